//! A flow and the scalars it carries.
use crate::FlowSolver;
use crate::flow_solver::forward;
use fv_mesh::{
    Boussinesq, CartesianGrid, Field, FlowError, FlowStatistics, Fluid, Piso, Scalar, ScalarTransport,
    SidePower, Sides, SourceWork, Velocity,
};
use ibm::ViscousStep;
use interfaces::{Bodies, Checkpoint, RestartError, Vector};

/// Any [`FlowSolver`] and scalars as one flow: in the first part of a step the scalars move on by the velocity at its start, then the flow, which they may [`Drive`]. (With a
/// [`Projection`](fv_mesh::Projection) take [`Hooked`](fv_mesh::Hooked).)
///
/// ```
/// use coupling::{FlowSolver, WithScalars};
/// use coupling::fv_mesh::{CartesianGrid, Fluid, Piso, Scalar, ScalarSide, Side};
/// let grid = CartesianGrid::new([16, 16], [0.1, 0.1])?;
/// let dye = Scalar::new(&grid, ScalarSide::NO_GRADIENT.everywhere(), 1e-6)?;
/// let lid = [Side::WALL.both(), [Side::WALL, Side::Wall([0.1, 0.0, 0.0])]];
/// let water = Piso::new(grid, lid, Fluid { density: 1000.0, viscosity: 1e-6 })?;
/// let mut flow = WithScalars { flow: water, scalars: dye, drive: () };
/// flow.predict(0.01, [0.0; 2])?;
/// for _ in 0..flow.rounds() {
///     flow.project(0.01)?;
/// }
/// flow.finish(0.01)?;
/// assert_eq!(flow.scalars.steps(), 1);
/// # Ok::<(), fv_mesh::FlowError>(())
/// ```
#[derive(Debug)]
pub struct WithScalars<A, S, B = ()> {
    /// The flow.
    pub flow: A,
    /// What it carries.
    pub scalars: S,
    /// What these do to it.
    pub drive: B,
}

/// What scalars do to the flow that carries them: `()` is nothing.
pub trait Drive<A, S> {
    /// Lays ready for the next step what `scalars`, at its end, do to `flow`.
    fn drive(&self, scalars: &S, flow: &mut A);
}

impl<A, S> Drive<A, S> for () {
    fn drive(&self, _: &S, _: &mut A) {}
}

/// Something, or nothing.
impl<A, S, B: Drive<A, S>> Drive<A, S> for Option<B> {
    fn drive(&self, scalars: &S, flow: &mut A) {
        if let Some(drive) = self {
            drive.drive(scalars, flow);
        }
    }
}

/// Buoyancy.
impl<const D: usize> Drive<Piso<D>, Scalar<D>> for Boussinesq {
    fn drive(&self, scalar: &Scalar<D>, flow: &mut Piso<D>) {
        let source = flow.source_mut();
        source.iter_mut().for_each(|source| source.data_mut().fill(0.0));
        self.accelerate(scalar, source);
    }
}

impl<A: Checkpoint, S: Checkpoint, B> Checkpoint for WithScalars<A, S, B> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.flow.save(&mut |name, values| sink(&format!("flow.{name}"), values));
        self.scalars.save(&mut |name, values| sink(&format!("scalars.{name}"), values));
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.flow.restore(&|name| source(&format!("flow.{name}")))?;
        self.scalars.restore(&|name| source(&format!("scalars.{name}")))
    }
    fn save_start(&mut self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.flow.save_start(&mut |name, values| sink(&format!("flow.{name}"), values));
        self.scalars.save_start(&mut |name, values| sink(&format!("scalars.{name}"), values));
    }
    fn take_back<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.flow.take_back(&|name| source(&format!("flow.{name}")))?;
        self.scalars.take_back(&|name| source(&format!("scalars.{name}")))
    }
}

impl<const D: usize, A, S, B> FlowSolver<D> for WithScalars<A, S, B>
where
    A: FlowSolver<D>,
    S: ScalarTransport<D> + Checkpoint,
    B: Drive<A, S>,
{
    forward!(self => self.flow);
    fn predict(&mut self, dt: f64, force: [f64; D]) -> Result<(), FlowError> {
        self.scalars.advance(self.flow.velocity(), self.flow.time(), dt)?;
        self.drive.drive(&self.scalars, &mut self.flow);
        self.flow.predict(dt, force)
    }
    fn project(&mut self, dt: f64) -> Result<(), FlowError> {
        self.flow.project(dt)
    }
    fn move_window(&mut self, axis: usize, _cells: i64) -> Result<(), FlowError> {
        let what = "scalars would stay behind; take them out, or give a box that is long enough";
        Err(FlowError::Window { axis, what })
    }
    fn rounds(&self) -> usize {
        self.flow.rounds()
    }
    fn weights(&self) -> [f64; 3] {
        self.flow.weights()
    }
    fn own_force(&self) -> [f64; D] {
        self.flow.own_force()
    }
    fn keep_books(&mut self) {
        self.flow.keep_books();
    }
    fn source_work(&self) -> SourceWork {
        self.flow.source_work()
    }
    fn stable_dt(&self, courant: f64) -> f64 {
        self.flow.stable_dt(courant).min(self.scalars.longest_step(0.0))
    }
    fn follow_walls(&mut self, bodies: &dyn Bodies) -> Result<(), FlowError> {
        self.scalars.follow(self.flow.grid(), self.flow.sides(), self.flow.time(), bodies)?;
        self.flow.follow_walls(bodies)
    }
    fn viscous_step(&self, dt: f64) -> Option<ViscousStep> {
        self.flow.viscous_step(dt)
    }
    fn viscous_limit(&self) -> f64 {
        self.flow.viscous_limit()
    }
}
