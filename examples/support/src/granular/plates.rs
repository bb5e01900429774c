//! Walls that end: rings of convex pieces around the vertical axis.
use crate::Outcome;
use dem::{ConvexPolyhedron, Shape};
use interfaces::{Point, Pose};
use std::f64::consts::PI;
use std::sync::Arc;

/// A piece of a ring.
#[derive(Clone)]
pub struct Stave {
    /// Its shape.
    pub shape: Arc<dyn Shape>,
    /// Its place.
    pub pose: Pose,
    /// The direction in which it lies from the axis, from x towards y \[rad\].
    pub angle: f64,
}

/// A ring of `count` convex pieces whose section is the quadrilateral with these four corners (distance from the axis along the middle of a
/// piece, and height), in any order. Inside it is a prism or pyramid of `count` sides: a funnel, a tube, a plate with a hole.
///
/// # Errors
/// [`dem::DemError`] for corners that make no body.
pub fn ring_of_staves(count: usize, section: [[f64; 2]; 4]) -> Outcome<Vec<Stave>> {
    let widen = (PI / count as f64).tan();
    let points: Vec<[f64; 3]> =
        section.iter().flat_map(|[r, z]| [[*r, r * widen, *z], [*r, -r * widen, *z]]).collect();
    let shape = ConvexPolyhedron::from_points(&points)?;
    let origin = shape.origin();
    let shape: Arc<dyn Shape> = Arc::new(shape);
    let stave = |i: usize| {
        let angle = 2.0 * PI * i as f64 / count as f64;
        let orientation = interfaces::Rotation::from_euler_angles(0.0, 0.0, angle);
        let position = Point::from(orientation * origin.coords);
        Stave { shape: shape.clone(), pose: Pose { position, orientation }, angle }
    };
    Ok((0..count).map(stave).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::Solid;

    /// A funnel of eight staves: what is within is free, what is beyond is not.
    #[test]
    fn staves_leave_the_inside_free() {
        let ring = ring_of_staves(8, [[1.0, 0.0], [2.0, 1.0], [1.2, -0.1], [2.2, 0.9]]).unwrap();
        let least = |x: [f64; 3]| {
            let of = |s: &Stave| s.shape.signed_distance(s.pose.to_body(Point::from(x)), 10.0);
            ring.iter().map(of).fold(f64::MAX, f64::min)
        };
        for k in 0..24 {
            let (sin, cos) = (PI * f64::from(k) / 12.0).sin_cos();
            assert!(least([1.49 * cos, 1.49 * sin, 0.5]) > 0.0);
            assert!(least([1.75 * cos, 1.75 * sin, 0.5]) < 0.0);
        }
        assert!(least([0.0, 0.0, 0.0]) > 0.9);
    }
}
