//! Going back to the middle of a step.
use super::Projection;

/// Velocity and pressure between [`predict`](Projection::predict) and [`project`](Projection::project), to which a step can go back: for
/// bodies whose motion is found by trying.
#[derive(Clone, Debug, Default)]
pub struct Prediction {
    velocity: Vec<f64>,
    pressure: Vec<f64>,
    sides: Vec<f64>,
}

impl<const D: usize> Projection<D> {
    /// Notes velocity and pressure as they are; no memory is taken the second time.
    pub fn note(&self, prediction: &mut Prediction) {
        let Prediction { velocity, pressure, sides } = prediction;
        velocity.clear();
        for component in &self.state.velocity.components {
            velocity.extend_from_slice(component.data());
        }
        pressure.clear();
        pressure.extend_from_slice(self.state.pressure.data());
        self.state.boundaries.memory(sides);
    }

    /// Takes velocity and pressure back to what [`note`](Self::note) found in this step.
    pub fn go_back(&mut self, to: &Prediction) {
        let n = self.state.pressure.data().len();
        for (component, noted) in self.state.velocity.components.iter_mut().zip(to.velocity.chunks_exact(n)) {
            component.data_mut().copy_from_slice(noted);
        }
        self.state.pressure.data_mut().copy_from_slice(&to.pressure);
        self.state.boundaries.recall(&to.sides);
    }
}
