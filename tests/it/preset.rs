//! The paper's algorithm, as one call.
use crate::with_threads;
use siltflow::coupling::{self, HfdibDem, Ledger, LedgerReport, Particles, Schedule, Simulation};
use siltflow::flow::{PisoParams, TimeScheme};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{BodyId, Checkpoint, Kinematics, Twist};
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use validation::falling_discs::{FLUID, FallingDiscs};

/// Speeds of the two discs at 0.03 s \[mm/s\].
fn speeds(mut simulation: HfdibDem<2>) -> [f64; 2] {
    let schedule = Schedule { end: 0.03, intervals: 30, dt: Some(2.5e-4), ..Schedule::default() };
    coupling::run(&mut simulation, &schedule, &mut (), &AtomicBool::new(false)).unwrap();
    assert!(simulation.flow.statistics().divergence < 1e-3);
    [0, 1].map(|b| 1e3 * simulation.particles.bodies.twist(BodyId(b)).linear.norm())
}

/// 15 cells per diameter; 5.45 and 2.96 mm/s by unsteady Stokes theory.
#[test]
fn two_discs_sink_by_the_papers_algorithm() {
    with_threads(1, || {
        let found = speeds(FallingDiscs::default().hfdib_dem().unwrap());
        for (speed, theory) in found.into_iter().zip([5.45, 2.96]) {
            assert!((speed / theory - 1.0).abs() < 0.05, "{speed} {theory}");
        }
    });
}

/// By BDF2 a change of the velocity takes 3/2 of its momentum: heavy discs sink as by Euler's scheme.
#[test]
fn the_scheme_in_time_does_not_matter_to_heavy_discs() {
    with_threads(1, || {
        let scene =
            FallingDiscs { densities: vec![2000.0], cells_per_diameter: 10, ..FallingDiscs::default() };
        let euler = speeds(scene.hfdib_dem().unwrap());
        let mut simulation = scene.hfdib_dem().unwrap();
        let params = PisoParams { time_scheme: TimeScheme::Bdf2, ..*simulation.flow.params() };
        simulation.flow = simulation.flow.with_params(params).unwrap();
        for (second, first) in speeds(simulation).into_iter().zip(euler) {
            assert!((second / first - 1.0).abs() < 0.01, "{second} {first}");
        }
    });
}

/// A run that is stopped and resumed ends as one that is not, to the last bit.
#[test]
fn the_papers_algorithm_is_resumed() {
    with_threads(1, || {
        let scene = FallingDiscs { cells_per_diameter: 8, ..FallingDiscs::default() };
        let run = |from: Option<&BTreeMap<String, Vec<f64>>>, steps: usize| {
            let mut simulation = scene.hfdib_dem().unwrap();
            if let Some(state) = from {
                simulation.restore(&|name| state.get(name).map(Vec::as_slice)).unwrap();
            }
            (0..steps).for_each(|_| simulation.step(5e-4).unwrap());
            let mut state = BTreeMap::new();
            simulation.save(&mut |name, values| {
                state.insert(name.to_string(), values.to_vec());
            });
            state
        };
        let half = run(None, 10);
        assert!(run(Some(&half), 7) == run(None, 17));
    });
}

/// Our coupling on PISO, by BDF2: what the fluid's reaction is foreseen to be has the scheme's 3/2, too.
#[test]
fn one_solution_works_on_piso() {
    for density in [100.0, 1060.0] {
        with_threads(1, || {
            let scene =
                FallingDiscs { densities: vec![density], cells_per_diameter: 10, ..FallingDiscs::default() };
            let speed = |twist: Twist| 1e3 * twist.linear.norm();
            let schedule = Schedule { end: 0.03, intervals: 30, dt: Some(2.5e-4), ..Schedule::default() };
            let mut ours = scene.build(SmoothForcing::new(FLUID.density)).unwrap();
            coupling::run(&mut ours, &schedule, &mut (), &AtomicBool::new(false)).unwrap();
            let Simulation { flow, particles, .. } = scene.hfdib_dem().unwrap();
            let params = PisoParams { time_scheme: TimeScheme::Bdf2, ..*flow.params() };
            let flow = flow.with_params(params).unwrap();
            let (forcing, gravity) = (SmoothForcing::new(FLUID.density), particles.gravity());
            let particles = Particles::new(particles.bodies, forcing, FLUID.density, gravity);
            let mut piso = Simulation::new(flow, particles, scene.balance).unwrap();
            coupling::run(&mut piso, &schedule, &mut (), &AtomicBool::new(false)).unwrap();
            for b in [BodyId(0), BodyId(1)] {
                let (theirs, own) =
                    (speed(piso.particles.bodies.twist(b)), speed(ours.particles.bodies.twist(b)));
                assert!((theirs / own - 1.0).abs() < 0.03, "{density}: {theirs} {own}");
            }
        });
    }
}

/// Momentum is kept to the tolerances of the linear solvers; of the energy a part is lost.
#[test]
fn the_papers_algorithm_keeps_books() {
    let books = |floor: bool, tolerance: f64| -> LedgerReport {
        with_threads(1, || {
            let scene = FallingDiscs { cells_per_diameter: 10, floor, ..FallingDiscs::default() };
            let mut simulation = scene.hfdib_dem().unwrap();
            let params = PisoParams {
                momentum_tolerance: tolerance,
                pressure_tolerance: tolerance,
                ..*simulation.flow.params()
            };
            simulation.flow = simulation.flow.with_params(params).unwrap();
            let schedule = Schedule { end: 0.03, intervals: 30, dt: Some(2.5e-4), ..Schedule::default() };
            let mut ledger = Ledger::new();
            coupling::run(&mut simulation, &schedule, &mut ledger, &AtomicBool::new(false)).unwrap();
            *ledger.report()
        })
    };
    let lost = |books: &LedgerReport| books.energy_residual / books.work;
    let found = books(false, 1e-11);
    assert!(found.momentum_step < 1e-10, "{found:?}");
    assert!((-0.05..0.0).contains(&lost(&found)), "{found:?}");
    let found = books(false, 1e-4);
    assert!(found.momentum_step < 1e-4 && found.momentum_total < 1e-5, "{found:?}");
    // Between floor and ceiling also what two corrections leave.
    let found = books(true, 1e-4);
    assert!(found.momentum_total < 1e-3, "{found:?}");
    assert!((-0.05..0.0).contains(&lost(&found)), "{found:?}");
}
