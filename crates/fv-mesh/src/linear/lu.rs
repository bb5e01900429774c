//! Sparse LU.
use super::direct::{self, Pattern};
use super::error::check_length;
use super::{DirectInfo, DirectParams, LinearError, LinearOperator, Matrix};
use monomorphic::Lu;

/// P A Q = L U with partial pivoting and a fill-reducing order of columns, by `faer`. The order is found once per
/// pattern.
pub struct SparseLu {
    pattern: Pattern,
    factors: Lu,
    residual: Vec<f64>,
    ready: bool,
}

impl SparseLu {
    /// Analyses the pattern and factorises.
    ///
    /// # Errors
    /// [`LinearError::Memory`], and as [`refactor`](Self::refactor).
    pub fn new(matrix: &Matrix) -> Result<Self, LinearError> {
        direct::check_entries(matrix)?;
        let factors = Lu::new(direct::pattern(matrix)).map_err(|e| direct::failure(matrix, e))?;
        let pattern = Pattern::new(matrix);
        let mut lu = Self { pattern, factors, residual: vec![0.0; matrix.n()], ready: false };
        lu.refactor(matrix)?;
        Ok(lu)
    }

    /// Factorises new values of the same pattern, with the order found before.
    ///
    /// # Errors
    /// [`LinearError::PatternChanged`], [`LinearError::NonFinite`], [`LinearError::Singular`] and
    /// [`LinearError::Memory`].
    pub fn refactor(&mut self, matrix: &Matrix) -> Result<(), LinearError> {
        self.pattern.check(matrix)?;
        direct::check_entries(matrix)?;
        self.ready = false;
        self.factors
            .factorize(direct::pattern(matrix), matrix.as_sprs().data())
            .map_err(|e| direct::failure(matrix, e))?;
        self.ready = true;
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
