//! Shifted POD with ranks and wrong entries found: `cargo bench -p siltflow-mor --bench shifted_robust [-- CASE …]`.
//!
//! One line per case: the ranks found, the relative error against the clean field in Frobenius' norm, iterations, CPU seconds. The cases are those
//! of the reference page and others like them; the discs are thinned to every eighth snapshot unless `discs601` is asked for.
use cpu_time::ProcessTime;
use interfaces::{Point, Rotation, Vector};
use mor::Mat;
use mor::shifted::{
    Grid, GridFrames, Interpolation, Motion, Motions, Noise, Proximal, Ranks, ShiftedPod, Shifts,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// A case: what moves, what is seen of it.
struct Case {
    grid: Grid,
    shifts: Motions,
    clean: Mat<f64>,
}

/// Pulses on a periodic line of length 1, 400 points and 200 times up to 0.5, that start at these places with these speeds.
fn pulses(waves: &[(f64, f64)]) -> Case {
    let (m, n) = (400, 200);
    let t = |j: usize| j as f64 * 0.5 / n as f64;
    let pulse = |x: f64, at: f64| (-((x.rem_euclid(1.0) - at) / 0.015).powi(2)).exp();
    let value =
        |i: usize, j: usize| waves.iter().map(|&(at, v)| pulse(i as f64 / m as f64 - v * t(j), at)).sum();
    let shifts = Motions::by(waves.len(), n, |k, j| Motion::translation(Vector::x() * (waves[k].1 * t(j))));
    Case { grid: Grid::new([m], [1.0 / m as f64]).expect("a grid"), shifts, clean: Mat::from_fn(m, n, value) }
}

/// Two discs of 15 cells with an edge of one cell that fall in a periodic box of 150 × 300 cells, `every` of 601 snapshots.
fn discs(every: usize) -> Case {
    let grid = Grid::new([150, 300], [1.0; 2]).expect("a grid");
    let n = 600 / every + 1;
    let way = |k: usize, j: usize| {
        let t = (j * every) as f64 / 600.0;
        -[320.0, 180.0][k] * [t * t, 0.3 * t + 0.7 * t * t][k]
    };
    let disc = |i: usize, c: [f64; 2], s: f64| {
        let x = grid.centre(i);
        let dy = x.y - c[1] - s;
        let r = (x.x - c[0]).hypot(dy - 300.0 * (dy / 300.0).round());
        0.5 - 0.5 * (r - 7.5).tanh()
    };
    let clean = Mat::from_fn(45_000, n, |i, j| {
        disc(i, [50.0, 250.0], way(0, j)) + disc(i, [100.0, 250.0], way(1, j))
    });
    let shifts = Motions::by(2, n, |k, j| Motion::translation(Vector::y() * way(k, j)));
    Case { grid, shifts, clean }
}

/// A bar that turns on its way through a periodic box, and a bump that falls.
fn turning() -> Case {
    let grid = Grid::new([80, 64], [1.0; 2]).expect("a grid");
    let n = 100;
    let motion = |k: usize, j: usize| {
        let t = j as f64 / (n - 1) as f64;
        match k {
            0 => Motion {
                displacement: Vector::new(120.0 * t, 40.0 * (PI * t).sin(), 0.0),
                rotation: Rotation::new(Vector::z() * (9.0 * t)),
                centre: Point::new(20.0, 24.0, 0.0),
            },
            _ => Motion::translation(Vector::new(0.0, -90.0 * t * t, 0.0)),
        }
    };
    let shortest =
        |d: Vector| Vector::new(d.x - 80.0 * (d.x / 80.0).round(), d.y - 64.0 * (d.y / 64.0).round(), 0.0);
    let value = |i: usize, j: usize| {
        let x = grid.centre(i);
        let m = motion(0, j);
        let d = m.rotation.inverse() * shortest(x - m.centre - m.displacement);
        let bar = 0.25 * (1.0 - ((d.x.abs() - 9.0) / 1.5).tanh()) * (1.0 - ((d.y.abs() - 4.0) / 1.5).tanh());
        let d = shortest(x - Point::new(60.0, 40.0, 0.0) - motion(1, j).displacement);
        bar + (-(d.x * d.x + d.y * d.y) / 30.0).exp() * (1.0 + 0.3 * (0.1 * j as f64).sin())
    };
    Case { grid, shifts: Motions::by(2, n, motion), clean: Mat::from_fn(80 * 64, n, value) }
}

/// Normal numbers of this part of the root mean square.
fn normal(clean: &Mat<f64>, part: f64) -> Mat<f64> {
    let mut rng = Pcg64::seed_from_u64(1);
    let amount = part * clean.norm_l2() / ((clean.nrows() * clean.ncols()) as f64).sqrt();
    let mut number = || {
        (-2.0 * rng.random_range(f64::MIN_POSITIVE..1.0).ln()).sqrt()
            * (2.0 * PI * rng.random_range(0.0..1.0)).cos()
    };
    Mat::from_fn(clean.nrows(), clean.ncols(), |i, j| clean[(i, j)] + amount * number())
}

/// Zeros and ones in this part of the entries.
fn salt_and_pepper(clean: &Mat<f64>, part: f64) -> Mat<f64> {
    let mut rng = Pcg64::seed_from_u64(2);
    Mat::from_fn(clean.nrows(), clean.ncols(), |i, j| {
        let u = rng.random_range(0.0..1.0);
        if u < 0.5 * part {
            0.0
        } else if u < part {
            1.0
        } else {
            clean[(i, j)]
        }
    })
}

fn run(name: &str, case: &Case, seen: &Mat<f64>, pod: ShiftedPod) {
    let start = ProcessTime::now();
    let d = pod.solve(&case.shifts, seen.as_ref(), None, &mut |_| ControlFlow::Continue(()));
    let seconds = start.elapsed().as_secs_f64();
    let d = d.expect("a decomposition");
    let op = GridFrames::new(case.grid, Interpolation::Spectral, &case.shifts, case.clean.nrows())
        .expect("frames");
    let error = d.relative_error(&op, case.clean.as_ref());
    println!(
        "{name:32} ranks {:12} error {error:.2e}  {:4} steps {seconds:7.2} s",
        format!("{:?}", d.ranks()),
        d.history.len()
    );
}

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let wanted =
        |name: &str| if asked.is_empty() { name != "discs601" } else { asked.iter().any(|a| a == name) };
    let pod = |case: &Case| ShiftedPod::new(case.grid, Interpolation::Spectral);
    for (name, case) in [
        ("crossing", pulses(&[(0.1, 1.0), (0.9, -1.0)])),
        ("three", pulses(&[(0.1, 1.0), (0.9, -1.0), (0.5, 0.3)])),
    ] {
        if !wanted(name) {
            continue;
        }
        let given = Ranks::Given(vec![1; case.shifts.n_frames()]);
        let c = &case.clean;
        for (kind, seen, noise) in [
            ("clean", c.clone(), Noise::Dense),
            ("5 % normal", normal(c, 0.05), Noise::Dense),
            ("5 % normal", normal(c, 0.05), Noise::Sparse),
            ("5 % salt and pepper", salt_and_pepper(c, 0.05), Noise::Sparse),
            ("12.5 % salt and pepper", salt_and_pepper(c, 0.125), Noise::Sparse),
        ] {
            for (which, ranks) in [("given", given.clone()), ("found", Ranks::Found)] {
                run(&format!("{name} {kind} {which}"), &case, &seen, pod(&case).noise(noise).ranks(ranks));
            }
        }
        let op =
            GridFrames::new(case.grid, Interpolation::Spectral, &case.shifts, c.nrows()).expect("frames");
        for (kind, algorithm) in [
            ("ALM", Proximal::augmented_lagrangian().tolerance(1e-5)),
            ("JFB", Proximal::joint()),
            ("BFB", Proximal::block()),
        ] {
            let start = ProcessTime::now();
            let d = algorithm
                .solve(&op, c.as_ref(), None, &mut |_| ControlFlow::Continue(()))
                .expect("a decomposition");
            let seconds = start.elapsed().as_secs_f64();
            let (error, steps) = (d.relative_error(&op, c.as_ref()), d.history.len());
            println!(
                "{name} {kind:22} ranks {:?} error {error:.2e} {steps:4} steps {seconds:7.2} s",
                d.ranks()
            );
        }
    }
    if wanted("turning") {
        let case = turning();
        run("turning given", &case, &case.clean, pod(&case).ranks(Ranks::Given(vec![1, 1])));
        run("turning found", &case, &case.clean, pod(&case).rank_tolerance(1e-3));
        let seen = salt_and_pepper(&case.clean, 0.05);
        run(
            "turning 5 % salt and pepper",
            &case,
            &seen,
            pod(&case).noise(Noise::Sparse).ranks(Ranks::Given(vec![1, 1])),
        );
    }
    for (name, every) in [("discs", 8), ("discs601", 1)] {
        if wanted(name) {
            let case = discs(every);
            for (which, pod) in [
                ("(1, 1)", pod(&case).ranks(Ranks::Given(vec![1, 1]))),
                ("(3, 3)", pod(&case).ranks(Ranks::Given(vec![3, 3])).tolerance(1e-5)),
                ("found to 2e-3", pod(&case).rank_tolerance(2e-3)),
                ("found to 1e-4", pod(&case).rank_tolerance(1e-4).tolerance(1e-5)),
            ] {
                run(&format!("{name} {which}"), &case, &case.clean, pod);
            }
        }
    }
}
