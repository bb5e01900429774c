//! When a periodic integral by the trapezoidal rule is good enough.

/// Watches the means of a few integrands over N azimuths while N is doubled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Doubling {
    tolerance: f64,
    last: [f64; 2],
    change: f64,
}

impl Doubling {
    pub(super) fn new(tolerance: f64) -> Self {
        Self { tolerance, last: [f64::NAN; 2], change: f64::NAN }
    }
    /// Whether the next doubling could change the `volume`, or the `area` of the cut as a share of V^⅔, by no more than the
    /// tolerance. What is left is guessed from the last two changes d₁, d₂: smooth integrands converge exponentially, so that
    /// the next change is below d₂²/d₁, and at an algebraic rate that is just the next change; a fifth of the last change
    /// is taken at least, and from the first change alone 10 d₁^1.5.
    pub(super) fn settled(&mut self, volume: f64, area: f64) -> bool {
        let now = [volume, area];
        let scales = [volume.abs(), volume.abs().powf(2.0 / 3.0) + area.abs()];
        let change = (0..2).map(|i| (now[i] - self.last[i]).abs() / scales[i]).fold(0.0, f64::max);
        let first = self.last[0].is_nan();
        let left = if self.change.is_nan() {
            10.0 * change * change.sqrt()
        } else {
            change * (change / self.change).clamp(0.2, 1.0)
        };
        self.last = now;
        if !first {
            self.change = change;
        }
        !first && (change == 0.0 || left <= self.tolerance)
    }
    /// Whether the last doubling changed less than a thousandth of the tolerance, which no accident explains.
    pub(super) fn still(&self) -> bool {
        self.change <= 1e-3 * self.tolerance
    }
}
