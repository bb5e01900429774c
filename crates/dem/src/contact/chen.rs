//! Equation (4).
use super::friction::{Friction, Springs};
use super::law::{ContactLaw, Push, Touch};
use super::properties::{Means, PairProperties};
use crate::{DemError, Material};
use interfaces::Vector;

/// The viscoelastic volume law (Chen 2012; Isoz et al. 2023, equation 4, with dV/dt outside the root, as its dimension asks):
///
/// ```text
/// F_n = [Y V/L_c + γ √(Y M/L_c³) dV/dt] n,   L_c = c l_i l_j/(l_i + l_j),   M = m_i m_j/(m_i + m_j)
/// ```
///
/// dV/dt is the integral of the normal velocity over the patch: damping is a pressure on each of its points, with the couple that
/// belongs to it ([`Pivot`](crate::Pivot)), and so it acts on bodies that rock, too.
///
/// l from the contact to the centre of mass (infinite for a wall), M the other one's mass where one cannot be moved; no tension unless asked for.
/// Along the surface a spring that grows with the sliding and a dashpot, both `tangential` times the normal ones (Y A/L_c per length,
/// γ√(YM/L_c³) A per velocity, A = |∂V/∂x|), together at most μ|F_n|; the same against spin about the normal, by the polar moment of the patch's area. In a plane scene V is an area, all forces are per metre of
/// depth, and M is the mass of a slice as deep as L_c.
///
/// The force has no potential but for spheres and discs, so bodies with edges gain or lose some per cent of their energy in an elastic rebound, and
/// restitution depends on the speed of impact: take [`Potential`](crate::Potential) where either matters, this one to compute as the
/// literature does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chen {
    factor: f64,
    means: Means,
    adhesion: bool,
}

impl Default for Chen {
    /// c = 4, springs in series, no tension.
    fn default() -> Self {
        Self { factor: 4.0, means: Means::Series, adhesion: false }
    }
}

impl Chen {
    /// Another factor c in L_c, positive.
    #[must_use]
    pub fn with_length_factor(self, factor: f64) -> Self {
        Self { factor, ..self }
    }
    /// Other means of the two bodies' properties.
    #[must_use]
    pub fn with_means(self, means: Means) -> Self {
        Self { means, ..self }
    }
    /// The dashpot may pull bodies that part while they overlap.
    #[must_use]
    pub fn with_adhesion(self, adhesion: bool) -> Self {
        Self { adhesion, ..self }
    }

    /// 1/L_c \[1/m\], by one division.
    #[inline]
    fn per_length(&self, [la, lb]: [f64; 2]) -> f64 {
        let factor = match self.means {
            Means::Series => self.factor,
            Means::Literal => 2.0 * self.factor,
        };
        if lb == f64::INFINITY { 1.0 / (factor * la) } else { (la + lb) / (factor * la * lb) }
    }
}

impl ContactLaw for Chen {
    type Memory = Springs;
    const PIVOTS: bool = true;

    fn properties(&self, a: &Material, b: &Material) -> PairProperties {
        PairProperties::by(self.means, a, b)
    }

    #[inline(always)]
    fn push(&self, p: &PairProperties, t: &Touch<'_>, springs: &mut Springs) -> Push {
        let (n, area) = (t.overlap.normal, t.area);
        let per_length = self.per_length(t.arms);
        let [wa, wb] = t.inverse_masses;
        // YM/L_c by one division; the mass of a plane scene is that of a slice as deep as L_c.
        let mut elastic_mass = p.stiffness / (wa + wb);
        if !t.plane {
            elastic_mass *= per_length;
        }
        if self.means == Means::Literal && wa > 0.0 && wb > 0.0 {
            elastic_mass *= 2.0;
        }
        let elastic = p.stiffness * per_length;
        let dashpot = p.damping * elastic_mass.sqrt() * per_length;
        let pressure = elastic * t.overlap.volume + dashpot * t.rate;
        let pressure = if self.adhesion || pressure > 0.0 { pressure } else { 0.0 };
        let stiffness = elastic * area;
        let viscosity = dashpot * area;
        let (along, torque) = Friction {
            stiffness: p.tangential * stiffness,
            viscosity: p.tangential * viscosity,
            limit: p.friction * pressure.abs(),
        }
        .act(t, springs);
        // (√k + c√(1/m))²: as stiff as the dashpot makes it in effect.
        let stiffness = stiffness + viscosity * viscosity * (wa + wb);
        let couple = if let Some(pivot) = &t.pivot
            && pressure > 0.0
        {
            t.overlap.moment * (-dashpot * t.rate / area) + pivot.couple(dashpot, pressure / area, area, t.dt)
        } else {
            Vector::zeros()
        };
        Push { force: n * pressure + along, couple: couple + torque, stiffness }
    }

    fn check(&self) -> Result<(), DemError> {
        if self.factor.is_finite() && self.factor > 0.0 {
            Ok(())
        } else {
            Err(DemError::LengthFactor { factor: self.factor })
        }
    }
}
