//! Harmonics of phases whose amplitudes are functions by any method.
use super::interpolator::{check_input, load};
use super::waves::Waves;
use super::{
    Degree, FitObserver, InterpolationError, Interpolator, Method, Record, RecordError, Samples,
    VaryingParams, unobserved,
};
use crate::Mat;

/// How to make a [`Harmonics`] function.
pub struct HarmonicsParams<'a> {
    /// Method for the amplitudes.
    pub amplitudes: Box<dyn Method + 'a>,
    /// Number of slow inputs, the first ones; the others are pairs (cos θ_a, sin θ_a).
    pub slow: usize,
}

/// y(u, θ) = ĝ₀(u) + Σ_f T_f(θ) ĝ_f(u): functions ĝ of the slow inputs u alone, by any method, with the harmonics T_f of a [`Varying`](super::Varying) function.
///
/// Samples of the amplitudes are those of the least-squares fit, g_f(uⱼ) for f ≥ 1, and yⱼ − Σ_f T_f(θⱼ) g_f(uⱼ) for f = 0: with ĝ = g at the samples the function goes through
/// them, and a method that cannot take scattered inputs can be used with phases.
pub struct Harmonics {
    amplitudes: Box<dyn Interpolator>,
    waves: Waves,
    outputs: usize,
    domain: Vec<[f64; 2]>,
}

impl HarmonicsParams<'_> {
    /// The function.
    ///
    /// # Errors
    /// As [`VaryingParams::varying`], and those of the method.
    pub fn harmonics(&self, samples: &Samples) -> Result<Harmonics, InterpolationError> {
        self.fitted(samples, &mut unobserved)
    }
    fn fitted(&self, samples: &Samples, observer: FitObserver<'_>) -> Result<Harmonics, InterpolationError> {
        let times = samples.distinct(0).len();
        let degree = Degree::highest(times).unwrap_or(Degree::Linear);
        let varying = VaryingParams { degree, slow: self.slow }.fitted(samples, &mut *observer)?;
        let waves = varying.waves().clone();
        let (k, m, slow) = (samples.outputs(), samples.len(), self.slow);
        let mut values = Mat::zeros(k * (1 + waves.len()), m);
        for j in 0..m {
            let (x, column) = (samples.point(j), values.col_as_slice_mut(j));
            let at = waves.at(&x[slow..], None);
            for (row, g) in varying.amplitudes(&x[..slow]).iter().enumerate() {
                let sum: f64 = g.iter().zip(&at).map(|(g, t)| g * t).sum();
                column[row] = samples.value(j)[row] - sum;
                g.iter().enumerate().for_each(|(f, g)| column[(f + 1) * k + row] = *g);
            }
        }
        let points = samples.points().get(..slow, ..).to_owned();
        let samples_of_amplitudes = Samples::new(points.as_ref(), values.as_ref())?;
        let amplitudes = self.amplitudes.fit_observed(&samples_of_amplitudes, observer)?;
        Ok(Harmonics { amplitudes, waves, outputs: k, domain: samples.domain().to_vec() })
    }
}

impl Method for HarmonicsParams<'_> {
    fn name(&self) -> String {
        format!("{} × harmonics of phases", self.amplitudes.name())
    }
    fn fit_observed(
        &self,
        samples: &Samples,
        observer: FitObserver<'_>,
    ) -> Result<Box<dyn Interpolator>, InterpolationError> {
        Ok(Box::new(self.fitted(samples, observer)?))
    }
}

impl Harmonics {
    pub(super) const KIND: &str = "harmonics";

    /// Σ_f factor_f g_f with g₀ first.
    fn sum(&self, first: f64, factors: &[f64], g: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (factor, g) in [first].iter().chain(factors).zip(g.chunks_exact(self.outputs)) {
            out.iter_mut().zip(g).for_each(|(out, g)| *out += factor * g);
        }
    }

    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect(Self::KIND)?;
        let amplitudes = load(&record.record("amplitudes")?)?;
        let bounds = record.numbers("domain")?;
        let domain: Vec<[f64; 2]> = bounds.as_chunks::<2>().0.to_vec();
        let [phases, harmonics] = record.counts("waves")?[..] else {
            return Err(record.wrong("waves", "are not two numbers".into()));
        };
        let outputs = record.count("outputs")?;
        if phases > 3 || domain.len() != amplitudes.inputs() + 2 * phases || harmonics > Waves::MOST {
            return Err(record.wrong("waves", format!("are {harmonics} of {phases} phases")));
        }
        let waves = Waves::new(phases, harmonics);
        if outputs.checked_mul(1 + waves.len()) != Some(amplitudes.outputs()) {
            return Err(record.wrong("outputs", "does not fit the amplitudes".into()));
        }
        Ok(Self { amplitudes, waves, outputs, domain })
    }
}

impl Interpolator for Harmonics {
    fn inputs(&self) -> usize {
        self.domain.len()
    }
    fn outputs(&self) -> usize {
        self.outputs
    }
    fn domain(&self) -> &[[f64; 2]] {
        &self.domain
    }
    fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), InterpolationError> {
        InterpolationError::check_prediction([self.inputs(), self.outputs()], x, out)?;
        let (u, z) = x.split_at(self.amplitudes.inputs());
        let mut g = vec![0.0; self.amplitudes.outputs()];
        self.amplitudes.predict(u, &mut g)?;
        self.sum(1.0, &self.waves.at(z, None), &g, out);
        Ok(())
    }
    fn derivative(&self, x: &[f64], input: usize, out: &mut [f64]) -> Result<(), InterpolationError> {
        InterpolationError::check_prediction([self.inputs(), self.outputs()], x, out)?;
        check_input(input, self.inputs())?;
        let (u, z) = x.split_at(self.amplitudes.inputs());
        let mut g = vec![0.0; self.amplitudes.outputs()];
        match input.checked_sub(u.len()) {
            None => {
                self.amplitudes.derivative(u, input, &mut g)?;
                self.sum(1.0, &self.waves.at(z, None), &g, out);
            }
            along => {
                self.amplitudes.predict(u, &mut g)?;
                self.sum(0.0, &self.waves.at(z, along), &g, out);
            }
        }
        Ok(())
    }
    fn record(&self) -> Record {
        Record::new(Self::KIND)
            .with("domain", self.domain.iter().flatten().copied())
            .with("outputs", [self.outputs as f64])
            .with("waves", [self.waves.phases(), self.waves.harmonics()].map(|n| n as f64))
            .with_record("amplitudes", &self.amplitudes.record())
    }
}

#[cfg(test)]
mod tests;
