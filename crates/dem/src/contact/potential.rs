//! The law with a potential.
use super::friction::Friction;
use super::law::{ContactLaw, Memory, Push, Touch};
use super::properties::{PairProperties, series};
use crate::DemError;
use interfaces::Vector;
use std::f64::consts::PI;

/// A volume law with a potential, so that it keeps the energy of bodies of any shape:
///
/// ```text
/// F = −s E′(V) ∇V,   E′(V) = Y/(2 L_c) √(V/(π R*)),   E(V) = Y/(3 L_c) √(V³/(π R*)),   L_c = c R*
/// ```
///
/// V is the volume of all patches of a pair, ∇V its derivative with respect to place *and* turning (the force −E′∂V/∂x at the patch's
/// centroid and the couple −E′∂V/∂φ), R* = R_i R_j/(R_i + R_j) with the radii of spheres as large as the bodies. For shallow
/// overlaps of spheres it is [`Chen`](crate::Chen)'s Y V/L_c. In a plane scene E′ = ⅔ Y δ/L_c, δ = (3V/(4√(2R*)))^⅔.
///
/// s is 1 while V grows and e² while it shrinks (Walton & Braun 1986, J. Rheol. 30, 949): bodies part with e times the speed at which they
/// met, whatever that was, whatever their shapes, at walls and at bodies that cannot be moved, where contact is central. Where loading
/// turns into unloading within a sub-step, each has its part of it; a contact at rest carries what it has to, between both.
///
/// Along the surface a spring and a dashpot as in [`Chen`](crate::Chen), but with the damping ratio that gives e in a linear contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Potential {
    factor: f64,
}

impl Default for Potential {
    /// c = 4.
    fn default() -> Self {
        Self { factor: 4.0 }
    }
}

impl Potential {
    /// Another factor c in L_c, positive.
    #[must_use]
    pub fn with_length_factor(self, factor: f64) -> Self {
        Self { factor }
    }
    /// E(V) and E′(V) \[J, J/m³\] (in a plane scene per metre of depth).
    #[inline]
    pub fn energy(&self, p: &PairProperties, sizes: [f64; 2], volume: f64, plane: bool) -> (f64, f64) {
        let radius = series(sizes[0], sizes[1]);
        let unit = p.stiffness / (self.factor * radius);
        if plane {
            let depth = (0.75 * volume / (2.0 * radius).sqrt()).cbrt().powi(2);
            // δ ∝ V^⅔.
            (0.4 * unit * depth * volume, 2.0 / 3.0 * unit * depth)
        } else {
            let slope = 0.5 * unit * (volume / (PI * radius)).sqrt();
            (2.0 / 3.0 * slope * volume, slope)
        }
    }
}

/// What is given back is the share e² of the energy, and the leapfrog's error a share of all of it: the smaller e, the finer the steps.
const FINER: f64 = 0.02;

/// What [`Potential`] keeps per patch.
#[derive(Clone, Copy, Debug, Default)]
pub struct Loading {
    spring: Vector,
    /// Speed of approach along the normal \[m/s\] and by how much the contact slowed it in the last sub-step \[m/s²\].
    approach: f64,
    slowed: f64,
    met: bool,
}

impl Memory for Loading {
    const N: usize = 6;
    fn save(&self, out: &mut Vec<f64>) {
        self.spring.save(out);
        out.extend([self.approach, self.slowed, f64::from(u8::from(self.met))]);
    }
    fn load(from: &[f64]) -> Self {
        Self { spring: Vector::load(from), approach: from[3], slowed: from[4], met: from[5] != 0.0 }
    }
}

/// Mean share of the force over a sub-step, for bodies that approach at `u`, are slowed by `a` under the full force, and
/// quickened by `other` from elsewhere; `least` of the force while they part.
fn share(u: f64, a: f64, other: f64, least: f64, dt: f64) -> f64 {
    // What keeps a contact where it is.
    let rest = if a > 0.0 { (other / a).clamp(least, 1.0) } else { 1.0 };
    if u > 0.0 {
        let end = u + (other - a) * dt;
        if end >= 0.0 {
            return 1.0;
        }
        let before = u / (u - end);
        before + (1.0 - before) * rest
    } else {
        let end = u + (other - least * a) * dt;
        if end <= 0.0 {
            return least;
        }
        let before = u / (u - end);
        before * least + (1.0 - before) * rest
    }
}

impl ContactLaw for Potential {
    type Memory = Loading;
    const MOBILITY: bool = true;

    #[inline]
    fn length(&self, arms: [f64; 2]) -> f64 {
        self.factor * series(arms[0], arms[1])
    }

    #[inline]
    fn push(&self, p: &PairProperties, t: &Touch<'_>, memory: &mut Loading) -> Push {
        let o = t.overlap;
        let area = o.area();
        // One within the other: nothing changes when they move.
        if area <= 0.0 {
            *memory = Loading::default();
            return Push { force: Vector::zeros(), couple: Vector::zeros(), stiffness: 0.0 };
        }
        let rate = o.rate(t.velocity, t.spin);
        let (_, mut slope) = self.energy(p, t.sizes, t.volume, t.plane);
        // Where whole faces meet, the force begins like a root of the depth. The first and the last sub-step of such a contact do the work that
        // belongs to the whole way from and to V = 0, though the bodies touch in a part of a sub-step only.
        let reach = 0.5 * t.dt * rate.abs();
        let most = t.volume + reach;
        let (deepest, steepest) = self.energy(p, t.sizes, most, t.plane);
        if t.flat && reach > 0.0 && (!memory.met || (rate < 0.0 && t.volume < 2.0 * reach)) {
            slope = deepest / (2.0 * reach);
        }
        let approach = rate / area;
        let full = slope * t.mobility / area;
        let least = p.restitution * p.restitution;
        let share = if least < 1.0 {
            let other = if memory.met { (approach - memory.approach) / t.dt + memory.slowed } else { 0.0 };
            share(approach, full, other, least, t.dt)
        } else {
            1.0
        };
        (memory.approach, memory.slowed, memory.met) = (approach, share * full, true);
        let size = share * slope;
        // dF/dδ = E″A² + E′dA/dδ: of a shallow sphere Y A/L_c; of a face half of it.
        let stiffness = steepest * area * area / most * (1.0 + FINER / least.max(0.001));
        let stiffness = if t.flat { 2.0 * stiffness } else { stiffness };
        let mut force = o.gradient * -size;
        if p.friction > 0.0 {
            let [wa, wb] = t.inverse_masses;
            let ratio = match p.restitution {
                e if e >= 1.0 => 0.0,
                e if e <= 0.0 => 1.0,
                e => -e.ln() / (PI * PI + e.ln() * e.ln()).sqrt(),
            };
            let along = p.tangential * stiffness;
            force += Friction {
                normal: o.normal,
                velocity: t.velocity,
                stiffness: along,
                viscosity: 2.0 * ratio * (along / (wa + wb)).sqrt(),
                limit: p.friction * size * area,
                dt: t.dt,
            }
            .force(&mut memory.spring);
        }
        Push { force, couple: o.moment * -size, stiffness }
    }

    fn check(&self) -> Result<(), DemError> {
        if self.factor.is_finite() && self.factor > 0.0 {
            Ok(())
        } else {
            Err(DemError::LengthFactor { factor: self.factor })
        }
    }
}
