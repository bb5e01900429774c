//! What a network sees of its inputs.
use super::Fourier;
use super::frequencies;
use crate::Mat;
use crate::interpolation::{InterpolationError, Record, RecordError, Samples, Scaling};
use std::f64::consts::TAU;

/// Inputs z scaled to [−1, 1], those that are not periodic, and cos ωᵀz and sin ωᵀz for some ω.
#[derive(Clone, Debug)]
pub(super) struct Features {
    scaling: Scaling,
    /// Which inputs are seen as they are.
    plain: Vec<usize>,
    /// ω as columns.
    frequencies: Mat<f64>,
}

impl Features {
    pub(super) fn new(fourier: &Fourier, samples: &Samples) -> Result<Self, InterpolationError> {
        let d = samples.inputs();
        let scaling = Scaling::by_range(samples.points());
        let (plain, frequencies) = match fourier {
            Fourier::None => ((0..d).collect::<Vec<_>>(), Mat::zeros(d, 0)),
            Fourier::Multiples { periods, up_to } => {
                InterpolationError::same("periods, one for each input", d, periods.len())?;
                if let Some(&value) = periods.iter().find(|p| p.is_nan() || **p <= 0.0) {
                    let must = "positive, or infinite for an input that is not periodic";
                    return Err(InterpolationError::Parameter { what: "period of an input", value, must });
                }
                let periodic: Vec<usize> = (0..d).filter(|&i| periods[i].is_finite()).collect();
                let frequencies = Mat::from_fn(d, periodic.len() * up_to, |i, j| {
                    let (input, multiple) = (periodic[j / up_to], j % up_to + 1);
                    let base = TAU / (periods[input] * scaling.factor(input));
                    if i == input { multiple as f64 * base } else { 0.0 }
                });
                ((0..d).filter(|&i| !periods[i].is_finite()).collect(), frequencies)
            }
            Fourier::Found { most } => ((0..d).collect(), frequencies::strongest(samples, &scaling, *most)),
        };
        if plain.len() + frequencies.ncols() == 0 {
            let must = "at least 1 if all inputs are periodic";
            return Err(InterpolationError::Parameter { what: "number of multiples", value: 0.0, must });
        }
        Ok(Self { scaling, plain, frequencies })
    }
    /// How many.
    pub(super) fn len(&self) -> usize {
        self.plain.len() + 2 * self.frequencies.ncols()
    }
    pub(super) fn inputs(&self) -> usize {
        self.scaling.rows()
    }
    /// ω/2π in units of x.
    pub(super) fn frequencies(&self) -> Mat<f64> {
        let to = |i: usize| self.scaling.factor(i) / TAU;
        Mat::from_fn(self.inputs(), self.frequencies.ncols(), |i, j| to(i) * self.frequencies[(i, j)])
    }
    /// Largest slope of every feature with the scaled inputs.
    pub(super) fn steepness(&self) -> Vec<f64> {
        let waves = (0..self.frequencies.ncols()).map(|j| {
            let omega = self.frequencies.col_as_slice(j).iter().map(|w| w * w).sum::<f64>().sqrt();
            [omega; 2]
        });
        self.plain.iter().map(|_| 1.0).chain(waves.flatten()).collect()
    }
    fn angle(&self, z: &[f64], j: usize) -> f64 {
        z.iter().zip(self.frequencies.col_as_slice(j)).map(|(z, omega)| z * omega).sum()
    }
    /// The features at x.
    pub(super) fn apply(&self, x: &[f64], features: &mut [f64]) {
        let mut z = vec![0.0; x.len()];
        self.scaling.apply(x, &mut z);
        let (plain, waves) = features.split_at_mut(self.plain.len());
        plain.iter_mut().zip(&self.plain).for_each(|(feature, &i)| *feature = z[i]);
        for (j, wave) in waves.as_chunks_mut::<2>().0.iter_mut().enumerate() {
            let (sin, cos) = self.angle(&z, j).sin_cos();
            *wave = [cos, sin];
        }
    }
    /// How they change with input `input` at x.
    pub(super) fn slopes(&self, x: &[f64], input: usize) -> Vec<f64> {
        let mut z = vec![0.0; x.len()];
        self.scaling.apply(x, &mut z);
        let factor = self.scaling.factor(input);
        let plain = self.plain.iter().map(|&i| if i == input { factor } else { 0.0 });
        let wave = |j: usize| {
            let ((sin, cos), omega) = (self.angle(&z, j).sin_cos(), factor * self.frequencies[(input, j)]);
            [-omega * sin, omega * cos]
        };
        plain.chain((0..self.frequencies.ncols()).flat_map(wave)).collect()
    }

    pub(super) fn record(&self) -> Record {
        let columns = 0..self.frequencies.ncols();
        Record::new("features")
            .with("sizes", [self.inputs() as f64, self.frequencies.ncols() as f64])
            .with("plain", self.plain.iter().map(|&i| i as f64))
            .with("frequencies", columns.flat_map(|j| self.frequencies.col_as_slice(j).iter().copied()))
            .with_record("scaling", &self.scaling.record())
    }
    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect("features")?;
        let sizes = record.counts("sizes")?;
        let &[d, count] = sizes.as_slice() else {
            return Err(record.wrong("sizes", format!("has {} entries instead of 2", sizes.len())));
        };
        let plain = record.counts("plain")?;
        if plain.iter().any(|&i| i >= d) {
            return Err(record.wrong("plain", format!("is {plain:?} of {d} inputs")));
        }
        let values = record.numbers_of("frequencies", d.saturating_mul(count))?;
        Ok(Self {
            scaling: Scaling::from_record(&record.record("scaling")?, d)?,
            plain,
            frequencies: Mat::from_fn(d, count, |i, j| values[i + j * d]),
        })
    }
}
