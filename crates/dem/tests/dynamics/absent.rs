//! Bodies without contacts: the law `()`.
use super::*;
use dem::HalfSpace;
use interfaces::{Checkpoint, Dynamics, Point};

/// Two balls fly at one another over a floor, under gravity.
fn scene() -> RigidBodies<()> {
    let mut bodies = RigidBodies::with_law(Periods::default(), ());
    bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), Material::default()).unwrap();
    for side in [-1.0, 1.0] {
        let (at, twist) =
            (Pose::at([3.0 * side * R, 0.0, 2.0 * R]), moving([-side, 0.0, 0.0], [0.0, 0.0, side]));
        bodies.add(Sphere::new(R).unwrap(), Material::default(), at, twist, Freedom::FREE).unwrap();
    }
    bodies
}

/// They pass through one another and through the floor, in one step however long, and no overlap is asked for.
#[test]
fn bodies_pass_through_all() {
    let (dt, mut bodies) = (0.01, scene());
    assert_eq!(bodies.stable_dt(), f64::INFINITY);
    bodies.check_overlaps().unwrap();
    for _ in 0..10 {
        bodies.advance(dt).unwrap();
        assert_eq!((bodies.n_contacts(), bodies.overlap_calls()), (0, 0));
    }
    for (b, side) in [(BodyId(0), -1.0), (BodyId(1), 1.0)] {
        let fallen = Vector::new(-0.1 * side + 3.0 * side * R, 0.0, 2.0 * R - 0.5 * 9.81 * 0.01);
        assert!((bodies.pose(b).position.coords - fallen).norm() < 1e-14, "{}", bodies.pose(b).position);
        assert_eq!(bodies.contact_impulse(b).force, Vector::zeros());
        assert!((bodies.twist(b).linear - Vector::new(-side, 0.0, -0.981)).norm() < 1e-14);
    }
}

/// Stopped and gone on, they are where they would have been, bit for bit.
#[test]
fn they_go_on_from_a_saved_state() {
    let (mut whole, mut second) = (scene(), scene());
    let mut saved = Vec::new();
    for step in 0..20 {
        whole.advance(0.003).unwrap();
        if step == 9 {
            whole.save(&mut |name, values| saved.push((name.to_owned(), values.to_vec())));
        }
    }
    second.restore(&|name| saved.iter().find(|(n, _)| n == name).map(|(_, values)| &values[..])).unwrap();
    (0..10).for_each(|_| second.advance(0.003).unwrap());
    assert!(whole.ids().all(|b| whole.pose(b) == second.pose(b) && whole.twist(b) == second.twist(b)));
}
