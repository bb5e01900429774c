//! Sums and their gradients, for all samples at once.
use super::Activation;
use crate::{Mat, MatRef};
use monomorphic::{MatMut, add_product};
use std::ops::Range;

/// How many neurons each layer has, from the inputs to the outputs. Weights are one row of numbers: for every layer the matrix
/// (column by column), then the shifts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layers {
    pub(super) sizes: Vec<usize>,
    pub(super) activation: Activation,
}

/// All values of a pass, one column per sample.
pub(super) struct Pass {
    /// Of the layers after the inputs.
    values: Vec<Mat<f64>>,
    /// φ′ in the hidden layers.
    slopes: Vec<Mat<f64>>,
    /// ∂L/∂z.
    deltas: Vec<Mat<f64>>,
}

impl Layers {
    /// How many there are after the inputs.
    pub(super) fn depth(&self) -> usize {
        self.sizes.len() - 1
    }
    /// Where the matrix and the shifts of layer `l` are.
    pub(super) fn places(&self, l: usize) -> [Range<usize>; 2] {
        let weights = |l: usize| self.sizes[l] * self.sizes[l + 1];
        let start: usize = (0..l).map(|l| weights(l) + self.sizes[l + 1]).sum();
        let middle = start + weights(l);
        [start..middle, middle..middle + self.sizes[l + 1]]
    }
    /// How many weights and shifts.
    pub(super) fn len(&self) -> usize {
        self.places(self.depth() - 1)[1].end
    }
    fn matrix<'a>(&self, l: usize, weights: &'a [f64]) -> MatRef<'a, f64> {
        let values = &weights[self.places(l)[0].clone()];
        MatRef::from_column_major_slice(values, self.sizes[l + 1], self.sizes[l])
    }
    /// For so many samples.
    pub(super) fn pass(&self, samples: usize) -> Pass {
        let zeros = |sizes: &[usize]| sizes.iter().map(|&n| Mat::zeros(n, samples)).collect();
        let depth = self.depth();
        Pass {
            values: zeros(&self.sizes[1..]),
            slopes: zeros(&self.sizes[1..depth]),
            deltas: zeros(&self.sizes[1..]),
        }
    }
    /// a_l = φ(W_l a_{l−1} + b_l) of the layers in this range, the last one without φ.
    pub(super) fn forward(&self, weights: &[f64], x: MatRef<'_, f64>, which: Range<usize>, pass: &mut Pass) {
        for l in which {
            let (before, rest) = pass.values.split_at_mut(l);
            let from = before.last().map_or(x, Mat::as_ref);
            let shifts = &weights[self.places(l)[1].clone()];
            for j in 0..rest[0].ncols() {
                rest[0].col_as_slice_mut(j).copy_from_slice(shifts);
            }
            add_product(rest[0].as_mut(), self.matrix(l, weights), from);
            if let Some(slopes) = pass.slopes.get_mut(l) {
                for j in 0..slopes.ncols() {
                    self.activation.apply(rest[0].col_as_slice_mut(j), slopes.col_as_slice_mut(j));
                }
            }
        }
    }
    /// Adds ∂L/∂W and ∂L/∂b of the first `layers` layers to `gradient`, from [`Pass::outputs_and_delta`] and the last forward pass.
    pub(super) fn backward(
        &self,
        weights: &[f64],
        x: MatRef<'_, f64>,
        layers: usize,
        pass: &mut Pass,
        gradient: &mut [f64],
    ) {
        for l in (0..self.depth()).rev() {
            let (before, rest) = pass.deltas.split_at_mut(l);
            let delta = rest[0].as_ref();
            if l < layers {
                let from = l.checked_sub(1).map_or(x, |l| pass.values[l].as_ref());
                let [matrix, shifts] = self.places(l);
                let (rows, columns) = (self.sizes[l + 1], self.sizes[l]);
                let to = MatMut::from_column_major_slice_mut(&mut gradient[matrix], rows, columns);
                add_product(to, delta, from.transpose());
                for j in 0..delta.ncols() {
                    for (sum, d) in gradient[shifts.clone()].iter_mut().zip(rest[0].col_as_slice(j)) {
                        *sum += d;
                    }
                }
            }
            if let Some(before) = before.last_mut() {
                before.fill(0.0);
                add_product(before.as_mut(), self.matrix(l, weights).transpose(), delta);
                for j in 0..before.ncols() {
                    let slopes = pass.slopes[l - 1].col_as_slice(j);
                    before.col_as_slice_mut(j).iter_mut().zip(slopes).for_each(|(d, slope)| *d *= slope);
                }
            }
        }
    }
    /// How the outputs change with a change of the inputs, one sample (a column each), after a forward pass of it.
    pub(super) fn tangent(&self, weights: &[f64], change: &[f64], pass: &Pass) -> Vec<f64> {
        let mut change = change.to_vec();
        for l in 0..self.depth() {
            let matrix = self.matrix(l, weights);
            let mut next = vec![0.0; self.sizes[l + 1]];
            for (j, c) in change.iter().enumerate() {
                next.iter_mut().enumerate().for_each(|(i, n)| *n += matrix[(i, j)] * c);
            }
            if let Some(slopes) = pass.slopes.get(l) {
                next.iter_mut().zip(slopes.col_as_slice(0)).for_each(|(n, slope)| *n *= slope);
            }
            change = next;
        }
        change
    }
}

impl Pass {
    /// Of the last layer.
    pub(super) fn outputs(&self) -> &Mat<f64> {
        &self.values[self.values.len() - 1]
    }
    /// Of the layer before the last one; None if there is none.
    pub(super) fn features(&self) -> Option<&Mat<f64>> {
        self.values.len().checked_sub(2).map(|l| &self.values[l])
    }
    /// Of the last layer, and where ∂L/∂y goes.
    pub(super) fn outputs_and_delta(&mut self) -> (&Mat<f64>, &mut Mat<f64>) {
        let last = self.deltas.len() - 1;
        (&self.values[last], &mut self.deltas[last])
    }
}
