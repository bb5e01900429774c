//! Bodies that the flow moves, and the record of how they move.
use coupling::{CouplingError, Observer, Particles, Simulation, StepInfo};
use dem::{Chen, ContactLaw, RigidBodies};
use ibm::SmoothForcing;
use interfaces::{BodyId, Kinematics};

/// Bodies that flow, gravity and contacts move.
pub type Fall<const D: usize, L = Chen> = Simulation<D, Particles<SmoothForcing, RigidBodies<L>>>;

/// Position and velocity of a body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Time \[s\].
    pub time: f64,
    /// Centre \[m\].
    pub position: [f64; 3],
    /// Velocity \[m/s\].
    pub velocity: [f64; 3],
}

/// States of every body at the start and after every step.
#[derive(Clone, Debug, Default)]
pub struct Motion {
    /// States, body by body.
    pub bodies: Vec<Vec<State>>,
}

impl Motion {
    /// Quantity of body `b` over time.
    pub fn over_time(&self, b: usize, quantity: impl Fn(&State) -> f64) -> Vec<(f64, f64)> {
        let states = self.bodies.get(b).map_or(&[][..], Vec::as_slice);
        states.iter().map(|s| (s.time, quantity(s))).collect()
    }

    fn push<const D: usize, L: ContactLaw>(&mut self, fall: &Fall<D, L>, time: f64) {
        let bodies = &fall.particles.bodies;
        self.bodies.resize_with(bodies.n_bodies(), Vec::new);
        for (b, states) in self.bodies.iter_mut().enumerate() {
            let (position, velocity) = (bodies.pose(BodyId(b)).position, bodies.twist(BodyId(b)).linear);
            states.push(State { time, position: position.coords.into(), velocity: velocity.into() });
        }
    }
}

impl<const D: usize, L: ContactLaw> Observer<Fall<D, L>> for Motion {
    fn begin(&mut self, fall: &mut Fall<D, L>) {
        self.push(fall, fall.flow.time());
    }
    fn step(&mut self, fall: &mut Fall<D, L>, info: &StepInfo) -> Result<(), CouplingError> {
        self.push(fall, info.time);
        Ok(())
    }
}
