//! Bodies at rest, as walls of the flow.
use coupling::{CouplingError, FlowSolver, Immersed, Module, Timings};
use dem::Shape;
use interfaces::{
    Bodies, BodyId, Checkpoint, Freedom, Inertia, Kinematics, Pose, RestartError, Solid, Twist,
};
use std::sync::Arc;

/// Bodies that stay where they are. The flow has them as walls already, so nothing is left to do in a step.
#[derive(Clone, Default)]
pub(crate) struct Still {
    bodies: Vec<(Arc<dyn Shape>, Pose, f64)>,
}

impl Still {
    /// Shapes, where they are, and their densities \[kg/m³\].
    pub(crate) fn new(bodies: Vec<(Arc<dyn Shape>, Pose, f64)>) -> Self {
        Self { bodies }
    }
}

impl Kinematics for Still {
    fn n_bodies(&self) -> usize {
        self.bodies.len()
    }
    fn pose(&self, b: BodyId) -> Pose {
        self.bodies[b.0].1
    }
    fn twist(&self, _: BodyId) -> Twist {
        Twist::default()
    }
}

impl Bodies for Still {
    fn solid(&self, b: BodyId) -> &dyn Solid {
        &self.bodies[b.0].0
    }
    fn inertia(&self, b: BodyId) -> Inertia {
        let (shape, _, density) = &self.bodies[b.0];
        shape.inertia(*density)
    }
    fn freedom(&self, _: BodyId) -> Freedom {
        Freedom::NONE
    }
}

impl Checkpoint for Still {
    fn save(&self, _: &mut dyn FnMut(&str, &[f64])) {}
    fn restore<'a>(&mut self, _: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        Ok(())
    }
}

impl<const D: usize, A: FlowSolver<D>> Immersed<D, A> for Still {
    fn couple(&mut self, flow: &mut A, dt: f64, timings: &mut Timings) -> Result<(), CouplingError> {
        for _ in 0..flow.rounds() {
            timings.measure(Module::Pressure, || flow.project(dt))?;
        }
        Ok(())
    }
}
