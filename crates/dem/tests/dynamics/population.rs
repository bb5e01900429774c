//! Bodies that come in, in time and with room, and those that go.
use super::*;
use dem::placing::{PlacingError, Region, SizeDistribution};
use dem::{DemError, Entrant, HalfSpace, Inflow, Origin, Population, RigidDynamics};
use interfaces::{Aabb, Checkpoint, Dynamics, Point, RestartError};
use std::collections::BTreeMap;

const DT: f64 = 1e-3;
const GRAVITY: Vector = Vector::new(0.0, 0.0, -9.81);

fn boxed(low: [f64; 3], high: [f64; 3]) -> Region<'static> {
    Region::cuboid(Aabb { min: low.map(|c| c * R).into(), max: high.map(|c| c * R).into() }, [false; 3])
        .unwrap()
}

/// Spheres of 0.5 to 1 R that fall with 0.3 m/s when they come in.
fn grain(serial: u64) -> Entrant {
    let sizes = SizeDistribution::log_normal(0.7 * R, 1.3, [0.5 * R, R]).unwrap();
    Entrant {
        shape: Arc::new(Sphere::new(sizes.sample(1, serial)[0]).unwrap()),
        material: Material { youngs_modulus: 1e6, friction: 0.3, ..Material::default() },
        twist: Twist { linear: Vector::new(0.0, 0.0, -0.3), ..Twist::default() },
        freedom: Freedom::FREE,
    }
}

/// Two inflows above a table with an edge, over which grains fall to an exit; one sphere from the start.
fn fountain() -> Population {
    let mut bodies = RigidBodies::new(Periods::default());
    bodies.set_gravity(GRAVITY);
    let table = dem::Cuboid::new([6.0 * R, 6.0 * R, 2.0 * R]).unwrap();
    let at = Pose::at([0.0, 0.0, -R]);
    bodies.add(table, Material::default(), at, Twist::default(), Freedom::NONE).unwrap();
    let left = Inflow::new(boxed([-3.0, -3.0, 4.0], [0.0, 3.0, 8.0]), 70.0, grain).unwrap();
    let right = Inflow::new(boxed([0.0, -3.0, 4.0], [3.0, 3.0, 8.0]), 40.0, grain).unwrap();
    let below = HalfSpace::new(Point::new(0.0, 0.0, -10.0 * R), Vector::z()).unwrap();
    Population::new(bodies)
        .with_inflow(left.with_gap(0.05 * R).unwrap().with_seed(1))
        .with_inflow(right.with_start(0.1).unwrap().with_number(12).with_seed(2))
        .with_exit(below)
}

fn go(population: &mut Population, steps: std::ops::Range<u32>) {
    for step in steps {
        population.renew(f64::from(step) * DT).unwrap();
        population.advance(DT).unwrap();
    }
}

fn motion(p: &Population) -> BTreeMap<Origin, (Pose, Twist)> {
    p.ids().map(|b| (p.origin(b), (p.pose(b), p.twist(b)))).collect()
}

#[test]
fn they_come_in_time_and_go() {
    let mut fountain = fountain();
    let mut entered = Vec::new();
    for step in 0..1000 {
        let time = f64::from(step) * DT;
        let before = fountain.n_bodies() as u64 + fountain.left();
        fountain.renew(time).unwrap();
        // Who has come in is no nearer than the gap to anyone.
        let new = (fountain.n_bodies() as u64 + fountain.left() - before) as usize;
        for b in (fountain.n_bodies() - new..fountain.n_bodies()).map(BodyId) {
            let (shape, at) = (fountain.rigid_bodies().shape(b).bounding_radius(), fountain.pose(b).position);
            for other in fountain.ids().filter(|o| *o != b && o.0 != 0) {
                let apart = (fountain.pose(other).position - at).norm();
                let gap = apart - shape - fountain.rigid_bodies().shape(other).bounding_radius();
                assert!(gap >= 0.0, "{gap}");
            }
            entered.push((time, fountain.origin(b)));
        }
        assert_eq!(fountain.waiting(0, time) + fountain.waiting(1, time), 0);
        fountain.advance(DT).unwrap();
    }
    assert_eq!((fountain.entered(0), fountain.entered(1), fountain.entered(7)), (70, 12, 0));
    assert!(fountain.left() > 20, "{}", fountain.left());
    assert_eq!(fountain.n_bodies() as u64 + fountain.left(), 83);
    for (time, origin) in entered {
        let Origin::Inflow { inflow, serial } = origin else { panic!("{origin:?}") };
        let due = [serial as f64 / 70.0, 0.1 + serial as f64 / 40.0][inflow];
        assert!(time >= due - 1e-9 && time < due + DT, "{origin:?} at {time}, due {due}");
    }
    let lowest = fountain.ids().map(|b| fountain.pose(b).position.z).fold(0.0, f64::min);
    assert!(lowest > -10.5 * R, "{lowest}");
    assert_eq!(fountain.origin(BodyId(0)), Origin::Start(0));
}

/// In a zone that is full they wait, and none is lost.
#[test]
fn they_wait_for_room() {
    let mut bodies = RigidBodies::new(Periods::new([Some(8.0 * R), None, None]));
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), Material::default()).unwrap();
    // Its image is in the zone.
    let at = Pose::at([7.5 * R, 0.0, 2.0 * R]);
    bodies.add(Sphere::new(R).unwrap(), Material::default(), at, Twist::default(), Freedom::NONE).unwrap();
    let recipe = |_| Entrant {
        shape: Arc::new(Sphere::new(R).unwrap()),
        material: Material::default(),
        twist: Twist::default(),
        freedom: Freedom::NONE,
    };
    // The zone reaches below the floor: room for one row of spheres along x, but for what is there.
    let inflow = Inflow::new(boxed([-2.0, -1.01, -0.99], [4.0, 1.01, 3.01]), 10.0, recipe).unwrap();
    let mut waiting = Population::new(bodies).with_inflow(inflow);
    for step in 0..100 {
        waiting.renew(f64::from(step) * 0.01).unwrap();
    }
    let n = waiting.entered(0);
    assert!((1..=2).contains(&n), "{n}");
    assert_eq!(waiting.waiting(0, 0.95), 10 - n);
    assert!(waiting.rigid_bodies().smallest_gap().unwrap() > -1e-12);
    // Room is made: the next one takes it.
    (1..=n as usize).for_each(|b| waiting.dismiss(BodyId(b)).unwrap());
    let numbers = waiting.renew(0.96).unwrap().unwrap();
    assert_eq!((numbers.before() as u64, numbers.left()), (n + 1, 1));
    assert!(waiting.entered(0) > n && waiting.left() == n);
    assert_eq!(waiting.origin(BodyId(1)), Origin::Inflow { inflow: 0, serial: n });
}

/// A run that goes on from a saved state, in one that has just been set up or has run already, is the same to the last bit.
#[test]
fn restarts_do_not_notice() {
    let mut whole = fountain();
    // Cut where some are in touch.
    let mut cut = 400;
    go(&mut whole, 0..cut);
    while whole.rigid_bodies().n_contacts() < 2 {
        go(&mut whole, cut..cut + 1);
        cut += 1;
    }
    whole.dismiss(BodyId(3)).unwrap();
    let mut saved = BTreeMap::new();
    whole.save(&mut |name, values| drop(saved.insert(name.to_owned(), values.to_vec())));
    let source = |name: &str| saved.get(name).map(Vec::as_slice);
    let (mut new, mut used) = (fountain(), fountain());
    go(&mut used, 0..250);
    assert!(used.left() > 0 && used.n_bodies() > 5);
    let before = (whole.left(), whole.entered(0));
    go(&mut whole, cut..cut + 200);
    assert!(whole.left() > before.0 + 5 && whole.entered(0) > before.1 + 5);
    for again in [&mut new, &mut used] {
        again.restore(&source).unwrap();
        // Asked twice at the same time, as a run loop does that begins there.
        again.renew(f64::from(cut) * DT).unwrap();
        go(again, cut..cut + 200);
        assert_eq!(motion(&whole), motion(again));
        let count = |p: &Population| (p.entered(0), p.entered(1), p.left());
        assert_eq!(count(again), count(&whole));
    }
    let mut other = Population::new(RigidBodies::new(Periods::default()));
    assert!(matches!(other.restore(&source), Err(RestartError::Length { .. })));
}

#[test]
fn bad_inflows_say_so() {
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let made = Inflow::new(boxed([0.0; 3], [1.0; 3]), rate, grain);
        assert!(matches!(made.err(), Some(PlacingError::Parameter { what: "rate of the inflow", .. })));
    }
    let inflow = || Inflow::new(boxed([0.0; 3], [1.0; 3]), 1.0, grain).unwrap();
    assert!(inflow().with_start(f64::NAN).is_err() && inflow().with_gap(-1.0).is_err());
    // A body larger than its zone.
    let mut bodies = Population::new(RigidBodies::new(Periods::default())).with_inflow(inflow());
    let renewed = bodies.renew(0.0);
    assert!(matches!(renewed, Err(PlacingError::TooLarge { .. })), "{renewed:?}");
    let nobody = bodies.dismiss(BodyId(0));
    assert!(matches!(nobody, Err(DemError::NoSuchBody { body: BodyId(0), bodies: 0 })), "{nobody:?}");
    // None before the start.
    assert_eq!(
        inflow()
            .with_start(5.0)
            .map(|i| Population::new(RigidBodies::new(Periods::default())).with_inflow(i).waiting(0, 4.0))
            .unwrap(),
        0
    );
}
