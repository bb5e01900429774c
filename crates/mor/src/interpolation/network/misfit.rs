//! How far a network is from samples.
use super::layers::{Layers, Pass};
use super::lbfgs::Objective;
use crate::{Mat, MatRef};
use monomorphic::LeastSquares;

/// L(θ) = Σ |y_θ(xᵢ) − yᵢ|²/(m k) + λ Σ |W|², over all samples and all matrices of weights.
///
/// With the last layer eliminated, θ is all but this layer, which is the best one to the others: L(θ) = min L(θ, W, b) is a linear
/// least-squares problem, and its gradient is that of L at fixed W and b (variable projection: Golub & Pereyra, SIAM J. Numer. Anal.
/// 10 (1973) 413–432). The neurons before it become dependent to round-off as they fit: a ridge μ is added to λ of the last layer.
pub(super) struct Misfit<'a> {
    layers: &'a Layers,
    x: MatRef<'a, f64>,
    y: MatRef<'a, f64>,
    decay: f64,
    /// μ, without effect if the last layer is not eliminated.
    pub(super) ridge: f64,
    /// Of the last evaluation, all layers.
    weights: Vec<f64>,
    pass: Pass,
    eliminated: Option<Elimination>,
}

/// Equations of the last layer.
struct Elimination {
    equations: LeastSquares,
    /// (m + n) × k.
    right: Mat<f64>,
}

impl<'a> Misfit<'a> {
    pub(super) fn new(layers: &'a Layers, [x, y]: [MatRef<'a, f64>; 2], decay: f64, eliminate: bool) -> Self {
        let (m, k) = (x.ncols(), y.nrows());
        let eliminated = (eliminate && layers.depth() > 1).then(|| {
            let n = layers.sizes[layers.depth() - 1];
            Elimination { equations: LeastSquares::new(m + n, n + 1, k), right: Mat::zeros(m + n, k) }
        });
        let weights = vec![0.0; layers.len()];
        Self { layers, x, y, decay, ridge: 0.0, weights, pass: layers.pass(m), eliminated }
    }
    /// Where the last layer begins.
    fn last(&self) -> usize {
        self.layers.places(self.layers.depth() - 1)[0].start
    }
    /// How many numbers θ has.
    pub(super) fn len(&self) -> usize {
        if self.eliminated.is_some() { self.last() } else { self.layers.len() }
    }
    /// All weights of the last evaluation.
    pub(super) fn weights(&self) -> &[f64] {
        &self.weights
    }
    /// Σ |y_θ(xᵢ) − yᵢ|²/(m k) alone.
    pub(super) fn error(&mut self, weights: &[f64]) -> f64 {
        self.layers.forward(weights, self.x, 0..self.layers.depth(), &mut self.pass);
        self.differences()
    }
    /// Writes ∂L/∂y and gives back the sum of squares divided by m k.
    fn differences(&mut self) -> f64 {
        let scale = 1.0 / (self.y.nrows() * self.y.ncols()) as f64;
        let (outputs, delta) = self.pass.outputs_and_delta();
        let mut sum = 0.0;
        for j in 0..self.y.ncols() {
            let wanted = (0..self.y.nrows()).map(|i| self.y[(i, j)]);
            let column = outputs.col_as_slice(j).iter().zip(delta.col_as_slice_mut(j));
            for ((output, delta), wanted) in column.zip(wanted) {
                let off = output - wanted;
                *delta = 2.0 * scale * off;
                sum += off * off;
            }
        }
        scale * sum
    }
    /// The best last layer to the features of the last forward pass.
    fn eliminate(&mut self) {
        let last = self.last();
        let (Some(Elimination { equations, right }), Some(features)) =
            (&mut self.eliminated, self.pass.features())
        else {
            return;
        };
        let ((n, m), k) = (features.shape(), self.y.nrows());
        let ridge = ((self.decay + self.ridge) * (m * k) as f64).sqrt();
        let mut matrix = equations.matrix();
        for j in 0..n {
            for i in 0..m {
                matrix[(i, j)] = features[(j, i)];
            }
            for i in 0..n {
                matrix[(m + i, j)] = if i == j { ridge } else { 0.0 };
            }
        }
        for i in 0..m + n {
            matrix[(i, n)] = if i < m { 1.0 } else { 0.0 };
            for row in 0..k {
                right[(i, row)] = if i < m { self.y[(row, i)] } else { 0.0 };
            }
        }
        equations.solve(right.as_mut());
        for j in 0..=n {
            for row in 0..k {
                self.weights[last + j * k + row] = right[(j, row)];
            }
        }
    }
}

impl Objective for Misfit<'_> {
    fn evaluate(&mut self, theta: &[f64], gradient: &mut [f64]) -> f64 {
        let depth = self.layers.depth();
        self.weights[..theta.len()].copy_from_slice(theta);
        self.layers.forward(&self.weights, self.x, 0..depth - 1, &mut self.pass);
        self.eliminate();
        self.layers.forward(&self.weights, self.x, depth - 1..depth, &mut self.pass);
        let mut loss = self.differences();
        gradient.fill(0.0);
        let free = if self.eliminated.is_some() { depth - 1 } else { depth };
        self.layers.backward(&self.weights, self.x, free, &mut self.pass, gradient);
        for l in 0..depth {
            let decay = if l < free { self.decay } else { self.decay + self.ridge };
            if decay > 0.0 {
                let [matrix, _] = self.layers.places(l);
                loss += decay * self.weights[matrix.clone()].iter().map(|w| w * w).sum::<f64>();
                if l < free {
                    let pairs = gradient[matrix.clone()].iter_mut().zip(&self.weights[matrix]);
                    pairs.for_each(|(g, w)| *g += 2.0 * decay * w);
                }
            }
        }
        loss
    }
}
