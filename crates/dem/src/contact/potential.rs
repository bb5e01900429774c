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
/// Where whole flat faces meet, A is there at once, and a force like √V would be without limit stiff at first: a cube that lies on a floor
/// would swing a thousand times faster than it bounces. Between two bodies with flat faces √V is therefore √V₀ x(3 − x)/2, x = V/V₀, below V₀ = 10⁻⁴ A_f R*,
/// A_f the smaller of both largest faces: still a function of V alone, so energy is kept.
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
    /// E(V) and E′(V) \[J, J/m³\] (in a plane scene per metre of depth) of bodies as large as spheres of these radii, flat faces of
    /// up to `face` in area meeting.
    #[inline]
    pub fn energy(
        &self,
        p: &PairProperties,
        sizes: [f64; 2],
        face: f64,
        volume: f64,
        plane: bool,
    ) -> (f64, f64) {
        let radius = series(sizes[0], sizes[1]);
        let unit = p.stiffness / (self.factor * radius);
        if plane {
            let depth = (0.75 * volume / (2.0 * radius).sqrt()).cbrt().powi(2);
            // δ ∝ V^⅔.
            return (0.4 * unit * depth * volume, 2.0 / 3.0 * unit * depth);
        }
        let slope = 0.5 * unit / (PI * radius).sqrt();
        let first = ONSET * face * radius;
        if volume < first {
            let (root, x) = (first.sqrt(), volume / first);
            (slope * root * first * x * x * (0.75 - x / 6.0), slope * root * 0.5 * x * (3.0 - x))
        } else {
            let root = volume.sqrt();
            (slope * (2.0 / 3.0 * root * volume - first * first.sqrt() / 12.0), slope * root)
        }
    }
}

/// Volume up to which the force between flat faces begins gently, in areas of the face times R*.
const ONSET: f64 = 1e-4;

/// What is given back is the share e² of the energy, and the leapfrog's error a share of all of it: the smaller e, the finer the steps.
const FINER: f64 = 0.02;
/// Where edges and faces come in, the force has kinks: finer steps where all of the energy is to be kept (to 1e-8 of it, over 200 rebounds of cubes).
const EDGES_FINER: f64 = 16.0;

/// How quickly a contact at rest follows what presses it. All contacts of a heap do so at once, each by what the others did last: at once would be
/// too much, and forces would swing from sub-step to sub-step.
const FOLLOW: f64 = 0.25;

/// What [`Potential`] keeps per patch.
#[derive(Clone, Copy, Debug, Default)]
pub struct Loading {
    spring: Vector,
    /// Speed of approach along the normal \[m/s\] and by how much the contact slowed it in the last sub-step \[m/s²\].
    approach: f64,
    slowed: f64,
    /// What else quickened it \[m/s²\], smoothed.
    other: f64,
    met: bool,
    /// Did loading turn into unloading, or back, in the last sub-step?
    turned: bool,
}

impl Memory for Loading {
    const N: usize = 8;
    fn save(&self, out: &mut Vec<f64>) {
        self.spring.save(out);
        out.extend([self.approach, self.slowed, self.other]);
        out.extend([self.met, self.turned].map(|yes| f64::from(u8::from(yes))));
    }
    fn load(from: &[f64]) -> Self {
        let [approach, slowed, other] = [3, 4, 5].map(|i| from[i]);
        let [met, turned] = [6, 7].map(|i| from[i] != 0.0);
        Self { spring: Vector::load(from), approach, slowed, other, met, turned }
    }
}

/// A contact that is loaded and unloaded.
struct Turn {
    /// Speed of approach \[m/s\].
    approach: f64,
    /// What the full force slows it by, and what all else quickens it by \[m/s²\].
    full: f64,
    other: f64,
    /// Share of the force while the bodies part.
    least: f64,
    dt: f64,
}

impl Turn {
    /// Mean share of the force over a sub-step, and whether loading turned into unloading or back within it. A contact that did so in the last
    /// sub-step already is at `rest`: it is brought to a stop over some.
    fn share(&self, rest: bool) -> (f64, bool) {
        let Self { approach, full, other, least, dt } = *self;
        let now = if approach > 0.0 { 1.0 } else { least };
        let end = approach + (other - now * full) * dt;
        if full <= 0.0 || (end <= 0.0) == (approach <= 0.0) {
            return (now, false);
        }
        let share = if rest {
            (other + FOLLOW * approach / dt) / full
        } else {
            let before = approach / (approach - end);
            before * now + (1.0 - before) * (other / full).clamp(least, 1.0)
        };
        (share.clamp(least, 1.0), true)
    }
}

impl ContactLaw for Potential {
    type Memory = Loading;
    const MOBILITY: bool = true;

    #[inline(always)]
    fn push(&self, p: &PairProperties, t: &Touch<'_>, memory: &mut Loading) -> Push {
        let o = t.overlap;
        let area = t.area;
        // One within the other: nothing changes when they move.
        if area <= 0.0 {
            *memory = Loading::default();
            return Push { force: Vector::zeros(), couple: Vector::zeros(), stiffness: 0.0 };
        }
        let rate = t.rate;
        let (_, mut slope) = self.energy(p, t.sizes, t.face, t.volume, t.plane);
        // Where whole faces meet, the force begins like a root of the depth. The first and the last sub-step of such a contact do the work that
        // belongs to the whole way from and to V = 0, though the bodies touch in a part of a sub-step only.
        let reach = 0.5 * t.dt * rate.abs();
        let most = t.volume + reach;
        let (deepest, steepest) = self.energy(p, t.sizes, t.face, most, t.plane);
        if t.face > 0.0 && reach > 0.0 && (!memory.met || (rate < 0.0 && t.volume < 2.0 * reach)) {
            slope = deepest / (2.0 * reach);
        }
        let approach = rate / area;
        let full = slope * t.mobility / area;
        let least = p.restitution * p.restitution;
        let share = if least < 1.0 {
            if memory.met {
                let other = (approach - memory.approach) / t.dt + memory.slowed;
                memory.other += FOLLOW * (other - memory.other);
            }
            let turn = Turn { approach, full, other: memory.other, least, dt: t.dt };
            let (share, turned) = turn.share(memory.turned);
            memory.turned = turned;
            share
        } else {
            1.0
        };
        (memory.approach, memory.slowed, memory.met) = (approach, share * full, true);
        let size = share * slope;
        // dF/dδ = E″A² + E′dA/dδ: of a shallow sphere Y A/L_c; of a face half of it.
        let stiffness = steepest * area * area / most * (1.0 + FINER / least.max(0.001));
        let stiffness = match t.face > 0.0 {
            true if least >= 1.0 => EDGES_FINER * stiffness,
            true => 2.0 * stiffness,
            false => stiffness,
        };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Material;

    /// E is the integral of E′ from V = 0 on, through the gentle beginning and beyond, in space and in the plane.
    #[test]
    fn energy_is_the_integral_of_its_slope() {
        let p = PairProperties::new(&Material::default(), &Material::default());
        let law = Potential::default();
        let (sizes, face) = ([0.01, 0.02], 3e-4);
        let first = ONSET * face * series(sizes[0], sizes[1]);
        for (face, plane) in [(face, false), (0.0, false), (0.0, true)] {
            let (n, end) = (4000, 5.0 * first);
            let at = |v: f64| law.energy(&p, sizes, face, v, plane);
            let mut sum = 0.0;
            for i in 0..n {
                // Cubes of equal steps: the root at V = 0 does no harm.
                let [low, high] = [i, i + 1].map(|k| end * (f64::from(k) / f64::from(n)).powi(3));
                sum += (high - low) * at(0.5 * (low + high)).1;
                if (i + 1) % 500 == 0 {
                    let (energy, _) = at(high);
                    assert!((sum / energy - 1.0).abs() < 1e-4, "{face} {plane}: {sum:e} {energy:e}");
                }
            }
        }
    }
}
