//! Bodies on springs.
use crate::R;
use dem::{DemError, Material, RigidBodies, Sphere, Tether};
use interfaces::{BodyId, Dynamics, Freedom, Kinematics, Periods, Point, Pose, Twist, Vector};
use std::f64::consts::{PI, TAU};

const BODY: BodyId = BodyId(0);

fn ball(tether: Tether) -> (RigidBodies, f64) {
    let material = Material { density: 1000.0, ..Material::default() };
    let mut bodies = RigidBodies::new(Periods::default());
    bodies
        .add(Sphere::new(R).unwrap(), material, Pose::at([0.0; 3]), Twist::default(), Freedom::FREE)
        .unwrap();
    bodies.set_tether(BODY, Some(tether)).unwrap();
    (bodies, 1000.0 * 4.0 / 3.0 * PI * R.powi(3))
}

/// It swings with period 2π√(m/k), and for ever: after a hundred swings energy is what it was to 1e-4. A dashpot takes e^(−ct/2m).
#[test]
fn a_ball_on_a_spring_swings() {
    let (k, anchor) = (40.0, Point::new(0.003, 0.0, 0.0));
    let free = Tether { on_body: Point::origin(), anchor, stiffness: k, damping: 0.0 };
    let (mut bodies, m) = ball(free);
    let period = TAU * (m / k).sqrt();
    let energy = |bodies: &RigidBodies| bodies.kinetic_energy() + free.energy(&bodies.pose(BODY));
    let start = energy(&bodies);
    for swing in 0..100 {
        bodies.advance(0.5 * period).unwrap();
        let x = bodies.pose(BODY).position.x;
        assert!((x / 0.006 - 1.0).abs() < 1e-3 * f64::from(1 + swing), "after {swing}.5 swings at {x}");
        bodies.advance(0.5 * period).unwrap();
    }
    assert!((energy(&bodies) / start - 1.0).abs() < 1e-3, "{} {start}", energy(&bodies));

    let (mut bodies, m) = ball(Tether { damping: 0.1 * (m * k).sqrt(), ..free });
    // Ten swings of the damped one.
    let (rate, whole) = (0.05 * (k / m).sqrt(), TAU / ((k / m) * (1.0 - 0.0025)).sqrt());
    bodies.advance(10.0 * whole).unwrap();
    let (left, exact) = ((0.003 - bodies.pose(BODY).position.x) / 0.003, (-rate * 10.0 * whole).exp());
    assert!((left / exact - 1.0).abs() < 0.03, "{left} {exact}");
}

/// Tied off its centre it is a pendulum on a spring: energy and the angular momentum about the vertical through the anchor stay.
#[test]
fn a_ball_hangs_by_its_pole() {
    let anchor = Point::new(0.5 * R, 0.0, R);
    let tether = Tether { on_body: Point::new(R, 0.0, 0.0), anchor, stiffness: 50.0, damping: 0.0 };
    let (mut bodies, m) = ball(tether);
    bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
    bodies.set_twist(BODY, Twist { linear: Vector::new(0.0, 0.1, 0.0), angular: Vector::new(1.0, 2.0, 3.0) });
    let books = |bodies: &RigidBodies| {
        let (pose, twist) = (bodies.pose(BODY), bodies.twist(BODY));
        let energy = bodies.kinetic_energy() + tether.energy(&pose) + m * 9.81 * (pose.position.z + R);
        let moment = m * (pose.position - anchor).cross(&twist.linear) + 0.4 * m * R * R * twist.angular;
        (energy, moment.z)
    };
    let start = books(&bodies);
    bodies.advance(20.0).unwrap();
    let end = books(&bodies);
    assert!(
        (end.0 / start.0 - 1.0).abs() < 2e-3 && (end.1 / start.1 - 1.0).abs() < 2e-3,
        "{end:?} {start:?}"
    );
    assert!(bodies.contact_impulse(BODY).force.z > 0.9 * 20.0 * m * 9.81, "the spring bears the weight");
}

#[test]
fn senseless_tethers_are_refused() {
    let good = Tether { on_body: Point::origin(), anchor: Point::origin(), stiffness: 1.0, damping: 0.0 };
    let (mut bodies, _) = ball(good);
    for bad in [
        Tether { stiffness: -1.0, ..good },
        Tether { damping: f64::NAN, ..good },
        Tether { anchor: Point::new(f64::INFINITY, 0.0, 0.0), ..good },
    ] {
        assert!(matches!(bodies.set_tether(BODY, Some(bad)), Err(DemError::Tether { body: BODY, .. })));
    }
    assert_eq!(bodies.tether(BODY), Some(&good));
    bodies.set_tether(BODY, None).unwrap();
    assert_eq!(bodies.tether(BODY), None);
    assert!(bodies.stable_dt() < 1.0);
}
