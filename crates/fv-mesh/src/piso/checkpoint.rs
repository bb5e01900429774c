//! What a stopped run needs to go on.
use super::Piso;
use interfaces::{Checkpoint, RestartError};

impl<const D: usize> Checkpoint for Piso<D> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        for c in 0..D {
            sink(&format!("velocity{c}"), self.velocity.components[c].data());
            sink(&format!("old{c}"), self.old[c].data());
        }
        sink("pressure", self.pressure.data());
        sink("clock", &[self.time, self.step as f64, self.last_dt]);
        sink("rates", &self.rates);
        sink("sides", &self.boundaries.memory());
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let n = self.grid.storage();
        for c in 0..D {
            let u = RestartError::take(source, &format!("velocity{c}"), n)?;
            self.velocity.components[c].data_mut().copy_from_slice(u);
            let old = RestartError::take(source, &format!("old{c}"), n)?;
            self.old[c].data_mut().copy_from_slice(old);
        }
        self.pressure.data_mut().copy_from_slice(RestartError::take(source, "pressure", n)?);
        let clock = RestartError::take(source, "clock", 3)?;
        (self.time, self.step, self.last_dt) = (clock[0], clock[1] as u64, clock[2]);
        self.rates.copy_from_slice(RestartError::take(source, "rates", D)?);
        let sides = RestartError::take(source, "sides", self.boundaries.memory().len())?;
        self.boundaries.recall(sides);
        Ok(())
    }
}
