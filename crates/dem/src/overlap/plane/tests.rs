use super::*;
use crate::{ConvexPolyhedron, Disc, OverlapSolver, Part, Shape, Union};
use interfaces::{Rotation, Solid};
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

fn at(x: f64, y: f64, angle: f64) -> Pose {
    Pose { orientation: Rotation::from_scaled_axis(Vector::z() * angle), ..Pose::at([x, y, 0.0]) }
}

fn solve(a: &dyn Shape, at_a: &Pose, b: &dyn Shape, at_b: &Pose) -> Vec<Overlap> {
    OverlapSolver::new().solve(a, at_a, b, at_b).unwrap().to_vec()
}

fn star(radii: &[f64]) -> Polygon {
    let corner = |(i, r): (usize, &f64)| {
        let (sin, cos) = (TAU * i as f64 / radii.len() as f64).sin_cos();
        [r * cos, r * sin]
    };
    Polygon::new(&radii.iter().enumerate().map(corner).collect::<Vec<_>>()).unwrap()
}

/// Area, and the first moment about the origin.
fn sums(patches: &[Overlap]) -> (f64, Vector) {
    (patches.iter().map(|o| o.volume).sum(), patches.iter().map(|o| o.volume * o.centroid.coords).sum())
}

#[test]
fn unit_squares() {
    let square = Polygon::rectangle([1.0; 2]).unwrap();
    let found = solve(&square, &at(0.0, 0.0, 0.0), &square, &at(0.9, 0.8, 0.0));
    assert_eq!(found.len(), 1);
    let o = found[0];
    assert!((o.volume - 0.02).abs() < 1e-15 && (o.centroid - Point::new(0.45, 0.4, 0.0)).norm() < 1e-15);
    assert!((o.gradient - Vector::new(0.2, 0.1, 0.0)).norm() < 1e-15, "{o:?}");
    // One at 45° in the other: 2(√2 − 1).
    let turned = solve(&square, &at(0.0, 0.0, 0.0), &square, &at(0.0, 0.0, 0.25 * PI));
    assert!((turned[0].volume - 2.0 * (2.0_f64.sqrt() - 1.0)).abs() < 1e-14);
    // All of it within another one, and within a wall.
    let large = Polygon::rectangle([4.0; 2]).unwrap();
    let whole = solve(&square, &at(0.5, 0.0, 0.3), &large, &at(0.0, 0.0, 0.0));
    assert!((whole[0].volume - 1.0).abs() < 1e-14 && whole[0].gradient == Vector::zeros());
    assert!((whole[0].normal - Vector::x()).norm() < 1e-15);
    let wall = HalfSpace::new(Point::origin(), Vector::y()).unwrap();
    let sunk = solve(&square, &at(0.2, 0.4, 0.0), &wall, &at(0.0, 0.0, 0.0));
    assert!((sunk[0].volume - 0.1).abs() < 1e-15 && (sunk[0].normal - Vector::y()).norm() < 1e-15);
    assert!(solve(&square, &at(0.2, -1.0, 0.0), &wall, &at(0.0, 0.0, 0.0))[0].gradient.norm() < 1e-12);
    assert!(solve(&square, &at(0.0, 0.0, 0.0), &square, &at(1.0, 0.0, 0.0)).is_empty());
}

/// An angle of two rectangles is what it is as one polygon, but for the patches.
#[test]
fn unions_of_the_plane() {
    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let angle = Polygon::new(&corners).unwrap();
    let part = |edges: [f64; 2], x: f64, y: f64| Part {
        shape: Arc::new(Polygon::rectangle(edges).unwrap()),
        pose: at(x, y, 0.0),
    };
    let both = Union::new(vec![part([2.0, 1.0], 1.0, 0.5), part([1.0, 1.0], 0.5, 1.5)]).unwrap();
    assert!((both.inertia(1.0).tensor[(2, 2)] - angle.inertia(1.0).tensor[(2, 2)]).abs() < 1e-13);
    let (disc, wall) = (Disc::new(0.8).unwrap(), HalfSpace::new(Point::origin(), Vector::y()).unwrap());
    let others: [(&dyn Shape, Pose); 3] =
        [(&disc, at(0.9, 1.1, 0.0)), (&angle, at(1.4, 0.6, 2.0)), (&wall, at(0.0, 0.4, 0.0))];
    for (other, pose) in others {
        let [one, two] = [&angle as &dyn Shape, &both].map(|a| solve(a, &at(0.2, 0.1, 0.3), other, &pose));
        let [(v, w), (m, n)] = [&one, &two].map(|o| sums(o));
        assert!((v - m).abs() < 1e-13 && v > 0.1 && (w - n).norm() < 1e-13, "{} {v} {m}", other.name());
        let apart = Pose { position: pose.position - 6.0 * Vector::y(), ..pose };
        let [one, two] = [&angle as &dyn Shape, &both]
            .map(|a| closest(&a.form(), &at(0.2, 0.1, 0.3), &other.form(), &apart, 9.0).unwrap());
        assert!((one.gap - two.gap).abs() < 1e-13 && (one.normal - two.normal).norm() < 1e-12);
    }
}

/// A comb in a bar: a patch per tooth; two halves of one polygon that only a cut parts are one patch.
#[test]
fn what_hangs_together_is_one_patch() {
    let teeth: Vec<[f64; 2]> = (0..4)
        .flat_map(|i| [[2.0 * f64::from(i), 0.0], [2.0 * f64::from(i) + 1.0, 0.0]].map(|[x, _]| [x, 0.0]))
        .collect();
    let mut comb: Vec<[f64; 2]> = vec![[7.0, 3.0], [0.0, 3.0]];
    for (i, tooth) in teeth.chunks(2).enumerate() {
        comb.extend([tooth[0], tooth[1]]);
        if i < 3 {
            comb.extend([[tooth[1][0], 2.0], [tooth[1][0] + 1.0, 2.0]]);
        }
    }
    let comb = Polygon::new(&comb).unwrap();
    let origin = comb.origin();
    let place = at(origin.x, origin.y, 0.0);
    let bar = Polygon::rectangle([20.0, 1.0]).unwrap();
    for (shape, pose, n) in [(&bar, at(3.0, 0.0, 0.0), 4), (&bar, at(3.0, 2.5, 0.0), 1)] {
        let found = solve(&comb, &place, shape, &pose);
        assert_eq!(found.len(), n);
        assert_eq!(solve(shape, &pose, &comb, &place).len(), n);
        let (area, _) = sums(&found);
        assert!((area - if n == 4 { 2.0 } else { 7.0 }).abs() < 1e-13, "{area}");
    }
    let disc = Disc::new(0.4).unwrap();
    // Across the roots of a gap: one patch; at its two sides: two.
    assert_eq!(solve(&disc, &at(1.5, 2.2, 0.0), &comb, &place).len(), 1);
    assert_eq!(solve(&Disc::new(0.6).unwrap(), &at(1.5, 1.0, 0.0), &comb, &place).len(), 2);
    let wall = HalfSpace::new(Point::new(0.0, 1.0, 0.0), Vector::y()).unwrap();
    assert_eq!(solve(&comb, &place, &wall, &at(0.0, 0.0, 0.0)).len(), 4);
}

proptest! {
    /// What two convex prisms share, per depth.
    #[test]
    fn convex_ones_are_prisms(
        [n, m] in [3_usize..9, 3..9], [a, b] in [0.5..1.5_f64, 0.5..1.5], x in -2.0..2.0_f64, y in -2.0..2.0_f64, [s, t] in [0.0..6.0_f64, 0.0..6.0],
    ) {
        let (p, q) = (Polygon::ellipse([1.0, a], n).unwrap(), Polygon::ellipse([b, 1.0], m).unwrap());
        // No faces of both in one plane.
        let prism = |p: &Polygon, half: f64| {
            let corners = p.corners().iter().flat_map(|c| [-half, half].map(|z| [c.x, c.y, z])).collect::<Vec<_>>();
            ConvexPolyhedron::from_points(&corners).unwrap()
        };
        let poses = [at(0.3, -0.2, s), at(x, y, t)];
        let plane = solve(&p, &poses[0], &q, &poses[1]);
        let solid = solve(&prism(&p, 1.0), &poses[0], &prism(&q, 1.5), &poses[1]);
        prop_assert!(plane.len() <= 1);
        match (plane.first(), solid.first()) {
            (Some(o), Some(v)) => {
                prop_assert!((2.0 * o.volume - v.volume).abs() < 1e-12, "{} {}", o.volume, v.volume);
                if o.volume > 1e-6 {
                    prop_assert!((o.centroid - v.centroid).norm() < 1e-8 && (2.0 * o.gradient - v.gradient).norm() < 1e-8);
                    prop_assert!((2.0 * o.moment - v.moment).norm() < 1e-8, "{:?} {:?}", o.moment, v.moment);
                }
            }
            (o, v) => prop_assert!(o.map_or(0.0, |o| o.volume) + v.map_or(0.0, |v| v.volume) < 1e-12),
        }
    }

    /// S and the moment are how the area changes with the first body's place and turn; the second sees the opposite. Stars, convex or not, and discs, and walls.
    #[test]
    fn gradients_are_those_of_the_area(
        [p, q] in [proptest::collection::vec(0.3..1.5_f64, 3..9), proptest::collection::vec(0.3..1.5_f64, 3..9)],
        x in -1.5..1.5_f64, y in -1.5..1.5_f64, [s, t] in [0.0..6.0_f64, 0.0..6.0], kind in 0..4_usize,
    ) {
        let (p, q, disc) = (star(&p), star(&q), Disc::new(0.7).unwrap());
        let wall = HalfSpace::new(Point::new(0.1, 0.0, 0.0), Vector::new(0.6, 0.8, 0.0)).unwrap();
        let pairs: [[&dyn Shape; 2]; 4] = [[&p, &q], [&disc, &q], [&q, &disc], [&p, &wall]];
        let [a, b] = pairs[kind];
        let (at_a, at_b) = (at(x, y, s), if kind == 3 { at(0.0, 0.0, 0.0) } else { at(0.0, 0.0, t) });
        let patches = solve(a, &at_a, b, &at_b);
        let area = |pose: &Pose| sums(&solve(a, pose, b, &at_b)).0;
        let h = 1e-6;
        let gradient: Vector = patches.iter().map(|o| o.gradient).sum();
        for (axis, e) in [Vector::x(), Vector::y()].into_iter().enumerate() {
            let moved = |by: f64| Pose { position: at_a.position + by * e, ..at_a };
            let slope = (area(&moved(h)) - area(&moved(-h))) / (2.0 * h);
            prop_assert!((slope - gradient[axis]).abs() < 2e-5, "{axis}: {slope} {}", gradient[axis]);
        }
        // A turn about the first body's place: the moment about it.
        let about: f64 = patches.iter().map(|o| (o.moment + (o.centroid - at_a.position).cross(&o.gradient)).z).sum();
        let turned = |by: f64| Pose { orientation: Rotation::from_scaled_axis(Vector::z() * (s + by)), ..at_a };
        let slope = (area(&turned(h)) - area(&turned(-h))) / (2.0 * h);
        prop_assert!((slope - about).abs() < 2e-5, "{slope} {about}");
        if kind < 3 {
            let other = solve(b, &at_b, a, &at_a);
            let (one, two) = (sums(&patches), sums(&other));
            prop_assert_eq!(patches.len(), other.len());
            prop_assert!((one.0 - two.0).abs() < 1e-13 && (one.1 - two.1).norm() < 1e-13);
            prop_assert!((gradient + other.iter().map(|o| o.gradient).sum::<Vector>()).norm() < 1e-12);
        }
    }

    /// Bodies that are apart, however near, share nothing.
    #[test]
    fn bodies_apart_share_nothing(
        [p, q] in [proptest::collection::vec(0.3..1.5_f64, 3..9), proptest::collection::vec(0.3..1.5_f64, 3..9)],
        angle in 0.0..6.3_f64, turn in 0.0..6.3_f64, gap in 1e-9..1e-3_f64, size in 0.01..100.0_f64, disc: bool,
    ) {
        let (p, q, disc) = (star(&p), star(&q), if disc { Some(Disc::new(size).unwrap()) } else { None });
        let other: &dyn Shape = disc.as_ref().map_or(&q, |disc| disc);
        // Comes from far away until it is as near as that.
        let (mut way, way_by) = (4.0 + other.bounding_radius(), Vector::new(angle.cos(), angle.sin(), 0.0));
        let place = |way: f64| Pose { position: Point::from(way * way_by), ..at(0.0, 0.0, turn) };
        for _ in 0..60 {
            let found = closest(&p.form(), &at(0.0, 0.0, 0.0), &other.form(), &place(way), f64::INFINITY).unwrap();
            if found.gap <= gap {
                break;
            }
            way -= 0.999 * (found.gap - 0.5 * gap);
        }
        for patches in [solve(&p, &at(0.0, 0.0, 0.0), other, &place(way)), solve(other, &place(way), &p, &at(0.0, 0.0, 0.0))] {
            prop_assert!(patches.is_empty(), "{patches:?}");
        }
    }

    /// A disc is a polygon of many corners.
    #[test]
    fn discs_are_polygons_of_many_corners(
        q in proptest::collection::vec(0.3..1.5_f64, 3..9), x in -2.0..2.0_f64, y in -2.0..2.0_f64, r in 0.1..2.0_f64,
    ) {
        let (q, disc, many) = (star(&q), Disc::new(r).unwrap(), Polygon::ellipse([r; 2], 400).unwrap());
        let [one, two] = [&disc as &dyn Shape, &many].map(|a| sums(&solve(a, &at(x, y, 0.0), &q, &at(0.0, 0.0, 0.2))));
        prop_assert!((one.0 - two.0).abs() < 1e-4 * r * r && (one.1 - two.1).norm() < 3e-4 * r * r, "{one:?} {two:?}");
    }

    /// Where two are closest: as near as any sampled places are, and the same from the other side.
    #[test]
    fn closest_places(
        [p, q] in [proptest::collection::vec(0.3..1.0_f64, 3..8), proptest::collection::vec(0.3..1.0_f64, 3..8)], angle in 0.0..6.0_f64, disc: bool,
    ) {
        let (p, q, ball) = (star(&p), star(&q), Disc::new(0.5).unwrap());
        let (at_a, at_b) = (at(0.1, 0.2, angle), at(0.1 + 2.2 * angle.cos(), 0.2 + 2.2 * angle.sin(), 1.0));
        let other: &dyn Shape = if disc { &ball } else { &q };
        let found = closest(&p.form(), &at_a, &other.form(), &at_b, 5.0).unwrap();
        let sampled = p.edges().flat_map(|[c, d]| (0..=200).map(move |i| c + (d - c) * (f64::from(i) / 200.0)));
        let world = |v: Vector2<f64>| at_a.to_world(Point::new(v.x, v.y, 0.0));
        let least = sampled.map(|v| other.signed_distance(at_b.to_body(world(v)), 9.0)).fold(f64::INFINITY, f64::min);
        prop_assert!(found.gap <= least + 1e-12 && least - found.gap < 0.01, "{} {least}", found.gap);
        let ends = [-0.5, 0.5].map(|s| found.at + found.normal * (s * found.gap));
        prop_assert!(p.signed_distance(at_a.to_body(ends[0]), 9.0).abs() < 1e-12);
        prop_assert!(other.signed_distance(at_b.to_body(ends[1]), 9.0).abs() < 1e-12);
        let back = closest(&other.form(), &at_b, &p.form(), &at_a, 5.0).unwrap();
        prop_assert!((back.gap - found.gap).abs() < 1e-12);
    }
}
