//! Radial basis functions.
mod kernel;
mod system;
mod tail;

pub use kernel::Kernel;

use super::interpolator::check_input;
use super::{
    FitObserver, FitProgress, FitStage, Folds, InterpolationError, Interpolator, Method, Record, RecordError,
    Samples, Scaling, unobserved,
};
use crate::Mat;
use system::System;
use tail::Tail;

/// Beyond this condition number leave-one-out errors are round-off.
const CONDITION: f64 = 1e15;
/// Samples that are missed by more, relative to the largest value, are not interpolated.
const RESIDUAL: f64 = 1e-7;

/// The shape parameter ε.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// This one.
    Fixed(f64),
    /// The one with the smallest leave-one-out error.
    LeaveOneOut,
}

/// How to make an [`Rbf`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RbfParams {
    /// φ.
    pub kernel: Kernel,
    /// ε, for the kernels that have one.
    pub shape: Shape,
    /// Degree of the polynomials that are added and reproduced; None for the lowest the kernel needs.
    pub tail: Option<usize>,
}

impl RbfParams {
    /// With the shape that leaves the smallest leave-one-out error and the lowest tail.
    #[must_use]
    pub fn new(kernel: Kernel) -> Self {
        Self { kernel, shape: Shape::LeaveOneOut, tail: None }
    }
    /// With another tail.
    #[must_use]
    pub fn with_tail(self, degree: usize) -> Self {
        Self { tail: Some(degree), ..self }
    }
    /// With another shape.
    #[must_use]
    pub fn with_shape(self, shape: Shape) -> Self {
        Self { shape, ..self }
    }
    fn checked(&self, samples: &Samples) -> Result<(System, Scaling), InterpolationError> {
        let lowest = self.kernel.lowest_tail();
        if let Some(tail) = self.tail.filter(|tail| lowest.is_some_and(|lowest| *tail < lowest) || *tail > 8)
        {
            let must = "at most 8, and at least what the kernel needs (cubic and thin plate 1, quintic 2)";
            return Err(InterpolationError::Parameter {
                what: "degree of the tail",
                value: tail as f64,
                must,
            });
        }
        if self.kernel == Kernel::Wendland && samples.inputs() > 3 {
            let value = samples.inputs() as f64;
            let must = "at most 3 for Wendland's function: take another kernel";
            return Err(InterpolationError::Parameter { what: "number of inputs", value, must });
        }
        if let Shape::Fixed(shape) = self.shape
            && !(shape > 0.0 && shape.is_finite())
        {
            let must = "positive and finite";
            return Err(InterpolationError::Parameter { what: "shape parameter", value: shape, must });
        }
        let scaling = Scaling::by_range(samples.points());
        Ok((System::new(self.kernel, self.tail.or(lowest), samples, &scaling)?, scaling))
    }
    /// Errors at every sample (k × m) of the interpolant through all the others: a cross-validation without refitting.
    ///
    /// # Errors
    /// As [`rbf`](Self::rbf).
    pub fn leave_one_out(&self, samples: &Samples) -> Result<Mat<f64>, InterpolationError> {
        let (system, _) = self.checked(samples)?;
        Ok(system.leave_one_out(self.choose(&system, &mut unobserved)?).0)
    }
    fn choose(&self, system: &System, observer: FitObserver<'_>) -> Result<f64, InterpolationError> {
        match self.shape {
            Shape::Fixed(shape) => Ok(shape),
            // Polynomials alone go through as many samples as there are monomials.
            Shape::LeaveOneOut if !self.kernel.has_shape() || system.is_polynomial() => Ok(1.0),
            Shape::LeaveOneOut => best_shape(system, observer)?.ok_or_else(|| self.singular()),
        }
    }
    fn singular(&self) -> InterpolationError {
        InterpolationError::Singular {
            what: format!("{} functions", self.kernel.name()),
            remedy: "points are too near each other for this shape: thin them out, take a larger shape parameter, or cubic functions",
        }
    }
    /// The function through the samples.
    ///
    /// # Errors
    /// [`InterpolationError::TooFew`] and [`InterpolationError::Singular`] if the samples do not determine the tail,
    /// [`InterpolationError::TooMany`], [`InterpolationError::Parameter`].
    pub fn rbf(&self, samples: &Samples) -> Result<Rbf, InterpolationError> {
        self.fitted(samples, &mut unobserved)
    }
    fn fitted(&self, samples: &Samples, observer: FitObserver<'_>) -> Result<Rbf, InterpolationError> {
        let (system, scaling) = self.checked(samples)?;
        let shape = self.choose(&system, observer)?;
        let (weights, residual) = system.solve(shape);
        if residual.is_nan() || residual > RESIDUAL {
            return Err(self.singular());
        }
        let weights = weights.transpose().to_owned();
        let degree = self.tail.or(self.kernel.lowest_tail());
        let System { kernel, tail, centres, .. } = system;
        Ok(Rbf { kernel, shape, degree, tail, scaling, centres, weights, domain: samples.domain().to_vec() })
    }
}

impl Method for RbfParams {
    fn name(&self) -> String {
        let tail = self.tail.map_or(String::new(), |degree| format!(" + degree {degree}"));
        format!("{} RBF{tail}", self.kernel.name())
    }
    fn fit_observed(
        &self,
        samples: &Samples,
        observer: FitObserver<'_>,
    ) -> Result<Box<dyn Interpolator>, InterpolationError> {
        Ok(Box::new(self.fitted(samples, observer)?))
    }
    /// In closed form, with the shape that suits all samples.
    fn left_out(
        &self,
        samples: &Samples,
        folds: &Folds,
        observer: FitObserver<'_>,
    ) -> Result<Vec<Mat<f64>>, InterpolationError> {
        let (system, _) = self.checked(samples)?;
        system.left_out(self.choose(&system, observer)?, folds).ok_or_else(|| self.singular())
    }
}

/// The ε with the smallest sum of squares of leave-one-out errors among those whose equations are not singular to round-off: the
/// best of a geometric row, then a golden section around it.
fn best_shape(system: &System, observer: FitObserver<'_>) -> Result<Option<f64>, InterpolationError> {
    let (steps, sections) = (16, 10);
    let mut step = 0;
    let mut error = |log_shape: f64| -> Result<f64, InterpolationError> {
        let (errors, condition) = system.leave_one_out(log_shape.exp());
        let sum = errors.squared_norm_l2();
        let sum = if condition < CONDITION && sum.is_finite() { sum } else { f64::INFINITY };
        step += 1;
        FitProgress::new(FitStage::Shape, step, steps + 3 + sections)
            .with_loss(sum)
            .report(&mut *observer)?;
        Ok(sum)
    };
    // From functions as wide as four times the samples' extent to those as narrow as half their distance.
    let [low, high] = [0.1_f64.ln(), (4.0 * system.density().max(0.5)).ln()];
    let place = |i: usize| low + (high - low) * i as f64 / steps as f64;
    let row = (0..=steps).map(|i| error(place(i))).collect::<Result<Vec<f64>, _>>()?;
    let best = (0..=steps).min_by(|&a, &b| row[a].total_cmp(&row[b])).unwrap_or(0);
    if row[best] == f64::INFINITY {
        return Ok(None);
    }
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let [mut a, mut b] = [place(best.saturating_sub(1)), place((best + 1).min(steps))];
    let [mut c, mut d] = [b - golden * (b - a), a + golden * (b - a)];
    let [mut at_c, mut at_d] = [error(c)?, error(d)?];
    for _ in 0..sections {
        if at_c < at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - golden * (b - a);
            at_c = error(c)?;
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + golden * (b - a);
            at_d = error(d)?;
        }
    }
    let candidates = [(place(best), row[best]), (c, at_c), (d, at_d)];
    let least = candidates.into_iter().min_by(|a, b| a.1.total_cmp(&b.1));
    Ok(least.map(|(log_shape, _)| log_shape.exp()))
}

fn too_few(kernel: Kernel, degree: Option<usize>, needed: usize, found: usize) -> InterpolationError {
    let what = format!("a tail of degree {} of {} functions", degree.unwrap_or(0), kernel.name());
    InterpolationError::TooFew { what, of: "samples", needed, found }
}

/// y(x) = Σ w_i φ(|z − z_i|) + Σ c_j p_j(z) with z = x scaled to [−1, 1] by the samples' extent, and monomials p_j (Wendland,
/// Scattered Data Approximation, 2005, chapters 6 to 9).
///
/// It goes through all samples at any points, and reproduces polynomials of the tail's degree. One prediction costs m (d + k)
/// multiplications and m evaluations of φ.
#[derive(Clone, Debug)]
pub struct Rbf {
    kernel: Kernel,
    shape: f64,
    degree: Option<usize>,
    tail: Tail,
    scaling: Scaling,
    /// Scaled, d × m.
    centres: Mat<f64>,
    /// k × (m + q).
    weights: Mat<f64>,
    domain: Vec<[f64; 2]>,
}

impl Rbf {
    pub(super) const KIND: &str = "rbf";

    /// φ.
    #[must_use]
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }
    /// ε, in units of the scaled inputs.
    #[must_use]
    pub fn shape(&self) -> f64 {
        self.shape
    }

    fn scaled(&self, x: &[f64]) -> Vec<f64> {
        let mut z = vec![0.0; x.len()];
        self.scaling.apply(x, &mut z);
        z
    }
    /// Σ of the columns of weights with these factors.
    fn sum(&self, factor: impl Fn(usize) -> f64, out: &mut [f64]) {
        out.fill(0.0);
        for i in 0..self.weights.ncols() {
            let factor = factor(i);
            if factor != 0.0 {
                for (out, weight) in out.iter_mut().zip(self.weights.col_as_slice(i)) {
                    *out += factor * weight;
                }
            }
        }
    }
    fn distance(&self, z: &[f64], i: usize) -> f64 {
        z.iter().zip(self.centres.col_as_slice(i)).map(|(z, c)| (z - c).powi(2)).sum()
    }

    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect(Self::KIND)?;
        let name = record.word("kernel")?;
        let kernel = Kernel::ALL.into_iter().find(|kernel| kernel.name() == name);
        let kernel = kernel.ok_or_else(|| record.wrong("kernel", format!("is `{name}`")))?;
        let [inputs, outputs, centres] = match record.counts("sizes")?.as_slice() {
            &[inputs, outputs, centres] => [inputs, outputs, centres],
            sizes => return Err(record.wrong("sizes", format!("has {} entries instead of 3", sizes.len()))),
        };
        let degree = match record.counts("degree")?.as_slice() {
            [] => None,
            [degree] if *degree <= 8 => Some(*degree),
            degree => return Err(record.wrong("degree", format!("is {degree:?}"))),
        };
        let domain = record.numbers_of("domain", inputs.saturating_mul(2))?;
        let tail = Tail::new(inputs, degree);
        let matrix = |name, rows: usize, columns: usize| {
            let values = record.numbers_of(name, rows.saturating_mul(columns))?;
            Ok::<_, RecordError>(Mat::from_fn(rows, columns, |i, j| values[i + j * rows]))
        };
        Ok(Self {
            kernel,
            shape: record.number("shape")?,
            degree,
            scaling: Scaling::from_record(&record.record("scaling")?, inputs)?,
            centres: matrix("centres", inputs, centres)?,
            weights: matrix("weights", outputs, centres.saturating_add(tail.len()))?,
            tail,
            domain: domain.as_chunks::<2>().0.to_vec(),
        })
    }
}

impl Interpolator for Rbf {
    fn inputs(&self) -> usize {
        self.centres.nrows()
    }
    fn outputs(&self) -> usize {
        self.weights.nrows()
    }
    fn domain(&self) -> &[[f64; 2]] {
        &self.domain
    }
    fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), InterpolationError> {
        InterpolationError::check_prediction([self.inputs(), self.outputs()], x, out)?;
        let z = self.scaled(x);
        let m = self.centres.ncols();
        let factor = |i: usize| match i.checked_sub(m) {
            None => self.kernel.value(self.distance(&z, i), self.shape),
            Some(monomial) => self.tail.value(monomial, &z),
        };
        self.sum(factor, out);
        Ok(())
    }
    fn derivative(&self, x: &[f64], input: usize, out: &mut [f64]) -> Result<(), InterpolationError> {
        InterpolationError::check_prediction([self.inputs(), self.outputs()], x, out)?;
        check_input(input, self.inputs())?;
        let z = self.scaled(x);
        let m = self.centres.ncols();
        let inner = self.scaling.factor(input);
        let factor = |i: usize| match i.checked_sub(m) {
            None => {
                let slope = self.kernel.slope(self.distance(&z, i), self.shape);
                inner * slope * (z[input] - self.centres[(input, i)])
            }
            Some(monomial) => inner * self.tail.slope(monomial, input, &z),
        };
        self.sum(factor, out);
        Ok(())
    }
    fn record(&self) -> Record {
        let entries =
            |of: &Mat<f64>| (0..of.ncols()).flat_map(|j| of.col_as_slice(j).to_vec()).collect::<Vec<_>>();
        Record::new(Self::KIND)
            .with_word("kernel", self.kernel.name())
            .with("sizes", [self.inputs(), self.outputs(), self.centres.ncols()].map(|n| n as f64))
            .with("shape", [self.shape])
            .with("degree", self.degree.map(|degree| degree as f64))
            .with("centres", entries(&self.centres))
            .with("weights", entries(&self.weights))
            .with("domain", self.domain.iter().flatten().copied())
            .with_record("scaling", &self.scaling.record())
    }
}

#[cfg(test)]
mod tests;
