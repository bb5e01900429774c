//! Descent of the squared error over the amplitudes.
use super::amplitudes::{Amplitudes, add};
use super::objective::Evaluation;
use super::problem::Problem;
use crate::Mat;
use std::collections::VecDeque;

/// Pairs of steps and changes of the gradient that are remembered.
const MEMORY: usize = 40;
/// Part of the trace that is added to the second derivatives at given modes: some snapshots do not tell all amplitudes.
pub(super) const DAMPING: f64 = 1e-10;

/// Limited-memory BFGS; the step to the best amplitudes at given modes (alternating least squares) is its first guess.
pub(super) struct Descent<'a> {
    pub(super) problem: &'a Problem<'a>,
    pub(super) amplitudes: Amplitudes,
    pub(super) evaluation: Evaluation,
    /// Steps, changes of the gradient, and their product.
    memory: VecDeque<(Mat<f64>, Mat<f64>, f64)>,
}

pub(super) fn dot(a: &Mat<f64>, b: &Mat<f64>) -> f64 {
    let column = |c: usize| a.col_as_slice(c).iter().zip(b.col_as_slice(c)).map(|(x, y)| x * y).sum::<f64>();
    (0..a.ncols()).map(column).sum()
}

impl<'a> Descent<'a> {
    /// From these amplitudes.
    pub(super) fn new(problem: &'a Problem<'a>, mut amplitudes: Amplitudes) -> Self {
        amplitudes.orthonormalise();
        let evaluation = Evaluation::new(problem, &amplitudes);
        Self { problem, amplitudes, evaluation, memory: VecDeque::new() }
    }

    /// Goes on with another sample of the same data.
    pub(super) fn with(mut self, problem: &'a Problem<'a>) -> Self {
        self.evaluation = Evaluation::new(problem, &self.amplitudes);
        self.problem = problem;
        self
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
            let evaluation = Evaluation::new(self.problem, &trial);
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
