//! Overlaps by the adaptive tree against formulas, and how fast they converge.
use crate::{
    BoxKind, CellOverlap, DemError, HalfSpace, Normal, Overlap, OverlapSolver, Refinement, Route, Shape,
    Sphere,
};
use interfaces::{Aabb, Cell, Inertia, MeshGeometry, Point, Pose, Rotation, Solid, Vector};
use proptest::prelude::*;
use std::f64::consts::PI;

/// A body of which only the distance is known.
struct Given {
    distance: fn(Vector) -> f64,
    half: [f64; 3],
}

impl Solid for Given {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        (self.distance)(x.coords)
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), self.half.into())
    }
}
impl Shape for Given {
    fn name(&self) -> &'static str {
        "body"
    }
    fn inertia(&self, _: f64) -> Inertia {
        unreachable!("overlaps do not ask for it")
    }
    fn bounding_radius(&self) -> f64 {
        Vector::from(self.half).norm()
    }
}

mod convex;
#[cfg(feature = "mesh")]
mod facets;
mod parted;
mod regions;

const BALL: Given = Given { distance: |x| x.norm() - 1.0, half: [1.0; 3] };
const TORUS: Given = Given { distance: |x| (x.x.hypot(x.y) - 0.7).hypot(x.z) - 0.3, half: [1.0, 1.0, 0.3] };
/// Unit edges.
const CUBE: Given = Given {
    distance: |x| {
        let q = x.abs() - Vector::repeat(0.5);
        q.map(|q| q.max(0.0)).norm() + q.max().min(0.0)
    },
    half: [0.5; 3],
};
/// Half-axes 1, 0.6 and 0.4: no distance, but a bound of it, (|p| − 1)·0.4 with p the stretched place.
const ELLIPSOID: Given = Given {
    distance: |x| 0.4 * (Vector::new(x.x, x.y / 0.6, x.z / 0.4).norm() - 1.0),
    half: [1.0, 0.6, 0.4],
};

fn solver(refinement: Refinement) -> OverlapSolver {
    OverlapSolver::new().with_route(Some(Route::Tree)).with_refinement(refinement)
}
fn tolerance(t: f64) -> OverlapSolver {
    solver(Refinement::Tolerance(t))
}
fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::at([x, y, z])
}
fn turned(pose: Pose, [x, y, z]: [f64; 3]) -> Pose {
    Pose { orientation: Rotation::from_euler_angles(x, y, z), ..pose }
}
fn one(patches: &[Overlap]) -> Overlap {
    assert_eq!(patches.len(), 1);
    patches[0]
}
/// Of two balls of radius 1 whose centres are `d` apart.
fn lens(d: f64) -> f64 {
    PI * (2.0 - d) * (2.0 - d) * (4.0 + d) / 12.0
}

/// Down to a depth of 1e-9, in any direction and anywhere; gradient, centroid and moment too.
#[test]
fn balls_at_all_depths() {
    for tol in [1e-2, 1e-3, 1e-4] {
        let mut solver = tolerance(tol);
        for depth in [1e-9, 1e-6, 1e-3, 0.1, 0.7, 1.6] {
            for direction in [Vector::z(), Vector::new(0.3, -0.5, 0.7).normalize()] {
                for place in [[0.0; 3], [1e3, -2e3, 5e2]] {
                    let a = Pose::at(place);
                    let b = Pose::at((Vector::from(place) + (2.0 - depth) * direction).into());
                    let d = (b.position - a.position).norm();
                    // Digits of the place itself.
                    if (d - 2.0 + depth).abs() > 1e-3 * tol * depth {
                        continue;
                    }
                    let o = one(solver.solve(&BALL, &a, &BALL, &b).unwrap());
                    assert!((o.volume / lens(d) - 1.0).abs() < 2.0 * tol, "{tol} {depth} {o:?}");
                    let off = o.centroid - nalgebra::center(&a.position, &b.position);
                    assert!(
                        off.dot(&direction).abs() < 3.0 * tol * depth && off.norm() < 3.0 * tol,
                        "{tol} {depth}"
                    );
                    let area = PI * (1.0 - 0.25 * d * d);
                    let s = (o.gradient - area * direction).norm() / area;
                    assert!(s < 20.0 * tol, "{tol} {depth} {s}");
                    assert!(o.moment.norm() < 20.0 * tol * area);
                    assert!((o.normal + direction).norm() < 20.0 * tol);
                }
            }
        }
    }
}

/// Work against error: the error falls at least as fast as the tolerance, for smooth bodies and for corners.
#[test]
fn errors_keep_to_the_tolerance() {
    let cube = turned(at(0.6, 0.3, 0.2), [20_f64.to_radians(), 0.0, 0.0]);
    // R = Rz(30°) Rx(20°).
    let cube = Pose {
        orientation: Rotation::from_axis_angle(&Vector::z_axis(), PI / 6.0) * cube.orientation,
        ..cube
    };
    let cases: [(&Given, Pose, &Given, f64); 3] = [
        (&CUBE, cube, &CUBE, 0.234_876_418_44),
        // A ball on the corner of a cube.
        (&CUBE, at(0.5, 0.5, 0.5), &SMALL, 4.0 / 3.0 * PI * 0.027 / 8.0),
        // One within the other.
        (&BALL, at(0.2, 0.1, 0.0), &ELLIPSOID_SMALL, 4.0 / 3.0 * PI * 0.5 * 0.3 * 0.2),
    ];
    for (a, at_b, b, exact) in cases {
        for tol in [1e-1, 1e-2, 1e-3] {
            let mut solver = tolerance(tol);
            let o = one(solver.solve(a, &at(0.0, 0.0, 0.0), b, &at_b).unwrap());
            assert!((o.volume / exact - 1.0).abs() < 2.0 * tol, "{exact} {tol} {}", o.volume);
        }
    }
}
const SMALL: Given = Given { distance: |x| x.norm() - 0.3, half: [0.3; 3] };
const ELLIPSOID_SMALL: Given = Given {
    distance: |x| 0.2 * (Vector::new(x.x / 0.5, x.y / 0.3, x.z / 0.2).norm() - 1.0),
    half: [0.5, 0.3, 0.2],
};

/// Centroids of the reference page, and what a face contact's gradient is.
#[test]
fn cubes_face_to_face_and_askew() {
    let o = one(tolerance(1e-3).solve(&CUBE, &at(0.0, 0.0, 0.0), &CUBE, &at(0.9, 0.8, 0.7)).unwrap()).volume;
    assert!((o / 0.006 - 1.0).abs() < 2e-3);
    let o = one(tolerance(1e-2).solve(&CUBE, &at(0.0, 0.0, 0.0), &CUBE, &at(0.9, 0.0, 0.0)).unwrap());
    assert!((o.volume / 0.1 - 1.0).abs() < 2e-2, "{o:?}");
    assert!((o.normal + Vector::x()).norm() < 1e-2 && (o.area() - 1.0).abs() < 3e-2);
    assert!((o.centroid - Point::new(0.45, 0.0, 0.0)).norm() < 1e-2);
}

/// A graze of two non-convex bodies in each of several places at once: one patch each.
#[test]
fn patches_are_told_apart() {
    // A bar through the ring touches its inner wall on both sides.
    const BAR: Given = Given {
        distance: |x| {
            let q = Vector::new(x.x.abs() - 0.41, x.y.abs() - 0.1, x.z.abs() - 0.1);
            q.map(|q| q.max(0.0)).norm() + q.max().min(0.0)
        },
        half: [0.41, 0.1, 0.1],
    };
    let mut solver = tolerance(1e-3);
    let patches = solver.solve(&TORUS, &at(0.0, 0.0, 0.0), &BAR, &at(0.0, 0.0, 0.0)).unwrap().to_vec();
    assert_eq!(patches.len(), 2, "{patches:?}");
    assert!((patches[0].volume / patches[1].volume - 1.0).abs() < 1e-3);
    assert!(patches[0].centroid.x * patches[1].centroid.x < 0.0);
    let way = patches[0].normal + patches[1].normal;
    assert!(way.norm() < 2e-2, "{patches:?}");
    // Two rings in a chain, pulled apart until they touch at one place; and far apart.
    let link = |x: f64| turned(at(x, 0.0, 0.0), [0.5 * PI, 0.0, 0.0]);
    let patches = solver.solve(&TORUS, &at(0.0, 0.0, 0.0), &TORUS, &link(0.85)).unwrap();
    assert_eq!(patches.len(), 1);
    assert!(solver.solve(&TORUS, &at(0.0, 0.0, 0.0), &TORUS, &link(0.7)).unwrap().is_empty());
    assert!(solver.solve(&TORUS, &at(0.0, 0.0, 0.0), &TORUS, &at(3.0, 0.0, 0.0)).unwrap().is_empty());
}

/// The paper's tree: every level divides the boxes by two, and the error falls by four at least.
#[test]
fn levels_converge() {
    let (a, b) = (at(0.0, 0.0, 0.0), at(1.0, 0.7, 0.5));
    let exact = lens(b.position.coords.norm());
    let mut errors = Vec::new();
    for level in 1..=5 {
        let mut solver = solver(Refinement::Levels(level));
        let o = one(solver.solve(&BALL, &a, &BALL, &b).unwrap());
        errors.push((o.volume / exact - 1.0).abs());
        let cut = solver.boxes().filter(|b| b.kind != BoxKind::Inside);
        assert!(cut.count() > 0 && solver.boxes().all(|b| b.level <= level));
        let total: f64 = solver.boxes().map(|b| b.volume).sum();
        assert!((total / o.volume - 1.0).abs() < 1e-12);
    }
    for (coarse, fine) in errors.iter().zip(&errors[2..]) {
        assert!(*fine < coarse / 16.0 || *fine < 1e-5, "{errors:?}");
    }
    assert!(errors[2] < 5e-3, "{errors:?}");
}

/// What the paper's normal is worth.
#[test]
fn planes_through_edge_boxes() {
    for refinement in [Refinement::Levels(4), Refinement::Levels(6), Refinement::Tolerance(1e-4)] {
        for direction in [Vector::z(), Vector::new(0.6, 0.5, 0.7).normalize()] {
            let mut solver = solver(refinement).with_normal(Normal::PlaneFit);
            let b = Pose::at((1.9 * direction).into());
            let o = one(solver.solve(&BALL, &at(0.0, 0.0, 0.0), &BALL, &b).unwrap());
            let degrees = o.normal.angle(&-direction).to_degrees();
            assert!(degrees < 1.0, "{refinement:?} {direction:?} {degrees}");
            assert!(solver.boxes().any(|b| b.kind == BoxKind::Edge));
        }
    }
}

/// Walls, and pairs that have no route.
#[test]
fn walls_and_what_is_refused() {
    let wall = HalfSpace::new(Point::new(0.0, 0.0, 0.3), Vector::z()).unwrap();
    let o = one(tolerance(1e-4).solve(&ELLIPSOID, &at(5.0, 0.0, 0.5), &wall, &at(0.0, 0.0, 0.0)).unwrap());
    // A cap of height ⅕/0.4 of the half-axis, of the ball that it is the image of.
    let exact = 0.24 * PI * 0.25 * 2.5 / 3.0;
    // Its centroid is 0.675 of the half-axis from the middle.
    assert!((o.centroid - Point::new(5.0, 0.0, 0.23)).norm() < 1e-4, "{o:?}");
    assert!((o.volume / exact - 1.0).abs() < 1e-4 && (o.normal - Vector::z()).norm() < 1e-3, "{o:?}");
    let disc = crate::Disc::new(1.0).unwrap();
    let mut solver = tolerance(1e-2);
    let error = solver.solve(&disc, &at(0.0, 0.0, 0.0), &BALL, &at(1.0, 0.0, 0.0)).unwrap_err();
    assert!(matches!(error, DemError::Route { .. }));
    let error = solver.solve(&wall, &at(0.0, 0.0, 0.0), &wall, &at(1.0, 0.0, 0.0)).unwrap_err();
    assert!(matches!(error, DemError::Route { .. }));
    for refinement in [Refinement::Levels(0), Refinement::Levels(9), Refinement::Tolerance(f64::NAN)] {
        let error = OverlapSolver::new().with_route(Some(Route::Tree)).with_refinement(refinement);
        let error = { error }.solve(&BALL, &at(0.0, 0.0, 0.0), &BALL, &at(1.0, 0.0, 0.0)).unwrap_err();
        assert!(matches!(error, DemError::Refinement { .. }));
    }
    assert!(matches!(CellOverlap::new(9), Err(DemError::Refinement { .. })));
}

/// Cells of a mesh of 0.1 m, divided or not.
struct Lattice;
impl MeshGeometry for Lattice {
    fn for_cells_in(&self, b: &Aabb, mut see: impl FnMut(&Cell)) {
        let range = |a: usize| (b.min[a] / 0.1).floor() as i64..=(b.max[a] / 0.1).floor() as i64;
        for i in range(0) {
            for j in range(1) {
                for k in range(2) {
                    let centre = [i, j, k].map(|n| 0.1 * n as f64 + 0.05).into();
                    see(&Cell { centre, edges: Vector::repeat(0.1), volume: 1e-3 });
                }
            }
        }
    }
}

#[test]
fn cells_of_a_mesh() {
    let (ball, a, b) = (Sphere::new(1.0).unwrap(), at(0.013, 0.0, 0.0), at(1.213, 0.9, 0.83));
    let d = (b.position - a.position).norm();
    let mut errors = Vec::new();
    for levels in 0..=2 {
        let mut cells = CellOverlap::new(levels).unwrap();
        let o = cells.overlap(&Lattice, &ball, &a, &ball, &b).unwrap().unwrap();
        errors.push((o.volume / lens(d) - 1.0).abs());
        let way = (a.position - b.position).normalize();
        assert!(
            (o.normal - way).norm() < 0.03 && (o.area() / (PI * (1.0 - 0.25 * d * d)) - 1.0).abs() < 0.03
        );
        assert!((o.centroid - nalgebra::center(&a.position, &b.position)).norm() < 0.02);
        assert!(cells.n_cells() > 10);
        assert!(cells.overlap(&Lattice, &ball, &a, &ball, &at(3.0, 0.0, 0.0)).unwrap().is_none());
    }
    assert!(errors[0] < 0.02 && errors[2] < 1e-3 && errors[2] < errors[0], "{errors:?}");
}

/// A warmed-up solver allocates nothing.
#[test]
fn no_memory_is_asked_for_again() {
    for refinement in [Refinement::Levels(4), Refinement::Tolerance(1e-3)] {
        let mut solver = solver(refinement);
        let mut step = |i: usize| {
            let b = turned(at(1.5, 0.01 * (i % 5) as f64, 0.2), [0.1 * (i % 5) as f64, 0.2, 0.3]);
            let near = turned(at(0.6, 0.3, 0.2), [0.1 * (i % 5) as f64, 0.2, 0.3]);
            let cubes = solver.solve(&CUBE, &at(0.0, 0.0, 0.0), &CUBE, &near).unwrap().len();
            cubes * solver.solve(&TORUS, &at(0.0, 0.0, 0.0), &TORUS, &b).unwrap().len()
        };
        (0..5).for_each(|i| assert!(step(i) > 0));
        let used = allocation_counter::measure(|| (0..5).for_each(|i| assert!(step(i) > 0)));
        assert_eq!(used.count_total, 0, "{refinement:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    /// The pair the other way round, and all of it moved and turned, give the same; the gradient is the volume's.
    #[test]
    fn symmetric_and_consistent(
        place in prop::array::uniform3(-0.6..0.6_f64),
        turn in prop::array::uniform3(-3.0..3.0_f64),
        bodies in 0..3_usize,
    ) {
        let (a, b) = [(&TORUS, &ELLIPSOID), (&ELLIPSOID, &ELLIPSOID), (&BALL, &TORUS)][bodies];
        let (at_a, at_b) = (turned(at(0.0, 0.0, 0.0), [0.3, 0.2, 0.1]), turned(Pose::at(place), turn));
        let mut solver = tolerance(1e-4);
        let sum = |p: &[Overlap]| {
            p.iter().fold((0.0, Vector::zeros()), |(v, s), o| (v + o.volume, s + o.gradient))
        };
        let patches = solver.solve(a, &at_a, b, &at_b).unwrap();
        let (volume, gradient) = sum(patches);
        // What the gradients of several regions, or of sides of one, leave of one another may be small.
        let area = patches.iter().map(|o| o.gradient.norm()).sum::<f64>() + volume.cbrt().powi(2);
        let (swapped, other) = sum(solver.solve(b, &at_b, a, &at_a).unwrap());
        // Both are only asked for to 1e-4.
        prop_assert!((volume - swapped).abs() < 2e-4 * volume.max(1e-3), "{} {}", volume, swapped);
        prop_assert!((gradient + other).norm() < 2e-2 * area.max(0.05));
        let all = turned(at(3.0, -2.0, 7.0), [1.0, 0.5, -0.7]);
        let moved = |p: &Pose| Pose {
            position: all.to_world(p.position),
            orientation: all.orientation * p.orientation,
        };
        let (same, along) = sum(solver.solve(a, &moved(&at_a), b, &moved(&at_b)).unwrap());
        prop_assert!((volume - same).abs() < 4e-4 * volume.max(1e-3), "{} {}", volume, same);
        let off = (all.orientation * gradient - along).norm();
        prop_assert!(off < 2e-2 * area.max(0.05), "{} {:?}", off, gradient);
        // ∂V/∂x by differences.
        let h = 1e-2;
        let push = |s: f64| Pose { position: at_a.position + Vector::new(0.0, s, 0.0), ..at_a };
        let [up, down] = [h, -h].map(|s| sum(tolerance(1e-5).solve(a, &push(s), b, &at_b).unwrap()).0);
        prop_assert!((0.5 * (up - down) / h - gradient.y).abs() < 0.02 * area.max(0.05));
    }
}

#[test]
fn a_route_asked_for_is_taken_for_spheres_too() {
    let ball = crate::Sphere::new(1.0).unwrap();
    let [here, there] = [Pose::at([0.0; 3]), Pose::at([1.5, 0.0, 0.0])];
    let mut solver = solver(Refinement::Levels(1));
    let volume = solver.solve(&ball, &here, &ball, &there).unwrap()[0].volume;
    assert!(solver.boxes().next().is_some());
    let exact = OverlapSolver::new().solve(&ball, &here, &ball, &there).unwrap()[0].volume;
    assert!((volume / exact - 1.0).abs() > 1e-6, "one level cannot be exact: {volume} and {exact}");
    let refused =
        OverlapSolver::new().with_route(Some(Route::Clip)).solve(&ball, &here, &ball, &there).map(<[_]>::len);
    assert!(refused.is_err());
}
