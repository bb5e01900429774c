//! Hulls against what they must be, with many points on planes and lines.
use super::{hull, quickhull, start};
use crate::{ConvexPolyhedron, DemError};
use interfaces::{Point, Rotation, Vector};
use proptest::prelude::*;
use std::collections::{BTreeSet, HashMap};
use std::f64::consts::{PI, TAU};

type Hull = (Vec<Point>, Vec<Vec<u32>>);

fn volume((vertices, faces): &Hull) -> f64 {
    let fans = faces.iter().flat_map(|f| f.windows(2).skip(1).map(|p| [f[0], p[0], p[1]]));
    fans.map(|t| t.map(|v| vertices[v as usize] - vertices[0]))
        .map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0)
        .sum()
}

/// What makes it the convex hull: closed, faces plane, strictly convex and all points behind them, corners among the points, all
/// used. `flat` is a share of the size.
fn check(points: &[[f64; 3]], found: &Hull, flat: f64) {
    let (vertices, faces) = found;
    let given: BTreeSet<[u64; 3]> = points.iter().map(|p| p.map(f64::to_bits)).collect();
    assert!(vertices.iter().all(|v| given.contains(&<[f64; 3]>::from(*v).map(f64::to_bits))));
    let used: BTreeSet<u32> = faces.iter().flatten().copied().collect();
    assert_eq!(used.len(), vertices.len());
    let mut edges = HashMap::new();
    for face in faces {
        assert!(face.len() > 2);
        for i in 0..face.len() {
            *edges.entry((face[i], face[(i + 1) % face.len()])).or_insert(0) += 1;
        }
    }
    assert!(edges.iter().all(|((p, q), n)| *n == 1 && edges.contains_key(&(*q, *p))), "not closed");
    assert_eq!(vertices.len() + faces.len(), edges.len() / 2 + 2);
    let size = points
        .iter()
        .flat_map(|p| points.iter().take(50).map(|q| (Point::from(*p) - Point::from(*q)).norm()));
    let flat = flat * size.fold(0.0, f64::max);
    for face in faces {
        let corners: Vec<Vector> = face.iter().map(|v| vertices[*v as usize].coords).collect();
        let n = corners.len();
        let cross: Vector =
            (1..n - 1).map(|i| (corners[i] - corners[0]).cross(&(corners[i + 1] - corners[0]))).sum();
        let normal = cross.normalize();
        for p in points {
            let height = normal.dot(&(Vector::from(*p) - corners[0]));
            // The normals of narrow faces are not known as well.
            let spread = corners.iter().map(|c| (c - corners[0]).norm()).fold(0.0, f64::max);
            let slack = flat * (1.0 + spread * spread / cross.norm());
            assert!(height <= slack, "a point {height:e} m before a face of {n} corners");
        }
    }
}

/// Points of a grid with so many along each axis, at integers.
fn grid(n: [usize; 3]) -> Vec<[f64; 3]> {
    let all = (0..n[0]).flat_map(|i| (0..n[1]).flat_map(move |j| (0..n[2]).map(move |k| [i, j, k])));
    all.map(|p| p.map(|x| x as f64)).collect()
}

fn turned(points: &[[f64; 3]], turn: [f64; 3], shift: [f64; 3]) -> Vec<[f64; 3]> {
    let rotation = Rotation::from_scaled_axis(turn.into());
    points.iter().map(|p| (rotation * Vector::from(*p) + Vector::from(shift)).into()).collect()
}

#[test]
fn a_cube_of_points_is_a_cube() {
    for n in [2, 3, 9] {
        let points = grid([n, n, n]);
        for points in [points.clone(), turned(&points, [0.3, 0.7, -0.4], [1e3, 20.0, -3.0])] {
            let found = hull(&points).unwrap();
            assert_eq!((found.0.len(), found.1.len()), (8, 6), "{n}");
            assert!(found.1.iter().all(|f| f.len() == 4));
            assert!((volume(&found) / ((n - 1) as f64).powi(3) - 1.0).abs() < 1e-12);
            check(&points, &found, 1e-12);
        }
    }
}

#[test]
fn prisms_keep_their_polygons() {
    for n in [3, 7, 100] {
        let ring = (0..n).map(|i| (TAU * i as f64 / n as f64).sin_cos());
        let points: Vec<[f64; 3]> = ring.flat_map(|(s, c)| [0.0, 0.5, 2.0].map(|z| [c, s, z])).collect();
        let points = turned(&points, [1.0, 0.2, 0.3], [-3.0, 4.0, 5.0]);
        let found = hull(&points).unwrap();
        assert_eq!((found.0.len(), found.1.len()), (2 * n, n + 2));
        let exact = n as f64 * (TAU / n as f64).sin();
        assert!((volume(&found) / exact - 1.0).abs() < 1e-12);
        check(&points, &found, 1e-12);
    }
}

#[test]
fn points_on_a_sphere_are_all_corners() {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let points: Vec<[f64; 3]> = (0..2000)
        .map(|i| {
            let (z, (s, c)) = (1.0 - (2.0 * i as f64 + 1.0) / 2000.0, (golden * i as f64).sin_cos());
            let r = (1.0 - z * z).sqrt();
            [r * c, r * s, z]
        })
        .collect();
    let found = hull(&points).unwrap();
    assert_eq!((found.0.len(), found.1.len()), (2000, 3996));
    check(&points, &found, 1e-12);
}

#[test]
fn what_has_no_hull_is_named() {
    assert_eq!(hull(&[[0.0; 3]; 3]), Err(DemError::TooFewPoints { points: 3 }));
    assert!(matches!(hull(&[[2.0; 3]; 9]), Err(DemError::PointsOnLine { size: 0.0, .. })));
    let line: Vec<[f64; 3]> = (0..9).map(|i| [0.1, 0.2, 0.3].map(|x| x * f64::from(i))).collect();
    assert!(matches!(hull(&line), Err(DemError::PointsOnLine { .. })));
    let plane = turned(&grid([5, 4, 1]), [0.3, 0.4, 0.5], [1.0, 2.0, 3.0]);
    assert!(matches!(hull(&plane), Err(DemError::PointsOnPlane { .. })));
    let mut points = grid([2, 2, 2]);
    points[5][1] = f64::NAN;
    assert!(matches!(hull(&points), Err(DemError::PointNotFinite { point: 5, .. })));
    points[5][1] = 1e200;
    assert!(matches!(hull(&points), Err(DemError::PointNotFinite { point: 5, .. })));
    // Sizes do not matter.
    for size in [1e-200, 1e-9, 1e40] {
        let points: Vec<[f64; 3]> = grid([3, 3, 3]).iter().map(|p| p.map(|x| x * size)).collect();
        let found = hull(&points).unwrap();
        assert_eq!((found.0.len(), found.1.len()), (8, 6), "{size}");
    }
}

/// Plane means up to 1e-12 of the size, or the round-off of coordinates far from the origin.
#[test]
fn nearly_plane_faces_are_one() {
    let noise = |i: usize, a: usize| ((7 * i + a) as f64 * 12.9898).sin();
    for (error, shift) in [(4e-13, 0.0), (0.0, 1e6)] {
        let points: Vec<[f64; 3]> = turned(&grid([5, 5, 5]), [0.3, 0.7, -0.4], [shift, -shift, 0.5 * shift])
            .iter()
            .enumerate()
            .map(|(i, p)| [0, 1, 2].map(|a| p[a] + error * noise(i, a)))
            .collect();
        let found = hull(&points).unwrap();
        assert_eq!((found.0.len(), found.1.len()), (8, 6), "{error} {shift}");
    }
    // A thousand times that is not plane.
    let points: Vec<[f64; 3]> = grid([5, 5, 5])
        .iter()
        .enumerate()
        .map(|(i, p)| [0, 1, 2].map(|a| p[a] + 4e-10 * noise(i, a)))
        .collect();
    assert!(hull(&points).unwrap().1.len() > 20);
}

/// Thousands of points on few planes and lines, many of them the same.
fn small_integers() -> impl Strategy<Value = Vec<[f64; 3]>> {
    let point = |most: i32| prop::array::uniform3(0..=most);
    (1..6_i32)
        .prop_flat_map(move |most| prop::collection::vec(point(most), 0..60))
        .prop_map(|points| points.into_iter().map(|p| p.map(f64::from)).collect())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, failure_persistence: None, ..ProptestConfig::default() })]

    /// Exact where coordinates are integers: faces of the hull are the planes through three points with all others on one side.
    #[test]
    fn hulls_of_integers(points in small_integers()) {
        let Ok(found) = hull(&points) else { return Ok(()) };
        check(&points, &found, 1e-14);
        let mut planes = BTreeSet::new();
        for face in &found.1 {
            let [a, b, c] = [0, 1, 2].map(|i| found.0[face[i] as usize].coords);
            // No two faces on one plane, no corner on an edge.
            let normal = (b - a).cross(&(c - a)).normalize() + Vector::repeat(0.0);
            let key = [normal.x, normal.y, normal.z, normal.dot(&a)].map(|x| (x * 1e9).round() as i64);
            prop_assert!(planes.insert(key));
            let n = face.len();
            for i in 0..n {
                let [p, q, r] = [i, i + 1, i + 2].map(|i| found.0[face[i % n] as usize].coords);
                prop_assert!((q - p).cross(&(r - q)).dot(&normal) > 0.5 * 1e-9);
            }
        }
    }

    /// Before faces are joined: no triangle without area, no point beyond one, by as little as it may be.
    #[test]
    fn triangles_are_exact(points in small_integers()) {
        prop_assume!(points.len() > 3);
        let Ok((first, _)) = start(&points, 1.0) else { return Ok(()) };
        let at = |v: u32| Vector::from(points[v as usize]);
        for [a, b, c] in quickhull::quickhull(&points, first) {
            let normal = (at(b) - at(a)).cross(&(at(c) - at(a)));
            prop_assert!(normal != Vector::zeros());
            prop_assert!(points.iter().all(|p| normal.dot(&(Vector::from(*p) - at(a))) <= 0.0));
        }
    }

    /// Turned, the same points have as many corners and faces, though no longer exactly on planes.
    #[test]
    fn round_off_does_not_matter(points in small_integers(), turn in prop::array::uniform3(-3.0..3.0_f64),
                                 shift in prop::array::uniform3(-30.0..30.0_f64)) {
        let moved = turned(&points, turn, shift);
        match (hull(&points), hull(&moved)) {
            (Ok(plain), Ok(found)) => {
                check(&moved, &found, 1e-12);
                prop_assert_eq!((plain.0.len(), plain.1.len()), (found.0.len(), found.1.len()));
                prop_assert!((volume(&plain) / volume(&found) - 1.0).abs() < 1e-10);
                let body = ConvexPolyhedron::from_points(&moved).unwrap();
                prop_assert!((body.volume() / volume(&plain) - 1.0).abs() < 1e-10);
            }
            (Err(plain), Err(found)) => {
                prop_assert_eq!(std::mem::discriminant(&plain), std::mem::discriminant(&found));
            }
            (plain, found) => prop_assert!(false, "{:?} {:?}", plain, found),
        }
    }

    /// Nearly plane and nearly on lines at all scales, up to what is called plane.
    #[test]
    fn nearly_plane(points in prop::collection::vec(prop::array::uniform3(-4..=4_i32), 4..40), noise in -17..-2_i32,
                    seed in prop::collection::vec(prop::array::uniform3(-1.0..1.0_f64), 40), exponent in -30..30_i32) {
        let size = 2.0_f64.powi(exponent);
        let noisy = |(p, e): (&[i32; 3], &[f64; 3])| [0, 1, 2].map(|a| (f64::from(p[a]) + e[a] * 10.0_f64.powi(noise)) * size);
        let points: Vec<[f64; 3]> = points.iter().zip(&seed).map(noisy).collect();
        if let Ok(found) = hull(&points) {
            check(&points, &found, 1e-11);
        }
    }
}
