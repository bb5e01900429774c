//! State from which steady iterations go on.
use super::Simple;
use interfaces::{Checkpoint, RestartError};

/// Velocity, pressure, sides, the number of iterations and the friction of immersed walls. All else follows from these, from a turbulence
/// model and from what is set before.
impl<const D: usize> Checkpoint for Simple<D> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.state.save(sink);
        if let Some(walls) = &self.walls {
            sink("walls", &walls.friction_state());
        }
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.state.restore(source)?;
        if let Some(walls) = &mut self.walls {
            let expected = walls.friction_state().len();
            walls.set_friction_state(RestartError::take(source, "walls", expected)?);
        }
        Ok(())
    }
}
