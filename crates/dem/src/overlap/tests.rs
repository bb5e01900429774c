//! Overlaps against closed forms, series, quadrature and the symmetries they must have.
use super::{Overlap, overlap};
use crate::{DemError, Disc, HalfSpace, Shape, Sphere};
use approx::assert_relative_eq;
use interfaces::{Periods, Point, Pose, Rotation, Vector};
use proptest::prelude::*;
use std::f64::consts::PI;

/// A disc (`dim` 2) or sphere (3) of radius `r`.
fn round(dim: usize, r: f64) -> Box<dyn Shape> {
    if dim == 2 { Box::new(Disc::new(r).unwrap()) } else { Box::new(Sphere::new(r).unwrap()) }
}
/// The one patch, if any, of two shapes that are not turned.
fn patch(a: &dyn Shape, at_a: Point, b: &dyn Shape, at_b: Point) -> Option<Overlap> {
    let patches = overlap(a, &Pose::at(at_a.into()), b, &Pose::at(at_b.into())).unwrap();
    assert!(patches.len() <= 1);
    patches.first().copied()
}
fn at(x: f64) -> Point {
    Point::new(x, 0.0, 0.0)
}
/// Two of them, centres `d` apart along x, the first at the origin.
fn pair(dim: usize, ra: f64, rb: f64, d: f64) -> Option<Overlap> {
    patch(&*round(dim, ra), at(0.0), &*round(dim, rb), at(d))
}
/// One of them, its centre `d` in front of a wall at x = 0 that looks along x.
fn wall(dim: usize, r: f64, d: f64) -> Option<Overlap> {
    patch(&*round(dim, r), at(d), &HalfSpace::new(Point::origin(), Vector::x()).unwrap(), Point::origin())
}

/// (∫dV, ∫x dV) over the part of a disc or sphere of radius `r` at `centre` between `from` and its end at
/// `end` = centre ± r; the quadratic substitution takes the root at the end away.
fn part(dim: usize, r: f64, centre: f64, from: f64, end: f64) -> (f64, f64) {
    let n = 4000;
    (0..n).fold((0.0, 0.0), |(volume, moment), i| {
        let w = (i as f64 + 0.5) / n as f64;
        let x = end + (from - end) * w * w;
        let half = (r * r - (x - centre) * (x - centre)).max(0.0).sqrt();
        let slice = if dim == 2 { 2.0 * half } else { PI * half * half };
        let dv = slice * 2.0 * w * (from - end).abs() / n as f64;
        (volume + dv, moment + x * dv)
    })
}
/// Volume and centroid of what [`pair`] shares.
fn quadrature(dim: usize, ra: f64, rb: f64, d: f64) -> (f64, f64) {
    let plane = (d * d + ra * ra - rb * rb) / (2.0 * d);
    let (a, b) = (part(dim, ra, 0.0, plane, ra), part(dim, rb, d, plane, d - rb));
    (a.0 + b.0, (a.1 + b.1) / (a.0 + b.0))
}

#[test]
fn closed_forms_of_the_reference_page() {
    for (ra, rb, d) in [(1.0, 1.0, 1.9), (1.0, 1.0, 0.3), (1.0, 0.4, 1.2), (0.4, 1.0, 0.7), (2.0, 5.0, 6.9)] {
        let (sum, difference): (f64, f64) = (ra + rb, ra - rb);
        // Spheres: π(R+r−d)²(d²+2d(R+r)−3(R−r)²)/(12d).
        let v = PI * (sum - d).powi(2) * (d * d + 2.0 * d * sum - 3.0 * difference.powi(2)) / (12.0 * d);
        assert_relative_eq!(pair(3, ra, rb, d).unwrap().volume, v, max_relative = 1e-13);
        // Discs: the textbook sum of two sectors less a kite.
        let cos = |r: f64, s: f64| ((d * d + r * r - s * s) / (2.0 * d * r)).acos();
        let kite = (sum - d) * (d + difference) * (d - difference) * (d + sum);
        let area = ra * ra * cos(ra, rb) + rb * rb * cos(rb, ra) - 0.5 * kite.sqrt();
        assert_relative_eq!(pair(2, ra, rb, d).unwrap().volume, area, max_relative = 1e-12);
    }
    for depth in [1e-3, 0.3, 1.0, 1.7] {
        let (s, c) = (wall(2, 1.0, 1.0 - depth).unwrap(), wall(3, 1.0, 1.0 - depth).unwrap());
        let rest = 1.0 - depth;
        let area = rest.acos() - rest * (depth * (2.0 - depth)).sqrt();
        assert_relative_eq!(s.volume, area, max_relative = 1e-11);
        assert_relative_eq!(c.volume, PI * depth * depth * (3.0 - depth) / 3.0, max_relative = 1e-12);
        assert_eq!((s.normal, c.normal), (Vector::x(), Vector::x()));
    }
}

#[test]
fn volume_and_centroid_by_quadrature() {
    for dim in [2, 3] {
        for (ra, rb, d) in
            [(1.0, 1.0, 1.99), (1.0, 1.0, 0.2), (1.0, 0.4, 1.3), (1.0, 0.4, 0.65), (0.5, 2.0, 1.6)]
        {
            let (o, (volume, x)) = (pair(dim, ra, rb, d).unwrap(), quadrature(dim, ra, rb, d));
            assert_relative_eq!(o.volume, volume, max_relative = 1e-7);
            assert_relative_eq!(o.centroid, at(x), epsilon = 1e-7);
        }
        for d in [0.99, 0.4, 0.0, -0.6] {
            let (o, (volume, moment)) = (wall(dim, 1.0, d).unwrap(), part(dim, 1.0, d, 0.0, d - 1.0));
            assert_relative_eq!(o.volume, volume, max_relative = 1e-7);
            assert_relative_eq!(o.centroid, at(moment / volume), epsilon = 1e-7);
        }
    }
}

/// Shallow overlaps keep all digits: the depth is what the numbers of the positions say, the volume follows to
/// round-off down to 1e-12 radii.
#[test]
fn shallow_overlaps_against_the_series() {
    for r in [1e-9, 0.75, 1e6] {
        for share in [1e-12, 1e-9, 1e-6, 1e-3, 1e-1] {
            let d = 2.0 * r - share * r;
            let delta: f64 = r + r - d; // Exact (Sterbenz).
            let (discs, spheres) = (pair(2, r, r, d).unwrap(), pair(3, r, r, d).unwrap());
            let sphere = PI * delta * delta * (6.0 * r - delta) / 12.0;
            // Twice the segment of depth s = δ/2: (4/3)√(2r) s^1.5 (1 − 3s/20r − 3s²/224r² − s³/384r³ …).
            let s = 0.5 * delta / r;
            let series = 1.0 - 3.0 / 20.0 * s - 3.0 / 224.0 * s * s - s.powi(3) / 384.0;
            let disc = 4.0 / 3.0 * r.sqrt() * delta.powf(1.5) * series;
            assert_relative_eq!(spheres.volume, sphere, max_relative = 1e-13);
            // What the series leaves out is about 0.0007 s⁴.
            assert_relative_eq!(discs.volume, disc, max_relative = 1e-13 + 8e-4 * s.powi(4));
            assert_relative_eq!(
                discs.area(),
                2.0 * (delta * (r - 0.25 * delta)).sqrt(),
                max_relative = 1e-13
            );
            assert_relative_eq!(spheres.area(), PI * delta * (r - 0.25 * delta), max_relative = 1e-13);
            for o in [discs, spheres] {
                assert_relative_eq!(o.centroid.x, 0.5 * d, max_relative = 1e-13);
            }
        }
    }
}

#[test]
fn one_inside_the_other() {
    for dim in [2, 3] {
        let small = round(dim, 0.3);
        let whole = small.inertia(1.0).volume;
        for d in [0.0, 0.1, 0.7] {
            for o in [pair(dim, 0.3, 1.0, d), pair(dim, 1.0, 0.3, d)] {
                let o = o.unwrap();
                assert_relative_eq!(o.volume, whole, max_relative = 1e-14);
                assert_eq!(o.area(), 0.0, "the volume no longer changes");
            }
            assert_eq!(pair(dim, 0.3, 1.0, d).unwrap().centroid, at(0.0));
            assert_eq!(pair(dim, 1.0, 0.3, d).unwrap().centroid, at(d));
        }
        let sunk = wall(dim, 0.3, -0.4).unwrap();
        assert_relative_eq!(sunk.volume, whole, max_relative = 1e-14);
        assert_eq!((sunk.area(), sunk.centroid), (0.0, at(-0.4)));
        // On the way in, everything ends where containment begins.
        let nearly = pair(dim, 0.3, 1.0, 0.7 + 1e-12).unwrap();
        assert_relative_eq!(nearly.volume, whole, max_relative = 1e-9);
        assert!(nearly.area() < 1e-5);
    }
}

#[test]
fn apart_is_none_and_mixed_is_an_error() {
    for dim in [2, 3] {
        assert!(pair(dim, 1.0, 0.5, 1.5).is_none() && pair(dim, 1.0, 0.5, 1.6).is_none());
        assert!(wall(dim, 1.0, 1.0).is_none() && wall(dim, 1.0, 1.1).is_none());
    }
    let (disc, sphere) = (round(2, 1.0), round(3, 1.0));
    let mixed = overlap(&*disc, &Pose::at([0.0; 3]), &*sphere, &Pose::at([9.0, 0.0, 0.0]));
    assert_eq!(mixed, Err(DemError::Unsupported { a: "disc", b: "sphere" }));
}

/// Three in a row: the middle one's shares add up, as do the two sides of a wall.
#[test]
fn additive() {
    for dim in [2, 3] {
        let whole = round(dim, 1.0).inertia(1.0).volume;
        for d in [0.9, 0.3, 0.0] {
            let sides = wall(dim, 1.0, d).unwrap().volume + wall(dim, 1.0, -d).unwrap().volume;
            assert_relative_eq!(sides, whole, max_relative = 1e-13);
        }
        // A huge ball is nearly a wall.
        let (huge, wall) = (pair(dim, 1.0, 1e7, 1e7 + 0.6).unwrap(), wall(dim, 1.0, 0.6).unwrap());
        assert_relative_eq!(huge.volume, wall.volume, max_relative = 1e-6);
        assert_relative_eq!(huge.area(), wall.area(), max_relative = 1e-6);
    }
}

/// Where containment begins, round-off must not lead beyond the whole.
fn nearly_contained(small: f64, rest: f64) {
    let big = small + rest;
    for (dim, ulps) in (0..200).map(|i| (2 + i % 2, i / 2)) {
        let d = rest * (1.0 + ulps as f64 * f64::EPSILON) + f64::MIN_POSITIVE;
        let whole = round(dim, small).inertia(1.0).volume;
        for o in [pair(dim, small, big, d).unwrap(), pair(dim, big, small, d).unwrap()] {
            assert_relative_eq!(o.volume, whole, max_relative = 1e-7);
            assert!(o.volume <= whole * (1.0 + 1e-12));
            assert!(0.0 <= o.area() && o.area() < 1e-4 * whole / small);
        }
    }
}

/// Where the larger one's part is a hair thinner than nothing.
#[test]
fn barely_contained_once_failed() {
    nearly_contained(0.9890920930409446, 0.033680898211901476);
}

fn pairs() -> impl Strategy<Value = (usize, f64, f64, f64)> {
    // The distance as a share of what lies between containment and touching.
    (2..=3usize, 0.05..1.0f64, 0.05..1.0f64, 0.0..1.0f64)
        .prop_map(|(dim, ra, rb, share)| (dim, ra, rb, (ra - rb).abs() + share * 2.0 * f64::min(ra, rb)))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn barely_contained(small in 0.01..1.0f64, rest in 0.0..1.0f64) {
        nearly_contained(small, rest);
    }

    #[test]
    fn symmetric((dim, ra, rb, d) in pairs()) {
        let (shape_a, shape_b) = (round(dim, ra), round(dim, rb));
        let (one, two) = (patch(&*shape_a, at(0.0), &*shape_b, at(d)), patch(&*shape_b, at(d), &*shape_a, at(0.0)));
        if let (Some(one), Some(two)) = (one, two) {
            prop_assert!(one.volume.is_finite() && one.area().is_finite() && one.area() >= 0.0);
            assert_relative_eq!(one.volume, two.volume, max_relative = 1e-14);
            assert_relative_eq!(one.area(), two.area(), max_relative = 1e-14);
            assert_relative_eq!(one.centroid, two.centroid, epsilon = 1e-14);
            prop_assert_eq!(one.normal, -two.normal);
            // The first is pushed away from the second.
            assert_relative_eq!(one.normal, -Vector::x(), epsilon = 1e-15);
        }
    }

    /// Turned, moved and by an image: the same overlap.
    #[test]
    fn invariant((dim, ra, rb, d) in pairs(), turn in prop::array::uniform3(-3.0..3.0f64),
                 shift in prop::array::uniform3(-2.0..2.0f64), image in prop::array::uniform3(-3..=3i32)) {
        let turn = Rotation::from_scaled_axis(if dim == 2 {
            Vector::new(0.0, 0.0, turn[2])
        } else {
            turn.into()
        });
        let (a, b) = (Point::from(shift), Point::from(shift) + turn * Vector::new(d, 0.0, 0.0));
        let periods = Periods::new([Some(4.5), Some(5.0), None]);
        let far = b + Vector::new(4.5 * f64::from(image[0]), 5.0 * f64::from(image[1]), 0.0);
        let seen = a + periods.nearest(far - a);
        let o = patch(&*round(dim, ra), a, &*round(dim, rb), seen);
        if let (Some(o), Some(plain)) = (o, pair(dim, ra, rb, d)) && ra + rb - d > 1e-6 {
            // A distance is known to 1e-14; shallow volumes and areas are the more sensitive to it.
            let tolerance = 1e-13 / ((ra + rb - d) / ra.min(rb)).min((d - (ra - rb).abs()) / ra.min(rb) + 1e-9);
            assert_relative_eq!(o.volume, plain.volume, max_relative = tolerance);
            let centroid = a + turn * (plain.centroid - Point::origin());
            assert_relative_eq!(o.centroid, centroid, epsilon = 1e-12 + tolerance);
            assert_relative_eq!(o.normal, turn * plain.normal, epsilon = 1e-10);
        }
    }

    /// V(s x) = s^D V, area s^(D−1), centroid s.
    #[test]
    fn scales((dim, ra, rb, d) in pairs(), exponent in -30..20i32) {
        let s = 2.0f64.powi(exponent); // 1e-9 … 1e6; powers of two commit no rounding.
        if let Some(o) = pair(dim, ra, rb, d) {
            let big = pair(dim, s * ra, s * rb, s * d).unwrap();
            assert_relative_eq!(big.volume, s.powi(dim as i32) * o.volume, max_relative = 1e-13);
            assert_relative_eq!(big.area(), s.powi(dim as i32 - 1) * o.area(), max_relative = 1e-13);
            assert_relative_eq!(big.centroid.x, s * o.centroid.x, max_relative = 1e-12, epsilon = s * 1e-14);
        }
    }

    /// Nearer means more: V falls with the distance and its slope is the area; `rate` is dV/dt.
    #[test]
    fn area_is_the_gradient((dim, ra, rb, d) in pairs(), u in -1.0..1.0f64) {
        let r = ra.min(rb);
        // Away from both ends, where the slope has kinks of its own.
        let h = 1e-4 * r;
        prop_assume!(d - (ra - rb).abs() > 1e-2 * r && ra + rb - d > 1e-2 * r);
        let volume = |d| pair(dim, ra, rb, d).unwrap().volume;
        let o = pair(dim, ra, rb, d).unwrap();
        prop_assert!(volume(d + h) < o.volume && o.volume < volume(d - h));
        // Fourth-order differences.
        let slope = (8.0 * (volume(d + h) - volume(d - h)) - volume(d + 2.0 * h) + volume(d - 2.0 * h)) / (12.0 * h);
        assert_relative_eq!(-slope, o.area(), max_relative = 1e-6);
        // The first moves at u along x, so the distance falls at u; across nothing changes at first.
        let rate = o.rate(Vector::new(u, 0.7, 0.0), Vector::new(3.0, 2.0, 1.0));
        assert_relative_eq!(rate, -u * slope, max_relative = 1e-6, epsilon = 1e-9 * o.area());
    }

    #[test]
    fn area_is_the_gradient_at_a_wall(dim in 2..=3usize, d in -0.98..0.98f64) {
        let h = 1e-4;
        let volume = |d| wall(dim, 1.0, d).unwrap().volume;
        let slope = (8.0 * (volume(d + h) - volume(d - h)) - volume(d + 2.0 * h) + volume(d - 2.0 * h)) / (12.0 * h);
        let o = wall(dim, 1.0, d).unwrap();
        assert_relative_eq!(-slope, o.area(), max_relative = 1e-6);
        assert_relative_eq!(o.rate(Vector::new(-2.0, 5.0, 0.0), Vector::x()), -2.0 * slope, max_relative = 1e-6);
    }
}
