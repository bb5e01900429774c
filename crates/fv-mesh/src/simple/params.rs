//! Parameters and report of the steady algorithm.
use super::PressureCorrection;
use crate::boundary::Boundaries;
use crate::metrics::Metrics;
use crate::momentum_matrix::MomentumSolver;
use crate::{CartesianGrid, FlowError};

/// Parameters of [`Simple`](super::Simple).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimpleParams {
    /// Relaxation factor α_u of the momentum equations, 0 < α_u < 1. Default 0.93; SIMPLE proper wants about 0.7.
    pub velocity_relaxation: f64,
    /// Part s of the viscous terms that relaxation counts, 0 < s ≤ 1. Default 0.1; 1 is Patankar's relaxation, which slows
    /// down on fine grids.
    pub viscous_share: f64,
    /// Relaxation factor α_p of the pressure, 0 < α_p ≤ 1. Default 1; SIMPLE proper wants about 0.3.
    pub pressure_relaxation: f64,
    /// SIMPLEC rather than SIMPLE. Default yes.
    pub consistent: bool,
    /// Residual to which momentum equations are solved in one iteration, relative to that before. Default 0.3.
    pub momentum_tolerance: f64,
    /// Residual to which the pressure equation is solved in one iteration, relative to its right-hand side. Default 0.3.
    pub pressure_tolerance: f64,
}

impl Default for SimpleParams {
    fn default() -> Self {
        Self {
            velocity_relaxation: 0.93,
            viscous_share: 0.1,
            pressure_relaxation: 1.0,
            consistent: true,
            momentum_tolerance: 0.3,
            pressure_tolerance: 0.3,
        }
    }
}

impl SimpleParams {
    /// The parameters of SIMPLE proper: not consistent, α_u = 0.7, s = 1, α_p = 0.3.
    pub fn simple() -> Self {
        Self {
            velocity_relaxation: 0.7,
            viscous_share: 1.0,
            pressure_relaxation: 0.3,
            consistent: false,
            ..Self::default()
        }
    }

    /// For flows with a turbulence model: α_u = 0.85, s = 0.3, momentum equations solved to 0.1. The viscosities change by orders of
    /// magnitude across the flow and from iteration to iteration: a larger s takes more iterations where cells are fine (what is wide
    /// in cells settles in as many iterations as it has cells squared), a smaller one where they are coarse. α_u = 0.9 saves a third
    /// in ducts with immersed walls and behind bluff bodies, there with s = 0.03.
    pub fn turbulent() -> Self {
        Self { velocity_relaxation: 0.85, viscous_share: 0.3, momentum_tolerance: 0.1, ..Self::default() }
    }

    pub(super) fn check(&self) -> Result<(), FlowError> {
        let fail = |name, value, range| Err(FlowError::Parameter { name, value, range });
        let open = |x: f64| x > 0.0 && x < 1.0;
        if !open(self.velocity_relaxation) {
            let name = "the relaxation factor of the velocity";
            return fail(name, self.velocity_relaxation, "above 0 and below 1");
        }
        if !(self.pressure_relaxation > 0.0 && self.pressure_relaxation <= 1.0) {
            let name = "the relaxation factor of the pressure";
            return fail(name, self.pressure_relaxation, "above 0 and at most 1");
        }
        if !(self.viscous_share > 0.0 && self.viscous_share <= 1.0) {
            return fail("the viscous share", self.viscous_share, "above 0 and at most 1");
        }
        for (name, value) in [
            ("the tolerance of the momentum equations", self.momentum_tolerance),
            ("the tolerance of the pressure equation", self.pressure_tolerance),
        ] {
            if !(1e-13..1.0).contains(&value) {
                return fail(name, value, "at least 1e-13 and below 1");
            }
        }
        Ok(())
    }

    pub(super) fn momentum_solver(&self, cells: usize) -> MomentumSolver {
        MomentumSolver::new(cells, self.momentum_tolerance, 20)
    }

    pub(super) fn pressure_solver<const D: usize>(
        &self,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        boundaries: &Boundaries<D>,
    ) -> Result<PressureCorrection<D>, FlowError> {
        PressureCorrection::new(grid, metrics, boundaries, self.pressure_tolerance, 30)
    }
}

/// What an iteration has to tell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SimpleInfo {
    /// Iterations made so far.
    pub iterations: usize,
    /// Per component Σ |r| V over the largest Σ (|∇·(u⊗u) − viscous term| + |∂p/∂x|/ρ + |f|) V of all components.
    pub momentum: [f64; 3],
    /// Σ |∇·u*| V over Σ |u*| A, A the faces.
    pub continuity: f64,
    /// That of the turbulence model; 0 without one.
    pub closure: f64,
    /// Iterations of the momentum solver, all components together.
    pub sweeps: usize,
    /// Iterations of the pressure solver.
    pub pressure_iterations: usize,
}

impl SimpleInfo {
    /// The largest residual.
    pub fn largest(&self) -> f64 {
        self.momentum.into_iter().fold(self.continuity.max(self.closure), f64::max)
    }
}
