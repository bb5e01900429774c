//! Capsules and cylinders with bodies of flat faces: closed forms, cuts, differences.
use crate::draw::Draw;
use crate::overlap::{Overlap, OverlapSolver, Route};
use crate::{Capsule, ConvexPolyhedron, Cuboid, Cylinder, HalfSpace, Shape};
use approx::assert_relative_eq;
use interfaces::{Point, Pose, Rotation, Vector};
use std::f64::consts::PI;

fn solve(a: &dyn Shape, at_a: &Pose, b: &dyn Shape, at_b: &Pose) -> Vec<Overlap> {
    let mut solver = OverlapSolver::new().with_route(Some(Route::ClosedForm));
    solver.solve(a, at_a, b, at_b).unwrap().to_vec()
}
fn volume(a: &dyn Shape, at_a: &Pose, b: &dyn Shape, at_b: &Pose) -> f64 {
    solve(a, at_a, b, at_b).iter().map(|o| o.volume).sum()
}
fn at(position: [f64; 3]) -> Pose {
    Pose::at(position)
}
/// Random pose around the origin.
fn pose(draw: &mut Draw, reach: f64) -> Pose {
    Pose { position: Point::from(draw.direction() * (reach * draw.next())), orientation: draw.turn() }
}

#[test]
fn upright_and_lying_in_a_box() {
    let (capsule, cylinder) = (Capsule::new(0.5, 2.0).unwrap(), Cylinder::new(0.5, 2.0).unwrap());
    let cube = Cuboid::new([4.0; 3]).unwrap();
    // Standing on its upper face, sunk by 0.2.
    let sunk = at([0.1, 0.3, 3.0 + 0.5 - 0.2]);
    let cap = PI * 0.04 * (0.5 - 0.2 / 3.0);
    assert_relative_eq!(volume(&capsule, &sunk, &cube, &at([0.0; 3])), cap, max_relative = 1e-14);
    let o = solve(&cylinder, &at([0.1, 0.3, 2.8]), &cube, &at([0.0; 3]))[0];
    assert_relative_eq!(o.volume, 0.25 * PI * 0.2, max_relative = 1e-14);
    assert_relative_eq!(o.centroid, Point::new(0.1, 0.3, 1.9), epsilon = 1e-14);
    assert_relative_eq!(o.gradient, Vector::new(0.0, 0.0, -0.25 * PI), epsilon = 1e-14);
    // Lying: a segment of the circle along the straight part, a cap of the ball at the ends.
    let lying = Pose {
        position: Point::new(0.2, 0.1, 2.4),
        orientation: Rotation::from_scaled_axis(Vector::y() * (0.5 * PI)),
    };
    let segment = 0.25 * 0.8f64.acos() - 0.4 * 0.3;
    let cap = PI * 0.01 * (0.5 - 0.1 / 3.0);
    assert_relative_eq!(volume(&cylinder, &lying, &cube, &at([0.0; 3])), 2.0 * segment, max_relative = 1e-12);
    let o = solve(&capsule, &lying, &cube, &at([0.0; 3]))[0];
    assert_relative_eq!(o.volume, 2.0 * segment + cap, max_relative = 1e-12);
    assert_relative_eq!(o.gradient, Vector::new(0.0, 0.0, -(2.0 * 0.6 + PI * 0.09)), epsilon = 1e-12);
    assert_relative_eq!(o.centroid.xy(), Point::new(0.2, 0.1, 0.0).xy(), epsilon = 1e-12);
}

/// All of either within the other, and neither.
#[test]
fn one_within_the_other() {
    let (capsule, cylinder) = (Capsule::new(0.5, 1.0).unwrap(), Cylinder::new(0.5, 1.0).unwrap());
    let (large, small) = (Cuboid::new([5.0; 3]).unwrap(), Cuboid::new([0.2; 3]).unwrap());
    let floor = HalfSpace::new(Point::origin(), Vector::z()).unwrap();
    for tube in [&capsule as &dyn Shape, &cylinder] {
        let whole = tube.inertia(1.0).volume;
        assert_relative_eq!(volume(tube, &at([0.3, 0.2, 0.1]), &large, &at([0.0; 3])), whole);
        assert_relative_eq!(
            volume(tube, &at([0.1, 0.0, 0.2]), &small, &at([0.0; 3])),
            0.008,
            epsilon = 1e-16
        );
        assert!(solve(tube, &at([0.0, 0.0, 9.0]), &large, &at([0.0; 3])).is_empty());
        assert_relative_eq!(volume(tube, &at([0.3, 0.2, -9.0]), &floor, &at([0.0; 3])), whole);
        assert!(solve(tube, &at([0.3, 0.2, 9.0]), &floor, &at([0.0; 3])).is_empty());
    }
}

/// A box cut in two by a plane shares the sum of what its halves share; centres of ends on faces,
/// edges and corners of them included.
#[test]
fn halves_of_a_box_add_up() {
    let whole = Cuboid::new([1.2, 1.0, 0.8]).unwrap();
    let half = Cuboid::new([0.6, 1.0, 0.8]).unwrap();
    let mut draw = Draw(21);
    for round in 0..3000 {
        let (r, l) = (draw.between(0.02, 1.0), draw.between(0.02, 2.0));
        let mut at_a = pose(&mut draw, 0.7);
        if round % 3 == 0 {
            // The centre of an end on a corner of the grid of faces, edges and cuts.
            let grid = Vector::new(0.6, 0.5, 0.4).map(|x| x * ((draw.next() * 3.0).floor() - 1.0));
            let end = at_a.orientation * Vector::new(0.0, 0.0, 0.5 * l);
            at_a.position = Point::from(grid - end);
        }
        let by = pose(&mut draw, 3.0);
        let by = if round % 2 == 0 { at([0.0; 3]) } else { by };
        let moved = |p: Pose| by.of(&p);
        let (capsule, cylinder) = (Capsule::new(r, l).unwrap(), Cylinder::new(r, l).unwrap());
        for tube in [&capsule as &dyn Shape, &cylinder] {
            let with = |b: &dyn Shape, p: Pose| volume(tube, &moved(at_a), b, &moved(p));
            let parts = with(&half, at([0.3, 0.0, 0.0])) + with(&half, at([-0.3, 0.0, 0.0]));
            let all = with(&whole, at([0.0; 3]));
            let scale = tube.inertia(1.0).volume.max(0.96);
            // Ends on edges are moved off by 1e-10 radii.
            let share = if round % 3 == 0 { 3e-10 } else { 1e-12 };
            assert!(
                (all - parts).abs() < share * scale,
                "{all} {parts}, round {round}, r {r}, l {l}, {at_a:?}"
            );
        }
    }
}

/// Gradient and moment are the rates at which the volume changes.
#[test]
fn gradient_and_moment_are_differences() {
    let points: Vec<[f64; 3]> = {
        let mut draw = Draw(4);
        (0..14).map(|_| (draw.direction() * draw.between(0.4, 1.0)).into()).collect()
    };
    let hull = ConvexPolyhedron::from_points(&points).unwrap();
    let mut draw = Draw(31);
    let mut met = 0;
    for _ in 0..300 {
        let (r, l) = (draw.between(0.1, 1.0), draw.between(0.1, 2.0));
        let (capsule, cylinder) = (Capsule::new(r, l).unwrap(), Cylinder::new(r, l).unwrap());
        let (at_a, at_b) = (pose(&mut draw, 1.0), pose(&mut draw, 0.3));
        for tube in [&capsule as &dyn Shape, &cylinder] {
            let found = solve(tube, &at_a, &hull, &at_b);
            let [o] = found[..] else { continue };
            met += 1;
            let h = 1e-4;
            let (way, about) = (draw.direction(), draw.direction());
            let shifted = |s: f64| {
                let moved = Pose { position: at_a.position + way * (s * h), ..at_a };
                volume(tube, &moved, &hull, &at_b)
            };
            let turned = |s: f64| {
                let turn = Rotation::from_scaled_axis(about * (s * h));
                let position = o.centroid + turn * (at_a.position - o.centroid);
                let moved = Pose { position, orientation: turn * at_a.orientation };
                volume(tube, &moved, &hull, &at_b)
            };
            let slope = |v: &dyn Fn(f64) -> f64| (v(1.0) - v(-1.0)) / (2.0 * h);
            assert_relative_eq!(slope(&shifted), o.gradient.dot(&way), epsilon = 3e-5);
            assert_relative_eq!(slope(&turned), o.moment.dot(&about), epsilon = 3e-5);
        }
    }
    assert!(met > 300, "{met}");
}

/// First moments about a plane: the parts of a cut box have the centroid of the whole.
#[test]
fn centroids_of_halves_add_up() {
    let (whole, half) = (Cuboid::new([1.2, 1.0, 0.8]).unwrap(), Cuboid::new([0.6, 1.0, 0.8]).unwrap());
    let mut draw = Draw(41);
    for _ in 0..1000 {
        let (r, l) = (draw.between(0.05, 1.0), draw.between(0.05, 2.0));
        let at_a = pose(&mut draw, 0.7);
        let (capsule, cylinder) = (Capsule::new(r, l).unwrap(), Cylinder::new(r, l).unwrap());
        for tube in [&capsule as &dyn Shape, &cylinder] {
            let first = |b: &dyn Shape, x: f64| -> Vector {
                solve(tube, &at_a, b, &at([x, 0.0, 0.0])).iter().map(|o| o.centroid.coords * o.volume).sum()
            };
            let scale = tube.inertia(1.0).volume.max(0.96);
            let difference = first(&whole, 0.0) - first(&half, 0.3) - first(&half, -0.3);
            assert!(difference.norm() < 1e-12 * scale, "{difference}");
        }
    }
}

/// Shallow contact keeps its digits: a tube lying on a face, by depth.
#[test]
fn shallow_contacts_keep_their_digits() {
    let cube = Cuboid::new([4.0; 3]).unwrap();
    let (capsule, cylinder) = (Capsule::new(0.5, 2.0).unwrap(), Cylinder::new(0.5, 2.0).unwrap());
    for depth in [1e-2, 1e-4, 1e-6] {
        let lying = Pose {
            position: Point::new(0.2, 0.1, 2.5 - depth),
            orientation: Rotation::from_scaled_axis(Vector::y() * (0.5 * PI)),
        };
        // r² (a − sin a cos a) with 1 − cos a = depth/r.
        let half = (0.5 * depth / 0.5f64).sqrt().asin();
        let segment = 0.25 * crate::overlap::slices::segment(2.0 * half);
        let cap = PI * depth * depth * (0.5 - depth / 3.0);
        let relative = 1e-13 / depth;
        let found = volume(&cylinder, &lying, &cube, &at([0.0; 3]));
        assert_relative_eq!(found, 2.0 * segment, max_relative = relative);
        let found = volume(&capsule, &lying, &cube, &at([0.0; 3]));
        assert_relative_eq!(found, 2.0 * segment + cap, max_relative = relative);
    }
}

#[cfg(feature = "mesh")]
mod meshes {
    use super::*;
    use crate::TriangleMesh;
    use nalgebra::{Quaternion, UnitQuaternion};

    /// An L of two square arms, 0.4 thick and high.
    fn angle() -> TriangleMesh {
        let corners = [[-0.4, -0.4], [0.6, -0.4], [0.6, 0.0], [0.0, 0.0], [0.0, 0.6], [-0.4, 0.6]];
        let vertices: Vec<[f64; 3]> =
            [-0.2, 0.2].iter().flat_map(|z| corners.map(|[x, y]| [x, y, *z])).collect();
        let mut faces: Vec<[u32; 3]> = Vec::new();
        for i in 0..6 {
            let j = (i + 1) % 6;
            faces.extend([[i, j, 6 + j], [i, 6 + j, 6 + i]]);
        }
        for [p, q, r] in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
            faces.extend([[p, r, q], [6 + p, 6 + q, 6 + r]]);
        }
        TriangleMesh::new(&vertices, &faces).unwrap()
    }
    fn pose(x: [f64; 3], [w, i, j, k]: [f64; 4]) -> Pose {
        Pose { position: x.into(), orientation: UnitQuaternion::from_quaternion(Quaternion::new(w, i, j, k)) }
    }

    /// Against the sum of both arms by slices and an octree, to the digits that these agree to.
    #[test]
    fn capsules_and_an_angle() {
        let angle = angle();
        let capsule = Capsule::new(0.04474103895, 0.92514346).unwrap();
        let at_a =
            pose([0.02762302, -0.11541816, -0.11349988], [-0.33835419, -0.74575591, 0.52322180, -0.23582617]);
        let at_b =
            pose([-0.00063530, -0.00096419, 0.03327590], [0.65212893, 0.34710796, 0.63362944, -0.22971875]);
        assert_relative_eq!(volume(&capsule, &at_a, &angle, &at_b), 3.612779e-3, max_relative = 3e-5);
        let capsule = Capsule::new(0.0316590833, 0.8272245187).unwrap();
        let at_a =
            pose([-0.05429012, 0.06076095, 0.04016415], [0.60260326, 0.56223162, 0.56632801, -0.00557578]);
        let at_b =
            pose([-0.07816445, 0.16381468, 0.07717580], [-0.46650743, -0.52596867, 0.66685252, 0.24705352]);
        assert_relative_eq!(volume(&capsule, &at_a, &angle, &at_b), 2.573678e-3, max_relative = 3e-5);
    }

    /// A tube across both arms shares a region with each; the sum is that of the arms as boxes.
    #[test]
    fn arms_are_regions_of_their_own() {
        let angle = angle();
        let c = angle.origin();
        let arms = [([1.0, 0.4, 0.4], [0.1, -0.2, 0.0]), ([0.4, 0.6, 0.4], [-0.2, 0.3, 0.0])];
        let mut draw = Draw(51);
        let mut several = 0;
        for _ in 0..2000 {
            let (r, l) = (draw.between(0.02, 0.4), draw.between(0.1, 2.0));
            let at_a = super::pose(&mut draw, 0.6);
            let (capsule, cylinder) = (Capsule::new(r, l).unwrap(), Cylinder::new(r, l).unwrap());
            for tube in [&capsule as &dyn Shape, &cylinder] {
                let regions = solve(tube, &at_a, &angle, &at([0.0; 3]));
                let parts: f64 = arms
                    .iter()
                    .map(|(edges, x)| {
                        let arm = Cuboid::new(*edges).unwrap();
                        volume(tube, &at_a, &arm, &at([x[0] - c.x, x[1] - c.y, x[2] - c.z]))
                    })
                    .sum();
                let all: f64 = regions.iter().map(|o| o.volume).sum();
                assert!((all - parts).abs() < 1e-12, "{all} {parts} r {r} l {l} {at_a:?}");
                several += usize::from(regions.len() > 1);
            }
        }
        assert!(several > 20, "{several}");
    }
}
