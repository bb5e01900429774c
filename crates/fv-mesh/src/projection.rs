//! The flow algorithm for time-accurate runs.
use crate::boundary::Boundaries;
use crate::grid::GHOSTS;
use crate::implicit::ImplicitDiffusion;
use crate::kernels::{self, Advance, Momentum};
use crate::metrics::{Metrics, NodeMetrics};
use crate::poisson::PoissonInfo;
use crate::pressure::{Pressure, PressureSolver};
use crate::statistics::{self, Measure};
use crate::{CartesianGrid, Convection, Field, FlowError, FlowStatistics, Side, Sides, Velocity, walls};
use interfaces::{Checkpoint, RestartError, Vector};

/// A Newtonian fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluid {
    /// Density ρ \[kg/m³\].
    pub density: f64,
    /// Kinematic viscosity ν \[m²/s\].
    pub viscosity: f64,
}

/// An inviscid fluid is allowed; one without mass is not.
pub(crate) fn check_fluid(fluid: Fluid) -> Result<(), FlowError> {
    for (name, value, unit) in
        [("density", fluid.density, "kg/m³"), ("kinematic viscosity", fluid.viscosity, "m²/s")]
    {
        if !(value.is_finite() && (value > 0.0 || value == 0.0 && unit == "m²/s")) {
            return Err(FlowError::Fluid { name, value, unit });
        }
    }
    Ok(())
}

/// How viscous terms are advanced in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Diffusion {
    /// Explicit along the axes where the step allows it, implicit along the others.
    #[default]
    Auto,
    /// Explicit along all axes: the step has to stay within the viscous limit.
    Explicit,
    /// Implicit along all axes.
    Implicit,
}

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
/// runs inside a rayon pool, unless implicit diffusion meets a new step length. After an error in the middle of a step the
/// state is that of half a step: restore a saved one.
pub struct Projection<const D: usize> {
    grid: CartesianGrid<D>,
    metrics: Metrics<D>,
    boundaries: Boundaries<D>,
    momentum: Momentum<D>,
    implicit: ImplicitDiffusion<D>,
    measure: Measure<D>,
    fluid: Fluid,
    diffusion: Diffusion,
    /// The axes whose diffusion was implicit in the last step.
    implicit_axes: [bool; D],
    velocity: Velocity<D>,
    next: [Field<D>; D],
    tendency: [Field<D>; D],
    pressure: Field<D>,
    phi: Vec<f64>,
    /// The pressure at rest where some is given (dense), else empty.
    rest_pressure: Vec<f64>,
    /// Accelerations that vary in space, for the next predictor step; made when first needed.
    sources: Option<Box<[Field<D>; D]>>,
    sources_given: bool,
    /// The largest ν_t of the last step with a closure \[m²/s\].
    eddy_most: f64,
    /// ν_t with ghosts; made when first needed.
    eddy: Option<Box<Field<D>>>,
    /// Scratch of one row.
    row: Vec<f64>,
    pressure_solver: Pressure<D>,
    time: f64,
    step: u64,
    last_dt: f64,
    /// Largest |u_c|/h_c \[1/s\].
    rates: [f64; D],
    /// Half the largest sum of coefficients of the second difference along each axis \[1/m²\].
    stiffness: [f64; D],
    /// What the sides did at the last two predictor steps, per time, and their impulse in the last step.
    friction: [Vector; 2],
    wall_impulse: Vector,
}

/// Adams–Bashforth is used while a step is at most so many times longer than the last.
const LONGEST_GROWTH: f64 = 10.0;

/// A step that ends with a larger Courant number has diverged.
const LARGEST_COURANT: f64 = 3.0;

/// Implicit steps are at most so many times the explicit limit, for the sake of accuracy.
const IMPLICIT_GAIN: f64 = 10.0;

impl<const D: usize> Projection<D> {
    /// Fluid at rest in a box; `sides[axis]` are its lower and upper side.
    ///
    /// # Errors
    /// [`FlowError`] for sides or fluid properties that make no sense.
    pub fn new(grid: CartesianGrid<D>, sides: [[Side; 2]; D], fluid: Fluid) -> Result<Self, FlowError> {
        let sides = Sides::new(sides)?;
        check_fluid(fluid)?;
        let metrics = Metrics::new(&grid, std::array::from_fn(|a| sides.periodic(a)));
        let velocity = Velocity::zeros(&grid, &sides);
        let boundaries = Boundaries::new(&grid, sides, &metrics)?;
        let pressure_solver = Pressure::new(&grid, &boundaries, PressureSolver::Auto)?;
        let stiffness = std::array::from_fn(|a| stiffness(&metrics, a));
        let field = || std::array::from_fn(|_| Field::zeros(&grid));
        let mut flow = Self {
            momentum: Momentum::new(&grid, &metrics, Convection::Central),
            implicit: ImplicitDiffusion::new(&grid),
            measure: Measure::new(&grid, &metrics),
            velocity,
            next: field(),
            tendency: field(),
            pressure: Field::zeros(&grid),
            phi: vec![0.0; grid.n_cells()],
            rest_pressure: Vec::new(),
            sources: None,
            sources_given: false,
            eddy_most: 0.0,
            eddy: None,
            row: vec![0.0; grid.cells()[0]],
            pressure_solver,
            diffusion: Diffusion::Auto,
            implicit_axes: [false; D],
            time: 0.0,
            step: 0,
            last_dt: 0.0,
            rates: [0.0; D],
            stiffness,
            friction: [Vector::zeros(); 2],
            wall_impulse: Vector::zeros(),
            grid,
            metrics,
            boundaries,
            fluid,
        };
        flow.fill_velocity();
        if let Some(rhs) = flow.boundaries.given_pressures() {
            flow.rest_pressure = vec![0.0; rhs.len()];
            let n = flow.grid.cells()[0];
            let rows = |r: usize, row: &mut [f64]| row.copy_from_slice(&rhs[r * n..(r + 1) * n]);
            flow.pressure_solver.solve_rows(rows, &mut flow.rest_pressure)?;
        }
        flow.reset_pressure();
        flow.rates = flow.measure_rates();
        Ok(flow)
    }

    /// The same with another convection scheme than [`Convection::Central`].
    #[must_use]
    pub fn with_convection(mut self, scheme: Convection) -> Self {
        self.momentum = Momentum::new(&self.grid, &self.metrics, scheme);
        self
    }

    /// The same with viscous terms as told rather than [`Diffusion::Auto`].
    #[must_use]
    pub fn with_diffusion(mut self, diffusion: Diffusion) -> Self {
        self.diffusion = diffusion;
        self
    }

    /// The same with a pressure solver as told rather than [`PressureSolver::Auto`].
    ///
    /// # Errors
    /// [`FlowError::Poisson`] if it cannot serve these sides.
    pub fn with_pressure_solver(mut self, solver: PressureSolver) -> Result<Self, FlowError> {
        self.pressure_solver = Pressure::new(&self.grid, &self.boundaries, solver)?;
        Ok(self)
    }

    /// Sets every velocity component to `u(x)[c]` at its nodes \[m/s\], outlets included; walls and inlets keep theirs.
    pub fn set_velocity(&mut self, u: impl Fn([f64; D]) -> [f64; D]) {
        for c in 0..D {
            let mut component = std::mem::replace(&mut self.velocity.components[c], Field::zeros(&self.grid));
            self.each_node(c, |o, x| component.data_mut()[o] = u(x)[c]);
            self.velocity.components[c] = component;
        }
        self.boundaries.start(&self.metrics, u);
        self.fill_velocity();
        self.rates = self.measure_rates();
        // The last tendency and pressure belong to another flow.
        self.last_dt = 0.0;
    }

    fn measure_rates(&self) -> [f64; D] {
        let given = self.boundaries.rates(&self.metrics);
        let u = &self.velocity.components;
        std::array::from_fn(|c| {
            // Sums keep what is not finite.
            let inside = statistics::largest_rate(&self.grid, &self.metrics, c, &u[c]);
            if inside > given[c] || inside.is_nan() { inside } else { given[c] }
        })
    }

    /// First half of a step: the velocity becomes u*, under the body force `force` per mass
    /// \[m/s²\].
    ///
    /// # Errors
    /// [`FlowError::TimeStep`] for a step that is not positive and finite, [`FlowError::Unstable`]
    /// for one beyond the [`viscous_limit`](Self::viscous_limit) of [`Diffusion::Explicit`], [`FlowError::MassBalance`] if
    /// what enters cannot leave.
    pub fn predict(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        if !self.sources_given {
            self.eddy_most = 0.0;
        }
        let implicit = self.choose_implicit(dt)?;
        // The fields hold the old values in their ghosts.
        self.boundaries.advance(&self.metrics, self.time + dt)?;
        // The last step's tendency and pressure are no guide at the start, and after a much shorter step:
        // what changes at once (a wall set moving, an immersed body's slip) is a pressure ∝ 1/dt.
        let mut r = dt / self.last_dt;
        if self.step == 0 {
            r = 0.0;
        } else if r > LONGEST_GROWTH {
            r = 0.0;
            self.reset_pressure();
        } else if implicit != self.implicit_axes {
            // The last tendency holds other terms.
            r = 0.0;
        }
        self.implicit_axes = implicit;
        let weights = [1.0 + 0.5 * r, -0.5 * r];
        let nu = self.fluid.viscosity;
        let viscosity = [false, true].map(|which| implicit.map(|i| if i == which { nu } else { 0.0 }));
        let any_implicit = implicit.contains(&true);
        let [friction, viscous] = self.side_fluxes(viscosity);
        self.friction = [friction, self.friction[0]];
        self.wall_impulse = dt
            * self.fluid.density
            * (weights[0] * self.friction[0] + weights[1] * self.friction[1] + 0.5 * viscous);
        for c in 0..D {
            let k = Advance {
                dt,
                weights,
                explicit: viscosity[0],
                implicit: viscosity[1],
                specific_volume: 1.0 / self.fluid.density,
                force: force[c],
            };
            self.momentum.advance(
                c,
                k,
                &self.velocity.components,
                &self.pressure,
                &mut self.next[c],
                &mut self.tendency[c],
            );
        }
        if let Some(sources) = self.sources.as_deref().filter(|_| self.sources_given) {
            for c in 0..D {
                kernels::change(&self.grid, weights[0] * dt, &sources[c], &mut self.next[c]);
                kernels::change(&self.grid, 1.0, &sources[c], &mut self.tendency[c]);
            }
        }
        self.sources_given = false;
        if any_implicit {
            self.implicit.set(&self.metrics, viscosity[1].map(|nu| 0.5 * dt * nu));
            for c in 0..D {
                let (u, next) = (&self.velocity.components[c], &mut self.next[c]);
                kernels::change(&self.grid, -1.0, u, next);
                self.implicit.solve(c, &self.metrics, &self.boundaries, next);
                kernels::change(&self.grid, 1.0, u, next);
            }
        }
        for c in 0..D {
            std::mem::swap(&mut self.velocity.components[c], &mut self.next[c]);
        }
        self.boundaries.advance_outlets(&self.metrics, &self.velocity.components, dt, nu)?;
        self.last_dt = dt;
        self.fill_velocity();
        if any_implicit {
            let [_, viscous] = self.side_fluxes(viscosity);
            self.wall_impulse += 0.5 * dt * self.fluid.density * viscous;
        }
        Ok(())
    }

    /// The pressure at rest: zero, or harmonic between the given ones.
    fn reset_pressure(&mut self) {
        if self.rest_pressure.is_empty() {
            self.pressure.data_mut().fill(0.0);
        } else {
            kernels::copy_dense(&self.grid, &self.rest_pressure, &mut self.pressure);
        }
        self.boundaries.fill_pressure(&mut self.pressure);
    }

    /// Lets `f` add accelerations that vary in space \[m/s²\] for the next predictor step.
    pub(crate) fn with_sources(&mut self, f: impl FnOnce(&Self, &mut [Field<D>; D])) {
        let zeros = || Box::new(std::array::from_fn(|_| Field::zeros(&self.grid)));
        let mut sources = self.sources.take().unwrap_or_else(zeros);
        if !self.sources_given {
            sources.iter_mut().for_each(|s| s.data_mut().fill(0.0));
        }
        f(self, &mut sources);
        self.sources = Some(sources);
        self.sources_given = true;
    }

    /// Takes back accelerations that no predictor step used.
    pub(crate) fn forget_sources(&mut self) {
        (self.sources_given, self.eddy_most) = (false, 0.0);
    }

    /// Adds ∇·[ν_t(∇u + ∇uᵀ)] of the eddy viscosity ν_t \[m²/s\] (dense) to the next predictor step of `dt`.
    pub(crate) fn add_eddy_stress(&mut self, eddy: &[f64], dt: f64) -> Result<(), FlowError> {
        let n = self.grid.n_cells();
        if eddy.len() != n {
            let source =
                interfaces::SolveError::Length { what: "the eddy viscosity", expected: n, found: eddy.len() };
            return Err(FlowError::Closure { time: self.time, source });
        }
        self.eddy_most = eddy.iter().copied().fold(0.0, f64::max);
        self.choose_implicit(dt)?;
        let mut field = self.eddy.take().unwrap_or_else(|| Box::new(Field::zeros(&self.grid)));
        kernels::copy_dense(&self.grid, eddy, &mut field);
        self.boundaries.fill_even(&mut field);
        self.with_sources(|flow, sources| {
            for (c, source) in sources.iter_mut().enumerate() {
                let u = &flow.velocity.components;
                kernels::add_eddy_stress(&flow.grid, &flow.metrics, c, u, &field, source);
            }
        });
        self.eddy = Some(field);
        Ok(())
    }

    /// Calls `f` with the storage index and the place of every node of component `c` (those on bounded sides too).
    pub(crate) fn each_node(&self, c: usize, mut f: impl FnMut(usize, [f64; D])) {
        self.each_cell(|o, cell| {
            f(o, std::array::from_fn(|a| self.metrics.of(Some(c), a).x[GHOSTS + cell[a]]))
        });
    }

    /// Calls `f` with the storage index and the place of every cell.
    pub(crate) fn each_cell(&self, mut f: impl FnMut(usize, [usize; D])) {
        let (base, s) = (self.grid.base(), self.grid.stride());
        for cell in (0..self.grid.n_cells()).map(|i| self.grid.cell(i)) {
            f(base + (0..D).map(|a| cell[a] * s[a]).sum::<usize>(), cell);
        }
    }

    /// Parts of the distance between the centres beside every lower face along axis `a` that lie below and above it.
    pub(crate) fn shares(&self, a: usize) -> [&[f64]; 2] {
        self.metrics.axes[a].share.each_ref().map(|s| &s[GHOSTS..])
    }

    fn side_fluxes(&self, [explicit, implicit]: [[f64; D]; 2]) -> [Vector; 2] {
        let u = &self.velocity.components;
        walls::friction(&self.momentum, &self.metrics, &self.grid, u, explicit, implicit)
    }

    /// The axes whose diffusion has to be implicit in a step of `dt`.
    pub(crate) fn choose_implicit(&self, dt: f64) -> Result<[bool; D], FlowError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(FlowError::TimeStep { dt, time: self.time });
        }
        let chosen = match self.diffusion {
            Diffusion::Implicit => [true; D],
            Diffusion::Explicit => [false; D],
            Diffusion::Auto => {
                // Not to and fro with small changes of the step.
                let (needed, soon) = (self.stiff_axes(dt), self.stiff_axes(2.0 * dt));
                let last = self.implicit_axes;
                let keep = (0..D).all(|a| (last[a] || !needed[a]) && (soon[a] || !last[a]));
                if keep { last } else { needed }
            }
        };
        // An eddy viscosity is explicit in any case.
        let limit = self.viscous_limit_along(&chosen);
        if dt > limit { Err(FlowError::Unstable { dt, limit }) } else { Ok(chosen) }
    }

    /// The fewest axes that have to be implicit for the others to be stable with a step of `dt`.
    fn stiff_axes(&self, dt: f64) -> [bool; D] {
        let mut implicit = [false; D];
        while dt > self.viscous_limit_along(&implicit) {
            let stiffest = (0..D)
                .filter(|&a| !implicit[a])
                .min_by(|&a, &b| self.grid.axis(a).narrowest().total_cmp(&self.grid.axis(b).narrowest()));
            let Some(a) = stiffest else { break };
            implicit[a] = true;
        }
        implicit
    }

    fn viscous_limit_along(&self, implicit: &[bool; D]) -> f64 {
        let viscosity = |a: usize| self.eddy_most + if implicit[a] { 0.0 } else { self.fluid.viscosity };
        0.25 / (0..D).map(|a| viscosity(a) * self.stiffness[a]).sum::<f64>()
    }

    /// Makes the velocity free of divergence and adds what that took to the pressure. May be
    /// called several times within one step, each time with the velocity forced anew.
    ///
    /// # Errors
    /// [`FlowError::Diverged`] when the velocity is not finite.
    pub fn project(&mut self, dt: f64) -> Result<(), FlowError> {
        self.fill_velocity();
        let scale = self.fluid.density / dt;
        let (grid, metrics, velocity) = (&self.grid, &self.metrics, &self.velocity.components);
        let solved = self.pressure_solver.solve_rows(
            // Called from code that is compiled for the processor at hand.
            #[inline(always)]
            |r, row: &mut [f64]| kernels::divergence_row(grid, metrics, r, velocity, scale, row),
            &mut self.phi,
        );
        if let Err(error) = solved {
            return Err(match error {
                crate::poisson::PoissonError::NonFinite { .. } => self.diverged(dt),
                other => other.into(),
            });
        }
        for c in 0..D {
            kernels::correct_component(
                &self.grid,
                &self.metrics,
                c,
                dt / self.fluid.density,
                &self.phi,
                &mut self.velocity.components[c],
            );
        }
        self.boundaries.correct(dt / self.fluid.density, &self.phi);
        kernels::add_dense(&self.grid, &self.phi, &mut self.pressure);
        if self.implicit_axes.contains(&true) {
            let kappa = 0.5 * dt * self.fluid.viscosity;
            let kappa = self.implicit_axes.map(|implicit| if implicit { kappa } else { 0.0 });
            let phi = &mut self.next[0];
            kernels::copy_dense(&self.grid, &self.phi, phi);
            self.boundaries.fill_correction(phi);
            kernels::subtract_second_differences(&self.grid, &self.metrics, kappa, phi, &mut self.pressure);
        }
        self.boundaries.fill_pressure(&mut self.pressure);
        self.fill_velocity();
        Ok(())
    }

    /// Ends a step: the time moves on by `dt`.
    ///
    /// # Errors
    /// [`FlowError::Diverged`] when the velocity is not finite, or so large that this step would have carried it over
    /// more than three cells.
    pub fn finish(&mut self, dt: f64) -> Result<(), FlowError> {
        self.rates = self.measure_rates();
        let courant = self.courant(dt);
        if courant.is_nan() || courant > LARGEST_COURANT {
            return Err(self.diverged(dt));
        }
        self.wall_impulse += dt * walls::thrust(&self.grid, &self.metrics, &self.pressure);
        self.time += dt;
        self.step += 1;
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

    fn fill_velocity(&mut self) {
        for c in 0..D {
            self.boundaries.fill_velocity(c, &mut self.velocity.components[c]);
        }
    }

    fn diverged(&self, dt: f64) -> FlowError {
        let cell = statistics::worst_cell(&self.velocity.components);
        FlowError::Diverged { step: self.step, time: self.time, dt, courant: self.courant(dt), cell }
    }

    /// Courant number dt Σ_a max(|u_a|/h_a) of a step of length `dt`, what moves at the sides included.
    pub fn courant(&self, dt: f64) -> f64 {
        dt * self.rates.iter().sum::<f64>()
    }

    /// The longest step \[s\] for which Adams–Bashforth diffusion is stable along all axes: 1/(4ν Σ 1/h²) on a uniform periodic
    /// grid, 13 % less between walls (a quarter less if fewer than ten cells are).
    pub fn viscous_limit(&self) -> f64 {
        self.viscous_limit_along(&[false; D])
    }

    /// The longest step \[s\] with Courant number ≤ `courant`; a tenth inside the viscous limit where diffusion is
    /// explicit, at most ten times that limit where it may be implicit.
    pub fn stable_dt(&self, courant: f64) -> f64 {
        let viscous = match self.diffusion {
            Diffusion::Explicit => 0.9 * self.viscous_limit(),
            _ => (IMPLICIT_GAIN * self.viscous_limit()).min(0.9 * self.viscous_limit_along(&[true; D])),
        };
        (courant / self.courant(1.0)).min(viscous)
    }

    /// Sums and extremes of the velocity, as it is now.
    pub fn statistics(&mut self) -> FlowStatistics {
        self.measure.of(
            &self.grid,
            &self.metrics,
            &self.velocity.components,
            [self.fluid.density, self.fluid.viscosity],
            &mut self.row,
        )
    }

    /// The grid.
    pub fn grid(&self) -> &CartesianGrid<D> {
        &self.grid
    }
    /// The sides of the box.
    pub fn sides(&self) -> &Sides<D> {
        &self.boundaries.sides
    }
    /// The fluid.
    pub fn fluid(&self) -> Fluid {
        self.fluid
    }
    /// The velocity \[m/s\]; between the halves of a step it is u*.
    pub fn velocity(&self) -> &Velocity<D> {
        &self.velocity
    }
    /// The velocity, for an immersed boundary to change between the halves of a step.
    pub fn velocity_mut(&mut self) -> &mut Velocity<D> {
        &mut self.velocity
    }
    /// The pressure at the cell centres \[Pa\], without the hydrostatic part.
    pub fn pressure(&self) -> &Field<D> {
        &self.pressure
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
        self.pressure_solver.info()
    }
    /// Net outflow \[m³/s\] that the outlets, or without any the inlets, were shifted by in the last step, so that what
    /// enters leaves.
    pub fn imbalance(&self) -> f64 {
        self.boundaries.imbalance
    }
    /// Length of the last step \[s\].
    pub fn last_dt(&self) -> f64 {
        self.last_dt
    }
    /// Time \[s\].
    pub fn time(&self) -> f64 {
        self.time
    }
    /// Steps made.
    pub fn steps(&self) -> u64 {
        self.step
    }
    /// Sets the clock exactly (to the end of an interval that was cut into equal steps).
    pub fn set_time(&mut self, time: f64) {
        self.time = time;
    }
    /// The mean of the velocity component `c` at the two faces of every cell, row after row.
    pub fn centred_velocity(&self, c: usize) -> impl Iterator<Item = f64> + '_ {
        let (n, s) = (self.grid.cells()[0], self.grid.stride()[c]);
        let u = self.velocity.components[c].data();
        (0..self.pressure.n_rows()).flat_map(move |r| {
            let o = self.pressure.row_start(r);
            (o..o + n).map(move |i| 0.5 * (u[i] + u[i + s]))
        })
    }
}

/// Half the largest sum of coefficients of the second difference along axis `a`, 1/h² on a uniform axis. At a wall the
/// parabolic ghost raises the largest eigenvalue from 4/h² to (2 + r + 1/r)/h², r = √12 − 3.
fn stiffness<const D: usize>(metrics: &Metrics<D>, a: usize) -> f64 {
    let axis = &metrics.axes[a];
    let n = axis.width.len() - 2 * GHOSTS;
    let sums = |nodes: &NodeMetrics| {
        (GHOSTS..GHOSTS + n).map(|i| 0.5 * (nodes.up[i] + nodes.down[i])).fold(0.0, f64::max)
    };
    let inside = sums(&axis.centres).max(sums(&axis.faces));
    let r = 12.0_f64.sqrt() - 3.0;
    match (metrics.periodic[a], n) {
        (true, _) => inside,
        // The two walls meet.
        (false, ..10) => inside * 4.0 / 3.0,
        (false, _) => inside * 0.25 * (2.0 + r + 1.0 / r),
    }
}

impl<const D: usize> Checkpoint for Projection<D> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        for c in 0..D {
            sink(&format!("velocity{c}"), self.velocity.components[c].data());
            sink(&format!("tendency{c}"), self.tendency[c].data());
        }
        sink("pressure", self.pressure.data());
        sink("clock", &[self.time, self.step as f64, self.last_dt]);
        sink("rates", &self.rates);
        sink("friction", self.friction[0].as_slice());
        if self.pressure_solver.remembers() {
            sink("correction", &self.phi);
        }
        sink("sides", &self.boundaries.memory());
        sink("implicit", &self.implicit_axes.map(|i| f64::from(u8::from(i))));
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let n = self.grid.storage();
        for c in 0..D {
            let u = RestartError::take(source, &format!("velocity{c}"), n)?;
            self.velocity.components[c].data_mut().copy_from_slice(u);
            let h = RestartError::take(source, &format!("tendency{c}"), n)?;
            self.tendency[c].data_mut().copy_from_slice(h);
        }
        self.pressure.data_mut().copy_from_slice(RestartError::take(source, "pressure", n)?);
        let clock = RestartError::take(source, "clock", 3)?;
        (self.time, self.step, self.last_dt) = (clock[0], clock[1] as u64, clock[2]);
        self.rates.copy_from_slice(RestartError::take(source, "rates", D)?);
        self.friction[0] = Vector::from_column_slice(RestartError::take(source, "friction", 3)?);
        if self.pressure_solver.remembers() {
            let n = self.phi.len();
            self.phi.copy_from_slice(RestartError::take(source, "correction", n)?);
        }
        let sides = RestartError::take(source, "sides", self.boundaries.memory().len())?;
        self.boundaries.recall(sides);
        self.sources_given = false;
        let implicit = RestartError::take(source, "implicit", D)?;
        self.implicit_axes = std::array::from_fn(|a| implicit[a] != 0.0);
        Ok(())
    }
}
