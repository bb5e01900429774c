//! Errors, steps, CPU seconds and peak memory of shifted decompositions at full size: `cargo bench -p siltflow-mor --bench shifted -- two_discs`.
use cpu_time::ProcessTime;
use interfaces::Vector;
use mor::Mat;
use mor::shifted::fourier::{Als, centred};
use mor::shifted::{Grid, Motion, Motions};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;

/// Snapshots, where they are, and how their frames move.
struct Case {
    grid: Grid,
    motions: Motions,
    snapshots: Mat<f64>,
}

/// Peaks that run along x, one to the right and one to the left (and one of twice the speed).
fn crossing_waves(frames: usize) -> Case {
    let (nx, nt) = (400, 200);
    let speeds = [1.0, -1.0, 2.0];
    let starts = [0.1, 0.9, 0.5];
    let time = |j: usize| j as f64 * 0.5 / nt as f64;
    let value = |i: usize, j: usize| {
        let x = i as f64 / nx as f64;
        let wave = |k: usize| {
            let from = (x - speeds[k] * time(j)).rem_euclid(1.0) - starts[k];
            (-(from / 0.015_f64).powi(2)).exp()
        };
        (0..frames).map(wave).sum()
    };
    Case {
        grid: Grid::new([nx], [1.0 / nx as f64]).unwrap(),
        motions: Motions::by(frames, nt, |k, j| {
            Motion::translation(Vector::new(speeds[k] * time(j), 0.0, 0.0))
        }),
        snapshots: Mat::from_fn(nx, nt, value),
    }
}

/// Two discs with a tanh edge one cell wide that fall side by side at different, growing speeds; `drift` cells sideways
/// as well, from centres `offset` cells aside from those of cells.
fn two_discs(cells: [usize; 2], n: usize, d: f64, drift: f64, offset: f64) -> Case {
    discs(2, cells, n, d, drift, offset)
}

/// The first `count` of them.
fn discs(count: usize, [nx, ny]: [usize; 2], n: usize, d: f64, drift: f64, offset: f64) -> Case {
    let cells = [nx, ny];
    let [nx, ny] = cells.map(|n| n as f64);
    let way = [320.0, 180.0].map(|w| w * nx / 300.0);
    let start = [1.0, 2.0].map(|y| Vector::new(0.1 * nx + offset, y * ny / 3.0 + offset, 0.0));
    let moved = |k: usize, j: usize| {
        let t = j as f64 / (n - 1) as f64;
        Vector::new(way[k] * 0.5 * t * (1.0 + t), drift * (t * (1.0 + t)) * [0.5, -0.5][k], 0.0)
    };
    let grid = Grid::new(cells, [1.0; 2]).unwrap();
    let field = |i: usize, j: usize| {
        let disc = |k: usize| {
            let mut r = grid.centre(i).coords - start[k] - moved(k, j);
            r.x -= nx * (r.x / nx).round();
            r.y -= ny * (r.y / ny).round();
            0.5 - 0.5 * (r.norm() - d / 2.0).tanh()
        };
        (0..count).map(disc).sum::<f64>()
    };
    Case {
        motions: Motions::by(count, n, |k, j| Motion::translation(moved(k, j))),
        snapshots: Mat::from_fn(cells[0] * cells[1], n, field),
        grid,
    }
}

/// In frames whose bodies are at rest at the centres of cells.
fn on_cells(mut case: Case) -> Case {
    case.motions = centred(&case.grid, &case.motions, case.snapshots.as_ref()).unwrap();
    case
}

/// Velocities: two spheres that fall on curves in a periodic cube, each as fast as it moves.
fn two_spheres(cells: usize, n: usize) -> Case {
    let length = cells as f64;
    let grid = Grid::new([cells; 3], [1.0; 3]).unwrap();
    let moved = |k: usize, t: f64| {
        let turn = 2.0 * PI * t + k as f64;
        Vector::new(0.2 * turn.cos(), 0.2 * turn.sin(), [1.5, 0.7][k] * t) * length
    };
    let time = |j: usize| j as f64 / n as f64;
    let value = |row: usize, j: usize| {
        let (component, cell) = (row / grid.n_cells(), row % grid.n_cells());
        let sphere = |k: usize| {
            let r = grid.centre(cell).coords - moved(k, time(j)) - Vector::repeat(0.5 * k as f64 * length);
            let r = r.map(|x| x - length * (x / length).round());
            let speed = (moved(k, time(j) + 1e-4) - moved(k, time(j) - 1e-4))[component] / 2e-4;
            speed * (-r.norm_squared() / (0.1 * length).powi(2)).exp()
        };
        sphere(0) + sphere(1)
    };
    Case {
        motions: Motions::by(2, n, |k, j| Motion::translation(moved(k, time(j)))),
        snapshots: Mat::from_fn(3 * grid.n_cells(), n, value),
        grid,
    }
}

/// With noise of this standard deviation.
fn noisy(mut case: Case, deviation: f64) -> Case {
    let mut rng = Pcg64::seed_from_u64(3);
    let q = &case.snapshots;
    // Of twelve uniform numbers the sum has the variance 1.
    let mut noise = || (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>();
    case.snapshots = Mat::from_fn(q.nrows(), q.ncols(), |i, j| q[(i, j)] + deviation * noise());
    case
}

/// Its name, itself, and which ranks.
type Entry<'a> = (&'a str, &'a dyn Fn() -> Case, &'a [&'a [usize]]);

fn peak_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<f64>().ok()).unwrap_or(f64::NAN) / 1e6
}

fn main() {
    let chosen: Vec<_> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let chosen = |name: &str| chosen.is_empty() || chosen.iter().any(|c| name.contains(c.as_str()));
    const SMALL: [usize; 2] = [100, 50];
    const FULL: [usize; 2] = [300, 150];
    let cases: &[Entry<'_>] = &[
        ("crossing_waves", &|| crossing_waves(2), &[&[1, 1]]),
        ("three_waves", &|| crossing_waves(3), &[&[1, 1, 1]]),
        ("discs_small", &|| two_discs(SMALL, 201, 9.0, 0.0, 0.0), &[&[1, 1], &[3, 3]]),
        ("discs_small_drifting", &|| two_discs(SMALL, 201, 9.0, 20.0, 0.0), &[&[1, 1], &[5, 5]]),
        ("discs", &|| two_discs(FULL, 601, 15.0, 0.0, 0.0), &[&[1, 1], &[3, 3]]),
        ("discs_between_cells", &|| two_discs(FULL, 601, 15.0, 0.0, 0.5), &[&[1, 1], &[3, 3], &[4, 4]]),
        ("discs_centred", &|| on_cells(two_discs(FULL, 601, 15.0, 0.0, 0.5)), &[&[1, 1], &[3, 3]]),
        ("discs_drifting", &|| two_discs(FULL, 601, 15.0, 40.0, 0.0), &[&[1, 1], &[3, 3], &[5, 5]]),
        ("disc_alone", &|| discs(1, FULL, 601, 15.0, 0.0, 0.0), &[&[1], &[3]]),
        ("disc_alone_drifting", &|| discs(1, FULL, 601, 15.0, 40.0, 0.0), &[&[1], &[5], &[9]]),
        ("spheres", &|| two_spheres(40, 100), &[&[1, 1], &[3, 3]]),
        ("discs_noisy", &|| noisy(two_discs(FULL, 601, 15.0, 0.0, 0.0), 0.05), &[&[1, 1], &[3, 3]]),
    ];
    println!("case                 ranks         error      steps  stopped      CPU s  peak GB");
    for (name, case, all) in cases.iter().filter(|c| chosen(c.0)) {
        let Case { grid, motions, snapshots } = case();
        for ranks in *all {
            let start = ProcessTime::now();
            let verbose = std::env::var_os("VERBOSE").is_some();
            let out = Als::new(*ranks)
                .solve(&grid, &motions, snapshots.as_ref(), None, None, &mut |p| {
                    if verbose {
                        println!(
                            "{:5} {:2} {:.6e} {:.3}",
                            p.step,
                            p.rank,
                            p.error,
                            start.elapsed().as_secs_f64()
                        );
                    }
                    true
                })
                .unwrap();
            let seconds = start.elapsed().as_secs_f64();
            let last = out.history.last().unwrap();
            let ranks = format!("{ranks:?}");
            let stopped = format!("{:?}", out.stopped);
            println!(
                "{name:20} {ranks:12} {:10.3e} {:5}  {stopped:11} {seconds:6.3}  {:6.3}",
                last.error,
                last.step,
                peak_memory()
            );
        }
    }
}
