//! Sparse Cholesky.
use super::direct::{self, Pattern};
use super::error::check_length;
use super::{DirectInfo, DirectParams, LinearError, LinearOperator, Matrix};
use monomorphic::Cholesky;

/// P A Pᵀ = L Lᵀ of a symmetric positive definite matrix with a fill-reducing order, by `faer`. The order is found
/// once per pattern.
pub struct SparseCholesky {
    pattern: Pattern,
    /// Places (i, j) and (j, i) of the entries above the diagonal.
    mirrored: Vec<[usize; 2]>,
    factors: Cholesky,
    residual: Vec<f64>,
    ready: bool,
}

/// Largest difference across the diagonal over the largest of the two entries and their rows' diagonals.
const SYMMETRIC: f64 = 1e-12;

impl SparseCholesky {
    /// Analyses the pattern and factorises.
    ///
    /// # Errors
    /// [`LinearError::Memory`], and as [`refactor`](Self::refactor).
    pub fn new(matrix: &Matrix) -> Result<Self, LinearError> {
        let mut mirrored = Vec::new();
        for row in 0..matrix.n() {
            let start = matrix.parts().0[row];
            for (k, &col) in matrix.row(row).0.iter().enumerate() {
                if col > row {
                    mirrored.push([start + k, matrix.slot(col, row)?]);
                }
            }
        }
        let factors = Cholesky::new(direct::pattern(matrix)).map_err(|e| direct::failure(matrix, e))?;
        let pattern = Pattern::new(matrix);
        let residual = vec![0.0; matrix.n()];
        let mut cholesky = Self { pattern, mirrored, factors, residual, ready: false };
        cholesky.refactor(matrix)?;
        Ok(cholesky)
    }

    /// Factorises new values of the same pattern, with the order found before.
    ///
    /// # Errors
    /// [`LinearError::PatternChanged`], [`LinearError::NonFinite`], [`LinearError::NotSymmetric`],
    /// [`LinearError::NotPositiveDefinite`] (take [`SparseLu`](super::SparseLu) then) and [`LinearError::Memory`].
    pub fn refactor(&mut self, matrix: &Matrix) -> Result<(), LinearError> {
        self.pattern.check(matrix)?;
        direct::check_entries(matrix)?;
        self.check_symmetry(matrix)?;
        self.ready = false;
        self.factors
            .factorize(direct::pattern(matrix), matrix.as_sprs().data())
            .map_err(|e| direct::failure(matrix, e))?;
        self.ready = true;
        Ok(())
    }

    fn check_symmetry(&self, matrix: &Matrix) -> Result<(), LinearError> {
        let (starts, columns, values) = matrix.parts();
        for &[upper, lower] in &self.mirrored {
            let [value, mirror] = [values[upper], values[lower]];
            if value != mirror {
                let row = starts.partition_point(|&s| s <= upper) - 1;
                let col = columns[upper];
                let scale = [value, mirror, matrix.diagonal(row), matrix.diagonal(col)];
                let scale = scale.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
                if (value - mirror).abs() > SYMMETRIC * scale {
                    return Err(LinearError::NotSymmetric { row, col, value, mirrored: mirror });
                }
            }
        }
        Ok(())
    }

    /// Solves A x = b; `matrix` is the one factorised (or one close to it: x is then refined). What x held is not
    /// read. If b = 0, x becomes zero.
    ///
    /// # Errors
    /// [`LinearError::NotConverged`] or [`LinearError::NonFinite`] if the matrix is singular to round-off;
    /// [`LinearError::Shape`], [`LinearError::Parameter`], [`LinearError::PatternChanged`], and
    /// [`LinearError::Singular`] after a failed [`refactor`](Self::refactor).
    pub fn solve(
        &mut self,
        matrix: &Matrix,
        b: &[f64],
        x: &mut [f64],
        params: &DirectParams,
    ) -> Result<DirectInfo, LinearError> {
        self.pattern.check(matrix)?;
        check_length("b", matrix.n(), b.len())?;
        check_length("x", matrix.n(), x.len())?;
        if !self.ready {
            return Err(LinearError::Singular { step: 0 });
        }
        let Self { factors, residual, .. } = self;
        direct::solve_refined(matrix, b, x, residual, params, |v| factors.solve(v))
    }
}
