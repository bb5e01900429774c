//! The equations Σ_j B_j(x_i) c_j = y_i.
use super::Axis;
use crate::Mat;

/// L U of the matrix B_j(x_i), a band. It is totally positive, so that elimination needs no pivots (de Boor and Pinkus 1977).
pub(super) struct Collocation {
    /// Half the band's width.
    half: usize,
    n: usize,
    /// Row i from column i − half to i + half.
    band: Vec<f64>,
}

impl Collocation {
    pub(super) fn new(axis: &Axis, points: &[f64]) -> Self {
        let (n, p) = (points.len(), axis.degree);
        let width = 2 * p + 1;
        let mut band = vec![0.0; n * width];
        for (i, &x) in points.iter().enumerate() {
            let span = axis.span(x);
            for (j, b) in axis.values(span, x)[..=p].iter().enumerate() {
                // Zeros at the ends of the support may lie outside the band.
                if let Some(place) = (span - p + j + p).checked_sub(i).filter(|place| *place < width) {
                    band[i * width + place] = *b;
                }
            }
        }
        for i in 0..n {
            let pivot = band[i * width + p];
            for below in i + 1..n.min(i + p + 1) {
                let at = below * width + p + i - below;
                let factor = band[at] / pivot;
                band[at] = factor;
                for right in i + 1..n.min(i + p + 1) {
                    band[below * width + p + right - below] -= factor * band[i * width + p + right - i];
                }
            }
        }
        Self { half: p, n, band }
    }

    /// Replaces the values by coefficients on every line of nodes that are `stride` columns apart.
    pub(super) fn solve(&self, values: &mut Mat<f64>, stride: usize) {
        let block = stride * self.n;
        for start in (0..values.ncols()).step_by(block) {
            for line in start..start + stride {
                self.solve_line(values, line, stride);
            }
        }
    }
    fn solve_line(&self, values: &mut Mat<f64>, first: usize, stride: usize) {
        let (n, p) = (self.n, self.half);
        let entry = |i: usize, j: usize| self.band[i * (2 * p + 1) + p + j - i];
        for i in 0..n {
            for j in i.saturating_sub(p)..i {
                add(values, first + i * stride, first + j * stride, -entry(i, j));
            }
        }
        for i in (0..n).rev() {
            for j in i + 1..n.min(i + p + 1) {
                add(values, first + i * stride, first + j * stride, -entry(i, j));
            }
            let pivot = entry(i, i);
            values.col_as_slice_mut(first + i * stride).iter_mut().for_each(|v| *v /= pivot);
        }
    }
}

/// Column `to` += factor · column `from`.
fn add(values: &mut Mat<f64>, to: usize, from: usize, factor: f64) {
    for row in 0..values.nrows() {
        let add = factor * values[(row, from)];
        values[(row, to)] += add;
    }
}
