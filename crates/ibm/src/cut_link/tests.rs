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

/// Links meet the surface where it is.
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
                let mut at = node.arm;
                at[a] += link.fraction * h * (2.0 * side as f64 - 1.0);
                assert!((at.norm() - radius).abs() < 1e-8, "{at:?}");
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
