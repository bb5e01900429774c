//! Shifted POD on cases that nobody tuned it to: places, speeds and sizes by random numbers. `cargo bench -p siltflow-mor --bench shifted_unseen [-- KIND … [SEEDS]]`.
//!
//! Kinds: `waves` (two or three pulses on a line), `discs` (two discs of a tanh edge that fall side by side), `drift` (that move sideways, too), `near` (frames that
//! hardly move against one another), `small` (discs on 48 × 64 cells; `N=400` in the environment: so many snapshots, 200 unless told). Each clean and noisy, with ranks given and found; one line per run: error against the clean field in Frobenius' norm.
use cpu_time::ProcessTime;
use interfaces::Vector;
use mor::Mat;
use mor::shifted::{Grid, GridFrames, Interpolation, Motion, Motions, Noise, Ranks, ShiftedPod, Shifts};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// What moves, what is seen of it, and with how many modes.
struct Case {
    what: String,
    grid: Grid,
    shifts: Motions,
    clean: Mat<f64>,
    ranks: Vec<usize>,
}

/// A number of cells from the middle of a period.
fn nearest(x: f64, period: f64) -> f64 {
    x - period * (x / period).round()
}

fn waves(rng: &mut Pcg64) -> Case {
    let (m, n) = (2 * rng.random_range(100..250_usize), rng.random_range(80..260));
    let count = rng.random_range(2..4);
    let pulses: Vec<[f64; 4]> = (0..count)
        .map(|k| {
            let speed = [1.0, -1.0, 0.2][k] * rng.random_range(0.4..1.6);
            [rng.random_range(0.0..1.0), speed, rng.random_range(-0.4..0.4), rng.random_range(0.012..0.05)]
        })
        .collect();
    let way = |p: &[f64; 4], j: usize| {
        let t = j as f64 / n as f64;
        p[1] * t + p[2] * t * t
    };
    let value = |i: usize, j: usize| {
        pulses
            .iter()
            .map(|p| (-(nearest(i as f64 / m as f64 - p[0] - way(p, j), 1.0) / p[3]).powi(2)).exp())
            .sum()
    };
    Case {
        what: format!("{count} waves, {m} × {n}"),
        grid: Grid::new([m], [1.0 / m as f64]).expect("a grid"),
        shifts: Motions::by(count, n, |k, j| Motion::translation(Vector::x() * way(&pulses[k], j))),
        clean: Mat::from_fn(m, n, value),
        ranks: vec![1; count],
    }
}

/// How large a set of discs is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Size {
    Any,
    Full,
    /// 48 × 64 cells, 200 snapshots, radius 7.
    Small,
}

/// `drift` in cells.
fn discs(rng: &mut Pcg64, drift: f64, size: Size) -> Case {
    let cells = match size {
        Size::Any => [2 * rng.random_range(40..60_usize), 2 * rng.random_range(60..100)],
        Size::Full => [150, 300],
        Size::Small => [48, 64],
    };
    let n = match size {
        Size::Any => rng.random_range(150..300),
        Size::Full => 601,
        Size::Small => std::env::var("N").ok().and_then(|n| n.parse().ok()).unwrap_or(200),
    };
    let [nx, ny] = cells.map(|n| n as f64);
    let radius = if size == Size::Small { 7.0 } else { rng.random_range(5.0..0.12 * nx) };
    let starts = [0.25, 0.75].map(|x| [x * nx + rng.random_range(-1.0..1.0), rng.random_range(0.0..ny)]);
    let ways: [[f64; 3]; 2] = [(); 2].map(|()| {
        [rng.random_range(0.3..1.2) * ny, rng.random_range(0.0..1.0), drift * rng.random_range(-1.0..1.0)]
    });
    let way = |k: usize, j: usize| {
        let (t, [far, start, aside]) = (j as f64 / (n - 1) as f64, ways[k]);
        [aside * (1.0 - (PI * t).cos()), -far * (start * t + (1.0 - start) * t * t)]
    };
    let grid = Grid::new(cells, [1.0; 2]).expect("a grid");
    let value = |i: usize, j: usize| {
        let x = grid.centre(i);
        let disc = |k: usize| {
            let [sx, sy] = way(k, j);
            let r = nearest(x.x - starts[k][0] - sx, nx).hypot(nearest(x.y - starts[k][1] - sy, ny));
            0.5 - 0.5 * (r - radius).tanh()
        };
        disc(0) + disc(1)
    };
    Case {
        what: format!("discs of radius {radius:.1}, {} × {} × {n}", cells[0], cells[1]),
        shifts: Motions::by(2, n, |k, j| Motion::translation(Vector::new(way(k, j)[0], way(k, j)[1], 0.0))),
        clean: Mat::from_fn(cells[0] * cells[1], n, value),
        ranks: vec![3, 3],
        grid,
    }
}

/// Fields of ranks 1 to 3 in frames that move against one another by a few cells.
fn near(rng: &mut Pcg64) -> Case {
    let (m, n) = (128, 120);
    let speeds = [(); 2].map(|()| rng.random_range(-6.0..6.0));
    let common: f64 = rng.random_range(-60.0..60.0);
    let ranks = [(); 2].map(|()| rng.random_range(1..4_usize));
    let way = |k: usize, j: usize| {
        let t = j as f64 / n as f64;
        common * t * t + speeds[k] * t
    };
    let modes: Vec<[f64; 5]> = (0..ranks[0] + ranks[1])
        .map(|_| {
            let [place, phase] = [(); 2].map(|()| rng.random_range(0.0..128.0));
            [place, rng.random_range(3.0..9.0), rng.random_range(0.5..3.0), phase, rng.random_range(0.3..1.0)]
        })
        .collect();
    let value = |i: usize, j: usize| {
        let t = j as f64 / n as f64;
        let of = |(c, p): (usize, &[f64; 5])| {
            let k = usize::from(c >= ranks[0]);
            let amplitude = p[4] * (1.0 + 0.5 * (p[2] * PI * t + p[3]).sin());
            amplitude * (-(nearest(i as f64 - p[0] - way(k, j), 128.0) / p[1]).powi(2)).exp()
        };
        modes.iter().enumerate().map(of).sum()
    };
    Case {
        what: format!("near frames {:.1} cells apart, ranks {ranks:?}", speeds[0] - speeds[1]),
        grid: Grid::new([m], [1.0]).expect("a grid"),
        shifts: Motions::by(2, n, |k, j| Motion::translation(Vector::x() * way(k, j))),
        clean: Mat::from_fn(m, n, value),
        ranks: ranks.to_vec(),
    }
}

fn normal(clean: &Mat<f64>, part: f64, rng: &mut Pcg64) -> Mat<f64> {
    let amount = part * clean.norm_l2() / ((clean.nrows() * clean.ncols()) as f64).sqrt();
    let mut number = || (0..12).map(|_| rng.random_range(-0.5..0.5)).sum::<f64>();
    Mat::from_fn(clean.nrows(), clean.ncols(), |i, j| clean[(i, j)] + amount * number())
}

fn salt_and_pepper(clean: &Mat<f64>, part: f64, rng: &mut Pcg64) -> Mat<f64> {
    Mat::from_fn(clean.nrows(), clean.ncols(), |i, j| match rng.random_range(0.0..1.0) {
        u if u < 0.5 * part => 0.0,
        u if u < part => 1.0,
        _ => clean[(i, j)],
    })
}

fn peak_memory() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<f64>().ok()).unwrap_or(f64::NAN) / 1e6
}

fn run(case: &Case, kind: &str, seen: &Mat<f64>, noise: Noise) {
    for ranks in [Ranks::Given(case.ranks.clone()), Ranks::Found] {
        let found = ranks == Ranks::Found;
        let pod = ShiftedPod::new(case.grid, Interpolation::Spectral).noise(noise).ranks(ranks);
        let start = ProcessTime::now();
        let d = pod.solve(&case.shifts, seen.as_ref(), None, &mut |p| {
            if std::env::var_os("VERBOSE").is_some() {
                println!("{:4} {:2} {:.4e} {:.3}", p.step, p.rank, p.error, start.elapsed().as_secs_f64());
            }
            ControlFlow::Continue(())
        });
        let seconds = start.elapsed().as_secs_f64();
        let op = GridFrames::new(case.grid, Interpolation::Spectral, &case.shifts, case.clean.nrows())
            .expect("frames");
        match d {
            Ok(d) => println!(
                "{:44} {kind:20} {} {:10} error {:.2e} {:4} steps {seconds:6.2} s {:.2} GB",
                case.what,
                if found { "found" } else { "given" },
                format!("{:?}", d.ranks()),
                d.relative_error(&op, case.clean.as_ref()),
                d.history.len(),
                peak_memory()
            ),
            Err(why) => println!("{:44} {kind:20} {why}", case.what),
        }
    }
}

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let seeds = asked.iter().find_map(|a| a.parse().ok()).unwrap_or(4_u64);
    let kinds: Vec<&str> = asked.iter().map(String::as_str).filter(|a| a.parse::<u64>().is_err()).collect();
    for kind in ["waves", "discs", "drift", "near", "full", "small"] {
        if !(kinds.contains(&kind) || kinds.is_empty() && !["full", "small"].contains(&kind)) {
            continue;
        }
        for seed in 0..seeds {
            let mut rng = Pcg64::seed_from_u64(100 + seed);
            let case = match kind {
                "waves" => waves(&mut rng),
                "discs" => discs(&mut rng, 0.0, Size::Any),
                "drift" => discs(&mut rng, 15.0, Size::Any),
                "full" => discs(&mut rng, 0.0, Size::Full),
                "small" => discs(&mut rng, 0.0, Size::Small),
                _ => near(&mut rng),
            };
            let c = &case.clean;
            run(&case, "clean", c, Noise::Dense);
            if kind != "near" {
                run(&case, "5 % normal", &normal(c, 0.05, &mut rng), Noise::Dense);
                run(&case, "5 % salt and pepper", &salt_and_pepper(c, 0.05, &mut rng), Noise::Sparse);
            }
            let _ = case.shifts.n_frames();
        }
    }
}
