//! Smooth convex pairs: closed forms, independent routes against one another, symmetries, finite differences.
use super::{Overlap, OverlapSolver, Route};
use crate::{Capsule, Cylinder, Ellipsoid, Form, HalfSpace, Shape, SmoothConvex, Sphere};
use approx::assert_relative_eq;
use interfaces::{Aabb, Inertia, Point, Pose, Rotation, Solid, Vector};
use proptest::prelude::*;
use std::f64::consts::PI;

fn ellipsoid(e: [f64; 3]) -> Ellipsoid {
    Ellipsoid::new(e).unwrap()
}
fn solve(
    route: Option<Route>,
    tolerance: f64,
    a: &dyn Shape,
    at_a: Pose,
    b: &dyn Shape,
    at_b: Pose,
) -> Option<Overlap> {
    let mut solver = OverlapSolver::new().with_route(route).with_tolerance(tolerance);
    let patches = solver.solve(a, &at_a, b, &at_b).unwrap();
    assert!(patches.len() <= 1, "convex bodies share one region");
    patches.first().copied()
}
fn pose(at: [f64; 3], turn: [f64; 3]) -> Pose {
    Pose { position: at.into(), orientation: Rotation::from_scaled_axis(turn.into()) }
}
fn wall() -> HalfSpace {
    HalfSpace::new(Point::origin(), Vector::z()).unwrap()
}
/// Volume, centroid, gradient and moment alike, to a `share` of V, of the area of the cut and V^⅔, and so on.
fn assert_alike(one: &Overlap, two: &Overlap, share: f64) {
    let size = one.volume.cbrt();
    assert_relative_eq!(one.volume, two.volume, max_relative = share);
    let area = one.area() + size * size;
    let width = area.sqrt();
    assert!((one.centroid - two.centroid).norm() < share * width, "{one:?} {two:?}");
    assert!((one.gradient - two.gradient).norm() < share * area, "{one:?} {two:?}");
    assert!((one.moment - two.moment).norm() < share * area * width, "{one:?} {two:?}");
}

#[test]
fn closed_forms_of_the_reference_page() {
    // Two perpendicular equal cylinders through each other: 16r³/3.
    let tube = Cylinder::new(0.3, 2.0).unwrap();
    let across = pose([0.0; 3], [0.5 * PI, 0.0, 0.0]);
    let o = solve(None, 1e-6, &tube, pose([0.0; 3], [0.0; 3]), &tube, across).unwrap();
    assert_relative_eq!(o.volume, 16.0 / 3.0 * 0.027, max_relative = 1e-5);
    assert!(o.centroid.coords.norm() < 1e-6 && o.area() < 1e-5);
    // A cylinder parallel to a plane.
    for depth in [1e-6, 0.01, 0.3, 0.5] {
        let lying = pose([0.0, 0.0, 0.3 - depth], [0.0, 0.5 * PI, 0.0]);
        let o = solve(None, 1e-5, &tube, lying, &wall(), Pose::at([0.0; 3])).unwrap();
        let (r, rest) = (0.3, 0.3 - depth);
        let v = 2.0 * (r * r * f64::acos(rest / r) - rest * (2.0 * r * depth - depth * depth).sqrt());
        assert_relative_eq!(o.volume, v, max_relative = if depth < 1e-3 { 1e-4 } else { 1e-12 });
        assert_relative_eq!(o.area(), 4.0 * (2.0 * r * depth - depth * depth).sqrt(), max_relative = 1e-9);
        assert!(o.moment.norm() < 1e-12);
    }
}

#[test]
fn spheres_by_curve_and_columns() {
    let (big, small) = (Sphere::new(1.0).unwrap(), Sphere::new(0.7).unwrap());
    for d in [1.7 - 1e-6, 1.69, 1.5, 1.2, 0.9, 0.5, 0.31] {
        let at = pose([0.1, -0.2, 0.3], [0.0; 3]);
        let there = Pose::at([0.1 + 0.6 * d, -0.2, 0.3 + 0.8 * d]);
        let exact = solve(Some(Route::ClosedForm), 1e-5, &big, at, &small, there).unwrap();
        let curve = solve(Some(Route::Curve), 1e-5, &big, at, &small, there).unwrap();
        assert_alike(&curve, &exact, if d > 1.699 { 1e-8 } else { 1e-12 });
        let columns = solve(Some(Route::Columns), 1e-5, &big, at, &small, there).unwrap();
        assert_alike(&columns, &exact, 1e-5);
    }
}

#[test]
fn one_within_the_other() {
    let (long, small) = (ellipsoid([0.3, 1.0, 3.0]), ellipsoid([0.1, 0.05, 0.02]));
    let tube = Cylinder::new(1.0, 3.0).unwrap();
    let pill = Capsule::new(0.1, 0.3).unwrap();
    let inside = pose([0.05, 0.1, -0.4], [0.4, 0.2, 0.9]);
    let outer: [&dyn Shape; 2] = [&long, &tube];
    let inner: [&dyn Shape; 2] = [&small, &pill];
    for (a, b) in outer.into_iter().flat_map(|a| inner.map(|b| (a, b))) {
        for o in [
            solve(None, 1e-5, a, Pose::at([0.0; 3]), b, inside).unwrap(),
            solve(None, 1e-5, b, inside, a, Pose::at([0.0; 3])).unwrap(),
        ] {
            assert_eq!(o.volume, b.inertia(1.0).volume);
            assert_eq!((o.centroid, o.area(), o.moment), (inside.position, 0.0, Vector::zeros()));
        }
    }
    // The same body twice.
    let o = solve(None, 1e-5, &long, inside, &long, inside).unwrap();
    assert_relative_eq!(o.volume, long.inertia(1.0).volume, max_relative = 1e-9);
    // From within, touching.
    let o = solve(
        None,
        1e-5,
        &Sphere::new(1.0).unwrap(),
        Pose::at([0.0; 3]),
        &ellipsoid([0.2, 0.2, 0.4]),
        Pose::at([0.0, 0.0, 0.6]),
    )
    .unwrap();
    assert_relative_eq!(o.volume, ellipsoid([0.2, 0.2, 0.4]).inertia(1.0).volume, max_relative = 1e-9);
}

#[test]
fn sunk_in_a_wall_and_above_it() {
    let shapes: [&dyn Shape; 3] =
        [&ellipsoid([0.3, 0.2, 0.6]), &Cylinder::new(0.3, 0.8).unwrap(), &Capsule::new(0.2, 0.5).unwrap()];
    for shape in shapes {
        let o =
            solve(None, 1e-5, shape, pose([0.1, 0.2, -0.7], [0.3, 0.1, 0.2]), &wall(), Pose::at([0.0; 3]))
                .unwrap();
        assert_eq!((o.volume, o.area()), (shape.inertia(1.0).volume, 0.0));
        assert!(
            solve(None, 1e-5, shape, pose([0.0, 0.0, 0.7], [0.3, 0.1, 0.2]), &wall(), Pose::at([0.0; 3]))
                .is_none()
        );
        let swapped =
            solve(None, 1e-5, &wall(), Pose::at([0.0; 3]), shape, pose([0.0, 0.0, 0.1], [0.3, 0.1, 0.2]))
                .unwrap();
        let plain =
            solve(None, 1e-5, shape, pose([0.0, 0.0, 0.1], [0.3, 0.1, 0.2]), &wall(), Pose::at([0.0; 3]))
                .unwrap();
        assert_eq!(swapped.swapped(), plain);
    }
}

/// A shape of a user's own: |x/a|⁴ + |y/b|⁴ + |z/c|⁴ ≤ 1 is no quadric.
struct Pillow(Vector);
impl Solid for Pillow {
    fn signed_distance(&self, x: Point, _band: f64) -> f64 {
        self.level(x).0 * self.0.min()
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), self.0)
    }
}
impl Shape for Pillow {
    fn name(&self) -> &'static str {
        "pillow"
    }
    /// Volume 8abc Γ(5/4)³/Γ(7/4).
    fn inertia(&self, density: f64) -> Inertia {
        let volume = 8.0 * self.0.product() * 0.906_402_477_055_477_f64.powi(3) / 0.919_062_526_848_883;
        Inertia { mass: density * volume, volume, tensor: nalgebra::Matrix3::identity() }
    }
    fn bounding_radius(&self) -> f64 {
        self.0.norm()
    }
    fn form(&self) -> Form<'_> {
        Form::Smooth(self)
    }
}
impl SmoothConvex for Pillow {
    fn level(&self, x: Point) -> (f64, Vector) {
        let z = x.coords.component_div(&self.0);
        (z.map(|z| z.powi(4)).sum() - 1.0, z.map(|z| 4.0 * z.powi(3)).component_div(&self.0))
    }
    fn chord(&self, o: Point, u: Vector) -> Option<[f64; 2]> {
        let f = |t: f64| {
            let (f, g) = self.level(o + u * t);
            (f, g.dot(&u))
        };
        // Newton's method from outside on either side of the lowest place.
        let reach = 4.0 * (self.0.norm() + o.coords.norm()) / u.norm();
        let ends = [-reach, reach].map(|mut t| {
            for _ in 0..80 {
                let (value, slope) = f(t);
                t -= value / slope;
            }
            t
        });
        (f(0.5 * (ends[0] + ends[1])).0 < 0.0).then_some(ends)
    }
    fn support(&self, n: Vector) -> Point {
        // x = a (a n)^(1/3) over a norm.
        let scaled = self.0.component_mul(&n).map(f64::cbrt);
        let norm = scaled.map(|s| s.powi(4)).sum().powf(0.25);
        Point::from(self.0.component_mul(&scaled) / norm)
    }
}

#[test]
fn a_shape_of_the_users_own() {
    let pillow = Pillow(Vector::new(1.0, 0.8, 0.5));
    let ball = Sphere::new(0.6).unwrap();
    let volume = |z: f64| {
        solve(None, 1e-7, &pillow, pose([0.0; 3], [0.0; 3]), &ball, Pose::at([0.1, 0.2, z]))
            .map_or(0.0, |o| o.volume)
    };
    let (coarse, h) =
        (solve(None, 1e-5, &pillow, Pose::at([0.0; 3]), &ball, Pose::at([0.1, 0.2, 0.8])).unwrap(), 1e-4);
    assert_relative_eq!(coarse.volume, volume(0.8), max_relative = 1e-5);
    // The second body moves.
    assert_relative_eq!(
        coarse.gradient.z,
        -(volume(0.8 + h) - volume(0.8 - h)) / (2.0 * h),
        max_relative = 1e-4
    );
    // A wall through the middle halves it.
    let o = solve(None, 1e-5, &pillow, Pose::at([0.0; 3]), &wall(), Pose::at([0.0; 3])).unwrap();
    assert_relative_eq!(o.volume, 0.5 * pillow.inertia(1.0).volume, max_relative = 1e-5);
}

fn direction() -> impl Strategy<Value = Vector> {
    prop::array::uniform3(-1.0..1.0f64)
        .prop_filter_map("no direction", |v| Vector::from(v).try_normalize(0.1))
}
fn shape(kind: usize, sizes: [f64; 3]) -> Box<dyn Shape> {
    match kind {
        0 => Box::new(ellipsoid(sizes)),
        1 => Box::new(Sphere::new(sizes[0]).unwrap()),
        2 => Box::new(Capsule::new(sizes[0], sizes[1]).unwrap()),
        _ => Box::new(Cylinder::new(sizes[0], sizes[1]).unwrap()),
    }
}
/// Two shapes of the first `kinds`, their centres nearer than where they touch by a factor, at least `nearest`.
fn pairs(kinds: usize, nearest: f64) -> impl Strategy<Value = (Box<dyn Shape>, Pose, Box<dyn Shape>, Pose)> {
    let sizes = || prop::array::uniform3(0.2..1.0f64);
    let turn = || prop::array::uniform3(-2.0..2.0f64);
    ((0..kinds, sizes(), turn()), (0..kinds, sizes(), turn()), direction(), nearest..0.95f64).prop_map(
        |((kind_a, size_a, turn_a), (kind_b, size_b, turn_b), u, share)| {
            let (a, b) = (shape(kind_a, size_a), shape(kind_b, size_b));
            let at_a = pose([0.1, -0.3, 0.2], turn_a);
            let orientation = Rotation::from_scaled_axis(turn_b.into());
            let at = |d: f64| Pose { position: at_a.position + u * d, orientation };
            let (mut near, mut far) = (0.0, a.bounding_radius() + b.bounding_radius());
            for _ in 0..50 {
                let middle = 0.5 * (near + far);
                let apart = solve(None, 1e-3, &*a, at_a, &*b, at(middle)).is_none();
                if apart { far = middle } else { near = middle }
            }
            (a, at_a, b, at(near * share))
        },
    )
}
impl std::fmt::Debug for dyn Shape {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {:?}", self.name(), self.aabb())
    }
}

/// Fourth-order difference.
fn slope(f: impl Fn(f64) -> f64, h: f64) -> f64 {
    (8.0 * (f(h) - f(-h)) - f(2.0 * h) + f(-2.0 * h)) / (12.0 * h)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    /// Two routes that share nothing but the ellipsoid's level function.
    #[test]
    fn curve_and_columns_agree((a, at_a, b, at_b) in pairs(2, 0.6)) {
        let one = solve(Some(Route::Curve), 1e-5, &*a, at_a, &*b, at_b);
        let two = solve(Some(Route::Columns), 1e-5, &*a, at_a, &*b, at_b);
        if let (Some(one), Some(two)) = (one, two) {
            assert_alike(&one, &two, 2e-3);
            assert_relative_eq!(one.volume, two.volume, max_relative = 1e-4);
        } else {
            prop_assert!(one.is_none() && two.is_none());
        }
    }

    /// The error is about what was asked for.
    #[test]
    fn tolerance_is_kept((a, at_a, b, at_b) in pairs(2, 0.3)) {
        let fine = solve(Some(Route::Curve), 1e-10, &*a, at_a, &*b, at_b).unwrap();
        let plain = solve(Some(Route::Curve), 1e-5, &*a, at_a, &*b, at_b).unwrap();
        // Deep tangles go by rays, where about one in a thousand misses 1e-5.
        assert_relative_eq!(plain.volume, fine.volume, max_relative = 1e-4);
    }

    /// S and the moment are derivatives of the volume.
    #[test]
    fn gradient_and_moment_by_differences((a, at_a, b, at_b) in pairs(2, 0.5), v in direction(), axis in direction()) {
        let o = solve(Some(Route::Curve), 1e-9, &*a, at_a, &*b, at_b).unwrap();
        let h = 1e-3 * o.volume.cbrt();
        prop_assume!(o.area() > 1e-3 * o.volume.cbrt().powi(2));
        let volume = |at_a: Pose| solve(Some(Route::Curve), 1e-10, &*a, at_a, &*b, at_b).map_or(0.0, |o| o.volume);
        let moved = slope(|t| volume(Pose { position: at_a.position + v * t, ..at_a }), h);
        prop_assert!((moved - o.gradient.dot(&v)).abs() < 1e-4 * (o.area() + h), "{} {}", moved, o.gradient.dot(&v));
        let turned = slope(|t| {
            let turn = Rotation::from_scaled_axis(axis * t);
            volume(Pose {
                position: o.centroid + turn * (at_a.position - o.centroid),
                orientation: turn * at_a.orientation,
            })
        }, 1e-3);
        prop_assert!((turned - o.moment.dot(&axis)).abs() < 1e-4 * (o.area() * o.area().sqrt() + o.volume), "{} {}", turned, o.moment.dot(&axis));
    }

    #[test]
    fn the_same_for_both_moved_and_scaled((a, at_a, b, at_b) in pairs(4, 0.6), turn in prop::array::uniform3(-2.0..2.0f64)) {
        let one = solve(None, 1e-5, &*a, at_a, &*b, at_b).unwrap();
        let two = solve(None, 1e-5, &*b, at_b, &*a, at_a).unwrap();
        assert_alike(&one, &two.swapped(), 3e-3);
        // Edges and seams cost accuracy.
        let tight = if a.name() == "capsule" || b.name() == "capsule" || a.name() == "cylinder" || b.name() == "cylinder" { 5e-4 } else { 1e-4 };
        assert_relative_eq!(one.volume, two.volume, max_relative = tight);
        let turn = Rotation::from_scaled_axis(turn.into());
        let moved = |at: Pose| Pose { position: turn * at.position + Vector::new(3.0, -20.0, 7.0), orientation: turn * at.orientation };
        let three = solve(None, 1e-5, &*a, moved(at_a), &*b, moved(at_b)).unwrap();
        assert_relative_eq!(one.volume, three.volume, max_relative = tight);
        let smaller = a.inertia(1.0).volume.min(b.inertia(1.0).volume);
        prop_assert!(one.volume <= smaller * (1.0 + 1e-5));
    }

    /// V(s x) = s³ V.
    #[test]
    fn scales(kinds in prop::array::uniform2(0..4usize), sizes in prop::array::uniform2(prop::array::uniform3(0.2..1.0f64)),
              turns in prop::array::uniform2(prop::array::uniform3(-2.0..2.0f64)), u in direction(), exponent in -30..20i32) {
        let s = 2f64.powi(exponent); // 1e-9 … 1e6; powers of two commit no rounding.
        let at = |s: f64| {
            let (a, b) = (shape(kinds[0], sizes[0].map(|l| s * l)), shape(kinds[1], sizes[1].map(|l| s * l)));
            solve(None, 1e-5, &*a, pose([0.0; 3], turns[0]), &*b, pose((u * (0.5 * s)).into(), turns[1]))
        };
        match (at(1.0), at(s)) {
            (Some(one), Some(other)) => {
                assert_relative_eq!(other.volume, s.powi(3) * one.volume, max_relative = 1e-9);
                assert_relative_eq!(other.area(), s * s * one.area(), max_relative = 1e-9, epsilon = 1e-9 * s * s);
            }
            (one, other) => prop_assert!(one.is_none() && other.is_none()),
        }
    }

    /// Brunn and Minkowski: V^⅓ is concave along any translation of a convex pair.
    #[test]
    fn concave((a, at_a, b, at_b) in pairs(2, 0.02), v in direction(), t in 0.01..0.2f64) {
        let root = |t: f64| {
            let at_a = Pose { position: at_a.position + v * t, ..at_a };
            solve(None, 1e-6, &*a, at_a, &*b, at_b).map(|o| o.volume.cbrt())
        };
        if let (Some(before), Some(now), Some(after)) = (root(-t), root(0.0), root(t)) {
            prop_assert!(now >= 0.5 * (before + after) - 1e-5);
        }
    }

    /// A body much larger than the other is a wall to it.
    #[test]
    fn sizes_mixed(e in prop::array::uniform3(0.2..1.0f64), turn in prop::array::uniform3(-2.0..2.0f64), share in -0.9..0.95f64) {
        let (small, huge) = (ellipsoid(e), ellipsoid([1e6, 1e6, 1e6]));
        let at = pose([0.0; 3], turn);
        let reach = small.support(at.orientation.inverse() * Vector::z()).coords.norm().min(small.semi_axes().min());
        let top = Pose::at([0.0, 0.0, share * reach - 1e6]);
        let o = solve(Some(Route::Curve), 1e-7, &small, at, &huge, top).unwrap();
        let plane = HalfSpace::new(Point::new(0.0, 0.0, share * reach), Vector::z()).unwrap();
        let w = solve(None, 1e-5, &small, at, &plane, Pose::at([0.0; 3])).unwrap();
        assert_alike(&o, &w, 1e-4);
    }

    /// A wall's both sides make the whole, and slices have the slope that the area says; columns find the same.
    #[test]
    fn at_walls(kind in 0..3usize, e in prop::array::uniform3(0.2..1.0f64), turn in prop::array::uniform3(-2.0..2.0f64), z in -0.9..0.9f64, axis in direction()) {
        let a = shape([0, 3, 2][kind], e);
        let up = HalfSpace::new(Point::origin(), -Vector::z()).unwrap();
        let at = pose([0.3, 0.1, z * a.bounding_radius()], turn);
        let volume = |wall: &HalfSpace, at: Pose| solve(None, 1e-5, &*a, at, wall, Pose::at([0.0; 3])).map_or(0.0, |o| o.volume);
        let whole = a.inertia(1.0).volume;
        let tight = if kind == 2 { 2e-5 } else { 1e-12 };
        prop_assert!((volume(&wall(), at) + volume(&up, at) - whole).abs() < tight * whole);
        if let Some(o) = solve(None, 1e-5, &*a, at, &wall(), Pose::at([0.0; 3])) && kind < 2 && o.area() > 0.0 {
            // Shallower than the contact is deep (2V/A for a cap): beyond its edge the volume has no slope.
            let h = (0.2 * o.volume / o.area()).min(1e-4);
            let falls = slope(|t| volume(&wall(), Pose { position: at.position + Vector::z() * t, ..at }), h);
            prop_assert!((falls - o.gradient.z).abs() < 1e-3 * o.area() + 1e-6, "{} {}", falls, o.gradient.z);
            let turned = slope(|t| {
                let turn = Rotation::from_scaled_axis(axis * t);
                volume(&wall(), Pose { position: o.centroid + turn * (at.position - o.centroid), orientation: turn * at.orientation })
            }, h);
            prop_assert!((turned - o.moment.dot(&axis)).abs() < 1e-4, "{} {}", turned, o.moment.dot(&axis));
            if kind == 0 {
                let columns = solve(Some(Route::Columns), 1e-5, &*a, at, &wall(), Pose::at([0.0; 3])).unwrap();
                assert_alike(&columns, &o, 5e-3);
            }
        }
    }
}
