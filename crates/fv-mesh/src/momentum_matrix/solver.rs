//! The linear solver of the momentum equations.
use crate::FlowError;
use crate::linear::{BiCgStabParams, BiCgStabScratch, Dilu, LinearError, StencilMatrix, bicgstab};

/// BiCGSTAB preconditioned by incomplete factors; its memory serves all components.
pub(crate) struct MomentumSolver {
    scratch: BiCgStabScratch,
    factors: Option<Dilu>,
    pub(crate) params: BiCgStabParams,
}

impl MomentumSolver {
    pub(crate) fn new(cells: usize, relative: f64, max_iterations: usize) -> Self {
        Self {
            scratch: BiCgStabScratch::new(cells),
            factors: None,
            params: BiCgStabParams { relative, absolute: 0.0, max_iterations },
        }
    }

    /// Solves A δ = `rhs` from δ = 0; gives the iterations made. Running out of them is no error: the last δ stands.
    pub(crate) fn solve<const D: usize>(
        &mut self,
        matrix: &StencilMatrix<D>,
        rhs: &[f64],
        delta: &mut [f64],
    ) -> Result<usize, FlowError> {
        delta.fill(0.0);
        match &mut self.factors {
            Some(factors) => factors.refactor(matrix)?,
            none => *none = Some(Dilu::new(matrix)?),
        }
        let Some(factors) = &self.factors else { return Ok(0) };
        let solved =
            bicgstab(matrix, &mut factors.with(matrix)?, rhs, delta, &mut self.scratch, &self.params);
        match solved {
            Ok(info) => Ok(info.iterations),
            Err(LinearError::NotConverged { iterations, .. }) => Ok(iterations),
            Err(error) => Err(error.into()),
        }
    }
}
