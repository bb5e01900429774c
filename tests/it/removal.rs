//! Bodies that are taken out of a flow, and put into it.
use crate::with_threads;
use siltflow::coupling::{CouplingError, Particles, Simulation};
use siltflow::dem::{Disc, Material, RigidBodies};
use siltflow::ibm::{Forcing, Hfdib, SmoothForcing};
use siltflow::interfaces::{BodyId, Freedom, Kinematics, Pose, Twist};
use validation::falling_discs::{FLUID, FallingDiscs};

type Fall<F> = Simulation<2, Particles<F, RigidBodies>>;

/// Two discs that have fallen for a while, and a third, of another size, that was put in on the way.
fn three<F: Forcing>(forcing: F) -> Fall<F> {
    let scene = FallingDiscs { cells_per_diameter: 10, ..FallingDiscs::default() };
    let mut fall = scene.build(forcing).unwrap();
    (0..10).for_each(|_| fall.step(1e-3).unwrap());
    let bodies = &mut fall.particles.bodies;
    let small = Disc::new(0.4 * scene.diameter).unwrap();
    let material = Material { density: 3000.0, ..Material::default() };
    bodies.add(small, material, Pose::at([2e-3, 10e-3, 0.0]), Twist::default(), Freedom::PLANAR).unwrap();
    (0..10).for_each(|_| fall.step(1e-3).unwrap());
    fall
}

fn motion<F>(fall: &Fall<F>) -> Vec<(Pose, Twist)> {
    let bodies = &fall.particles.bodies;
    bodies.ids().map(|b| (bodies.pose(b), bodies.twist(b))).collect()
}

/// What a forcing kept under the old numbers is as good as what it would find anew, to the last bit.
fn goes_on<F: Forcing>(new: impl Fn() -> F + Sync) {
    with_threads(1, || {
        let (mut told, mut anew) = (three(new()), three(new()));
        for fall in [&mut told, &mut anew] {
            let numbers = fall.particles.bodies.remove(&[BodyId(0)]).unwrap();
            fall.particles.renumber(&numbers);
        }
        anew.particles.forcing = new();
        for fall in [&mut told, &mut anew] {
            (0..10).for_each(|_| fall.step(1e-3).unwrap());
        }
        assert_eq!(told.particles.bodies.n_bodies(), 2);
        assert_eq!(motion(&told), motion(&anew));
        // The small one sinks.
        let sinks = told.particles.bodies.twist(BodyId(1)).linear.y;
        assert!(sinks < 0.0, "{sinks}");
    });
}

#[test]
fn smooth_forcing_keeps_who_is_left() {
    goes_on(|| SmoothForcing::new(FLUID.density));
}

#[test]
fn hfdib_keeps_who_is_left() {
    goes_on(|| Hfdib::new(FLUID.density));
}

#[test]
fn a_removal_that_was_not_told_is_an_error() {
    let mut fall = three(SmoothForcing::new(FLUID.density));
    let numbers = fall.particles.bodies.remove(&[BodyId(1)]).unwrap();
    let untold = fall.step(1e-3);
    assert!(matches!(untold, Err(CouplingError::Renumbered { before: 3, now: 2 })), "{untold:?}");
    // Nothing is lost.
    fall.particles.renumber(&numbers);
    fall.step(1e-3).unwrap();
}
