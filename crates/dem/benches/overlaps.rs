//! Error, consistency and CPU time of overlaps, every kind of body with every other, at random poses:
//! `cargo bench -p dem --bench overlaps -- [poses] [kind] [other kind]`.
#[path = "../src/draw.rs"]
mod draw;
#[path = "../tests/overlaps/kinds.rs"]
mod kinds;
#[path = "../tests/overlaps/poses.rs"]
mod poses;
#[path = "../tests/overlaps/quadrature.rs"]
mod quadrature;
#[path = "../tests/overlaps/reference.rs"]
mod reference;

use dem::OverlapSolver;
use kinds::KINDS;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|w| !w.starts_with("--")).collect();
    let n = words.first().and_then(|w| w.parse().ok()).unwrap_or(100);
    let (first, second) = (words.get(1), words.get(2));
    let chosen = |i: usize, j: usize| {
        let is = |word: &String, k: usize| KINDS[k].starts_with(word.as_str());
        match (first, second) {
            (Some(p), Some(q)) => is(p, i) && is(q, j),
            (Some(p), None) => is(p, i) || is(p, j),
            _ => true,
        }
    };
    println!("pair | met | error/body | error/volume | dV - S dx | median us | 99 % | most | worst case");
    let mut solver = OverlapSolver::new();
    for (i, j) in (0..KINDS.len()).flat_map(|i| (i..KINDS.len()).map(move |j| (i, j))) {
        if !chosen(i, j) {
            continue;
        }
        let mut table = poses::Table::default();
        for case in 0..n {
            let (a, b, at_a, at_b) = poses::pose(i, j, case);
            table.add(poses::measure(&mut solver, (&a, &at_a), (&b, &at_b)), case);
        }
        println!("{} and {} | {table}", KINDS[i], KINDS[j]);
    }
}
