//! Error, consistency and CPU time of overlaps, every kind of body with every other, at random
//! poses: `cargo bench -p dem --bench overlaps -- [poses] [kind] [other kind]`.
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
use poses::Measured;
use std::fmt;

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
        let mut table = Table::default();
        for case in 0..n {
            let (a, b, at_a, at_b) = poses::pose(i, j, case);
            table.add(poses::measure(&mut solver, (&a, &at_a), (&b, &at_b)), case);
        }
        println!("{} and {} | {table}", KINDS[i], KINDS[j]);
    }
}

/// Largest differences over many poses.
#[derive(Clone, Debug, Default)]
struct Table {
    met: usize,
    worst: [(f64, u64); 3],
    times: Vec<(f64, u64)>,
}

impl Table {
    fn add(&mut self, m: Measured, case: u64) {
        self.met += usize::from(m.volume > 0.0);
        for (worst, now) in self.worst.iter_mut().zip([m.of_body, m.of_volume, m.gradient]) {
            if now.is_nan() || now > worst.0 {
                *worst = (now, case);
            }
        }
        self.times.push((m.time, case));
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut times = self.times.clone();
        times.sort_by(|x, y| x.0.total_cmp(&y.0));
        let n = times.len();
        let [body, volume, gradient] = self.worst;
        let (median, most, longest) = (times[n / 2].0, times[n * 99 / 100].0, times[n - 1]);
        write!(
            f,
            "{} | {:.1e} | {:.1e} | {:.1e} | {median:.1} | {most:.0} | {:.0} | {} {} {} {}",
            self.met, body.0, volume.0, gradient.0, longest.0, body.1, volume.1, gradient.1, longest.1
        )
    }
}
