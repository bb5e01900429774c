//! What a forcing costs, in µs of CPU time per body and step: `cargo bench -p siltflow-ibm --bench forcing`; `-- smooth` takes only the rows
//! with this word. Equal balls, 5 % of a periodic box, medians: to take note of them at rest and moved, to force the velocity (all
//! rounds), and to tell the fluid's resistance and the momentum inside, which bodies that move freely ask for.
#[path = "support/staggered.rs"]
mod staggered;
mod support;

use cpu_time::ProcessTime;
use ibm::{Forcing, Hfdib, Kernel, SmoothForcing, ViscousStep};
use interfaces::{BodyId, Pose, Vector};
use staggered::Staggered;
use std::f64::consts::PI;
use support::{Ball, Equal};

const STEPS: usize = 41;

/// With the viscosity known, or not: then markers stand deeper and nothing slips.
fn row<const D: usize>(name: &str, known: bool, mut forcing: impl Forcing, cells: usize, across: usize) {
    let diffused = 0.1 / (cells * cells) as f64;
    let step = known.then(|| ViscousStep { diffused, implicit: Vector::zeros() });
    let only = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    if only.is_some_and(|o| !name.contains(&o)) {
        return;
    }
    let share = 0.05 / across.pow(D as u32) as f64;
    let radius = if D == 2 { (share / PI).sqrt() } else { (0.75 * share / PI).cbrt() };
    let at = |k: usize, a: usize| {
        if a < D { ((k / across.pow(a as u32) % across) as f64 + 0.503) / across as f64 } else { 0.0 }
    };
    let poses: Vec<_> = (0..across.pow(D as u32)).map(|k| Pose::at([at(k, 0), at(k, 1), at(k, 2)])).collect();
    let n = poses.len();
    let mut bodies = Equal { solid: Box::new(Ball { radius, dim: D }), poses };
    let mut field = Staggered::new::<D>(cells);
    let mut times: [Vec<f64>; 4] = Default::default();
    let drift = Vector::new(0.13, 0.17, if D == 2 { 0.0 } else { 0.11 }) / cells as f64;
    for _ in 0..STEPS {
        let mut part = |k: usize, work: &mut dyn FnMut()| {
            let start = ProcessTime::now();
            work();
            times[k].push(start.elapsed().as_secs_f64() * 1e6 / n as f64);
        };
        bodies.poses.iter_mut().for_each(|pose| pose.position += drift);
        forcing.begin(step);
        part(1, &mut || forcing.place(&field, &bodies).expect("bodies that the grid sees"));
        part(0, &mut || forcing.place(&field, &bodies).expect("bodies that the grid sees"));
        part(2, &mut || (0..forcing.rounds()).for_each(|_| forcing.force(&mut field, &bodies)));
        part(3, &mut || {
            for b in (0..n).map(BodyId) {
                std::hint::black_box((
                    forcing.layer(&field, &bodies, b),
                    forcing.internal_momentum(&field, &bodies, b),
                ));
            }
        });
    }
    let [rest, moved, force, momentum] = times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[STEPS / 2]
    });
    println!(
        "{name:<14} {:>6} {n:>5} balls {:>5.1} per D: {rest:>7.2} at rest {moved:>7.1} moved {force:>7.1} force {momentum:>7.1} momentum",
        format!("{cells}^{D}"),
        2.0 * radius * cells as f64,
    );
}

fn main() {
    for (cells, across) in [(256, 6), (256, 1)] {
        row::<2>("smooth", true, SmoothForcing::new(1.0), cells, across);
        row::<2>("smooth, deeper", false, SmoothForcing::new(1.0), cells, across);
        row::<2>("yang", true, SmoothForcing::new(1.0).with_kernel(Kernel::Yang), cells, across);
        row::<2>("quintic", true, SmoothForcing::new(1.0).with_kernel(Kernel::QuinticSpline), cells, across);
        row::<2>("hfdib", true, Hfdib::new(1.0), cells, across);
    }
    for (cells, across) in [(64, 3), (64, 1), (85, 4)] {
        row::<3>("smooth", true, SmoothForcing::new(1.0), cells, across);
        row::<3>("smooth, deeper", false, SmoothForcing::new(1.0), cells, across);
        row::<3>("quartic", true, SmoothForcing::new(1.0).with_kernel(Kernel::QuarticSpline), cells, across);
        row::<3>("quintic", true, SmoothForcing::new(1.0).with_kernel(Kernel::QuinticSpline), cells, across);
        row::<3>("hfdib", true, Hfdib::new(1.0), cells, across);
    }
}
