//! Distances, mass properties and surfaces of the shapes.
use super::{Capsule, Cylinder, Ellipsoid, Shape, SmoothConvex};
use crate::DemError;
use approx::assert_relative_eq;
use interfaces::{Point, Solid, Vector};
use proptest::prelude::*;
use std::f64::consts::PI;

fn shapes() -> Vec<Box<dyn Shape>> {
    vec![
        Box::new(Ellipsoid::new([0.5, 1.0, 0.8]).unwrap()),
        Box::new(Cylinder::new(0.5, 1.3).unwrap()),
        Box::new(Capsule::new(0.5, 1.3).unwrap()),
    ]
}

#[test]
fn lengths_must_be_lengths() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Ellipsoid::new([1.0, bad, 1.0]), Err(DemError::Length { .. })));
        assert!(matches!(Cylinder::new(bad, 1.0), Err(DemError::Length { .. })));
        assert!(matches!(Cylinder::new(1.0, bad), Err(DemError::Length { .. })));
        assert!(matches!(Capsule::new(bad, 1.0), Err(DemError::Length { .. })));
        assert!(matches!(Capsule::new(1.0, bad), Err(DemError::Length { .. })));
    }
}

/// Volume and ∫x² dV by midpoints.
#[test]
fn inertia_by_summation() {
    for shape in shapes() {
        let (half, n) = (shape.aabb().extent() * 0.5, 80);
        let at = |i: usize, a: usize| half[a] * ((2 * i + 1) as f64 / n as f64 - 1.0);
        let cell = half.product() * 8.0 / f64::from(n as u32).powi(3);
        let (mut volume, mut squares) = (0.0, Vector::zeros());
        for (i, j, k) in (0..n * n * n).map(|m| (m % n, m / n % n, m / n / n)) {
            let x = Point::new(at(i, 0), at(j, 1), at(k, 2));
            if shape.signed_distance(x, f64::INFINITY) < 0.0 {
                volume += cell;
                squares += x.coords.component_mul(&x.coords) * cell;
            }
        }
        let inertia = shape.inertia(3.0);
        assert_relative_eq!(inertia.volume, volume, max_relative = 3e-3);
        assert_relative_eq!(inertia.mass, 3.0 * inertia.volume, max_relative = 1e-14);
        for a in 0..3 {
            let about = 3.0 * (squares.sum() - squares[a]);
            assert_relative_eq!(inertia.tensor[(a, a)], about, max_relative = 5e-3);
        }
    }
}

/// Elements lie on the offset surface, close it, and fill the volume within; areas follow Steiner's formula.
#[test]
fn surfaces() {
    for shape in shapes() {
        let area = |offset: f64| -> f64 { shape.surface(0.05, offset).unwrap().iter().map(|e| e.area).sum() };
        for offset in [-0.1, 0.0, 0.3] {
            let elements = shape.surface(0.05, offset).unwrap();
            let mut closed = Vector::zeros();
            for e in &elements {
                assert_relative_eq!(shape.signed_distance(e.point, 1.0), offset, epsilon = 1e-12);
                assert_relative_eq!(shape.normal(e.point + 1e-9 * e.normal, 1.0), e.normal, epsilon = 1e-5);
                closed += e.normal * e.area;
            }
            assert!(closed.norm() < 2e-2, "{} {closed}", shape.name());
            if offset == 0.0 {
                let volume: f64 = elements.iter().map(|e| e.area * e.normal.dot(&e.point.coords) / 3.0).sum();
                assert_relative_eq!(volume, shape.inertia(1.0).volume, max_relative = 3e-3);
            }
        }
        // A(d) = A + 2Md + 4πd² outside of a convex body.
        let second = area(0.4) - 2.0 * area(0.2) + area(0.0);
        assert_relative_eq!(second, 8.0 * PI * 0.04, max_relative = 1e-6);
        assert!(shape.surface(0.0, 0.0).is_none() && shape.surface(0.1, -3.0).is_none());
    }
    // A spheroid's area in closed form, axes 0.3 and 3.
    let (a, c) = (0.3, 3.0_f64);
    let e = (1.0 - a * a / (c * c)).sqrt();
    let exact = 2.0 * PI * a * a * (1.0 + c / (a * e) * e.asin());
    let whole: f64 =
        Ellipsoid::new([a, a, c]).unwrap().surface(0.1, 0.0).unwrap().iter().map(|e| e.area).sum();
    assert_relative_eq!(whole, exact, max_relative = 1e-6);
}

/// The sum of curvatures is the divergence of the normal.
#[test]
fn curvatures() {
    for shape in shapes() {
        for x in [Point::new(0.6, 0.5, 0.9), Point::new(-0.3, 0.2, 1.4), Point::new(0.7, 0.1, 0.2)] {
            let h = 1e-5;
            let divergence: f64 = (0..3)
                .map(|a| {
                    let mut e = Vector::zeros();
                    e[a] = h;
                    (shape.normal(x + e, 1.0)[a] - shape.normal(x - e, 1.0)[a]) / (2.0 * h)
                })
                .sum();
            assert_relative_eq!(shape.curvature(x, 1.0), divergence, epsilon = 1e-6, max_relative = 1e-6);
        }
    }
}

#[test]
fn distances_at_the_centre_and_on_the_axes() {
    let e = Ellipsoid::new([1.0, 0.25, 3.0]).unwrap();
    for (x, d) in [
        ([0.0, 0.0, 0.0], -0.25),
        ([2.0, 0.0, 0.0], 1.0),
        ([0.0, -1.0, 0.0], 0.75),
        ([0.0, 0.0, 4.0], 1.0),
        ([1.0, 0.0, 0.0], 0.0),
        ([0.0, 0.0, -2.999], -0.001),
    ] {
        assert_relative_eq!(e.nearest(Point::from(x)).1, d, epsilon = 1e-15);
    }
    let ball = Ellipsoid::new([0.7; 3]).unwrap();
    assert_eq!(ball.nearest(Point::origin()).1, -0.7);
    assert_relative_eq!(ball.nearest(Point::new(0.1, 0.2, 0.2)).1, -0.4, epsilon = 1e-15);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    /// The nearest point is on the surface, straight below along its normal, and no other is nearer; also of needles and
    /// flakes, near axes and centre.
    #[test]
    fn nearest_point(powers in prop::array::uniform3(-3..=3i32), near in prop::array::uniform3(-1.0..1.0f64),
                     small in prop::array::uniform3(0..4i32), scale in 0.0..3.0f64, u in prop::array::uniform3(-1.0..1.0f64)) {
        let axes = powers.map(|p| 10f64.powi(p));
        let e = Ellipsoid::new(axes).unwrap();
        let x = Point::from(Vector::from_fn(|i, _| axes[i] * near[i] * scale * 10f64.powi(-5 * small[i].max(1) + 5)));
        let (c, d) = e.nearest(x);
        let (f, g) = e.level(c);
        let size = e.bounding_radius();
        prop_assert!(f.abs() < 1e-9, "{} off the surface", f);
        prop_assert!((x - (c + g.normalize() * d)).norm() < 1e-9 * (size + x.coords.norm()), "{c} {d}");
        prop_assert_eq!(d < 0.0, e.level(x).0 < 0.0);
        let other = Vector::from(u).normalize().component_mul(&Vector::from(axes));
        prop_assert!((other - x.coords).norm() >= d.abs() * (1.0 - 1e-12) - 1e-14 * size);
    }
}

proptest! {
    /// Within the band an ellipsoid's distance is exact; beyond it a bound of the right sign, no less than the band and no more than the distance.
    #[test]
    fn far_points_of_ellipsoids_have_bounds(
        axes in prop::array::uniform3(0.1..3.0_f64), x in prop::array::uniform3(-5.0..5.0_f64), band in 0.01..2.0_f64,
    ) {
        let ellipsoid = Ellipsoid::new(axes).unwrap();
        let (found, exact) = (ellipsoid.signed_distance(x.into(), band), ellipsoid.nearest(x.into()).1);
        if exact.abs() < band {
            prop_assert_eq!(found, exact);
        } else {
            prop_assert!(found.abs() >= band && found.abs() <= exact.abs() * (1.0 + 1e-12), "{} {}", found, exact);
            prop_assert!(found * exact > 0.0);
        }
    }
}
