//! The flow algorithm for time-accurate runs.
mod checkpoint;
mod immersed;
mod prediction;
mod sources;
mod unknowns;
mod window;

use crate::boundary::OutletStep;
use crate::cut::{Step, Walls};
use crate::diffusion::{SplitDiffusion, stiffness};
use crate::flow_state::{FlowState, show_clock, show_state};
use crate::implicit::ImplicitDiffusion;
use crate::kernels::{self, Advance, Conductance, Momentum};
use crate::metrics::Metrics;
use crate::per_dimension::per_dimension;
use crate::poisson::{PoissonError, PoissonInfo};
use crate::pressure::{Pressure, PressureSolver};
use crate::{CartesianGrid, Convection, Diffusion, Field, FlowError, Fluid, Side, walls};
use interfaces::Vector;
pub use prediction::Prediction;
pub use sources::SourceWork;
use sources::Sources;

/// Incompressible flow by incremental pressure projection on a staggered grid:
///
/// ```text
/// (1 − κL)(u* − uⁿ) = dt [ (1 + r/2) Hⁿ − (r/2) Hⁿ⁻¹ + ν L uⁿ − ∇pⁿ/ρ + b ],   r = dt/dt_last
/// ∇²φ  = (ρ/dt) ∇·u*,    uⁿ⁺¹ = u* − (dt/ρ) ∇φ,    pⁿ⁺¹ = pⁿ + φ − κ L φ
/// ```
///
/// H = −∇·(u⊗u) + ν∇²u takes the viscous terms along the axes where the step is within their stability limit, L those
/// along the other axes, κ = ½ν dt ([`Diffusion`]): Adams–Bashforth with variable step and Crank–Nicolson, second
/// order in time; central differences (unless another [`Convection`] is chosen), second order in space; rotational
/// pressure update (Timmermans et al. 1996), which on this grid leaves no numerical boundary layer; pⁿ⁺¹ belongs to the
/// middle of the step. The two halves of a step are public, so that an
/// immersed boundary can act between them: [`predict`](Self::predict) and
/// [`project`](Self::project); [`advance`](Self::advance) is both. A step allocates nothing when it
/// runs inside a rayon pool. After an error in the middle of a step the
/// state is that of half a step: restore a saved one.
pub struct Projection<const D: usize> {
    pub(crate) state: FlowState<D>,
    momentum: Momentum<D>,
    diffusion: SplitDiffusion<D>,
    implicit: ImplicitDiffusion<D>,
    /// Where the velocity goes in the predictor; then what it was before.
    next: [Field<D>; D],
    /// φ, where implicit diffusion needs it as a field.
    correction: Option<Field<D>>,
    tendency: [Field<D>; D],
    sources: Sources<D>,
    pressure_solver: Pressure<D>,
    phi: Vec<f64>,
    /// The pressure at rest where some is given (dense), else empty.
    rest_pressure: Vec<f64>,
    /// What the sides did at the last two predictor steps, per time, and their impulse in the last step.
    friction: [Vector; 2],
    wall_impulse: Vector,
    walls: Option<Box<Walls<D>>>,
    start: Option<Box<Start<D>>>,
}

/// Fields at the start of a step that can be taken back; the velocity is in `next`.
struct Start<const D: usize> {
    tendency: [Field<D>; D],
    pressure: Field<D>,
    /// Whether velocity and tendency, and the pressure, are those of the step's end.
    advanced: [bool; 2],
}

impl<const D: usize> Start<D> {
    /// Keeps the pressure at the start of the step, unless that was done in this step, and returns it;
    /// `pressure` is then to be set from it.
    fn set_pressure_aside(&mut self, pressure: &mut Field<D>) -> Option<&Field<D>> {
        if std::mem::replace(&mut self.advanced[1], true) {
            return None;
        }
        std::mem::swap(pressure, &mut self.pressure);
        Some(&self.pressure)
    }
}

/// Adams–Bashforth is used while a step is at most so many times longer than the last.
const LONGEST_GROWTH: f64 = 10.0;

/// A step that ends with a larger Courant number has diverged.
const LARGEST_COURANT: f64 = 3.0;

impl<const D: usize> Projection<D> {
    /// Fluid at rest in a box; `sides[axis]` are its lower and upper side.
    ///
    /// # Errors
    /// [`FlowError`] for sides or fluid properties that make no sense.
    pub fn new(grid: CartesianGrid<D>, sides: [[Side; 2]; D], fluid: Fluid) -> Result<Self, FlowError> {
        per_dimension!(Projection, new_here(grid: CartesianGrid<D>, sides: [[Side; 2]; D], fluid: Fluid) -> Result<Projection<D>, FlowError>)
    }

    fn new_here(grid: CartesianGrid<D>, sides: [[Side; 2]; D], fluid: Fluid) -> Result<Self, FlowError> {
        let state = FlowState::new(grid, sides, fluid)?;
        let grid = &state.grid;
        let field = || std::array::from_fn(|_| Field::zeros(grid));
        let mut flow = Self {
            momentum: Momentum::new(grid, &state.metrics, Convection::Central),
            diffusion: SplitDiffusion::new(fluid.viscosity, wall_stiffness(&state.metrics, grid)),
            implicit: ImplicitDiffusion::new(grid),
            next: field(),
            correction: None,
            tendency: field(),
            sources: Sources::default(),
            pressure_solver: Pressure::new(grid, &state.boundaries, PressureSolver::Auto)?,
            phi: vec![0.0; grid.n_cells()],
            rest_pressure: Vec::new(),
            friction: [Vector::zeros(); 2],
            wall_impulse: Vector::zeros(),
            walls: None,
            start: None,
            state,
        };
        if let Some(rhs) = flow.state.boundaries.given_pressures() {
            flow.rest_pressure = vec![0.0; rhs.len()];
            let n = flow.state.grid.cells()[0];
            let rows = |r: usize, row: &mut [f64]| row.copy_from_slice(&rhs[r * n..(r + 1) * n]);
            flow.pressure_solver.solve_rows(&rows, &mut flow.rest_pressure)?;
        }
        flow.reset_pressure();
        Ok(flow)
    }

    /// The same with another convection scheme than [`Convection::Central`].
    #[must_use]
    pub fn with_convection(mut self, scheme: Convection) -> Self {
        self.momentum = Momentum::new(&self.state.grid, &self.state.metrics, scheme);
        self
    }

    /// The same with viscous terms as told rather than [`Diffusion::Auto`].
    #[must_use]
    pub fn with_diffusion(mut self, diffusion: Diffusion) -> Self {
        self.diffusion.mode = diffusion;
        self
    }

    /// The same with a pressure solver as told rather than [`PressureSolver::Auto`].
    ///
    /// # Errors
    /// [`FlowError::Poisson`] if it cannot serve these sides.
    pub fn with_pressure_solver(mut self, solver: PressureSolver) -> Result<Self, FlowError> {
        per_dimension!(&mut self, Projection, set_pressure_solver(solver: PressureSolver) -> Result<(), FlowError>)?;
        Ok(self)
    }

    fn set_pressure_solver(&mut self, solver: PressureSolver) -> Result<(), FlowError> {
        self.pressure_solver = Pressure::new(&self.state.grid, &self.state.boundaries, solver)?;
        Ok(())
    }

    /// Sets every velocity component to `u(x)[c]` at its nodes \[m/s\], outlets included; walls and inlets keep theirs.
    pub fn set_velocity(&mut self, u: impl Fn([f64; D]) -> [f64; D]) {
        self.state.set_velocity(u);
        // The last tendency and pressure belong to another flow.
        self.state.last_dt = 0.0;
        if let Some(walls) = &mut self.walls {
            walls.projected = false;
        }
    }

    /// First half of a step: the velocity becomes u*, under the body force `force` per mass
    /// \[m/s²\].
    ///
    /// # Errors
    /// [`FlowError::TimeStep`] for a step that is not positive and finite, [`FlowError::Unstable`]
    /// for one beyond the [`viscous_limit`](Self::viscous_limit) of [`Diffusion::Explicit`], [`FlowError::MassBalance`] if
    /// what enters cannot leave.
    pub fn predict(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        per_dimension!(self, Projection, predict_here(dt: f64, force: [f64; D]) -> Result<(), FlowError>)
    }

    fn predict_here(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        if self.sources.start() {
            self.reset_outlet_diffusion();
        }
        let implicit = self.choose_implicit(dt)?;
        // The fields hold the old values in their ghosts.
        self.state.boundaries.advance(&self.state.metrics, self.state.time + dt)?;
        // The last step's tendency and pressure are no guide at the start, and after a much shorter step:
        // what changes at once (a wall set moving, an immersed body's slip) is a pressure ∝ 1/dt.
        let mut r = dt / self.state.last_dt;
        if self.state.step == 0 {
            r = 0.0;
        } else if r > LONGEST_GROWTH {
            r = 0.0;
            self.reset_pressure();
        } else if implicit != self.diffusion.last {
            // The last tendency holds other terms.
            r = 0.0;
        }
        self.diffusion.last = implicit;
        let weights = [1.0 + 0.5 * r, -0.5 * r];
        let viscosity = self.diffusion.parts(implicit);
        let any_implicit = implicit.contains(&true);
        let [friction, viscous] = self.side_fluxes(viscosity);
        self.friction = [friction, self.friction[0]];
        let density = self.state.fluid.density;
        self.wall_impulse =
            dt * density * (weights[0] * self.friction[0] + weights[1] * self.friction[1] + 0.5 * viscous);
        let FlowState { grid, metrics, boundaries, fluid, velocity, pressure, .. } = &mut self.state;
        let velocity = &mut velocity.components;
        if let Some(start) = &mut self.start {
            std::mem::swap(&mut self.tendency, &mut start.tendency);
            start.advanced[0] = true;
        }
        for c in 0..D {
            let last = self.start.as_ref().map(|start| &start.tendency[c]);
            let k = Advance {
                dt,
                weights,
                explicit: viscosity[0],
                implicit: viscosity[1],
                specific_volume: 1.0 / density,
                force: force[c],
            };
            self.momentum.advance(c, k, velocity, pressure, &mut self.next[c], (&mut self.tendency[c], last));
        }
        self.sources.act(density, dt, weights);
        if let Some(sources) = self.sources.take() {
            for (c, source) in sources.iter().enumerate() {
                kernels::change(grid, weights[0] * dt, source, &mut self.next[c]);
                kernels::change(grid, 1.0, source, &mut self.tendency[c]);
            }
        }
        if any_implicit {
            self.implicit.set(metrics, viscosity[1].map(|nu| 0.5 * dt * nu));
            for (c, (u, next)) in velocity.iter().zip(&mut self.next).enumerate() {
                kernels::change(grid, -1.0, u, next);
                self.implicit.solve(c, metrics, boundaries, next);
                kernels::change(grid, 1.0, u, next);
            }
        }
        if let Some(walls) = &mut self.walls {
            let step = Step { dt, weights, viscosity: fluid.viscosity, density };
            walls.hold(step, velocity, &mut self.next);
        }
        std::mem::swap(velocity, &mut self.next);
        boundaries.advance_outlets(metrics, velocity, dt, fluid.viscosity)?;
        boundaries.advance_excess(OutletStep {
            metrics,
            velocity: &self.next,
            pressure,
            fluid: *fluid,
            inverse_step: dt.recip(),
            relaxation: [0.0; 2],
        });
        boundaries.apply_excess(velocity);
        self.state.last_dt = dt;
        self.state.fill_velocity();
        if any_implicit {
            let [_, viscous] = self.side_fluxes(viscosity);
            self.wall_impulse += 0.5 * dt * density * viscous;
        }
        Ok(())
    }

    /// The pressure at rest: zero, or harmonic between the given ones.
    fn reset_pressure(&mut self) {
        let FlowState { grid, pressure, .. } = &mut self.state;
        if let Some(start) = &mut self.start {
            start.set_pressure_aside(pressure);
        }
        if self.rest_pressure.is_empty() {
            pressure.data_mut().fill(0.0);
        } else {
            kernels::copy_dense(grid, &self.rest_pressure, pressure);
        }
        self.state.fill_pressure();
    }

    fn side_fluxes(&self, [explicit, implicit]: [[f64; D]; 2]) -> [Vector; 2] {
        let FlowState { grid, metrics, velocity, .. } = &self.state;
        walls::friction(&self.momentum, metrics, grid, [&velocity.components; 2], explicit, implicit)
    }

    /// The axes whose diffusion has to be implicit in a step of `dt`; an eddy viscosity is explicit in any case.
    pub(crate) fn choose_implicit(&self, dt: f64) -> Result<[bool; D], FlowError> {
        self.state.check_step(dt)?;
        self.diffusion.choose(dt, self.sources.eddy_rate())
    }

    /// Makes the velocity free of divergence and adds what that took to the pressure. May be
    /// called several times within one step, each time with the velocity forced anew.
    ///
    /// # Errors
    /// [`FlowError::Diverged`] when the velocity is not finite.
    pub fn project(&mut self, dt: f64) -> Result<(), FlowError> {
        per_dimension!(self, Projection, project_here(dt: f64) -> Result<(), FlowError>)
    }

    fn project_here(&mut self, dt: f64) -> Result<(), FlowError> {
        let FlowState { metrics, boundaries, velocity, fluid, .. } = &mut self.state;
        boundaries.repeat_outlets(metrics, &velocity.components, dt, fluid.viscosity)?;
        if let Some(walls) = &mut self.walls {
            walls.show_fluxes(&mut self.state.velocity.components);
        }
        self.state.fill_velocity();
        let FlowState { grid, metrics, boundaries, fluid, velocity, pressure, .. } = &mut self.state;
        let velocity = &mut velocity.components;
        let scale = fluid.density / dt;
        let solved = {
            let divergence = kernels::divergence(grid, metrics, velocity, scale);
            match &mut self.walls {
                None => self.pressure_solver.solve_rows(&divergence, &mut self.phi),
                Some(walls) => walls.pressure.solve(&mut self.pressure_solver, &divergence, &mut self.phi),
            }
        };
        if let Some(walls) = &mut self.walls {
            walls.show_nodes(velocity);
        }
        match solved {
            Err(PoissonError::NonFinite { .. }) => return Err(self.state.diverged(dt)),
            other => other?,
        }
        let answer = dt / fluid.density;
        for (c, component) in velocity.iter_mut().enumerate() {
            kernels::correct_component(grid, metrics, c, Conductance::Same(answer), &self.phi, component);
        }
        boundaries.correct(answer, &self.phi);
        match self.start.as_deref_mut().and_then(|start| start.set_pressure_aside(pressure)) {
            Some(before) => kernels::sum_dense(grid, &self.phi, before, pressure),
            None => kernels::add_dense(grid, &self.phi, pressure),
        }
        if let Some(walls) = &mut self.walls {
            walls.project(answer, &self.phi);
            walls.hold_solid(fluid.density, velocity);
            walls.pressure.smooth_orphans(pressure);
        }
        let implicit = self.diffusion.last;
        if implicit.contains(&true) {
            let [_, nu] = self.diffusion.parts(implicit);
            let phi = self.correction.get_or_insert_with(|| Field::zeros(grid));
            kernels::copy_dense(grid, &self.phi, phi);
            boundaries.fill_correction(phi);
            kernels::subtract_second_differences(grid, metrics, nu.map(|nu| 0.5 * dt * nu), phi, pressure);
        }
        self.state.fill_pressure();
        self.state.fill_velocity();
        Ok(())
    }

    /// Ends a step: the time moves on by `dt`.
    ///
    /// # Errors
    /// [`FlowError::Diverged`] when the velocity is not finite, or so large that this step would have carried it over
    /// more than three cells.
    pub fn finish(&mut self, dt: f64) -> Result<(), FlowError> {
        per_dimension!(self, Projection, finish_here(dt: f64) -> Result<(), FlowError>)
    }

    fn finish_here(&mut self, dt: f64) -> Result<(), FlowError> {
        self.state.boundaries.keep_outlets();
        self.state.measure_rates();
        let courant = self.courant(dt);
        if courant.is_nan() || courant > LARGEST_COURANT {
            return Err(self.state.diverged(dt));
        }
        let FlowState { grid, metrics, pressure, .. } = &self.state;
        self.wall_impulse += dt * walls::thrust(grid, metrics, pressure);
        self.state.tick(dt);
        Ok(())
    }

    /// One whole step of length `dt` under the body force `force` per mass \[m/s²\].
    ///
    /// # Errors
    /// See [`predict`](Self::predict) and [`project`](Self::project).
    pub fn advance(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        self.predict(dt, force)?;
        self.project(dt)?;
        self.finish(dt)
    }

    /// The longest step \[s\] for which Adams–Bashforth diffusion is stable along all axes: 1/(4ν Σ 1/h²) on a uniform periodic
    /// grid, 13 % less between walls (a quarter less if fewer than ten cells are).
    pub fn viscous_limit(&self) -> f64 {
        self.diffusion.limit(self.sources.eddy_rate(), &[false; D])
    }

    /// The axes along which viscous terms were implicit (Crank–Nicolson) in the last predictor.
    pub fn implicit_axes(&self) -> [bool; D] {
        self.diffusion.last
    }

    /// The longest step \[s\] with Courant number ≤ `courant`; a tenth inside the viscous limit where diffusion is
    /// explicit, at most ten times that limit where it may be implicit.
    pub fn stable_dt(&self, courant: f64) -> f64 {
        (courant / self.courant(1.0)).min(self.diffusion.longest_step(self.sources.eddy_rate()))
    }

    show_state!();
    show_clock!();

    /// Component `c` of the velocity at the start of the last step \[m/s\].
    pub fn before(&self, c: usize) -> &Field<D> {
        &self.next[c]
    }
    /// Impulse of the bounded sides on the fluid during the last step \[N s\].
    pub fn wall_impulse(&self) -> Vector {
        self.wall_impulse
    }
    /// Which pressure solver works here, and why: a sentence.
    pub fn pressure_solver(&self) -> &str {
        self.pressure_solver.reason()
    }
    /// What the last pressure solution told: iterations, residual.
    pub fn pressure_info(&self) -> PoissonInfo {
        let info = self.pressure_solver.info();
        match &self.walls {
            Some(walls) => PoissonInfo { iterations: walls.pressure.iterations, ..info },
            None => info,
        }
    }
    /// Net outflow \[m³/s\] that the outlets, or without any the inlets, were shifted by in the last step, so that what
    /// enters leaves.
    pub fn imbalance(&self) -> f64 {
        self.state.boundaries.imbalance
    }
}

/// The stiffness of viscous terms along each axis. At a wall the parabolic ghost raises the largest eigenvalue from 4/h² to
/// (2 + r + 1/r)/h², r = √12 − 3.
fn wall_stiffness<const D: usize>(metrics: &Metrics<D>, grid: &CartesianGrid<D>) -> [f64; D] {
    std::array::from_fn(|a| {
        let (axis, n) = (&metrics.axes[a], grid.cells()[a]);
        let inside = stiffness(&axis.centres, n).max(stiffness(&axis.faces, n));
        let r = 12.0_f64.sqrt() - 3.0;
        match (metrics.periodic[a], n) {
            (true, _) => inside,
            // The two walls meet.
            (false, ..10) => inside * 4.0 / 3.0,
            (false, _) => inside * 0.25 * (2.0 + r + 1.0 / r),
        }
    })
}
