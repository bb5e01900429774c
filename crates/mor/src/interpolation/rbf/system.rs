//! The equations of the weights.
use super::{Kernel, Tail, too_few};
use crate::interpolation::{Folds, InterpolationError, Samples, Scaling};
use crate::{Mat, MatRef};
use monomorphic::{DenseLu, Qr};

/// The matrix takes 8 m² bytes, and three of them are needed.
const MOST: usize = 6000;

/// Φ w + P c = y, Pᵀ w = 0 at scaled points.
pub(super) struct System {
    pub(super) kernel: Kernel,
    pub(super) tail: Tail,
    /// Scaled, d × m.
    pub(super) centres: Mat<f64>,
    /// Squared distances, m × m.
    distances: Mat<f64>,
    /// y and zeros, (m + q) × k.
    right: Mat<f64>,
}

impl System {
    pub(super) fn new(
        kernel: Kernel,
        degree: Option<usize>,
        samples: &Samples,
        scaling: &Scaling,
    ) -> Result<Self, InterpolationError> {
        let (d, m) = (samples.inputs(), samples.len());
        if m > MOST {
            let bytes = 24.0 * (m as f64).powi(2);
            return Err(InterpolationError::TooMany {
                what: "radial basis functions",
                found: m,
                most: MOST,
                bytes,
            });
        }
        let tail = Tail::new(d, degree);
        if m < tail.len() {
            return Err(too_few(kernel, degree, tail.len(), m));
        }
        let mut centres = Mat::zeros(d, m);
        for i in 0..m {
            scaling.apply(samples.point(i), centres.col_as_slice_mut(i));
        }
        let polynomials = Mat::from_fn(m, tail.len(), |i, j| tail.value(j, centres.col_as_slice(i)));
        if tail.len() > 0 && Qr::new(polynomials).diagonal().any(|r| r.abs() < 1e-10) {
            let degree = degree.unwrap_or(0);
            let what = format!("the tail of degree {degree} of {} functions", kernel.name());
            let remedy = "a polynomial of this degree vanishes at all points (is an input constant, or are they on a line?): give other \
                          points, leave the input out, or take a lower degree";
            return Err(InterpolationError::Singular { what, remedy });
        }
        let distance = |i: usize, j: usize| {
            let pairs = centres.col_as_slice(i).iter().zip(centres.col_as_slice(j));
            pairs.map(|(a, b)| (a - b).powi(2)).sum()
        };
        let distances = Mat::from_fn(m, m, distance);
        let values = samples.values();
        let right =
            Mat::from_fn(m + tail.len(), values.nrows(), |i, row| if i < m { values[(row, i)] } else { 0.0 });
        Ok(Self { kernel, tail, centres, distances, right })
    }
    fn m(&self) -> usize {
        self.centres.ncols()
    }
    /// Are there no more samples than monomials?
    pub(super) fn is_polynomial(&self) -> bool {
        self.m() == self.tail.len()
    }
    fn matrix(&self, shape: f64) -> Mat<f64> {
        let (m, n) = (self.m(), self.right.nrows());
        let tail = |monomial: usize, i: usize| self.tail.value(monomial, self.centres.col_as_slice(i));
        Mat::from_fn(n, n, |i, j| match (i < m, j < m) {
            (true, true) => self.kernel.value(self.distances[(i, j)], shape),
            (true, false) => tail(j - m, i),
            (false, true) => tail(i - m, j),
            (false, false) => 0.0,
        })
    }
    /// Weights and coefficients, (m + q) × k, and the largest residual relative to the largest value.
    pub(super) fn solve(&self, shape: f64) -> (Mat<f64>, f64) {
        let matrix = self.matrix(shape);
        let lu = DenseLu::new(matrix.clone());
        let mut weights = self.right.clone();
        lu.solve(weights.as_mut());
        let mut residual = &self.right - &matrix * &weights;
        // One step of refinement, kept where it helps.
        let before = largest(residual.as_ref());
        lu.solve(residual.as_mut());
        let refined = &weights + &residual;
        let after = largest((&self.right - &matrix * &refined).as_ref());
        let scale = largest(self.right.as_ref()).max(f64::MIN_POSITIVE);
        if after < before { (refined, after / scale) } else { (weights, before / scale) }
    }
    /// The errors at every sample of the interpolant through all the others (k × m), in closed form: w_i/(M⁻¹)_ii with the matrix M
    /// of all equations (Rippa, Adv. Comput. Math. 11 (1999) 193–210; with a tail, the same elimination holds for the bordered
    /// matrix). Also the condition number ‖M‖₁‖M⁻¹‖₁.
    pub(super) fn leave_one_out(&self, shape: f64) -> (Mat<f64>, f64) {
        let matrix = self.matrix(shape);
        let inverse = DenseLu::new(matrix.clone()).inverse();
        let weights = &inverse * &self.right;
        let errors = Mat::from_fn(self.right.ncols(), self.m(), |row, i| weights[(i, row)] / inverse[(i, i)]);
        (errors, norm(&matrix) * norm(&inverse))
    }
    /// The errors ŷ − y at the samples of every set S of the interpolant through all the others: with the inverse of the matrix of all
    /// equations and all weights, −((M⁻¹)_SS)⁻¹ w_S, by the same elimination of several rows at once. None if there is no such
    /// interpolant, or it is round-off.
    pub(super) fn left_out(&self, shape: f64, folds: &Folds) -> Option<Vec<Mat<f64>>> {
        let inverse = DenseLu::new(self.matrix(shape)).inverse();
        let weights = &inverse * &self.right;
        let one = |set: &Vec<usize>| {
            let block = Mat::from_fn(set.len(), set.len(), |i, j| inverse[(set[i], set[j])]);
            let mut errors = Mat::from_fn(set.len(), weights.ncols(), |i, row| -weights[(set[i], row)]);
            DenseLu::new(block).solve(errors.as_mut());
            let enough = self.m() - set.len() >= self.tail.len();
            (enough && largest(errors.as_ref()).is_finite()).then(|| errors.transpose().to_owned())
        };
        folds.sets().iter().map(one).collect()
    }
    /// Points per unit of length if they were on a grid.
    pub(super) fn density(&self) -> f64 {
        let spread = (0..self.centres.nrows())
            .filter(|&i| (1..self.m()).any(|j| self.centres[(i, j)] != self.centres[(i, 0)]))
            .count()
            .max(1);
        0.5 * (self.m() as f64).powf(1.0 / spread as f64)
    }
}

/// The largest |entry|; infinite if one is not a number.
fn largest(a: MatRef<'_, f64>) -> f64 {
    let mut largest = 0.0_f64;
    for j in 0..a.ncols() {
        for i in 0..a.nrows() {
            let entry = a[(i, j)].abs();
            largest = largest.max(if entry.is_nan() { f64::INFINITY } else { entry });
        }
    }
    largest
}

/// ‖A‖₁.
fn norm(a: &Mat<f64>) -> f64 {
    (0..a.ncols()).map(|j| a.col_as_slice(j).iter().map(|v| v.abs()).sum()).fold(0.0, f64::max)
}
