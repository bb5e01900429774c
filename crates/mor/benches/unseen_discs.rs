//! Errors of sPODIANN for λ of discs at unseen times and parameters, by method. `cargo bench -p mor --bench unseen_discs [-- KIND …]`.
//!
//! Kinds: `two` (two discs, ranks (5,5), snapshots between those of the fit), `ten` (ten discs, ranks 3), `parameters` (two discs, five runs and four runs between
//! them). λ = min(1, max(0, ½ + (R − r)/h)) on paths that start from rest, approach a terminal velocity and drift sideways.
use cpu_time::ProcessTime;
use interfaces::Vector;
use mor::Mat;
use mor::interpolation::{Degree, Kernel, Method, NetworkParams, RbfParams, SplineParams};
use mor::models::{Spodiann, SpodiannParams};
use mor::shifted::fourier::Als;
use mor::shifted::{Grid, Interpolation, Motion, Motions, Shifts};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;

const CELLS: [usize; 2] = [90, 120];

/// A disc: start [cells], radius [cells], and its path for a parameter μ.
struct Disc {
    start: [f64; 2],
    radius: f64,
    distance: f64,
    relaxation: f64,
    drift: [f64; 3],
}

impl Disc {
    fn random(rng: &mut Pcg64, start: [f64; 2], radius: f64) -> Self {
        Self {
            start,
            radius,
            distance: rng.random_range(0.4..1.4) * CELLS[1] as f64,
            relaxation: rng.random_range(0.1..0.5),
            drift: [rng.random_range(-6.0..6.0), rng.random_range(0.3..1.2), rng.random_range(0.0..TAU)],
        }
    }
    fn displacement(&self, t: f64, mu: f64) -> Vector {
        let tau = self.relaxation * (1.0 + 0.2 * mu);
        let fallen = self.distance * (1.0 + 0.3 * mu) * (t - tau * (1.0 - (-t / tau).exp()));
        let [size, turns, phase] = self.drift;
        let aside = size * (1.0 + 0.2 * mu) * ((TAU * turns * t + phase).sin() - phase.sin()) * t;
        Vector::new(aside, -fallen, 0.0)
    }
}

struct Part {
    points: Mat<f64>,
    snapshots: Mat<f64>,
    motions: Motions,
}

/// λ at points that are times, or times and parameters.
fn part(discs: &[Disc], points: &[Vec<f64>]) -> Part {
    let grid = Grid::new(CELLS, [1.0; 2]).expect("a grid");
    let moved = |k: usize, j: usize| discs[k].displacement(points[j][0], points[j].get(1).copied().unwrap_or(0.0));
    let motions = Motions::by(discs.len(), points.len(), |k, j| Motion::translation(moved(k, j)));
    let nearest = |d: f64, n: usize| d - n as f64 * (d / n as f64).round();
    let value = |i: usize, j: usize| {
        let x = grid.centre(i);
        let disc = |(k, disc): (usize, &Disc)| {
            let s = motions.motion(k, j).displacement;
            let r = nearest(x.x - disc.start[0] - s.x, CELLS[0]).hypot(nearest(x.y - disc.start[1] - s.y, CELLS[1]));
            (0.5 + disc.radius - r).clamp(0.0, 1.0)
        };
        discs.iter().enumerate().map(disc).sum::<f64>()
    };
    Part {
        points: Mat::from_fn(points[0].len(), points.len(), |i, j| points[j][i]),
        snapshots: Mat::from_fn(grid.n_cells(), points.len(), value),
        motions,
    }
}

fn measure(name: &str, ranks: &[usize], known: &Part, held: &Part) {
    let grid = Grid::new(CELLS, [1.0; 2]).expect("a grid");
    let watch = ProcessTime::now();
    let modes = Als { stagnation: 1e-2, ..Als::new(ranks) }
        .solve(&grid, &known.motions, known.snapshots.as_ref(), None, None, &mut |_| true)
        .expect("modes");
    println!(
        "\n{name}: ranks {ranks:?}, {} snapshots, error {:.2e}, {:.1} CPU s",
        known.points.ncols(),
        modes.history.last().map_or(f64::NAN, |p| p.error),
        watch.elapsed().as_secs_f64()
    );
    println!("{:12} {:>10} {:>9} {:>7} {:>12} {:>9} {:>8}", "method", "projection", "total", "ratio", "worst ratio", "at time", "fit s");
    let spline = SplineParams::new(Degree::Quintic);
    let rbf = RbfParams::new(Kernel::Cubic);
    let network = NetworkParams { iterations: 300, ..NetworkParams::new(&[24, 24]) };
    let methods: [(&str, Option<&dyn Method>); 4] =
        [("best", None), ("spline", Some(&spline)), ("rbf", Some(&rbf)), ("network", Some(&network))];
    let only = std::env::var("METHOD").ok();
    for (name, method) in methods {
        if only.as_ref().is_some_and(|only| only != name) {
            continue;
        }
        let watch = ProcessTime::now();
        let how = (grid, Interpolation::Spectral);
        let params = SpodiannParams { coefficients: method, paths: None };
        let model = match Spodiann::new(known.points.as_ref(), &modes, how, &known.motions, params) {
            Ok(model) => model,
            Err(why) => {
                println!("{name:12} {why}");
                continue;
            }
        };
        let fit = watch.elapsed().as_secs_f64();
        if std::env::var_os("VERBOSE").is_some() {
            for (k, fit) in model.coefficient_fits().iter().flatten().enumerate() {
                println!("    frame {k}: {}, phases {:?}, left out {:.2e}, other {:.2e}, σ {:.2?}", fit.method, fit.phases, fit.left_out, fit.left_out_other.unwrap_or(f64::NAN), modes.frames[k].singular_values);
            }
        }
        let found = model.assess(held.points.as_ref(), held.snapshots.as_ref(), &held.motions).expect("errors");
        let mut worst = (0.0, f64::NAN);
        for j in 0..held.points.ncols() {
            let motions = Motions::by(ranks.len(), 1, |k, _| held.motions.motion(k, j));
            let one = model
                .assess(held.points.as_ref().subcols(j, 1), held.snapshots.as_ref().subcols(j, 1), &motions)
                .expect("errors");
            if std::env::var_os("VERBOSE").is_some() {
                print!("{:.3}: {:.2} ", held.points[(0, j)], one.total / one.projection);
            }
            if one.total / one.projection > worst.0 {
                worst = (one.total / one.projection, held.points[(0, j)]);
            }
        }
        println!(
            "{name:12} {:10.2e} {:9.2e} {:7.3} {:12.2} {:9.3} {fit:8.2}",
            found.projection,
            found.total,
            found.total / found.projection,
            worst.0,
            worst.1
        );
    }
}

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let is_asked = |kind: &str| asked.iter().all(|a| a.parse::<u64>().is_ok()) || asked.iter().any(|a| a == kind);
    let seed = asked.iter().find_map(|a| a.parse().ok()).unwrap_or(1_u64);
    let mut rng = Pcg64::seed_from_u64(seed);
    let two: Vec<Disc> = [[22.0, 20.3], [67.4, 70.0]].map(|at| Disc::random(&mut rng, at, 7.5)).into();
    let ten: Vec<Disc> = (0..10)
        .map(|k| {
            let jitter = [(); 2].map(|()| rng.random_range(-2.0..2.0));
            let at = [9.0 + 18.0 * f64::from(k % 5) + jitter[0], 30.0 + 60.0 * f64::from(k / 5) + jitter[1]];
            Disc::random(&mut rng, at, 5.0)
        })
        .collect();
    let times = |m: usize, from: f64| (0..m).map(move |j| vec![(j as f64 + from) / 200.0]);
    // The last snapshots between are as near the end as those of a run at every second time.
    let strided = |all: Vec<Vec<f64>>| -> Vec<Vec<f64>> {
        let n = all.len();
        all.into_iter().enumerate().filter(|(j, _)| j % 8 == 3 || *j < 2 || *j + 2 >= n).map(|(_, x)| x).collect()
    };
    let known: Vec<_> = times(201, 0.0).collect();
    let held = strided(times(200, 0.5).collect());
    if is_asked("two") {
        measure("two discs", &[5, 5], &part(&two, &known), &part(&two, &held));
    }
    if is_asked("ten") {
        measure("ten discs", &[3; 10], &part(&ten, &known), &part(&ten, &held));
    }
    if is_asked("parameters") {
        let runs = |mus: &[f64], times: &[f64]| -> Vec<Vec<f64>> {
            mus.iter().flat_map(|mu| times.iter().map(move |t| vec![*t, *mu])).collect()
        };
        let at = |m: usize, from: f64| (0..m).map(|j| (j as f64 + from) / 40.0).collect::<Vec<_>>();
        let known = runs(&[-1.0, -0.5, 0.0, 0.5, 1.0], &at(41, 0.0));
        let held = runs(&[-0.8, -0.3, 0.25, 0.7], &at(8, 0.5).iter().map(|t| 5.0 * t).collect::<Vec<_>>());
        measure("two discs, five runs", &[5, 5], &part(&two, &known), &part(&two, &held));
    }
}
