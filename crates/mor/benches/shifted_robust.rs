//! x
use cpu_time::ProcessTime;
use mor::Mat;
use mor::shifted::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::ops::ControlFlow;

fn main() {
    let (m, n) = (400, 200);
    let [x, t] = [|i: usize| i as f64 / 400.0, |j: usize| j as f64 * 0.5 / 200.0];
    let wave = |x: f64, at: f64| (-((x.rem_euclid(1.0) - at) / 0.015).powi(2)).exp();
    let clean = Mat::from_fn(m, n, |i, j| wave(x(i) - t(j), 0.1) + wave(x(i) + t(j), 0.9));
    let shifts = Motions::along_x(&[(0..n).map(t).collect(), (0..n).map(|j| 0.8 - t(j)).collect()]).unwrap();
    let grid = Grid::new([m], [1.0 / 400.0]).unwrap();
    let op = GridFrames::new(grid, Interpolation::Spectral, &shifts, m).unwrap();
    let mut rng = Pcg64::seed_from_u64(1);
    let mut gauss = || (0..12).map(|_| rng.random_range(0.0..1.0)).sum::<f64>() - 6.0;
    let rms = clean.norm_l2() / ((m * n) as f64).sqrt();
    let gaussian = Mat::from_fn(m, n, |i, j| clean[(i, j)] + 0.05 * rms * gauss());
    let mut rng = Pcg64::seed_from_u64(2);
    let mut salt = |part: f64| {
        Mat::from_fn(m, n, |i, j| {
            let u = rng.random_range(0.0..1.0);
            if u < part / 2.0 {
                0.0
            } else if u < part {
                1.0
            } else {
                clean[(i, j)]
            }
        })
    };
    let s5 = salt(0.05);
    let s12 = salt(0.125);
    for (name, q) in [("clean", &clean), ("gauss", &gaussian), ("salt5", &s5), ("salt12", &s12)] {
        for noise in [Noise::Dense, Noise::Sparse] {
            for ranks in [Ranks::Given(vec![1, 1]), Ranks::Found] {
                let start = ProcessTime::now();
                let pod = ShiftedPod::new(grid, Interpolation::Spectral).noise(noise).ranks(ranks.clone());
                let d = pod.solve(&shifts, q.as_ref(), None, &mut |_| ControlFlow::Continue(())).unwrap();
                println!(
                    "{name} {noise:?} {ranks:?}: {} steps, {:?}, ranks {:?} error {:.2e} {:.2} s",
                    d.history.len(),
                    d.stopped,
                    d.ranks(),
                    d.relative_error(&op, clean.as_ref()),
                    start.elapsed().as_secs_f64()
                );
                if let Some(e) = &d.noise {
                    println!(
                        "   nonzero {}",
                        (0..n).map(|j| (0..m).filter(|&i| e[(i, j)] != 0.0).count()).sum::<usize>()
                    );
                }
            }
        }
    }
}
