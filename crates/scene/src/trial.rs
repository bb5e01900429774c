//! First steps of a scene, without files.
use crate::assembly::Execution;
use crate::build_error::BuildError;
use crate::look::{Books, Extremes, Show};
use crate::result::{Ending, RunResult};
use crate::run::RunError;
use crate::setup::Setup;
use crate::steady::Steady;
use crate::still::Still;
use crate::view::{Seen, View};
use crate::watch::Audience;
use coupling::{CouplingError, Observer, StepInfo};
use interfaces::ThinPart;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Execution of the first steps.
pub(crate) struct Trial<'a>(pub(crate) &'a Setup);

/// Findings of a trial.
pub(crate) struct Tried {
    /// Longest step \[s\] that is stable however slow the flow is, and Courant number per time
    /// \[1/s\] at the start; none for a steady flow.
    pub(crate) limits: Option<[f64; 2]>,
    /// Pressure solver, and why it is taken.
    pub(crate) pressure: String,
    /// Parts of bodies that are too thin for the grid.
    pub(crate) thin: Vec<ThinPart>,
    /// Wall time of a step or an iteration \[s\]; none without one.
    pub(crate) step: Option<f64>,
}

/// Steps of a trial, at most, and the time after which none begins.
const STEPS: u32 = 4;
const TIME: Duration = Duration::from_millis(250);

/// Courant number that limits no step.
pub(crate) const ANY_COURANT: f64 = 1e9;

impl Trial<'_> {
    /// Findings after the first steps; requires that references point to what a result has.
    fn found(
        &self,
        view: &mut dyn View,
        limits: Option<[f64; 2]>,
        step: Option<f64>,
    ) -> Result<Tried, BuildError> {
        if !self.0.references.is_empty() {
            let (extremes, audience) = (Extremes::default(), Audience::new(Vec::new()));
            let ending = Ending::Stopped;
            let result = RunResult::new(self.0, view, &extremes, None, &audience, ending, Path::new(""));
            self.0.check_references(&result.result)?;
        }
        Ok(Tried { limits, pressure: view.pressure_solver(), thin: view.thin().to_vec(), step })
    }
}

/// Observer that times steps and stops after some.
struct FirstSteps<'a> {
    stop: &'a AtomicBool,
    begin: Instant,
    last: Instant,
    steps: u32,
    shortest: Option<f64>,
}

impl<'a> FirstSteps<'a> {
    fn new(stop: &'a AtomicBool) -> Self {
        let now = Instant::now();
        Self { stop, begin: now, last: now, steps: 0, shortest: None }
    }

    /// Notes a step; returns whether another may begin.
    fn note(&mut self) -> bool {
        let time = self.last.elapsed().as_secs_f64();
        self.last = Instant::now();
        self.shortest = Some(self.shortest.map_or(time, |shortest| shortest.min(time)));
        self.steps += 1;
        self.steps < STEPS && self.begin.elapsed() < TIME
    }
}

impl<S> Observer<S> for FirstSteps<'_> {
    fn begin(&mut self, _: &mut S) {
        self.begin = Instant::now();
        self.last = self.begin;
    }
    fn step(&mut self, _: &mut S, _: &StepInfo) -> Result<(), CouplingError> {
        if !self.note() {
            self.stop.store(true, Ordering::Relaxed);
        }
        Ok(())
    }
}

impl Execution for Trial<'_> {
    type Output = Tried;

    fn march<S: Show, K: Books<S>>(&self, mut simulation: S, _: K) -> Result<Tried, RunError> {
        let setup = self.0;
        let schedule = setup.schedule(&simulation);
        // Without regard to convection: implicit viscous terms do not limit it.
        let limits = [simulation.stable_dt(ANY_COURANT), simulation.courant(1.0)];
        let stop = AtomicBool::new(false);
        let mut first = FirstSteps::new(&stop);
        coupling::run(&mut simulation, &schedule, &mut first, &stop)?;
        Ok(self.found(&mut simulation.see(setup), Some(limits), first.shortest)?)
    }

    fn converge<const D: usize>(&self, mut steady: Steady<D>) -> Result<Tried, RunError> {
        let stop = AtomicBool::new(false);
        let mut first = FirstSteps::new(&stop);
        loop {
            steady.iterate().map_err(BuildError::from)?;
            if !first.note() {
                break;
            }
        }
        let still = Still { bodies: self.0.still(), thin: std::mem::take(&mut steady.thin) };
        let mut view = Seen { flow: &mut steady, guests: &still, timings: coupling::Timings::default() };
        Ok(self.found(&mut view, None, first.shortest)?)
    }
}
