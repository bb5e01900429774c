//! Gauss and Newton's way down, where the frames hardly tell themselves apart and other ways creep.
use super::amplitudes::add;
use super::descent::{DAMPING, Descent, dot};
use super::objective::Evaluation;
use crate::Mat;

/// Conjugate gradients end at this part of the gradient, or after so many products.
const FORCING: f64 = 0.01;
const MOST: usize = 200;
/// Trials of one step, at most.
const TRIALS: usize = 12;

/// Steps of Levenberg and Marquardt's; the second derivatives at given modes are the metric, and precondition conjugate gradients.
pub(super) struct Newton {
    pub(super) damping: f64,
    /// Products with second derivatives that are left to be made.
    pub(super) products: usize,
}

impl Newton {
    /// One step; false if none gets lower.
    pub(super) fn step(&mut self, descent: &mut Descent<'_>) -> bool {
        for _ in 0..TRIALS {
            let (step, predicted) = self.minimise(descent);
            let mut trial = descent.amplitudes.clone();
            add(&mut trial.values, 1.0, &step);
            trial.orthonormalise();
            let evaluation = Evaluation::new(descent.problem, &trial);
            let gain = descent.evaluation.value - evaluation.value;
            if gain > 0.0 {
                if gain > 0.75 * predicted {
                    self.damping = (0.1 * self.damping).max(1e-14);
                } else if gain < 0.25 * predicted {
                    self.damping *= 4.0;
                }
                (descent.amplitudes, descent.evaluation) = (trial, evaluation);
                return true;
            }
            self.damping *= 10.0;
        }
        false
    }

    /// The d that makes g·d + ½ d·(H + damping M) d nearly least, and how much less than nothing that is.
    fn minimise(&mut self, descent: &Descent<'_>) -> (Mat<f64>, f64) {
        let Descent { problem, amplitudes, evaluation, .. } = descent;
        let gradient = &evaluation.gradient;
        let mut step = Mat::zeros(gradient.nrows(), gradient.ncols());
        // g + (H + damping M) d, and −M times the direction of search.
        let mut left = gradient.clone();
        let mut metric = gradient.clone();
        let mut search = evaluation.precondition(&left, DAMPING);
        let mut square = -dot(&left, &search);
        let first = square;
        for _ in 0..MOST.min(self.products) {
            if square <= FORCING * FORCING * first {
                break;
            }
            self.products -= 1;
            let mut curved = Evaluation::curvature(problem, amplitudes, &search);
            add(&mut curved, -self.damping, &metric);
            let curvature = dot(&search, &curved);
            if curvature <= 0.0 {
                break;
            }
            add(&mut step, square / curvature, &search);
            add(&mut left, square / curvature, &curved);
            let mut next = evaluation.precondition(&left, DAMPING);
            let next_square = -dot(&left, &next);
            add(&mut next, next_square / square, &search);
            let mut next_metric = left.clone();
            add(&mut next_metric, next_square / square, &metric);
            (search, metric, square) = (next, next_metric, next_square);
        }
        let predicted = -0.5 * (dot(&step, gradient) + dot(&step, &left));
        (step, predicted)
    }
}
