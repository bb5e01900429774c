//! Observers of fits: order and counts of what is reported, stops, and results that do not depend
//! on who looks.
use interfaces::Vector;
use mor::interpolation::{
    Degree, FitObserver, FitProgress, FitStage, Folds, HarmonicsParams, InterpolationError, Interpolator,
    Kernel, Method, NetworkParams, ProductParams, RbfParams, Samples, SplineParams, Stop, VaryingParams,
    best_of, best_of_observed, compare_observed, cross_validate_observed,
};
use mor::models::{ModelError, Podiann, Spodiann, SpodiannParams};
use mor::pod::{Pod, PodParams};
use mor::shifted::{Grid, Interpolation, Motion, Motions, Progress, Ranks, ShiftedPod};
use mor::{Mat, MatRef};
use std::ops::ControlFlow;

/// Stages of one report from the outermost: kind, name, step, bound.
type Chain = Vec<(String, usize, Option<usize>)>;

fn chain(progress: &FitProgress<'_>) -> Chain {
    let own = (progress.stage.to_string(), progress.step, progress.of);
    [own].into_iter().chain(progress.inner.map(chain).unwrap_or_default()).collect()
}

/// Kind of a stage without the name of its method, and whether all steps of its bound are made.
fn kind(stage: &str) -> (&str, bool) {
    let is_exact = !["Adam", "L-BFGS", "shape parameter", "number of terms"].contains(&stage);
    let kinds = ["method", "fit by"];
    (kinds.into_iter().find(|k| stage.starts_with(k)).unwrap_or(stage), is_exact)
}

/// Steps count from 1 without gaps up to their bound, and within a step the same holds.
fn check(chains: &[Chain]) {
    let ended = |of: &[(String, usize, Option<usize>)]| {
        of.iter().all(|(stage, step, bound)| !kind(stage).1 || Some(*step) == *bound)
    };
    for (before, now) in [Chain::new()].iter().chain(chains).zip(chains) {
        assert!(now.iter().all(|(_, step, of)| *step >= 1 && of.is_none_or(|of| *step <= of)), "{now:?}");
        let same = before.iter().zip(now).take_while(|(a, b)| a == b).count();
        assert!(same < now.len(), "{now:?} twice");
        assert!(now[same + 1..].iter().all(|(_, step, _)| *step == 1), "{now:?}");
        if same < before.len() {
            assert!(ended(&before[same + 1..]), "{before:?}, then {now:?}");
            let ((old, last, bound), (new, step, of)) = (&before[same], &now[same]);
            let next = *step == last + 1 && bound == of && kind(old).0 == kind(new).0;
            assert!(next || *step == 1 && ended(&before[same..]), "{before:?}, then {now:?}");
        } else {
            assert_eq!(now[same].1, 1, "{now:?}");
        }
    }
    assert!(chains.last().is_some_and(|last| ended(last)), "{:?}", chains.last());
}

/// Number of reports of a fit that is only observed, in order; stops after some of them end it at
/// once.
fn observed<T>(fit: &dyn Fn(FitObserver<'_>) -> T, is_stopped: &dyn Fn(&T) -> bool) -> (T, Vec<Chain>) {
    let mut chains = vec![];
    let result = fit(&mut |progress| {
        chains.push(chain(progress));
        ControlFlow::Continue(())
    });
    assert!(!is_stopped(&result));
    check(&chains);
    let stride = (chains.len() / 23).max(1);
    for most in (1..=chains.len()).filter(|k| *k <= 5 || k % stride == 0 || *k == chains.len()) {
        let mut calls = 0;
        let result = fit(&mut |progress| {
            assert_eq!(chain(progress), chains[calls]);
            calls += 1;
            if calls < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        assert!(is_stopped(&result) && calls == most, "{calls} calls, {most} wanted");
    }
    (result, chains)
}

fn stopped<T>(result: &Result<T, InterpolationError>) -> bool {
    matches!(result, Err(InterpolationError::Stopped))
}

fn model_stopped<T>(result: &Result<T, ModelError>) -> bool {
    result.as_ref().is_err_and(ModelError::is_stopped)
}

fn stages(chains: &[Chain]) -> Vec<&str> {
    let mut all: Vec<&str> = chains.iter().flatten().map(|(stage, ..)| kind(stage).0).collect();
    all.sort_unstable();
    all.dedup();
    all
}

/// 12 times at 4 parameters.
fn samples() -> Samples {
    let points = Mat::from_fn(2, 48, |i, j| if i == 0 { (j % 12) as f64 } else { (j / 12) as f64 });
    let value = |t: f64, mu: f64| (0.5 * t).sin() + 0.1 * mu * t.cos();
    let values = Mat::from_fn(2, 48, |i, j| value(points[(0, j)] + i as f64, points[(1, j)]));
    Samples::new(points.as_ref(), values.as_ref()).unwrap()
}

fn network() -> NetworkParams {
    let params = NetworkParams::new(&[4]);
    NetworkParams { adam: mor::interpolation::Adam { steps: 8, ..params.adam }, iterations: 15, ..params }
}

#[test]
fn networks() {
    let (samples, params) = (samples(), NetworkParams { starts: 2, ..network() });
    let fit = |observer: FitObserver<'_>| params.network_observed(&samples, observer).unwrap();
    let (found, chains) = observed(&fit, &|network| network.report().unwrap().stopped);
    let alone = params.network(&samples).unwrap();
    assert_eq!(found.record().to_bytes(), alone.record().to_bytes());
    assert_eq!(found.report().unwrap().history, alone.report().unwrap().history);
    assert_eq!(stages(&chains), ["Adam", "L-BFGS", "start"]);

    // Losses are those of the history, of the start that was kept.
    let mut losses = vec![];
    fit(&mut |progress| {
        if progress.step == found.report().unwrap().start + 1 {
            losses.push(progress.innermost().loss.unwrap());
        }
        ControlFlow::Continue(())
    });
    let history = &found.report().unwrap().history;
    assert_eq!(losses, history.iter().map(|epoch| epoch.loss).collect::<Vec<_>>());

    for (most, stops) in [(5, [Stop::Observer; 2]), (12, [Stop::Iterations, Stop::Observer])] {
        let mut calls = 0;
        let network = fit(&mut |_| {
            calls += 1;
            if calls < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        let report = network.report().unwrap();
        assert_eq!(([report.adam_stop, report.lbfgs_stop], report.history.len()), (stops, most));
        // The best weights so far.
        let losses: Vec<f64> = report.history.iter().map(|epoch| epoch.loss).collect();
        assert_eq!(report.score(), losses.iter().copied().fold(f64::INFINITY, f64::min));
        assert_eq!(report.history, history[..most].to_vec());
    }
}

#[test]
fn methods() {
    let samples = samples();
    let phases = Mat::from_fn(3, 48, |i, j| match i {
        0 => j as f64,
        1 => (0.7 * j as f64).cos(),
        _ => (0.7 * j as f64).sin(),
    });
    let phased = Samples::new(phases.as_ref(), samples.values()).unwrap();
    let spline = SplineParams::new(Degree::Cubic);
    let gaussian = || Box::new(RbfParams::new(Kernel::Gaussian));
    let varying = VaryingParams { degree: Degree::Cubic, slow: 1 };
    let cases: [(Box<dyn Method>, &Samples, &[&str]); 5] = [
        (gaussian(), &samples, &["shape parameter"]),
        (Box::new(network()), &samples, &["Adam", "L-BFGS", "start"]),
        (Box::new(ProductParams { first: spline, others: gaussian() }), &samples, &["shape parameter"]),
        (Box::new(varying), &phased, &["number of terms"]),
        (
            Box::new(HarmonicsParams { amplitudes: gaussian(), slow: 1 }),
            &phased,
            &["number of terms", "shape parameter"],
        ),
    ];
    for (method, samples, expected) in cases {
        let (found, chains) = observed(&|observer| method.fit_observed(samples, observer), &|f| stopped(f));
        assert_eq!(found.unwrap().record().to_bytes(), method.fit(samples).unwrap().record().to_bytes());
        assert_eq!(stages(&chains), expected, "{}", method.name());
    }
}

fn three() -> Vec<Box<dyn Method>> {
    vec![
        Box::new(SplineParams::new(Degree::Linear)),
        Box::new(RbfParams::new(Kernel::Gaussian)),
        Box::new(network()),
    ]
}

#[test]
fn comparisons() {
    let (samples, methods) = (samples(), three());
    let folds = Folds::suited(&samples, 1).unwrap();
    let validate = |observer: FitObserver<'_>| {
        cross_validate_observed(methods[0].as_ref(), &samples, &folds, observer).map(|of| of.error)
    };
    let (_, chains) = observed(&validate, &|result| stopped(result));
    assert_eq!((chains.len(), stages(&chains)), (folds.sets().len(), vec!["fold"]));

    let best = |observer: FitObserver<'_>| best_of_observed(&methods, &samples, &folds, observer);
    let (found, chains) = observed(&best, &|result| stopped(result));
    let (found, alone) = (found.unwrap(), best_of(&methods, &samples, &folds).unwrap());
    assert_eq!(found.interpolator.record().to_bytes(), alone.interpolator.record().to_bytes());
    assert_eq!(found.table.rows.len(), 3);
    let expected = ["Adam", "L-BFGS", "fit by", "fold", "method", "shape parameter", "start"];
    assert_eq!(stages(&chains), expected);
    assert_eq!(chains[0], [("method linear spline".to_string(), 1, Some(3))]);

    // Rows from the one under way on state that they were stopped; no row is reported after that.
    let mut reports = vec![];
    let table = compare_observed(&methods, &samples, &folds, &mut |progress: &FitProgress<'_>| {
        reports.push(progress.to_string());
        if progress.step < 2 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    let ends: Vec<bool> = table.rows.iter().map(|row| stopped(&row.outcome)).collect();
    assert_eq!((ends, table.best()), (vec![false, true, true], Some(0)));
    assert_eq!(reports[1], format!("method linear spline 1/3, fold 1/{}", folds.sets().len()));
    assert_eq!(reports.last().unwrap(), "method Gaussian RBF 2/3");
}

#[test]
fn models_with_modes_that_stay() {
    let samples = samples();
    let field = Mat::from_fn(40, 48, |x, j| {
        let y = samples.value(j);
        (0.1 * x as f64).sin() * y[0] + (0.2 * x as f64).cos() * y[1]
    });
    let pod = Pod::new(field.as_ref(), &PodParams::of_rank(2)).unwrap();
    let gaussian = RbfParams::new(Kernel::Gaussian);
    for (method, expected) in [
        (
            Some(&gaussian as &dyn Method),
            &["error estimate", "fit by", "fold", "method", "shape parameter"][..],
        ),
        (Some(&SplineParams::new(Degree::Linear)), &["error estimate", "fit by", "fold", "method"]),
    ] {
        let fit = |observer: FitObserver<'_>| Podiann::new_observed(samples.points(), &pod, method, observer);
        let (found, chains) = observed(&fit, &|result| model_stopped(result));
        let alone = Podiann::new(samples.points(), &pod, method).unwrap();
        assert_eq!(found.unwrap().record().to_bytes(), alone.record().to_bytes());
        assert_eq!(stages(&chains), expected);
        let fits = chains.iter().filter(|chain| chain.len() == 1 && kind(&chain[0].0).0 == "fit by");
        assert_eq!(fits.count(), 1, "all samples are fitted once");
    }
}

#[test]
fn models_with_modes_that_move() {
    let (n, m) = (40, 24);
    let grid = Grid::new([n], [1.0]).unwrap();
    let place = |k: usize, j: usize| [1.3 * j as f64, -0.6 * j as f64][k];
    let motions = Motions::by(2, m, |k, j| Motion::translation(Vector::new(place(k, j), 0.0, 0.0)));
    let wave = |x: f64| (0.4 * (std::f64::consts::TAU * x / n as f64).cos()).exp();
    let snapshots = Mat::from_fn(n, m, |x, j| {
        wave(x as f64 - place(0, j)) + (0.1 * j as f64).cos() * wave(x as f64 - place(1, j)).powi(3)
    });
    let decomposition = ShiftedPod::new(grid, Interpolation::Spectral)
        .ranks(Ranks::Given(vec![1, 1]))
        .max_steps(30)
        .solve(&motions, snapshots.as_ref(), None, &mut |_: &Progress| ControlFlow::Continue(()))
        .unwrap();
    let times = Mat::from_fn(1, m, |_, j| j as f64);
    let points: MatRef<'_, f64> = times.as_ref();
    let how = (grid, Interpolation::Spectral);
    let params = SpodiannParams::default();
    let fit = |observer: FitObserver<'_>| {
        Spodiann::new_observed(points, &decomposition, how, &motions, params, observer)
    };
    let (found, chains) = observed(&fit, &|result| model_stopped(result));
    let alone = Spodiann::new(points, &decomposition, how, &motions, params).unwrap();
    assert_eq!(found.unwrap().record().to_bytes(), alone.record().to_bytes());
    let expected =
        ["error estimate", "fit by", "fold", "frame", "method", "number of terms", "paths", "set of inputs"];
    assert_eq!(stages(&chains), expected);
    let outermost: Vec<&Chain> = chains.iter().filter(|chain| chain.len() == 1).collect();
    let outermost: Vec<(&str, usize)> = outermost.iter().map(|c| (&c[0].0[..], c[0].1)).collect();
    assert_eq!(outermost, [("paths", 1), ("frame", 1), ("frame", 2)]);
}

#[test]
fn progress_in_words() {
    let adam = FitProgress::new(FitStage::Adam, 37, 500).with_loss(1.25e-3);
    let fold = FitProgress { inner: Some(&adam), ..FitProgress::new(FitStage::Fold, 4, 5) };
    let method = FitStage::Method("cubic RBF");
    let all = FitProgress { inner: Some(&fold), ..FitProgress::new(method, 2, None) };
    assert_eq!(all.to_string(), "method cubic RBF 2, fold 4/5, Adam 37/500: loss 1.250e-3");
    assert_eq!(all.innermost(), &adam);
}
