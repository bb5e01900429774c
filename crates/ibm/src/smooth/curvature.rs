//! How curved the surface is as the cells see it.
use interfaces::{Point, Solid};

/// Sum of the principal curvatures at a place `x` of the surface \[1/m\], positive where the body bulges: the Laplacian of the signed distance by differences over `h`, which round edges off.
pub(super) fn curvature(x: Point, solid: &dyn Solid, dim: usize, h: f64) -> f64 {
    let mut points = [x; 7];
    for a in 0..dim {
        points[1 + 2 * a][a] += h;
        points[2 + 2 * a][a] -= h;
    }
    let (mut distances, n) = ([0.0; 7], 1 + 2 * dim);
    solid.signed_distances(&points[..n], 4.0 * h, &mut distances[..n]);
    let around: f64 = distances[1..n].iter().sum();
    (around - 2.0 * dim as f64 * distances[0]) / (h * h)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{Aabb, Vector};

    #[test]
    fn flat_faces_have_none_and_hollow_ones_less() {
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
        assert!(curvature(Point::new(0.1, 0.2, 0.0), &Flat, 3, 0.05).abs() < 1e-10);
        let found = curvature(Point::new(0.3, 0.0, 0.4), &Hollow, 3, 0.05);
        assert!((found + 4.0).abs() < 0.02, "{found}");
    }
}
