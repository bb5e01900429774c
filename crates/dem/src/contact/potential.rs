//! The law with a potential.
use super::friction::{Friction, Springs};
use super::law::{ContactLaw, Memory, Push, Touch, stiffness_of_decay};
use super::properties::{PairProperties, series};
use crate::DemError;
use interfaces::Vector;
use std::f64::consts::PI;

/// A volume law with a potential, so that it keeps the energy of bodies of any shape:
///
/// ```text
/// F = −(E′(V) + d dV/dt) ∇V,   E′(V) = Y/(2 L_c) √(V/(π R*)),   E(V) = Y/(3 L_c) √(V³/(π R*)),   L_c = c R*
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
/// The damping d makes √E and the velocity along it a linear oscillator of damping ratio ζ, in a time of its own, whatever E(V),
/// the masses and the shapes are: d = 2ζ d√(2E)/dV/√w, w = ∇V·m⁻¹∇V. So central impacts give back e at any speed, and bodies rest
/// where E′ alone carries them. A contact never pulls. e below 0.002 counts as 0.002.
///
/// dV/dt is the integral of the normal velocity over the patch: damping is a pressure d A v_n on each of its points, and a
/// patch about which bodies pivot at constant V has the couple −d A K ω of what v_n varies ([`Pivot`](crate::Pivot)).
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

/// Stiffness of contacts of edges and faces as the time step takes it, over that of smooth ones, since the force has kinks where
/// these come in: with damping (restitution to 3e-4) and without (energy to 1e-8, over 200 rebounds of cubes).
const FACES_FINER: [f64; 2] = [4.0, 16.0];

/// Share of a new value in the running mean of what presses a contact: those of a heap follow one another, and at once would
/// make forces oscillate between sub-steps.
const FOLLOW: f64 = 0.25;

/// What [`Potential`] keeps per patch.
#[derive(Clone, Copy, Debug, Default)]
pub struct Loading {
    springs: Springs,
    /// Speed of approach along the normal that the last sub-step's contact alone leads to \[m/s\].
    expected: f64,
    /// Running mean of the rate at which everything else quickens it \[m/s²\].
    other: f64,
    /// Length of the last sub-step \[s\]; 0 before the first.
    last: f64,
}

impl Memory for Loading {
    const N: usize = Springs::N + 3;
    fn save(&self, out: &mut Vec<f64>) {
        self.springs.save(out);
        out.extend([self.expected, self.other, self.last]);
    }
    fn load(from: &[f64]) -> Self {
        let [expected, other, last] = [0, 1, 2].map(|i| from[Springs::N + i]);
        Self { springs: Springs::load(from), expected, other, last }
    }
}

/// Pressure of a patch over a sub-step.
struct Pressure {
    /// E′ + d dV/dt, mean over the sub-step \[Pa\].
    mean: f64,
    /// d \[Pa s/m³\].
    damping: f64,
    /// dE′/dV, secant from V = 0 to the deepest place of the sub-step \[Pa/m³\].
    stiffness: f64,
}

impl Potential {
    /// The pressure over a sub-step in the middle of which the patch is as `t` says.
    ///
    /// V follows the depth δ as δⁿ through the sub-step: n = 1 of faces, 3/2 of discs, 2 of curved bodies. The first sub-step of a
    /// contact does the work that belongs to the whole way from V = 0, though the bodies touch in a part of it only, and the
    /// last one to the place where the force vanishes.
    #[inline(always)]
    fn pressure(&self, p: &PairProperties, t: &Touch<'_>, memory: &mut Loading) -> Pressure {
        let energy = |volume: f64| self.energy(p, t.sizes, t.face, volume, t.plane);
        let (rate, volume) = (t.rate, t.volume);
        let (elastic, slope) = energy(volume);
        let reach = 0.5 * t.dt * rate.abs();
        // Up to round-off, where the surfaces met just as contacts were found last.
        let is_first = memory.last == 0.0 && volume <= (1.0 + 1e-6) * rate.abs() * t.since;
        if p.damping_ratio <= 0.0 || t.mobility <= 0.0 {
            let most = volume + reach;
            let (deepest, steepest) = energy(most);
            let is_last = rate < 0.0 && volume < 2.0 * reach;
            memory.last = t.dt;
            let mean = if t.face > 0.0 && (is_first || is_last) { deepest / (2.0 * reach) } else { slope };
            return Pressure { mean, damping: 0.0, stiffness: steepest / most };
        }
        // V at the ends of the sub-step, and the whole way between them in rates.
        let (n, share) = match t.face > 0.0 {
            true => (1.0, reach / volume),
            false if t.plane => (1.5, reach / (1.5 * volume)),
            false => (2.0, reach / (2.0 * volume)),
        };
        let power = |x: f64| match t.face > 0.0 {
            true => x,
            false if t.plane => x * x.sqrt(),
            false => x * x,
        };
        let most = volume * power(1.0 + share);
        let (deepest, steepest) = energy(most);
        let root = |energy: f64| (2.0 * energy).sqrt();
        // d√(2E)/dV, mean over the part of the sub-step in which the bodies touch, and over all of it.
        let (touching, all) = if is_first {
            let root = root(deepest);
            (root / (n * volume + reach), root / (2.0 * reach))
        } else if share > 1e-6 {
            let low = energy(volume * power((1.0 - share).max(0.0))).0;
            let mean = (root(deepest) - root(low)) / (2.0 * reach).min(n * volume + reach);
            (mean, mean)
        } else {
            let tangent = slope / root(elastic);
            (tangent, tangent)
        };
        let unit = 2.0 * p.damping_ratio / t.mobility.sqrt();
        let approach = rate / t.area;
        if memory.last > 0.0 {
            let other = (approach - memory.expected) / memory.last;
            memory.other += FOLLOW * (other - memory.other);
        }
        // By the velocity in the middle of the sub-step, to which the pressure itself adds.
        let unslowed = rate + 0.5 * t.dt * memory.other * t.area;
        let conservative = if is_first { deepest / (2.0 * reach) } else { slope };
        let damping = unit * touching;
        let middle = (conservative + unit * all * unslowed) / (1.0 + 0.5 * t.dt * damping * t.mobility);
        // Bodies that part do so where the pressure vanishes, as it falls by so much in half a sub-step.
        let fall = steepest - slope;
        let mean = match middle > 0.0 {
            true if rate < 0.0 && middle < 2.0 * fall => (middle + fall).powi(2) / (4.0 * fall),
            true => middle,
            false => 0.0,
        };
        memory.expected = approach - mean * t.mobility / t.area * t.dt;
        memory.last = t.dt;
        Pressure { mean, damping, stiffness: steepest / most }
    }
}

impl ContactLaw for Potential {
    type Memory = Loading;
    const MOBILITY: bool = true;
    const PIVOTS: bool = true;

    #[inline(always)]
    fn push(&self, p: &PairProperties, t: &Touch<'_>, memory: &mut Loading) -> Push {
        let o = t.overlap;
        let area = t.area;
        // One within the other: nothing changes when they move.
        if area <= 0.0 {
            *memory = Loading::default();
            return Push { force: Vector::zeros(), couple: Vector::zeros(), stiffness: 0.0 };
        }
        let Pressure { mean, damping, stiffness } = self.pressure(p, t, memory);
        // dF/dδ = E″A² + E′dA/dδ: of a shallow sphere Y A/L_c; of a face half of it.
        let mut stiffness = stiffness * area * area;
        if t.face > 0.0 {
            stiffness *= FACES_FINER[usize::from(p.damping_ratio <= 0.0)];
        }
        if damping > 0.0 {
            let decay = stiffness_of_decay(damping * t.mobility);
            stiffness = stiffness.max(decay * area * area / t.mobility);
        }
        let mut force = o.gradient * -mean;
        let mut couple = o.moment * -mean;
        if let Some(pivot) = &t.pivot {
            couple += pivot.couple(damping * area, mean, area, t.dt);
        }
        if p.friction > 0.0 {
            let [wa, wb] = t.inverse_masses;
            let ratio = match p.restitution {
                e if e >= 1.0 => 0.0,
                e if e <= 0.0 => 1.0,
                e => -e.ln() / (PI * PI + e.ln() * e.ln()).sqrt(),
            };
            let along = p.tangential * stiffness;
            let (along, torque) = Friction {
                stiffness: along,
                viscosity: 2.0 * ratio * (along / (wa + wb)).sqrt(),
                limit: p.friction * mean * area,
            }
            .act(t, &mut memory.springs);
            force += along;
            couple += torque;
        }
        Push { force, couple, stiffness }
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
