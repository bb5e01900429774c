use super::*;
use crate::testing::Balls;
use interfaces::Nodes;
use std::f64::consts::TAU;

const H: f64 = 0.05;
const RADIUS: f64 = 0.3;

/// The centres of a periodic box of 2 × 1.
fn centres() -> Lattice {
    let nodes = |n| Nodes::uniform(0.5 * H, H, n, true);
    Lattice::new([nodes(40), nodes(20)], 0, [1, 40])
}

/// Distance of cell `c` from the surface of a disc at `at`, the nearest of its images.
fn distance(lattice: &Lattice, c: usize, at: [f64; 2]) -> f64 {
    let [x, y, _] = lattice.position(lattice.node(c));
    let near = |d: f64, length: f64| d - length * (d / length).round();
    near(x - at[0], 2.0).hypot(near(y - at[1], 1.0)) - RADIUS
}

/// Across a corner of the box: what cells are, how far their rows are, and what surface is theirs.
#[test]
fn rows_and_film_are_where_they_should_be() {
    let (lattice, at) = (centres(), [0.013, 0.978]);
    let bodies = Balls::new(2, RADIUS, vec![[at[0], at[1], 0.0]]);
    let mut near = NearWalls::new();
    assert!(near.place(&lattice, &bodies).unwrap());
    let mut film = vec![None; 800];
    near.film().iter().for_each(|&(cell, row, share)| film[cell] = Some((row, share)));
    let mut rows = vec![None; 800];
    near.rows().iter().enumerate().for_each(|(i, row)| rows[row.cell] = Some((i, *row)));
    for c in 0..800 {
        let d = distance(&lattice, c, at);
        assert_eq!(near.solid().binary_search(&c).is_ok(), d <= 0.0, "{c}: {d}");
        assert!((near.distance()[c] - d.max(0.0)).abs() < 1e-12);
        let from = d / H;
        assert_eq!(rows[c].is_some(), from > 0.0 && from < 2.5, "{c}: {from}");
        if let Some((i, row)) = rows[c] {
            let y = if from < 0.5 { 0.5 * (d + 0.5 * H) } else { d };
            assert!((row.y - y).abs() < 1e-12 && (row.free - (from - 1.5).clamp(0.0, 1.0)).abs() < 1e-9);
            let (number, share) = film[c].unwrap();
            assert!(number == i && (share + row.free - 1.0).abs() < 1e-9, "{share} {}", row.free);
            assert!((row.seen.unwrap().y / (1.5 * H) - 1.0).abs() < 1e-12);
        } else if from > -2.4 && from <= 0.0 {
            let (row, share) = film[c].unwrap();
            // Outside, on the same normal.
            assert!(share == 1.0 && near.rows()[row].y < 1.5 * H);
        } else if !(-2.6..=-2.4).contains(&from) {
            assert!(film[c].is_none());
        }
    }
    let area: f64 = near.rows().iter().map(|row| row.area).sum();
    // That of the parallel surface one cell away.
    assert!((area / (TAU * (RADIUS + H)) - 1.0).abs() < 0.03, "{area}");
}

/// A body that stays changes nothing, and where it came from does not matter.
#[test]
fn only_where_bodies_are_counts() {
    let lattice = centres();
    let mut bodies = Balls::new(2, RADIUS, vec![[0.6, 0.5, 0.0], [1.3, 0.4, 0.0]]);
    let mut near = NearWalls::new();
    near.place(&lattice, &bodies).unwrap();
    assert!(!near.place(&lattice, &bodies).unwrap());
    let before = near.rows().to_vec();
    bodies.shift(0, Vector::new(0.4 * H, -0.3 * H, 0.0));
    assert!(near.place(&lattice, &bodies).unwrap());
    assert_ne!(near.rows(), before);
    let mut fresh = NearWalls::new();
    fresh.place(&lattice, &bodies).unwrap();
    assert_eq!((near.rows(), near.film(), near.solid()), (fresh.rows(), fresh.film(), fresh.solid()));
    bodies.shift(0, Vector::new(-0.4 * H, 0.3 * H, 0.0));
    near.place(&lattice, &bodies).unwrap();
    let same = |(a, b): (&WallRow, &WallRow)| a.cell == b.cell && (a.y - b.y).abs() < 1e-12;
    assert!(near.rows().len() == before.len() && near.rows().iter().zip(&before).all(same));
    let gone = Balls::new(2, RADIUS, vec![]);
    assert!(near.place(&lattice, &gone).unwrap());
    assert!(near.rows().is_empty() && near.solid().is_empty() && near.film().is_empty());
}

/// As a body moves, rows come and go with nothing: the sum of the surface's shares and of the film changes little by little.
#[test]
fn cells_come_and_go_steadily() {
    let lattice = centres();
    let sums = |x: f64| {
        let mut near = NearWalls::new();
        near.place(&lattice, &Balls::new(2, RADIUS, vec![[x, 0.5123, 0.0]])).unwrap();
        let outside = |f: &&(usize, usize, f64)| near.solid().binary_search(&f.0).is_err();
        let area: f64 = near.rows().iter().map(|r| r.area).sum();
        let film: f64 = near.film().iter().filter(outside).map(|f| f.2).sum();
        (area, film + near.solid().len() as f64)
    };
    let mut last = sums(0.7);
    for i in 1..=200 {
        let now = sums(0.7 + 0.01 * H * f64::from(i));
        // Of 120 cells about a hundredth of a cell.
        assert!(
            (now.0 - last.0).abs() < 0.03 * TAU * RADIUS && (now.1 - last.1).abs() < 2.0,
            "{last:?} {now:?}"
        );
        last = now;
    }
}

/// What rows see of a shear flow past a disc that turns and moves, and of k, but for the differences that its normals are.
#[test]
fn rows_see_the_flow() {
    struct Shear([Lattice; 2], [Vec<f64>; 2]);
    impl VelocityField for Shear {
        fn dim(&self) -> usize {
            2
        }
        fn lattice(&self, c: usize) -> &Lattice {
            &self.0[c]
        }
        fn component(&self, c: usize) -> &[f64] {
            &self.1[c]
        }
        fn component_mut(&mut self, c: usize) -> &mut [f64] {
            &mut self.1[c]
        }
    }
    let lattice = centres();
    let faces = |first: [f64; 2]| {
        let nodes = |a: usize, n| Nodes::uniform(first[a], H, n, true);
        Lattice::new([nodes(0, 40), nodes(1, 20)], 0, [1, 40])
    };
    let lattices = [faces([0.0, 0.5 * H]), faces([0.5 * H, 0.0])];
    let values = [0, 1].map(|c: usize| {
        let of = |i| {
            let [x, y, _] = lattices[c].position(lattices[c].node(i));
            if c == 0 { 2.0 * y } else { 0.5 * x }
        };
        (0..800).map(of).collect::<Vec<f64>>()
    });
    let flow = Shear(lattices, values);
    let at = Vector::new(1.013, 0.478, 0.0);
    let mut bodies = Balls::new(2, RADIUS, vec![at.into()]);
    bodies.twists[0].linear = Vector::new(0.3, -0.1, 0.0);
    bodies.twists[0].angular = Vector::new(0.0, 0.0, 1.5);
    let k: Vec<f64> = (0..800).map(|c| lattice.position(lattice.node(c))[0]).collect();
    let mut near = NearWalls::new();
    near.place(&lattice, &bodies).unwrap();
    near.fill(&flow, 1e-3);
    near.fill_k(&k);
    for (row, wall) in near.rows().iter().zip(&near.walls) {
        let seen = row.seen.unwrap();
        let x = at + wall.normal * (RADIUS + seen.y);
        let surface = bodies.twists[0].at(wall.normal * RADIUS);
        let u = Vector::new(2.0 * x.y, 0.5 * x.x, 0.0) - surface;
        let along = (u - wall.normal * wall.normal.dot(&u)).norm();
        assert!((seen.u_t - along).abs() < 1e-6 && (row.shear.unwrap() * seen.y - along).abs() < 1e-6);
        assert!((row.u_t * seen.y / row.y - along).abs() < 1e-6 && row.nu == 1e-3);
        assert_eq!(row.k, k[row.cell]);
        assert!((seen.k - x.x).abs() < 0.6 * H, "{} {}", seen.k, x.x);
    }
    let lost = Balls::new(2, RADIUS, vec![[f64::NAN, 0.0, 0.0]]);
    assert!(matches!(near.place(&lattice, &lost), Err(IbmError::Lost { .. })));
}
