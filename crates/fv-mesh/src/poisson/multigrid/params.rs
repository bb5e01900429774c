//! What to give to the multigrid solvers.
/// Parameters of [`Multigrid`](super::Multigrid) and [`MultigridCg`](super::MultigridCg).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultigridParams {
    /// Largest 2-norm (volume-weighted) of the residual over that of f. Default 10⁻⁶.
    pub tolerance: f64,
    /// Iterations after which a solve gives up. Default 100.
    pub max_iterations: usize,
    /// Red–black Gauss–Seidel sweeps before and as many after the coarse correction of a V-cycle. Default 2.
    pub sweeps: usize,
    /// Keep face coefficients and kinds of ends cell by cell, so that they can be set later; else β = 1. Default no.
    pub variable: bool,
    /// Cells up to this times the width of the narrowest are merged first. Larger: fewer levels, but more
    /// iterations on stretched grids. Default 2.
    pub widest_merged: f64,
}

impl Default for MultigridParams {
    fn default() -> Self {
        Self { tolerance: 1e-6, max_iterations: 100, sweeps: 2, variable: false, widest_merged: 2.0 }
    }
}
