//! Shifted POD of many frames: 2, 5 and 10 discs of rank 3 on 100 × 200 cells in 101 snapshots.
//!
//! `cargo bench -p mor --bench shifted_frames [-- KIND … [COUNT …]]`. Kinds: `cross` (paths along both
//! axes), `fall` (paths along the long axis only), `found` (as `cross`, ranks found). Places, radii and
//! laws of motion are random numbers. One line per case.
use cpu_time::ProcessTime;
use interfaces::Vector;
use mor::Mat;
use mor::shifted::{Grid, GridFrames, Interpolation, Motion, Motions, Ranks, ShiftedPod};
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

fn main() {
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let counts: Vec<usize> = chosen.iter().filter_map(|a| a.parse().ok()).collect();
    let kinds: Vec<_> = chosen.iter().filter(|a| a.parse::<usize>().is_err()).collect();
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
