//! Polygons in plane scenes.
use crate::R;
use dem::{Chen, ContactLaw, Disc, HalfSpace, Material, Polygon, Potential, RigidBodies, Shape, Sphere};
use interfaces::{
    Bodies, BodyId, Dynamics, Freedom, Kinematics, Periods, Point, Pose, Rotation, Twist, Vector,
};
use std::sync::Arc;

fn angle() -> Arc<dyn Shape> {
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    Arc::new(Polygon::new(&corners.map(|c: [f64; 2]| c.map(|x| x * R))).unwrap())
}

fn turned(x: f64, y: f64, angle: f64) -> Pose {
    Pose { orientation: Rotation::from_scaled_axis(Vector::z() * angle), ..Pose::at([x, y, 0.0]) }
}

/// Momentum, angular momentum about the origin, kinetic energy.
fn books<L: ContactLaw>(bodies: &RigidBodies<L>) -> (Vector, f64, f64) {
    bodies.ids().fold((Vector::zeros(), 0.0, 0.0), |(p, l, e), b| {
        let (inertia, pose, twist) = (bodies.inertia(b), bodies.pose(b), bodies.twist(b));
        let spin = inertia.tensor[(2, 2)] * twist.angular.z;
        let momentum = inertia.mass * twist.linear;
        let energy = 0.5 * (momentum.dot(&twist.linear) + spin * twist.angular.z);
        (p + momentum, l + spin + pose.position.coords.cross(&momentum).z, e + energy)
    })
}

/// An angle, a disc and an ellipse that collide without friction, elastic: momentum, angular momentum and energy stay.
#[test]
fn elastic_collisions_keep_the_books() {
    let stone = Material { density: 2000.0, restitution: 1.0, friction: 0.0, ..Material::default() };
    let mut bodies = RigidBodies::with_law(Periods::default(), Potential::default());
    let ellipse = Arc::new(Polygon::ellipse([1.5 * R, 0.7 * R], 60).unwrap());
    let starts: [(Arc<dyn Shape>, Pose, [f64; 3]); 3] = [
        (angle(), turned(0.0, 0.0, 0.3), [0.0, 0.0, 5.0]),
        (Arc::new(Disc::new(0.5 * R).unwrap()), turned(3.0 * R, 0.8 * R, 0.0), [-0.5, 0.0, 0.0]),
        (ellipse, turned(-R, 4.0 * R, 1.0), [0.1, -0.6, -3.0]),
    ];
    for (shape, pose, [u, v, spin]) in starts {
        let motion = Twist { linear: Vector::new(u, v, 0.0), angular: Vector::z() * spin };
        bodies.add(shape, stone, pose, motion, Freedom::PLANAR).unwrap();
    }
    let before = books(&bodies);
    let mut touched = 0;
    for _ in 0..400 {
        bodies.advance(0.02 * R).unwrap();
        touched += usize::from(bodies.n_contacts() > 0);
    }
    let after = books(&bodies);
    assert!(touched > 3 && bodies.n_contacts() == 0, "{touched}");
    assert!((after.0 - before.0).norm() < 1e-12 * before.2.sqrt());
    assert!((after.1 - before.1).abs() < 1e-10 * before.1.abs().max(before.2 * R), "{before:?} {after:?}");
    assert!((after.2 / before.2 - 1.0).abs() < 2e-3, "{} {}", before.2, after.2);
}

/// A block slides down a plane of 30° as Coulomb's law tells, or stays, and a wall bears its weight on two corners.
#[test]
fn blocks_slide_by_coulombs_law() {
    for (friction, expected) in [(0.3, 9.81 * (0.5 - 0.3 * 0.75_f64.sqrt())), (0.7, 0.0)] {
        let wood = Material { density: 700.0, youngs_modulus: 1e7, friction, ..Material::default() };
        let mut bodies = RigidBodies::with_law(Periods::default(), Chen::default());
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::y()).unwrap(), wood).unwrap();
        bodies.set_gravity(9.81 * Vector::new(0.5, -0.75_f64.sqrt(), 0.0));
        let block = Polygon::rectangle([0.06, 0.03]).unwrap();
        bodies.add(block, wood, turned(0.0, 0.015, 0.0), Twist::default(), Freedom::PLANAR).unwrap();
        for _ in 0..400 {
            bodies.advance(1e-3).unwrap();
        }
        let speed = bodies.twist(BodyId(0)).linear.x;
        assert!((speed - 0.4 * expected).abs() < 2e-3, "{speed} {}", 0.4 * expected);
        assert!(bodies.pose(BodyId(0)).orientation.angle() < 1e-3);
    }
}

#[test]
fn plane_and_solid_bodies_do_not_meet() {
    let mut bodies = RigidBodies::with_law(Periods::default(), Chen::default());
    let free = Freedom::PLANAR;
    bodies.add(angle(), Material::default(), turned(0.0, 0.0, 0.0), Twist::default(), free).unwrap();
    let sphere = Sphere::new(R).unwrap();
    assert!(bodies.add(sphere, Material::default(), turned(0.1, 0.0, 0.0), Twist::default(), free).is_err());
}
