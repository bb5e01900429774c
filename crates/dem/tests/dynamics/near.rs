//! Which overlaps are computed, and what a step costs.
use super::*;
use dem::{DemError, HalfSpace};
use interfaces::{Dynamics, Point};

#[test]
fn no_overlap_call_while_boxes_are_apart() {
    let mut bodies = head_on(disc(), Material::default(), 0.5 * R, 0.1);
    bodies.add_wall(HalfSpace::new(Point::new(0.0, -2.0 * R, 0.0), Vector::y()).unwrap(), elastic()).unwrap();
    // 0.05 s to go; in a short step boxes cannot meet, in a longer one they might, but do not.
    for dt in [0.01, 0.01, 0.02, 0.0099] {
        bodies.advance(dt).unwrap();
        assert_eq!((bodies.overlap_calls(), bodies.n_contacts(), bodies.contact_time()), (0, 0, 0.0));
    }
    bodies.advance(1e-3).unwrap();
    assert!(bodies.overlap_calls() > 0 && bodies.n_contacts() == 1 && bodies.contact_time() > 0.0);
    // One call per sub-step for the one pair: the wall is never near.
    assert!(bodies.overlap_calls() as f64 <= (1e-3 / bodies.stable_dt()).ceil());
}

/// Within each other's reach, but on their way apart: sub-steps, no overlaps.
#[test]
fn no_overlap_call_for_those_that_part() {
    let mut bodies = head_on(disc(), Material::default(), 0.5 * R, -0.1);
    // They slide along a wall that is 0.05 R away.
    bodies
        .add_wall(HalfSpace::new(Point::new(0.0, -1.05 * R, 0.0), Vector::y()).unwrap(), elastic())
        .unwrap();
    bodies.advance(0.1).unwrap();
    assert_eq!((bodies.overlap_calls(), bodies.n_contacts()), (0, 0));
}

/// A body that is hit within a long step meets others that it was not on its way to.
#[test]
fn a_hit_is_passed_on_within_one_advance() {
    let at = |x: f64, u: f64| ([x * R, 0.0, 0.0], moving([u, 0.0, 0.0], [0.0; 3]));
    let mut cradle = scene(sphere(), elastic(), &[at(0.0, 1.0), at(2.5, 0.0), at(5.0, 0.0), at(7.5, 0.0)]);
    cradle.advance(0.04).unwrap();
    let speeds: Vec<f64> = cradle.ids().map(|b| cradle.twist(b).linear.x).collect();
    assert!(speeds[3] > 0.99 && speeds[..3].iter().all(|u| u.abs() < 0.01), "{speeds:?}");
}

/// Bodies that nothing can move are no pair.
#[test]
fn a_fixed_bed_costs_nothing() {
    let mut bodies = RigidBodies::new(Periods::default());
    for i in 0..10 {
        let pose = Pose::at([1.9 * R * f64::from(i), 0.0, 0.0]);
        bodies.add(disc().shape(), Material::default(), pose, Twist::default(), Freedom::NONE).unwrap();
    }
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::y()).unwrap(), elastic()).unwrap();
    bodies.apply(BodyId(0), push(Vector::new(0.0, -1.0, 0.0)));
    bodies.advance(1.0).unwrap();
    assert_eq!((bodies.overlap_calls(), bodies.n_contacts()), (0, 0));
    assert_eq!(bodies.smallest_gap(), Some(-R));
}

fn settling(n: usize) -> RigidBodies {
    let mut bodies = RigidBodies::new(Periods::new([Some(20.0 * R * 1.05), None, None]));
    for i in 0..n {
        let place = [
            2.1 * R * (i % 10) as f64 + 0.1 * R * (i / 10) as f64,
            1.05 * R + 2.05 * R * (i / 10) as f64,
            0.0,
        ];
        let b = bodies.add(
            disc().shape(),
            Material::default(),
            Pose::at(place),
            Twist::default(),
            Freedom::PLANAR,
        );
        let weight = 1000.0 * std::f64::consts::PI * R * R * 9.81;
        bodies.apply(b.unwrap(), push(Vector::new(0.0, -weight, 0.0)));
    }
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::y()).unwrap(), Material::default()).unwrap();
    bodies
}

#[test]
fn a_warm_advance_allocates_nothing() {
    let mut bodies = settling(100);
    bodies.advance(0.2).unwrap();
    for _ in 0..100 {
        bodies.advance(1e-3).unwrap();
    }
    let info = allocation_counter::measure(|| {
        for _ in 0..20 {
            bodies.advance(1e-3).unwrap();
        }
    });
    assert!(bodies.n_contacts() > 50, "they lie on one another");
    assert_eq!(info.count_total, 0);
}

/// Heavy, soft balls: what is a few sub-steps to their contact is hundreds of periods of the box at their speed. They are listed for less; and who passes
/// the box hundreds of times in the very step is told to be too fast.
#[test]
fn heavy_balls_in_a_small_box_are_listed_for_less() {
    let soft = Material { density: 1e8, youngs_modulus: 1e3, ..Material::default() };
    let made = |speed: f64| {
        let mut bodies = RigidBodies::new(Periods::new([Some(0.01); 3]));
        for (x, speed) in [(0.0025, speed), (0.0075, 0.0)] {
            let twist = Twist { linear: Vector::new(0.0, speed, 0.0), angular: Vector::zeros() };
            bodies
                .add(Sphere::new(1e-3).unwrap(), soft, Pose::at([x, 0.005, 0.005]), twist, Freedom::FREE)
                .unwrap();
        }
        bodies
    };
    let mut bodies = made(10.0);
    // Forty sub-steps of the contact are more than 250 periods.
    assert!(40.0 * bodies.stable_dt() * 10.0 > 250.0 * 0.01, "{}", bodies.stable_dt());
    bodies.advance(1e-4).unwrap();
    assert!((bodies.pose(BodyId(0)).position.y - 0.006).abs() < 1e-12);
    let error = made(1e6).advance(1e-4).unwrap_err();
    assert!(matches!(error, DemError::TooFast { body: BodyId(0), .. }), "{error}");
}
