//! Steps of the size that past gradients suggest.
use super::Stop;
use super::lbfgs::Objective;

/// How to descend by Adam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adam {
    /// How many steps at most.
    pub steps: usize,
    /// Size of the first.
    pub first: f64,
    /// Size of the last; geometric between.
    pub last: f64,
}

impl Default for Adam {
    fn default() -> Self {
        Self { steps: 500, first: 1e-2, last: 1e-3 }
    }
}

impl Adam {
    /// Adam (Kingma & Ba, ICLR 2015) with β₁ = 0.9, β₂ = 0.999. `watch` sees the function before every step, and its value; it may
    /// end it.
    pub(super) fn minimise<O: Objective>(
        &self,
        objective: &mut O,
        theta: &mut [f64],
        watch: &mut dyn FnMut(&O, f64) -> Option<Stop>,
    ) -> Stop {
        let [beta, beta2] = [0.9, 0.999];
        let n = theta.len();
        let (mut gradient, mut mean, mut square) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let ratio = (self.last / self.first).powf(1.0 / self.steps.max(2) as f64);
        let mut size = self.first;
        let [mut left, mut left2] = [1.0, 1.0];
        for _ in 0..self.steps {
            let value = objective.evaluate(theta, &mut gradient);
            if let Some(stop) = watch(objective, value) {
                return stop;
            }
            left *= beta;
            left2 *= beta2;
            let (rate, scale) = (size / (1.0 - left), 1.0 / (1.0 - left2));
            for i in 0..n {
                let g = gradient[i];
                mean[i] += (1.0 - beta) * (g - mean[i]);
                square[i] += (1.0 - beta2) * (g * g - square[i]);
                theta[i] -= rate * mean[i] / ((square[i] * scale).sqrt() + 1e-12);
            }
            size *= ratio;
        }
        Stop::Iterations
    }
}
