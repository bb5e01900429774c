//! The unsteady segregated algorithm.
mod checkpoint;
mod params;
#[cfg(test)]
mod tests;
mod window;

pub use params::{PisoParams, TimeScheme};

use crate::boundary::OutletStep;
use crate::flow_state::{FlowState, show_clock, show_state};
use crate::kernels;
use crate::linear::StencilMatrix;
use crate::momentum_matrix::{self as momentum, Equation, Implicit, MomentumEquations, MomentumSolver};
use crate::per_dimension::per_dimension;
use crate::poisson::PoissonError;
use crate::simple::PressureCorrection;
use crate::{
    CartesianGrid, Convection, Field, FlowError, FlowStatistics, Fluid, ImmersedForcing, Side, walls,
};
use interfaces::Vector;

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
/// times) and [`finish`](Self::finish); [`advance`](Self::advance) is all of them, with an [`ImmersedForcing`] between. Outlets
/// of given pressure are those of [`Projection`](crate::Projection).
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
    state: FlowState<D>,
    params: PisoParams,
    equations: MomentumEquations<D>,
    matrices: [StencilMatrix<D>; D],
    correction: PressureCorrection<D>,
    /// Of the last step and of the one before it; at the start of a step `old` is uⁿ⁻¹.
    old: [Field<D>; D],
    older: [Field<D>; D],
    /// Before the correction under way.
    last: [Field<D>; D],
    /// What the predictor, then each correction did to the velocity.
    delta: [Vec<f64>; D],
    zeros: Vec<f64>,
    eddy: Option<Field<D>>,
    /// What accelerates the fluid besides.
    source: Option<Box<[Field<D>; D]>>,
    /// Dense number, storage index and velocity of the nodes where it is imposed.
    imposed: [Vec<(usize, usize, f64)>; D],
    /// Corrections made in this step.
    corrections: usize,
    /// w dt of this step.
    weights: [f64; 3],
    /// û, which carries momentum in this step.
    carrier: [Field<D>; D],
    /// Momentum per density and time that convection and viscosity carried through the sides in this step, so far \[m⁴/s²\].
    side_flux: Vector,
    wall_impulse: Vector,
}

impl<const D: usize> Piso<D> {
    /// Fluid at rest in a box; `sides[axis]` are its lower and upper side.
    ///
    /// # Errors
    /// [`FlowError`] for sides or fluid properties that make no sense.
    pub fn new(grid: CartesianGrid<D>, sides: [[Side; 2]; D], fluid: Fluid) -> Result<Self, FlowError> {
        per_dimension!(Piso, new_here(grid: CartesianGrid<D>, sides: [[Side; 2]; D], fluid: Fluid) -> Result<Piso<D>, FlowError>)
    }

    fn new_here(grid: CartesianGrid<D>, sides: [[Side; 2]; D], fluid: Fluid) -> Result<Self, FlowError> {
        let state = FlowState::new(grid, sides, fluid)?;
        let FlowState { grid, metrics, boundaries, .. } = &state;
        let params = PisoParams::default();
        let n = grid.n_cells();
        let matrix = StencilMatrix::new(grid.cells(), metrics.periodic)?;
        let fields = || std::array::from_fn(|_| Field::zeros(grid));
        let solver = MomentumSolver::new(n, params.momentum_tolerance, ITERATIONS);
        let tolerance = params.pressure_tolerance;
        Ok(Self {
            equations: MomentumEquations::new(grid, metrics, fluid, solver, Implicit::Central),
            matrices: std::array::from_fn(|_| matrix.clone()),
            correction: PressureCorrection::new(grid, metrics, boundaries, tolerance, ITERATIONS)?,
            old: fields(),
            older: fields(),
            last: fields(),
            delta: std::array::from_fn(|_| vec![0.0; n]),
            zeros: vec![0.0; n],
            eddy: None,
            source: None,
            imposed: std::array::from_fn(|_| Vec::new()),
            corrections: 0,
            weights: [1.0, -1.0, 0.0],
            carrier: fields(),
            side_flux: Vector::zeros(),
            wall_impulse: Vector::zeros(),
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
    pub fn with_params(mut self, params: PisoParams) -> Result<Self, FlowError> {
        params.check()?;
        let FlowState { grid, metrics, boundaries, .. } = &self.state;
        self.equations.solver = MomentumSolver::new(grid.n_cells(), params.momentum_tolerance, ITERATIONS);
        let tolerance = params.pressure_tolerance;
        self.correction = PressureCorrection::new(grid, metrics, boundaries, tolerance, ITERATIONS)?;
        self.params = params;
        Ok(self)
    }

    /// (w₀, w₁, w₂) dt of this step: (1, −1, 0) by Euler's scheme, (3, −4, 1)/2 with equal steps by BDF2. A change of the velocity between the parts of the step takes w₀ dt
    /// times the impulse that it gives to the fluid at once.
    pub fn weights(&self) -> [f64; 3] {
        self.weights
    }

    /// The parameters.
    pub fn params(&self) -> &PisoParams {
        &self.params
    }

    /// Sets every velocity component to `u(x)[c]` at its nodes \[m/s\], outlets included; walls and inlets keep theirs.
    pub fn set_velocity(&mut self, u: impl Fn([f64; D]) -> [f64; D]) {
        self.state.set_velocity(u);
    }

    /// Sets the kinematic eddy viscosity ν_t \[m²/s\] at the cell centres; `None` takes it away. Ghost values are used as
    /// they are: half the sum of a ghost and the cell inside is ν_t on the side.
    pub fn set_eddy_viscosity(&mut self, eddy: Option<&Field<D>>) {
        match (&mut self.eddy, eddy) {
            (Some(own), Some(eddy)) => own.data_mut().copy_from_slice(eddy.data()),
            (own, eddy) => *own = eddy.cloned(),
        }
    }

    /// Accelerations that vary in space, of every component at its nodes \[m/s²\], of the steps to come; zero until this is first called. They have no part in
    /// the checkpoint.
    pub fn source_mut(&mut self) -> &mut [Field<D>; D] {
        let grid = &self.state.grid;
        self.source.get_or_insert_with(|| Box::new(std::array::from_fn(|_| Field::zeros(grid))))
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
            let cell = momentum::check_node(&self.state.grid, c, index, value)?;
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
        per_dimension!(self, Piso, predict_here(dt: f64, force: [f64; D]) -> Result<(), FlowError>)
    }

    fn predict_here(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        self.state.check_step(dt)?;
        let mut r = if self.state.step > 0 { dt / self.state.last_dt } else { 0.0 };
        if r > LONGEST_RATIO || self.params.time_scheme == TimeScheme::Euler {
            r = 0.0;
        }
        self.weights = [(1.0 + 2.0 * r) / (1.0 + r), -(1.0 + r), r * r / (1.0 + r)];
        let weights = self.weights.map(|w| w / dt);
        std::mem::swap(&mut self.old, &mut self.older);
        for (c, u) in self.state.velocity.components.iter_mut().enumerate() {
            let (u, old, older) = (u.data_mut(), self.old[c].data_mut(), self.older[c].data());
            old.copy_from_slice(u);
            if r > 0.0 {
                u.iter_mut().zip(older).for_each(|(u, older)| *u += r * (*u - older));
            }
        }
        self.state.boundaries.advance(&self.state.metrics, self.state.time + dt)?;
        self.state.fill_velocity();
        for (carrier, u) in self.carrier.iter_mut().zip(&self.state.velocity.components) {
            carrier.data_mut().copy_from_slice(u.data());
        }
        for c in 0..D {
            let FlowState { boundaries, velocity, pressure, .. } = &self.state;
            let equation = Equation {
                velocity: &velocity.components,
                pressure,
                history: [&self.old[c], &self.older[c]],
                weights,
                force: force[c],
                source: self.source.as_ref().map(|source| &source[c]),
                relaxation: 1.0,
                viscous_share: 0.0,
                eddy: self.eddy.as_ref(),
            };
            let matrix = &mut self.matrices[c];
            let [terms, _] = self.equations.make(c, equation, boundaries, matrix);
            if !terms.is_finite() {
                return Err(self.state.diverged(dt));
            }
            for &(cell, index, value) in &self.imposed[c] {
                let change = value - velocity.components[c].data()[index];
                momentum::pin(matrix, cell, change, &mut self.equations.rhs);
            }
            self.equations.solver.solve(matrix, &self.equations.rhs, &mut self.delta[c])?;
            self.correction.set(c, matrix, None, 1.0 / weights[0]);
        }
        let FlowState { grid, metrics, boundaries, fluid, velocity, pressure, .. } = &mut self.state;
        let stress = self.eddy.as_ref();
        boundaries.set_outlet_diffusion(metrics, fluid.viscosity, stress.map(|eddy| (eddy, &[][..])));
        boundaries.advance_excess(OutletStep {
            metrics,
            velocity: &self.old,
            pressure,
            fluid: *fluid,
            inverse_step: dt.recip(),
            relaxation: [0.0; 2],
        });
        for (u, delta) in velocity.components.iter_mut().zip(&self.delta) {
            kernels::add_dense(grid, delta, u);
        }
        boundaries.advance_outlets(metrics, &velocity.components, dt, fluid.viscosity)?;
        boundaries.apply_excess(&velocity.components);
        self.correction.update(boundaries)?;
        self.state.fill_velocity();
        self.side_flux = self.equations.side_flux(&self.carrier, &self.state.velocity.components);
        self.corrections = 0;
        self.state.last_dt = dt;
        Ok(())
    }

    /// A pressure correction: makes the velocity free of divergence. The velocity may be changed before each, by an
    /// immersed body for instance.
    ///
    /// # Errors
    /// [`FlowError::Diverged`] when the velocity is not finite; [`FlowError::Poisson`] if the pressure equation could not
    /// be solved to its tolerance.
    pub fn correct(&mut self, dt: f64) -> Result<(), FlowError> {
        per_dimension!(self, Piso, correct_here(dt: f64) -> Result<(), FlowError>)
    }

    fn correct_here(&mut self, dt: f64) -> Result<(), FlowError> {
        let FlowState { metrics, boundaries, velocity, fluid, .. } = &mut self.state;
        boundaries.repeat_outlets(metrics, &velocity.components, dt, fluid.viscosity)?;
        // What was done to the velocity in between is no change by the flow: its neighbours do not follow it, nor does friction.
        self.state.fill_velocity();
        let before = self.equations.side_flux(&self.carrier, &self.state.velocity.components);
        let FlowState { grid, boundaries, velocity, .. } = &mut self.state;
        for (c, u) in velocity.components.iter_mut().enumerate() {
            self.last[c].data_mut().copy_from_slice(u.data());
            if self.corrections > 0 {
                let (matrix, h) = (&self.matrices[c], &mut self.equations.rhs);
                matrix.h(&self.zeros, &self.delta[c], h)?;
                h.iter_mut().zip(matrix.centre()).for_each(|(h, centre)| *h /= centre);
                kernels::add_dense(grid, h, u);
            }
        }
        boundaries.apply_excess(&velocity.components);
        self.state.fill_velocity();
        let FlowState { grid, boundaries, fluid, velocity, pressure, .. } = &mut self.state;
        self.correction.measure(boundaries, &velocity.components);
        match self.correction.solve(true) {
            Err(PoissonError::NonFinite { .. }) => return Err(self.state.diverged(dt)),
            other => other?,
        };
        self.correction.correct(boundaries, &mut velocity.components);
        boundaries.measure_excess(&velocity.components);
        let density = fluid.density;
        self.correction.phi.iter_mut().for_each(|phi| *phi *= density);
        kernels::add_dense(grid, &self.correction.phi, pressure);
        self.state.fill_pressure();
        self.state.fill_velocity();
        let velocity = &self.state.velocity.components;
        for ((u, last), delta) in velocity.iter().zip(&self.last).zip(&mut self.delta) {
            momentum::difference(u, last, delta);
        }
        self.side_flux += self.equations.side_flux(&self.carrier, velocity) - before;
        self.corrections += 1;
        Ok(())
    }

    /// Ends a step: the time moves on by `dt`.
    ///
    /// # Errors
    /// [`FlowError::Diverged`] when the velocity is not finite.
    pub fn finish(&mut self, dt: f64) -> Result<(), FlowError> {
        per_dimension!(self, Piso, finish_here(dt: f64) -> Result<(), FlowError>)
    }

    fn finish_here(&mut self, dt: f64) -> Result<(), FlowError> {
        self.state.boundaries.keep_outlets();
        self.state.measure_rates();
        if self.state.rates.iter().any(|u| !u.is_finite()) {
            return Err(self.state.diverged(dt));
        }
        let FlowState { grid, metrics, pressure, fluid, .. } = &self.state;
        let thrust = walls::thrust(grid, metrics, pressure);
        self.wall_impulse = dt * (fluid.density * self.side_flux + thrust);
        self.state.tick(dt);
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
        forcing: &mut impl ImmersedForcing<D>,
    ) -> Result<(), FlowError> {
        self.predict(dt, force)?;
        for _ in 0..self.params.correctors {
            forcing.force(&mut self.state.velocity, self.state.time + dt, dt)?;
            self.correct(dt)?;
        }
        self.finish(dt)
    }

    /// The longest step \[s\] with Courant number ≤ `courant`, which may be above 1, at most twice the last step. Infinite
    /// for the first step of a fluid at rest.
    pub fn stable_dt(&self, courant: f64) -> f64 {
        let growth = if self.steps() > 0 { GROWTH * self.last_dt() } else { f64::INFINITY };
        (courant / self.courant(1.0)).min(growth)
    }

    /// Component `c` of the velocity at the start of the last step \[m/s\].
    pub fn before(&self, c: usize) -> &Field<D> {
        &self.old[c]
    }

    /// Impulse of the bounded sides on the fluid during the last step \[N s\]: pressure, friction of the fluid's own viscosity, and what flows through.
    /// By it and by forces w₀Pⁿ⁺¹ + w₁Pⁿ + w₂Pⁿ⁻¹ differs from zero ([`weights`](Self::weights)), up to the tolerances and, between walls, what the last correction's neighbours do
    /// not answer any more. What [`impose`](Self::impose) takes is not in it.
    pub fn wall_impulse(&self) -> Vector {
        self.wall_impulse
    }

    /// Sums and extremes of the velocity, as it is now.
    pub fn statistics(&mut self) -> FlowStatistics {
        self.state.statistics()
    }
    show_state!();
    show_clock!();
}
