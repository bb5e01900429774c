//! What acts on a flow beside pressure and viscosity, each slot a type: `()` is nothing and costs nothing.
use crate::flow_state::{each_cell, each_node};
use crate::grid::GHOSTS;
use crate::{ClosureSlot, Field, FlowError, Projection, Scalar, ScalarTransport, Velocity};
use interfaces::Vector;

/// The slots of [`Projection::advance_with`].
///
/// ```
/// use fv_mesh::{CartesianGrid, Fluid, ForceField, Hooks, Projection, Side};
/// let water = Fluid { density: 1000.0, viscosity: 1e-6 };
/// let mut flow = Projection::new(CartesianGrid::new([8, 8], [0.1, 0.1])?, Side::WALL.everywhere(), water)?;
/// // A force that turns the fluid round.
/// let mut hooks = Hooks::none().with_body_force(ForceField(|x: [f64; 2], _t| [0.05 - x[1], x[0] - 0.05]));
/// flow.advance_with(1e-3, &mut hooks)?;
/// assert!(flow.statistics().kinetic_energy > 0.0);
/// # Ok::<(), fv_mesh::FlowError>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Hooks<B = (), F = (), C = (), S = ()> {
    /// Acceleration by forces of the body of the fluid: [`BodyForce`].
    pub body_force: B,
    /// What immersed bodies do to the velocity: [`ImmersedForcing`].
    pub forcing: F,
    /// Turbulence model: [`Modelled`](crate::Modelled).
    pub closure: C,
    /// Passive or buoyant scalars: [`ScalarTransport`].
    pub scalars: S,
}

impl Hooks {
    /// Nothing.
    #[must_use]
    pub fn none() -> Self {
        Self::default()
    }
}

impl<B, F, C, S> Hooks<B, F, C, S> {
    /// The same with this body force.
    #[must_use]
    pub fn with_body_force<B2>(self, body_force: B2) -> Hooks<B2, F, C, S> {
        Hooks { body_force, forcing: self.forcing, closure: self.closure, scalars: self.scalars }
    }
    /// The same with this forcing by immersed bodies.
    #[must_use]
    pub fn with_forcing<F2>(self, forcing: F2) -> Hooks<B, F2, C, S> {
        Hooks { body_force: self.body_force, forcing, closure: self.closure, scalars: self.scalars }
    }
    /// The same with this turbulence model.
    #[must_use]
    pub fn with_closure<C2>(self, closure: C2) -> Hooks<B, F, C2, S> {
        Hooks { body_force: self.body_force, forcing: self.forcing, closure, scalars: self.scalars }
    }
    /// The same with these scalars.
    #[must_use]
    pub fn with_scalars<S2>(self, scalars: S2) -> Hooks<B, F, C, S2> {
        Hooks { body_force: self.body_force, forcing: self.forcing, closure: self.closure, scalars }
    }
}

/// A force per mass \[m/s²\]. `()` is none; `[f64; D]` is the same everywhere and always; a [`ForceField`] is a function
/// of place and time; [`Boussinesq`] is buoyancy by a scalar.
pub trait BodyForce<const D: usize, S = ()> {
    /// Does it differ from place to place? If not, [`add`](Self::add) is not called.
    fn varies(&self) -> bool {
        false
    }
    /// The part that is the same everywhere.
    fn uniform(&self, _time: f64) -> [f64; D] {
        [0.0; D]
    }
    /// Adds the part that varies, at the velocity nodes, to `source[c]`.
    fn add(&self, _flow: &Projection<D>, _scalars: &S, _source: &mut [Field<D>; D]) {}
}

impl<const D: usize, S> BodyForce<D, S> for () {}

/// A force, or none.
impl<const D: usize, S, B: BodyForce<D, S>> BodyForce<D, S> for Option<B> {
    fn varies(&self) -> bool {
        self.as_ref().is_some_and(B::varies)
    }
    fn uniform(&self, time: f64) -> [f64; D] {
        self.as_ref().map_or([0.0; D], |force| force.uniform(time))
    }
    fn add(&self, flow: &Projection<D>, scalars: &S, source: &mut [Field<D>; D]) {
        if let Some(force) = self {
            force.add(flow, scalars, source);
        }
    }
}

impl<const D: usize, S> BodyForce<D, S> for [f64; D] {
    fn uniform(&self, _time: f64) -> [f64; D] {
        *self
    }
}

/// A force per mass \[m/s²\] that is a function of place \[m\] and time \[s\].
#[derive(Clone, Copy, Debug)]
pub struct ForceField<F>(
    /// The function.
    pub F,
);

impl<const D: usize, S, F: Fn([f64; D], f64) -> [f64; D]> BodyForce<D, S> for ForceField<F> {
    fn varies(&self) -> bool {
        true
    }
    fn add(&self, flow: &Projection<D>, _scalars: &S, source: &mut [Field<D>; D]) {
        let time = flow.time();
        for (c, source) in source.iter_mut().enumerate() {
            each_node(flow.grid(), &flow.state.metrics, c, |o, x| source.data_mut()[o] += self.0(x, time)[c]);
        }
    }
}

/// Buoyancy of a fluid that expands a little: −β (φ − φ₀) g with the first scalar φ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Boussinesq {
    /// Expansion coefficient β \[1/unit of φ\].
    pub expansion: f64,
    /// φ₀, at which nothing is buoyant.
    pub reference: f64,
    /// Gravity g \[m/s²\].
    pub gravity: Vector,
}

impl<const D: usize> BodyForce<D, Scalar<D>> for Boussinesq {
    fn varies(&self) -> bool {
        true
    }
    fn add(&self, _: &Projection<D>, scalar: &Scalar<D>, source: &mut [Field<D>; D]) {
        self.accelerate(scalar, source);
    }
}

impl Boussinesq {
    /// Adds it to accelerations at the velocity nodes of the scalar's grid \[m/s²\], as [`Piso::source_mut`](crate::Piso::source_mut) and
    /// [`Simple::source_mut`](crate::Simple::source_mut) have them.
    pub fn accelerate<const D: usize>(&self, scalar: &Scalar<D>, source: &mut [Field<D>; D]) {
        let (phi, grid) = (scalar.field().data(), scalar.grid());
        for (c, source) in source.iter_mut().enumerate().filter(|(c, _)| self.gravity[*c] != 0.0) {
            let (factor, s) = (-self.expansion * self.gravity[c], grid.stride()[c]);
            let share = &scalar.metrics().axes[c].share;
            each_cell(grid, |o, cell| {
                let [below, above] = [0, 1].map(|part: usize| share[part][GHOSTS + cell[c]]);
                // Linear between the centres beside the face.
                let mean = above * phi[o - s] + below * phi[o];
                source.data_mut()[o] += factor * (mean - self.reference);
            });
        }
    }
}

impl<const D: usize> BodyForce<D, Vec<Scalar<D>>> for Boussinesq {
    fn varies(&self) -> bool {
        true
    }
    fn add(&self, flow: &Projection<D>, scalars: &Vec<Scalar<D>>, source: &mut [Field<D>; D]) {
        if let Some(first) = scalars.first() {
            self.add(flow, first, source);
        }
    }
}

/// Forces the velocity between predictor and projection, as immersed bodies do; `()` does not. So may a closure
/// `|velocity, time, dt|`. Nodes and values are those of [`VelocityField`](crate::VelocityField).
///
/// ```
/// use fv_mesh::{CartesianGrid, FlowError, Fluid, Hooks, Profile, Projection, Side, Velocity};
/// use fv_mesh::VelocityField;
/// let grid = CartesianGrid::new([32, 16], [2.0, 1.0])?;
/// let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
/// let sides = [[inlet, Side::ConvectiveOutlet], Side::FreeSlip.both()];
/// let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 0.01 })?;
/// flow.set_velocity(|_| [1.0, 0.0]);
/// // A disc in which the fluid is held.
/// let disc = |velocity: &mut Velocity<2>, _time: f64, _dt: f64| -> Result<(), FlowError> {
///     for c in 0..2 {
///         let lattice = velocity.lattice(c).clone();
///         let [rows, columns] = [lattice.range(1, 0.4, 0.6), lattice.range(0, 0.4, 0.6)];
///         for node in rows.flat_map(|j| columns.clone().map(move |i| [i, j, 0])) {
///             let x = lattice.position(node);
///             if (x[0] - 0.5).hypot(x[1] - 0.5) < 0.1 && let Some(at) = lattice.index(node) {
///                 velocity.component_mut(c)[at] = 0.0;
///             }
///         }
///     }
///     Ok(())
/// };
/// let mut hooks = Hooks::none().with_forcing(disc);
/// for _ in 0..20 {
///     flow.advance_with(0.02, &mut hooks)?;
/// }
/// # Ok::<(), FlowError>(())
/// ```
pub trait ImmersedForcing<const D: usize> {
    /// Changes the predicted velocity u* \[m/s\] of time `time` \[s\], the end of a step of `dt` \[s\]; the projection
    /// follows.
    ///
    /// # Errors
    /// Whatever stops the run.
    fn force(&mut self, velocity: &mut Velocity<D>, time: f64, dt: f64) -> Result<(), FlowError>;
}

impl<const D: usize> ImmersedForcing<D> for () {
    #[inline(always)]
    fn force(&mut self, _: &mut Velocity<D>, _: f64, _: f64) -> Result<(), FlowError> {
        Ok(())
    }
}

impl<const D: usize, F> ImmersedForcing<D> for F
where
    F: FnMut(&mut Velocity<D>, f64, f64) -> Result<(), FlowError>,
{
    fn force(&mut self, velocity: &mut Velocity<D>, time: f64, dt: f64) -> Result<(), FlowError> {
        self(velocity, time, dt)
    }
}

impl<const D: usize> Projection<D> {
    /// One whole step of length `dt` with everything in `hooks`: scalars and body force from the flow as it is, predictor,
    /// forcing, projection, and the closure from the flow that results.
    ///
    /// Hooks have no part in the flow's checkpoint: save scalars and the closure's state beside it.
    ///
    /// # Errors
    /// See [`predict`](Self::predict) and [`project`](Self::project), and what the hooks answer.
    pub fn advance_with<B, F, C, S>(
        &mut self,
        dt: f64,
        hooks: &mut Hooks<B, F, C, S>,
    ) -> Result<(), FlowError>
    where
        B: BodyForce<D, S>,
        F: ImmersedForcing<D>,
        C: ClosureSlot<D>,
        S: ScalarTransport<D>,
    {
        let uniform = self.prepare(dt, hooks)?;
        self.predict(dt, uniform)?;
        let end = self.time() + dt;
        hooks.forcing.force(self.velocity_mut(), end, dt)?;
        self.project(dt)?;
        self.finish(dt)?;
        self.correct(dt, &mut hooks.closure)
    }

    /// What hooks do before the predictor: scalars move on, forces and eddy stress are laid ready. Answers the uniform part of the force.
    pub(crate) fn prepare<B, F, C, S>(
        &mut self,
        dt: f64,
        hooks: &mut Hooks<B, F, C, S>,
    ) -> Result<[f64; D], FlowError>
    where
        B: BodyForce<D, S>,
        C: ClosureSlot<D>,
        S: ScalarTransport<D>,
    {
        let Hooks { body_force, closure, scalars, .. } = hooks;
        self.forget_sources();
        self.choose_implicit(dt)?;
        if body_force.varies() {
            self.with_sources(|flow, sources| body_force.add(flow, scalars, sources));
        }
        if let Some(stress) = closure.stress(self)? {
            self.add_eddy_stress(stress, dt)?;
            scalars.mix(stress, self.fluid().viscosity);
        }
        scalars.advance(self.velocity(), self.time(), dt)?;
        // Of the middle of the step, as what is explicit is extrapolated to it.
        Ok(body_force.uniform(self.time() + 0.5 * dt))
    }

    /// What hooks do at the end of a step: the closure follows the flow, and the next step's limit the closure.
    pub(crate) fn correct<C: ClosureSlot<D>>(&mut self, dt: f64, closure: &mut C) -> Result<(), FlowError> {
        closure.correct(self, dt)?;
        self.expect_eddy_viscosity(closure.fastest());
        Ok(())
    }
}
