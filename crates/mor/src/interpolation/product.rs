//! A spline in the first input, any method in the others.
use super::interpolator::{check_input, load};
use super::samples::nearest;
use super::{
    FitObserver, InterpolationError, Interpolator, Method, Record, RecordError, Samples, Spline,
    SplineParams, unobserved,
};
use crate::Mat;
use std::collections::BTreeMap;

/// Parts of the samples below this, relative to all of them, are round-off.
const ROUND_OFF: f64 = 1e-15;

/// How to make a [`Product`].
pub struct ProductParams {
    /// In the first input, say time.
    pub first: SplineParams,
    /// In the others, say the parameters of runs.
    pub others: Box<dyn Method>,
}

/// Samples at all pairs of some values of the first input with some points of the others.
pub(crate) struct Runs {
    /// Ascending.
    pub(super) first: Vec<f64>,
    /// Which sample is at each value of the first input, for every point of the others.
    pub(super) samples: Vec<Vec<usize>>,
}

impl Runs {
    pub(crate) fn of(samples: &Samples) -> Result<Self, InterpolationError> {
        let axes: Vec<Vec<f64>> = (0..samples.inputs()).map(|i| samples.distinct(i)).collect();
        let mut runs = BTreeMap::<Vec<usize>, Vec<usize>>::new();
        for sample in 0..samples.len() {
            let place = |i: usize| nearest(&axes[i], samples.point(sample)[i]);
            let run = runs.entry((1..axes.len()).map(place).collect()).or_default();
            run.resize(axes[0].len(), usize::MAX);
            run[place(0)] = sample;
        }
        if axes.len() > 1 && runs.values().all(|run| !run.contains(&usize::MAX)) {
            return Ok(Self { first: axes[0].clone(), samples: runs.into_values().collect() });
        }
        let values = vec![axes[0].len(), runs.len()];
        let nodes = values.iter().product();
        Err(InterpolationError::NotAGrid { samples: samples.len(), values, nodes })
    }
}

/// A = Q R with orthonormal columns of Q, as many as A has independent ones (at least one): by Gram and Schmidt, twice, the column
/// that is left largest next.
fn factors(mut a: Mat<f64>) -> [Mat<f64>; 2] {
    let (rows, columns) = a.shape();
    let start = a.norm_l2();
    let (mut q, mut r) = (Vec::<Vec<f64>>::new(), Vec::new());
    while q.len() < rows.min(columns) {
        let norms: Vec<f64> =
            (0..columns).map(|j| dot(a.col_as_slice(j), a.col_as_slice(j)).sqrt()).collect();
        let next = (0..columns).max_by(|&i, &j| norms[i].total_cmp(&norms[j])).unwrap_or(0);
        if !q.is_empty() && norms[next] <= ROUND_OFF * start {
            break;
        }
        let mut new = a.col_as_slice(next).to_vec();
        for old in &q {
            let share = dot(old, &new);
            new.iter_mut().zip(old).for_each(|(new, old)| *new -= share * old);
        }
        let norm = dot(&new, &new).sqrt();
        new.iter_mut().for_each(|v| *v /= if norm > 0.0 { norm } else { 1.0 });
        let mut shares = vec![0.0; columns];
        for j in 0..columns {
            shares[j] = dot(&new, a.col_as_slice(j));
            a.col_as_slice_mut(j).iter_mut().zip(&new).for_each(|(a, q)| *a -= shares[j] * q);
        }
        q.push(new);
        r.push(shares);
    }
    [Mat::from_fn(rows, q.len(), |i, j| q[j][i]), Mat::from_fn(r.len(), columns, |i, j| r[i][j])]
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl ProductParams {
    /// The product through, or near, the samples.
    ///
    /// # Errors
    /// [`InterpolationError::NotAGrid`] if they are not at all pairs of values of the first input and points of the others, and those
    /// of both methods.
    pub fn product(&self, samples: &Samples) -> Result<Product, InterpolationError> {
        self.fitted(samples, &mut unobserved)
    }
    fn fitted(&self, samples: &Samples, observer: FitObserver<'_>) -> Result<Product, InterpolationError> {
        let Runs { first, samples: runs } = Runs::of(samples)?;
        let k = samples.outputs();
        let all = Mat::from_fn(k * first.len(), runs.len(), |i, run| samples.value(runs[run][i / k])[i % k]);
        let [shapes, coefficients] = factors(all);
        let values = Mat::from_fn(k * shapes.ncols(), first.len(), |i, j| shapes[(i % k + k * j, i / k)]);
        let spline = self.first.spline(&Samples::of_one_input(&first, values.as_ref())?)?;
        let of_runs: Vec<usize> = runs.iter().map(|run| run[0]).collect();
        let points = samples.pick(&of_runs)[0].get(1.., ..).to_owned();
        let of_runs = Samples::new(points.as_ref(), coefficients.as_ref())?;
        let others = self.others.fit_observed(&of_runs, observer)?;
        Product::of(spline, others, k).ok_or(InterpolationError::Shape {
            what: "outputs of the product",
            expected: k * shapes.ncols(),
            found: values.nrows(),
        })
    }
}

impl Method for ProductParams {
    fn name(&self) -> String {
        format!("{} × {}", self.first.name(), self.others.name())
    }
    fn fit_observed(
        &self,
        samples: &Samples,
        observer: FitObserver<'_>,
    ) -> Result<Box<dyn Interpolator>, InterpolationError> {
        Ok(Box::new(self.fitted(samples, observer)?))
    }
}

/// y(x) = Σ_j c_j(x₂ … x_d) b_j(x₁): splines b_j through orthonormal functions of the first input, of which all runs are made, and
/// their coefficients by any method.
///
/// For methods that are linear in the values (splines, radial functions) it is the product of both; the number of functions is the
/// rank of the runs, so that a network has few outputs as well. One prediction costs what both methods cost, and k multiplications
/// for each function.
pub struct Product {
    first: Spline,
    others: Box<dyn Interpolator>,
    outputs: usize,
    domain: Vec<[f64; 2]>,
}

impl Product {
    pub(super) const KIND: &str = "product";

    /// None if the spline does not have `outputs` for every function.
    fn of(first: Spline, others: Box<dyn Interpolator>, outputs: usize) -> Option<Self> {
        let domain = [first.domain(), others.domain()].concat();
        let fit = first.inputs() == 1 && outputs.checked_mul(others.outputs()) == Some(first.outputs());
        fit.then_some(Self { first, others, outputs, domain })
    }
    /// How many functions of the first input all runs are made of.
    #[must_use]
    pub fn functions(&self) -> usize {
        self.others.outputs()
    }
    fn sum(&self, shapes: &[f64], coefficients: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for (shape, c) in shapes.chunks_exact(self.outputs).zip(coefficients) {
            out.iter_mut().zip(shape).for_each(|(out, shape)| *out += c * shape);
        }
    }

    pub(super) fn from_record(record: &Record) -> Result<Self, RecordError> {
        record.expect(Self::KIND)?;
        let first = Spline::from_record(&record.record("first")?)?;
        let others = load(&record.record("others")?)?;
        let outputs = record.count("outputs")?;
        Self::of(first, others, outputs)
            .ok_or_else(|| record.wrong("outputs", format!("is {outputs}, which its parts do not have")))
    }
}

impl Interpolator for Product {
    fn inputs(&self) -> usize {
        1 + self.others.inputs()
    }
    fn outputs(&self) -> usize {
        self.outputs
    }
    fn domain(&self) -> &[[f64; 2]] {
        &self.domain
    }
    fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<(), InterpolationError> {
        InterpolationError::check_prediction([self.inputs(), self.outputs], x, out)?;
        let (mut shapes, mut coefficients) = (vec![0.0; self.first.outputs()], vec![0.0; self.functions()]);
        self.first.predict(&x[..1], &mut shapes)?;
        self.others.predict(&x[1..], &mut coefficients)?;
        self.sum(&shapes, &coefficients, out);
        Ok(())
    }
    fn derivative(&self, x: &[f64], input: usize, out: &mut [f64]) -> Result<(), InterpolationError> {
        InterpolationError::check_prediction([self.inputs(), self.outputs], x, out)?;
        check_input(input, self.inputs())?;
        let (mut shapes, mut coefficients) = (vec![0.0; self.first.outputs()], vec![0.0; self.functions()]);
        match input.checked_sub(1) {
            None => {
                self.first.derivative(&x[..1], 0, &mut shapes)?;
                self.others.predict(&x[1..], &mut coefficients)?;
            }
            Some(input) => {
                self.first.predict(&x[..1], &mut shapes)?;
                self.others.derivative(&x[1..], input, &mut coefficients)?;
            }
        }
        self.sum(&shapes, &coefficients, out);
        Ok(())
    }
    fn record(&self) -> Record {
        Record::new(Self::KIND)
            .with("outputs", [self.outputs as f64])
            .with_record("first", &self.first.record())
            .with_record("others", &self.others.record())
    }
}

#[cfg(test)]
mod tests;
