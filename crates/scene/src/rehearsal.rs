//! Run on a coarse grid, which gives the speeds of a run with free bodies.
use crate::any_simulation::AnySimulation;
use crate::assembly::Assembled;
use crate::estimate::one_thread;
use crate::pace::equivalent_diameter;
use crate::pile::is_free;
use crate::run::RunError;
use crate::setup::{BodySetup, Setup};
use coupling::{CouplingError, Observer, StepInfo};
use cpu_time::ThreadTime;
use std::sync::atomic::{AtomicBool, Ordering};

/// CPU time \[s\] for which the coarse grid is chosen; twice as much is the limit.
const TIME: f64 = 1.0;
/// Coarse cells across a disc or ball of the least body's volume, at least.
const CELLS_ACROSS: f64 = 4.0;

/// Speeds during a rehearsal.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rehearsal {
    /// Times at the ends of steps \[s\].
    times: Vec<f64>,
    /// Σ max|u_a|/h_a with the cells of the run \[1/s\].
    rates: Vec<f64>,
}

impl Rehearsal {
    /// Σ max|u_a|/h_a of the run at `time`; behind the end of the rehearsal the last one \[1/s\].
    pub(crate) fn rate(&self, time: f64) -> f64 {
        let at = self.times.partition_point(|&end| end < time).min(self.rates.len() - 1);
        self.rates[at]
    }
}

impl Setup {
    /// Rehearsal of a scene whose run takes `cost` \[s\] of CPU time; none without free bodies in a
    /// fluid, with steps of given length, or if a grid that resolves the bodies would take too long.
    pub(crate) fn rehearse(&self, cost: f64) -> Option<Rehearsal> {
        let size = |b: &BodySetup| equivalent_diameter(b.shape.inertia(1.0).volume, self.dim());
        let smallest = self.bodies.list.iter().filter(|b| is_free(b)).map(size).reduce(f64::min)?;
        let dim = self.dim() as f64;
        let factor = (cost / TIME).powf(1.0 / (dim + 1.0)).max(1.0);
        let resolved = smallest >= CELLS_ACROSS * factor * self.narrowest();
        if self.fluid.is_none() || self.dt.is_some() || !resolved {
            return None;
        }
        let coarse = self.coarser((self.cells() as f64 / factor.powf(dim)) as usize).ok()?;
        let ratio = (self.cells() as f64 / coarse.cells() as f64).powf(dim.recip());
        let rehearsed = one_thread(|| coarse.run_through(ratio)).ok()?;
        rehearsed.ok().filter(|rehearsal| !rehearsal.rates.is_empty())
    }

    /// Runs to the end, with the speeds for cells `ratio` times narrower.
    fn run_through(&self, ratio: f64) -> Result<Rehearsal, RunError> {
        let Assembled::Unsteady(mut simulation) = self.assemble()? else {
            return Ok(Rehearsal::default());
        };
        let (schedule, stop) = (self.schedule(&*simulation), AtomicBool::new(false));
        let (rehearsal, start) = (Rehearsal::default(), ThreadTime::now());
        let mut speeds = Speeds { ratio, rehearsal, start, stop: &stop };
        coupling::run(&mut *simulation, &schedule, &mut speeds, &stop)?;
        Ok(speeds.rehearsal)
    }
}

/// Observer that notes speeds and stops a rehearsal that takes too long.
struct Speeds<'a> {
    ratio: f64,
    rehearsal: Rehearsal,
    start: ThreadTime,
    stop: &'a AtomicBool,
}

impl Observer<dyn AnySimulation> for Speeds<'_> {
    fn step(
        &mut self,
        simulation: &mut (dyn AnySimulation + 'static),
        _: &StepInfo,
    ) -> Result<(), CouplingError> {
        self.rehearsal.times.push(simulation.time());
        self.rehearsal.rates.push(self.ratio * simulation.courant(1.0));
        if self.start.elapsed().as_secs_f64() > 2.0 * TIME {
            self.stop.store(true, Ordering::Relaxed);
        }
        Ok(())
    }
}
