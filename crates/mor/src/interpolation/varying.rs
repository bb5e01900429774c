//! Trigonometric polynomials of phases with coefficients that vary slowly.
mod complexity;
mod terms;

use super::interpolator::check_input;
use super::scaling::ranges;
use super::waves::Waves;
use super::{
    Degree, FitObserver, Folds, InterpolationError, Interpolator, Method, Record, RecordError, Samples,
    unobserved,
};
use crate::Mat;
use complexity::{Complexity, Fit};
use terms::Terms;

/// How to make a [`Varying`] function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VaryingParams {
    /// Degree of the spline in the first input.
    pub degree: Degree,
    /// Number of slow inputs, the first ones; the others are pairs (cos θ_a, sin θ_a).
    pub slow: usize,
}

/// y(u, θ) = g₀(u) + Σ_f T_f(θ) g_f(u) with slow inputs u = (t, μ) and phases θ, given as cos θ_a, sin θ_a: a varying-coefficient model (Hastie and Tibshirani,
/// J. R. Stat. Soc. B 55 (1993) 757).
///
/// g₀ is a spline in t times polynomials of μ of total degree r₀; T_f are products of cos kθ_a and sin kθ_a with Σ|k| ≤ q; g_f are polynomials of u of total
/// degree r₁ (Legendre's, on the samples' domain). With θ = 2πs/h of a displacement s(u) it follows the aliasing of a sharp edge on a grid of spacing h, however
/// far the body moves between samples.
///
/// Least squares with a ridge ρ. Pieces of the spline (knots at quantiles of t), r₀, r₁, q and ρ are those with the smallest error of predictions of samples left
/// out in the [`suited`](Folds::suited) sets of u, found by steps of one of them at a time from the simplest function: terms that samples do not determine are
/// left out or small. One prediction costs as many multiplications as terms times outputs.
#[derive(Clone, Debug)]
pub struct Varying {
    terms: Terms,
    /// k × terms.
    coefficients: Mat<f64>,
    domain: Vec<[f64; 2]>,
}

impl VaryingParams {
    fn complexity<'a>(
        &self,
        samples: &'a Samples,
        observer: FitObserver<'_>,
    ) -> Result<(Fit<'a>, Complexity), InterpolationError> {
        let phases = samples.inputs().saturating_sub(self.slow);
        if self.slow == 0 || self.slow > samples.inputs() || phases % 2 == 1 {
            return Err(InterpolationError::Parameter {
                what: "number of slow inputs",
                value: self.slow as f64,
                must: "positive, and followed by pairs of a cosine and a sine",
            });
        }
        let slow = samples.first_inputs(self.slow);
        let fit = Fit { samples, degree: self.degree, slow: self.slow, times: slow.distinct(0) };
        let found = fit.best(&Folds::suited(&slow, 1)?, observer)?;
        Ok((fit, found))
    }
    /// The function near the samples.
    ///
    /// # Errors
    /// [`InterpolationError::TooFew`]; [`InterpolationError::Parameter`] if the inputs are not slow ones and pairs.
    pub fn varying(&self, samples: &Samples) -> Result<Varying, InterpolationError> {
        self.fitted(samples, &mut unobserved)
    }
    pub(super) fn fitted(
        &self,
        samples: &Samples,
        observer: FitObserver<'_>,
    ) -> Result<Varying, InterpolationError> {
        let (fit, found) = self.complexity(samples, observer)?;
        let terms = fit.terms(found);
        let coefficients = fit.coefficients(&terms, found);
        Ok(Varying { terms, coefficients, domain: ranges(samples.points()) })
    }
}

impl Method for VaryingParams {
    fn name(&self) -> String {
        format!("{} spline + harmonics of phases", format!("{:?}", self.degree).to_lowercase())
    }
    fn fit_observed(
        &self,
        samples: &Samples,
        observer: FitObserver<'_>,
    ) -> Result<Box<dyn Interpolator>, InterpolationError> {
        Ok(Box::new(self.fitted(samples, observer)?))
    }
    /// In closed form, with the numbers of terms that suit all samples.
    fn left_out(
        &self,
        samples: &Samples,
        folds: &Folds,
        observer: FitObserver<'_>,
    ) -> Result<Vec<Mat<f64>>, InterpolationError> {
        let (fit, found) = self.complexity(samples, observer)?;
        fit.left_out(found, folds).ok_or_else(|| InterpolationError::Singular {
            what: self.name(),
            remedy: "give more samples, or take another method",
        })
    }
}

impl Varying {
    pub(super) const KIND: &str = "varying coefficients";

    /// Number of terms.
    #[must_use]
    pub fn terms(&self) -> usize {
        self.coefficients.ncols()
    }

    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect(Self::KIND)?;
        let bounds = record.numbers("domain")?;
        let domain: Vec<[f64; 2]> = bounds.as_chunks::<2>().0.to_vec();
        if domain.is_empty() || bounds.len() != 2 * domain.len() {
            return Err(record.wrong("domain", format!("has {} entries", bounds.len())));
        }
        let terms = Terms::from_record(record, &domain)?;
        let (rows, columns) = (record.count("outputs")?, terms.len());
        let values = record.numbers_of("coefficients", rows * columns)?;
        let coefficients = Mat::from_fn(rows, columns, |i, j| values[i + j * rows]);
        Ok(Self { terms, coefficients, domain })
    }

    /// T_f, f ≥ 1.
    pub(super) fn waves(&self) -> &Waves {
        self.terms.waves()
    }
    /// g_f(u), f ≥ 1, of every output.
    pub(super) fn amplitudes(&self, u: &[f64]) -> Vec<Vec<f64>> {
        let of = |row: usize| self.terms.amplitudes(u, |column| self.coefficients[(row, column)]);
        (0..self.coefficients.nrows()).map(of).collect()
    }

    fn sum(&self, x: &[f64], along: Option<usize>, out: &mut [f64]) {
        out.fill(0.0);
        for (column, factor) in self.terms.at(x, along).into_iter().enumerate() {
            if factor != 0.0 {
                let of = self.coefficients.col_as_slice(column);
                out.iter_mut().zip(of).for_each(|(out, c)| *out += factor * c);
            }
        }
    }
}

impl Interpolator for Varying {
    fn inputs(&self) -> usize {
        self.domain.len()
    }
    fn outputs(&self) -> usize {
        self.coefficients.nrows()
    }
    fn domain(&self) -> &[[f64; 2]] {
        &self.domain
    }
    fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), InterpolationError> {
        InterpolationError::check_prediction([self.inputs(), self.outputs()], x, out)?;
        self.sum(x, None, out);
        Ok(())
    }
    fn derivative(&self, x: &[f64], input: usize, out: &mut [f64]) -> Result<(), InterpolationError> {
        InterpolationError::check_prediction([self.inputs(), self.outputs()], x, out)?;
        check_input(input, self.inputs())?;
        self.sum(x, Some(input), out);
        Ok(())
    }
    fn record(&self) -> Record {
        let columns = 0..self.coefficients.ncols();
        let record = Record::new(Self::KIND)
            .with("domain", self.domain.iter().flatten().copied())
            .with("outputs", [self.outputs() as f64])
            .with("coefficients", columns.flat_map(|j| self.coefficients.col_as_slice(j).iter().copied()));
        self.terms.record(record)
    }
}

#[cfg(test)]
mod tests;
