//! The steady flow algorithm.
mod checkpoint;
mod first_guess;
mod immersed;
mod params;
mod pressure_correction;
#[cfg(test)]
mod tests;
mod walls;

pub use params::{SimpleInfo, SimpleParams};
pub(crate) use pressure_correction::PressureCorrection;
pub use walls::WallStress;

use crate::boundary::OutletStep;
use crate::flow_state::{FlowState, show_state};
use crate::kernels;
use crate::linear::StencilMatrix;
use crate::momentum_matrix::{self as momentum, Equation, Implicit, MomentumEquations};
use crate::per_dimension::per_dimension;
use crate::poisson::PoissonError;
use crate::{CartesianGrid, Convection, EddyStress, Field, FlowError, Fluid, Modelled, Side};
use interfaces::Closure;
use walls::{Iteration, SimpleWalls};

/// Step \[s\] that outlets are moved on by in one iteration: they follow the flow inside at once.
const LONG: f64 = 1e30;
/// Residuals are relative to the sum of the terms of an equation, or to this part of Σ A_PP |u| V if that is more (where
/// all terms vanish, as in a uniform shear flow).
const FLOOR: f64 = 1e-5;
/// Divergence relative to what flows through that sums of numbers leave.
const ROUND_OFF: f64 = 1e-12;

/// Steady incompressible flow by SIMPLEC (Van Doormaal & Raithby 1984) or SIMPLE (Patankar & Spalding 1972) on a
/// staggered grid:
///
/// ```text
/// A δ = −∇·(u⊗u) + ∇·(2(ν + ν_t)S) − ∇p/ρ + f,   u* = u + δ
/// ∇·(β ∇φ) = ∇·u*,   u ← u* − β ∇φ,   p ← p + α_p ρ (φ − (ν + ν_t) ∇·u*)
/// ```
///
/// A is the implicit momentum operator (viscous terms, upwind or hybrid convection). Its diagonal gains
/// (1/α_u − 1)(Σ |u_n| A/2 + s ν Σ A/d)/V over the faces of a control volume: relaxation by local time steps, on fine grids
/// as on coarse ones. β = 1/(A_PP + Σ_N A_PN) (SIMPLEC) or 1/A_PP (SIMPLE, whose pressure goes without the last term:
/// Cahouet & Chabat 1988; with it α_u may be near 1 however viscous the fluid is). The right-hand side has the full
/// [`Convection`] scheme (deferred correction), so the steady flow has its order, whatever α_u is.
///
/// The velocity through a [`Side::PressureOutlet`] follows the momentum of the half cell before it, as in [`Projection`](crate::Projection).
///
/// Before the first iteration the velocity is freed of its divergence: from rest, or from a uniform stream that passes through
/// walls, it starts as the potential flow.
///
/// ```
/// use fv_mesh::{CartesianGrid, Fluid, Side, Simple};
/// // Plane Poiseuille flow: mean velocity f h²/(12 ν).
/// let grid = CartesianGrid::new([4, 16], [0.25, 1.0])?;
/// let sides = [Side::Periodic.both(), Side::WALL.both()];
/// let mut flow = Simple::new(grid, sides, Fluid { density: 1.0, viscosity: 0.1 })?;
/// flow.set_force([1.2, 0.0]);
/// flow.solve(200, 1e-9)?;
/// let mean = flow.statistics().volume_flow.x / 0.25;
/// assert!((mean - 1.0).abs() < 0.01);
/// # Ok::<(), fv_mesh::FlowError>(())
/// ```
pub struct Simple<const D: usize> {
    /// Its steps are iterations.
    state: FlowState<D>,
    params: SimpleParams,
    equations: MomentumEquations<D>,
    matrix: StencilMatrix<D>,
    correction: PressureCorrection<D>,
    delta: [Vec<f64>; D],
    force: [f64; D],
    /// What accelerates the fluid besides.
    source: Option<Box<[Field<D>; D]>>,
    stress: Option<EddyStress<D>>,
    /// Dense numbers of the nodes whose velocity is given.
    pinned: [Vec<usize>; D],
    walls: Option<Box<SimpleWalls<D>>>,
    /// k at the cell centres, for wall functions.
    energy: Option<Field<D>>,
}

impl<const D: usize> Simple<D> {
    /// Fluid at rest in a box; `sides[axis]` are its lower and upper side. Inlets that change in time stay as they are at
    /// time 0.
    ///
    /// # Errors
    /// [`FlowError`] for sides or fluid properties that make no sense.
    pub fn new(grid: CartesianGrid<D>, sides: [[Side; 2]; D], fluid: Fluid) -> Result<Self, FlowError> {
        per_dimension!(Simple, new_here(grid: CartesianGrid<D>, sides: [[Side; 2]; D], fluid: Fluid) -> Result<Simple<D>, FlowError>)
    }

    fn new_here(grid: CartesianGrid<D>, sides: [[Side; 2]; D], fluid: Fluid) -> Result<Self, FlowError> {
        let state = FlowState::new(grid, sides, fluid)?;
        let FlowState { grid, metrics, boundaries, .. } = &state;
        let params = SimpleParams::default();
        let n = grid.n_cells();
        let solver = params.momentum_solver(n);
        Ok(Self {
            equations: MomentumEquations::new(grid, metrics, fluid, solver, Implicit::Hybrid),
            matrix: StencilMatrix::new(grid.cells(), metrics.periodic)?,
            correction: params.pressure_solver(grid, metrics, boundaries)?,
            delta: std::array::from_fn(|_| vec![0.0; n]),
            force: [0.0; D],
            source: None,
            stress: None,
            pinned: std::array::from_fn(|_| Vec::new()),
            walls: None,
            energy: None,
            params,
            state,
        })
    }

    /// The same with another convection scheme than [`Convection::Central`].
    #[must_use]
    pub fn with_convection(mut self, scheme: Convection) -> Self {
        self.equations.set_convection(scheme);
        self
    }

    /// The same with these parameters.
    ///
    /// # Errors
    /// [`FlowError::Parameter`].
    pub fn with_params(mut self, params: SimpleParams) -> Result<Self, FlowError> {
        params.check()?;
        self.params = params;
        let FlowState { grid, metrics, boundaries, .. } = &self.state;
        self.equations.solver = params.momentum_solver(grid.n_cells());
        self.correction = params.pressure_solver(grid, metrics, boundaries)?;
        Ok(self)
    }

    /// Sets the first guess of the velocity to `u(x)` \[m/s\], outlets included; walls and inlets keep theirs.
    pub fn set_velocity(&mut self, u: impl Fn([f64; D]) -> [f64; D]) {
        self.state.set_velocity(u);
        if let Some(walls) = &self.walls {
            walls.stop(&self.state.grid, &mut self.state.velocity.components);
            self.state.fill_velocity();
        }
    }

    /// Sets the body force per mass \[m/s²\].
    pub fn set_force(&mut self, force: [f64; D]) {
        self.force = force;
    }
    /// Accelerations that vary in space, of every component at its nodes \[m/s²\], of the iterations to come; zero until this is first called.
    pub fn source_mut(&mut self) -> &mut [Field<D>; D] {
        let grid = &self.state.grid;
        self.source.get_or_insert_with(|| Box::new(std::array::from_fn(|_| Field::zeros(grid))))
    }

    /// Sets the kinematic eddy viscosity ν_t \[m²/s\] at the cell centres; `None` takes it away. Ghost values are used as
    /// they are: half the sum of a ghost and the cell inside is ν_t on the side.
    pub fn set_eddy_viscosity(&mut self, eddy: Option<&Field<D>>) {
        self.stress = eddy.map(|eddy| EddyStress::of(eddy.clone()));
        if let (Some(walls), Some(stress)) = (&mut self.walls, &mut self.stress) {
            walls.extend(&mut stress.eddy, self.energy.as_ref(), self.state.fluid.viscosity);
        }
    }

    /// Gives the velocity at some nodes, inside bodies at rest for instance: component, storage index in
    /// [`Field::data`] and value \[m/s\]. What was pinned before is free again. Neither the momentum equation nor the
    /// pressure changes these velocities.
    ///
    /// # Errors
    /// [`FlowError::Parameter`] for a component, index or value that makes no sense.
    pub fn pin(&mut self, nodes: impl IntoIterator<Item = (usize, usize, f64)>) -> Result<(), FlowError> {
        self.pinned.iter_mut().for_each(Vec::clear);
        for (c, index, value) in nodes {
            let cell = momentum::check_node(&self.state.grid, c, index, value)?;
            self.state.velocity.components[c].data_mut()[index] = value;
            self.pinned[c].push(cell);
        }
        self.state.fill_velocity();
        Ok(())
    }

    /// One iteration. The residuals told are those of the flow before it (momentum) and of its predicted velocity
    /// (continuity).
    ///
    /// # Errors
    /// [`FlowError::Diverged`] when the velocity is not finite or so large that the pressure equation cannot be solved; [`FlowError::MassBalance`] if what enters cannot leave.
    pub fn iterate(&mut self) -> Result<SimpleInfo, FlowError> {
        per_dimension!(self, Simple, iterate_here() -> Result<SimpleInfo, FlowError>)
    }

    fn iterate_here(&mut self) -> Result<SimpleInfo, FlowError> {
        let mut info = SimpleInfo::default();
        let mut scale = 0.0_f64;
        if self.state.step == 0 {
            self.free_first_guess()?;
        }
        if let Some(walls) = &mut self.walls {
            let FlowState { velocity, fluid, .. } = &self.state;
            walls.update(&velocity.components, self.energy.as_ref(), fluid.viscosity);
        }
        self.equations.set_law(self.stress.as_ref().map_or([[false; 2]; D], EddyStress::law));
        for c in 0..D {
            let FlowState { grid, metrics, boundaries, velocity, pressure, .. } = &self.state;
            let u = &velocity.components;
            let equation = Equation {
                velocity: u,
                pressure,
                history: [&u[c], &u[c]],
                weights: [0.0; 3],
                force: self.force[c],
                source: self.source.as_ref().map(|source| &source[c]),
                relaxation: self.params.velocity_relaxation,
                viscous_share: self.params.viscous_share,
                eddy: self.stress.as_ref().map(|s| &s.eddy),
            };
            let [mut terms, inertia] = self.equations.make(c, equation, boundaries, &mut self.matrix);
            if let Some(walls) = &mut self.walls {
                let iteration = Iteration {
                    grid,
                    metrics,
                    velocity: u,
                    pressure,
                    eddy: self.stress.as_ref().map(|s| &s.eddy),
                    scheme: self.equations.scheme,
                    viscosity: self.state.fluid.viscosity,
                    density: self.state.fluid.density,
                    force: self.force[c],
                    source: self.source.as_ref().map(|source| &source[c]),
                    relaxation: self.params.velocity_relaxation,
                    viscous_share: self.params.viscous_share,
                };
                walls.assemble(c, iteration, &mut self.equations, &mut self.matrix, &mut terms);
                for &cell in &walls.shut[c] {
                    momentum::pin(&mut self.matrix, cell, 0.0, &mut self.equations.rhs);
                }
            }
            if let Some(stress) = &self.stress {
                stress.add_friction(c, u, &mut self.matrix, &mut self.equations.rhs);
            }
            for &cell in &self.pinned[c] {
                momentum::pin(&mut self.matrix, cell, 0.0, &mut self.equations.rhs);
            }
            scale = scale.max(terms).max(FLOOR * inertia);
            let rhs = &self.equations.rhs;
            info.momentum[c] = momentum::absolute_sum(grid, metrics, Some(c), rhs);
            if !info.momentum[c].is_finite() {
                return Err(self.state.diverged(0.0));
            }
            info.sweeps += self.equations.solver.solve(&self.matrix, rhs, &mut self.delta[c])?;
            // Sums of rows do not fall below this but where the velocity is not yet free of divergence.
            let least = 0.05 * (1.0 - self.params.velocity_relaxation);
            let consistent = self.params.consistent.then_some(least);
            self.correction.set(c, &self.matrix, consistent, self.single());
            for &cell in &self.pinned[c] {
                self.correction.freeze(c, cell);
            }
            if let Some(walls) = &self.walls {
                walls.narrow(c, &mut self.correction);
            }
        }
        if scale > 0.0 {
            info.momentum.iter_mut().for_each(|r| *r /= scale);
        }
        let FlowState { grid, metrics, boundaries, fluid, velocity, pressure, .. } = &mut self.state;
        let stress = self.stress.as_ref().map(|stress| (&stress.eddy, &stress.walls[..]));
        boundaries.set_outlet_diffusion(metrics, fluid.viscosity, stress);
        boundaries.advance_excess(OutletStep {
            metrics,
            velocity: &velocity.components,
            pressure,
            fluid: *fluid,
            inverse_step: 0.0,
            relaxation: [1.0 / self.params.velocity_relaxation - 1.0, self.params.viscous_share],
        });
        for (u, delta) in velocity.components.iter_mut().zip(&self.delta) {
            kernels::add_dense(grid, delta, u);
        }
        boundaries.advance_outlets(metrics, &velocity.components, LONG, fluid.viscosity)?;
        boundaries.apply_excess(&velocity.components);
        self.state.fill_velocity();
        let FlowState { grid, metrics, boundaries, fluid, velocity, pressure, .. } = &mut self.state;
        self.correction.update(boundaries)?;
        let velocity = &mut velocity.components;
        if let Some(walls) = &self.walls {
            walls.show_fluxes(velocity);
        }
        let through = momentum::throughput(grid, metrics, velocity);
        let divergence = self.correction.measure(boundaries, velocity);
        if !divergence.is_finite() {
            return Err(self.state.diverged(0.0));
        }
        info.continuity = if through > 0.0 { divergence / through } else { 0.0 };
        if self.walls.is_some() || self.pinned.iter().any(|p| !p.is_empty()) {
            self.correction.skip_frozen();
        }
        info.pressure_iterations = match self.correction.solve(false) {
            Ok(solved) => solved.iterations,
            // Nothing but round-off is left of it.
            Err(PoissonError::NotConverged { .. }) if info.continuity < ROUND_OFF => {
                self.correction.phi.fill(0.0);
                0
            }
            // The residual grew: coefficients of a velocity that is far too large.
            Err(PoissonError::NotConverged { .. }) => return Err(self.state.diverged(0.0)),
            Err(error) => return Err(error.into()),
        };
        self.correction.correct(boundaries, velocity);
        if let Some(walls) = &self.walls {
            walls.show_nodes(velocity);
        }
        let gain = self.params.pressure_relaxation * fluid.density;
        // The viscous part of what the divergence takes (Cahouet & Chabat 1988); in SIMPLE proper β has it.
        let viscosity = if self.params.consistent { fluid.viscosity } else { 0.0 };
        let eddy = self.stress.as_ref().map(|s| &s.eddy).filter(|_| self.params.consistent);
        self.correction.scale(gain, viscosity, eddy);
        kernels::add_dense(grid, &self.correction.phi, pressure);
        self.state.fill_velocity();
        self.state.fill_pressure();
        self.state.step += 1;
        info.iterations = self.iterations();
        Ok(info)
    }

    /// One iteration with a turbulence model: the flow's with what the model says, then the model's with the flow that results.
    /// The residuals are those of [`iterate`](Self::iterate), and the model's.
    ///
    /// # Errors
    /// Those of [`iterate`](Self::iterate), and [`FlowError::Closure`].
    pub fn iterate_with<C: Closure>(&mut self, model: &mut Modelled<D, C>) -> Result<SimpleInfo, FlowError> {
        let viscosity = self.state.fluid.viscosity;
        let modelled = model.refresh(viscosity, 0.0)?;
        if modelled {
            std::mem::swap(&mut self.stress, &mut model.stress);
            self.look_at(model);
        }
        let iterated = self.iterate();
        if modelled {
            std::mem::swap(&mut self.stress, &mut model.stress);
        }
        let mut info = iterated?;
        match &mut self.walls {
            Some(walls) => {
                walls.fill_rows(viscosity);
                walls.reach_in(&mut self.state.velocity.components);
                self.state.fill_velocity();
                let updated = model.update(&self.state.velocity, walls.wall_rows(), viscosity, 0.0, None);
                walls.draw_back(&mut self.state.velocity.components);
                updated?;
            }
            None => model.update(&self.state.velocity, &[], viscosity, 0.0, None)?,
        }
        info.closure = model.closure.residual();
        Ok(info)
    }

    /// Iterates until all residuals are at most `tolerance`.
    ///
    /// # Errors
    /// [`FlowError::NotSteady`] with the residuals after `max_iterations`; else those of [`iterate`](Self::iterate).
    pub fn solve(&mut self, max_iterations: usize, tolerance: f64) -> Result<SimpleInfo, FlowError> {
        self.repeat(max_iterations, tolerance, Self::iterate)
    }

    /// The same with a turbulence model.
    ///
    /// # Errors
    /// As [`solve`](Self::solve), and those of [`iterate_with`](Self::iterate_with).
    pub fn solve_with<C: Closure>(
        &mut self,
        model: &mut Modelled<D, C>,
        max_iterations: usize,
        tolerance: f64,
    ) -> Result<SimpleInfo, FlowError> {
        self.repeat(max_iterations, tolerance, |flow| flow.iterate_with(model))
    }

    fn repeat(
        &mut self,
        max_iterations: usize,
        tolerance: f64,
        mut iterate: impl FnMut(&mut Self) -> Result<SimpleInfo, FlowError>,
    ) -> Result<SimpleInfo, FlowError> {
        let mut info = SimpleInfo { continuity: f64::INFINITY, ..SimpleInfo::default() };
        for _ in 0..max_iterations {
            info = iterate(self)?;
            if info.largest() <= tolerance {
                return Ok(info);
            }
        }
        let momentum = info.momentum.into_iter().fold(0.0, f64::max);
        let SimpleInfo { iterations, continuity, closure, .. } = info;
        Err(FlowError::NotSteady { iterations, momentum, continuity, closure, tolerance })
    }

    /// β where a box is one cell wide between two openings.
    fn single(&self) -> f64 {
        let FlowState { grid, fluid, .. } = &self.state;
        let stiffness: f64 = (0..D).map(|a| grid.axis(a).narrowest().powi(-2)).sum();
        let rate = 4.0 * fluid.viscosity * stiffness;
        if rate > 0.0 { 1.0 / rate } else { 0.0 }
    }

    /// Iterations made.
    pub fn iterations(&self) -> usize {
        self.state.step as usize
    }

    show_state!();
}
