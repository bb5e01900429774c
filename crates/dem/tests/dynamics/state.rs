//! Free motion, loads, and what a restart needs.
use super::*;
use approx::assert_relative_eq;
use dem::HalfSpace;
use interfaces::{Bodies, Checkpoint, Dynamics, Point, RestartError};

/// Under a constant load drift–kick–drift is exact, added mass and moment included.
#[test]
fn loads_accelerate_body_and_added_mass() {
    for shape in [disc(), sphere()] {
        let mut bodies =
            scene(shape, Material::default(), &[([0.0; 3], moving([0.1, 0.0, 0.0], [0.0, 0.0, 2.0]))]);
        let inertia = bodies.inertia(BodyId(0));
        let (added_mass, added_moment) = (0.7 * inertia.mass, 1.5 * inertia.tensor[(2, 2)]);
        let (force, torque) =
            (Vector::new(2.0, -3.0, 0.0) * inertia.mass, Vector::z() * inertia.tensor[(2, 2)]);
        bodies.apply(BodyId(0), Load { wrench: Wrench { force, torque }, added_mass, added_moment });
        for _ in 0..10 {
            bodies.advance(0.05).unwrap();
        }
        let (pose, twist) = (bodies.pose(BodyId(0)), bodies.twist(BodyId(0)));
        assert_relative_eq!(twist.linear, Vector::new(0.1 + 1.0 / 1.7, -1.5 / 1.7, 0.0), epsilon = 1e-13);
        assert_relative_eq!(twist.angular.z, 2.0 + 0.5 / 2.5, epsilon = 1e-13);
        assert_relative_eq!(pose.position.y, -1.5 / 1.7 * 0.25, epsilon = 1e-13);
        let angle = 2.0 * 0.5 + 0.5 * 0.4 * 0.25;
        assert_relative_eq!(pose.orientation.scaled_axis(), Vector::z() * angle, epsilon = 1e-13);
    }
}

/// ½mr² about z for a disc, ⅖mr² for a sphere: what the energy says.
#[test]
fn kinetic_energy_of_translation_and_spin() {
    for (shape, share, mass) in [
        (disc(), 0.5, std::f64::consts::PI * R * R),
        (sphere(), 0.4, 4.0 / 3.0 * std::f64::consts::PI * R.powi(3)),
    ] {
        let bodies =
            scene(shape, Material::default(), &[([0.0; 3], moving([3.0, 4.0, 0.0], [0.0, 0.0, 7.0]))]);
        let exact = 0.5 * 1000.0 * mass * (25.0 + share * R * R * 49.0);
        assert_relative_eq!(bodies.kinetic_energy(), exact, max_relative = 1e-14);
    }
}

#[test]
fn without_torque_spin_stays() {
    let mut bodies =
        scene(disc(), Material::default(), &[([0.0; 3], moving([0.2, 0.3, 0.0], [0.0, 0.0, 123.4]))]);
    bodies.apply(BodyId(0), push(Vector::new(1.0, 2.0, 0.0)));
    for _ in 0..1000 {
        bodies.advance(1e-3).unwrap();
    }
    assert_eq!(bodies.twist(BodyId(0)).angular, Vector::new(0.0, 0.0, 123.4));
    let turned = bodies.pose(BodyId(0)).orientation;
    assert!((turned.norm() - 1.0).abs() < 1e-14);
    assert!(turned.angle_to(&interfaces::Rotation::from_scaled_axis(Vector::z() * 123.4)) < 1e-10);
}

/// Fixed bodies stay, prescribed ones go as told, whatever pushes; constrained components do not change.
#[test]
fn freedom_is_kept() {
    let mut bodies = RigidBodies::new(Periods::default());
    let told = moving([0.0, 0.1, 0.0], [0.0, 0.0, 1.0]);
    let slider = Freedom { linear: [true, false, false], angular: [false; 3] };
    let mut add = |x: f64, twist, freedom| {
        bodies.add(disc().shape(), Material::default(), Pose::at([x, 0.0, 0.0]), twist, freedom)
    };
    let fixed = add(0.0, Twist::default(), Freedom::NONE).unwrap();
    let prescribed = add(1.0, told, Freedom::NONE).unwrap();
    let sliding = add(1.95 * R, Twist::default(), slider).unwrap();
    for b in [fixed, prescribed, sliding] {
        bodies.apply(b, push(Vector::new(-1.0, 2.0, 3.0)));
    }
    bodies.advance(1e-3).unwrap();
    assert!(bodies.contact_impulse(fixed).force.x < 0.0, "it was pushed");
    for _ in 1..100 {
        bodies.advance(1e-3).unwrap();
    }
    assert_eq!(bodies.pose(fixed), Pose::at([0.0; 3]));
    assert_eq!(bodies.twist(prescribed), told);
    assert_relative_eq!(bodies.pose(prescribed).position, Point::new(1.0, 0.01, 0.0), epsilon = 1e-14);
    let motion = bodies.twist(sliding);
    assert!(motion.linear.x != 0.0);
    assert_eq!((motion.linear.y, motion.linear.z, motion.angular), (0.0, 0.0, Vector::zeros()));
}

/// Three discs that roll and rub on a floor across a periodic side.
fn rubbing() -> RigidBodies {
    let mut bodies = RigidBodies::new(Periods::new([Some(6.3 * R), None, None]));
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::y()).unwrap(), Material::default()).unwrap();
    for (x, y, u, spin) in [(0.0, 1.001, 0.1, 30.0), (2.2, 1.0, -0.2, -5.0), (4.3, 1.3, 0.3, 11.0)] {
        let twist = moving([u, 0.0, 0.0], [0.0, 0.0, spin]);
        bodies
            .add(disc().shape(), Material::default(), Pose::at([x * R, y * R, 0.0]), twist, Freedom::PLANAR)
            .unwrap();
    }
    bodies
}
fn saved(bodies: &RigidBodies) -> Vec<(String, Vec<u64>)> {
    let mut all = Vec::new();
    bodies
        .save(&mut |name, values| all.push((name.to_owned(), values.iter().map(|v| v.to_bits()).collect())));
    all
}

#[test]
fn a_restart_amid_frictional_contact_continues_bit_for_bit() {
    let mut bodies = rubbing();
    for b in bodies.ids() {
        let weight = push(Vector::new(0.0, -9.81 * bodies.inertia(b).mass, 0.0));
        bodies.apply(b, Load { added_mass: 0.1, added_moment: 1e-5, ..weight });
    }
    for _ in 0..30 {
        bodies.advance(1e-3).unwrap();
    }
    assert!(bodies.n_contacts() >= 2);
    let state: Vec<(String, Vec<f64>)> = {
        let mut all = Vec::new();
        bodies.save(&mut |name, values| all.push((name.to_owned(), values.to_vec())));
        all
    };
    let source = |name: &str| state.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_slice());
    let mut again = rubbing();
    again.restore(&source).unwrap();
    for step in 0..50 {
        assert_eq!(saved(&again), saved(&bodies), "after {step} steps");
        assert!(again.contacts().eq(bodies.contacts()), "after {step} steps");
        for b in bodies.ids() {
            assert_eq!(again.contact_impulse(b), bodies.contact_impulse(b));
        }
        bodies.advance(1e-3).unwrap();
        again.advance(1e-3).unwrap();
    }

    // State of another set-up is refused.
    let mut other = scene(disc(), Material::default(), &[([0.0; 3], Twist::default())]);
    let error = other.restore(&source).unwrap_err();
    assert!(matches!(&error, RestartError::Length { name, found, .. } if name == "bodies" && found % 3 == 0));
    for (name, _) in &state {
        let without = |n: &str| if n == name { None } else { source(n) };
        assert_eq!(rubbing().restore(&without), Err(RestartError::Missing(name.clone())));
    }
}
