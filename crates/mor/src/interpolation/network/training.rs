//! From a start to weights that fit.
use super::layers::Layers;
use super::lbfgs::{self, Limits};
use super::misfit::Misfit;
use super::{Activation, NetworkParams};
use crate::interpolation::{FitObserver, FitProgress, FitStage};
use crate::{Mat, MatRef};
use cpu_time::ThreadTime;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Why a descent ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stop {
    /// All its steps were made.
    Iterations,
    /// The error of the samples held out did not fall any more.
    Validation,
    /// The gradient vanishes.
    Gradient,
    /// The loss falls no more.
    Flat,
    /// No lower place was found in the direction of descent: the loss is at round-off.
    LineSearch,
    /// The loss is not a number.
    NotFinite,
    /// The observer stopped it.
    Observer,
}

/// State of one iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Epoch {
    /// Loss over the samples trained with: mean of the squares of errors of outputs scaled to a mean square of one, and the decay.
    pub loss: f64,
    /// The same mean over the samples held out, without decay.
    pub validation: Option<f64>,
}

/// How a network was trained.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// One entry per step of Adam, then for each start of L-BFGS (one for each ridge of the last layer) and each iteration of it.
    pub history: Vec<Epoch>,
    /// How many of them are Adam's.
    pub adam_steps: usize,
    /// Why Adam ended.
    pub adam_stop: Stop,
    /// Why L-BFGS ended.
    pub lbfgs_stop: Stop,
    /// Where in the history the weights that were kept are from.
    pub kept: usize,
    /// Which start this was, from 0.
    pub start: usize,
    /// Whether the observer stopped the training, in this start or a later one.
    pub stopped: bool,
    /// CPU seconds of all starts together.
    pub cpu_seconds: f64,
    /// Samples that were held out.
    pub held_out: Vec<usize>,
}

impl Report {
    /// Of the weights that were kept; smaller is better.
    #[must_use]
    pub fn score(&self) -> f64 {
        self.history.get(self.kept).map_or(f64::INFINITY, score)
    }
}

fn score(epoch: &Epoch) -> f64 {
    epoch.validation.unwrap_or(epoch.loss)
}

/// Features and scaled values of the samples (columns), and which are held out.
pub(super) struct Data {
    pub(super) train: [Mat<f64>; 2],
    pub(super) held: [Mat<f64>; 2],
    pub(super) held_out: Vec<usize>,
    /// Largest slope of every feature.
    pub(super) steepness: Vec<f64>,
}

/// Ridges of the eliminated last layer, one after the other: at once with the last, the first steps lead to dependent neurons with
/// huge weights that cancel, and no step leads out; with the first alone the error stays at its root.
const RIDGES: [f64; 5] = [1e-12, 1e-14, 1e-16, 1e-18, 1e-20];

/// The best of several starts.
pub(super) fn train(
    params: &NetworkParams,
    layers: &Layers,
    data: &Data,
    observer: FitObserver<'_>,
) -> (Vec<f64>, Report) {
    let begin = ThreadTime::now();
    let mut best = one(params, layers, data, 0, &mut *observer);
    for start in 1..params.starts {
        if best.1.stopped {
            break;
        }
        let other = one(params, layers, data, start, &mut *observer);
        let stopped = other.1.stopped;
        if other.1.score() < best.1.score() {
            best = other;
        }
        best.1.stopped = stopped;
    }
    best.1.cpu_seconds = begin.elapsed().as_secs_f64();
    best
}

/// Keeps the best weights seen, and reports every loss.
struct Watch<'a> {
    held: Option<Misfit<'a>>,
    patience: usize,
    report: Report,
    best: f64,
    weights: Vec<f64>,
    /// Since when the best has not changed.
    since: usize,
    /// Start, and descent with the number of its losses at most.
    start: FitProgress<'static>,
    descent: FitProgress<'static>,
    observer: FitObserver<'a>,
}

impl Watch<'_> {
    fn see(&mut self, weights: &[f64], loss: f64) -> Option<Stop> {
        let validation = self.held.as_mut().map(|held| held.error(weights));
        let epoch = Epoch { loss, validation };
        let score = score(&epoch);
        self.report.history.push(epoch);
        if !(loss.is_finite() && score.is_finite()) {
            return Some(Stop::NotFinite);
        }
        self.since += 1;
        if score < self.best {
            self.best = score;
            self.weights.copy_from_slice(weights);
            self.report.kept = self.report.history.len() - 1;
            self.since = 0;
        }
        self.descent.step += 1;
        let progress = FitProgress { inner: Some(&self.descent.with_loss(loss)), ..self.start };
        if (self.observer)(&progress).is_break() {
            self.report.stopped = true;
            return Some(Stop::Observer);
        }
        (validation.is_some() && self.since >= self.patience).then_some(Stop::Validation)
    }
}

fn one(
    params: &NetworkParams,
    layers: &Layers,
    data: &Data,
    start: usize,
    observer: FitObserver<'_>,
) -> (Vec<f64>, Report) {
    let [x, y] = data.train.each_ref().map(Mat::as_ref);
    let initial = initial(params, layers, x, &data.steepness, start);
    let mut misfit = Misfit::new(layers, [x, y], params.decay, params.eliminate);
    let held = data.held.each_ref().map(Mat::as_ref);
    let report = Report {
        history: Vec::new(),
        adam_steps: 0,
        adam_stop: Stop::Iterations,
        lbfgs_stop: Stop::Iterations,
        kept: 0,
        start,
        stopped: false,
        cpu_seconds: 0.0,
        held_out: data.held_out.clone(),
    };
    let mut watch = Watch {
        held: (held[0].ncols() > 0).then(|| Misfit::new(layers, held, 0.0, false)),
        patience: params.patience,
        report,
        best: f64::INFINITY,
        weights: initial.clone(),
        since: 0,
        start: FitProgress::new(FitStage::Start, start + 1, params.starts),
        descent: FitProgress::new(FitStage::Adam, 0, params.adam.steps),
        observer,
    };
    let mut theta = initial[..misfit.len()].to_vec();
    let needed: Vec<f64> =
        RIDGES.into_iter().filter(|ridge| params.eliminate && *ridge > params.decay).collect();
    let ridges = if needed.is_empty() { vec![0.0] } else { needed };
    misfit.ridge = ridges[0];
    watch.report.adam_stop =
        params.adam.minimise(&mut misfit, &mut theta, &mut |m, loss| watch.see(m.weights(), loss));
    watch.report.adam_steps = watch.report.history.len();
    if watch.report.stopped {
        watch.report.lbfgs_stop = Stop::Observer;
        return (watch.weights, watch.report);
    }
    theta.copy_from_slice(&watch.weights[..misfit.len()]);
    watch.since = 0;
    let iterations = params.iterations.div_ceil(ridges.len());
    watch.descent = FitProgress::new(FitStage::Lbfgs, 0, ridges.len() * (iterations + 1));
    let limits = Limits { iterations, memory: 20, gradient: 1e-14, decrease: 1e-9 };
    for ridge in ridges {
        misfit.ridge = ridge;
        watch.report.lbfgs_stop =
            lbfgs::minimise(&mut misfit, &mut theta, &limits, &mut |m, loss| watch.see(m.weights(), loss));
        if matches!(watch.report.lbfgs_stop, Stop::Validation | Stop::NotFinite | Stop::Observer) {
            break;
        }
    }
    (watch.weights, watch.report)
}

/// Weights to start from. The first layer lets every feature contribute slopes within ± the bandwidth, over the root of their number,
/// and its neurons are centred at samples drawn at random; the others are uniform as Glorot & Bengio (2010) have it for tanh and SiLU,
/// and Sitzmann et al. (2020) for sine.
fn initial(
    params: &NetworkParams,
    layers: &Layers,
    x: MatRef<'_, f64>,
    steepness: &[f64],
    start: usize,
) -> Vec<f64> {
    let mut random = Pcg64::seed_from_u64(params.seed.wrapping_add(start as u64));
    let mut weights = vec![0.0; layers.len()];
    for l in 0..layers.depth() {
        let [n, next] = [layers.sizes[l], layers.sizes[l + 1]];
        let [matrix, shifts] = layers.places(l);
        let first = l == 0 && layers.depth() > 1;
        let bound = match params.activation {
            _ if first => 1.0,
            Activation::Sine if l + 1 < layers.depth() => (6.0 / n as f64).sqrt(),
            _ => (6.0 / (n + next) as f64).sqrt(),
        };
        for w in &mut weights[matrix.clone()] {
            *w = random.random_range(-bound..bound);
        }
        if first {
            for (i, w) in weights[matrix.clone()].iter_mut().enumerate() {
                *w *= params.bandwidth / (steepness[i / next] * (n as f64).sqrt());
            }
            for i in 0..next {
                let centre = random.random_range(0..x.ncols());
                let sum: f64 = (0..n).map(|j| weights[matrix.start + i + j * next] * x[(j, centre)]).sum();
                weights[shifts.start + i] = -sum;
            }
        }
    }
    weights
}
