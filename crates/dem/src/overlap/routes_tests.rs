//! Independent routes to the same overlap, and bodies of very different sizes.
use super::{CellOverlap, Overlap, OverlapSolver, Refinement, Route, overlap};
use crate::{ConvexPolyhedron, Cuboid, DemError, Ellipsoid, HalfSpace, Shape, Sphere};
use approx::assert_relative_eq;
use interfaces::{Aabb, Cell, MeshGeometry, Point, Pose, Rotation, Solid, Vector};
use proptest::prelude::*;

fn by(route: Route, a: &dyn Shape, at_a: &Pose, b: &dyn Shape, at_b: &Pose) -> Option<Overlap> {
    let mut solver = OverlapSolver::new()
        .with_route(Some(route))
        .with_tolerance(1e-10)
        .with_refinement(Refinement::Tolerance(1e-3));
    solver.solve(a, at_a, b, at_b).unwrap().first().copied()
}
fn pose(at: [f64; 3], turn: [f64; 3]) -> Pose {
    Pose { position: at.into(), orientation: Rotation::from_scaled_axis(turn.into()) }
}
fn volume(o: &Option<Overlap>) -> f64 {
    o.map_or(0.0, |o| o.volume)
}

/// Cells of edge `h` that fill space.
struct Grid(f64);

impl MeshGeometry for Grid {
    fn for_cells_in(&self, region: &Aabb, mut see: impl FnMut(&Cell)) {
        let ends = [region.min, region.max].map(|x| x.coords.map(|x| (x / self.0).floor() as i64));
        for i in ends[0].x..=ends[1].x {
            for j in ends[0].y..=ends[1].y {
                for k in ends[0].z..=ends[1].z {
                    let centre = Point::new(i as f64 + 0.5, j as f64 + 0.5, k as f64 + 0.5) * self.0;
                    see(&Cell { centre, edges: Vector::repeat(self.0), volume: self.0.powi(3) });
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// Formula, curve, columns, tree and cells of a mesh: spheres.
    #[test]
    fn spheres(r in 0.4..2.0f64, share in 0.05..0.95f64, direction in prop::array::uniform3(-1.0..1.0f64)) {
        let direction = Vector::from(direction);
        prop_assume!(direction.norm() > 0.1);
        let [a, b] = [Sphere::new(1.0).unwrap(), Sphere::new(r).unwrap()];
        // From a graze to one inside the other.
        let distance = (1.0 - r).abs() + share * (1.0 + r - (1.0 - r).abs());
        let (here, there) = (Pose::at([0.0; 3]), Pose::at((direction.normalize() * distance).into()));
        let exact = by(Route::ClosedForm, &a, &here, &b, &there).unwrap();
        let least = a.inertia(1.0).volume.min(b.inertia(1.0).volume);
        for (route, tolerance) in [(Route::Curve, 1e-12), (Route::Columns, 1e-8), (Route::Tree, 3e-3)] {
            let found = by(route, &a, &here, &b, &there).unwrap();
            prop_assert!((found.volume - exact.volume).abs() <= tolerance * least, "{route}: {found:?} {exact:?}");
        }
        let found = CellOverlap::new(1).unwrap().overlap(&Grid(0.1), &a, &here, &b, &there).unwrap().unwrap();
        prop_assert!((found.volume - exact.volume).abs() <= 3e-4 * least, "{found:?} {exact:?}");
    }
    /// Ellipsoids against a box: exact by its faces, as they are and cut into triangles; by the tree.
    #[test]
    fn round_bodies_and_faces(
        e in prop::array::uniform3(0.3..1.5f64),
        at in prop::array::uniform3(-1.2..1.2f64),
        turn in prop::array::uniform3(-3.0..3.0f64),
    ) {
        let (round, block) = (Ellipsoid::new(e).unwrap(), Cuboid::new([1.0, 0.8, 1.4]).unwrap());
        let there = pose(at, turn);
        let here = Pose::at([0.0; 3]);
        let exact = by(Route::ClosedForm, &round, &there, &block, &here);
        let tree = by(Route::Tree, &round, &there, &block, &here);
        let least = round.inertia(1.0).volume.min(block.inertia(1.0).volume);
        let faces = block.polyhedron().unwrap();
        let vertices: Vec<[f64; 3]> = faces.vertices.iter().map(|v| (*v).into()).collect();
        let triangles: Vec<Vec<u32>> = faces.faces.iter().map(|f| f.to_vec()).collect();
        let cut = ConvexPolyhedron::new(&vertices, &triangles).unwrap();
        let by_triangles = by(Route::ClosedForm, &round, &there, &cut, &here);
        prop_assert!((volume(&exact) - volume(&by_triangles)).abs() <= 1e-12 * least, "{exact:?} {by_triangles:?}");
        prop_assert!((volume(&exact) - volume(&tree)).abs() <= 5e-3 * least, "{exact:?} {tree:?}");
    }
    /// A wall is a face of a very large box.
    #[test]
    fn walls_and_large_boxes(
        points in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 8..20),
        height in -0.8..0.8f64,
        turn in prop::array::uniform3(-3.0..3.0f64),
    ) {
        let body = ConvexPolyhedron::from_points(&points);
        prop_assume!(body.is_ok());
        let body = body.unwrap();
        let wall = HalfSpace::new(Point::origin(), Vector::z()).unwrap();
        let large = Cuboid::new([8.0; 3]).unwrap();
        let at = pose([0.0, 0.0, height], turn);
        let by_wall = by(Route::ClosedForm, &body, &at, &wall, &Pose::at([0.0; 3]));
        for route in [Route::Clip, Route::Crossings] {
            let by_box = by(route, &body, &at, &large, &Pose::at([0.0, 0.0, -4.0]));
            prop_assert!((volume(&by_wall) - volume(&by_box)).abs() <= 1e-12 * body.volume(), "{route}");
            if let (Some(w), Some(b)) = (by_wall, by_box) && w.volume > 1e-3 * body.volume() {
                prop_assert!((w.gradient - b.gradient).norm() <= 1e-11);
                prop_assert!((w.moment - b.moment).norm() <= 1e-11);
            }
        }
    }
}

/// A ball of which a larger one holds all but a cap: as deep as the balls go, the largest of both distances is the smaller one's.
#[test]
fn all_but_a_cap() {
    let r = 1.869_690_249_513_634_5;
    let [a, b] = [Sphere::new(1.0).unwrap(), Sphere::new(r).unwrap()];
    let distance = (r - 1.0) + 0.124_264_641_945_743_52 * 2.0;
    let (here, there) = (Pose::at([0.0; 3]), Pose::at([0.0, 0.0, -distance]));
    let exact = by(Route::ClosedForm, &a, &here, &b, &there).unwrap();
    let mut solver = OverlapSolver::new().with_route(Some(Route::Tree));
    let found = solver.solve(&a, &here, &b, &there).unwrap();
    assert_eq!(found.len(), 1, "{found:?}");
    assert!((found[0].volume / exact.volume - 1.0).abs() < 1e-3, "{found:?} {exact:?}");
    assert!((found[0].gradient - exact.gradient).norm() < 2e-2, "{found:?} {exact:?}");
}

/// Bodies of 1e-9 m on the face of one of 1e6 m: half of each lies in it, to the last digits.
#[test]
fn a_speck_on_a_mountain() {
    let mountain = Cuboid::new([1e6; 3]).unwrap();
    let below = Pose::at([0.0, 0.0, -5e5]);
    let speck = Cuboid::new([1e-9, 2e-9, 1.5e-9]).unwrap();
    let ball = Sphere::new(1e-9).unwrap();
    let egg = Ellipsoid::new([1e-9, 2e-9, 3e-9]).unwrap();
    let at = pose([3e-9, 1e-9, 0.0], [0.3, -0.2, 0.5]);
    let half = |a: &dyn Shape, route: Option<Route>| {
        for (one, two, swapped) in [(a, &mountain as &dyn Shape, false), (&mountain, a, true)] {
            let (at_one, at_two) = if swapped { (&below, &at) } else { (&at, &below) };
            let mut solver = OverlapSolver::new().with_route(route);
            let found = solver.solve(one, at_one, two, at_two).unwrap();
            let whole = a.inertia(1.0).volume;
            assert_eq!(found.len(), 1);
            assert_relative_eq!(found[0].volume, 0.5 * whole, max_relative = 1e-12);
            let up = if swapped { -Vector::z() } else { Vector::z() };
            assert!((found[0].normal - up).norm() < 1e-12, "{:?}", found[0].normal);
        }
    };
    half(&speck, Some(Route::Clip));
    half(&ball, None);
    half(&egg, None);
    // Crossings take the places of all corners as they are rounded in the smaller one's frame: to ε times the ratio of the sizes.
    let hill = Cuboid::new([1e3; 3]).unwrap();
    let grain = Cuboid::new([1e-3, 2e-3, 1.5e-3]).unwrap();
    let at_grain = pose([3e-3, 1e-3, 0.0], [0.3, -0.2, 0.5]);
    let crossed = by(Route::Crossings, &grain, &at_grain, &hill, &Pose::at([0.0, 0.0, -500.0])).unwrap();
    assert_relative_eq!(crossed.volume, 1.5e-9, max_relative = 1e-9);
    assert!((crossed.normal - Vector::z()).norm() < 1e-9);
    // Anywhere else the places themselves are rounded to 6e-11: never more than that.
    let place = Point::new(123.0, -456.0, 5e5 + 1e-10);
    let found = overlap(&speck, &Pose { position: place, ..at }, &mountain, &Pose::at([0.0; 3])).unwrap();
    let volume: f64 = found.iter().map(|o| o.volume).sum();
    let whole = speck.inertia(1.0).volume;
    assert!((volume / whole - 0.5).abs() < 0.2, "{volume} of {whole}");
}

#[test]
fn routes_that_lead_nowhere() {
    let [ball, block] = [&Sphere::new(1.0).unwrap() as &dyn Shape, &Cuboid::new([1.0; 3]).unwrap()];
    let here = Pose::at([0.0; 3]);
    for (a, b, route) in [
        (ball, ball, Route::Clip),
        (ball, ball, Route::Crossings),
        (ball, block, Route::Clip),
        (ball, block, Route::Curve),
        (block, block, Route::ClosedForm),
        (block, block, Route::Columns),
    ] {
        let found = OverlapSolver::new().with_route(Some(route)).solve(a, &here, b, &here).map(<[_]>::len);
        assert!(matches!(found, Err(DemError::Route { .. })), "{route}: {found:?}");
    }
}
