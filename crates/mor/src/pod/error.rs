//! What can go wrong.
use crate::snapshots::SnapshotError;

/// Why snapshots could not be decomposed, or a field not be projected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PodError {
    /// Nothing to decompose.
    #[error("there is nothing to decompose: {snapshots} snapshots of {rows} rows; give at least one of each")]
    Empty {
        /// Unknowns.
        rows: usize,
        /// Columns.
        snapshots: usize,
    },
    /// Two sizes that must agree do not.
    #[error("{what}: {found} were given, {expected} are needed")]
    Shape {
        /// Of what.
        what: &'static str,
        /// How many there must be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// A value is NaN or infinite.
    #[error("row {row} of snapshot {snapshot} is {value}; remove or repair this snapshot")]
    NotFinite {
        /// Column of the data.
        snapshot: usize,
        /// Row of the data.
        row: usize,
        /// What is there.
        value: f64,
    },
    /// A weight of the inner product is none.
    #[error(
        "the weight of row {row} is {value}; weights are volumes of cells: finite, not negative, and not all zero"
    )]
    Weight {
        /// Which.
        row: usize,
        /// Its value.
        value: f64,
    },
    /// A parameter is unusable.
    #[error("the {what} is {value}; it must be {must}")]
    Parameter {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// Entries whose squares leave double precision.
    #[error(
        "the entries are as large as {largest:e}; squares of their sums leave double precision beyond {} and below {}; divide the snapshots by {largest:e}",
        NORMS.end(), NORMS.start()
    )]
    Size {
        /// Largest modulus of an entry.
        largest: f64,
    },
    /// Iterations for singular values that did not converge.
    #[error(
        "the singular values of a matrix of {rows} × {snapshots} with entries up to {largest:e} did not converge; scale the data to a size near 1"
    )]
    NotConverged {
        /// Unknowns.
        rows: usize,
        /// Columns.
        snapshots: usize,
        /// Largest modulus of an entry.
        largest: f64,
    },
    /// Snapshots could not be read.
    #[error(transparent)]
    Source(#[from] SnapshotError),
}

/// Norms of snapshots whose squares, and 1e-32 of these, are normal numbers.
const NORMS: std::ops::RangeInclusive<f64> = 1e-135..=1e150;

impl PodError {
    /// The norm must be one of those that can be squared, or zero.
    pub(super) fn check_size(squares: f64, largest: f64) -> Result<(), Self> {
        let norm = squares.sqrt();
        if largest == 0.0 || NORMS.contains(&norm) { Ok(()) } else { Err(Self::Size { largest }) }
    }
    /// `found` must be `expected`.
    pub(super) fn same(what: &'static str, expected: usize, found: usize) -> Result<(), Self> {
        if expected == found { Ok(()) } else { Err(Self::Shape { what, expected, found }) }
    }
}
