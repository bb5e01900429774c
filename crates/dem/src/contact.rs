//! The contact force.
use crate::{Material, Overlap};
use interfaces::Vector;

/// What two materials are to one another: springs in series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairProperties {
    /// Y = 1/Σ((1 − ν_i²)/Y_i) \[Pa\].
    pub stiffness: f64,
    /// γ = γ_i γ_j/(γ_i + γ_j), no unit.
    pub damping: f64,
    /// μ, the mean of both.
    pub friction: f64,
    /// Ratio of tangential to normal stiffness, 2(1 − ν)/(2 − ν) with the mean ν (Mindlin 1949).
    pub tangential: f64,
}

impl PairProperties {
    /// The properties of the pair.
    pub fn new(a: &Material, b: &Material) -> Self {
        let soft = |m: &Material| (1.0 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus;
        let poisson = 0.5 * (a.poisson_ratio + b.poisson_ratio);
        Self {
            stiffness: 1.0 / (soft(a) + soft(b)),
            damping: series(a.damping, b.damping),
            friction: 0.5 * (a.friction + b.friction),
            tangential: 2.0 * (1.0 - poisson) / (2.0 - poisson),
        }
    }
}

/// Product over sum; zero when both are zero.
pub(crate) fn series(a: f64, b: f64) -> f64 {
    if a + b > 0.0 { a * b / (a + b) } else { 0.0 }
}

/// Where and how two bodies touch at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    pub(crate) overlap: Overlap,
    /// Velocity of the first body against the second at the contact \[m/s\].
    pub(crate) velocity: Vector,
    /// Angular velocity of the first body against the second \[rad/s\].
    pub(crate) spin: Vector,
    /// Reduced mass M \[kg\]; in a plane scene that of a slice as deep as L_c, so that bodies of all sizes rebound
    /// alike and no unit of depth enters.
    pub(crate) mass: f64,
    /// Characteristic length L_c \[m\].
    pub(crate) length: f64,
}

/// The force on the first body (Chen 2012; Isoz et al. 2023, equation 4, with dV/dt outside the root, as its
/// dimension asks):
///
/// ```text
/// F_n = max(0, Y V/L_c + γ √(Y M/L_c³) dV/dt) n
/// ```
///
/// and along the surface a spring that grows with the sliding and a dashpot, both `tangential` times the
/// normal ones (Y A/L_c per length, γ√(YM/L_c³) A per velocity, A = |∂V/∂x|), together at most μ|F_n|.
/// `spring` is the elastic part of the last step's tangential force: it is turned into the present tangent
/// plane and updated. In a plane scene V is an area, all forces are per metre of
/// depth, and M is the mass of a slice as deep as L_c: the dashpot is γ √(Y M′)/L_c dV/dt with the mass M′ per metre.
pub(crate) fn force(p: &PairProperties, t: &Touch, spring: &mut Vector, dt: f64) -> Vector {
    let n = t.overlap.normal;
    let dashpot = p.damping * (p.stiffness * t.mass / t.length.powi(3)).sqrt();
    let pressure = p.stiffness * t.overlap.volume / t.length + dashpot * t.overlap.rate(t.velocity, t.spin);
    let pressure = pressure.max(0.0);

    let sliding = t.velocity - n * n.dot(&t.velocity);
    let length = spring.norm();
    *spring -= n * n.dot(spring);
    // Turned with the contact: the length is kept.
    if spring.norm() > 0.0 {
        *spring *= length / spring.norm();
    }
    *spring -= sliding * (dt * p.tangential * p.stiffness * t.overlap.area() / t.length);
    let viscous = -sliding * (p.tangential * dashpot * t.overlap.area());
    let mut along = *spring + viscous;
    let limit = p.friction * pressure;
    if along.norm() > limit {
        along *= limit / along.norm();
        // The spring holds what friction can hold.
        *spring = along;
    }
    n * pressure + along
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_means() {
        let (a, b) = (
            Material { youngs_modulus: 3.0, poisson_ratio: 0.5, ..Material::default() },
            Material::default(),
        );
        let p = PairProperties::new(&a, &b);
        assert!((p.stiffness - 1.0 / (0.75 / 3.0 + 0.91 / 1e6)).abs() < 1e-12);
        assert!((p.damping - 0.25).abs() < 1e-15 && (p.friction - 0.3).abs() < 1e-15);
        assert_eq!(series(0.0, 0.0), 0.0);
    }
}
