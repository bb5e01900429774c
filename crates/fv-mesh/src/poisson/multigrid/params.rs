//! What to give to the multigrid solvers.
use crate::poisson::AxisBounds;

/// One axis of the box: widths of its cells \[m\] and its ends.
#[derive(Clone, Debug, PartialEq)]
pub struct MultigridAxis {
    /// Widths of the cells from the low end to the high one \[m\].
    pub widths: Vec<f64>,
    /// What holds at the ends.
    pub ends: AxisBounds,
}

/// Parameters of [`Multigrid`](super::Multigrid) and [`MultigridCg`](super::MultigridCg).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MultigridParams {
    /// Largest 2-norm (volume-weighted) of the residual over that of f. Default 10⁻⁶.
    pub tolerance: f64,
    /// Iterations after which a solve gives up. Default 100.
    pub max_iterations: usize,
    /// Red–black Gauss–Seidel sweeps before and as many after the coarse correction of a V-cycle. Default 1.
    pub sweeps: usize,
    /// Keep face coefficients and kinds of ends cell by cell, so that they can be set later; else β = 1. Default no.
    pub variable: bool,
    /// Cells up to this times the width of the narrowest are merged first. Larger: fewer levels, but more
    /// iterations on stretched grids. Default 2.
    pub widest_merged: f64,
}

impl Default for MultigridParams {
    fn default() -> Self {
        Self { tolerance: 1e-6, max_iterations: 100, sweeps: 1, variable: false, widest_merged: 2.0 }
    }
}
