//! What a stopped run needs to go on.
use super::Piso;
use interfaces::{Checkpoint, RestartError};

impl<const D: usize> Checkpoint for Piso<D> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.state.save(sink);
        for (c, old) in self.old.iter().enumerate() {
            sink(&format!("old{c}"), old.data());
        }
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.state.restore(source)?;
        self.set_grid();
        for (c, old) in self.old.iter_mut().enumerate() {
            RestartError::fill(source, &format!("old{c}"), old.data_mut())?;
        }
        Ok(())
    }
}
