//! Multilayer perceptrons.
mod activation;
mod adam;
mod features;
mod frequencies;
mod layers;
mod lbfgs;
mod misfit;
mod training;
mod wolfe;

pub use activation::Activation;
pub use adam::Adam;
pub use training::{Epoch, Report, Stop};

use super::interpolator::check_input;
use super::{
    FitObserver, InterpolationError, Interpolator, Method, Record, RecordError, Samples, Scaling, unobserved,
};
use crate::Mat;
use features::Features;
use layers::Layers;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use training::Data;

/// Waves of the inputs that a network sees beside, or instead of, the inputs (Tancik et al., NeurIPS 2020).
#[derive(Clone, Debug, PartialEq)]
pub enum Fourier {
    /// None.
    None,
    /// cos(2πn x_i/Pᵢ) and sin(2πn x_i/Pᵢ), n = 1…`up_to`: the network has the period Pᵢ in input i exactly.
    Multiples {
        /// Pᵢ; infinite for an input that is not periodic, which is seen as it is.
        periods: Vec<f64>,
        /// How many for each.
        up_to: usize,
    },
    /// The waves that explain most of the samples, beside the inputs.
    Found {
        /// How many at most; fewer if they leave less than a thousandth of the squares.
        most: usize,
    },
}

/// How to make a [`Network`].
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkParams {
    /// Neurons of each hidden layer.
    pub hidden: Vec<usize>,
    /// φ.
    pub activation: Activation,
    /// Waves of the inputs.
    pub fourier: Fourier,
    /// Slope of the neurons of the first layer at the start, in inputs scaled to [−1, 1]: how fast functions change that are learnt
    /// easily.
    pub bandwidth: f64,
    /// λ ≥ 0 of the weight decay: λ Σ W² is added to the mean of the squares of errors (of outputs scaled to a mean square of one).
    pub decay: f64,
    /// Share of the samples held out, to stop when their error falls no more and to keep the weights for which it is smallest; 0
    /// for none. The samples at the ends of every input are not held out.
    pub validation: f64,
    /// Iterations without a smaller error of the samples held out before it is stopped.
    pub patience: usize,
    /// The first descent.
    pub adam: Adam,
    /// Iterations of L-BFGS at most, the second descent. With the last layer eliminated they are shared out among five regularisations
    /// of it, each weaker than the one before.
    pub iterations: usize,
    /// Solve for the last layer, which is linear, in every iteration, and descend with the others alone: orders of magnitude more
    /// accurate for samples without noise. Noise it fits sooner as well: hold samples out, give a decay, or leave all weights free.
    pub eliminate: bool,
    /// Of all random numbers.
    pub seed: u64,
    /// Trainings with different random weights, of which the best is kept: by the samples held out, or by the loss.
    pub starts: usize,
}

impl NetworkParams {
    /// These hidden layers with tanh, no waves, no decay, no samples held out, one start.
    #[must_use]
    pub fn new(hidden: &[usize]) -> Self {
        Self {
            hidden: hidden.to_vec(),
            activation: Activation::Tanh,
            fourier: Fourier::None,
            bandwidth: 4.0,
            decay: 0.0,
            validation: 0.0,
            patience: 200,
            adam: Adam::default(),
            iterations: 2500,
            eliminate: true,
            seed: 1,
            starts: 1,
        }
    }
    /// Networks of one hidden layer, as wide as the number of samples suggests, and iterations for a second or so.
    ///
    /// With one input it sees the waves it finds. With more there are usually few samples to each: two networks that begin flat, one
    /// of them with a decay that keeps them smooth between the samples.
    #[must_use]
    pub fn suited(samples: &Samples) -> Vec<Self> {
        let m = samples.len();
        let iterations = (500_000 / m).clamp(200, 2500);
        if samples.inputs() == 1 {
            let fourier = Fourier::Found { most: 8 };
            return vec![Self { fourier, iterations, ..Self::new(&[(m / 4).clamp(4, 64)]) }];
        }
        let flat = Self { bandwidth: 1.0, iterations, ..Self::new(&[(2 * m / 3).clamp(4, 64)]) };
        vec![flat.clone(), Self { decay: 1e-6, ..flat }]
    }
    fn check(&self, samples: &Samples) -> Result<(), InterpolationError> {
        let wrong = |what, value: f64, must| Err(InterpolationError::Parameter { what, value, must });
        let positive = |v: f64| v > 0.0 && v.is_finite();
        if self.hidden.contains(&0) {
            return wrong("number of neurons of a hidden layer", 0.0, "at least 1");
        }
        if self.starts == 0 {
            return wrong("number of starts", 0.0, "at least 1");
        }
        for (what, value) in [
            ("bandwidth", self.bandwidth),
            ("first step of Adam", self.adam.first),
            ("last step of Adam", self.adam.last),
        ] {
            if !positive(value) {
                return wrong(what, value, "positive and finite");
            }
        }
        if !(self.decay >= 0.0 && self.decay.is_finite()) {
            return wrong("weight decay", self.decay, "0 or positive, and finite");
        }
        if !(0.0..1.0).contains(&self.validation) {
            return wrong("share of samples held out", self.validation, "from 0 to below 1");
        }
        if samples.len() < 2 {
            return Err(InterpolationError::TooFew {
                what: "a network".into(),
                of: "samples",
                needed: 2,
                found: samples.len(),
            });
        }
        Ok(())
    }
    /// Those held out, ascending.
    fn held_out(&self, samples: &Samples) -> Vec<usize> {
        let inside = |j: &usize| {
            let ends = samples.domain().iter().zip(samples.point(*j));
            ends.clone().all(|([low, high], x)| low == high || (low < x && x < high))
        };
        let mut left: Vec<usize> = (0..samples.len()).filter(inside).collect();
        let count = (self.validation * samples.len() as f64).round() as usize;
        let mut random = Pcg64::seed_from_u64(self.seed ^ 0x5eed);
        let mut held: Vec<usize> = (0..count.min(left.len()))
            .map(|_| left.swap_remove(random.random_range(0..left.len())))
            .collect();
        held.sort_unstable();
        held
    }
    /// Trains a network with the samples.
    ///
    /// # Errors
    /// [`InterpolationError::Parameter`], [`InterpolationError::TooFew`] of one sample, [`InterpolationError::Shape`] if there is not
    /// one period for each input, [`InterpolationError::Diverged`].
    pub fn network(&self, samples: &Samples) -> Result<Network, InterpolationError> {
        self.network_observed(samples, &mut unobserved)
    }
    /// The same with an observer of every loss: [`FitStage::Start`](super::FitStage::Start), and in
    /// it [`FitStage::Adam`](super::FitStage::Adam) and
    /// [`FitStage::Lbfgs`](super::FitStage::Lbfgs). Once it stops, the network has the best weights
    /// so far, and [`Report::stopped`] is true.
    ///
    /// # Errors
    /// As [`network`](Self::network).
    pub fn network_observed(
        &self,
        samples: &Samples,
        observer: FitObserver<'_>,
    ) -> Result<Network, InterpolationError> {
        self.check(samples)?;
        let features = Features::new(&self.fourier, samples)?;
        let scaling = Scaling::by_common_deviation(samples.values());
        let sizes = [&[features.len()], self.hidden.as_slice(), &[samples.outputs()]].concat();
        let layers = Layers { sizes, activation: self.activation };
        let held_out = self.held_out(samples);
        let rest: Vec<usize> = (0..samples.len()).filter(|j| held_out.binary_search(j).is_err()).collect();
        let pick = |which: &[usize]| {
            let mut x = Mat::zeros(features.len(), which.len());
            let mut y = Mat::zeros(samples.outputs(), which.len());
            for (to, &from) in which.iter().enumerate() {
                features.apply(samples.point(from), x.col_as_slice_mut(to));
                scaling.apply(samples.value(from), y.col_as_slice_mut(to));
            }
            [x, y]
        };
        let data =
            Data { train: pick(&rest), held: pick(&held_out), held_out, steepness: features.steepness() };
        let (weights, report) = training::train(self, &layers, &data, observer);
        if !report.score().is_finite() {
            return Err(InterpolationError::Diverged { iterations: report.history.len() });
        }
        let domain = samples.domain().to_vec();
        Ok(Network { features, layers, weights, scaling, domain, report: Some(report) })
    }
}

impl Method for NetworkParams {
    fn name(&self) -> String {
        let hidden: Vec<String> = self.hidden.iter().map(ToString::to_string).collect();
        let waves = match &self.fourier {
            Fourier::None => String::new(),
            Fourier::Multiples { up_to, .. } => format!(" + {up_to} multiples"),
            Fourier::Found { .. } => " + waves".into(),
        };
        let decay = if self.decay > 0.0 { format!(", decay {:.0e}", self.decay) } else { String::new() };
        let free = if self.eliminate { "" } else { ", all weights free" };
        format!("{} network {}{waves}{decay}{free}", self.activation.name(), hidden.join(" × "))
    }
    /// A training that was stopped is an error, as the [`Report`] that states it is out of reach.
    fn fit_observed(
        &self,
        samples: &Samples,
        observer: FitObserver<'_>,
    ) -> Result<Box<dyn Interpolator>, InterpolationError> {
        let network = self.network_observed(samples, observer)?;
        if network.report.as_ref().is_some_and(|report| report.stopped) {
            return Err(InterpolationError::Stopped);
        }
        Ok(Box::new(network))
    }
}

/// y(x) = W_L φ(… φ(W₁ f(x) + b₁) …) + b_L, with features f of the scaled inputs, and scaled outputs.
///
/// Trained with all samples at once: exact gradients by back-propagation, Adam, then L-BFGS. It goes near the samples, not through
/// them. One prediction costs as many multiplications as there are weights.
#[derive(Clone, Debug)]
pub struct Network {
    features: Features,
    layers: Layers,
    weights: Vec<f64>,
    scaling: Scaling,
    domain: Vec<[f64; 2]>,
    report: Option<Report>,
}

impl Network {
    pub(super) const KIND: &str = "network";

    /// How it was trained; none of a loaded one.
    #[must_use]
    pub fn report(&self) -> Option<&Report> {
        self.report.as_ref()
    }
    /// How many weights and shifts it has.
    #[must_use]
    pub fn parameters(&self) -> usize {
        self.weights.len()
    }
    /// Frequencies of its waves as columns (d × number), in cycles per unit of the inputs.
    #[must_use]
    pub fn frequencies(&self) -> Mat<f64> {
        self.features.frequencies()
    }
    /// All layers at x, the last one into `out`, not yet unscaled.
    fn pass(&self, x: &[f64], out: &mut [f64]) -> layers::Pass {
        let mut features = Mat::zeros(self.features.len(), 1);
        self.features.apply(x, features.col_as_slice_mut(0));
        let mut pass = self.layers.pass(1);
        self.layers.forward(&self.weights, features.as_ref(), 0..self.layers.depth(), &mut pass);
        out.copy_from_slice(pass.outputs().col_as_slice(0));
        pass
    }

    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect(Self::KIND)?;
        let name = record.word("activation")?;
        let activation = Activation::ALL.into_iter().find(|a| a.name() == name);
        let activation = activation.ok_or_else(|| record.wrong("activation", format!("is `{name}`")))?;
        let features = Features::from_record(&record.record("features")?)?;
        let sizes = record.counts("sizes")?;
        if sizes.len() < 2 || sizes.contains(&0) || sizes[0] != features.len() {
            return Err(record.wrong("sizes", format!("is {sizes:?} with {} features", features.len())));
        }
        let outputs = sizes[sizes.len() - 1];
        let product = |w: &[usize]| w[0].saturating_add(1).saturating_mul(w[1]);
        let count = sizes.windows(2).map(product).fold(0, usize::saturating_add);
        let weights = record.numbers_of("weights", count)?.to_vec();
        let domain = record.numbers_of("domain", features.inputs().saturating_mul(2))?;
        Ok(Self {
            layers: Layers { sizes, activation },
            weights,
            scaling: Scaling::from_record(&record.record("scaling")?, outputs)?,
            domain: domain.as_chunks::<2>().0.to_vec(),
            features,
            report: None,
        })
    }
}

impl Interpolator for Network {
    fn inputs(&self) -> usize {
        self.features.inputs()
    }
    fn outputs(&self) -> usize {
        self.scaling.rows()
    }
    fn domain(&self) -> &[[f64; 2]] {
        &self.domain
    }
    fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), InterpolationError> {
        InterpolationError::check_prediction([self.inputs(), self.outputs()], x, out)?;
        self.pass(x, out);
        self.scaling.undo(out);
        Ok(())
    }
    fn derivative(&self, x: &[f64], input: usize, out: &mut [f64]) -> Result<(), InterpolationError> {
        InterpolationError::check_prediction([self.inputs(), self.outputs()], x, out)?;
        check_input(input, self.inputs())?;
        let pass = self.pass(x, out);
        let change = self.layers.tangent(&self.weights, &self.features.slopes(x, input), &pass);
        for (i, (out, change)) in out.iter_mut().zip(change).enumerate() {
            *out = change / self.scaling.factor(i);
        }
        Ok(())
    }
    fn record(&self) -> Record {
        Record::new(Self::KIND)
            .with_word("activation", self.layers.activation.name())
            .with("sizes", self.layers.sizes.iter().map(|&n| n as f64))
            .with("weights", self.weights.iter().copied())
            .with("domain", self.domain.iter().flatten().copied())
            .with_record("features", &self.features.record())
            .with_record("scaling", &self.scaling.record())
    }
}

#[cfg(test)]
mod tests;
