//! The full model: two discs fall, and every snapshot is handed on while they do.
use example_support::Outcome;
use example_support::scene::{FLUID, Scene};
use render::cpu::{Elapsed, Stopwatch};
use render::progress::{Progress, Status};
use siltflow::coupling::{
    self, BodyPaths, CouplingError, Observer, Particles, Quantity, Schedule, Simulation, SnapshotFeed,
    StepInfo,
};
use siltflow::dem::RigidBodies;
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{Pose, SnapshotSink};
use std::error::Error;
use std::sync::atomic::AtomicBool;

type Fall = Simulation<2, Particles<SmoothForcing, RigidBodies>>;

/// Snapshots one after the other.
#[derive(Default)]
pub(crate) struct Columns {
    pub(crate) times: Vec<f64>,
    pub(crate) values: Vec<f64>,
}

impl SnapshotSink for Columns {
    fn push(&mut self, time: f64, field: &[f64]) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.times.push(time);
        self.values.extend_from_slice(field);
        Ok(())
    }
}

/// What the run left.
pub(crate) struct Fallen {
    pub(crate) times: Vec<f64>,
    /// λ, one column per time.
    pub(crate) lambda: Vec<f64>,
    /// Both components of the velocity, one below the other.
    pub(crate) velocity: Vec<f64>,
    pub(crate) paths: Vec<Vec<Pose>>,
    pub(crate) cells: [usize; 2],
    /// Width of a cell [m].
    pub(crate) spacing: f64,
    pub(crate) steps: u64,
    pub(crate) elapsed: Elapsed,
}

struct Show(Progress);

impl Observer<Fall> for Show {
    fn step(&mut self, fall: &mut Fall, info: &StepInfo) -> Result<(), CouplingError> {
        self.0.step(info.step, || Status {
            time: info.time,
            dt: info.dt,
            courant: info.courant,
            divergence: fall.flow.statistics().divergence * info.dt,
        });
        Ok(())
    }
}

/// Runs the scene to `end`; `intervals` + 1 snapshots are taken.
pub(crate) fn run(scene: &Scene, end: f64, intervals: usize, stop: &AtomicBool) -> Outcome<Option<Fallen>> {
    let watch = Stopwatch::start();
    let mut fall = scene.build(SmoothForcing::new(FLUID.density))?;
    let schedule = Schedule { end, intervals, ..Schedule::default() };
    let feed = |quantity| SnapshotFeed::new(quantity, Columns::default());
    let feeds = (feed(Quantity::SolidFraction), feed(Quantity::Velocity));
    let mut observers = (feeds, (BodyPaths::default(), Show(Progress::new(0.0, end))));
    let summary = coupling::run(&mut fall, &schedule, &mut observers, stop)?;
    let ((lambda, velocity), (paths, show)) = observers;
    show.0.finish(summary.steps, "the discs have fallen");
    if lambda.sink.times.len() <= intervals {
        return Ok(None);
    }
    Ok(Some(Fallen {
        times: lambda.sink.times,
        lambda: lambda.sink.values,
        velocity: velocity.sink.values,
        paths: paths.whole(),
        cells: scene.cells(),
        spacing: scene.diameter / scene.cells_per_diameter as f64,
        steps: summary.steps,
        elapsed: watch.elapsed(),
    }))
}
