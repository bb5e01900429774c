//! The unsteady segregated algorithm.
mod checkpoint;
mod params;
#[cfg(test)]
mod tests;

pub use params::{Forcing, PisoParams, TimeScheme};

use crate::boundary::Boundaries;
use crate::kernels;
use crate::linear::StencilMatrix;
use crate::metrics::Metrics;
use crate::momentum_matrix::{self as momentum, Equation, Implicit, MomentumEquations, MomentumSolver};
use crate::poisson::PoissonError;
use crate::projection::check_fluid;
use crate::simple::PressureCorrection;
use crate::statistics::{self, Measure};
use crate::{CartesianGrid, Convection, Field, FlowError, FlowStatistics, Fluid, Side, Sides, Velocity};

/// A step may be at most so many times longer than the last for BDF2 to look back: it is stable up to 1 + √2.
const LONGEST_RATIO: f64 = 2.4;
/// By how much steps may grow.
const GROWTH: f64 = 2.0;
/// Iterations of a linear solver.
const ITERATIONS: usize = 100;

/// Incompressible flow by PISO (Issa 1986) on a staggered grid, for steps of any Courant number:
///
/// ```text
/// A δ = −(w₀ û + w₁ uⁿ + w₂ uⁿ⁻¹) − ∇·(û⊗û) + ν∇²û − ∇pⁿ/ρ + f,   u* = û + δ          (predictor)
/// ∇·(A_P⁻¹ ∇φ) = ∇·u*,   u** = u* − A_P⁻¹ ∇φ,   p ← p + ρ φ                            (first correction)
/// ∇·(A_P⁻¹ ∇φ) = ∇·ũ,    ũ = u** + A_P⁻¹ H(u** − u*), …                                (further ones)
/// ```
///
/// A = A_P − H is the implicit operator: time derivative, viscous terms and convection (central, or upwind with the rest
/// of the [`Convection`] scheme in the right-hand side), carried by û = uⁿ (Euler) or by its extrapolation to the
/// end of the step (BDF2). The pressure is that of the end of the step.
/// The parts of a step are public: [`predict`](Self::predict), [`correct`](Self::correct) (several
/// times) and [`finish`](Self::finish); [`advance`](Self::advance) is all of them, with a [`Forcing`] between. Outlets
/// of given pressure are those of [`Simple`](crate::Simple).
///
/// ```
/// use fv_mesh::{CartesianGrid, Fluid, Piso, Side};
/// // A lid set moving; steps at Courant number 2.
/// let grid = CartesianGrid::new([16, 16], [1.0, 1.0])?;
/// let sides = [Side::WALL.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]];
/// let mut flow = Piso::new(grid, sides, Fluid { density: 1.0, viscosity: 0.01 })?;
/// for _ in 0..10 {
///     flow.advance(flow.stable_dt(2.0).min(0.1), [0.0; 2], &mut ())?;
/// }
/// assert!(flow.statistics().divergence < 1e-5);
/// # Ok::<(), fv_mesh::FlowError>(())
/// ```
pub struct Piso<const D: usize> {
    grid: CartesianGrid<D>,
    metrics: Metrics<D>,
    boundaries: Boundaries<D>,
    fluid: Fluid,
    params: PisoParams,
    equations: MomentumEquations<D>,
    matrices: [StencilMatrix<D>; D],
    correction: PressureCorrection<D>,
    measure: Measure<D>,
    velocity: Velocity<D>,
    /// Of the last step and of the one before it; at the start of a step `old` is uⁿ⁻¹.
    old: [Field<D>; D],
    older: [Field<D>; D],
    /// Before the last correction.
    last: [Field<D>; D],
    pressure: Field<D>,
    delta: [Vec<f64>; D],
    zeros: Vec<f64>,
    eddy: Option<Field<D>>,
    /// Dense number, storage index and velocity of the nodes where it is imposed.
    imposed: [Vec<(usize, usize, f64)>; D],
    /// Corrections made in this step.
    corrections: usize,
    time: f64,
    step: u64,
    last_dt: f64,
    /// Largest |u_c|/h_c \[1/s\].
    rates: [f64; D],
}

impl<const D: usize> Piso<D> {
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
        let params = PisoParams::default();
        let n = grid.n_cells();
        let matrix = StencilMatrix::new(grid.cells(), metrics.periodic)?;
        let fields = || std::array::from_fn(|_| Field::zeros(&grid));
        let solver = MomentumSolver::new(n, params.momentum_tolerance, ITERATIONS);
        let mut flow = Self {
            equations: MomentumEquations::new(&grid, &metrics, fluid, solver, Implicit::Central),
            matrices: std::array::from_fn(|_| matrix.clone()),
            correction: PressureCorrection::new(
                &grid,
                &metrics,
                &boundaries,
                params.pressure_tolerance,
                ITERATIONS,
            )?,
            measure: Measure::new(&grid, &metrics),
            velocity,
            old: fields(),
            older: fields(),
            last: fields(),
            pressure: Field::zeros(&grid),
            delta: std::array::from_fn(|_| vec![0.0; n]),
            zeros: vec![0.0; n],
            eddy: None,
            imposed: std::array::from_fn(|_| Vec::new()),
            corrections: 0,
            time: 0.0,
            step: 0,
            last_dt: 0.0,
            rates: [0.0; D],
            params,
            grid,
            metrics,
            boundaries,
            fluid,
        };
        flow.fill_velocity();
        flow.boundaries.fill_pressure(&mut flow.pressure);
        Ok(flow)
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
    pub fn with_params(mut self, params: PisoParams) -> Result<Self, FlowError> {
        params.check()?;
        self.equations.solver =
            MomentumSolver::new(self.grid.n_cells(), params.momentum_tolerance, ITERATIONS);
        let tolerance = params.pressure_tolerance;
        self.correction =
            PressureCorrection::new(&self.grid, &self.metrics, &self.boundaries, tolerance, ITERATIONS)?;
        self.params = params;
        Ok(self)
    }

    /// Sets every velocity component to `u(x)[c]` at its nodes \[m/s\], outlets included; walls and inlets keep theirs.
    pub fn set_velocity(&mut self, u: impl Fn([f64; D]) -> [f64; D]) {
        momentum::set_velocity(&self.grid, &self.metrics, &mut self.velocity, &u);
        self.boundaries.start(&self.metrics, u);
        self.fill_velocity();
        self.rates = self.measure_rates();
    }

    /// Sets the kinematic eddy viscosity ν_t \[m²/s\] at the cell centres; `None` takes it away. Ghost values are used as
    /// they are: half the sum of a ghost and the cell inside is ν_t on the side.
    pub fn set_eddy_viscosity(&mut self, eddy: Option<&Field<D>>) {
        match (&mut self.eddy, eddy) {
            (Some(own), Some(eddy)) => own.data_mut().copy_from_slice(eddy.data()),
            (own, eddy) => *own = eddy.cloned(),
        }
    }

    /// Imposes the velocity at some nodes in the predictors to come, inside bodies for instance: component, storage index in
    /// [`Field::data`] and value \[m/s\]. The force that this takes acts within the implicit momentum equations, so the
    /// fluid around feels it whatever the step; pressure corrections act on these nodes as on others. What was
    /// imposed before is free again.
    ///
    /// # Errors
    /// [`FlowError::Parameter`] for a component, index or value that makes no sense.
    pub fn impose(&mut self, nodes: impl IntoIterator<Item = (usize, usize, f64)>) -> Result<(), FlowError> {
        self.imposed.iter_mut().for_each(Vec::clear);
        for (c, index, value) in nodes {
            let cell = momentum::check_node(&self.grid, c, index, value)?;
            self.imposed[c].push((cell, index, value));
        }
        Ok(())
    }

    /// First part of a step: the velocity becomes u*, under the body force `force` per mass \[m/s²\].
    ///
    /// # Errors
    /// [`FlowError::TimeStep`] for a step that is not positive and finite, [`FlowError::MassBalance`] if
    /// what enters cannot leave, [`FlowError::Diverged`] when the velocity is not finite.
    pub fn predict(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        if !(dt.is_finite() && dt > 0.0) {
            return Err(FlowError::TimeStep { dt, time: self.time });
        }
        let mut r = if self.step > 0 { dt / self.last_dt } else { 0.0 };
        if r > LONGEST_RATIO || self.params.time_scheme == TimeScheme::Euler {
            r = 0.0;
        }
        let weights = [(1.0 + 2.0 * r) / (1.0 + r), -(1.0 + r), r * r / (1.0 + r)].map(|w| w / dt);
        std::mem::swap(&mut self.old, &mut self.older);
        for c in 0..D {
            let u = self.velocity.components[c].data_mut();
            let (old, older) = (self.old[c].data_mut(), self.older[c].data());
            old.copy_from_slice(u);
            if r > 0.0 {
                u.iter_mut().zip(older).for_each(|(u, older)| *u += r * (*u - older));
            }
        }
        self.boundaries.advance(&self.metrics, self.time + dt)?;
        self.fill_velocity();
        for c in 0..D {
            let equation = Equation {
                velocity: &self.velocity.components,
                pressure: &self.pressure,
                history: [&self.old[c], &self.older[c]],
                weights,
                force: force[c],
                relaxation: 1.0,
                viscous_share: 0.0,
                eddy: self.eddy.as_ref(),
            };
            let matrix = &mut self.matrices[c];
            let [terms, _] = self.equations.make(c, equation, &self.boundaries, matrix);
            if !terms.is_finite() {
                return Err(self.diverged(dt));
            }
            for &(cell, index, value) in &self.imposed[c] {
                let change = value - self.velocity.components[c].data()[index];
                momentum::pin(matrix, cell, change, &mut self.equations.rhs);
            }
            self.equations.solver.solve(matrix, &self.equations.rhs, &mut self.delta[c])?;
            self.correction.set(c, matrix, None, 1.0 / weights[0]);
        }
        for (u, delta) in self.velocity.components.iter_mut().zip(&self.delta) {
            kernels::add_dense(&self.grid, delta, u);
        }
        self.boundaries.advance_outlets(
            &self.metrics,
            &self.velocity.components,
            dt,
            self.fluid.viscosity,
        )?;
        self.boundaries.reset_outlets(&self.velocity.components);
        self.correction.update(&mut self.boundaries, self.fluid.viscosity)?;
        self.fill_velocity();
        self.corrections = 0;
        self.last_dt = dt;
        Ok(())
    }

    /// A pressure correction: makes the velocity free of divergence. The velocity may be changed before each, by an
    /// immersed body for instance.
    ///
    /// # Errors
    /// [`FlowError::Diverged`] when the velocity is not finite; [`FlowError::Poisson`] if the pressure equation could not
    /// be solved to its tolerance.
    pub fn correct(&mut self, dt: f64) -> Result<(), FlowError> {
        for c in 0..D {
            let (u, last) = (&mut self.velocity.components[c], &mut self.last[c]);
            if self.corrections > 0 {
                momentum::difference(u, last, &mut self.delta[c]);
            }
            last.data_mut().copy_from_slice(u.data());
            if self.corrections > 0 {
                let (matrix, h) = (&self.matrices[c], &mut self.equations.rhs);
                matrix.h(&self.zeros, &self.delta[c], h)?;
                h.iter_mut().zip(matrix.centre()).for_each(|(h, centre)| *h /= centre);
                kernels::add_dense(&self.grid, h, u);
            }
        }
        self.boundaries.reset_outlets(&self.velocity.components);
        self.fill_velocity();
        self.correction.measure(
            &mut self.boundaries,
            &self.velocity.components,
            &self.pressure,
            self.fluid.density,
        );
        match self.correction.solve(true) {
            Err(PoissonError::NonFinite { .. }) => return Err(self.diverged(dt)),
            other => other?,
        };
        self.correction.correct(&mut self.boundaries, &mut self.velocity.components);
        let density = self.fluid.density;
        self.correction.phi.iter_mut().for_each(|phi| *phi *= density);
        kernels::add_dense(&self.grid, &self.correction.phi, &mut self.pressure);
        self.boundaries.fill_pressure(&mut self.pressure);
        self.fill_velocity();
        self.corrections += 1;
        Ok(())
    }

    /// Ends a step: the time moves on by `dt`.
    ///
    /// # Errors
    /// [`FlowError::Diverged`] when the velocity is not finite.
    pub fn finish(&mut self, dt: f64) -> Result<(), FlowError> {
        self.rates = self.measure_rates();
        if self.rates.iter().any(|u: &f64| !u.is_finite()) {
            return Err(self.diverged(dt));
        }
        self.time += dt;
        self.step += 1;
        Ok(())
    }

    /// One whole step of length `dt` under the body force `force` per mass \[m/s²\]. `forcing` acts after the predictor and
    /// after every correction but the last, which leaves the velocity free of divergence; `&mut ()` is none.
    ///
    /// # Errors
    /// See [`predict`](Self::predict) and [`correct`](Self::correct).
    pub fn advance(
        &mut self,
        dt: f64,
        force: [f64; D],
        forcing: &mut impl Forcing<D>,
    ) -> Result<(), FlowError> {
        self.predict(dt, force)?;
        for _ in 0..self.params.correctors {
            forcing.force(&mut self.velocity, self.time + dt, dt);
            self.correct(dt)?;
        }
        self.finish(dt)
    }

    fn fill_velocity(&mut self) {
        for c in 0..D {
            self.boundaries.fill_velocity(c, &mut self.velocity.components[c]);
        }
    }

    fn measure_rates(&self) -> [f64; D] {
        let u = &self.velocity.components;
        std::array::from_fn(|c| statistics::largest_rate(&self.grid, &self.metrics, c, &u[c]))
    }

    fn diverged(&self, dt: f64) -> FlowError {
        let cell = statistics::worst_cell(&self.velocity.components);
        FlowError::Diverged { step: self.step, time: self.time, dt, courant: self.courant(dt), cell }
    }

    /// Courant number dt Σ_a max(|u_a|/h_a) of a step of length `dt`.
    pub fn courant(&self, dt: f64) -> f64 {
        dt * self.rates.iter().sum::<f64>()
    }

    /// The longest step \[s\] with Courant number ≤ `courant`, which may be above 1, at most twice the last step. Infinite
    /// for the first step of a fluid at rest.
    pub fn stable_dt(&self, courant: f64) -> f64 {
        let growth = if self.step > 0 { GROWTH * self.last_dt } else { f64::INFINITY };
        (courant / self.courant(1.0)).min(growth)
    }

    /// Sums and extremes of the velocity, as it is now.
    pub fn statistics(&mut self) -> FlowStatistics {
        let fluid = [self.fluid.density, self.fluid.viscosity];
        let scratch = &mut self.equations.rhs;
        self.measure.of(&self.grid, &self.metrics, &self.velocity.components, fluid, scratch)
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
    /// The velocity \[m/s\]; between the parts of a step it is u*.
    pub fn velocity(&self) -> &Velocity<D> {
        &self.velocity
    }
    /// The velocity, for an immersed boundary to change between the parts of a step.
    pub fn velocity_mut(&mut self) -> &mut Velocity<D> {
        &mut self.velocity
    }
    /// The pressure at the cell centres \[Pa\], without the hydrostatic part.
    pub fn pressure(&self) -> &Field<D> {
        &self.pressure
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
}
