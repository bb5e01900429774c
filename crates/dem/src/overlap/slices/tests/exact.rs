//! What is known exactly.
use super::*;
use crate::{Form, HalfSpace};
use approx::assert_relative_eq;
use interfaces::{Point, Vector};
use std::f64::consts::PI;

/// ∫f over an interval by Gauss-Legendre points in sin φ on many pieces.
fn integral(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let pieces = 4000;
    let (middle, half, step) = (0.5 * (from + to), 0.5 * (to - from), PI / pieces as f64);
    let gauss = [(-0.6_f64.sqrt(), 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.6_f64.sqrt(), 5.0 / 18.0)];
    let at = |phi: f64| f(middle + half * phi.sin()) * half * phi.cos();
    let piece = |i: i32| {
        let centre = (f64::from(i) + 0.5) * step - 0.5 * PI;
        gauss.iter().map(|(x, w)| w * step * at(centre + 0.5 * step * x)).sum::<f64>()
    };
    (0..pieces).map(piece).sum()
}
/// What two discs share whose centres are `d` apart.
fn lens(r: f64, s: f64, d: f64) -> f64 {
    if d >= r + s {
        return 0.0;
    }
    if d <= (r - s).abs() {
        return PI * r.min(s).powi(2);
    }
    let part = |r: f64, s: f64| {
        let cos = ((d * d + r * r - s * s) / (2.0 * d * r)).clamp(-1.0, 1.0);
        r * r * (cos.acos() - cos * (1.0 - cos * cos).sqrt())
    };
    part(r, s) + part(s, r)
}
/// Radius of a body of revolution at the height z along its axis.
fn radius(shape: &dyn Shape, z: f64) -> f64 {
    match shape.form() {
        Form::Cylinder(c) if 2.0 * z.abs() <= c.length() => c.radius(),
        Form::Capsule(c) => {
            let beyond = (z.abs() - 0.5 * c.length()).max(0.0);
            (c.radius().powi(2) - beyond * beyond).max(0.0).sqrt()
        }
        _ => 0.0,
    }
}

#[test]
fn cylinders_through_one_another() {
    let tube = cylinder(0.3, 4.0);
    for angle in [0.5 * PI, 1.0, 0.4] {
        let o = slices(1e-11, &tube, here(), &tube, pose([0.0; 3], [angle, 0.0, 0.0])).unwrap();
        assert_relative_eq!(o.volume, 16.0 / 3.0 * 0.027 / angle.sin(), max_relative = 1e-11);
        assert!(o.centroid.coords.norm() < 1e-9 && o.area() < 1e-9, "{o:?}");
        // Of the angle between the axes.
        let moment = 16.0 / 3.0 * 0.027 * angle.cos() / angle.sin().powi(2);
        assert_relative_eq!(o.moment, Vector::x() * moment, epsilon = 1e-9);
    }
    // Shallow: in the slices 4 w₁ w₂, and both are parabolas where they touch.
    for depth in [1e-6, 1e-8] {
        let at = pose([0.6 - depth, 0.0, 0.0], [0.5 * PI, 0.0, 0.0]);
        let o = slices(1e-9, &tube, here(), &tube, at).unwrap();
        assert_relative_eq!(
            o.volume,
            PI * 0.3 * depth * depth,
            max_relative = 1e-9 + 3.0 * depth + 1e-15 / depth
        );
        assert_relative_eq!(o.normal, -Vector::x(), epsilon = 1e-6);
        assert_relative_eq!(o.gradient.x, 2.0 * PI * 0.3 * depth, max_relative = 1e-4);
    }
}

#[test]
fn parallel_cylinders() {
    let (long, short) = (cylinder(0.5, 2.0), cylinder(0.3, 1.0));
    for d in [0.79, 0.7, 0.5, 0.3, 0.21, 0.1, 0.0] {
        for (up, common) in [(0.0, 1.0), (0.5, 1.0), (0.9, 0.6), (1.4999, 1e-4)] {
            for turn in [0.0, 1e-16, 1e-12] {
                let at = pose([0.6 * d, 0.8 * d, up], [turn, 0.0, 0.3]);
                let o = slices(1e-11, &long, here(), &short, at).unwrap();
                let exact = common * lens(0.5, 0.3, d);
                assert_relative_eq!(o.volume, exact, max_relative = 1e-7, epsilon = 1e-13);
            }
        }
    }
}

#[test]
fn parallel_capsules() {
    let (long, short) = (capsule(0.5, 1.4), capsule(0.35, 0.6));
    for x in [0.8, 0.5, 0.2, 0.05, 0.0] {
        for z in [0.0, 0.2, 0.4, 0.9, 1.3] {
            for turn in [0.0, 1e-12, 1e-5] {
                let at = pose([0.6 * x, 0.8 * x, z], [turn, 0.0, 0.4]);
                let o = slices(1e-9, &long, here(), &short, at).map_or(0.0, |o| o.volume);
                let mut ends = [-1.2, -0.7, 0.7, 1.2, z - 0.65, z - 0.3, z + 0.3, z + 0.65];
                ends.sort_by(f64::total_cmp);
                let slice = |h: f64| lens(radius(&long, h), radius(&short, h - z), x);
                let exact: f64 = ends.windows(2).map(|w| integral(w[0], w[1], slice)).sum();
                let bound = 1e-7 + 2.0 * turn;
                assert!((o - exact).abs() < bound * short.inertia(1.0).volume, "{x} {z} {turn}: {o} {exact}");
            }
        }
    }
}

#[test]
fn spheres_in_bodies_of_revolution() {
    let shapes: [&dyn Shape; 2] = [&cylinder(0.5, 1.2), &capsule(0.4, 0.8)];
    for shape in shapes {
        for (r, x, z) in [
            (0.6, 0.3, 0.2),
            (0.6, 0.9, 0.1),
            (0.2, 0.55, 0.5),
            (0.9, 0.1, 0.9),
            (0.5, 0.5, 0.6),
            (0.3, 0.0, 0.8),
        ] {
            let o = slices(1e-12, &sphere(r), Pose::at([x, 0.0, z]), shape, here()).unwrap();
            // At breaks of the radius as well.
            let mut ends = [-0.8, -0.6, -0.4, 0.4, 0.6, 0.8, z - r, z + r];
            ends.sort_by(f64::total_cmp);
            let slice = |h: f64| lens((r * r - (h - z).powi(2)).max(0.0).sqrt(), radius(shape, h), x);
            let exact: f64 = ends.windows(2).map(|w| integral(w[0], w[1], slice)).sum();
            assert_relative_eq!(o.volume, exact, max_relative = 1e-8);
        }
    }
}

#[test]
fn walls() {
    let (tube, pill) = (cylinder(0.3, 0.8), capsule(0.2, 0.5));
    let wall = HalfSpace::new(Point::new(0.1, 0.2, 0.05), Vector::new(0.2, -0.3, 1.0)).unwrap();
    for z in [-0.3, -0.1, 0.0, 0.1, 0.25] {
        for turn in [[0.4, -0.2, 0.9], [1.5, 0.2, 0.1], [0.0; 3]] {
            let at = pose([0.05, 0.1, z], turn);
            // A cylinder has a formula.
            let exact = OverlapSolver::new().solve(&tube, &at, &wall, &here()).unwrap()[0];
            let o = slices(1e-12, &tube, at, &wall, here()).unwrap();
            assert_relative_eq!(o.volume, exact.volume, max_relative = 1e-10);
            assert_relative_eq!(o.centroid, exact.centroid, epsilon = 1e-10);
            assert_relative_eq!(o.gradient, exact.gradient, epsilon = 1e-9);
            assert_relative_eq!(o.moment, exact.moment, epsilon = 1e-9);
            // A capsule: discs across its axis, cut by the wall at a distance that is linear along it.
            let axis = at.orientation * Vector::z();
            let (cos, distance) = (axis.dot(&wall.normal()), wall.signed_distance(at.position));
            let sin = (1.0 - cos * cos).sqrt();
            let slice = |h: f64| {
                let (r, d) = (radius(&pill, h), distance + h * cos);
                if sin < 1e-12 {
                    return if d < 0.0 { PI * r * r } else { 0.0 };
                }
                let x = (d / (sin * r)).clamp(-1.0, 1.0);
                r * r * (x.acos() - x * (1.0 - x * x).sqrt())
            };
            let exact: f64 = if sin > 0.01 {
                [-0.45, -0.25, 0.25, 0.45].windows(2).map(|w| integral(w[0], w[1], slice)).sum()
            } else {
                continue;
            };
            let o = slices(1e-12, &pill, at, &wall, here());
            assert!((o.map_or(0.0, |o| o.volume) - exact).abs() < 2e-9 * pill.inertia(1.0).volume);
        }
    }
}

/// Prisms with ever more sides, whose overlaps are exact, and what they lead to.
#[test]
fn polyhedra_like_cylinders() {
    let other = cuboid([0.7, 0.9, 1.1]);
    let (r, l) = (0.4, 1.3);
    let (tube, thin) = (cylinder(r, l), cylinder(0.3, 1.0));
    for (x, turn) in [
        ([0.3, 0.2, 0.4], [0.3, 0.8, 0.2]),
        ([0.5, -0.3, 0.1], [1.0, -0.4, 0.7]),
        ([0.1, 0.0, 0.9], [0.2, 0.1, 0.4]),
        ([0.05, 0.1, 0.0], [0.5 * PI, 0.0, 0.0]),
    ] {
        let at = pose(x, turn);
        let clipped = |n: usize| {
            let patches = crate::overlap(&prism(n, r, l), &at, &other, &here()).unwrap();
            (patches[0].volume, patches[0].gradient)
        };
        let (coarse, fine) = (clipped(200), clipped(400));
        let o = slices(1e-10, &tube, at, &other, here()).unwrap();
        assert_relative_eq!(o.volume, (4.0 * fine.0 - coarse.0) / 3.0, max_relative = 1e-5);
        assert_relative_eq!(o.gradient, fine.1, epsilon = 2e-3);
        let crossed =
            |n: usize| crate::overlap(&prism(n, r, l), &at, &prism(n, 0.3, 1.0), &here()).unwrap()[0].volume;
        let o = slices(1e-10, &tube, at, &thin, here()).unwrap();
        assert_relative_eq!(o.volume, (4.0 * crossed(200) - crossed(100)) / 3.0, max_relative = 5e-5);
    }
}

/// A capsule of hardly any length is a sphere, whose overlap with flat faces is known.
#[test]
fn short_capsules() {
    let (ball, pill) = (sphere(0.5), capsule(0.5, 1e-12));
    let body = ConvexPolyhedron::from_points(&[
        [0.0, 0.0, 0.0],
        [1.0, 0.1, 0.0],
        [0.2, 0.9, 0.1],
        [0.1, 0.2, 1.1],
        [0.8, 0.7, 0.9],
    ])
    .unwrap();
    for x in [[0.5, 0.1, 0.2], [0.1, 0.2, 0.1], [-0.3, 0.2, 0.3], [0.2, -0.4, 0.6], [0.0; 3]] {
        let at = pose(x, [0.3, 0.5, 0.1]);
        let exact = crate::overlap(&ball, &at, &body, &here()).unwrap()[0];
        let o = slices(1e-11, &pill, at, &body, here()).unwrap();
        assert_relative_eq!(o.volume, exact.volume, max_relative = 1e-9);
        assert_relative_eq!(o.centroid, exact.centroid, epsilon = 1e-9);
        assert_relative_eq!(o.gradient, exact.gradient, epsilon = 1e-7);
        assert_relative_eq!(o.moment, exact.moment, epsilon = 1e-7);
    }
}

#[test]
fn touching_aligned_and_the_same() {
    let (tube, pill, cube) = (cylinder(0.5, 2.0), capsule(0.5, 2.0), cuboid([1.0, 1.0, 2.0]));
    let turned = pose([0.2, 0.1, -0.3], [0.3, 0.8, -0.4]);
    for (body, whole) in [(&tube as &dyn Shape, 0.5 * PI), (&pill, 0.5 * PI + PI / 6.0)] {
        for at in [here(), turned] {
            let o = slices(1e-9, body, at, body, at).unwrap();
            assert_relative_eq!(o.volume, whole, max_relative = 1e-9);
            assert_relative_eq!(o.centroid, at.position, epsilon = 1e-9);
            // Turned about its own axis.
            let again = Pose { orientation: at.orientation * Rotation::from_scaled_axis(Vector::z()), ..at };
            assert_relative_eq!(volume(body, at, body, again), whole, max_relative = 1e-9);
        }
    }
    // End on end, side on side, end on a face; half of each other.
    assert!(slices(1e-9, &tube, here(), &tube, Pose::at([0.0, 0.0, 2.0])).is_none());
    assert!(slices(1e-9, &tube, here(), &tube, Pose::at([1.0, 0.0, 0.0])).is_none());
    assert_relative_eq!(
        volume(&tube, here(), &tube, Pose::at([0.0, 0.0, 1.0])),
        0.25 * PI,
        max_relative = 1e-10
    );
    // A cylinder in the box around it, flush on all sides, and stacked on it.
    assert_relative_eq!(volume(&tube, here(), &cube, here()), 0.5 * PI, max_relative = 1e-10);
    assert_relative_eq!(
        volume(&tube, here(), &cube, Pose::at([0.0, 0.0, 1.5])),
        0.125 * PI,
        max_relative = 1e-10
    );
    assert_relative_eq!(
        volume(&tube, here(), &cube, Pose::at([0.5, 0.0, 0.0])),
        0.25 * PI,
        max_relative = 1e-10
    );
    for depth in [1e-3, 1e-6, 1e-9] {
        let o = slices(1e-9, &tube, here(), &cube, Pose::at([0.0, 0.0, 2.0 - depth])).unwrap();
        assert_relative_eq!(o.volume, 0.25 * PI * depth, max_relative = 1e-8 + 1e-15 / depth);
        assert_relative_eq!(o.gradient, Vector::z() * (0.25 * PI), epsilon = 1e-8);
        let o = slices(1e-9, &tube, here(), &cube, pose([0.0, 1.0 - depth, 0.0], [0.0; 3])).unwrap();
        let half = (2.0 * 0.5 * depth - depth * depth).sqrt();
        assert_relative_eq!(o.gradient.y, 4.0 * half, max_relative = 1e-6 + 1e-15 / depth);
    }
}

/// All of one within the other, with nothing sticking out.
#[test]
fn one_within_the_other() {
    let (tube, pill) = (cylinder(1.0, 3.0), capsule(1.0, 2.0));
    let inner: [&dyn Shape; 4] =
        [&sphere(0.4), &capsule(0.2, 0.6), &cylinder(0.2, 0.6), &cuboid([0.3, 0.4, 0.5])];
    let at = pose([0.1, 0.3, 0.6], [0.3, 0.5, 0.2]);
    for outer in [&tube as &dyn Shape, &pill] {
        for body in inner {
            let o = slices(1e-5, body, at, outer, here()).unwrap();
            assert_relative_eq!(o.volume, body.inertia(1.0).volume, max_relative = 1e-15);
            assert_relative_eq!(o.centroid, at.position, epsilon = 1e-15);
            assert_eq!((o.gradient, o.moment), (Vector::zeros(), Vector::zeros()));
        }
    }
}

/// Very long and very flat ones, far from the origin, of very different sizes.
#[test]
fn extreme_sizes() {
    let (needle, coin) = (cylinder(1e-3, 10.0), cylinder(1.0, 1e-3));
    let o = slices(1e-9, &needle, here(), &coin, pose([0.3, 0.2, 0.5], [0.3, 0.4, 0.0])).unwrap();
    let axis = Rotation::from_scaled_axis(Vector::new(0.3, 0.4, 0.0)) * Vector::z();
    assert_relative_eq!(o.volume, PI * 1e-9 / axis.z.abs(), max_relative = 1e-9);
    let far = Vector::new(1e3, -2e3, 5e2);
    let at = pose([0.3, 0.2, 0.5], [0.3, 0.4, 0.0]);
    let moved =
        slices(1e-9, &needle, Pose::at(far.into()), &coin, Pose { position: at.position + far, ..at });
    assert_relative_eq!(moved.unwrap().volume, o.volume, max_relative = 1e-8);
    // A huge capsule is a wall.
    let (huge, tube) = (capsule(1e5, 1e5), cylinder(0.3, 0.8));
    let lying = pose([0.0, 0.0, 0.1], [0.2, 1.0, 0.3]);
    let o = slices(1e-9, &tube, lying, &huge, pose([0.0, 0.0, -1e5], [0.5 * PI, 0.0, 0.0])).unwrap();
    let wall = HalfSpace::new(Point::origin(), Vector::z()).unwrap();
    let w = OverlapSolver::new().solve(&tube, &lying, &wall, &here()).unwrap()[0];
    assert_relative_eq!(o.volume, w.volume, max_relative = 1e-5);
    assert_relative_eq!(o.gradient, w.gradient, epsilon = 1e-5);
}

/// Four breaks at once, one of them between the middle of all heights and the place of a rule next to it.
#[test]
fn breaks_next_to_halves() {
    let at = |x: [f64; 3], [x1, x2, x3, w]: [f64; 4]| Pose {
        position: x.into(),
        orientation: Rotation::from_quaternion(nalgebra::Quaternion::new(w, x1, x2, x3)),
    };
    let (tube, cube) = (
        cylinder(0.7636823968362124, 0.7723586951482968),
        cuboid([0.7978979130978494, 0.9441861904683268, 0.5731067780536946]),
    );
    let at_tube = at(
        [0.1, -0.3, 0.2],
        [0.19591941012286157, -0.38574108210892516, 0.5870542021618977, 0.6842417453171088],
    );
    let at_cube = at(
        [0.47537594715642983, 0.09516574080743073, -0.10951086586493564],
        [-0.3203508459558952, 0.7330353156449861, 0.47693846487014774, 0.36409375473894745],
    );
    let [coarse, fine] = [1e-5, 1e-11].map(|t| slices(t, &tube, at_tube, &cube, at_cube).unwrap().volume);
    assert_relative_eq!(coarse, fine, max_relative = 1e-5);
}
