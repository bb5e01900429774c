//! Bodies at rest, as walls of the flow.
use coupling::{CouplingError, FlowSolver, Immersed, Module, Timings};
use ibm::StaticBodies;
use interfaces::{Checkpoint, RestartError, ThinPart};

/// Bodies that stay where they are. The flow has them as walls already, so nothing is left to do in a step.
#[derive(Default)]
pub(crate) struct Still {
    pub(crate) bodies: StaticBodies,
    /// Parts that are too thin for the grid.
    pub(crate) thin: Vec<ThinPart>,
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
