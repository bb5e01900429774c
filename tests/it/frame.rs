//! What every later part relies on: no allocation in a step, the same numbers for any number of threads.
use crate::with_threads;
use siltflow::coupling::{Ledger, Observer, StepInfo};
use siltflow::ibm::{Forcing, Hfdib, SmoothForcing};
use siltflow::interfaces::{BodyId, Kinematics};
use validation::falling_discs::{FLUID, FallingDiscs};

fn allocations(scene: &FallingDiscs, forcing: impl Forcing, threads: usize) -> u64 {
    with_threads(threads, || {
        let mut simulation = scene.build(forcing).unwrap();
        let mut ledger = Ledger::new();
        let info = StepInfo { step: 0, time: 0.0, dt: 1e-4, courant: 0.0, snapshot: None };
        ledger.begin(&mut simulation);
        let mut steps = |n| {
            for _ in 0..n {
                simulation.step(1e-4).unwrap();
                ledger.step(&mut simulation, &info).unwrap();
            }
        };
        steps(20);
        // Counts this thread, which does all the work when it is the only one.
        allocation_counter::measure(|| steps(20)).count_total
    })
}

#[test]
fn a_warmed_up_step_allocates_nothing() {
    let scene = FallingDiscs { cells_per_diameter: 8, ..FallingDiscs::default() };
    assert_eq!(allocations(&scene, SmoothForcing::new(FLUID.density), 1), 0);
    assert_eq!(allocations(&scene, SmoothForcing::new(FLUID.density), 2), 0);
    let paper = FallingDiscs { virtual_mass: Some(1.0), ..scene.clone() };
    assert_eq!(allocations(&paper, Hfdib::new(FLUID.density), 1), 0);
    let floor = FallingDiscs { floor: true, ..scene };
    assert_eq!(allocations(&floor, SmoothForcing::new(FLUID.density), 1), 0);
}

#[test]
fn contacts_allocate_nothing() {
    // A heavy disc a hundredth of a millimetre above the floor lands while steps are still warming up.
    let scene = FallingDiscs {
        cells_per_diameter: 8,
        floor: true,
        bodies: 1,
        densities: vec![8000.0],
        shift: [0.0, -15.495e-3],
        ..FallingDiscs::default()
    };
    assert_eq!(allocations(&scene, SmoothForcing::new(FLUID.density), 1), 0);
}

/// Every bit of flow and bodies after 60 steps.
fn fingerprint(floor: bool, threads: usize) -> Vec<u64> {
    with_threads(threads, || {
        let scene = FallingDiscs { cells_per_diameter: 9, floor, ..FallingDiscs::default() };
        let mut simulation = scene.build(SmoothForcing::new(FLUID.density)).unwrap();
        for _ in 0..60 {
            simulation.step(2e-4).unwrap();
        }
        let bodies = &simulation.particles.bodies;
        let motion = (0..2).flat_map(|b| {
            let (pose, twist) = (bodies.pose(BodyId(b)), bodies.twist(BodyId(b)));
            [pose.position.x, pose.position.y, twist.linear.x, twist.linear.y, twist.angular.z]
        });
        let flow = &simulation.flow;
        let field = flow.pressure().values().chain(flow.velocity().field(0).values());
        motion.chain(field).map(f64::to_bits).collect()
    })
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    for floor in [false, true] {
        assert!(fingerprint(floor, 1) == fingerprint(floor, 2), "floor {floor}");
    }
}
