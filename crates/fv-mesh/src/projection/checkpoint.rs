//! What a stopped run needs to go on.
use super::Projection;
use interfaces::{Checkpoint, RestartError};

impl<const D: usize> Checkpoint for Projection<D> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.state.save(sink);
        for (c, tendency) in self.tendency.iter().enumerate() {
            sink(&format!("tendency{c}"), tendency.data());
        }
        sink("friction", self.friction[0].as_slice());
        if self.pressure_solver.remembers() {
            sink("correction", &self.phi);
        }
        if let Some(walls) = &self.walls {
            walls.save(sink);
        }
        self.sources.save(sink);
        sink("implicit", &self.diffusion.last.map(|i| f64::from(u8::from(i))));
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.state.restore(source)?;
        self.set_grid();
        for (c, tendency) in self.tendency.iter_mut().enumerate() {
            RestartError::fill(source, &format!("tendency{c}"), tendency.data_mut())?;
        }
        RestartError::fill(source, "friction", self.friction[0].as_mut_slice())?;
        if self.pressure_solver.remembers() {
            RestartError::fill(source, "correction", &mut self.phi)?;
        }
        if let Some(walls) = &mut self.walls {
            walls.restore(source)?;
        }
        let implicit = RestartError::take(source, "implicit", D)?;
        self.diffusion.last = std::array::from_fn(|a| implicit[a] != 0.0);
        self.sources.restore(source)
    }
}
