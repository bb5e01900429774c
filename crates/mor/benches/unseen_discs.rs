//! Errors of sPODIANN for λ of discs at unseen times and parameters, by method. `cargo bench -p siltflow-mor --bench unseen_discs [-- KIND … SEED]`.
//!
//! Kinds: `two` (two discs, ranks (5,5), snapshots between those of the fit), `ten` (ten discs, ranks 3), `parameters` (two discs, five runs and four runs between
//! them). Paths start from rest, approach a terminal velocity and drift sideways (tests/discs).
#[path = "../tests/discs/mod.rs"]
mod discs;

use cpu_time::ProcessTime;
use discs::{Discs, Part, each, runs, times};
use mor::interpolation::{Degree, Kernel, Method, NetworkParams, RbfParams, SplineParams};
use mor::models::{Spodiann, SpodiannParams};
use mor::shifted::fourier::Als;
use mor::shifted::{Grid, Interpolation};

fn measure(name: &str, grid: Grid, ranks: &[usize], known: &Part, held: &Part) {
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
    println!(
        "{:8} {:>10} {:>9} {:>7} {:>12} {:>9} {:>8} coefficients of frame 1",
        "given", "projection", "total", "ratio", "worst ratio", "at time", "fit s"
    );
    let spline = SplineParams::new(Degree::Cubic);
    let rbf = RbfParams::new(Kernel::Cubic);
    let network = NetworkParams { iterations: 300, ..NetworkParams::new(&[24, 24]) };
    let methods: [(&str, Option<&dyn Method>); 4] =
        [("none", None), ("spline", Some(&spline)), ("rbf", Some(&rbf)), ("network", Some(&network))];
    for (name, coefficients) in methods {
        let watch = ProcessTime::now();
        let params = SpodiannParams { coefficients, paths: None };
        let how = (grid, Interpolation::Spectral);
        let model =
            Spodiann::new(known.points.as_ref(), &modes, how, &known.motions, params).expect("a model");
        let fit = watch.elapsed().as_secs_f64();
        let found =
            model.assess(held.points.as_ref(), held.snapshots.as_ref(), &held.motions).expect("errors");
        let all = each(&model, held).expect("errors");
        let ratio = |j: &usize| all[*j].total / all[*j].projection;
        let worst = (0..all.len()).max_by(|a, b| ratio(a).total_cmp(&ratio(b))).unwrap_or(0);
        let of = model.coefficient_fits().swap_remove(0);
        println!(
            "{name:8} {:10.2e} {:9.2e} {:7.3} {:12.2} {:9.3} {fit:8.2} {}",
            found.projection,
            found.total,
            found.total / found.projection,
            ratio(&worst),
            held.points[(0, worst)],
            of.map_or(String::new(), |of| format!(
                "{}, phases {:?}, left out {:.1e}",
                of.method, of.phases, of.left_out
            )),
        );
    }
}

fn main() {
    let given: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let seed = given.iter().find_map(|a| a.parse().ok()).unwrap_or(1_u64);
    let kinds: Vec<&str> = given.iter().map(String::as_str).filter(|a| a.parse::<u64>().is_err()).collect();
    let chosen = |kind: &str| kinds.is_empty() || kinds.contains(&kind);
    let two = Discs::random(seed, [90, 120], [2, 1], 7.5);
    let points =
        |between: bool| -> Vec<Vec<f64>> { times(201, between).into_iter().map(|t| vec![t]).collect() };
    // Every eighth snapshot between, and those at the ends.
    let held = |all: Vec<Vec<f64>>| -> Vec<Vec<f64>> {
        let n = all.len();
        all.into_iter()
            .enumerate()
            .filter(|(j, _)| j % 8 == 3 || *j < 2 || *j + 2 >= n)
            .map(|(_, x)| x)
            .collect()
    };
    if chosen("two") {
        let [known, held] = [points(false), held(points(true))].map(|points| two.part(&points));
        measure("two discs", two.grid, &[5; 2][..two.count()], &known, &held);
    }
    if chosen("ten") {
        let ten = Discs::random(seed, [90, 120], [5, 2], 5.0);
        let [known, held] = [points(false), held(points(true))].map(|points| ten.part(&points));
        measure("ten discs", ten.grid, &[3; 10], &known, &held);
    }
    if chosen("parameters") {
        let known = two.part(&runs(&times(41, false), &[-1.0, -0.5, 0.0, 0.5, 1.0]));
        let held = two.part(&runs(&times(9, true), &[-0.8, -0.3, 0.25, 0.7]));
        measure("two discs, five runs", two.grid, &[5, 5], &known, &held);
    }
}
