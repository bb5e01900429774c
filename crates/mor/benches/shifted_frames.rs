//! Shifted POD of many frames: 2, 5 and 10 discs of rank 3 on 100 × 200 cells in 101 snapshots.
//!
//! `cargo bench -p siltflow-mor --bench shifted_frames [-- KIND … [COUNT …]]`. Kinds: `cross` (paths along both
//! axes), `fall` (paths along the long axis only), `found` (as `cross`, ranks found), `fire` (two fronts
//! on a bounded axis and on a periodic one of twice the length). Places, radii and laws of motion are
//! random numbers. One line per case.
use cpu_time::ProcessTime;
use interfaces::Vector;
use mor::Mat;
use mor::shifted::{Frame, Grid, GridFrames, Interpolation, Motion, Motions, Ranks, ShiftedPod};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;
use std::ops::ControlFlow;

const CELLS: [usize; 2] = [100, 200];
const SNAPSHOTS: usize = 101;
const RANK: usize = 3;

/// Snapshots and how their frames move.
struct Case {
    grid: Grid,
    motions: Motions,
    snapshots: Mat<f64>,
}

/// Offset from the middle of a period.
fn nearest(x: f64, period: f64) -> f64 {
    x - period * (x / period).round()
}

/// Discs with a tanh edge of one cell on smooth paths, `aside` cells across the long axis at most.
fn discs(count: usize, aside: f64, seed: u64) -> Case {
    let mut rng = Pcg64::seed_from_u64(seed);
    let [nx, ny] = CELLS.map(|n| n as f64);
    // Start, radius, way along y, curvature of its law, way along x, its period.
    let laws: Vec<_> = (0..count)
        .map(|_| {
            let start = Vector::new(rng.random_range(0.0..nx), rng.random_range(0.0..ny), 0.0);
            let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
            let way = sign * rng.random_range(0.3..1.2) * ny;
            let [bend, side] = [(); 2].map(|()| rng.random_range(-1.0..1.0));
            (start, rng.random_range(4.0..9.0), way, bend, aside * side, rng.random_range(0.5..1.5))
        })
        .collect();
    let moved = |k: usize, j: usize| {
        let t = j as f64 / (SNAPSHOTS - 1) as f64;
        let (_, _, way, bend, side, period) = laws[k];
        Vector::new(side * (PI * period * t).sin(), way * (t + 0.5 * bend * t * (t - 1.0)), 0.0)
    };
    let grid = Grid::new(CELLS, [1.0; 2]).expect("a grid");
    let value = |i: usize, j: usize| {
        let disc = |k: usize| {
            let r = grid.centre(i).coords - laws[k].0 - moved(k, j);
            0.5 - 0.5 * (nearest(r.x, nx).hypot(nearest(r.y, ny)) - laws[k].1).tanh()
        };
        (0..count).map(disc).sum()
    };
    let snapshots = Mat::from_fn(grid.n_cells(), SNAPSHOTS, value);
    let motions = Motions::by(count, SNAPSHOTS, |k, j| Motion::translation(moved(k, j)));
    Case { grid, motions, snapshots }
}

/// Two fronts, `width` cells wide, that run apart from the middle and a pulse in between whose height
/// varies: 1 + pulse and both boxes less 1. On twice the length each box is periodic by itself.
fn fire(periodic: bool, width: f64, reach: f64) -> Case {
    let (n, n_t) = (200, 100);
    let length = n as f64;
    let moved = |j: usize| {
        let t = j as f64 / (n_t - 1) as f64;
        reach * length * t * (0.6 + 0.4 * t)
    };
    // Falls at 0 and rises again half a period away.
    let period = 2.0 * length;
    let front = |x: f64| {
        let x = nearest(x, period);
        let edge = |x: f64| 0.5 - 0.5 * (x / width).tanh();
        if x > 0.5 * length {
            1.0 - edge(x - length)
        } else if x < -0.5 * length {
            1.0 - edge(x + length)
        } else {
            edge(x)
        }
    };
    let value = |i: usize, j: usize| {
        let (x, t) = (i as f64 - 0.5 * length, j as f64 / (n_t - 1) as f64);
        let pulse = (0.3 + 0.2 * (2.0 * t).sin()) * (-(nearest(x, period) / (0.05 * length)).powi(2)).exp();
        front(x - moved(j)) + front(-x - moved(j)) - 1.0 + pulse
    };
    let grid = Grid::new([if periodic { 2 * n } else { n }], [1.0]).expect("a grid");
    let grid = if periodic { grid } else { grid.bounded([0]) };
    let to = |k: usize, j: usize| [1.0, -1.0, 0.0][k] * moved(j);
    Case {
        motions: Motions::by(3, n_t, |k, j| Motion::translation(Vector::x() * to(k, j))),
        snapshots: Mat::from_fn(grid.n_cells(), n_t, value),
        grid,
    }
}

/// A frame whose modes are given with their amplitudes.
fn frame(modes: &[&dyn Fn(usize) -> f64], amplitudes: &[&dyn Fn(usize) -> f64], m: usize, n: usize) -> Frame {
    Frame {
        modes: Mat::from_fn(m, modes.len(), |i, c| modes[c](i)),
        singular_values: vec![1.0; modes.len()],
        coefficients: Mat::from_fn(modes.len(), n, |c, j| amplitudes[c](j)),
    }
}

/// Errors of the same fronts with and without ends, and of the modes they are made of on the bounded axis.
fn fronts() {
    let quintic = Interpolation::QuinticSpline;
    for (width, reach) in [(2.0, 0.3), (4.0, 0.3)] {
        for (periodic, interpolation) in [
            (false, quintic),
            (false, Interpolation::Spectral),
            (true, quintic),
            (true, Interpolation::Spectral),
        ] {
            let Case { grid, motions, snapshots } = fire(periodic, width, reach);
            let (m, n) = snapshots.shape();
            let frames = GridFrames::new(grid, interpolation, &motions, m).expect("motions along the axis");
            let pod = ShiftedPod::new(grid, interpolation).ranks(Ranks::Given(vec![1, 1, 2]));
            let start = ProcessTime::now();
            let d = pod.solve(&motions, snapshots.as_ref(), None, &mut |p| {
                if std::env::var_os("VERBOSE").is_some() {
                    let seconds = start.elapsed().as_secs_f64();
                    println!("{:5} {:3} {:.6e} {seconds:.3}", p.step, p.rank, p.error);
                }
                ControlFlow::Continue(())
            });
            let seconds = start.elapsed().as_secs_f64();
            let mut d = d.expect("a decomposition");
            println!(
                "fire   width {width} reach {reach} {} {:15} error {:.3e} {:4} steps {:?} {seconds:7.2} s",
                if periodic { "periodic" } else { "bounded " },
                interpolation.name(),
                d.relative_error(&frames, snapshots.as_ref()),
                d.history.len(),
                d.stopped,
            );
            if !periodic {
                let x = |i: usize| i as f64 - 0.5 * m as f64;
                let edge = |x: f64| 0.5 - 0.5 * (x / width).tanh();
                let pulse = |i: usize| (-(x(i) / (0.05 * m as f64)).powi(2)).exp();
                let height = |j: usize| 0.3 + 0.2 * (2.0 * j as f64 / (n - 1) as f64).sin();
                d.frames = vec![
                    frame(&[&|i| edge(x(i))], &[&|_| 1.0], m, n),
                    frame(&[&|i| edge(-x(i))], &[&|_| 1.0], m, n),
                    frame(&[&|_| -1.0, &pulse], &[&|_| 1.0, &height], m, n),
                ];
                let error = d.relative_error(&frames, snapshots.as_ref());
                println!(
                    "fire   width {width} reach {reach} bounded  {:15} error {error:.3e} of the exact modes",
                    interpolation.name()
                );
            }
        }
    }
}

fn main() {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let counts: Vec<usize> = chosen.iter().filter_map(|a| a.parse().ok()).collect();
    let kinds: Vec<_> = chosen.iter().filter(|a| a.parse::<usize>().is_err()).collect();
    if kinds.is_empty() || kinds.iter().any(|k| *k == "fire") {
        fronts();
    }
    for (kind, aside, found) in [("cross", 40.0, false), ("fall", 0.0, false), ("found", 40.0, true)] {
        if !kinds.is_empty() && kinds.iter().all(|k| *k != kind) {
            continue;
        }
        for count in [2, 5, 10] {
            if !counts.is_empty() && !counts.contains(&count) {
                continue;
            }
            let Case { grid, motions, snapshots } = discs(count, aside, 7);
            let ranks = if found { Ranks::Found } else { Ranks::Given(vec![RANK; count]) };
            let pod = ShiftedPod::new(grid, Interpolation::Spectral).ranks(ranks);
            let verbose = std::env::var_os("VERBOSE").is_some();
            let start = ProcessTime::now();
            let d = pod.solve(&motions, snapshots.as_ref(), None, &mut |p| {
                if verbose {
                    let seconds = start.elapsed().as_secs_f64();
                    println!("{:5} {:3} {:.6e} {seconds:.3}", p.step, p.rank, p.error);
                }
                ControlFlow::Continue(())
            });
            let seconds = start.elapsed().as_secs_f64();
            match d {
                Err(why) => println!("{kind:6} {count:2} discs: {why}"),
                Ok(d) => {
                    let frames = GridFrames::new(grid, Interpolation::Spectral, &motions, snapshots.nrows());
                    let error = frames.map_or(f64::NAN, |f| d.relative_error(&f, snapshots.as_ref()));
                    println!(
                        "{kind:6} {count:2} discs {:?} error {error:.3e} {:4} steps {} attempts {:?} \
                         {seconds:7.2} s",
                        d.ranks(),
                        d.history.len(),
                        d.attempts,
                        d.stopped,
                    );
                }
            }
        }
    }
}
