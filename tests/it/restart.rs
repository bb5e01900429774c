//! A run that is stopped goes on as if it had not been.
use crate::with_threads;
use siltflow::coupling::{self, CheckpointError, CouplingError, Particles, Schedule, Simulation, StepInfo};
use siltflow::dem::RigidBodies;
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{BodyId, Kinematics};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use validation::falling_discs::{FLUID, FallingDiscs};

type Fall = Simulation<2, Particles<SmoothForcing, RigidBodies>>;

fn scratch(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("siltflow-restart-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder.join(name)
}

/// Two discs, or one that lands on the floor and is in contact when the run is cut.
fn build(floor: bool) -> Fall {
    let mut scene = FallingDiscs { cells_per_diameter: 8, floor, ..FallingDiscs::default() };
    if floor {
        scene.bodies = 1;
        scene.densities = vec![8000.0];
        scene.shift = [0.0, -15.45e-3];
    }
    scene.build(SmoothForcing::new(FLUID.density)).unwrap()
}

fn bits(fall: &Fall) -> Vec<u64> {
    let bodies = &fall.particles.bodies;
    let motion = (0..bodies.n_bodies()).flat_map(|b| {
        let (pose, twist) = (bodies.pose(BodyId(b)), bodies.twist(BodyId(b)));
        let q = pose.orientation;
        [pose.position.x, pose.position.y, q.w, q.k, twist.linear.x, twist.linear.y, twist.angular.z]
    });
    let field = fall.flow.pressure().values().chain(fall.flow.velocity().field(1).values());
    motion.chain(field).chain([fall.flow.time()]).map(f64::to_bits).collect()
}

/// Notes which snapshots steps foretell and which come.
#[derive(Default)]
struct Foretold(Option<usize>, Vec<usize>);

impl coupling::Observer<Fall> for Foretold {
    fn step(&mut self, _: &mut Fall, info: &StepInfo) -> Result<(), CouplingError> {
        assert!(std::mem::replace(&mut self.0, info.snapshot).is_none(), "a snapshot was skipped");
        Ok(())
    }
    fn snapshot(&mut self, _: &mut Fall, index: usize, info: &StepInfo) -> Result<(), CouplingError> {
        assert_eq!(info.snapshot, Some(index));
        assert!(self.0.take() == Some(index) || index == 0);
        self.1.push(index);
        Ok(())
    }
}

/// A state that was saved between the last step of an interval and its snapshot would lose the snapshot: steps tell when one follows.
#[test]
fn steps_foretell_snapshots() {
    with_threads(1, || {
        let schedule = Schedule { end: 0.01, intervals: 4, ..Schedule::default() };
        let mut seen = Foretold::default();
        coupling::run(&mut build(false), &schedule, &mut seen, &AtomicBool::new(false)).unwrap();
        assert_eq!(seen.1, [0, 1, 2, 3, 4]);
    });
}

#[test]
fn n_steps_are_k_and_then_n_minus_k() {
    with_threads(1, || {
        for floor in [false, true] {
            let schedule = Schedule { end: 0.06, intervals: 6, ..Schedule::default() };
            let stop = AtomicBool::new(false);
            let mut whole = build(floor);
            coupling::run(&mut whole, &schedule, &mut (), &stop).unwrap();

            let half = Schedule { end: 0.03, intervals: 3, ..schedule };
            let mut first = build(floor);
            coupling::run(&mut first, &half, &mut (), &stop).unwrap();
            assert!(!floor || first.particles.bodies.n_contacts() == 1, "in contact when the run is cut");
            let path = scratch(if floor { "floor.bin" } else { "box.bin" });
            coupling::save(&path, &first).unwrap();
            let mut second = build(floor);
            coupling::load(&path, &mut second).unwrap();
            assert_eq!(bits(&first), bits(&second));
            coupling::run(&mut second, &schedule, &mut (), &stop).unwrap();
            assert!(bits(&whole) == bits(&second), "floor {floor}");
        }
    });
}

/// The state before the last is kept, and offered when the last one is damaged.
#[test]
fn an_older_state_is_at_hand() {
    let path = scratch("older.bin");
    let mut fall = build(false);
    fall.step(1e-4).unwrap();
    coupling::save(&path, &fall).unwrap();
    let first = bits(&fall);
    fall.step(1e-4).unwrap();
    coupling::save(&path, &fall).unwrap();
    coupling::load(&path, &mut fall).unwrap();
    assert!(bits(&fall) != first);
    std::fs::write(&path, b"nothing").unwrap();
    let Err(CheckpointError::Corrupt { older: Some(older), .. }) = coupling::load(&path, &mut fall) else {
        panic!("the older state is not offered");
    };
    assert_eq!(older, coupling::previous(&path));
    coupling::load(&older, &mut fall).unwrap();
    assert!(bits(&fall) == first);
}

#[test]
fn a_damaged_or_foreign_state_is_refused() {
    let path = scratch("damaged.bin");
    let mut fall = build(false);
    fall.step(1e-4).unwrap();
    coupling::save(&path, &fall).unwrap();
    let good = std::fs::read(&path).unwrap();

    let mut bytes = good.clone();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&path, &bytes).unwrap();
    let error = coupling::load(&path, &mut fall).unwrap_err();
    assert!(matches!(error, CheckpointError::Corrupt { what: "wrong checksum", .. }), "{error}");

    for cut in [0, 5, 20, good.len() - 1] {
        std::fs::write(&path, &good[..cut]).unwrap();
        assert!(matches!(coupling::load(&path, &mut fall), Err(CheckpointError::Corrupt { .. })), "{cut}");
    }

    std::fs::write(&path, &good).unwrap();
    let mut other = FallingDiscs { cells_per_diameter: 9, ..FallingDiscs::default() }
        .build(SmoothForcing::new(1000.0))
        .unwrap();
    assert!(matches!(coupling::load(&path, &mut other), Err(CheckpointError::Mismatch(_))));
    let missing = scratch("is-not-there.bin");
    assert!(matches!(coupling::load(&missing, &mut fall), Err(CheckpointError::Io { .. })));
}
