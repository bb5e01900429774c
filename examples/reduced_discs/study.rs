//! Reduced models of one quantity, and how far they are off.
use crate::fall::Fallen;
use example_support::Outcome;
use mor::interpolation::{
    Degree, FitProgress, FitStage, Kernel, Method, NetworkParams, RbfParams, SplineParams,
};
use mor::models::{Assessment, CoefficientFit, ModelError, Podiann, Spodiann, SpodiannParams};
use mor::pod::{Pod, PodParams};
use mor::shifted::fourier::Als;
use mor::shifted::{Grid, Interpolation, Motion, Motions};
use mor::{Mat, MatRef};
use render::cpu::Stopwatch;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is reduced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Lambda,
    Velocity,
}

impl Quantity {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Lambda => "solid fraction",
            Self::Velocity => "velocity",
        }
    }
    /// All snapshots as columns.
    pub(crate) fn of(self, fallen: &Fallen) -> MatRef<'_, f64> {
        let data = match self {
            Self::Lambda => &fallen.lambda,
            Self::Velocity => &fallen.velocity,
        };
        let m = fallen.times.len();
        MatRef::from_column_major_slice(data, data.len() / m, m)
    }
}

/// Which modes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Pod,
    /// So many for each disc.
    Shifted([usize; 2]),
}

/// A model and how it did.
pub(crate) struct Fitted {
    pub(crate) kind: Kind,
    pub(crate) modes: usize,
    /// Method given, and the coefficients' method as fitted, of shifted modes for each frame.
    pub(crate) method: &'static str,
    pub(crate) fitted: Vec<String>,
    /// At snapshots it was made of, and between.
    pub(crate) within: Assessment,
    pub(crate) between: Assessment,
    pub(crate) modes_cpu: f64,
    pub(crate) training_cpu: f64,
    /// CPU seconds of one prediction.
    pub(crate) evaluation: f64,
    /// The field in the middle between two snapshots.
    pub(crate) shown: Vec<f64>,
}

/// All models of a quantity.
pub(crate) struct Study {
    pub(crate) quantity: Quantity,
    pub(crate) models: Vec<Fitted>,
    /// Relative singular values of the snapshots as they are, and in the frame of each disc.
    pub(crate) decay: Vec<(String, Vec<f64>)>,
    /// Number of the snapshot that is shown.
    pub(crate) shown: usize,
    pub(crate) shifted: Vec<Spodiann>,
}

/// Of the network's hidden layers, and of its training.
const HIDDEN: [usize; 2] = [24, 24];
const ITERATIONS: usize = 300;
/// Snapshots of which errors are told.
const ASSESSED: usize = 25;

/// Snapshots of a quantity at some of the times.
struct Part {
    points: Mat<f64>,
    snapshots: Mat<f64>,
    motions: Motions,
}

impl Part {
    fn new(fallen: &Fallen, quantity: Quantity, which: &[usize]) -> Self {
        let all = quantity.of(fallen);
        let shift = |k: usize, j: usize| {
            Motion::translation(fallen.paths[k][which[j]].position - fallen.paths[k][0].position)
        };
        Self {
            points: Mat::from_fn(1, which.len(), |_, j| fallen.times[which[j]]),
            snapshots: Mat::from_fn(all.nrows(), which.len(), |i, j| all[(i, which[j])]),
            motions: Motions::by(2, which.len(), shift),
        }
    }
}

impl Study {
    /// `None` if it was stopped.
    pub(crate) fn new(
        fallen: &Fallen,
        quantity: Quantity,
        modes: &[usize],
        most_shifted: usize,
        stop: &AtomicBool,
    ) -> Outcome<Option<Self>> {
        let n = fallen.times.len();
        let training = Part::new(fallen, quantity, &(0..n).step_by(2).collect::<Vec<_>>());
        let stride = 2 * (n / (2 * ASSESSED)).max(1);
        let within = Part::new(fallen, quantity, &(stride / 4 * 2..n).step_by(stride).collect::<Vec<_>>());
        let between =
            Part::new(fallen, quantity, &(stride / 4 * 2 + 1..n).step_by(stride).collect::<Vec<_>>());
        let shown = n / 2 / 2 * 2 + 1;
        let h = fallen.spacing;
        let grid = Grid::new(fallen.cells, [h, h])?.starting_at([0.5 * h, 0.5 * h, 0.0].into());
        let network = NetworkParams { iterations: ITERATIONS, ..NetworkParams::new(&HIDDEN) };
        let (spline, rbf) = (SplineParams::new(Degree::Cubic), RbfParams::new(Kernel::Cubic));
        let methods: [(&'static str, Option<&dyn Method>); 4] = [
            ("network", Some(&network)),
            ("splines", Some(&spline)),
            ("radial functions", Some(&rbf)),
            ("best", None),
        ];
        let mut study = Self { quantity, models: Vec::new(), decay: Vec::new(), shown, shifted: Vec::new() };
        let stopped = || stop.load(Ordering::Relaxed);
        let mut observer = |progress: &FitProgress<'_>| {
            if matches!(progress.innermost().stage, FitStage::Frame | FitStage::Method(_)) {
                eprintln!("  {progress}");
            }
            if stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };

        let watch = Stopwatch::start();
        let most = modes.iter().copied().max().unwrap_or(1);
        let pod = Pod::new(training.snapshots.as_ref(), &PodParams::of_rank(most))?;
        let modes_cpu = watch.elapsed().cpu;
        study.decay.push(("as they are".into(), relative(&pod.singular_values)));
        for &count in modes {
            for (name, method) in methods {
                if stopped() {
                    return Ok(None);
                }
                eprintln!("{}: POD, {count} modes, {name}", quantity.name());
                let watch = Stopwatch::start();
                let (points, modes) = (training.points.as_ref(), pod.truncated(count));
                let model = Podiann::new_observed(points, &modes, method, &mut observer);
                let Some(model) = unless_stopped(model)? else { return Ok(None) };
                let training_cpu = watch.elapsed().cpu;
                let mut field = vec![0.0; model.rows()];
                let watch = Stopwatch::start();
                model.predict(&[fallen.times[shown]], &mut field)?;
                let evaluation = watch.elapsed().cpu;
                study.models.push(Fitted {
                    kind: Kind::Pod,
                    modes: count,
                    method: name,
                    fitted: model.method().map(str::to_owned).into_iter().collect(),
                    within: model.assess(within.points.as_ref(), within.snapshots.as_ref())?,
                    between: model.assess(between.points.as_ref(), between.snapshots.as_ref())?,
                    modes_cpu,
                    training_cpu,
                    evaluation,
                    shown: field,
                });
            }
        }
        for &count in modes.iter().filter(|&&count| count <= most_shifted) {
            let ranks = [count.div_ceil(2), count / 2];
            eprintln!("{}: shifted POD, {count} modes", quantity.name());
            let watch = Stopwatch::start();
            let mut progress = |_: &_| !stopped();
            // Ten steps that gain less than a hundredth are enough for errors of a per cent.
            let found = Als { stagnation: 1e-2, ..Als::new(ranks) }.solve(
                &grid,
                &training.motions,
                training.snapshots.as_ref(),
                None,
                None,
                &mut progress,
            )?;
            let modes_cpu = watch.elapsed().cpu;
            if count == modes.iter().copied().filter(|&c| c <= most_shifted).max().unwrap_or(0) {
                for (k, frame) in found.frames.iter().enumerate() {
                    study
                        .decay
                        .push((format!("along with disc {}", k + 1), relative(&frame.singular_values)));
                }
            }
            for (name, method) in methods {
                if stopped() {
                    return Ok(None);
                }
                let watch = Stopwatch::start();
                let params = SpodiannParams { coefficients: method, paths: None };
                let how = (grid, Interpolation::Spectral);
                let (points, motions) = (training.points.as_ref(), &training.motions);
                let model = Spodiann::new_observed(points, &found, how, motions, params, &mut observer);
                let Some(model) = unless_stopped(model)? else { return Ok(None) };
                let training_cpu = watch.elapsed().cpu;
                let mut field = vec![0.0; model.rows()];
                let watch = Stopwatch::start();
                model.predict(&[fallen.times[shown]], &mut field)?;
                let evaluation = watch.elapsed().cpu;
                study.models.push(Fitted {
                    kind: Kind::Shifted(ranks),
                    modes: count,
                    method: name,
                    fitted: model.coefficient_fits().iter().flatten().map(fitted).collect(),
                    within: model.assess(
                        within.points.as_ref(),
                        within.snapshots.as_ref(),
                        &within.motions,
                    )?,
                    between: model.assess(
                        between.points.as_ref(),
                        between.snapshots.as_ref(),
                        &between.motions,
                    )?,
                    modes_cpu,
                    training_cpu,
                    evaluation,
                    shown: field,
                });
                study.shifted.push(model);
            }
        }
        Ok(Some(study))
    }
}

/// `None` if the observer stopped the fit.
fn unless_stopped<T>(model: Result<T, ModelError>) -> Outcome<Option<T>> {
    match model {
        Err(error) if error.is_stopped() => Ok(None),
        model => Ok(Some(model?)),
    }
}

/// Method of a frame's coefficients, and the axes whose phases are inputs.
fn fitted(of: &CoefficientFit) -> String {
    let axes: String = of.phases.iter().map(|&a| ["x", "y", "z"][a]).collect();
    let phases = if axes.is_empty() { "off".into() } else { axes };
    format!("{}, phases {phases}", of.method)
}

fn relative(values: &[f64]) -> Vec<f64> {
    let first = values.first().copied().unwrap_or(1.0);
    values.iter().map(|s| s / first).take_while(|s| *s > 1e-9).collect()
}
