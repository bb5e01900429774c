//! Error, consistency and CPU time of overlaps, every kind of body with every other, at random
//! poses: `cargo bench -p siltflow-dem --bench overlaps -- [poses] [kind] [other kind] [size=1e-4]`. Given `size`, the second
//! body's size is this share of the first one's, and it is on its surface.
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

use cpu_time::ThreadTime;
use dem::OverlapSolver;
use kinds::KINDS;
use poses::Measured;
use std::fmt;
use std::hint::black_box;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|w| !w.starts_with("--")).collect();
    let (sizes, words): (Vec<_>, Vec<_>) = words.into_iter().partition(|w| w.starts_with("size="));
    let ratio = sizes.first().map_or(1.0, |w| w[5..].parse().expect("a number after size="));
    let (numbers, words): (Vec<_>, Vec<_>) = words.iter().partition(|w| w.parse::<u64>().is_ok());
    let poses = numbers.first().and_then(|n| n.parse().ok()).unwrap_or(100);
    for word in &words {
        assert!(KINDS.iter().any(|k| k.starts_with(word.as_str())), "no kind begins with {word}: {KINDS:?}");
    }
    let is = |word: &str, kind: usize| KINDS[kind].starts_with(word);
    let chosen = |i: usize, j: usize| match words[..] {
        [p, q] => is(p, i) && is(q, j) || is(p, j) && is(q, i),
        [p] => is(p, i) || is(p, j),
        _ => true,
    };
    println!(
        "pair | met | error/body | error/volume | dV - S dx | CPU us of those that meet: median | 99 % | most | cases"
    );
    let mut solver = OverlapSolver::new();
    for (i, j) in (0..KINDS.len()).flat_map(|i| (i..KINDS.len()).map(move |j| (i, j))) {
        if !chosen(i, j) {
            continue;
        }
        let mut table = Table::default();
        for case in 0..poses {
            let (a, b, at_a, at_b) = poses::pose(i, j, ratio, case);
            let measured = poses::measure(&mut solver, STEP, (&a, &at_a), (&b, &at_b));
            let mut solve = || {
                let start = ThreadTime::now();
                let patches = solver.solve(&*a.shape, &at_a, &*b.shape, &at_b).expect("an overlap");
                black_box(patches.len());
                start.elapsed().as_secs_f64() * 1e6
            };
            let time = (0..3).map(|_| solve()).fold(f64::INFINITY, f64::min);
            table.add(&measured, time, case);
        }
        println!("{} and {} | {table}", KINDS[i], KINDS[j]);
    }
}

/// Largest differences over many poses, with the numbers of the cases.
#[derive(Clone, Debug, Default)]
struct Table {
    worst: [(f64, u64); 3],
    /// CPU times of pairs that meet \[µs\].
    times: Vec<(f64, u64)>,
}

/// Motion between V and V + S·dx, as a share of the cube root of the smaller volume.
const STEP: f64 = 1e-4;
/// Share of the smaller body below which errors are not compared with the volume itself.
const SMALL: f64 = 1e-6;

impl Table {
    fn add(&mut self, m: &Measured, time: f64, case: u64) {
        let share = m.volume / m.smaller;
        let of_volume = if share > SMALL { m.of_body / share } else { 0.0 };
        for (worst, now) in self.worst.iter_mut().zip([m.of_body, of_volume, m.gradient]) {
            if now.is_nan() || now > worst.0 {
                *worst = (now, case);
            }
        }
        if m.volume > 0.0 {
            self.times.push((time, case));
        }
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut times = self.times.clone();
        times.sort_by(|x, y| x.0.total_cmp(&y.0));
        let [body, volume, gradient] = self.worst;
        write!(f, "{} | {:.1e} | {:.1e} | {:.1e} | ", times.len(), body.0, volume.0, gradient.0)?;
        let Some(longest) = times.last() else { return write!(f, "none meets") };
        let at = |percent: usize| times[(times.len() - 1) * percent / 100].0;
        write!(f, "{:.1} | {:.0} | {:.0} | ", at(50), at(99), longest.0)?;
        write!(f, "{} {} {} {}", body.1, volume.1, gradient.1, longest.1)
    }
}
