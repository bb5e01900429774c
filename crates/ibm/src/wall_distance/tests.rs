use super::*;
use crate::testing::{Ball, Balls, Brick, Faceted};
use interfaces::{Nodes, Point, Rotation, Solid};
use proptest::prelude::*;

/// A shape that keeps its promise and nothing more: beyond the band it tells the band.
struct Banded<S>(S);

impl<S: Solid> Solid for Banded<S> {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        let d = self.0.signed_distance(x, f64::INFINITY);
        if d.abs() < band { d } else { band.copysign(d) }
    }
    fn aabb(&self) -> Aabb {
        self.0.aabb()
    }
}

/// An axis of `n` cells from −1 to 2, the widest twice the narrowest.
fn axis(n: usize, periodic: bool, stretched: bool) -> Nodes {
    let wave = if stretched { 0.33 } else { 0.0 };
    let mut faces: Vec<f64> = vec![0.0];
    for i in 0..n {
        faces.push(faces[i] + 1.0 + wave * (0.4 * i as f64).sin());
    }
    let scale = 3.0 / faces[n];
    let faces: Vec<f64> = faces.iter().map(|x| x * scale - 1.0).collect();
    if stretched {
        Nodes::centres(&faces, periodic)
    } else {
        Nodes::uniform(1.5 / n as f64 - 1.0, 3.0 / n as f64, n, periodic)
    }
}

/// Not a multiple of the blocks along any axis, and stored anyhow.
fn lattice(dim: usize, periodic: [bool; 3], stretched: bool) -> Lattice {
    let axis = |a: usize, n| axis(n, periodic[a], stretched && a != 1);
    if dim == 2 {
        Lattice::new([axis(0, 37), axis(1, 45)], 7, [1, 99])
    } else {
        Lattice::new([axis(0, 13), axis(1, 9), axis(2, 18)], 3, [1, 40, 1000])
    }
}

/// All distances by asking everybody.
fn asked(lattice: &Lattice, bodies: &Balls, walls: [[bool; 2]; 3]) -> Vec<f64> {
    let [nx, ny, nz] = lattice.shape();
    let turns = |a: usize| if a < lattice.dim && lattice.axes[a].is_periodic() { -2..=2 } else { 0..=0 };
    let mut shifts = Vec::new();
    for k in turns(2) {
        for j in turns(1) {
            shifts.extend(turns(0).map(|i| 3.0 * Vector::new(f64::from(i), f64::from(j), f64::from(k))));
        }
    }
    (0..nx * ny * nz)
        .map(|c| {
            let x = Point::from(lattice.position([c % nx, c / nx % ny, c / (nx * ny)].map(|i| i as isize)));
            let mut least = f64::INFINITY;
            for a in 0..lattice.dim {
                for (wall, at) in walls[a].into_iter().zip([-1.0, 2.0]) {
                    least = if wall { least.min((x[a] - at).abs()) } else { least };
                }
            }
            for b in (0..bodies.poses.len()).map(BodyId) {
                for shift in &shifts {
                    let x = bodies.poses[b.0].to_body(x - shift);
                    least = least.min(bodies.solid(b).signed_distance(x, f64::INFINITY));
                }
            }
            least.max(0.0)
        })
        .collect()
}

fn differ(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let apart = |(a, b): (&f64, &f64)| if a == b { 0.0 } else { (a - b).abs() };
    found.iter().zip(expected).map(apart).fold(0.0, f64::max)
}

fn pose(at: [f64; 3], turn: [f64; 3]) -> Pose {
    Pose { position: at.into(), orientation: Rotation::from_euler_angles(turn[0], turn[1], turn[2]) }
}

fn shape(dim: usize, round: bool) -> Box<dyn Solid> {
    match (dim, round) {
        (2, true) => Box::new(Ball { dim: 2, radius: 0.31 }),
        (2, false) => Box::new(Banded(Brick([0.7, 0.2, 0.0]))),
        (_, true) => Box::new(Banded(Ball { dim: 3, radius: 0.43 })),
        (_, false) => Box::new(Brick([0.6, 0.13, 0.4])),
    }
}

/// Places and turns of up to five bodies, some of them outside of the box.
fn places() -> impl Strategy<Value = Vec<([f64; 3], [f64; 3])>> {
    let place = (prop::array::uniform3(-1.9..2.9_f64), prop::array::uniform3(-3.0..3.0_f64));
    prop::collection::vec(place, 0..6)
}

/// In the plane bodies only turn in it.
fn posed(dim: usize, (mut at, mut turn): ([f64; 3], [f64; 3])) -> Pose {
    if dim == 2 {
        (at[2], turn[0], turn[1]) = (0.0, 0.0, 0.0);
    }
    pose(at, turn)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]
    /// To round-off what brute force finds, whatever is where; also when bodies then move, come or go.
    #[test]
    fn distances_are_exact(
        dim in 2..4_usize,
        periodic in prop::array::uniform3(any::<bool>()),
        walls in prop::array::uniform3(prop::array::uniform2(any::<bool>())),
        stretched: bool,
        round: bool,
        bodies in places(),
        then in places(),
    ) {
        let lattice = lattice(dim, periodic, stretched);
        let walls = std::array::from_fn(|a| if a < dim && !periodic[a] { walls[a] } else { [false; 2] });
        let of = |places: Vec<_>| Balls::boxed(shape(dim, round), 1.0, places.into_iter().map(|p| posed(dim, p)).collect());
        let (bodies, then) = (of(bodies), of(then));
        let mut distance = WallDistance::new().with_walls(walls);
        distance.update(&lattice, &bodies).unwrap();
        prop_assert!(differ(distance.values(), &asked(&lattice, &bodies, walls)) < 1e-13);
        // One body moves a little; then everything is different.
        let mut moved = of(Vec::new());
        moved.poses.clone_from(&bodies.poses);
        if let Some(pose) = moved.poses.last_mut() {
            pose.position.x += 0.07;
        }
        for bodies in [moved, then] {
            distance.update(&lattice, &bodies).unwrap();
            let mut fresh = WallDistance::new().with_walls(walls);
            fresh.update(&lattice, &bodies).unwrap();
            prop_assert!(distance.values() == fresh.values());
            prop_assert!(differ(distance.values(), &asked(&lattice, &bodies, walls)) < 1e-13);
        }
    }
}

#[test]
fn facets_are_asked_as_far_as_it_takes() {
    let mesh = Faceted::sphere(0.3, 0);
    let bodies =
        Balls::of(mesh, 0.1, vec![Pose::at([-0.8, 0.3, 1.7]), pose([1.3, 1.5, 0.2], [0.3, 0.4, 0.5])]);
    let lattice = lattice(3, [true, false, true], true);
    let mut distance = WallDistance::new();
    distance.update(&lattice, &bodies).unwrap();
    let expected = asked(&lattice, &bodies, Default::default());
    assert!(differ(distance.values(), &expected) < 1e-13);
    assert!(expected.iter().any(|d| *d > 1.0) && expected.contains(&0.0));
}

/// Bodies at rest cost nothing; of a crowd, one that moves costs what is around it.
#[test]
fn only_what_moved_is_computed_again() {
    let axis = || Nodes::uniform(-0.9875, 0.025, 120, true);
    let lattice = Lattice::new([axis(), axis()], 0, [1, 120]);
    let centres = (0..36).map(|i| [0.5 * f64::from(i % 6) - 0.8, 0.5 * f64::from(i / 6) - 0.8, 0.0]);
    let mut bodies = Balls::new(2, 0.15, centres.collect());
    let mut distance = WallDistance::new();
    distance.update(&lattice, &bodies).unwrap();
    let all = distance.updates();
    assert!(all == 14_400);
    distance.update(&lattice, &bodies).unwrap();
    assert_eq!(distance.updates(), all);
    bodies.shift(14, Vector::new(0.04, -0.02, 0.0));
    distance.update(&lattice, &bodies).unwrap();
    let again = distance.updates() - all;
    // A body's own share is 400 cells; blocks are 8 by 8.
    assert!((400..1600).contains(&again), "{again}");
    assert!(differ(distance.values(), &asked(&lattice, &bodies, Default::default())) < 1e-13);
}

#[test]
fn without_walls_it_is_infinite_and_bad_input_is_named() {
    let (open, none) = (lattice(3, [false; 3], false), Balls::new(3, 0.2, vec![]));
    let mut distance = WallDistance::new();
    distance.update(&open, &none).unwrap();
    assert!(distance.values().len() == 13 * 9 * 18 && distance.values().iter().all(|d| *d == f64::INFINITY));
    let periodic = lattice(2, [false, true, false], false);
    for (walls, axis) in
        [([[false; 2], [true, false], [false; 2]], 1), ([[false; 2], [false; 2], [false, true]], 2)]
    {
        let error = WallDistance::new().with_walls(walls).update(&periodic, &none).unwrap_err();
        assert_eq!(error, IbmError::NoSide { axis });
    }
    // What was known before stays.
    let mut bodies = Balls::new(2, 0.2, vec![[0.0; 3]]);
    distance.update(&periodic, &bodies).unwrap();
    let before = distance.values().to_vec();
    bodies.poses[0].position.x = f64::NAN;
    assert!(matches!(distance.update(&periodic, &bodies), Err(IbmError::Lost { body: BodyId(0), .. })));
    let long = Balls::new(2, 1.6, vec![[0.0; 3]]);
    assert!(matches!(distance.update(&periodic, &long), Err(IbmError::TooLarge { axis: 1, .. })));
    assert_eq!(distance.values(), before);
}
