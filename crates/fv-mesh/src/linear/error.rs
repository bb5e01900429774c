//! What can go wrong.

/// Why a matrix, a factorisation or a solve was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinearError {
    /// A vector, matrix or scratch of the wrong size.
    #[error("{what} has size {found} but {expected} was expected; give one entry per unknown")]
    Shape {
        /// Which argument.
        what: &'static str,
        /// Size that fits.
        expected: usize,
        /// Size given.
        found: usize,
    },
    /// The iterations ran out or no longer help. The last iterate was written.
    #[error(
        "the residual is {residual:.3e} of |b| after {iterations} iterations, above the tolerance {tolerance:.3e}; \
         allow more iterations, a larger tolerance or a stronger preconditioner"
    )]
    NotConverged {
        /// Iterations made.
        iterations: usize,
        /// 2-norm of b − A x over that of b.
        residual: f64,
        /// What was asked for, over the 2-norm of b.
        tolerance: f64,
    },
    /// A recurrence divides by a number that vanishes, even after a restart.
    #[error("{what} is {value:.3e} in iteration {iteration}: the method breaks down; use a direct solver")]
    Breakdown {
        /// Iteration, from 0.
        iteration: usize,
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// The operator or the preconditioner is not positive definite, as conjugate gradients need.
    #[error(
        "{what} is {value:.3e} in iteration {iteration}: not positive definite; use BiCGSTAB or a direct solver"
    )]
    Indefinite {
        /// Iteration, from 0.
        iteration: usize,
        /// Which number.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A Cholesky pivot that is not positive.
    #[error("the pivot of row {row} is not positive: the matrix is not positive definite; use LU")]
    NotPositiveDefinite {
        /// Row of the matrix.
        row: usize,
    },
    /// A Cholesky factorisation of a matrix that is not symmetric.
    #[error("entry ({row}, {col}) is {value:.17e} but ({col}, {row}) is {mirrored:.17e}; use LU")]
    NotSymmetric {
        /// Row of the first entry.
        row: usize,
        /// Its column.
        col: usize,
        /// Its value.
        value: f64,
        /// Value across the diagonal.
        mirrored: f64,
    },
    /// A diagonal entry or pivot that cannot be divided by.
    #[error(
        "the diagonal or pivot of row {row} is {value:.3e}; it must be finite and not vanish: check that row"
    )]
    ZeroPivot {
        /// Row.
        row: usize,
        /// Value found.
        value: f64,
    },
    /// No pivot at all: the rows are linearly dependent whatever their values.
    #[error(
        "no pivot is left in elimination step {step}: the pattern of the matrix is singular; check for empty columns"
    )]
    Singular {
        /// Step of the elimination.
        step: usize,
    },
    /// Infinities or NaN.
    #[error("{what} is {value} in row {row}; look for the step where it stopped being finite")]
    NonFinite {
        /// Which argument.
        what: &'static str,
        /// First such row.
        row: usize,
        /// Value found.
        value: f64,
    },
    /// An entry outside the fixed pattern.
    #[error("({row}, {col}) is not in the pattern of this {n} × {n} matrix; build the pattern with it")]
    Pattern {
        /// Row.
        row: usize,
        /// Column.
        col: usize,
        /// Unknowns.
        n: usize,
    },
    /// Another pattern than the one that was analysed.
    #[error(
        "the matrix has {found} entries in another pattern than the {expected} analysed; factorise it anew"
    )]
    PatternChanged {
        /// Entries analysed.
        expected: usize,
        /// Entries given.
        found: usize,
    },
    /// A parameter outside its range.
    #[error("{name} is {value}; it must be {range}")]
    Parameter {
        /// Which one.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        range: &'static str,
    },
    /// A box that cannot hold a matrix.
    #[error("a box of {cells:?} cells; give 1 to 3 axes of at least one cell that fit in memory")]
    Cells {
        /// Cells per axis.
        cells: Vec<usize>,
    },
    /// A factorisation needs more memory than there is.
    #[error(
        "the factors of {n} unknowns with {entries} entries do not fit in memory; use an iterative solver"
    )]
    Memory {
        /// Unknowns.
        n: usize,
        /// Entries of the matrix.
        entries: usize,
    },
}

/// Checks a length.
pub(super) fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), LinearError> {
    if expected == found { Ok(()) } else { Err(LinearError::Shape { what, expected, found }) }
}

/// Checks that all is finite.
pub(super) fn check_finite(what: &'static str, values: &[f64]) -> Result<(), LinearError> {
    match values.iter().position(|v| !v.is_finite()) {
        Some(row) => Err(LinearError::NonFinite { what, row, value: values[row] }),
        None => Ok(()),
    }
}
