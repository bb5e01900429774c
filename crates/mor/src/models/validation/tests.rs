//! Folds against models made by hand, and against EZyRB.
use super::*;
use crate::interpolation::{Degree, Kernel, RbfParams, Samples, SplineParams};
use crate::pod::Rank;
use crate::shifted::{Motion, Ranks, ShiftedPod};
use interfaces::Vector;
use std::f64::consts::TAU;

const TIMES: usize = 41;
const RUNS: usize = 6;

/// f = sin(3x − tμ) + .3 μ² cos 5x cos 2t at 64 places, 41 times and 6 parameters, run by run.
fn snapshots() -> [Mat<f64>; 2] {
    let points = Mat::from_fn(2, TIMES * RUNS, |i, j| match i {
        0 => (j % TIMES) as f64 / 20.0,
        _ => 0.5 + 1.5 * (j / TIMES) as f64 / 5.0,
    });
    let at = |i: usize, j: usize| {
        let (x, t, mu) = (TAU * i as f64 / 64.0, points[(0, j)], points[(1, j)]);
        (3.0 * x - t * mu).sin() + 0.3 * mu * mu * (5.0 * x).cos() * (2.0 * t).cos()
    };
    let fields = Mat::from_fn(64, points.ncols(), at);
    [points, fields]
}

fn runs() -> Folds {
    Folds::new(TIMES * RUNS, (0..RUNS).map(|run| (TIMES * run..TIMES * (run + 1)).collect()).collect())
        .unwrap()
}

/// Reference: EZyRB 1.3.3, `ReducedOrderModel(Database(Z, S), POD('svd', rank=4), RBF('cubic',
/// smooth=0))` of points Z scaled to [−1, 1]. Runs between the first and the last: the norm of
/// errors over that of the snapshots; snapshots 0, 1, 2 and 100: `loo_error`.
#[test]
fn errors_are_those_of_ezyrb() {
    let [points, fields] = snapshots();
    let data = (points.as_ref(), fields.as_ref());
    let (pod, cubic) = (PodParams::of_rank(4), RbfParams::new(Kernel::Cubic));
    let inner = Folds::new(TIMES * RUNS, runs().sets()[1..RUNS - 1].to_vec()).unwrap();
    let found = validate_podiann(data, &pod, Some(&cubic), &inner).unwrap();
    let reference = [0.033525598278512724, 0.010143974426242576, 0.02143067909656246, 0.054651472910946186];
    for (found, reference) in found.folds.iter().zip(reference) {
        assert!((found.total / reference - 1.0).abs() < 1e-8, "{found:?}, {reference}");
    }

    let alone = Folds::new(TIMES * RUNS, vec![vec![0], vec![1], vec![2], vec![100]]).unwrap();
    let found = validate_podiann(data, &pod, Some(&cubic), &alone).unwrap();
    let reference =
        [0.002163980292339472, 0.000448591508376453, 8.820978805256457e-05, 1.6808378410747198e-06];
    for (found, reference) in found.folds.iter().zip(reference) {
        assert!((found.total / reference - 1.0).abs() < 1e-6, "{found:?}, {reference}");
    }
}

#[test]
fn a_fold_is_the_model_of_the_other_snapshots() {
    let [points, fields] = snapshots();
    let params = PodParams { rank: Rank::Tolerance(1e-3), subtract_mean: true, ..PodParams::default() };
    let folds = runs().some(2);
    let spline = SplineParams::new(Degree::Linear);
    let methods: [Option<&dyn Method>; 2] = [None, Some(&spline)];
    for method in methods {
        let found = validate_podiann((points.as_ref(), fields.as_ref()), &params, method, &folds).unwrap();
        let mut squares = [0.0; 2];
        for (set, found) in folds.sets().iter().zip(&found.folds) {
            let others: Vec<usize> = (0..TIMES * RUNS).filter(|j| !set.contains(j)).collect();
            let [known, left_out] =
                [&others, set].map(|of| [&points, &fields].map(|all| part(all.as_ref(), of)));
            let pod = Pod::new(known[1].as_ref(), &params).unwrap();
            let model = Podiann::new(known[0].as_ref(), &pod, method).unwrap();
            let by_hand = model.assess(left_out[0].as_ref(), left_out[1].as_ref()).unwrap();
            assert_eq!(*found, by_hand);
            let norm = left_out[1].squared_norm_l2();
            squares = [squares[0] + by_hand.total.powi(2) * norm, squares[1] + norm];
        }
        assert!(((squares[0] / squares[1]).sqrt() / found.total.total - 1.0).abs() < 1e-12);
    }
}

/// Leave-one-out is k-fold with one set for each snapshot.
#[test]
fn as_many_folds_as_snapshots() {
    let [points, fields] = snapshots();
    let some: Vec<usize> = (0..TIMES).step_by(4).collect();
    let (points, fields) = (part(points.get(..1, ..), &some), part(fields.as_ref(), &some));
    let samples = Samples::new(points.as_ref(), points.as_ref()).unwrap();
    let folds = [
        Folds::k_fold(&samples, some.len(), 3).unwrap(),
        Folds::leave_one_out(&samples),
        Folds::k_fold(&samples, 3, 3).unwrap(),
    ];
    let [k_fold, alone, three] = folds.each_ref().map(|folds| {
        validate_podiann((points.as_ref(), fields.as_ref()), &PodParams::of_rank(3), None, folds).unwrap()
    });
    for (set, found) in folds[0].sets().iter().zip(&k_fold.folds) {
        assert_eq!((set.len(), found), (1, &alone.folds[set[0]]));
    }
    assert!((k_fold.total.total / alone.total.total - 1.0).abs() < 1e-12);
    let mut all: Vec<usize> = folds[2].sets().concat();
    all.sort_unstable();
    assert_eq!((all, three.folds.len()), ((0..some.len()).collect(), 3));
}

/// Two waves that move against one another, with a decomposition of their own for each fold.
#[test]
fn moving_modes_are_decomposed_anew() {
    let (n, m) = (32, 21);
    let grid = Grid::new([n], [1.0]).unwrap();
    let place = |k: usize, j: usize| [1.3 * j as f64, -0.6 * j as f64][k];
    let motions = Motions::by(2, m, |k, j| Motion::translation(Vector::new(place(k, j), 0.0, 0.0)));
    let wave = |x: f64| (TAU * x / n as f64).cos().exp();
    let fields = Mat::from_fn(n, m, |x, j| {
        wave(x as f64 - place(0, j)) + (0.1 * j as f64).cos() * wave(x as f64 - place(1, j)).powi(3)
    });
    let points = Mat::from_fn(1, m, |_, j| j as f64);
    let data = (points.as_ref(), fields.as_ref());
    let how = (grid, Interpolation::Spectral);
    let pod = ShiftedPod::new(grid, Interpolation::Spectral).ranks(Ranks::Given(vec![1, 1])).max_steps(30);
    let folds = Folds::interleaved(&Samples::new(data.0, data.0).unwrap(), 4).unwrap();
    let params = SpodiannParams::default();
    let validate = |observer: FitObserver<'_>| {
        let mut decompose = |shifts: &dyn Shifts, snapshots: MatRef<'_, f64>, observer: Observer<'_>| {
            pod.solve(shifts, snapshots, None, observer)
        };
        validate_spodiann_observed(data, how, &motions, &mut decompose, params, &folds, observer)
    };
    let (mut calls, mut steps) = (0, 0);
    let found = validate(&mut |progress| {
        calls += 1;
        steps += usize::from(progress.innermost().stage == FitStage::Modes);
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(steps >= 4 && calls > steps, "{steps} of {calls}");

    let set = &folds.sets()[1];
    let others: Vec<usize> = (0..m).filter(|j| !set.contains(j)).collect();
    let [known, left_out] = [&others, set].map(|of| {
        let motions = Motions::by(2, of.len(), |k, j| motions.motion(k, of[j]));
        (part(data.0, of), part(data.1, of), motions)
    });
    let (shifts, quiet) = (&known.2, &mut |_: &Progress| ControlFlow::Continue(()));
    let modes = pod.solve(shifts, known.1.as_ref(), None, quiet).unwrap();
    let model = Spodiann::new(known.0.as_ref(), &modes, how, shifts, params).unwrap();
    let by_hand = model.assess(left_out.0.as_ref(), left_out.1.as_ref(), &left_out.2).unwrap();
    assert_eq!(found.folds[1], by_hand);
    assert!(found.total.total < 1e-3, "{:?}", found.total);

    // A stop within a decomposition, and one within the fit of a model.
    for most in (1..=calls).step_by((calls / 29).max(1)) {
        let mut made = 0;
        let stopped = validate(&mut |_| {
            made += 1;
            if made < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        assert!(stopped.unwrap_err().is_stopped() && made == most, "{made} calls, {most} wanted");
    }
}

#[test]
fn folds_that_do_not_fit_are_errors() {
    let [points, fields] = snapshots();
    let pod = PodParams::of_rank(2);
    let error = |folds: Result<Folds, InterpolationError>| folds.unwrap_err().to_string();
    assert!(error(Folds::new(3, vec![vec![3]])).contains("index of a sample left out is 3"));
    assert!(error(Folds::new(3, vec![vec![0], vec![]])).contains("samples in each set"));
    assert!(error(Folds::new(3, vec![vec![2, 0, 1]])).contains("samples that are not left out"));
    assert!(error(Folds::new(3, vec![])).contains("1 sets"));
    let other = Folds::new(1000, vec![vec![999]]).unwrap();
    let wrong = validate_podiann((points.as_ref(), fields.as_ref()), &pod, None, &other).unwrap_err();
    assert!(matches!(wrong, ModelError::Interpolation(InterpolationError::Parameter { value: 999.0, .. })));
    let fewer = (points.subcols(0, 9), fields.as_ref());
    assert!(matches!(
        validate_podiann(fewer, &pod, None, &other),
        Err(ModelError::Shape { expected: 9, found: 246, .. })
    ));
}
