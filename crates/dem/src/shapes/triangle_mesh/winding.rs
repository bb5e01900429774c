//! How often a surface goes around a point.
use interfaces::{Point, Vector};
use std::f64::consts::PI;

/// Generalised winding number of the faces around `x`: the sum of their solid angles over 4π (Jacobson, Kavan &
/// Sorkine-Hornung 2013, ACM Trans. Graph. 32, 33; solid angle of a triangle: Van Oosterom & Strackee 1983, IEEE Trans.
/// Biomed. Eng. 30, 125).
pub(crate) fn winding_number<'a>(
    faces: impl Iterator<Item = &'a [u32; 3]>,
    at: impl Fn(u32) -> Point,
    x: Point,
) -> f64 {
    let solid_angle = |face: &[u32; 3]| {
        let [a, b, c] = face.map(|v| at(v) - x);
        let [p, q, r]: [f64; 3] = [a, b, c].map(|v: Vector| v.norm());
        let below = p * q * r + a.dot(&b) * r + b.dot(&c) * p + c.dot(&a) * q;
        // a·(b × c), with differences of corners so that narrow faces keep their digits.
        2.0 * a.dot(&(b - a).cross(&(c - a))).atan2(below)
    };
    faces.map(solid_angle).sum::<f64>() / (4.0 * PI)
}
