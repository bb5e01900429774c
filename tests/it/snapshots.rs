//! Snapshots handed on by a running simulation.
use siltflow::coupling::{BodyPaths, CouplingError, FileOutput, Quantity, Schedule, SnapshotFeed, run};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{BodyId, Kinematics, SnapshotSink};
use std::error::Error;
use std::sync::atomic::AtomicBool;
use validation::falling_discs::FallingDiscs;

/// Keeps all, up to a certain time.
struct Kept(Vec<(f64, Vec<f64>)>, f64);

impl SnapshotSink for Kept {
    fn push(&mut self, time: f64, field: &[f64]) -> Result<(), Box<dyn Error + Send + Sync>> {
        if time > self.1 {
            return Err("no room".into());
        }
        self.0.push((time, field.to_vec()));
        Ok(())
    }
}

fn schedule() -> Schedule {
    Schedule { end: 0.02, intervals: 4, ..Schedule::default() }
}

/// λ is that of the files; velocity and pressure are those of the flow; paths are those of the bodies.
#[test]
fn snapshots_reach_their_sinks() {
    let scene = FallingDiscs { cells_per_diameter: 8, ..FallingDiscs::default() };
    let mut fall = scene.build(SmoothForcing::new(1000.0)).unwrap();
    let feed = |quantity| SnapshotFeed::new(quantity, Kept(Vec::new(), f64::INFINITY));
    let folder = std::env::temp_dir().join(format!("siltflow-snapshots-{}", std::process::id()));
    let mut observers = (
        (feed(Quantity::SolidFraction), (feed(Quantity::Velocity), feed(Quantity::Pressure))),
        (BodyPaths::default(), FileOutput::new(&folder).unwrap()),
    );
    run(&mut fall, &schedule(), &mut observers, &AtomicBool::new(false)).unwrap();
    let ((lambda, (velocity, pressure)), (paths, files)) = observers;
    assert_eq!(lambda.sink.0.last().unwrap().1, files.lambda());
    let all: Vec<f64> = fall.flow.centred_velocity(0).chain(fall.flow.centred_velocity(1)).collect();
    assert_eq!(velocity.sink.0.last().unwrap().1, all);
    assert!(all.iter().any(|v| *v != 0.0));
    assert!(pressure.sink.0.last().unwrap().1.iter().copied().eq(fall.flow.pressure().values()));
    for kept in [&lambda.sink.0, &velocity.sink.0, &pressure.sink.0] {
        let times: Vec<f64> = kept.iter().map(|k| k.0).collect();
        assert_eq!(times, paths.times);
        assert_eq!(times.len(), 5);
    }
    let whole = paths.whole();
    assert_eq!(whole.len(), 2);
    for (b, path) in whole.iter().enumerate() {
        assert_eq!(path[4], fall.particles.bodies.pose(BodyId(b)));
        assert!(path[4].position.y < path[0].position.y);
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// What the sink says ends the run, and is told.
#[test]
fn a_sink_that_refuses_ends_the_run() {
    let scene = FallingDiscs { cells_per_diameter: 8, ..FallingDiscs::default() };
    let mut fall = scene.build(SmoothForcing::new(1000.0)).unwrap();
    let mut feed = SnapshotFeed::new(Quantity::Velocity, Kept(Vec::new(), 0.012));
    let error = run(&mut fall, &schedule(), &mut feed, &AtomicBool::new(false)).unwrap_err();
    assert!(
        matches!(&error, CouplingError::Output { source, .. } if source.to_string() == "no room"),
        "{error}"
    );
    assert_eq!(feed.sink.0.len(), 3);
}
