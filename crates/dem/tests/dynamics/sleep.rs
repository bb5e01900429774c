//! Who lies still is left alone, and woken as if it had not been.
use super::*;
use dem::{Chen, Cuboid, DemError, HalfSpace, Potential, Sleep};
use interfaces::{Checkpoint, Dynamics, Point};

const SLEEP: Sleep = Sleep { speed: 1e-3, time: 0.02 };

fn material() -> Material {
    Material { youngs_modulus: 1e7, damping: 5.0, friction: 0.5, ..Material::default() }
}
/// `towers` of three cubes on a floor, far from one another, about to fall by a hair's breadth.
fn towers(n: usize, sleep: Option<Sleep>) -> RigidBodies {
    let mut bodies = RigidBodies::new(Periods::default());
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), material()).unwrap();
    bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
    bodies.set_sleep(sleep).unwrap();
    let cube: Arc<dyn Shape> = Arc::new(Cuboid::new([2.0 * R; 3]).unwrap());
    for i in 0..3 * n {
        let at = [4.0 * R * (i / 3) as f64, 0.0, (1.001 + 2.0005 * (i % 3) as f64) * R];
        bodies.add(cube.clone(), material(), Pose::at(at), Twist::default(), Freedom::FREE).unwrap();
    }
    bodies
}
fn bullet(to: &mut RigidBodies, x: f64) -> BodyId {
    let thrown = moving([0.0, 1.0, 0.0], [0.0; 3]);
    to.add(sphere().shape(), material(), Pose::at([x, -3.0 * R, 3.0 * R]), thrown, Freedom::FREE).unwrap()
}

#[test]
fn towers_fall_asleep_and_cost_nothing() {
    let mut bodies = towers(4, Some(SLEEP));
    for _ in 0..400 {
        bodies.advance(1e-3).unwrap();
    }
    assert_eq!(bodies.n_asleep(), 12);
    assert_eq!(bodies.kinetic_energy(), 0.0);
    let calls = bodies.overlap_calls();
    let before: Vec<_> = bodies.ids().map(|b| bodies.pose(b)).collect();
    for _ in 0..100 {
        bodies.advance(1e-3).unwrap();
    }
    assert_eq!(bodies.overlap_calls(), calls);
    assert!(bodies.ids().all(|b| bodies.pose(b) == before[b.0]));
    // They still tell what carries them: every contact, and the impulse that bears the weight.
    let weight = 9.81 * bodies.inertia(BodyId(0)).mass;
    let mut carried: Vec<_> = bodies.contacts().map(|c| c.force.z.abs() / weight).collect();
    carried.sort_by(f64::total_cmp);
    assert_eq!(carried.len(), 12);
    assert!(carried.iter().enumerate().all(|(i, c)| (c - (i / 4 + 1) as f64).abs() < 0.02), "{carried:?}");
    assert!(bodies.ids().all(|b| (bodies.contact_impulse(b).force.z - weight * 1e-3).abs() < 1e-12 * weight));
    // With sleep taken away they are where they were, and at rest.
    bodies.set_sleep(None).unwrap();
    assert_eq!(bodies.n_asleep(), 0);
    bodies.advance(1e-3).unwrap();
    assert!(bodies.n_contacts() == 12 && bodies.kinetic_energy() < 1e-12);
}

/// A tower that is hit wakes, its neighbours do not, and it falls as it would have without sleep.
#[test]
fn only_who_is_hit_wakes() {
    let run = |sleep| {
        let mut bodies = towers(3, sleep);
        (0..400).for_each(|_| bodies.advance(1e-3).unwrap());
        let slept = bodies.n_asleep();
        bullet(&mut bodies, 4.0 * R);
        let mut woken = 0;
        for _ in 0..60 {
            bodies.advance(1e-3).unwrap();
            woken = woken.max(slept - bodies.n_asleep().min(slept));
        }
        (bodies, slept, woken)
    };
    let (asleep, slept, woken) = run(Some(SLEEP));
    let (awake, none, _) = run(None);
    assert_eq!((slept, woken, none), (9, 3, 0));
    assert!(asleep.is_asleep(BodyId(0)) && !asleep.is_asleep(BodyId(4)));
    let moved = (awake.pose(BodyId(4)).position - Point::new(4.0 * R, 0.0, 3.0 * R)).norm();
    assert!(moved > 0.1 * R);
    for b in awake.ids() {
        let off = (awake.pose(b).position - asleep.pose(b).position).norm();
        assert!(off < 0.02 * moved, "{b:?}: {off:.1e} of {moved:.1e}");
    }
}

/// Loads, weight, walls and motions that are new wake; the same ones do not.
#[test]
fn what_is_new_wakes() {
    let asleep = || {
        let mut bodies = towers(2, Some(SLEEP));
        (0..400).for_each(|_| bodies.advance(1e-3).unwrap());
        assert_eq!(bodies.n_asleep(), 6);
        bodies
    };
    let mut same = asleep();
    same.set_gravity(Vector::new(0.0, 0.0, -9.81));
    same.apply(BodyId(0), Load::default());
    same.set_twist(BodyId(0), Twist::default());
    assert_eq!(same.n_asleep(), 6);
    let mut bodies = asleep();
    bodies.apply(BodyId(1), push(Vector::new(10.0, 0.0, 0.0)));
    assert_eq!(bodies.n_asleep(), 3);
    bodies.advance(1e-2).unwrap();
    assert!(bodies.twist(BodyId(1)).linear.x > 0.1 && bodies.n_contacts() >= 3);
    let mut bodies = asleep();
    bodies.set_twist(BodyId(5), moving([0.0, 0.0, 0.1], [0.0; 3]));
    assert_eq!(bodies.n_asleep(), 3);
    let mut bodies = asleep();
    bodies.set_gravity(Vector::zeros());
    assert_eq!(bodies.n_asleep(), 0);
    let mut bodies = asleep();
    bodies.add_wall(HalfSpace::new(Point::new(-R, 0.0, 0.0), Vector::x()).unwrap(), material()).unwrap();
    assert_eq!(bodies.n_asleep(), 0);
}

/// A plate that moves as prescribed pushes a sleeping tower, and nothing sleeps on it while it moves.
#[test]
fn a_moving_plate_wakes() {
    let mut bodies = towers(1, Some(SLEEP));
    let plate = Arc::new(Cuboid::new([R, 6.0 * R, 6.0 * R]).unwrap());
    let plate = bodies
        .add(plate, material(), Pose::at([-2.0 * R, 0.0, 3.1 * R]), Twist::default(), Freedom::NONE)
        .unwrap();
    (0..400).for_each(|_| bodies.advance(1e-3).unwrap());
    assert_eq!(bodies.n_asleep(), 3);
    bodies.set_twist(plate, moving([0.1, 0.0, 0.0], [0.0; 3]));
    (0..200).for_each(|_| bodies.advance(1e-3).unwrap());
    assert_eq!(bodies.n_asleep(), 0);
    assert!(bodies.ids().take(3).all(|b| bodies.pose(b).position.x > 0.5 * R));
}

#[test]
fn a_restart_of_sleepers_continues_bit_for_bit() {
    let state = |bodies: &RigidBodies| {
        let mut all = Vec::new();
        bodies.save(&mut |name, values| all.push((name.to_owned(), values.to_vec())));
        all
    };
    // Amid it all: before, while and after they fall asleep, one tower hit.
    for steps in [5, 39, 40, 41, 400] {
        let mut bodies = towers(2, Some(SLEEP));
        (0..steps).for_each(|_| bodies.advance(1e-3).unwrap());
        let saved = state(&bodies);
        let source = |name: &str| saved.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_slice());
        let mut again = towers(2, Some(SLEEP));
        again.restore(&source).unwrap();
        assert_eq!(again.n_asleep(), bodies.n_asleep());
        assert!(again.contacts().eq(bodies.contacts()));
        for all in [&mut bodies, &mut again] {
            bullet(all, 0.0);
        }
        for _ in 0..60 {
            assert_eq!(state(&again), state(&bodies), "restored after {steps} steps");
            bodies.advance(1e-3).unwrap();
            again.advance(1e-3).unwrap();
        }
    }
}

#[test]
fn energy_of_sleepers_is_told() {
    let mut bodies = RigidBodies::with_law(Periods::default(), Potential::default());
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), material()).unwrap();
    bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
    bodies.set_sleep(Some(SLEEP)).unwrap();
    let m = Material { restitution: 0.3, ..material() };
    bodies.add(sphere().shape(), m, Pose::at([0.0, 0.0, R]), Twist::default(), Freedom::FREE).unwrap();
    let mut awake = 0.0;
    while bodies.n_asleep() == 0 {
        awake = bodies.elastic_energy().unwrap();
        bodies.advance(1e-3).unwrap();
    }
    (0..10).for_each(|_| bodies.advance(1e-3).unwrap());
    let asleep = bodies.elastic_energy().unwrap();
    // It still oscillates by 0.2 % when it falls asleep.
    assert!(asleep > 0.0 && (asleep / awake - 1.0).abs() < 5e-3, "{asleep:e} {awake:e}");
}

#[test]
fn thresholds_are_checked() {
    let mut bodies = RigidBodies::with_law(Periods::default(), Chen::default());
    for (speed, time) in [(0.0, 1.0), (1.0, -1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
        assert!(matches!(bodies.set_sleep(Some(Sleep { speed, time })), Err(DemError::Sleep { .. })));
    }
}

/// A plate that moves more slowly than who may sleep: what lies on it is carried all the same.
#[test]
fn nobody_sleeps_on_what_moves() {
    let mut bodies = RigidBodies::new(Periods::default());
    bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
    bodies.set_sleep(Some(SLEEP)).unwrap();
    let plate = Cuboid::new([6.0 * R, 6.0 * R, R]).unwrap();
    let lifted = moving([0.0, 0.0, 0.5 * SLEEP.speed], [0.0; 3]);
    bodies.add(plate, material(), Pose::at([0.0, 0.0, -0.5 * R]), lifted, Freedom::NONE).unwrap();
    let cube = Cuboid::new([2.0 * R; 3]).unwrap();
    let b = bodies.add(cube, material(), Pose::at([0.0, 0.0, R]), lifted, Freedom::FREE).unwrap();
    let start = bodies.pose(b).position.z;
    for _ in 0..500 {
        bodies.advance(1e-3).unwrap();
        assert_eq!(bodies.n_asleep(), 0);
    }
    let risen = (bodies.pose(b).position.z - start) / (0.5 * lifted.linear.z);
    assert!((risen - 1.0).abs() < 0.05, "{risen}");
}

/// A block that friction holds on an incline is held by it from the first step on when it wakes: its springs have slept, too.
#[test]
fn friction_is_remembered() {
    let mut bodies = RigidBodies::new(Periods::default());
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), material()).unwrap();
    bodies.set_gravity(Vector::new(2.0, 0.0, -9.81));
    bodies.set_sleep(Some(SLEEP)).unwrap();
    let block = Cuboid::new([4.0 * R, 4.0 * R, R]).unwrap();
    let b = bodies
        .add(block, material(), Pose::at([0.0, 0.0, 0.5 * R]), Twist::default(), Freedom::FREE)
        .unwrap();
    (0..600).for_each(|_| bodies.advance(1e-3).unwrap());
    assert!(bodies.is_asleep(b));
    bodies.apply(b, push(Vector::new(1e-9, 0.0, 0.0)));
    assert!(!bodies.is_asleep(b));
    let dt = bodies.stable_dt();
    bodies.advance(dt).unwrap();
    let held: f64 = bodies.contacts().map(|c| -c.force.x).sum();
    let pull = 2.0 * bodies.inertia(b).mass;
    assert!((held / pull - 1.0).abs() < 0.01, "{held} N of {pull} N");
}
