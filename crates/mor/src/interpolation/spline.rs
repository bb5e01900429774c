//! Interpolating splines of odd degree.
mod axis;
mod collocation;

use super::interpolator::check_input;
use super::scaling::ranges;
use super::{FitObserver, InterpolationError, Interpolator, Method, Record, RecordError, Samples};
use crate::Mat;
pub(super) use axis::Axis;
use collocation::Collocation;

/// Degree of a spline, one less than its order of accuracy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Degree {
    /// Second order.
    Linear,
    /// Fourth order, two continuous derivatives.
    Cubic,
    /// Sixth order, four continuous derivatives.
    Quintic,
}

impl Degree {
    /// All, the lowest first.
    pub const ALL: [Self; 3] = [Self::Linear, Self::Cubic, Self::Quintic];

    /// 1, 3 or 5.
    #[must_use]
    pub fn get(self) -> usize {
        match self {
            Self::Linear => 1,
            Self::Cubic => 3,
            Self::Quintic => 5,
        }
    }
    /// The highest that needs no more than so many samples; None for a single one.
    #[must_use]
    pub fn highest(samples: usize) -> Option<Self> {
        Self::ALL.into_iter().rev().find(|degree| degree.get() < samples)
    }
}

/// How to make a [`Spline`]: the degree along every input, or one for all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SplineParams {
    degrees: Vec<Degree>,
}

impl SplineParams {
    /// This degree along every input.
    #[must_use]
    pub fn new(degree: Degree) -> Self {
        Self { degrees: vec![degree] }
    }
    /// These degrees, one for each input.
    #[must_use]
    pub fn per_input(degrees: &[Degree]) -> Self {
        Self { degrees: degrees.to_vec() }
    }
    /// The highest degree that the number of different values allows, for each input.
    ///
    /// # Errors
    /// [`InterpolationError::TooFew`] if an input has one value only.
    pub fn highest(samples: &Samples) -> Result<Self, InterpolationError> {
        let of = |i: usize| {
            let found = samples.distinct(i).len();
            Degree::highest(found).ok_or_else(|| too_few(i, Degree::Linear, found))
        };
        Ok(Self { degrees: (0..samples.inputs()).map(of).collect::<Result<_, _>>()? })
    }
    /// The same with lower degrees where they are higher than this.
    #[must_use]
    pub fn at_most(&self, degree: Degree) -> Self {
        Self { degrees: self.degrees.iter().map(|own| degree.min(*own)).collect() }
    }
    /// The spline through the samples.
    ///
    /// # Errors
    /// [`InterpolationError::NotAGrid`], [`InterpolationError::TooFew`], [`InterpolationError::Shape`] if there are neither one degree
    /// nor one for each input, [`InterpolationError::Singular`] if the points are too uneven.
    pub fn spline(&self, samples: &Samples) -> Result<Spline, InterpolationError> {
        Spline::through(samples, &self.degrees)
    }
}

impl Method for SplineParams {
    fn name(&self) -> String {
        let degrees: Vec<String> = self.degrees.iter().map(|d| format!("{d:?}").to_lowercase()).collect();
        format!("{} spline", degrees.join(" × "))
    }
    fn fit_observed(
        &self,
        samples: &Samples,
        _: FitObserver<'_>,
    ) -> Result<Box<dyn Interpolator>, InterpolationError> {
        Ok(Box::new(self.spline(samples)?))
    }
}

/// A spline of degree p (1, 3 or 5) through values at points on a line, or the product of such splines on a grid of points.
///
/// y(x) = Σ c_{i…j} B_i(x₁) … B_j(x_d) with B-splines on the points themselves as knots, save the (p − 1)/2 next to each end
/// ("not-a-knot"): no derivatives are needed at the ends, the spline reproduces polynomials of degree p, and its error is
/// O(h^{p+1}) everywhere (de Boor, A Practical Guide to Splines, 2001, chapters IX, XIII and XVII). The points need not be even.
/// Beyond the samples the outermost polynomials go on. One prediction costs (p + 1)ᵈ k multiplications.
#[derive(Clone, Debug)]
pub struct Spline {
    axes: Vec<Axis>,
    /// k × (n₁ ⋯ n_d), the first axis fastest.
    coefficients: Mat<f64>,
    domain: Vec<[f64; 2]>,
}

fn too_few(input: usize, degree: Degree, found: usize) -> InterpolationError {
    let what = format!("a spline of degree {} along input {input}", degree.get());
    InterpolationError::TooFew { what, of: "different values", needed: degree.get() + 1, found }
}

impl Spline {
    pub(super) const KIND: &str = "spline";

    fn through(samples: &Samples, degrees: &[Degree]) -> Result<Self, InterpolationError> {
        let grid = samples.grid()?;
        let d = grid.axes.len();
        let degree = |i: usize| match degrees {
            [all] => Ok(*all),
            _ => degrees.get(i).copied().filter(|_| degrees.len() == d).ok_or(InterpolationError::Shape {
                what: "degrees, one for all inputs or one for each",
                expected: d,
                found: degrees.len(),
            }),
        };
        let mut axes = Vec::with_capacity(d);
        let values = samples.values();
        let mut coefficients =
            Mat::from_fn(values.nrows(), values.ncols(), |row, node| values[(row, grid.samples[node])]);
        let mut stride = 1;
        for (i, points) in grid.axes.iter().enumerate() {
            let degree = degree(i)?;
            if points.len() <= degree.get() {
                return Err(too_few(i, degree, points.len()));
            }
            let axis = Axis::not_a_knot(points, degree.get());
            let collocation = Collocation::new(&axis, points);
            collocation.solve(&mut coefficients, stride);
            stride *= points.len();
            axes.push(axis);
        }
        let finite = (0..stride).all(|j| coefficients.col_as_slice(j).iter().all(|c| c.is_finite()));
        if !finite {
            let what = format!("a spline of degree {}", axes.iter().map(|a| a.degree).max().unwrap_or(0));
            let remedy = "the points are too uneven for this degree: take a lower one, or thin them out where they are dense";
            return Err(InterpolationError::Singular { what, remedy });
        }
        Ok(Self { axes, coefficients, domain: ranges(samples.points()) })
    }
    /// p along every input.
    #[must_use]
    pub fn degrees(&self) -> Vec<usize> {
        self.axes.iter().map(|axis| axis.degree).collect()
    }

    /// Σ over the B-splines that are not zero, their derivatives along `input` if one is given.
    fn sum(&self, x: &[f64], input: Option<usize>, out: &mut [f64]) {
        let d = self.axes.len();
        let mut bases = Vec::with_capacity(d);
        let (mut first, mut stride) = (0, 1);
        for (i, axis) in self.axes.iter().enumerate() {
            let span = axis.span(x[i]);
            bases.push(if input == Some(i) { axis.slopes(span, x[i]) } else { axis.values(span, x[i]) });
            first += (span - axis.degree) * stride;
            stride *= axis.len();
        }
        out.fill(0.0);
        self.add(&bases, d, first, stride, 1.0, out);
    }
    /// Adds what the first `d` axes contribute from column `first` on; `stride` columns are between the points of axis d.
    fn add(&self, bases: &[[f64; 6]], d: usize, first: usize, stride: usize, weight: f64, out: &mut [f64]) {
        let Some(i) = d.checked_sub(1) else {
            for (out, c) in out.iter_mut().zip(self.coefficients.col_as_slice(first)) {
                *out += weight * c;
            }
            return;
        };
        let stride = stride / self.axes[i].len();
        for (j, b) in bases[i][..=self.axes[i].degree].iter().enumerate() {
            self.add(bases, i, first + j * stride, stride, weight * b, out);
        }
    }

    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect(Self::KIND)?;
        let degrees = record.counts("degrees")?;
        if degrees.is_empty() {
            return Err(record.wrong("degrees", "is empty".into()));
        }
        let mut axes = Vec::new();
        for (i, &degree) in degrees.iter().enumerate() {
            axes.push(Axis::from_record(record, &format!("knots {i}"), degree)?);
        }
        let rows = record.count("outputs")?;
        let columns: usize = axes.iter().map(Axis::len).product();
        let values = record.numbers_of("coefficients", rows * columns)?;
        let domain = axes.iter().map(Axis::range).collect();
        let coefficients = Mat::from_fn(rows, columns, |i, j| values[i + j * rows]);
        Ok(Self { axes, coefficients, domain })
    }
}

impl Interpolator for Spline {
    fn inputs(&self) -> usize {
        self.axes.len()
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
        let mut record = Record::new(Self::KIND)
            .with("degrees", self.axes.iter().map(|a| a.degree as f64))
            .with("outputs", [self.outputs() as f64])
            .with("coefficients", columns.flat_map(|j| self.coefficients.col_as_slice(j).iter().copied()));
        for (i, axis) in self.axes.iter().enumerate() {
            record = record.with(&format!("knots {i}"), axis.knots.iter().copied());
        }
        record
    }
}

#[cfg(test)]
mod tests;
