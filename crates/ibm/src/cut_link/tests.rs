mod random_walls;

use super::*;
use crate::testing::{Balls, Brick, Staggered};
use interfaces::{CutFace, Kinematics, Pose};
use proptest::prelude::*;

/// Nodes along an edge, or one axis of a face, that the exact mean velocities are summed over.
const POINTS: usize = 40;

/// The mean velocity over the face of the node at `x`.
fn exact(u: &dyn Fn([f64; 3]) -> [f64; 3], x: [f64; 3], c: usize, h: f64, dim: usize) -> f64 {
    let points = if dim == 2 { POINTS * POINTS } else { POINTS };
    let place = |i: usize| h * ((i as f64 + 0.5) / points as f64 - 0.5);
    let axes = [(c + 1) % dim, (c + 2) % dim];
    let count = if dim == 2 { points } else { points * points };
    let sum: f64 = (0..count)
        .map(|i| {
            let mut x = x;
            x[axes[0]] += place(i % points);
            if dim == 3 {
                x[axes[1]] += place(i / points);
            }
            u(x)[c]
        })
        .sum();
    sum / count as f64
}

/// The worst error of the mean velocities over the cut faces of a ball in a flow round the axis z that is quadratic in the
/// distance from it; the ball itself may turn.
fn worst_flux(dim: usize, n: usize, turning: f64) -> f64 {
    let (h, radius, centre) = (4.0 / n as f64, 1.0, [2.013, 1.971, if dim == 2 { 0.0 } else { 2.04 }]);
    let mut bodies = Balls::new(dim, radius, vec![centre]);
    bodies.twists[0].angular.z = turning;
    let mut field =
        if dim == 2 { Staggered::new([n, n], h, [0.0; 2]) } else { Staggered::new([n; 3], h, [0.0; 3]) };
    let u = |x: [f64; 3]| {
        let r = Vector::from(x) - Vector::from(centre);
        let d = r.norm() - radius;
        let speed = turning + if d > 0.0 { d * (3.0 - d) } else { 0.0 };
        [-r.y * speed, r.x * speed, 0.0]
    };
    field.set(u);
    let walls = cut_walls(&field, &bodies).unwrap();
    let error = |c: usize, face: &CutFace| {
        let lattice = field.lattice(c);
        let mean = exact(&u, lattice.position(lattice.node(face.index)), c, h, dim);
        (face.mean_velocity(field.component(c)) - mean).abs()
    };
    (0..dim).flat_map(|c| walls.components[c].faces.iter().map(move |f| error(c, f))).fold(0.0, f64::max)
}

#[test]
fn fluxes_are_second_order() {
    for turning in [0.0, 1.0] {
        let errors = [20, 40, 80, 160].map(|n| worst_flux(2, n, turning));
        // (h/8)², h the cell.
        assert!(errors[0] < 0.2_f64.powi(2) / 6.0 && errors[3] < errors[0] / 40.0, "{errors:?}");
        let errors = [16, 32, 64].map(|n| worst_flux(3, n, turning));
        assert!(errors[2] < errors[0] / 12.0, "{errors:?}");
    }
}

/// Links meet the surface where it is; those that graze it end farther in, but less deep than their node inside.
#[test]
fn links_end_at_the_wall() {
    let (h, radius, centre) = (0.1, 1.0, [2.013, 1.971, 0.0]);
    let bodies = Balls::new(2, radius, vec![centre]);
    let field = Staggered::new([40, 40], h, [0.0; 2]);
    let walls = cut_walls(&field, &bodies).unwrap();
    let mut found = 0;
    for c in 0..2 {
        for node in &walls.components[c].links {
            for (a, side) in (0..2).flat_map(|a| [(a, 0), (a, 1)]) {
                let Some(link) = node.links[a][side] else { continue };
                let place = |fraction: f64| {
                    let mut at = node.arm;
                    at[a] += fraction * h * (2.0 * side as f64 - 1.0);
                    at.norm() - radius
                };
                let (wall, inside) = (place(link.fraction), place(1.0));
                let steep = (place(0.0) - inside).abs() > 0.5 * h;
                assert!(
                    wall.abs() < if steep { 1e-5 * h } else { 0.1 * inside.abs().max(1e-7 * h) },
                    "{wall} {inside}"
                );
                found += 1;
            }
        }
    }
    // The circle crosses 40 lines of either lattice twice, less those it does not reach.
    assert_eq!(found, 2 * 2 * 2 * 20);
}

/// What is inside two bodies counts once, and the number of solid nodes is their volume.
#[test]
fn bodies_may_overlap_and_cross_periodic_sides() {
    let area = |centres: Vec<[f64; 3]>| {
        let bodies = Balls::new(2, 0.8, centres);
        let walls = cut_walls(&Staggered::new([100, 100], 0.04, [0.0; 2]), &bodies).unwrap();
        let mut indices: Vec<usize> = walls.components[0].solid.iter().map(|s| s.index).collect();
        let count = indices.len();
        indices.dedup();
        assert_eq!(indices.len(), count, "a node counts twice");
        count as f64 * 0.04 * 0.04
    };
    let disc = std::f64::consts::PI * 0.64;
    assert!((area(vec![[2.0, 2.0, 0.0]]) / disc - 1.0).abs() < 0.01);
    assert!((area(vec![[3.9, 0.1, 0.0]]) / disc - 1.0).abs() < 0.01);
    assert!((area(vec![[3.9, 0.1, 0.0], [-0.1, 4.1, 0.0]]) / disc - 1.0).abs() < 0.01);
}

#[test]
fn a_body_that_no_node_sees_is_an_error() {
    let field = Staggered::new([40, 40], 0.1, [0.0; 2]);
    let speck = Balls::new(2, 0.01, vec![[2.02, 2.02, 0.0]]);
    match cut_walls(&field, &speck) {
        Err(IbmError::Unseen { body, size, .. }) => assert!(body == BodyId(0) && (size - 0.02).abs() < 1e-12),
        other => panic!("{other:?}"),
    }
    // A plate as thick as a cell has nodes inside, wherever it stands.
    for shift in [0.0, 0.013, 0.05, 0.071] {
        let plate = Balls::of(Brick([0.0501, 1.0, 0.0]), 0.2, vec![Pose::at([2.0 + shift, 2.0, 0.0])]);
        assert!(cut_walls(&field, &plate).is_ok(), "{shift}");
    }
}

proptest! {
    /// Fluid and solid that move alike: every face carries that velocity, however it is cut.
    #[test]
    fn a_common_motion_passes_all_faces(
        x in 0.0..4.0_f64, y in 0.0..4.0_f64, z in 0.0..4.0_f64, radius in 0.3..1.5_f64, angle in 0.0..3.0_f64,
        speed in proptest::array::uniform3(-1.0..1.0_f64), dim in 2..4_usize,
    ) {
        let plane = if dim == 2 { 0.0 } else { 1.0 };
        let mut pose = Pose::at([x, y, plane * z]);
        pose.orientation = interfaces::Rotation::from_scaled_axis(Vector::new(plane * angle, 0.3 * plane, angle));
        let ball = Balls::new(dim, radius, vec![[x, y, plane * z]]);
        let brick = Balls::of(Brick([radius, 0.6, 0.7 * plane]), 1.0, vec![pose]);
        for mut bodies in [ball, brick] {
            prop_assume!(bodies.aabb(BodyId(0)).extent().max() < 4.0);
            bodies.twists[0].linear = Vector::from(speed);
            let mut field =
                if dim == 2 { Staggered::new([20; 2], 0.2, [0.0; 2]) } else { Staggered::new([20; 3], 0.2, [0.0; 3]) };
            field.set(|_| speed);
            let walls = cut_walls(&field, &bodies).unwrap();
            for c in 0..dim {
                for face in &walls.components[c].faces {
                    prop_assert!((0.0..1.0).contains(&face.open), "{face:?}");
                    let mean = face.mean_velocity(field.component(c));
                    prop_assert!((mean - speed[c]).abs() < 1e-12, "{mean} {face:?}");
                }
                for link in walls.components[c].links.iter().flat_map(|n| n.links.into_iter().flatten().flatten()) {
                    prop_assert!(link.fraction > 0.0 && link.fraction <= 1.0 && (link.velocity - speed[c]).abs() < 1e-12);
                }
            }
            prop_assert_eq!(bodies.n_bodies(), walls.n_bodies);
        }
    }
}

/// A surface that turns about a body at rest cuts links and faces as a body that turns does; only the inside stands still, where
/// nobody asks how the surface moves.
#[test]
fn surfaces_may_move_by_themselves() {
    let mut bodies = Balls::new(2, 0.7, vec![[1.013, 0.971, 0.0]]);
    let field = Staggered::new([20; 2], 0.1, [0.0; 2]);
    bodies.twists[0].angular.z = 0.7;
    let turning = cut_walls(&field, &bodies).unwrap();
    let twist = std::mem::take(&mut bodies.twists[0]);
    bodies.motion = Some(Box::new(move |arm| {
        assert!(arm.norm() > 0.5, "{arm}");
        twist.at(arm)
    }));
    let sliding = cut_walls(&field, &bodies).unwrap();
    let mut moved = 0;
    for (a, b) in turning.components.iter().zip(&sliding.components).take(2) {
        assert!(a.links == b.links);
        moved += a
            .links
            .iter()
            .flat_map(|n| n.links.iter().flatten().flatten())
            .filter(|l| l.velocity != 0.0)
            .count();
        assert!(a.faces.iter().zip(&b.faces).all(|(a, b)| a == b || b.open == 0.0 && b.constant == 0.0));
        assert!(a.faces.iter().zip(&b.faces).filter(|(a, b)| a != b).count() < a.faces.len() - 40);
        assert!(b.solid.iter().all(|point| point.velocity == 0.0));
    }
    assert!(moved > 40, "{moved}");
}

/// Bodies that are symmetric to the grid, with surfaces through nodes, edges and corners: size along an axis, and a turn about z.
fn symmetric_bodies(dim: usize) -> Vec<Balls> {
    let z = if dim == 2 { 0.0 } else { 1.0 };
    let turned = |angle: f64| {
        let mut pose = Pose::at([1.0, 1.0, z]);
        pose.orientation = interfaces::Rotation::from_scaled_axis(Vector::z() * angle.to_radians());
        vec![pose]
    };
    let diagonal = 0.5_f64.sqrt();
    let balls = [0.5, 0.45, 0.25 * 5.0_f64.sqrt(), 0.5 * 2.0_f64.sqrt()]
        .map(|r| Balls::new(dim, r, vec![[1.0, 1.0, z]]));
    let bricks = [[0.5, 0.0], [0.45, 0.0], [0.4 * diagonal, 45.0], [0.5 * diagonal, 45.0], [0.55, 90.0]]
        .map(|[half, angle]| Balls::of(Brick([half, half, z * half]), 1.0, turned(angle)));
    let mut all: Vec<Balls> = balls.into_iter().chain(bricks).collect();
    if dim == 3 {
        all.push(Balls::of(crate::testing::Faceted::sphere(0.5, 1), 1.0, turned(0.0)));
    }
    all
}

/// Sides of 20 cells over 2 m; stretched, symmetric to the middle.
fn twenty_cells(stretched: bool) -> Vec<f64> {
    let place = |i: i32| {
        let s = f64::from(i) / 10.0 - 1.0;
        1.0 + if stretched { s * (0.7 + 0.3 * s * s) } else { s }
    };
    (0..=20).map(place).collect()
}

/// Cuts of bodies that are symmetric to the grid are symmetric to round-off, whatever round-off does to the distances of nodes on their surface.
#[test]
fn cuts_of_symmetric_bodies_are_symmetric() {
    for (dim, stretched) in [(2, false), (2, true), (3, false), (3, true)] {
        let sides = twenty_cells(stretched);
        let field =
            if dim == 2 { Staggered::between([&sides[..]; 2]) } else { Staggered::between([&sides[..]; 3]) };
        for (b, bodies) in symmetric_bodies(dim).iter().enumerate() {
            let walls = cut_walls(&field, bodies).unwrap();
            for (c, a) in (0..dim).flat_map(|c| (0..dim).map(move |a| (c, a))) {
                let lattice = field.lattice(c);
                let mirror = |index: usize| {
                    let mut node = lattice.node(index);
                    node[a] = lattice.axes[a].len() as isize - 1 - node[a];
                    lattice.index(node).unwrap()
                };
                let faces: std::collections::HashMap<usize, &CutFace> =
                    walls.components[c].faces.iter().map(|f| (f.index, f)).collect();
                let weights = |face: &CutFace, place: &dyn Fn(usize) -> usize| {
                    let mut sum = std::collections::BTreeMap::new();
                    face.terms
                        .iter()
                        .filter(|t| t.1.abs() > 1e-9)
                        .for_each(|&(i, w)| *sum.entry(place(i)).or_insert(0.0) += w);
                    sum
                };
                for face in faces.values() {
                    let at = format!("{dim} {stretched} body {b} component {c} axis {a}: {face:?}");
                    let other = faces.get(&mirror(face.index)).unwrap_or_else(|| panic!("{at}"));
                    assert!((face.open - other.open).abs() < 1e-9, "{at} {other:?}");
                    let (here, there) = (weights(face, &mirror), weights(other, &|i| i));
                    assert!(here.keys().eq(there.keys()), "{at} {other:?}");
                    assert!(here.iter().all(|(i, w)| (w - there[i]).abs() < 1e-9), "{at} {other:?}");
                }
                let links: std::collections::HashMap<usize, _> =
                    walls.components[c].links.iter().map(|n| (n.index, n.links)).collect();
                for (&index, own) in &links {
                    let mut other = links[&mirror(index)];
                    other[a].swap(0, 1);
                    for (p, q) in own.iter().flatten().zip(other.iter().flatten()) {
                        let same = match (p, q) {
                            (Some(p), Some(q)) => (p.fraction - q.fraction).abs() < 1e-9,
                            (p, q) => p.is_none() && q.is_none(),
                        };
                        assert!(same, "{dim} {stretched} body {b} component {c} axis {a}: {own:?} {other:?}");
                    }
                }
            }
        }
    }
}

/// Fluxes of a given flow around a ball do not jump where its surface comes to nodes and corners: radii that differ by 6·10⁻⁶ cells.
#[test]
fn fluxes_are_continuous_in_the_place_of_the_wall() {
    for dim in [2, 3] {
        let sides = twenty_cells(false);
        let z = if dim == 2 { 0.0 } else { 1.0 };
        let fluxes = |r: f64| -> Vec<f64> {
            let mut field = if dim == 2 {
                Staggered::between([&sides[..]; 2])
            } else {
                Staggered::between([&sides[..]; 3])
            };
            field.set(|x| {
                let q = Vector::new(x[0] - 1.0, x[1] - 1.0, x[2] - z);
                let d = (q.norm() - r).max(0.0);
                [d * (3.0 - d) * q.y, -d * (2.0 + d * d) * q.x, d * q.x * q.y]
            });
            let walls = cut_walls(&field, &Balls::new(dim, r, vec![[1.0, 1.0, z]])).unwrap();
            let component = |c: usize| {
                let mut all = field.component(c).to_vec();
                for face in &walls.components[c].faces {
                    all[face.index] = face.mean_velocity(field.component(c));
                }
                all
            };
            (0..dim).flat_map(component).collect()
        };
        let step = 3e-7;
        for r in [0.5, 0.45, 0.25 * 5.0_f64.sqrt(), 0.4 * 2.0_f64.sqrt()] {
            let [below, above] = [r - step, r + step].map(fluxes);
            let jump = below.iter().zip(&above).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            // The velocity changes by 2 · 3 times the step, in a chord that the circle cuts off by its root.
            assert!(jump < 40.0 * step, "{dim} {r} {jump:e}");
        }
    }
}

/// A box whose faces lie along lines of the grid, a little larger and a little smaller: its links end at the same places, or at nodes that are on its
/// surface. (Without that the drag of a square of 10 cells changes by 7 %.)
#[test]
fn links_along_a_face_are_continuous() {
    let sides = twenty_cells(false);
    let field = Staggered::between([&sides[..]; 2]);
    let shares = |half: f64| {
        let body = Balls::of(Brick([half, half, 0.0]), 1.0, vec![Pose::at([1.0, 1.0, 0.0])]);
        let walls = cut_walls(&field, &body).unwrap();
        // Second differences of 1 at every node in the fluid and 0 on the wall, in units of the cell.
        let mut all = vec![0.0; 2 * 20 * 20];
        for c in 0..2 {
            let solid: std::collections::HashSet<usize> =
                walls.components[c].solid.iter().map(|s| s.index).collect();
            // Nodes within 10⁻⁵ cells of the surface have its velocity.
            let lattice = field.lattice(c);
            let held = |index: usize| {
                let x = lattice.position(lattice.node(index));
                solid.contains(&index) || (0..2).all(|a| (x[a] - 1.0).abs() < half + 1e-5)
            };
            for node in walls.components[c].links.iter().filter(|node| !held(node.index)) {
                for (a, side) in (0..2).flat_map(|a| [(a, 0), (a, 1)]) {
                    if let Some(link) = node.links[a][side] {
                        all[400 * c + node.index] += 1.0 / link.fraction;
                    }
                }
            }
            for index in (0..field.component(c).len()).filter(|&index| !held(index)) {
                let at = lattice.node(index);
                for (a, side) in (0..2).flat_map(|a| [(a, -1), (a, 1)]) {
                    let mut next = at;
                    next[a] += side;
                    if lattice.index(next).is_some_and(|next| held(next) && !solid.contains(&next)) {
                        all[400 * c + index] += 1.0;
                    }
                }
            }
        }
        all
    };
    for half in [0.5, 0.45] {
        let [below, above] = [half - 4e-7, half + 4e-7].map(shares);
        let jump = below.iter().zip(&above).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(jump < 1e-3, "{half} {jump}");
    }
}
