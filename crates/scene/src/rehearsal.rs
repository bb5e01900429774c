//! Run on a coarse grid, which gives the speeds of a run with free bodies, and what later steps cost
//! beyond the first ones.
use crate::any_simulation::AnySimulation;
use crate::assembly::Assembled;
use crate::estimate::one_thread;
use crate::pile::is_free;
use crate::run::RunError;
use crate::setup::Setup;
use coupling::{CouplingError, Observer, StepInfo};
use cpu_time::ThreadTime;
use fv_mesh::Axis;
use ibm::SmoothForcing;
use std::sync::atomic::{AtomicBool, Ordering};

/// CPU time \[s\] for which the coarse grid is chosen; twice as much ends the rehearsal.
const TIME: f64 = 1.0;
/// Time of a whole rehearsal over `TIME` above which there is none: too little of the run is seen.
const LONGEST: f64 = 8.0;
/// Divisor of the coarse numbers of cells, so that solvers find levels and short transforms.
const MULTIPLE: usize = 8;
/// First steps, of which the shortest is what a step costs without bodies that come or touch later.
const FIRST: usize = 4;

/// Speeds and costs during a rehearsal.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rehearsal {
    /// CPU times of steps \[s\].
    costs: Vec<f64>,
    /// Surface cells of the run over those of the rehearsal.
    surface: f64,
    /// Times at the ends of steps \[s\].
    times: Vec<f64>,
    /// Σ max|u_a|/h_a with the cells of the run \[1/s\].
    rates: Vec<f64>,
}

impl Rehearsal {
    /// Σ max|u_a|/h_a of the run at `time`, behind the end of the rehearsal the larger of its last one
    /// and the `likely` one \[1/s\].
    pub(crate) fn rate(&self, time: f64, likely: impl Fn(f64) -> f64) -> f64 {
        match self.rates.get(self.times.partition_point(|&end| end < time)) {
            Some(rate) => *rate,
            None => self.rates.last().copied().unwrap_or(0.0).max(likely(time)),
        }
    }

    /// CPU time of a run of so many `steps` beyond that of as many first ones \[s\]: what bodies add
    /// grows with the cells at their surfaces.
    pub(crate) fn later(&self, steps: f64) -> f64 {
        let (first, others) = self.costs.split_at(FIRST.min(self.costs.len()));
        let mean = others.iter().sum::<f64>() / others.len().max(1) as f64;
        let first = first.iter().copied().fold(f64::INFINITY, f64::min);
        (mean - first).max(0.0) * self.surface * steps
    }
}

impl Setup {
    /// Rehearsal of a scene whose run takes `cost` \[s\] of CPU time; none without free bodies in a
    /// fluid, with steps of given length, or if a grid that resolves the bodies would take too long.
    pub(crate) fn rehearse(&self, cost: f64) -> Option<Rehearsal> {
        let power = self.dim() as f64 + 1.0;
        let smallest = self.sizes().fold(f64::INFINITY, f64::min);
        let coarsest = smallest / (SmoothForcing::LEAST_CELLS * self.narrowest());
        let factor = (cost / TIME).powf(power.recip()).clamp(1.0, coarsest.max(1.0));
        let free = !self.bodies.inflows.is_empty() || self.bodies.list.iter().any(is_free);
        let short = cost / factor.powf(power) <= LONGEST * TIME;
        if self.fluid.is_none() || !free || self.dt.is_some() || coarsest < 1.0 || !short {
            return None;
        }
        let cells = |axis: &Axis| {
            let wider = (axis.cells() as f64 / factor).ceil() as usize;
            wider.next_multiple_of(MULTIPLE).min(axis.cells())
        };
        let coarse = self.with_cells(cells).ok()?;
        let ratio = (self.cells() as f64 / coarse.cells() as f64).powf((power - 1.0).recip());
        let rehearsed = one_thread(|| coarse.run_through(ratio)).ok()?;
        rehearsed.ok().filter(|rehearsal| !rehearsal.rates.is_empty())
    }

    /// Runs to the end, with the speeds for cells `ratio` times narrower.
    fn run_through(&self, ratio: f64) -> Result<Rehearsal, RunError> {
        let Assembled::Unsteady(mut simulation) = self.assemble()? else {
            return Ok(Rehearsal::default());
        };
        let (schedule, stop) = (self.schedule(&*simulation), AtomicBool::new(false));
        let surface = ratio.powi(self.dim() as i32 - 1);
        let rehearsal = Rehearsal { surface, ..Rehearsal::default() };
        let now = ThreadTime::now();
        let mut speeds = Speeds { ratio, rehearsal, start: now, last: now, stop: &stop };
        coupling::run(&mut *simulation, &schedule, &mut speeds, &stop)?;
        Ok(speeds.rehearsal)
    }
}

/// Observer that notes speeds and costs, and stops a rehearsal that takes too long.
struct Speeds<'a> {
    ratio: f64,
    rehearsal: Rehearsal,
    start: ThreadTime,
    last: ThreadTime,
    stop: &'a AtomicBool,
}

impl Observer<dyn AnySimulation> for Speeds<'_> {
    fn step(
        &mut self,
        simulation: &mut (dyn AnySimulation + 'static),
        _: &StepInfo,
    ) -> Result<(), CouplingError> {
        self.rehearsal.costs.push(self.last.elapsed().as_secs_f64());
        self.rehearsal.times.push(simulation.time());
        self.rehearsal.rates.push(self.ratio * simulation.courant(1.0));
        if self.start.elapsed().as_secs_f64() > 2.0 * TIME {
            self.stop.store(true, Ordering::Relaxed);
        }
        self.last = ThreadTime::now();
        Ok(())
    }
}
