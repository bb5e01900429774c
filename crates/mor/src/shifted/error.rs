//! What can go wrong.

/// Why snapshots could not be decomposed or fields not be shifted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ShiftedError {
    /// An axis of the grid is not usable.
    #[error(
        "axis {axis} has {cells} cells of {spacing}; give at least one cell and a positive, finite spacing"
    )]
    Axis {
        /// Counted from 0.
        axis: usize,
        /// On it.
        cells: usize,
        /// Width of a cell.
        spacing: f64,
    },
    /// The rows of the snapshots are no whole number of fields.
    #[error(
        "{rows} rows are not a whole number of fields of {cells} cells; stack the components of a vector one below the other"
    )]
    Rows {
        /// Of the snapshots.
        rows: usize,
        /// Of the grid.
        cells: usize,
    },
    /// There are not as many snapshots as shifts.
    #[error(
        "there are {snapshots} snapshots but shifts of {shifts}; give each frame one motion per snapshot"
    )]
    Snapshots {
        /// Columns of the data.
        snapshots: usize,
        /// Motions of each frame.
        shifts: usize,
    },
    /// Nothing to decompose.
    #[error(
        "there is nothing to decompose: {snapshots} snapshots in {frames} frames; give at least one of each"
    )]
    Empty {
        /// Columns of the data.
        snapshots: usize,
        /// Frames of reference.
        frames: usize,
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
    /// A frame's motion is NaN or infinite.
    #[error("the motion of frame {frame} at snapshot {snapshot} is not finite")]
    Motion {
        /// Of reference.
        frame: usize,
        /// Column of the data.
        snapshot: usize,
    },
    /// A frame moves so far that its place within a cell is rounding.
    #[error(
        "frame {frame} moves by {distance:e} along axis {axis} at snapshot {snapshot}, {cells:e} cells: its place within a cell is rounding; take whole periods away"
    )]
    TooFar {
        /// Number of the frame.
        frame: usize,
        /// Number of the snapshot.
        snapshot: usize,
        /// Number of the axis, from 0.
        axis: usize,
        /// Displacement \[m\].
        distance: f64,
        /// The same in cells.
        cells: f64,
    },
    /// The phase of a wave vector shifts around a period only.
    #[error(
        "frame {frame} moves or turns by up to {distance} along axis {axis} at snapshot {snapshot}, which is not periodic: shift by Lagrange polynomials or splines"
    )]
    NotPeriodic {
        /// Of reference.
        frame: usize,
        /// Column of the data.
        snapshot: usize,
        /// Counted from 0.
        axis: usize,
        /// Of the frame.
        distance: f64,
    },
    /// A frame turns where only translations are possible.
    #[error(
        "frame {frame} turns by {angle} rad at snapshot {snapshot}; only translations are diagonal in Fourier space"
    )]
    Turns {
        /// Of reference.
        frame: usize,
        /// Column of the data.
        snapshot: usize,
        /// Of the frame.
        angle: f64,
    },
    /// A frame leaves the plane or the line of the grid.
    #[error("frame {frame} moves along axis {axis} at snapshot {snapshot}, of which the grid has one cell")]
    OffGrid {
        /// Of reference.
        frame: usize,
        /// Column of the data.
        snapshot: usize,
        /// Counted from 0.
        axis: usize,
    },
    /// The snapshots have another number of rows than the operators or the frames to start from.
    #[error("the snapshots have {rows} rows where {expected} are expected; use operators made for them")]
    Unknowns {
        /// Of the data.
        rows: usize,
        /// By the operators.
        expected: usize,
    },
    /// There are not as many ranks, or fields to start from, as frames.
    #[error("{ranks} ranks were given for {frames} frames; give one per frame, 0 if it is to carry nothing")]
    Ranks {
        /// Given.
        ranks: usize,
        /// Of reference.
        frames: usize,
    },
    /// An entry is beyond the snapshots.
    #[error("there is no row {row} of snapshot {snapshot}: there are {rows} rows and {snapshots} snapshots")]
    Entry {
        /// Asked for.
        row: usize,
        /// Asked for.
        snapshot: usize,
        /// Of the data.
        rows: usize,
        /// Columns of the data.
        snapshots: usize,
    },
    /// A forward step is so long that the iteration diverges, or none, or a weight is.
    #[error("{name} is {value}; it must be positive, finite and below {limit}")]
    Parameter {
        /// Which one.
        name: &'static str,
        /// Given.
        value: f64,
        /// It has to be below.
        limit: f64,
    },
    /// A tolerance that is not a number, or negative.
    #[error("the {name} is {value}; it must be a number of at least 0")]
    Tolerance {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// Snapshots of which powers leave double precision.
    #[error(
        "the entries are as large as {largest:e}, and the norm of the snapshots is {norm:e}: its fourth power leaves double precision; divide the snapshots by {largest:e}"
    )]
    Size {
        /// Largest modulus of an entry.
        largest: f64,
        /// Frobenius norm.
        norm: f64,
    },
    /// A matrix that belongs to the snapshots has another shape.
    #[error("{what}: {found:?} rows and columns (or frames and snapshots), where {expected:?} are needed")]
    Shape {
        /// Which.
        what: &'static str,
        /// What it must have.
        expected: [usize; 2],
        /// What it has.
        found: [usize; 2],
    },
}

/// Displacements in cells up to which double precision leaves 1e-6 of a cell.
const FARTHEST: f64 = 1e-6 / f64::EPSILON;

impl ShiftedError {
    /// Checks that the place within a cell is known of a frame that moves by a `distance`.
    pub(super) fn check_distance(
        [frame, snapshot, axis]: [usize; 3],
        distance: f64,
        spacing: f64,
    ) -> Result<(), Self> {
        let cells = distance / spacing;
        match cells.abs() <= FARTHEST {
            true => Ok(()),
            false => Err(Self::TooFar { frame, snapshot, axis, distance, cells }),
        }
    }
    /// Checks that a tolerance is a number of at least 0.
    pub(super) fn check_tolerance(name: &'static str, value: f64) -> Result<(), Self> {
        if value >= 0.0 { Ok(()) } else { Err(Self::Tolerance { name, value }) }
    }
}
