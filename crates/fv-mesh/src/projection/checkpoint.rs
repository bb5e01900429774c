//! What a stopped run needs to go on.
use super::{Projection, Start};
use crate::Field;
use interfaces::{Checkpoint, RestartError};

impl<const D: usize> Checkpoint for Projection<D> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.state.save(sink);
        for (c, tendency) in self.tendency.iter().enumerate() {
            sink(&format!("tendency{c}"), tendency.data());
        }
        self.save_algorithm(sink);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.state.restore(source)?;
        self.set_grid();
        for (c, tendency) in self.tendency.iter_mut().enumerate() {
            RestartError::fill(source, &format!("tendency{c}"), tendency.data_mut())?;
        }
        self.restore_algorithm(source)
    }
    fn save_start(&mut self, sink: &mut dyn FnMut(&str, &[f64])) {
        let grid = &self.state.grid;
        let start = self.start.get_or_insert_with(|| {
            let field = || Field::zeros(grid);
            Box::new(Start {
                tendency: std::array::from_fn(|_| field()),
                pressure: field(),
                advanced: [false; 2],
            })
        });
        start.advanced = [false; 2];
        self.state.save_clock(sink);
        self.save_algorithm(sink);
    }
    fn take_back<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        if let Some(start) = &mut self.start {
            let [advanced, projected] = std::mem::take(&mut start.advanced);
            if advanced {
                std::mem::swap(&mut self.state.velocity.components, &mut self.next);
                std::mem::swap(&mut self.tendency, &mut start.tendency);
            }
            if projected {
                std::mem::swap(&mut self.state.pressure, &mut start.pressure);
            }
        }
        self.state.restore_clock(source)?;
        self.restore_algorithm(source)
    }
}

impl<const D: usize> Projection<D> {
    /// Passes everything but the fields and what [`FlowState`](crate::flow_state::FlowState) holds to
    /// `sink`.
    fn save_algorithm(&self, sink: &mut dyn FnMut(&str, &[f64])) {
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

    fn restore_algorithm<'a>(
        &mut self,
        source: &dyn Fn(&str) -> Option<&'a [f64]>,
    ) -> Result<(), RestartError> {
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
