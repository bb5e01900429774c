//! The volume two bodies share, by closed forms; one file per family of pairs.
mod round;

use crate::{DemError, HalfSpace, Shape};
use interfaces::{Point, Vector};

/// What two bodies share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Volume V \[m³\]; area \[m²\] in a plane scene.
    pub volume: f64,
    /// Centroid of the overlap.
    pub centroid: Point,
    /// Contact normal: the way the first body is pushed.
    pub normal: Vector,
    /// Area of the contact, |∂V/∂x| \[m²\]; its length \[m\] in a plane scene.
    pub area: f64,
    /// How far the bodies would have to be moved apart along the normal \[m\].
    pub depth: f64,
}

impl Overlap {
    /// dV/dt = −area n·v, v the velocity of the first body against the second at the contact.
    pub fn rate(&self, relative_velocity: Vector) -> f64 {
        -self.area * self.normal.dot(&relative_velocity)
    }
}

/// The overlap of two bodies with centres `at_a` and `at_b`; `None` when they are apart.
///
/// # Errors
/// [`DemError::Unsupported`] for pairs without a formula.
pub fn overlap(a: &Shape, at_a: Point, b: &Shape, at_b: Point) -> Result<Option<Overlap>, DemError> {
    match (a, b) {
        (Shape::Disc(a), Shape::Disc(b)) => Ok(round::discs(a.radius(), at_a, b.radius(), at_b)),
        (Shape::Sphere(a), Shape::Sphere(b)) => Ok(round::spheres(a.radius(), at_a, b.radius(), at_b)),
        _ => Err(DemError::Unsupported { a: a.name(), b: b.name() }),
    }
}

/// The overlap of a body with centre `at` and a wall.
pub(crate) fn wall_overlap(shape: &Shape, at: Point, wall: &HalfSpace) -> Option<Overlap> {
    let distance = wall.signed_distance(at);
    match shape {
        Shape::Disc(s) => round::disc_wall(s.radius(), at, distance, wall.normal()),
        Shape::Sphere(s) => round::sphere_wall(s.radius(), at, distance, wall.normal()),
    }
}

#[cfg(test)]
mod tests;
