//! Descent of the squared error over the amplitudes.
use super::objective::{Amplitudes, Evaluation};
use super::spectrum::Spectrum;
use crate::Mat;
use std::collections::VecDeque;

/// Pairs of steps and changes of the gradient that are remembered.
const MEMORY: usize = 20;
/// Part of the trace that is added to the second derivatives at given modes: some snapshots do not tell all amplitudes.
const DAMPING: f64 = 1e-10;

/// Limited-memory BFGS; the step to the best amplitudes at given modes (alternating least squares) is its first guess.
pub(super) struct Descent<'a> {
    spectrum: &'a Spectrum,
    pub(super) amplitudes: Amplitudes,
    pub(super) evaluation: Evaluation,
    /// Steps, changes of the gradient, and their product.
    memory: VecDeque<(Mat<f64>, Mat<f64>, f64)>,
}

fn dot(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    let column = |c: usize| a.col_as_slice(c).iter().zip(b.col_as_slice(c)).map(|(x, y)| x * y).sum::<f64>();
    (0..a.ncols()).map(column).sum()
}

/// `to` += factor `x`.
fn add(to: &mut Mat<f64>, factor: f64, x: &Mat<f64>) {
    for c in 0..to.ncols() {
        to.col_as_slice_mut(c).iter_mut().zip(x.col_as_slice(c)).for_each(|(t, x)| *t += factor * x);
    }
}

impl<'a> Descent<'a> {
    /// From these amplitudes.
    pub(super) fn new(spectrum: &'a Spectrum, mut amplitudes: Amplitudes) -> Self {
        amplitudes.orthonormalise();
        let evaluation = Evaluation::new(spectrum, &amplitudes);
        Self { spectrum, amplitudes, evaluation, memory: VecDeque::new() }
    }

    fn direction(&self) -> Mat<f64> {
        let mut q = self.evaluation.gradient.clone();
        let mut factors = Vec::new();
        for (s, y, sy) in self.memory.iter().rev() {
            let factor = dot(s, &q) / sy;
            add(&mut q, -factor, y);
            factors.push(factor);
        }
        let mut d = self.evaluation.precondition(&q, DAMPING);
        for ((s, y, sy), factor) in self.memory.iter().zip(factors.iter().rev()) {
            let factor = factor + dot(y, &d) / sy;
            add(&mut d, -factor, s);
        }
        d
    }

    /// One step; false if none gets lower.
    pub(super) fn step(&mut self) -> bool {
        let mut d = self.direction();
        let mut slope = dot(&d, &self.evaluation.gradient);
        if slope >= 0.0 || !slope.is_finite() {
            self.memory.clear();
            d = self.direction();
            slope = dot(&d, &self.evaluation.gradient);
        }
        let mut t = 1.0;
        for _ in 0..20 {
            let mut trial = self.amplitudes.clone();
            add(&mut trial.values, t, &d);
            let triangles = trial.orthonormalise();
            let evaluation = Evaluation::new(self.spectrum, &trial);
            let (old, new) = (self.evaluation.value, evaluation.value);
            if new <= old + 1e-4 * t * slope {
                let mut s = d;
                (0..s.ncols()).for_each(|c| s.col_as_slice_mut(c).iter_mut().for_each(|x| *x *= t));
                // In the new coordinates: steps go with the amplitudes, gradients against them.
                for (s, y, _) in &mut self.memory {
                    trial.carry(&triangles, s, y);
                }
                let mut before = std::mem::replace(&mut self.evaluation, evaluation).gradient;
                trial.carry(&triangles, &mut s, &mut before);
                let mut y = self.evaluation.gradient.clone();
                add(&mut y, -1.0, &before);
                let sy = dot(&s, &y);
                if sy > 1e-10 * (dot(&s, &s) * dot(&y, &y)).sqrt() {
                    self.memory.push_back((s, y, sy));
                    if self.memory.len() > MEMORY {
                        self.memory.pop_front();
                    }
                }
                self.amplitudes = trial;
                return new < old;
            }
            // The minimum of the parabola.
            t *= (-0.5 * t * slope / (new - old - t * slope)).clamp(0.1, 0.5);
        }
        let again = !self.memory.is_empty();
        self.memory.clear();
        again
    }
}

impl Amplitudes {
    /// Makes the columns of each frame orthonormal: A = A' R. The R of each frame are returned, column by column. A column that
    /// depends on those before it becomes zero.
    pub(super) fn orthonormalise(&mut self) -> Vec<Mat<f64>> {
        let mut first = 0;
        let mut triangles = Vec::new();
        for &rank in &self.ranks {
            let mut triangle: Mat<f64> = Mat::zeros(rank, rank);
            for c in 0..rank {
                let mut x = self.values.col_as_slice(first + c).to_vec();
                let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
                let before = norm(&x);
                for _ in 0..2 {
                    for b in 0..c {
                        let q = self.values.col_as_slice(first + b);
                        let part: f64 = q.iter().zip(&x).map(|(q, x)| q * x).sum();
                        triangle[(b, c)] += part;
                        x.iter_mut().zip(q).for_each(|(x, q)| *x -= part * q);
                    }
                }
                let after = norm(&x);
                let factor = if after > 1e-13 * before && after > 0.0 { after.recip() } else { 0.0 };
                triangle[(c, c)] = after;
                let to = self.values.col_as_slice_mut(first + c);
                to.iter_mut().zip(&x).for_each(|(to, x)| *to = x * factor);
            }
            first += rank;
            triangles.push(triangle);
        }
        triangles
    }

    /// S R⁻¹ and Y Rᵀ, frame by frame.
    fn carry(&self, triangles: &[Mat<f64>], s: &mut Mat<f64>, y: &mut Mat<f64>) {
        let n = s.nrows();
        let mut first = 0;
        for r in triangles {
            let rank = r.nrows();
            for c in 0..rank {
                let inverse = if r[(c, c)] > 0.0 { r[(c, c)].recip() } else { 0.0 };
                for j in 0..n {
                    let sum: f64 = (0..c).map(|b| s[(j, first + b)] * r[(b, c)]).sum();
                    s[(j, first + c)] = (s[(j, first + c)] - sum) * inverse;
                    // Row c of R has nothing before column c.
                    y[(j, first + c)] = (c..rank).map(|b| y[(j, first + b)] * r[(c, b)]).sum();
                }
            }
            first += rank;
        }
    }
}
