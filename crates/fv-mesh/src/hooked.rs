//! A flow together with what acts on it.
use crate::{
    BodyForce, CartesianGrid, ClosureSlot, Field, FlowError, FlowStatistics, Fluid, Hooks, Projection,
    ScalarTransport, SidePower, Sides, SourceWork, Velocity,
};
use interfaces::{Bodies, Checkpoint, RestartError, Vector};

/// A [`Projection`] and its [`Hooks`] as one, whose step has the parts of the flow's own, so that something else can act in between, as
/// bodies do: [`Projection::advance_with`] is `predict`, forcing, `project`, `finish` of this.
///
/// ```
/// use fv_mesh::{Boussinesq, CartesianGrid, Fluid, Hooked, Hooks, Projection, Scalar, ScalarSide, Side};
/// // Air in a box that is warmer on the left.
/// let grid = CartesianGrid::new([16, 16], [0.1, 0.1])?;
/// let sides = [[ScalarSide::value(1.0), ScalarSide::value(0.0)], ScalarSide::NO_GRADIENT.both()];
/// let warmth = Scalar::new(&grid, sides, 2e-5)?;
/// let lift = Boussinesq { expansion: 3.4e-3, reference: 0.5, gravity: [0.0, -9.81, 0.0].into() };
/// let flow = Projection::new(grid, Side::WALL.everywhere(), Fluid { density: 1.2, viscosity: 1.5e-5 })?;
/// let mut air = Hooked::new(flow, Hooks::none().with_body_force(lift).with_scalars(warmth));
/// for _ in 0..5 {
///     air.predict(0.02, [0.0; 2])?;
///     air.project(0.02)?;
///     air.finish(0.02)?;
/// }
/// assert!(air.statistics().kinetic_energy > 0.0);
/// # Ok::<(), fv_mesh::FlowError>(())
/// ```
pub struct Hooked<const D: usize, B = (), C = (), S = ()> {
    /// The flow.
    pub flow: Projection<D>,
    /// What acts on it.
    pub hooks: Hooks<B, (), C, S>,
    /// The part of the hooks' force that is the same everywhere, of the last step.
    own: [f64; D],
}

impl<const D: usize, B, C, S> Hooked<D, B, C, S>
where
    B: BodyForce<D, S>,
    C: ClosureSlot<D>,
    S: ScalarTransport<D>,
{
    /// The two together.
    pub fn new(mut flow: Projection<D>, hooks: Hooks<B, (), C, S>) -> Self {
        flow.expect_eddy_viscosity(hooks.closure.fastest());
        Self { flow, hooks, own: [0.0; D] }
    }

    /// First part of a step of `dt` \[s\] under `force` per mass \[m/s²\] and the hooks' own: scalars and velocity move on.
    ///
    /// # Errors
    /// See [`Projection::predict`], and what the hooks answer.
    pub fn predict(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        self.own = self.flow.prepare(dt, &mut self.hooks)?;
        self.flow.predict(dt, std::array::from_fn(|a| force[a] + self.own[a]))
    }
    /// The part of the hooks' force per mass \[m/s²\] that is the same everywhere, in the last step.
    pub fn own_force(&self) -> [f64; D] {
        self.own
    }
    /// See [`Projection::keep_books`].
    pub fn keep_books(&mut self) {
        self.flow.keep_books();
    }
    /// What else the hooks did in the last step, once books are kept.
    pub fn source_work(&self) -> SourceWork {
        self.flow.source_work()
    }
    /// See [`Projection::project`].
    ///
    /// # Errors
    /// See there.
    pub fn project(&mut self, dt: f64) -> Result<(), FlowError> {
        self.flow.project(dt)
    }
    /// Tells scalars and closure where the bodies are, before a step and when they have moved in it.
    ///
    /// # Errors
    /// What they answer.
    pub fn follow_walls(&mut self, bodies: &dyn Bodies) -> Result<(), FlowError> {
        let Self { flow, hooks, .. } = &mut *self;
        hooks.scalars.follow(flow.grid(), flow.sides(), flow.time(), bodies)?;
        self.hooks.closure.follow(&self.flow, bodies)
    }
    /// Ends a step of `dt`; the closure follows the flow.
    ///
    /// # Errors
    /// See [`Projection::finish`], and what the closure answers.
    pub fn finish(&mut self, dt: f64) -> Result<(), FlowError> {
        self.flow.finish(dt)?;
        self.flow.correct(dt, &mut self.hooks.closure)
    }
    /// The longest step \[s\] with Courant number ≤ `courant` that is stable for the flow ([`Projection::stable_dt`]) and its scalars.
    pub fn stable_dt(&self, courant: f64) -> f64 {
        self.flow.stable_dt(courant).min(self.hooks.scalars.longest_step(self.hooks.closure.fastest()))
    }
    /// See [`Projection::move_window`].
    ///
    /// # Errors
    /// See there; [`FlowError::Window`] with scalars or a closure, whose fields would stay behind.
    pub fn move_window(&mut self, axis: usize, cells: i64) -> Result<(), FlowError> {
        if self.hooks.scalars.is_absent() && self.hooks.closure.is_absent() {
            return self.flow.move_window(axis, cells);
        }
        let what = "scalars and turbulence models would stay behind; take them out, or give a box that is long enough";
        Err(FlowError::Window { axis, what })
    }

    /// The grid.
    pub fn grid(&self) -> &CartesianGrid<D> {
        self.flow.grid()
    }
    /// The sides of the box.
    pub fn sides(&self) -> &Sides<D> {
        self.flow.sides()
    }
    /// The fluid.
    pub fn fluid(&self) -> Fluid {
        self.flow.fluid()
    }
    /// The velocity \[m/s\].
    pub fn velocity(&self) -> &Velocity<D> {
        self.flow.velocity()
    }
    /// The same, to be changed.
    pub fn velocity_mut(&mut self) -> &mut Velocity<D> {
        self.flow.velocity_mut()
    }
    /// Component `c` of the velocity at the start of the last step \[m/s\].
    pub fn before(&self, c: usize) -> &Field<D> {
        self.flow.before(c)
    }
    /// The pressure \[Pa\].
    pub fn pressure(&self) -> &Field<D> {
        self.flow.pressure()
    }
    /// Component `c` of the velocity at the centres of the cells.
    pub fn centred_velocity(&self, c: usize) -> impl Iterator<Item = f64> + '_ {
        self.flow.centred_velocity(c)
    }
    /// Sums and extremes.
    pub fn statistics(&mut self) -> FlowStatistics {
        self.flow.statistics()
    }
    /// What the bounded sides do to the kinetic energy of the fluid, as it is now.
    pub fn side_power(&self) -> SidePower {
        self.flow.side_power()
    }
    /// Impulse of the bounded sides on the fluid during the last step \[N s\].
    pub fn wall_impulse(&self) -> Vector {
        self.flow.wall_impulse()
    }
    /// Time \[s\].
    pub fn time(&self) -> f64 {
        self.flow.time()
    }
    /// Sets the clock exactly.
    pub fn set_time(&mut self, time: f64) {
        self.flow.set_time(time);
    }
    /// Steps made.
    pub fn steps(&self) -> u64 {
        self.flow.steps()
    }
    /// Length of the last step \[s\].
    pub fn last_dt(&self) -> f64 {
        self.flow.last_dt()
    }
    /// Courant number of a step of `dt`.
    pub fn courant(&self, dt: f64) -> f64 {
        self.flow.courant(dt)
    }
}

/// The projection in it.
impl<const D: usize, B, C, S> AsRef<Projection<D>> for Hooked<D, B, C, S> {
    fn as_ref(&self) -> &Projection<D> {
        &self.flow
    }
}

impl<const D: usize, B, C, S> AsMut<Projection<D>> for Hooked<D, B, C, S> {
    fn as_mut(&mut self) -> &mut Projection<D> {
        &mut self.flow
    }
}

/// Itself, as a [`Hooked`] has one.
impl<const D: usize> AsRef<Self> for Projection<D> {
    fn as_ref(&self) -> &Self {
        self
    }
}

impl<const D: usize> AsMut<Self> for Projection<D> {
    fn as_mut(&mut self) -> &mut Self {
        self
    }
}

impl<const D: usize, B, C: ClosureSlot<D> + Checkpoint, S: Checkpoint> Checkpoint for Hooked<D, B, C, S> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.flow.save(&mut |name, values| sink(&format!("flow.{name}"), values));
        self.hooks.closure.save(&mut |name, values| sink(&format!("closure.{name}"), values));
        self.hooks.scalars.save(&mut |name, values| sink(&format!("scalars.{name}"), values));
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.flow.restore(&|name| source(&format!("flow.{name}")))?;
        self.hooks.closure.restore(&|name| source(&format!("closure.{name}")))?;
        self.hooks.scalars.restore(&|name| source(&format!("scalars.{name}")))?;
        self.flow.expect_eddy_viscosity(self.hooks.closure.fastest());
        Ok(())
    }
    fn save_start(&mut self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.flow.save_start(&mut |name, values| sink(&format!("flow.{name}"), values));
        self.hooks.closure.save_start(&mut |name, values| sink(&format!("closure.{name}"), values));
        self.hooks.scalars.save_start(&mut |name, values| sink(&format!("scalars.{name}"), values));
    }
    fn take_back<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.flow.take_back(&|name| source(&format!("flow.{name}")))?;
        self.hooks.closure.take_back(&|name| source(&format!("closure.{name}")))?;
        self.hooks.scalars.take_back(&|name| source(&format!("scalars.{name}")))?;
        self.flow.expect_eddy_viscosity(self.hooks.closure.fastest());
        Ok(())
    }
}
