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
    /// μ, the mean of both.
    pub friction: f64,
    /// μ_r, the mean of both.
    pub rolling_friction: f64,
    /// Ratio of tangential to normal stiffness, 2(1 − ν)/(2 − ν) with the mean ν (Mindlin 1949).
    pub tangential: f64,
}

impl PairProperties {
    /// The properties of the pair, by springs in series.
    pub fn new(a: &Material, b: &Material) -> Self {
        Self::by(Means::Series, a, b)
    }
    /// The properties of the pair, by these `means`.
    pub fn by(means: Means, a: &Material, b: &Material) -> Self {
        let soft = |m: &Material| (1.0 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus;
        let poisson = 0.5 * (a.poisson_ratio + b.poisson_ratio);
        let returned = soft(a) * a.restitution * a.restitution + soft(b) * b.restitution * b.restitution;
        Self {
            stiffness: means.of(1.0 / soft(a), 1.0 / soft(b)),
            damping: means.of(a.damping, b.damping),
            restitution: (returned / (soft(a) + soft(b))).sqrt(),
            friction: 0.5 * (a.friction + b.friction),
            rolling_friction: 0.5 * (a.rolling_friction + b.rolling_friction),
            tangential: 2.0 * (1.0 - poisson) / (2.0 - poisson),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
