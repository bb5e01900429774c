//! Contacts and motion against closed forms; what the files share.
mod bad_input;
mod collisions;
mod friction;
mod near;
mod state;

use crate::{Disc, Material, RigidBodies, Round, Sphere};
use interfaces::{BodyId, Freedom, Kinematics, Load, Periods, Pose, Twist, Vector, Wrench};

pub(crate) const R: f64 = 0.01;

pub(crate) fn disc() -> Round {
    Disc::new(R).unwrap().into()
}
pub(crate) fn sphere() -> Round {
    Sphere::new(R).unwrap().into()
}
/// Neither damping nor friction.
pub(crate) fn elastic() -> Material {
    Material { damping: 0.0, friction: 0.0, ..Material::default() }
}
pub(crate) fn moving(linear: [f64; 3], angular: [f64; 3]) -> Twist {
    Twist { linear: linear.into(), angular: angular.into() }
}
pub(crate) fn freedom(shape: Round) -> Freedom {
    if shape.is_plane() { Freedom::PLANAR } else { Freedom::FREE }
}
pub(crate) fn push(force: Vector) -> Load {
    Load { wrench: Wrench { force, torque: Vector::zeros() }, ..Load::default() }
}
/// Bodies of one shape and material in free space.
pub(crate) fn scene(shape: Round, material: Material, bodies: &[([f64; 3], Twist)]) -> RigidBodies {
    let mut all = RigidBodies::new(Periods::default());
    for (place, twist) in bodies {
        all.add(shape, material, Pose::at(*place), *twist, freedom(shape)).unwrap();
    }
    all
}
/// Two equal bodies, `gap` apart along x, that approach each other at `speed`.
pub(crate) fn head_on(shape: Round, material: Material, gap: f64, speed: f64) -> RigidBodies {
    let x = R + 0.5 * gap;
    let bodies = [
        ([-x, 0.0, 0.0], moving([0.5 * speed, 0.0, 0.0], [0.0; 3])),
        ([x, 0.0, 0.0], moving([-0.5 * speed, 0.0, 0.0], [0.0; 3])),
    ];
    scene(shape, material, &bodies)
}
/// Distance of the first two bodies' centres.
pub(crate) fn distance(bodies: &RigidBodies) -> f64 {
    (bodies.pose(BodyId(1)).position - bodies.pose(BodyId(0)).position).norm()
}
/// Momentum and angular momentum about the origin.
pub(crate) fn momenta(bodies: &RigidBodies) -> (Vector, Vector) {
    use interfaces::Bodies;
    bodies.ids().fold((Vector::zeros(), Vector::zeros()), |(p, l), b| {
        let (inertia, pose, twist) = (bodies.inertia(b), bodies.pose(b), bodies.twist(b));
        let q = pose.orientation;
        let momentum = twist.linear * inertia.mass;
        let spin = q * (inertia.tensor * q.inverse_transform_vector(&twist.angular));
        (p + momentum, l + pose.position.coords.cross(&momentum) + spin)
    })
}
