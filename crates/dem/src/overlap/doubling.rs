//! When a periodic integral by the trapezoidal rule is good enough.

/// Watches the sum over N azimuths while N is doubled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubling {
    tolerance: f64,
    last: f64,
    change: f64,
}

impl Doubling {
    pub(super) fn new(tolerance: f64) -> Self {
        Self { tolerance, last: f64::NAN, change: f64::NAN }
    }
    /// Whether the next doubling could change the `mean` over the azimuths by no more than the tolerance. What is left is
    /// guessed from the last two changes d₁, d₂: smooth integrands converge exponentially, so that the next change is below
    /// d₂²/d₁, and at an algebraic rate that is just the next change; from the first change alone it is guessed as
    /// d₁^1.5.
    pub(super) fn settled(&mut self, mean: f64) -> bool {
        let change = (mean - self.last).abs() / mean.abs();
        let left = if self.change.is_nan() {
            change * change.sqrt()
        } else {
            change * (change / self.change).min(1.0)
        };
        (self.last, self.change) = (mean, change);
        // Exact for circles, where 0/0 appears.
        change == 0.0 || left <= self.tolerance
    }
}
