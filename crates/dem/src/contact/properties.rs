//! What two materials are to one another.
use crate::Material;

/// How the properties of two bodies make those of their contact.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Means {
    /// Springs and dampers in series: ab/(a + b).
    #[default]
    Series,
    /// The harmonic mean to the letter: 2ab/(a + b).
    Literal,
}

impl Means {
    /// The mean of two lengths, masses …; the other one's (twice, for [`Means::Literal`]) when one is infinite.
    #[inline]
    pub fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Series => series(a, b),
            Self::Literal => 2.0 * series(a, b),
        }
    }
}

/// Product over sum; zero when either is zero, the other one when one is infinite.
#[inline]
pub(crate) fn series(a: f64, b: f64) -> f64 {
    if b == f64::INFINITY {
        a
    } else if a == f64::INFINITY {
        b
    } else if a > 0.0 && b > 0.0 {
        a * (b / (a + b))
    } else {
        0.0
    }
}

/// What two materials are to one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairProperties {
    /// Y = 1/Σ((1 − ν_i²)/Y_i) \[Pa\]; twice that by [`Means::Literal`].
    pub stiffness: f64,
    /// γ = γ_i γ_j/(γ_i + γ_j), no unit.
    pub damping: f64,
    /// e: each body gives back the share e_i² of what energy its spring took up, e² = Σ s_i e_i²/Σ s_i, s_i = (1 − ν_i²)/Y_i.
    pub restitution: f64,
    /// ζ of a contact that [`Potential`](crate::Potential) damps to e.
    pub damping_ratio: f64,
    /// μ, the mean of both.
    pub friction: f64,
    /// μ_r, the mean of both.
    pub rolling_friction: f64,
    /// Ratio of tangential to normal stiffness, 2(1 − ν)/(2 − ν) with the mean ν (Mindlin 1949).
    pub tangential: f64,
}

impl PairProperties {
    /// The least restitution of [`Potential`](crate::Potential); less counts as this, since the damping ratio, and with it the
    /// number of sub-steps, grows like 1/√e.
    pub const LEAST_RESTITUTION: f64 = 2e-3;

    /// The properties of the pair, by springs in series.
    pub fn new(a: &Material, b: &Material) -> Self {
        Self::by(Means::Series, a, b)
    }
    /// The properties of the pair, by these `means`.
    pub fn by(means: Means, a: &Material, b: &Material) -> Self {
        let soft = |m: &Material| (1.0 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus;
        let poisson = 0.5 * (a.poisson_ratio + b.poisson_ratio);
        let returned = soft(a) * a.restitution * a.restitution + soft(b) * b.restitution * b.restitution;
        let restitution = (returned / (soft(a) + soft(b))).sqrt();
        Self {
            stiffness: means.of(1.0 / soft(a), 1.0 / soft(b)),
            damping: means.of(a.damping, b.damping),
            restitution,
            damping_ratio: damping_ratio(restitution),
            friction: 0.5 * (a.friction + b.friction),
            rolling_friction: 0.5 * (a.rolling_friction + b.rolling_friction),
            tangential: 2.0 * (1.0 - poisson) / (2.0 - poisson),
        }
    }
}

/// ζ of a damped linear oscillator that leaves its contact, once it no longer pushes, at e times the speed at which it came
/// (Schwager & Pöschel 2007, Granul. Matter 9, 465; for ζ > 1 by analytic continuation):
///
/// ```text
/// e = exp(−2ζ arccos(ζ)/√(1 − ζ²))
/// ```
fn damping_ratio(restitution: f64) -> f64 {
    let target = -restitution.clamp(PairProperties::LEAST_RESTITUTION, 1.0).ln();
    // −ln e grows with ζ: halve.
    let (mut low, mut high) = (0.0, 16.0);
    while high - low > f64::EPSILON * high {
        let middle: f64 = 0.5 * (low + high);
        if decrement(middle) < target {
            low = middle
        } else {
            high = middle
        }
        if middle == low && middle == high {
            break;
        }
    }
    low
}

/// −ln e of a damping ratio.
fn decrement(ratio: f64) -> f64 {
    let square = 1.0 - ratio * ratio;
    // arccos(ζ)/√(1 − ζ²) ≈ 1 + (1 − ζ)/3 near ζ = 1.
    let angle = match square {
        s if s.abs() < 1e-6 => 1.0 + s / 6.0,
        s if s > 0.0 => ratio.acos() / s.sqrt(),
        s => ratio.acosh() / (-s).sqrt(),
    };
    2.0 * ratio * angle
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the oscillator itself, integrated by a fourth-order scheme in small steps.
    #[test]
    fn damping_ratios() {
        for e in [0.01, 0.06, 0.1353, 0.2, 0.5, 0.9, 0.99] {
            let ratio = damping_ratio(e);
            let rate = |[q, v]: [f64; 2]| [v, -q - 2.0 * ratio * v];
            let (mut x, h) = ([0.0, 1.0], 1e-5);
            while x[0] + 2.0 * ratio * x[1] > 0.0 {
                let ahead = |k: [f64; 2], h: f64| [x[0] + h * k[0], x[1] + h * k[1]];
                let a = rate(x);
                let b = rate(ahead(a, 0.5 * h));
                let c = rate(ahead(b, 0.5 * h));
                let d = rate(ahead(c, h));
                for i in 0..2 {
                    x[i] += h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
                }
            }
            assert!((-x[1] - e).abs() < 1e-4 * e, "{e}: {} by {ratio}", -x[1]);
        }
        assert_eq!(damping_ratio(1.0), 0.0);
        assert_eq!(damping_ratio(0.0), damping_ratio(PairProperties::LEAST_RESTITUTION));
    }

    #[test]
    fn means() {
        let hard =
            Material { youngs_modulus: 3.0, poisson_ratio: 0.5, restitution: 0.8, ..Material::default() };
        let soft = Material { restitution: 0.4, ..Material::default() };
        let p = PairProperties::new(&hard, &soft);
        assert!((p.stiffness - 1.0 / (0.75 / 3.0 + 0.91 / 1e6)).abs() < 1e-12);
        assert!((p.damping - 0.25).abs() < 1e-15 && (p.friction - 0.3).abs() < 1e-15);
        // Here nearly all of the energy is in the body called hard.
        assert!((p.restitution - 0.8).abs() < 1e-5 && p.restitution < 0.8);
        let literal = PairProperties::by(Means::Literal, &hard, &soft);
        assert!((literal.stiffness - 2.0 * p.stiffness).abs() < 1e-12 && literal.damping == 2.0 * p.damping);
        assert_eq!(series(0.0, 0.0), 0.0);
        assert_eq!(series(3.0, f64::INFINITY), 3.0);
        assert_eq!(series(f64::INFINITY, 3.0), 3.0);
        assert_eq!(Means::Literal.of(3.0, f64::INFINITY), 6.0);
    }
}
