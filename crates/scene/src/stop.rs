//! Ends of runs before their time.
use crate::result::Ending;
use crate::setup::StopSetup;
use crate::view::View;
use coupling::StepInfo;
use interfaces::{BodyId, Checkpoint, RestartError};

/// Checks the conditions of `time.stop` after every step.
pub(crate) struct StopCheck {
    setup: StopSetup,
    /// Velocity at the centres of the cells after the last step, and room for the next.
    before: [Vec<f64>; 3],
    now: [Vec<f64>; 3],
    /// Rate of change of the flow in the last step \[1/s\].
    rate: f64,
    ending: Option<Ending>,
}

impl StopCheck {
    pub(crate) fn new(setup: StopSetup) -> Self {
        let (before, now) = Default::default();
        Self { setup, before, now, rate: f64::INFINITY, ending: None }
    }

    /// How the run ends, if a condition holds.
    pub(crate) fn ending(&self) -> Option<Ending> {
        self.ending
    }

    /// Before the first step, also of a run that goes on.
    pub(crate) fn begin(&mut self, view: &mut dyn View) {
        if self.setup.steady.is_some() {
            view.centred(&mut self.before);
        }
        self.update(view);
    }

    /// After a step.
    pub(crate) fn step(&mut self, view: &mut dyn View, info: &StepInfo) {
        if self.setup.steady.is_some() {
            view.centred(&mut self.now);
            let pairs = self.now.iter().zip(&self.before).flat_map(|(now, before)| now.iter().zip(before));
            let [change, speed] = pairs.fold([0.0_f64; 2], |[change, speed], (now, before)| {
                [change.max((now - before).abs()), speed.max(now.abs())]
            });
            // A fluid at rest has not begun to move.
            self.rate = if speed > 0.0 { change / (speed * info.dt) } else { f64::INFINITY };
            std::mem::swap(&mut self.now, &mut self.before);
        }
        self.update(view);
    }

    fn update(&mut self, view: &mut dyn View) {
        let event = self.setup.event.clone().is_some_and(|event| {
            let mut variables = [0.0; 8];
            variables[0] = view.time();
            if event.uses(1) {
                variables[1] = view.kinetic_energy();
            }
            if let Some(serial) = self.setup.body {
                let mut all = (0..view.bodies().n_bodies()).map(BodyId);
                // A body that has left has no place.
                let Some(b) = all.find(|b| view.serial(*b) == serial as u64) else { return false };
                let (pose, twist) = (view.bodies().pose(b), view.bodies().twist(b));
                for a in 0..3 {
                    (variables[2 + a], variables[5 + a]) = (pose.position[a], twist.linear[a]);
                }
            }
            event.needed(&variables) > 0.0
        });
        self.ending = if event {
            Some(Ending::Event)
        } else if self.setup.steady.is_some_and(|tolerance| self.rate < tolerance) {
            Some(Ending::Steady)
        } else {
            None
        };
    }
}

/// The rate of change; a state of a run without it has none yet.
impl Checkpoint for StopCheck {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("stop.rate", &[self.rate]);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.rate = source("stop.rate").and_then(|rate| rate.first().copied()).unwrap_or(f64::INFINITY);
        Ok(())
    }
}
