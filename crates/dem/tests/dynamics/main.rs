//! Contacts and motion against closed forms; what the files share.
mod absent;
mod bad_input;
mod belts;
mod collisions;
mod depth;
mod film;
mod friction;
mod many;
mod near;
mod polygons;
#[cfg(feature = "placing")]
mod population;
mod potential;
mod removal;
mod repulsion;
mod rocking;
mod rotation;
mod sleep;
mod start;
mod state;
mod stress;
mod tether;

use dem::{Disc, Material, RigidBodies, Shape, Sphere};
use interfaces::{Bodies, BodyId, Freedom, Kinematics, Load, Periods, Pose, Twist, Vector, Wrench};
use std::sync::Arc;

pub(crate) const R: f64 = 0.01;

/// A disc or a sphere.
#[derive(Clone, Copy)]
pub(crate) enum Ball {
    Disc(Disc),
    Sphere(Sphere),
}
impl Ball {
    pub(crate) fn is_plane(self) -> bool {
        matches!(self, Self::Disc(_))
    }
    pub(crate) fn shape(self) -> Arc<dyn Shape> {
        match self {
            Self::Disc(s) => Arc::new(s),
            Self::Sphere(s) => Arc::new(s),
        }
    }
    pub(crate) fn mass(self, material: &Material) -> f64 {
        self.shape().inertia(material.density).mass
    }
}
pub(crate) fn disc() -> Ball {
    Ball::Disc(Disc::new(R).unwrap())
}
pub(crate) fn sphere() -> Ball {
    Ball::Sphere(Sphere::new(R).unwrap())
}
/// Neither damping nor friction.
pub(crate) fn elastic() -> Material {
    Material { damping: 0.0, friction: 0.0, ..Material::default() }
}
pub(crate) fn moving(linear: [f64; 3], angular: [f64; 3]) -> Twist {
    Twist { linear: linear.into(), angular: angular.into() }
}
pub(crate) fn freedom(shape: Ball) -> Freedom {
    if shape.is_plane() { Freedom::PLANAR } else { Freedom::FREE }
}
pub(crate) fn push(force: Vector) -> Load {
    Load { wrench: Wrench { force, torque: Vector::zeros() }, ..Load::default() }
}
/// Bodies of one shape and material in free space.
pub(crate) fn scene(shape: Ball, material: Material, bodies: &[([f64; 3], Twist)]) -> RigidBodies {
    let mut all = RigidBodies::new(Periods::default());
    for (place, twist) in bodies {
        all.add(shape.shape(), material, Pose::at(*place), *twist, freedom(shape)).unwrap();
    }
    all
}
/// Two equal bodies, `gap` apart along x, that approach each other at `speed`.
pub(crate) fn head_on(shape: Ball, material: Material, gap: f64, speed: f64) -> RigidBodies {
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
pub(crate) fn momenta<L: dem::ContactLaw>(bodies: &RigidBodies<L>) -> (Vector, Vector) {
    bodies.ids().fold((Vector::zeros(), Vector::zeros()), |(p, l), b| {
        let (inertia, pose, twist) = (bodies.inertia(b), bodies.pose(b), bodies.twist(b));
        let q = pose.orientation;
        let momentum = twist.linear * inertia.mass;
        let spin = q * (inertia.tensor * q.inverse_transform_vector(&twist.angular));
        (p + momentum, l + pose.position.coords.cross(&momentum) + spin)
    })
}
