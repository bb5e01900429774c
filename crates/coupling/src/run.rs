//! The run loop.
use crate::CouplingError;
use crate::state_copy::StateCopy;
use fv_mesh::FlowError;
use interfaces::Checkpoint;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a run moves on in time: a [`Simulation`](crate::Simulation) of flow and bodies, or [`Grains`](crate::Grains) without a fluid.
pub trait Evolving: Checkpoint {
    /// Before every step: bodies that are due come and go. A second call in a row does nothing.
    ///
    /// # Errors
    /// [`CouplingError`] when it cannot begin.
    fn begin(&mut self) -> Result<(), CouplingError>;
    /// One step of length `dt` \[s\].
    ///
    /// # Errors
    /// [`CouplingError`] when it cannot go on.
    fn step(&mut self, dt: f64) -> Result<(), CouplingError>;
    /// Time \[s\].
    fn time(&self) -> f64;
    /// Sets the clock exactly.
    fn set_time(&mut self, time: f64);
    /// Steps made.
    fn steps(&self) -> u64;
    /// Length of the last step \[s\].
    fn last_dt(&self) -> f64;
    /// Courant number of a step of `dt`.
    fn courant(&self, dt: f64) -> f64;
    /// Whether the Courant number may be other than zero.
    fn convects(&self) -> bool {
        true
    }
    /// The longest step \[s\] that is stable and ends with a Courant number ≤ `courant`, as far as is known before it; infinite if any is.
    fn stable_dt(&self, courant: f64) -> f64;
    /// The longest step \[s\] that is stable however slow everything is; infinite if any is.
    fn longest_dt(&self) -> f64;
}

/// How long to run, in which steps, and when to show the state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// End time \[s\].
    pub end: f64,
    /// Equal intervals from 0 to the end; observers see the state at both ends of each.
    pub intervals: usize,
    /// The time step \[s\]; `None` takes the largest that `courant` and stability allow.
    pub dt: Option<f64>,
    /// Courant number that no automatic step exceeds: one that would is taken back and repeated with a shorter step.
    pub courant: f64,
    /// First step of a start from rest as a share of the time step, and by which factor steps may
    /// then grow: a body set free in a fluid at rest accelerates like √t.
    pub ramp: [f64; 2],
}

impl Default for Schedule {
    fn default() -> Self {
        Self { end: 1.0, intervals: 100, dt: None, courant: 0.1, ramp: [0.05, 1.15] }
    }
}

impl Schedule {
    /// Does it make sense?
    ///
    /// # Errors
    /// [`CouplingError::Schedule`] that names the value and what to give instead.
    pub fn check(&self) -> Result<(), CouplingError> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let tests = [
            ("end time", self.end, positive(self.end), "give a positive number of seconds"),
            ("number of intervals", self.intervals as f64, self.intervals > 0, "give at least 1"),
            (
                "time step",
                self.dt.unwrap_or(1.0),
                self.dt.is_none_or(positive),
                "give a positive number of seconds, or none",
            ),
            ("Courant number", self.courant, positive(self.courant), "give one between 0.05 and 0.5"),
            (
                "first step's share",
                self.ramp[0],
                positive(self.ramp[0]) && self.ramp[0] <= 1.0,
                "give at most 1",
            ),
            (
                "growth of steps",
                self.ramp[1],
                self.ramp[1].is_finite() && self.ramp[1] > 1.0,
                "give more than 1",
            ),
        ];
        match tests.into_iter().find(|t| !t.2) {
            Some((name, value, _, remedy)) => Err(CouplingError::Schedule { name, value, remedy }),
            None => Ok(()),
        }
    }

    /// Time of snapshot `i` \[s\].
    pub fn time(&self, i: usize) -> f64 {
        self.end * i as f64 / self.intervals as f64
    }
}

/// What observers are told after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepInfo {
    /// Steps made.
    pub step: u64,
    /// Time \[s\].
    pub time: f64,
    /// Length of the step \[s\].
    pub dt: f64,
    /// Courant number of the step.
    pub courant: f64,
    /// The step ends an interval: the snapshot with this index follows. A state that is saved to go on from is saved behind it, not before: who goes on from a state at the
    /// end of an interval takes its snapshot as made.
    pub snapshot: Option<usize>,
}

/// Someone who looks on: progress, output, probes, statistics. `()` sees nothing; pairs of
/// observers, and one that may be absent (`Option`), are observers.
pub trait Observer<S: ?Sized> {
    /// Before the first step of this run, which may go on from a saved state.
    fn begin(&mut self, _simulation: &mut S) {}
    /// After every step.
    ///
    /// # Errors
    /// What it could not do; the run then ends with that error.
    fn step(&mut self, _simulation: &mut S, _info: &StepInfo) -> Result<(), CouplingError> {
        Ok(())
    }
    /// At the start (`index` 0) and the end of every interval.
    ///
    /// # Errors
    /// What it could not do; the run then ends with that error.
    fn snapshot(
        &mut self,
        _simulation: &mut S,
        _index: usize,
        _info: &StepInfo,
    ) -> Result<(), CouplingError> {
        Ok(())
    }
    /// Whether the run is to end after the last step, before its time: at a steady state, or an
    /// event. A snapshot follows.
    fn finished(&self) -> bool {
        false
    }
}

impl<S: ?Sized> Observer<S> for () {}

impl<S: ?Sized, A: Observer<S>, B: Observer<S>> Observer<S> for (A, B) {
    fn begin(&mut self, simulation: &mut S) {
        self.0.begin(simulation);
        self.1.begin(simulation);
    }
    fn step(&mut self, simulation: &mut S, info: &StepInfo) -> Result<(), CouplingError> {
        self.0.step(simulation, info)?;
        self.1.step(simulation, info)
    }
    fn snapshot(&mut self, simulation: &mut S, index: usize, info: &StepInfo) -> Result<(), CouplingError> {
        self.0.snapshot(simulation, index, info)?;
        self.1.snapshot(simulation, index, info)
    }
    fn finished(&self) -> bool {
        self.0.finished() || self.1.finished()
    }
}

impl<S: ?Sized, A: Observer<S>> Observer<S> for Option<A> {
    fn begin(&mut self, simulation: &mut S) {
        if let Some(a) = self {
            a.begin(simulation);
        }
    }
    fn step(&mut self, simulation: &mut S, info: &StepInfo) -> Result<(), CouplingError> {
        self.as_mut().map_or(Ok(()), |a| a.step(simulation, info))
    }
    fn snapshot(&mut self, simulation: &mut S, index: usize, info: &StepInfo) -> Result<(), CouplingError> {
        self.as_mut().map_or(Ok(()), |a| a.snapshot(simulation, index, info))
    }
    fn finished(&self) -> bool {
        self.as_ref().is_some_and(A::finished)
    }
}

impl<S: ?Sized, A: Observer<S>> Observer<S> for &mut A {
    fn begin(&mut self, simulation: &mut S) {
        (**self).begin(simulation);
    }
    fn step(&mut self, simulation: &mut S, info: &StepInfo) -> Result<(), CouplingError> {
        (**self).step(simulation, info)
    }
    fn snapshot(&mut self, simulation: &mut S, index: usize, info: &StepInfo) -> Result<(), CouplingError> {
        (**self).snapshot(simulation, index, info)
    }
    fn finished(&self) -> bool {
        (**self).finished()
    }
}

/// A step that the Courant number makes this much shorter than diffusion alone would is no step.
const COLLAPSED: f64 = 1e-6;

/// Beyond this Courant number no explicit step is to be trusted.
const MOST_COURANT: f64 = 1.5;

/// Share of a step, an interval or a Courant number below which a rest is round-off.
const ROUND_OFF: f64 = 1e-6;

/// How a run went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RunSummary {
    /// Steps made.
    pub steps: u64,
    /// Shortest and longest step \[s\].
    pub dt: [f64; 2],
    /// Largest Courant number.
    pub courant: f64,
    /// Steps that were taken back because they exceeded the Courant number of the schedule.
    pub repeats: u64,
    /// Did `stop` end it?
    pub stopped: bool,
    /// Whether an observer ended it ([`Observer::finished`]).
    pub finished: bool,
}

/// Makes a step of `dt` \[s\]. Returns its Courant number if that exceeds the `limit`, the state then being that after the step or, when the flow has diverged, within it.
fn went_too_far<S: Evolving + ?Sized>(
    simulation: &mut S,
    dt: f64,
    limit: Option<f64>,
) -> Result<Option<f64>, CouplingError> {
    let courant = match (simulation.step(dt), limit) {
        (Ok(()), _) => simulation.courant(dt),
        (Err(CouplingError::Flow(FlowError::Diverged { courant, .. })), Some(_)) if courant.is_finite() => {
            courant
        }
        (Err(error), _) => return Err(error),
    };
    Ok(limit.filter(|limit| courant > (1.0 + ROUND_OFF) * limit).map(|_| courant))
}

/// Runs to the schedule's end, or until `stop` is set. Call it inside a rayon pool
/// (`pool.install(|| run(…))`): then steps do not allocate.
///
/// # Errors
/// The first error of a step or an observer. After an error within a step the simulation is between
/// two steps: go on from a saved state.
pub fn run<S: Evolving + ?Sized>(
    simulation: &mut S,
    schedule: &Schedule,
    observer: &mut impl Observer<S>,
    stop: &AtomicBool,
) -> Result<RunSummary, CouplingError> {
    schedule.check()?;
    let mut summary = RunSummary { dt: [f64::INFINITY, 0.0], ..RunSummary::default() };
    let mut info = StepInfo {
        step: simulation.steps(),
        time: simulation.time(),
        dt: simulation.last_dt(),
        courant: 0.0,
        snapshot: None,
    };
    // Ends of intervals that are behind, up to round-off: other schedules cut time otherwise.
    let behind = info.time + ROUND_OFF * schedule.end / schedule.intervals as f64;
    let mut index = (0..=schedule.intervals).take_while(|&i| schedule.time(i) <= behind).count().max(1) - 1;
    let automatic = schedule.dt.is_none() && simulation.convects();
    let mut before = StateCopy::default();
    // Gone on from its end, a run has no step to make ready for: no body comes in.
    if index < schedule.intervals {
        simulation.begin()?;
    }
    observer.begin(simulation);
    if info.step == 0 {
        info.snapshot = Some(0);
        observer.snapshot(simulation, 0, &info)?;
    }
    // A run that was finished has no step left.
    summary.finished = observer.finished();
    while index < schedule.intervals && !summary.finished {
        let target = schedule.time(index + 1);
        loop {
            if stop.load(Ordering::Relaxed) {
                summary.stopped = true;
                return Ok(summary);
            }
            let [first, growth] = schedule.ramp;
            let share = (first * growth.powf(info.step as f64)).min(1.0);
            // Nothing limits the step of a fluid at rest without viscosity but the run itself.
            let mut full =
                schedule.dt.unwrap_or_else(|| simulation.stable_dt(schedule.courant).min(schedule.end));
            simulation.begin()?;
            if automatic {
                before.take(simulation);
            }
            let left = target - simulation.time();
            let mut tried = 0;
            let (dt, steps) = loop {
                if full < COLLAPSED * simulation.longest_dt().min(schedule.end) {
                    let time = simulation.time();
                    return Err(CouplingError::Collapsed { dt: full, time, courant: schedule.courant });
                }
                // Equal steps to the end of the interval, up to round-off in the number of steps.
                let steps = (left / (full * share) - ROUND_OFF).ceil().max(1.0);
                let dt = left / steps;
                let Some(courant) = went_too_far(simulation, dt, automatic.then_some(schedule.courant))?
                else {
                    break (dt, steps);
                };
                before.give_back(simulation)?;
                simulation.begin()?;
                // An impulsive start gives the same velocity after any step; if a shorter step gives more, it is halved.
                let shorter = dt * schedule.courant / courant;
                full = if tried == 0 { shorter } else { shorter.min(0.5 * dt) } / share;
                tried += 1;
            };
            summary.repeats += tried;
            if steps == 1.0 {
                simulation.set_time(target);
            }
            info = StepInfo {
                step: simulation.steps(),
                time: simulation.time(),
                dt,
                courant: simulation.courant(dt),
                snapshot: (steps == 1.0).then_some(index + 1),
            };
            if info.courant > MOST_COURANT {
                return Err(CouplingError::Courant { courant: info.courant, dt, time: info.time });
            }
            summary.steps += 1;
            summary.dt = [summary.dt[0].min(dt), summary.dt[1].max(dt)];
            summary.courant = summary.courant.max(info.courant);
            observer.step(simulation, &info)?;
            summary.finished = observer.finished();
            if steps == 1.0 || summary.finished {
                break;
            }
        }
        index += 1;
        observer.snapshot(simulation, index, &info)?;
    }
    Ok(summary)
}
