//! First steps of a scene.
use crate::any_simulation::AnySimulation;
use crate::assembly::Assembled;
use crate::build_error::BuildError;
use crate::look::Extremes;
use crate::result::{Ending, RunResult};
use crate::run::{RunError, STATE};
use crate::setup::Setup;
use crate::steady::Steady;
use crate::still::Still;
use crate::view::{Seen, View};
use crate::wall_iterations::WallIterations;
use crate::watch::Audience;
use coupling::{CouplingError, Observer, StepInfo};
use cpu_time::ThreadTime;
use interfaces::{Checkpoint, ThinPart};
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// First steps of a scene.
pub(crate) struct Trial<'a> {
    pub(crate) setup: &'a Setup,
    /// Folder for the files of snapshots and a state; without it none are written.
    pub(crate) folder: Option<&'a Path>,
}

/// Findings of a trial.
pub(crate) struct Tried {
    /// Longest step \[s\] that is stable however slow the flow is, and Courant number per time
    /// \[1/s\] at the start; none for a steady flow.
    pub(crate) limits: Option<[f64; 2]>,
    /// Pressure solver, and why it is taken.
    pub(crate) pressure: String,
    /// Parts of bodies that are too thin for the grid.
    pub(crate) thin: Vec<ThinPart>,
    pub(crate) cost: Cost,
    /// Whether a disk failed, so that the cost lacks files.
    pub(crate) unwritten: bool,
}

/// CPU time of the parts of a run \[s\].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Cost {
    /// Step or iteration.
    pub(crate) step: f64,
    /// Files of a snapshot with a picture, and of one without.
    pub(crate) snapshot: [f64; 2],
    /// Saved state.
    pub(crate) state: f64,
    /// Parts of the run that its first steps do not have.
    pub(crate) later: f64,
    /// Iterations that end during the run.
    pub(crate) iterations: Option<WallIterations>,
}

impl Cost {
    /// Combination of both, part by part.
    pub(crate) fn with(self, other: Self, combine: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            step: combine(self.step, other.step),
            snapshot: [0, 1].map(|k| combine(self.snapshot[k], other.snapshot[k])),
            state: combine(self.state, other.state),
            later: combine(self.later, other.later),
            iterations: self.iterations.or(other.iterations),
        }
    }
}

/// Steps of a trial, at least and at most, and the time after which no more begin: in the second
/// what the first has made is replaced, which takes the memory of both.
const STEPS: [u32; 2] = [2, 4];
const TIME: Duration = Duration::from_millis(250);

/// Courant number that limits no step.
pub(crate) const ANY_COURANT: f64 = 1e9;

impl Trial<'_> {
    /// Requires that references point to what a result has.
    fn check_references(&self, view: &mut dyn View) -> Result<(), BuildError> {
        if self.setup.references.is_empty() {
            return Ok(());
        }
        let (extremes, audience) = (Extremes::default(), Audience::new(Vec::new()));
        let (ending, folder) = (Ending::Stopped, Path::new(""));
        let result = RunResult::new(self.setup, view, &extremes, None, &audience, ending, folder);
        self.setup.check_references(&result.result)
    }
}

/// Files of a trial. A disk that fails is no matter of the scene.
struct Files<'a> {
    folder: Option<&'a Path>,
    audience: Option<Audience>,
    written: bool,
    failed: bool,
}

impl<'a> Files<'a> {
    fn new(trial: &Trial<'a>) -> Result<Self, CouplingError> {
        let mut files = Self { folder: trial.folder, audience: None, written: false, failed: false };
        if let Some(folder) = trial.folder {
            files.audience = files.unless_disk_fails(trial.setup.audience(folder, None, true))?;
        }
        Ok(files)
    }

    /// The output, or none if a disk fails.
    ///
    /// # Errors
    /// Other reasons.
    fn unless_disk_fails<T>(&mut self, output: Result<T, CouplingError>) -> Result<Option<T>, CouplingError> {
        match output {
            Ok(output) => Ok(Some(output)),
            Err(CouplingError::Output { source, .. }) if source.kind() != io::ErrorKind::InvalidInput => {
                self.failed = true;
                Ok(None)
            }
            Err(error) => Err(error),
        }
    }

    /// Shows a step.
    fn step(&mut self, view: &mut dyn View, info: &StepInfo) -> Result<(), CouplingError> {
        let Some(audience) = &mut self.audience else { return Ok(()) };
        let shown = audience.step(view, info);
        self.unless_disk_fails(shown).map(drop)
    }

    /// Saves a state.
    fn save(&mut self, of: &(impl Checkpoint + ?Sized), cost: &mut Cost) {
        let Some(folder) = self.folder else { return };
        let start = ThreadTime::now();
        self.failed |= coupling::save(&folder.join(STATE), of).is_err();
        cost.state = start.elapsed().as_secs_f64();
    }

    /// Writes snapshots.
    fn write(&mut self, view: &mut dyn View, cost: &mut Cost) -> Result<(), CouplingError> {
        self.written = true;
        let info = StepInfo { step: view.steps(), time: view.time(), dt: 1.0, courant: 0.0, snapshot: None };
        for (index, cost) in cost.snapshot.iter_mut().enumerate() {
            let Some(audience) = &mut self.audience else { return Ok(()) };
            let start = ThreadTime::now();
            let shown = audience.snapshot(view, index, &info);
            self.unless_disk_fails(shown)?;
            *cost = start.elapsed().as_secs_f64();
        }
        Ok(())
    }
}

/// Observer that times steps, stops after some and writes files.
struct FirstSteps<'a> {
    setup: &'a Setup,
    files: Files<'a>,
    stop: &'a AtomicBool,
    timer: Timer,
    cost: Cost,
}

impl FirstSteps<'_> {
    /// Writes files while the memory of a step is held.
    fn write(&mut self, simulation: &mut dyn AnySimulation) -> Result<(), CouplingError> {
        self.cost.step = self.timer.shortest();
        let mut view = simulation.view(self.setup);
        self.cost.iterations = WallIterations::of(&*view, self.timer.share());
        self.files.write(&mut *view, &mut self.cost)?;
        drop(view);
        self.files.save(simulation, &mut self.cost);
        Ok(())
    }
}

/// Clock of the first steps.
struct Timer {
    begin: Instant,
    start: ThreadTime,
    last: ThreadTime,
    steps: u32,
    shortest: f64,
}

impl Timer {
    fn start() -> Self {
        let now = ThreadTime::now();
        Self { begin: Instant::now(), start: now, last: now, steps: 0, shortest: f64::INFINITY }
    }

    /// Notes a step; returns whether another may begin.
    fn note(&mut self) -> bool {
        self.shortest = self.shortest.min(self.last.elapsed().as_secs_f64());
        self.last = ThreadTime::now();
        self.steps += 1;
        self.steps < STEPS[0] || self.steps < STEPS[1] && self.begin.elapsed() < TIME
    }

    /// CPU time over wall time, which is less than 1 where other processes are busy.
    fn share(&self) -> f64 {
        let wall = self.begin.elapsed().as_secs_f64();
        if wall > 0.0 { (self.start.elapsed().as_secs_f64() / wall).min(1.0) } else { 1.0 }
    }

    /// Shortest step that was noted; 0 without one.
    fn shortest(&self) -> f64 {
        if self.steps > 0 { self.shortest } else { 0.0 }
    }
}

impl Observer<dyn AnySimulation> for FirstSteps<'_> {
    fn begin(&mut self, simulation: &mut (dyn AnySimulation + 'static)) {
        simulation.begin_budget();
        self.timer = Timer::start();
    }
    fn step(
        &mut self,
        simulation: &mut (dyn AnySimulation + 'static),
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        simulation.track_budget(info)?;
        self.files.step(&mut *simulation.view(self.setup), info)?;
        if !self.timer.note() {
            self.write(simulation)?;
            self.stop.store(true, Ordering::Relaxed);
        }
        Ok(())
    }
}

impl Trial<'_> {
    /// Takes the first steps.
    pub(crate) fn run(&self) -> Result<Tried, RunError> {
        match self.setup.assemble()? {
            Assembled::Unsteady(mut simulation) => self.march(&mut *simulation),
            Assembled::Steady2(flow) => self.converge(*flow),
            Assembled::Steady3(flow) => self.converge(*flow),
        }
    }

    fn march(&self, simulation: &mut (dyn AnySimulation + 'static)) -> Result<Tried, RunError> {
        let setup = self.setup;
        let schedule = setup.schedule(simulation);
        // Without regard to convection: implicit viscous terms do not limit it.
        let limits = Some([simulation.stable_dt(ANY_COURANT), simulation.courant(1.0)]);
        let (files, stop, timer) = (Files::new(self)?, AtomicBool::new(false), Timer::start());
        let mut first = FirstSteps { setup, files, stop: &stop, timer, cost: Cost::default() };
        coupling::run(simulation, &schedule, &mut first, &stop)?;
        if !first.files.written {
            first.write(simulation)?;
        }
        let mut view = simulation.view(setup);
        self.check_references(&mut *view)?;
        let (pressure, thin) = (view.pressure_solver(), view.thin().to_vec());
        Ok(Tried { limits, pressure, thin, cost: first.cost, unwritten: first.files.failed })
    }

    fn converge<const D: usize>(&self, mut steady: Steady<D>) -> Result<Tried, RunError> {
        let mut timer = Timer::start();
        loop {
            steady.iterate().map_err(BuildError::from)?;
            if !timer.note() {
                break;
            }
        }
        let (mut files, mut cost) = (Files::new(self)?, Cost { step: timer.shortest(), ..Cost::default() });
        let still = Still { bodies: self.setup.still(), thin: std::mem::take(&mut steady.thin) };
        let (timings, force) = (coupling::Timings::default(), interfaces::Vector::zeros());
        let mut view = Seen { flow: &mut steady, guests: &still, timings, force };
        files.write(&mut view, &mut cost)?;
        self.check_references(&mut view)?;
        let pressure = view.pressure_solver();
        files.save(&steady, &mut cost);
        Ok(Tried { limits: None, pressure, thin: still.thin, cost, unwritten: files.failed })
    }
}
