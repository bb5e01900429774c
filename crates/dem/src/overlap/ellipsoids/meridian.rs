//! Where the curve crosses a meridian of the unit sphere.
use interfaces::Vector;
use nalgebra::Matrix3;

/// Azimuths at most.
pub(super) const MOST: usize = 512;
/// Newton steps at most.
const STEPS: usize = 30;
/// Change that ends Newton's method, which squares it.
const CLOSE: f64 = 1e-6;
/// Places on a meridian where the sign of D is asked for: τ at equal angles.
#[rustfmt::skip]
const PLACES: [f64; 24] = [
    -15.257051688265541, -5.027339492125848, -2.945905004545787, -2.027799401989225,
    -1.4966057626654892, -1.1402814581675487, -0.8769764629927568, -0.6681786379192991,
    -0.49314542603130407, -0.33945425886337594, -0.1989123673796581, -0.06554346281523843,
    0.06554346281523843, 0.1989123673796581, 0.33945425886337594, 0.49314542603130407,
    0.6681786379192991, 0.8769764629927568, 1.1402814581675487, 1.4966057626654892,
    2.027799401989225, 2.945905004545787, 5.027339492125848, 15.257051688265541,
];

/// D = 2b·w + wᵀCw on the unit sphere.
pub(super) struct Quadric {
    pub(super) lean: Vector,
    pub(super) form: Matrix3<f64>,
}

/// D on the half circle at an azimuth, over sin²θ, as a function of τ = cot θ with r = √(1 + τ²):
/// F = 2(b₃τ + b)r + C₃₃τ² + 2κτ + γ.
pub(super) struct Meridian {
    sin: f64,
    cos: f64,
    up: f64,
    upward: f64,
    /// b, κ, γ and their changes with the azimuth.
    across: [f64; 2],
    kappa: [f64; 2],
    gamma: [f64; 2],
}

impl Quadric {
    pub(super) fn meridian(&self, phi: f64) -> Meridian {
        let (sin, cos) = phi.sin_cos();
        let (b, c) = (&self.lean, &self.form);
        let (xx, xy, yy, xz, yz) = (c[(0, 0)], c[(0, 1)], c[(1, 1)], c[(0, 2)], c[(1, 2)]);
        Meridian {
            sin,
            cos,
            up: b.z,
            upward: c[(2, 2)],
            across: [b.x * cos + b.y * sin, b.y * cos - b.x * sin],
            kappa: [xz * cos + yz * sin, yz * cos - xz * sin],
            gamma: [
                xx * cos * cos + 2.0 * xy * cos * sin + yy * sin * sin,
                2.0 * ((yy - xx) * cos * sin + xy * (cos * cos - sin * sin)),
            ],
        }
    }
}

impl Meridian {
    fn value(&self, tau: f64) -> f64 {
        2.0 * (self.up * tau + self.across[0]) * (1.0 + tau * tau).sqrt()
            + (self.upward * tau + 2.0 * self.kappa[0]) * tau
            + self.gamma[0]
    }
    /// From F about the equator.
    pub(super) fn guess(&self) -> f64 {
        let slope = self.up + self.kappa[0];
        if slope > 0.5 * self.up { -(0.5 * self.gamma[0] + self.across[0]) / slope } else { 0.0 }
    }
    /// Calls `add` with all places of the curve and their changes with the azimuth, in the sense in which the curve runs
    /// about D > 0; answers the τ of the last one.
    pub(super) fn crossings(&self, guess: f64, add: &mut impl FnMut(Vector, Vector)) -> Option<f64> {
        let bent = self.kappa[0].abs() + self.gamma[0].abs() + self.upward.abs() + 2.0 * self.across[0].abs();
        if bent < 0.5 * self.up {
            // F rises everywhere.
            return self.crossing(guess, [f64::NEG_INFINITY, f64::INFINITY], add);
        }
        // Beyond the last places the poles decide.
        let pole = |up: f64| 2.0 * up * self.up + self.upward;
        let mut last = (f64::NEG_INFINITY, pole(-1.0));
        let mut tau = Some(0.0);
        let places = PLACES.iter().map(|tau| (*tau, self.value(*tau)));
        for now in places.chain([(f64::INFINITY, pole(1.0))]) {
            if (last.1 < 0.0) != (now.1 < 0.0) {
                let inner = [last.0, now.0].map(|t| t.clamp(-1e3, 1e3));
                let start =
                    if guess > inner[0] && guess < inner[1] { guess } else { 0.5 * (inner[0] + inner[1]) };
                tau = Some(self.crossing(start, [last.0, now.0], add)?);
            }
            last = now;
        }
        tau
    }
    /// Newton's method between `ends`, at which F has different signs, with halving where it leaves them.
    fn crossing(&self, guess: f64, mut ends: [f64; 2], add: &mut impl FnMut(Vector, Vector)) -> Option<f64> {
        let sign_low = if ends[0].is_finite() { self.value(ends[0]) } else { self.upward - 2.0 * self.up };
        let mut tau = guess;
        for _ in 0..STEPS {
            let root = (1.0 + tau * tau).sqrt();
            let value = self.value(tau);
            let slope = 2.0
                * (self.up * root
                    + (self.up * tau + self.across[0]) * tau / root
                    + self.upward * tau
                    + self.kappa[0]);
            if (value < 0.0) == (sign_low < 0.0) {
                ends[0] = tau
            } else {
                ends[1] = tau
            }
            let mut next = tau - value / slope;
            if !(next >= ends[0] && next <= ends[1]) {
                next = match ends.map(f64::is_finite) {
                    [true, true] => 0.5 * (ends[0] + ends[1]),
                    [true, false] => 2.0 * ends[0].max(0.0) + 1.0,
                    [false, true] => 2.0 * ends[1].min(0.0) - 1.0,
                    [false, false] => 0.0,
                };
            }
            let step = (next - tau).abs();
            tau = next;
            if step < CLOSE * root {
                let change =
                    -(2.0 * self.across[1] * root + 2.0 * tau * self.kappa[1] + self.gamma[1]) / slope;
                let [w, dw] = self.place(tau, change);
                let sense = if slope < 0.0 { -1.0 } else { 1.0 };
                add(w, dw * sense);
                return change.is_finite().then_some(tau);
            }
        }
        None
    }
    /// The place on the unit sphere and its change with the azimuth.
    fn place(&self, tau: f64, change: f64) -> [Vector; 2] {
        let r2 = 1.0 + tau * tau;
        let scale = 1.0 / r2.sqrt();
        let w = Vector::new(self.cos, self.sin, tau) * scale;
        let dw = Vector::new(-self.sin, self.cos, change) * scale - w * (tau * change / r2);
        [w, dw]
    }
}
