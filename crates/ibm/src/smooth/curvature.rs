//! Where markers have to be on curved surfaces.
use interfaces::{Solid, SurfaceElement};

/// Moves an element of the level surface at the retraction −r_d farther in where the surface bulges:
///
/// ```text
/// x ← x − C r_d² K n,   A ← A (1 − C r_d² K²),   C = 1.75,   |C r_d² K| ≤ r_d/2
/// ```
///
/// K is the sum of the principal curvatures as the cells see it, the Laplacian of the signed distance by differences over `h`. The retraction makes up for
/// what the kernel blurs of straight profiles; those at a bulging surface are bent. (The blurred profile around a turning sphere, Ω within, Ω(a/r)³ outside, asks
/// for C = 2 to second order, drag for more.)
pub(super) fn follow_curvature(
    element: &mut SurfaceElement,
    solid: &dyn Solid,
    dim: usize,
    h: f64,
    retraction: f64,
) {
    let at = element.point + retraction * element.normal;
    let mut points = [at; 7];
    for a in 0..dim {
        points[1 + 2 * a][a] += h;
        points[2 + 2 * a][a] -= h;
    }
    let (mut distances, n) = ([0.0; 7], 1 + 2 * dim);
    solid.signed_distances(&points[..n], 4.0 * h, &mut distances[..n]);
    let around: f64 = distances[1..n].iter().sum();
    let curvature = (around - 2.0 * dim as f64 * distances[0]) / (h * h);
    let most = LARGEST_SHARE * retraction;
    let inwards = (SHARE * retraction * retraction * curvature).clamp(-most, most);
    element.point -= inwards * element.normal;
    element.area *= 1.0 - curvature * inwards;
}

/// C. Measured with spheres of 6 to 16 cells per diameter: the torque of a turning one becomes right to 0.1 %, the drag of one in a periodic cube is off by half of what it
/// was (`cargo bench --bench moving -- turning cube`).
const SHARE: f64 = 1.75;
/// Largest part of the retraction that curvature adds to it: edges are rounder than the cells see.
const LARGEST_SHARE: f64 = 0.5;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Ball;
    use interfaces::{Aabb, Point, Vector};

    #[test]
    fn markers_of_a_ball_lie_deeper_by_its_curvature() {
        let (radius, h, r) = (0.5, 0.05, 0.0156);
        let normal = Vector::new(1.0, 2.0, -2.0) / 3.0;
        let mut element = SurfaceElement { point: Point::from((radius - r) * normal), normal, area: 1.0 };
        follow_curvature(&mut element, &Ball { radius, dim: 3 }, 3, h, r);
        let expected = radius - r - SHARE * r * r * 2.0 / radius;
        // Differences over h see the curvature to (h/R)².
        assert!((element.point.coords.norm() - expected).abs() < 0.01 * r * r / radius, "{element:?}");
        assert!((element.area - (1.0 - SHARE * r * r * 4.0 / (radius * radius))).abs() < 1e-4);
    }

    #[test]
    fn flat_faces_keep_theirs_and_hollow_ones_move_out() {
        struct Hollow;
        impl Solid for Hollow {
            fn signed_distance(&self, x: Point, _: f64) -> f64 {
                0.5 - x.coords.norm()
            }
            fn aabb(&self) -> Aabb {
                Aabb::around(Point::origin(), Vector::repeat(1.0))
            }
        }
        struct Flat;
        impl Solid for Flat {
            fn signed_distance(&self, x: Point, _: f64) -> f64 {
                x.z
            }
            fn aabb(&self) -> Aabb {
                Aabb::around(Point::origin(), Vector::repeat(1.0))
            }
        }
        let (h, r) = (0.05, 0.0156);
        let start = SurfaceElement { point: Point::new(0.1, 0.2, -r), normal: Vector::z(), area: 1.0 };
        let mut element = start;
        follow_curvature(&mut element, &Flat, 3, h, r);
        assert!((element.point - start.point).norm() < 1e-12 && (element.area - 1.0).abs() < 1e-12);
        let start = SurfaceElement { point: Point::new(0.0, 0.0, 0.5 + r), normal: -Vector::z(), area: 1.0 };
        let mut element = start;
        follow_curvature(&mut element, &Hollow, 3, h, r);
        assert!(element.point.z < start.point.z - 1e-4 && element.point.z > 0.5, "{element:?}");
    }
}
