//! Who is taken away is missed by those only whom it touched.
use super::*;
use dem::{Cuboid, DemError, HalfSpace, Sleep, Tether};
use interfaces::{Checkpoint, Dynamics, Point, Renumbering};
use std::collections::BTreeMap;

const FAR: f64 = 100.0 * R;

/// Spheres and cubes fall onto a floor, on one another; between their numbers stand others, far away, where `strangers` are wanted.
fn heap(strangers: bool) -> (RigidBodies, Vec<BodyId>) {
    let rough = Material { youngs_modulus: 1e7, damping: 5.0, friction: 0.5, ..Material::default() };
    let mut bodies = RigidBodies::new(Periods::default());
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), rough).unwrap();
    bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
    let cube: Arc<dyn Shape> = Arc::new(Cuboid::new([1.5 * R; 3]).unwrap());
    let mut gone = Vec::new();
    for i in 0..24 {
        let (layer, x, y) = (i / 4, (i % 2) as f64, (i / 2 % 2) as f64);
        let lean = 0.07 * (i as f64).sin();
        let at = [(1.9 * x + lean) * R, (1.9 * y - lean) * R, (1.0 + 2.1 * layer as f64) * R];
        let shape = if i % 3 == 0 { cube.clone() } else { sphere().shape() };
        if strangers && i % 5 == 1 {
            let at = Pose::at([FAR + 4.0 * R * i as f64, 0.0, 0.9 * R]);
            gone.push(bodies.add(shape.clone(), rough, at, Twist::default(), Freedom::FREE).unwrap());
        }
        bodies.add(shape, rough, Pose::at(at), Twist::default(), Freedom::FREE).unwrap();
    }
    (bodies, gone)
}

fn motion(bodies: &RigidBodies) -> Vec<(Pose, Twist)> {
    bodies.ids().map(|b| (bodies.pose(b), bodies.twist(b))).collect()
}

/// Friction remembers: what is carried over is, to the last bit, what was there.
#[test]
fn those_left_do_not_notice() {
    let ((mut with, gone), (mut without, _)) = (heap(true), heap(false));
    assert_eq!(gone.len(), 5);
    for step in 0..150 {
        if step == 80 {
            let (now, before): (Vec<_>, Vec<_>) = (motion(&with), with.contacts().collect());
            let numbers = with.remove(&gone).unwrap();
            assert_eq!((numbers.before(), numbers.left()), (29, 24));
            for (b, was) in now.iter().enumerate() {
                if let Some(after) = numbers.of(BodyId(b)) {
                    assert_eq!(&(with.pose(after), with.twist(after)), was);
                }
            }
            // The strangers' contacts with the floor are gone, the others are there under their new numbers.
            let kept: Vec<_> = before.iter().filter_map(|c| Some((numbers.of(c.body)?, c.force))).collect();
            assert!(kept.len() < before.len(), "{} {}", kept.len(), before.len());
            let left: Vec<_> = with.contacts().map(|c| (c.body, c.force)).collect();
            assert_eq!(left, kept);
        }
        with.advance(1e-3).unwrap();
        without.advance(1e-3).unwrap();
    }
    assert!(with.n_contacts() > 8, "{}", with.n_contacts());
    assert_eq!(motion(&with), motion(&without));
}

/// After a removal the state is saved and restored as ever.
#[test]
fn a_state_after_a_removal_is_restored() {
    let (mut bodies, gone) = heap(true);
    (0..80).for_each(|_| bodies.advance(1e-3).unwrap());
    let _ = bodies.remove(&gone).unwrap();
    let mut saved = BTreeMap::new();
    bodies.save(&mut |name, values| {
        saved.insert(name.to_owned(), values.to_vec());
    });
    let (mut again, _) = heap(false);
    again.restore(&|name| saved.get(name).map(Vec::as_slice)).unwrap();
    for _ in 0..40 {
        bodies.advance(1e-3).unwrap();
        again.advance(1e-3).unwrap();
    }
    assert_eq!(motion(&bodies), motion(&again));
}

/// Three sleeping towers of three: of the first the foot goes, of the second all; the third sleeps on, and wakes as one when it is hit.
#[test]
fn only_those_that_lost_a_neighbour_wake() {
    let soft = Material { youngs_modulus: 1e7, damping: 5.0, friction: 0.5, ..Material::default() };
    let mut bodies = RigidBodies::new(Periods::default());
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), soft).unwrap();
    bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
    bodies.set_sleep(Some(Sleep { speed: 1e-3, time: 0.02 })).unwrap();
    let cube: Arc<dyn Shape> = Arc::new(Cuboid::new([2.0 * R; 3]).unwrap());
    for i in 0..9 {
        let at = [4.0 * R * (i / 3) as f64, 0.0, (1.001 + 2.0005 * (i % 3) as f64) * R];
        bodies.add(cube.clone(), soft, Pose::at(at), Twist::default(), Freedom::FREE).unwrap();
    }
    (0..400).for_each(|_| bodies.advance(1e-3).unwrap());
    assert_eq!(bodies.n_asleep(), 9);
    let numbers = bodies.remove(&[0, 3, 4, 5].map(BodyId)).unwrap();
    assert_eq!(numbers, Renumbering::without(9, [0, 3, 4, 5].map(BodyId)));
    assert_eq!((bodies.n_bodies(), bodies.n_asleep()), (5, 3));
    let top = bodies.pose(BodyId(1)).position.z;
    (0..400).for_each(|_| bodies.advance(1e-3).unwrap());
    let fallen = (top - bodies.pose(BodyId(1)).position.z) / R;
    assert!((fallen - 2.0).abs() < 0.05, "{fallen}");
    // They may sleep again by now; the third tower never woke.
    assert!((2..5).all(|b| bodies.is_asleep(BodyId(b))));
    let bullet = moving([0.0, 1.0, 0.0], [0.0; 3]);
    let at = Pose::at([8.0 * R, -3.0 * R, 3.0 * R]);
    bodies.add(sphere().shape(), soft, at, bullet, Freedom::FREE).unwrap();
    (0..30).for_each(|_| bodies.advance(1e-3).unwrap());
    assert!((2..5).all(|b| !bodies.is_asleep(BodyId(b))));
    assert!(bodies.pose(BodyId(3)).position.y > 0.1 * R);
}

#[test]
fn tethers_go_along() {
    let mut bodies = scene(sphere(), elastic(), &[0.0, 1.0, 2.0].map(|x| ([x, 0.0, 0.0], Twist::default())));
    let tether =
        Tether { on_body: Point::origin(), anchor: Point::new(2.0, 0.1, 0.0), stiffness: 1e9, damping: 0.0 };
    bodies.set_tether(BodyId(2), Some(tether)).unwrap();
    let dt = bodies.stable_dt();
    let _ = bodies.remove(&[BodyId(0)]).unwrap();
    assert_eq!((bodies.tether(BodyId(0)), bodies.tether(BodyId(1))), (None, Some(&tether)));
    assert_eq!(bodies.stable_dt(), dt);
    bodies.advance(dt).unwrap();
    assert!(bodies.twist(BodyId(1)).linear.y > 0.0 && bodies.twist(BodyId(0)) == Twist::default());
    let _ = bodies.remove(&[BodyId(1)]).unwrap();
    assert!(bodies.stable_dt() > 10.0 * dt);
}

#[test]
fn who_is_not_there_cannot_go() {
    let mut bodies = scene(sphere(), elastic(), &[([0.0; 3], Twist::default())]);
    let wrong = Err(DemError::NoSuchBody { body: BodyId(1), bodies: 1 });
    assert_eq!(bodies.remove(&[BodyId(0), BodyId(1)]), wrong);
    assert_eq!(bodies.set_tether(BodyId(1), None), Err(DemError::NoSuchBody { body: BodyId(1), bodies: 1 }));
    assert_eq!(bodies.n_bodies(), 1);
    assert_eq!(bodies.remove(&[]).unwrap().left(), 1);
    // Told twice, gone once; an empty set goes on.
    assert_eq!(bodies.remove(&[BodyId(0), BodyId(0)]).unwrap().left(), 0);
    bodies.advance(0.1).unwrap();
}
