//! Products against what they are products of.
use super::*;
use crate::interpolation::{Degree, Kernel, NetworkParams, RbfParams, best};
use proptest::prelude::*;

/// 30 times by scattered points, in no order.
fn runs(points: &[[f64; 2]], f: impl Fn(f64, [f64; 2]) -> [f64; 2]) -> Samples {
    let n = 30 * points.len();
    let at = |j: usize| {
        let j = (7 * j) % n;
        ((j % 30) as f64 / 29.0, points[j / 30])
    };
    let x = Mat::from_fn(3, n, |i, j| [at(j).0, at(j).1[0], at(j).1[1]][i]);
    let y = Mat::from_fn(2, n, |i, j| f(at(j).0, at(j).1)[i]);
    Samples::new(x.as_ref(), y.as_ref()).unwrap()
}

const POINTS: [[f64; 2]; 11] = [
    [0.0, 0.0],
    [1.0, 0.1],
    [0.1, 1.0],
    [1.0, 1.1],
    [0.5, 0.4],
    [0.25, 0.7],
    [0.7, 0.2],
    [0.8, 0.75],
    [0.4, 0.0],
    [0.05, 0.45],
    [0.6, 1.0],
];

fn smooth(t: f64, [a, b]: [f64; 2]) -> [f64; 2] {
    [(5.0 * t + a).sin() * (1.0 + b), (3.0 * t * (1.0 + 0.2 * b)).cos() - a * a]
}

fn product(kernel: Kernel) -> ProductParams {
    ProductParams { first: SplineParams::new(Degree::Quintic), others: Box::new(RbfParams::new(kernel)) }
}

#[test]
fn it_is_the_spline_of_what_the_other_method_says_at_every_time() {
    let samples = runs(&POINTS, smooth);
    let params = product(Kernel::Cubic);
    let found = params.product(&samples).unwrap();
    assert_eq!((found.inputs(), found.outputs()), (3, 2));
    assert_eq!(found.domain(), samples.domain());
    let at = [0.37, 0.45, 0.52];
    let Runs { first, samples: runs } = Runs::of(&samples).unwrap();
    let of_runs: Vec<usize> = runs.iter().map(|run| run[0]).collect();
    let points = samples.without_first_input(&of_runs).unwrap();
    let mut values = Mat::zeros(2, 30);
    for j in 0..30 {
        let then = Mat::from_fn(2, 11, |i, run| samples.value(runs[run][j])[i]);
        let rbf = RbfParams::new(Kernel::Cubic)
            .rbf(&Samples::new(points.points(), then.as_ref()).unwrap())
            .unwrap();
        rbf.predict(&at[1..], values.col_as_slice_mut(j)).unwrap();
    }
    let spline = params.first.spline(&Samples::of_one_input(&first, values.as_ref()).unwrap()).unwrap();
    let (mut expected, mut y) = ([0.0; 2], [0.0; 2]);
    spline.predict(&at[..1], &mut expected).unwrap();
    found.predict(&at, &mut y).unwrap();
    assert!((0..2).all(|i| (y[i] - expected[i]).abs() < 1e-12), "{y:?} {expected:?}");
}

#[test]
fn derivatives_are_those_of_predictions_and_files_are_whole() {
    let samples = runs(&POINTS, smooth);
    let found = product(Kernel::Multiquadric).product(&samples).unwrap();
    let at = [0.41, 0.5, 0.6];
    for input in 0..3 {
        let shifted = |s: f64| {
            let (mut x, mut y) = (at, [0.0; 2]);
            x[input] += s * 1e-3;
            found.predict(&x, &mut y).unwrap();
            y
        };
        let mut slopes = [0.0; 2];
        found.derivative(&at, input, &mut slopes).unwrap();
        for i in 0..2 {
            let d = |s: f64| shifted(s)[i] - shifted(-s)[i];
            let difference = (45.0 * d(1.0) - 9.0 * d(2.0) + d(3.0)) / 0.06;
            assert!((difference - slopes[i]).abs() < 1e-8, "input {input}: {difference} {}", slopes[i]);
        }
    }
    assert!(found.derivative(&at, 3, &mut [0.0; 2]).is_err());
    let bytes = found.record().to_bytes();
    let loaded = load(&Record::from_bytes(&bytes).unwrap()).unwrap();
    assert_eq!(loaded.record().to_bytes(), bytes);
    let mut y = [[0.0; 2]; 2];
    found.predict(&at, &mut y[0]).unwrap();
    loaded.predict(&at, &mut y[1]).unwrap();
    assert_eq!(y[0], y[1]);
    let wrong = found.record().with("outputs", [3.0]);
    assert!(matches!(Product::from_record(&wrong), Err(RecordError::Entry { .. })));
}

#[test]
fn runs_of_few_shapes_need_few_functions() {
    // Both outputs are sums of two functions of time.
    let samples = runs(&POINTS, |t, [a, b]| [a.sin() * t.exp() + b * t * t, 2.0 * a.sin() * t.exp()]);
    let network = ProductParams {
        first: SplineParams::new(Degree::Quintic),
        others: Box::new(NetworkParams { decay: 1e-8, iterations: 200, ..NetworkParams::new(&[8]) }),
    };
    assert_eq!(network.product(&samples).unwrap().functions(), 2);
    let nothing = runs(&POINTS, |_, _| [0.0; 2]);
    let found = product(Kernel::Cubic).product(&nothing).unwrap();
    let mut y = [f64::NAN; 2];
    found.predict(&[0.3, 0.3, 0.3], &mut y).unwrap();
    assert_eq!((found.functions(), y), (1, [0.0; 2]));
}

#[test]
fn runs_are_found_and_the_default_is_a_product() {
    let samples = runs(&POINTS, smooth);
    let best = best(&samples).unwrap();
    let chosen = &best.table.rows[best.chosen];
    assert!(chosen.method.starts_with("quintic spline × ") && best.table.rows.len() > 4, "{}", best.table);
    let mut y = [0.0; 2];
    best.interpolator.predict(&[0.33, 0.45, 0.35], &mut y).unwrap();
    let exact = smooth(0.33, [0.45, 0.35]);
    assert!((0..2).all(|i| (y[i] - exact[i]).abs() < 5e-3), "{y:?} {exact:?}");
    let short = samples.without(&[5]).unwrap();
    let error = product(Kernel::Cubic).product(&short).err().map(|error| error.to_string());
    assert!(error.is_some_and(|error| error.contains("329") && error.contains("330")));
}

proptest! {
    #[test]
    fn factors_are_orthonormal_and_give_the_matrix_back(
        rows in 1..12usize, columns in 1..12usize, rank in 0..6usize, seed in 0..1000u64
    ) {
        use rand::{RngExt, SeedableRng};
        let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
        let mut matrix = |m, n| Mat::from_fn(m, n, |_, _| random.random_range(-1.0..1.0));
        let a: Mat<f64> = matrix(rows, rank) * matrix(rank, columns);
        let [q, r] = factors(a.clone());
        prop_assert!((&q * &r - &a).norm_l2() <= 1e-14 * (1.0 + a.norm_l2()));
        prop_assert!(q.ncols() <= rank.max(1).min(rows).min(columns));
        if rank > 0 {
            let identity: Mat<f64> = Mat::identity(q.ncols(), q.ncols());
            prop_assert!((q.transpose() * &q - identity).norm_l2() < 1e-13);
        }
    }
}
