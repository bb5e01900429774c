//! The observer of the time loop, and what is saved.
use crate::any_simulation::AnySimulation;
use crate::deepest::Deepest;
use crate::history::History;
use crate::identity::Identity;
use crate::log::{Log, warn};
use crate::setup::Setup;
use crate::stop::StopCheck;
use crate::watch::{Audience, output};
use coupling::{CouplingError, Observer, StepInfo};
use interfaces::{Checkpoint, RestartError};
use render::progress::Progress;
use std::io;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// The most that there was in a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extremes {
    /// Shortest and longest step, largest Courant number.
    pub(crate) steps: [f64; 3],
    pub(crate) deepest: Deepest,
}

impl Default for Extremes {
    fn default() -> Self {
        Self { steps: [f64::INFINITY, 0.0, 0.0], deepest: Deepest::default() }
    }
}

/// All that is saved.
pub(crate) struct Whole<'a> {
    pub(crate) simulation: &'a mut dyn AnySimulation,
    pub(crate) extremes: &'a mut Extremes,
    pub(crate) stop: &'a mut Option<StopCheck>,
    pub(crate) identity: &'a Identity,
    /// Absent while a state is loaded: files go on from the time that has to be known first.
    pub(crate) audience: Option<&'a Audience>,
}

/// A number that takes 64 bits as two that doubles hold exactly.
pub(crate) fn halves(n: u64) -> [f64; 2] {
    [(n >> 32) as f64, (n & 0xffff_ffff) as f64]
}

impl Checkpoint for Whole<'_> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.identity.save(sink);
        sink("extremes", &self.extremes.steps);
        self.extremes.deepest.save(sink);
        self.stop.save(sink);
        self.simulation.save(sink);
        let budget = self.simulation.budget_state();
        budget.save(&mut |name, values| sink(&format!("books.{name}"), values));
        if let Some(audience) = self.audience {
            audience.save(&mut |name, values| sink(&format!("watch.{name}"), values));
        }
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        RestartError::fill(source, "extremes", &mut self.extremes.steps)?;
        self.extremes.deepest = Deepest::restore(source)?;
        self.stop.restore(source)?;
        self.simulation.restore(source)?;
        self.simulation.budget_state_mut().restore(&|name| source(&format!("books.{name}")))
    }
}

/// State of the observers.
pub(crate) struct Kept<'a>(pub(crate) &'a mut Audience);

impl Checkpoint for Kept<'_> {
    fn save(&self, _: &mut dyn FnMut(&str, &[f64])) {}
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.0.restore(&|name| source(&format!("watch.{name}")))
    }
}

/// The observer of the time loop: everyone who looks on, progress, log, saved states.
pub(crate) struct Look<'a> {
    pub(crate) setup: &'a Setup,
    pub(crate) audience: Audience,
    pub(crate) history: History,
    pub(crate) extremes: Extremes,
    pub(crate) stop: Option<StopCheck>,
    pub(crate) progress: Option<Progress>,
    pub(crate) log: Log,
    pub(crate) state: PathBuf,
    pub(crate) identity: &'a Identity,
    pub(crate) save_every: Duration,
    pub(crate) saved: Instant,
    /// No snapshot but the last.
    pub(crate) only_end: bool,
    /// Wall seconds spent on states.
    pub(crate) output: f64,
    /// And on the books.
    pub(crate) ledger: f64,
}

impl Look<'_> {
    fn save_if_due(&mut self, simulation: &mut dyn AnySimulation) -> Result<(), CouplingError> {
        if self.saved.elapsed() >= self.save_every { self.save(simulation) } else { Ok(()) }
    }
    /// Writes what tables hold in memory.
    pub(crate) fn flush(&mut self) -> Result<(), CouplingError> {
        self.audience.flush()?;
        self.history.flush()
    }
    pub(crate) fn save(&mut self, simulation: &mut dyn AnySimulation) -> Result<(), CouplingError> {
        let start = Instant::now();
        self.flush()?;
        let whole = Whole {
            simulation,
            extremes: &mut self.extremes,
            stop: &mut self.stop,
            identity: self.identity,
            audience: Some(&self.audience),
        };
        coupling::save(&self.state, &whole)
            .map_err(|e| output("saving the state in", &self.state)(io::Error::other(e)))?;
        self.saved = Instant::now();
        self.output += start.elapsed().as_secs_f64();
        Ok(())
    }
}

impl Observer<dyn AnySimulation> for Look<'_> {
    fn begin(&mut self, simulation: &mut (dyn AnySimulation + 'static)) {
        simulation.begin_budget();
        if let Some(stop) = &mut self.stop {
            stop.begin(&mut *simulation.view(self.setup));
        }
    }
    fn step(
        &mut self,
        simulation: &mut (dyn AnySimulation + 'static),
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let start = Instant::now();
        simulation.track_budget(info)?;
        self.ledger += start.elapsed().as_secs_f64();
        let [low, high, courant] = self.extremes.steps;
        self.extremes.steps = [low.min(info.dt), high.max(info.dt), courant.max(info.courant)];
        let (mut seen, budget) = simulation.view_with_budget(self.setup);
        self.audience.step(&mut *seen, info)?;
        self.history.step(&mut *seen, info, budget)?;
        if let Some(stop) = &mut self.stop {
            stop.step(&mut *seen, info);
        }
        let deep = self.extremes.deepest.look(&*seen, info);
        if let Some(progress) = &mut self.progress {
            progress.tell(info.step, info.time, || seen.status(info));
        }
        drop(seen);
        if deep && let Some(warning) = self.extremes.deepest.warning(self.setup) {
            warn(&mut self.log, &warning, self.progress.is_none())?;
        }
        if info.snapshot.is_none() && !self.finished() {
            self.save_if_due(simulation)?;
        }
        Ok(())
    }
    fn snapshot(
        &mut self,
        simulation: &mut (dyn AnySimulation + 'static),
        index: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        if self.only_end && index == 0 {
            return Ok(());
        }
        let mut seen = simulation.view(self.setup);
        self.audience.snapshot(&mut *seen, index, info)?;
        let (iterations, energy) = (seen.pressure_iterations(), seen.kinetic_energy());
        drop(seen);
        let StepInfo { step, time, dt, courant, .. } = *info;
        self.log.line(&format!(
            "t = {time:.6e} s, step {step}, dt {dt:.3e} s, Courant {courant:.3}, kinetic energy {energy:.6e} J{}",
            if iterations > 0 { format!(", {iterations} pressure iterations") } else { String::new() }
        ))?;
        self.save_if_due(simulation)
    }
    fn finished(&self) -> bool {
        self.stop.as_ref().is_some_and(|stop| stop.ending().is_some())
    }
}
