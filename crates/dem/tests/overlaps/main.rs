//! Overlaps of fifteen kinds of bodies keep the errors that the documentation states.
#[path = "../../src/draw.rs"]
mod draw;
mod kinds;
mod poses;
mod quadrature;
mod reference;

use dem::OverlapSolver;
use kinds::KINDS;
use std::collections::HashMap;

/// Poses per pair of kinds.
const POSES: u64 = 12;
/// Largest errors by pairs of words, as the page has them.
fn documented() -> HashMap<[&'static str; 2], f64> {
    let page = include_str!("../../../../docs/overlaps.md");
    let rows = page.lines().filter_map(|line| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let (first, second) = cells.get(1)?.split_once(", ")?;
        Some(([first, second], cells.get(2)?.parse().ok()?))
    });
    rows.collect()
}

/// Word of a kind in the table.
fn word(kind: usize) -> &'static str {
    match KINDS[kind] {
        "sphere" => "sphere",
        "ellipsoid" => "ellipsoid",
        "capsule" => "capsule",
        "cylinder" => "cylinder",
        _ => "flat",
    }
}

#[test]
fn every_pair_keeps_its_documented_error() {
    let table = documented();
    assert_eq!(table.len(), 15);
    let mut solver = OverlapSolver::new();
    let (mut met, mut faults) = (0, Vec::new());
    for (i, j) in (0..KINDS.len()).flat_map(|i| (i..KINDS.len()).map(move |j| (i, j))) {
        let (p, q) = (word(i), word(j));
        let error = *table.get(&[p, q]).or_else(|| table.get(&[q, p])).expect("a row");
        // Edges make S change by as much as the body moves: V − S·dx by its square.
        let step = 0.3 * error.sqrt();
        for case in 0..POSES {
            let (a, b, at_a, at_b) = poses::pose(i, j, 1.0, case);
            let m = poses::measure(&mut solver, step, (&a, &at_a), (&b, &at_b));
            assert!(m.volume <= m.smaller * (1.0 + error), "{m:?}");
            met += usize::from(m.volume > 0.0);
            let sound = m.of_body <= error && m.gradient <= error;
            if !sound {
                faults.push(format!("{} and {}, case {case}: {m:?}", KINDS[i], KINDS[j]));
            }
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
    assert!(met > 700, "{met} pairs met");
}

/// Bodies 1e-4 times as large on the surface of others: coordinates of these round by 1e-12 of the smaller one's size.
#[test]
fn small_bodies_keep_their_digits() {
    let mut solver = OverlapSolver::new();
    let compact = ["box", "hull", "ball of 80 triangles", "L mesh", "U mesh", "ring mesh"];
    let kinds = || (0..KINDS.len()).filter(|k| compact.contains(&KINDS[*k]));
    for (i, j) in kinds().flat_map(|i| kinds().map(move |j| (i, j))) {
        for case in 0..10 {
            let (a, b, at_a, at_b) = poses::pose(i, j, 1e-4, case);
            let m = poses::measure(&mut solver, 1e-4, (&a, &at_a), (&b, &at_b));
            assert!(
                m.of_body < 2e-10 && m.gradient < 1e-10,
                "{} and {}, case {case}: {m:?}",
                KINDS[i],
                KINDS[j]
            );
        }
    }
}

/// An ellipsoid that leaves a tube for less than the distance of two slices, beside the end of its straight part and
/// between two slices of one piece.
#[test]
fn short_pieces_of_ellipsoids_are_found() {
    let mut solver = OverlapSolver::new();
    let number = |kind: &str| KINDS.iter().position(|k| *k == kind).expect("a kind");
    for (tube, case) in [("capsule", 745), ("cylinder", 4856)] {
        let (a, b, at_a, at_b) = poses::pose(number("ellipsoid"), number(tube), 1.0, case);
        let m = poses::measure(&mut solver, 1e-4, (&a, &at_a), (&b, &at_b));
        assert!(m.of_body < 1e-5, "{tube}: {m:?}");
    }
}
