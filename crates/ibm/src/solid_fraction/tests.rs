use super::*;
use crate::testing::{Ball, Balls, Brick, Faceted, lattice};
use interfaces::{Aabb, Kinematics, Nodes, Point, Rotation, Solid};
use proptest::prelude::*;
use std::f64::consts::PI;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Σ λ V of all bodies.
fn total(lattice: &Lattice, bodies: &Balls) -> f64 {
    let mut fraction = SolidFraction::new();
    fraction.update(lattice, bodies).unwrap();
    bodies.ids().flat_map(|b| fraction.nodes(b)).map(|n| n.fraction * n.volume).sum()
}

/// Cells along an axis from 0 to 3, the widest 1.6 times the narrowest, 0.1 in the middle.
fn stretched() -> Nodes {
    let mut faces = vec![0.0_f64];
    let mut i = 0;
    while faces[i] < 3.0 {
        faces.push(faces[i] + 0.08 * (1.0 + 0.3 * (2.1 * faces[i]).sin()));
        i += 1;
    }
    let scale = 3.0 / faces[i];
    Nodes::centres(&faces.iter().map(|x| x * scale).collect::<Vec<_>>(), true)
}

fn pose(at: [f64; 3], turn: [f64; 3]) -> Pose {
    Pose { position: at.into(), orientation: Rotation::from_euler_angles(turn[0], turn[1], turn[2]) }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]
    /// Σ λ V is the body's volume within 0.1 % at 10 cells per diameter, wherever it sits, over
    /// periodic sides and corners too.
    #[test]
    fn balls_sum_to_their_volume(x in 0.0..3.0_f64, y in 0.0..3.0_f64, z in 0.0..3.0_f64) {
        let disc = total(&lattice(2, [0.1; 3], 3.0), &Balls::new(2, 0.5, vec![[x, y, 0.0]])) / (PI / 4.0);
        prop_assert!((disc - 1.0).abs() < 1.5e-4, "disc {disc}");
        let sphere = total(&lattice(3, [0.1; 3], 3.0), &Balls::new(3, 0.5, vec![[x, y, z]])) / (PI / 6.0);
        prop_assert!((sphere - 1.0).abs() < 1.5e-4, "sphere {sphere}");
    }

    #[test]
    fn balls_on_stretched_lattices_too(x in 0.0..3.0_f64, y in 0.0..3.0_f64, z in 0.0..3.0_f64) {
        let axis = stretched();
        let n = axis.len();
        let plane = Lattice::new([axis.clone(), axis.clone()], 0, [1, n]);
        let disc = total(&plane, &Balls::new(2, 0.5, vec![[x, y, 0.0]])) / (PI / 4.0);
        prop_assert!((disc - 1.0).abs() < 1e-3, "disc {disc}");
        let space = Lattice::new([axis.clone(), axis.clone(), axis], 0, [1, n, n * n]);
        let sphere = total(&space, &Balls::new(3, 0.5, vec![[x, y, z]])) / (PI / 6.0);
        prop_assert!((sphere - 1.0).abs() < 1e-3, "sphere {sphere}");
    }

    /// Edges and corners: a square and a cube ten cells wide, turned anyhow.
    #[test]
    fn bricks_sum_to_their_volume(
        x in 0.0..3.0_f64, y in 0.0..3.0_f64, z in 0.0..3.0_f64,
        a in -4.0..4.0_f64, b in -4.0..4.0_f64, c in -4.0..4.0_f64,
    ) {
        let square = Balls::of(Brick([0.5, 0.5, 0.0]), 1.0, vec![pose([x, y, 0.0], [0.0, 0.0, c])]);
        let area = total(&lattice(2, [0.1; 3], 3.0), &square);
        prop_assert!((area - 1.0).abs() < 1e-3, "square {area}");
        let cube = Balls::of(Brick([0.5; 3]), 1.0, vec![pose([x, y, z], [a, b, c])]);
        let volume = total(&lattice(3, [0.1; 3], 3.0), &cube);
        prop_assert!((volume - 1.0).abs() < 1e-3, "cube {volume}");
    }

    /// A plate thinner than a cell, and a ball smaller than one.
    #[test]
    fn thin_and_small_bodies_do_not_get_lost(
        x in 0.0..3.0_f64, y in 0.0..3.0_f64, z in 0.0..3.0_f64, turn in -4.0..4.0_f64,
    ) {
        let plate = Balls::of(Brick([0.5, 0.025, 0.5]), 0.05, vec![pose([x, y, z], [turn, 0.3, turn])]);
        let volume = total(&lattice(3, [0.1; 3], 3.0), &plate) / 0.05;
        prop_assert!((volume - 1.0).abs() < 0.02, "plate {volume}");
        let exact = 4.0 / 3.0 * PI * 0.04_f64.powi(3);
        let ball = total(&lattice(3, [0.1; 3], 3.0), &Balls::new(3, 0.04, vec![[x, y, z]])) / exact;
        prop_assert!((ball - 1.0).abs() < 0.1, "ball {ball}");
    }

    /// What a bounded box cuts off is missing: of a brick along the axes, any part of it.
    #[test]
    fn sides_cut_bodies(x in -1.0..4.0_f64, y in -1.0..4.0_f64) {
        let axis = || Nodes::uniform(0.05, 0.1, 30, false);
        let bounded = Lattice::new([axis(), axis()], 0, [1, 30]);
        let brick = Balls::of(Brick([0.5, 0.4, 0.0]), 0.8, vec![Pose::at([x, y, 0.0])]);
        let inside = |c: f64, half: f64| ((c + half).min(3.0) - (c - half).max(0.0)).max(0.0);
        let exact = inside(x, 0.5) * inside(y, 0.4);
        let found = total(&bounded, &brick);
        // Corners are cut into 16 parts along each axis.
        prop_assert!((found - exact).abs() < 8e-4, "{found} {exact}");
    }
}

/// Bodies that drift in from outside through one side, and out through the other.
#[test]
fn bodies_enter_and_leave() {
    let axis = || Nodes::uniform(0.05, 0.1, 30, false);
    let bounded = Lattice::new([axis(), axis(), axis()], 0, [1, 30, 900]);
    let mut bodies = Balls::new(3, 0.5, vec![[-0.7, 1.43, 1.52]]);
    let mut fraction = SolidFraction::new();
    for step in 0..90 {
        fraction.update(&bounded, &bodies).unwrap();
        let found: f64 = fraction.nodes(BodyId(0)).iter().map(|n| n.fraction * n.volume).sum();
        // The ball between the two sides, less what is beyond them.
        let x = bodies.poses[0].position.x;
        let cap = |depth: f64| {
            let h = depth.clamp(0.0, 1.0);
            PI * h * h * (0.5 - h / 3.0)
        };
        let exact = PI / 6.0 - cap(0.5 - x) - cap(x + 0.5 - 3.0);
        assert!((found - exact).abs() < 1e-3 * PI / 6.0, "{x}: {found} {exact}");
        bodies.shift(0, Vector::new(0.051, 0.0, 0.0));
        assert_eq!(fraction.updates(), step + 1);
    }
    assert!(fraction.nodes(BodyId(0)).is_empty() && bodies.poses[0].position.x > 3.5);
}

/// Two bodies that share cells each have their own λ there; together they fill no cell twice.
#[test]
fn two_bodies_in_one_cell() {
    let lattice = lattice(2, [0.1; 3], 3.0);
    // A gap of a quarter of a cell.
    let bodies = Balls::new(2, 0.5, vec![[1.0, 1.0, 0.0], [2.025, 1.0, 0.0]]);
    let mut fraction = SolidFraction::new();
    fraction.update(&lattice, &bodies).unwrap();
    let of = |b: usize| fraction.nodes(BodyId(b)).iter().map(|n| (n.index, n.fraction)).collect::<Vec<_>>();
    let (first, second) = (of(0), of(1));
    let shared: Vec<_> = first.iter().filter(|(i, _)| second.iter().any(|(j, _)| i == j)).collect();
    assert!(!shared.is_empty());
    assert!((total(&lattice, &bodies) / (PI / 2.0) - 1.0).abs() < 1e-3);
    let mut dense = vec![0.0; 900];
    fraction.add_to_dense(&lattice, &mut dense);
    let sum: f64 = dense.iter().sum::<f64>() * 0.01;
    assert!((sum / (PI / 2.0) - 1.0).abs() < 1e-3 && dense.iter().all(|l| *l <= 1.0), "{sum}");
}

/// A bar through the whole period, its ends in one cell, or over one another by less than a cell:
/// each node is there once, and solid across the seam.
#[test]
fn as_long_as_the_period_but_hardly_longer() {
    let lattice = lattice(2, [0.1; 3], 3.0);
    let bar = |half| Balls::of(Brick([half, 0.2, 0.0]), 0.8 * half, vec![Pose::at([0.333, 1.5, 0.0])]);
    for half in [1.495, 1.5, 1.5 + 1e-9, 1.51, 1.55] {
        let (mut fraction, bodies) = (SolidFraction::new(), bar(half));
        fraction.update(&lattice, &bodies).unwrap();
        let nodes = fraction.nodes(BodyId(0));
        assert!(
            (nodes.iter().map(|n| n.fraction * n.volume).sum::<f64>() / 0.4 - half.min(1.5) * 2.0).abs()
                < 3e-3
        );
        let mut seen: Vec<usize> = nodes.iter().map(|n| n.index).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), nodes.len());
        let middle = nodes.iter().filter(|n| n.arm.y.abs() < 0.1);
        let least = middle.fold(1.0, |least: f64, n| least.min(n.fraction));
        assert!(least > if half < 1.5 { 0.89 } else { 1.0 - 1e-7 }, "{half}: {least}");
    }
    let error = SolidFraction::new().update(&lattice, &bar(1.551)).unwrap_err();
    assert!(matches!(error, IbmError::TooLarge { body: BodyId(0), axis: 0, .. }), "{error}");
}

/// The paper's λ: ½ where the surface passes through the centre of a cell, ½(1 − tanh ½) half a cell
/// off, whole and empty where the cut share is.
#[test]
fn the_papers_rule() {
    let lattice = lattice(2, [0.1; 3], 3.0);
    let bodies = Balls::of(Brick([0.5, 0.5, 0.0]), 1.0, vec![Pose::at([1.05, 1.07, 0.0])]);
    let mut fraction = SolidFraction::new().with_rule(FractionRule::Centroid);
    fraction.update(&lattice, &bodies).unwrap();
    let at = |i: usize, j: usize| {
        fraction.nodes(BodyId(0)).iter().find(|n| n.index == i + 30 * j).map_or(0.0, |n| n.fraction)
    };
    assert!((at(5, 10) - 0.5).abs() < 1e-12 && (at(15, 10) - 0.5).abs() < 1e-12);
    // 0.02 inside the upper edge's cell: d = 1.55 − 1.57.
    assert!((at(10, 15) - 0.5 * (1.0 + 0.2_f64.tanh())).abs() < 1e-12);
    assert_eq!((at(10, 10), at(10, 16), at(4, 10)), (1.0, 0.0, 0.0));
}

#[test]
fn a_body_at_rest_is_projected_once() {
    let mut bodies = Balls::new(2, 0.5, vec![[1.0, 1.0, 0.0], [2.0, 2.0, 0.0]]);
    let lattice = lattice(2, [0.1; 3], 3.0);
    let mut fraction = SolidFraction::new();
    for _ in 0..5 {
        fraction.update(&lattice, &bodies).unwrap();
    }
    assert_eq!(fraction.updates(), 2);
    bodies.shift(1, Vector::new(0.05, 0.0, 0.0));
    fraction.update(&lattice, &bodies).unwrap();
    assert_eq!(fraction.updates(), 3);
}

#[test]
fn a_lost_body_is_named() {
    let bodies = Balls::new(2, 0.5, vec![[1.0, f64::NAN, 0.0]]);
    let error = SolidFraction::new().update(&lattice(2, [0.1; 3], 3.0), &bodies).unwrap_err();
    assert!(matches!(error, IbmError::Lost { body: BodyId(0), .. }));
}

/// A ball that counts how many distances it is asked for.
struct Counted {
    ball: Ball,
    asked: Arc<AtomicUsize>,
}

impl Solid for Counted {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        self.asked.fetch_add(1, Relaxed);
        self.ball.signed_distance(x, band)
    }
    fn aabb(&self) -> Aabb {
        self.ball.aabb()
    }
}

/// A sphere of eight cells per diameter is smooth yet: no more than one distance per cell of its box, and its volume is right.
#[test]
fn coarse_balls_need_no_smaller_cells() {
    for n in [8, 9, 12] {
        let h = 1.0 / f64::from(n);
        for i in 0..60 {
            let at = [0.37, 0.71, 0.53].map(|s: f64| 1.5 + h * (s * f64::from(i * i + i + 1)).fract());
            let asked = Arc::new(AtomicUsize::new(0));
            let solid = Counted { ball: Ball { dim: 3, radius: 0.5 }, asked: asked.clone() };
            let bodies = Balls::of(solid, PI / 6.0, vec![Pose::at(at)]);
            let mut fraction = SolidFraction::new();
            fraction.update(&lattice(3, [h; 3], 3.0), &bodies).unwrap();
            let volume: f64 = fraction.nodes(BodyId(0)).iter().map(|n| n.fraction * n.volume).sum();
            assert!((volume / (PI / 6.0) - 1.0).abs() < 1e-4, "{n}: {volume}");
            let box_ = (n as usize + 5).pow(3);
            let asked = asked.load(Relaxed);
            assert!(asked <= box_, "{n}: {asked} of {box_}");
        }
    }
}

/// Layer by layer λ is what it is of all nodes, on equal and other cells, across periodic sides, of balls and of triangles.
#[test]
fn a_layer_is_that_of_the_whole() {
    let axis = stretched();
    let n = axis.len();
    let uneven = Lattice::new([axis.clone(), axis.clone(), axis], 0, [1, n, n * n]);
    let places = [[0.1, 1.4, 2.9], [1.5, 2.95, 1.2], [2.2, 0.7, 0.75]];
    let balls = Balls::new(3, 0.3, places.to_vec());
    let corner = |i: usize| Point::from(std::array::from_fn(|a| if i >> a & 1 == 1 { 0.3 } else { -0.3 }));
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let cube = Faceted::new((0..8).map(corner).collect(), sides.into_iter().flat_map(halves).collect());
    let cubes = Balls::of(cube, 0.216, places.map(|at| pose(at, [0.3, 0.5, 0.7])).to_vec());
    for lattice in [lattice(3, [0.1, 0.1, 0.3], 3.0), uneven] {
        for bodies in [&balls, &cubes] {
            let mut whole = SolidFraction::new();
            whole.update(&lattice, bodies).unwrap();
            for axis in 0..3 {
                let (mut layer, mut found) = (SolidFraction::new(), 0);
                for number in 0..lattice.axes[axis].len() {
                    layer.set_layer(Some((axis, number)));
                    layer.update(&lattice, bodies).unwrap();
                    for b in bodies.ids() {
                        let there = |n: &&SolidNode| lattice.node(n.index)[axis] == number as isize;
                        let expected: Vec<_> = whole.nodes(b).iter().filter(there).copied().collect();
                        assert_eq!(layer.nodes(b), expected, "axis {axis}, layer {number}");
                        found += expected.len();
                    }
                }
                assert_eq!(found, bodies.ids().map(|b| whole.nodes(b).len()).sum::<usize>());
            }
        }
    }
}
