//! Bodies with edges of which only the distances are used, against exact routes.
use super::*;
use crate::draw::Draw;
use crate::{Capsule, Cuboid, Cylinder, Ellipsoid};

const KINDS: usize = 6;

/// A pair, aspect ratios up to `most`.
fn pair(kind: usize, most: f64, draw: &mut Draw) -> [Box<dyn Shape>; 2] {
    let mut edge = || draw.between(1.0 / most, 1.0);
    match kind {
        0 => [0, 1].map(|_| Box::new(Cuboid::new([edge(), edge(), edge()]).unwrap()) as _),
        1 => {
            [Box::new(Sphere::new(edge()).unwrap()), Box::new(Cuboid::new([edge(), edge(), edge()]).unwrap())]
        }
        2 => [
            Box::new(Capsule::new(0.5 * edge(), edge()).unwrap()),
            Box::new(Cuboid::new([edge(), edge(), edge()]).unwrap()),
        ],
        3 => [0, 1].map(|_| Box::new(Cylinder::new(0.5 * edge(), edge()).unwrap()) as _),
        4 => [
            Box::new(Ellipsoid::new([edge(), edge(), edge()]).unwrap()),
            Box::new(Cuboid::new([edge(), edge(), edge()]).unwrap()),
        ],
        _ => [0, 1].map(|_| Box::new(Ellipsoid::new([edge(), edge(), edge()]).unwrap()) as _),
    }
}

/// The pair somewhere between a graze and the one within the other, as deep as a power of ten from 1e-4 on.
fn pose(a: &dyn Shape, b: &dyn Shape, exact: &mut OverlapSolver, draw: &mut Draw) -> [Pose; 2] {
    let turns = [draw.turn(), draw.turn()];
    let way = draw.direction();
    let poses = |distance: f64| {
        [
            Pose { position: Point::new(0.3, -0.2, 0.7), orientation: turns[0] },
            Pose { position: Point::new(0.3, -0.2, 0.7) + way * distance, orientation: turns[1] },
        ]
    };
    let (mut near, mut far) = (0.0, a.bounding_radius() + b.bounding_radius());
    for _ in 0..40 {
        let middle = 0.5 * (near + far);
        let [p, q] = poses(middle);
        *(if exact.solve(a, &p, b, &q).unwrap().is_empty() { &mut far } else { &mut near }) = middle;
    }
    let least = a.aabb().extent().min().min(b.aabb().extent().min());
    poses(far - least * draw.between(1e-4, 1.0))
}

/// Within the tolerance in nearly all poses, and never beyond one and a half times it; convex bodies take no boxes.
#[test]
fn bodies_with_edges() {
    let mut exact = OverlapSolver::new().with_tolerance(1e-9);
    let mut tree = tolerance(1e-3);
    let (mut met, mut boxes, mut beyond) = (0, 0, 0);
    for kind in 0..KINDS {
        let mut draw = Draw(2);
        for case in 0..100 {
            let [a, b] = pair(kind, if case % 2 == 0 { 2.0 } else { 10.0 }, &mut draw);
            let [at_a, at_b] = pose(&*a, &*b, &mut exact, &mut draw);
            let known = exact.solve(&*a, &at_a, &*b, &at_b).unwrap().to_vec();
            let [known] = &known[..] else { continue };
            let found = one(tree.solve(&*a, &at_a, &*b, &at_b).unwrap());
            let error = (found.volume / known.volume - 1.0).abs();
            assert!(error < 1.5e-3, "{kind} {case}: {found:?} {known:?}");
            let area = known.gradient.norm();
            if area > 1e-9 * known.volume.cbrt().powi(2) {
                let off = (found.gradient - known.gradient).norm() / area;
                assert!(off < 2e-2, "{kind} {case}: {off} {found:?} {known:?}");
            }
            let apart = (found.centroid - known.centroid).norm();
            let size = a.bounding_radius().min(b.bounding_radius());
            assert!(apart < 1e-3 * size, "{kind} {case}: {apart} {found:?} {known:?}");
            met += 1;
            beyond += usize::from(error > 1e-3);
            boxes += usize::from(tree.boxes().next().is_some());
        }
    }
    assert!(met > 590 && boxes <= 3 && beyond <= 1, "{met} {boxes} {beyond}");
}

/// What is known of cubes is exact, wherever they are: planes are found for good.
#[test]
fn flat_faces_are_exact() {
    let cube = turned(at(0.6, 0.3, 0.2), [20_f64.to_radians(), 0.0, 0.0]);
    let turn = Rotation::from_axis_angle(&Vector::z_axis(), PI / 6.0);
    let cube = Pose { orientation: turn * cube.orientation, ..cube };
    let o = one(tolerance(1e-3).solve(&CUBE, &at(0.0, 0.0, 0.0), &CUBE, &cube).unwrap());
    assert!((o.volume / 0.234_876_418_44 - 1.0).abs() < 1e-9, "{o:?}");
    let block = Cuboid::new([1.0; 3]).unwrap();
    let known = OverlapSolver::new().solve(&block, &at(0.0, 0.0, 0.0), &block, &cube).unwrap()[0];
    assert!((o.centroid - known.centroid).norm() < 1e-8 && (o.gradient - known.gradient).norm() < 1e-8);
    assert!((o.moment - known.moment).norm() < 1e-8, "{o:?} {known:?}");
}

/// A corner in a face, however small what it shares: there is no place that a search on a grid would meet.
#[test]
fn corners_that_only_just_touch() {
    for depth in [1e-2, 1e-4, 1e-6] {
        // The diagonal upright.
        let up = Vector::z() * (0.5 + 0.75_f64.sqrt() - depth);
        let orientation = Rotation::rotation_between(&Vector::repeat(1.0), &-Vector::z()).unwrap();
        let b = Pose { position: Point::from(up + Vector::new(0.13, -0.07, 0.0)), orientation };
        let o = one(tolerance(1e-3).solve(&CUBE, &at(0.0, 0.0, 0.0), &CUBE, &b).unwrap());
        // Three edges of √3·depth at right angles.
        let exact = (3_f64.sqrt() * depth).powi(3) / 6.0;
        assert!((o.volume / exact - 1.0).abs() < 1e-3, "{depth} {o:?} {exact}");
        assert!((o.normal + Vector::z()).norm() < 1e-2, "{depth} {o:?}");
    }
}
