//! What the direct solvers have in common.
use super::criterion::Criterion;
use super::{LinearError, LinearOperator, Matrix, vector};
use monomorphic::FactorError;

/// Tolerances of a direct solve: it ends when ‖b − A x‖ ≤ max(relative ‖b‖, absolute), at once as a rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectParams {
    /// Of ‖b‖.
    pub relative: f64,
    /// In the unit of b.
    pub absolute: f64,
    /// Solves allowed, of which all but the first refine x by its residual.
    pub max_iterations: usize,
}

impl Default for DirectParams {
    fn default() -> Self {
        Self { relative: 1e-10, absolute: 0.0, max_iterations: 4 }
    }
}

/// What a direct solve did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DirectInfo {
    /// Solves with the factors.
    pub iterations: usize,
    /// ‖b − A x‖ / ‖b‖ after the first of them.
    pub initial_residual: f64,
    /// ‖b − A x‖ / ‖b‖ of the x found.
    pub residual: f64,
}

/// The pattern that was analysed.
#[derive(Clone, Debug)]
pub(super) struct Pattern {
    starts: Vec<usize>,
    columns: Vec<usize>,
}

impl Pattern {
    pub(super) fn new(matrix: &Matrix) -> Self {
        let (starts, columns, _) = matrix.parts();
        Self { starts: starts.to_vec(), columns: columns.to_vec() }
    }

    pub(super) fn check(&self, matrix: &Matrix) -> Result<(), LinearError> {
        let (starts, columns, _) = matrix.parts();
        if starts == self.starts && columns == self.columns {
            return Ok(());
        }
        Err(LinearError::PatternChanged { expected: self.columns.len(), found: columns.len() })
    }
}

/// For `monomorphic`.
pub(super) fn pattern(matrix: &Matrix) -> monomorphic::Pattern<'_> {
    let (starts, columns, _) = matrix.parts();
    monomorphic::Pattern { starts, columns }
}

/// What to say of a matrix without factors.
pub(super) fn failure(matrix: &Matrix, error: FactorError) -> LinearError {
    match error {
        FactorError::Memory => LinearError::Memory { n: matrix.n(), entries: matrix.as_sprs().nnz() },
        FactorError::NotPositive { row } => LinearError::NotPositiveDefinite { row },
        FactorError::Singular { step } => LinearError::Singular { step },
    }
}

/// The first entry that is not finite.
pub(super) fn check_entries(matrix: &Matrix) -> Result<(), LinearError> {
    let (starts, _, values) = matrix.parts();
    match values.iter().position(|v| !v.is_finite()) {
        Some(slot) => {
            let row = starts.partition_point(|&s| s <= slot) - 1;
            Err(LinearError::NonFinite { what: "the matrix", row, value: values[slot] })
        }
        None => Ok(()),
    }
}

/// Solves and refines; `solve` replaces its argument v by A⁻¹ v.
pub(super) fn solve_refined(
    matrix: &Matrix,
    b: &[f64],
    x: &mut [f64],
    r: &mut [f64],
    params: &DirectParams,
    mut solve: impl FnMut(&mut [f64]),
) -> Result<DirectInfo, LinearError> {
    x.fill(0.0);
    let Some(criterion) = Criterion::new([params.relative, params.absolute], matrix.n(), b, x)? else {
        return Ok(DirectInfo::default());
    };
    let mut info = DirectInfo { iterations: 0, initial_residual: 1.0, residual: 1.0 };
    let mut norm = criterion.scale;
    r.copy_from_slice(b);
    while norm > criterion.target {
        if info.iterations >= params.max_iterations {
            return Err(criterion.not_converged(info.iterations, norm));
        }
        solve(r);
        vector::add_scaled(1.0, r, x);
        let reached = criterion.residual(matrix, b, x, r)?;
        info.iterations += 1;
        info.residual = reached / criterion.scale;
        if info.iterations == 1 {
            info.initial_residual = info.residual;
        } else if reached > 0.9 * norm && reached > criterion.target {
            return Err(criterion.not_converged(info.iterations, reached));
        }
        norm = reached;
    }
    Ok(info)
}
