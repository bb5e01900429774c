//! How well samples are predicted from the others.
use super::{FitObserver, Folds, InterpolationError, Method, Samples, unobserved};
use cpu_time::ThreadTime;

/// Errors of predictions of samples that were left out.
#[derive(Clone, Debug, PartialEq)]
pub struct CrossValidation {
    /// (Σ |ŷᵢ − yᵢ|²/Σ |yᵢ|²)^½ over all outputs of all samples left out.
    pub error: f64,
    /// The same of every output alone; an output that is zero everywhere has 0 if it is predicted so, else infinity.
    pub per_output: Vec<f64>,
    /// max |ŷᵢ − yᵢ|, and of which sample.
    pub worst: (f64, usize),
    /// How many predictions were made: a sample may be in several sets.
    pub predictions: usize,
    /// CPU seconds of all fits and predictions.
    pub cpu_seconds: f64,
}

/// Leaves out each of the sets in turn.
///
/// # Errors
/// Those of the method with a part of the samples; [`InterpolationError::TooFew`] if no set has a sample, or one has them all.
pub fn cross_validate(
    method: &dyn Method,
    samples: &Samples,
    folds: &Folds,
) -> Result<CrossValidation, InterpolationError> {
    cross_validate_observed(method, samples, folds, &mut unobserved)
}

/// The same with an observer: [`FitStage::Fold`](super::FitStage::Fold), or the steps of a search
/// if the method leaves samples out in closed form.
///
/// # Errors
/// As [`cross_validate`]; [`InterpolationError::Stopped`] by the observer.
pub fn cross_validate_observed(
    method: &dyn Method,
    samples: &Samples,
    folds: &Folds,
    observer: FitObserver<'_>,
) -> Result<CrossValidation, InterpolationError> {
    let begin = ThreadTime::now();
    let k = samples.outputs();
    let (mut off, mut norm) = (vec![0.0; k], vec![0.0; k]);
    let (mut worst, mut predictions) = ((0.0, 0), 0);
    for (set, errors) in folds.sets().iter().zip(method.left_out(samples, folds, observer)?) {
        for (j, &sample) in set.iter().enumerate() {
            let mut sum = 0.0;
            for row in 0..k {
                let square = errors[(row, j)].powi(2);
                sum += square;
                off[row] += square;
                norm[row] += samples.value(sample)[row].powi(2);
            }
            predictions += 1;
            if predictions == 1 || sum.sqrt() > worst.0 {
                worst = (sum.sqrt(), sample);
            }
        }
    }
    if predictions == 0 {
        let (what, of) = ("cross-validation".into(), "samples that are left out");
        return Err(InterpolationError::TooFew { what, of, needed: 1, found: 0 });
    }
    let relative = |off: f64, norm: f64| if off == 0.0 { 0.0 } else { (off / norm).sqrt() };
    Ok(CrossValidation {
        error: relative(off.iter().sum(), norm.iter().sum()),
        per_output: off.iter().zip(&norm).map(|(o, n)| relative(*o, *n)).collect(),
        worst,
        predictions,
        cpu_seconds: begin.elapsed().as_secs_f64(),
    })
}

#[cfg(test)]
mod tests;
