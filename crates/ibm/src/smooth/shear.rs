//! What the kernel's blur takes of the shear at the surface.
use crate::Kernel;
use interfaces::Vector;

/// Velocity that markers on the surface read besides the surface's own where the fluid does not slip.
///
/// The force per area τ of a sheet of markers bends the velocity along it by τ/μ. Spread and read with the kernel, this kink is blurred: the markers read too little by
///
/// ```text
/// s = −r(n) τ_t/μ,    r(n) = r_d + (c h/12) (1 − Σ n_a⁴),
/// ```
///
/// with the [`Kernel::retraction`] r_d, the [`Kernel::self_overlap`] c and the tangential part τ_t of what the markers put on the fluid. (r = ½⟨|n·ξ|⟩ − (c h/12) Σ n_a⁴, ξ the distance of two points drawn from the kernel;
/// the last term is the discrete Laplacian's. The first hardly depends on n.) Markers that lie r_d deeper instead read no slip, too, but also let nothing through r_d too deep, which
/// is felt to second order: drag and resistance to strain of a sphere ask for 3 and more times the depth that its torque asks for.
///
/// Where diffusion is implicit with the weight θ_a along axis a, the force is added after it, and does what (1 − ν dt Σ θ_a ∂_a²) of it would do in a steady flow: it is sharpened, and r is less by c (ν dt/h) Σ θ_a n_a².
/// (With markers at a depth of r_d the torque on a turning sphere is 16 % too small by this.)
///
/// τ is what was given in steps before, so that s is followed by
///
/// ```text
/// s ← s + θ (−r τ_t/μ − s),    θ = min(½, κ c ν dt/(r h)),    κ = ¼/N:
/// ```
///
/// a change of s by ε takes a force of ε h/(c ν dt) times μ/h in the same step, so θ has to stay below about c ν dt/(r h). Where bodies share fluid, either takes back in each pass what the other gave, and N is twice the number of passes
/// (two discs that meet are unstable with κ = ¼); else it is 1. What happens faster than in 3 N h²/ν meets the surface as it is.
#[derive(Clone, Debug, Default)]
pub(super) struct Shear {
    kernel: Option<Kernel>,
    /// h \[m\].
    spacing: f64,
    /// Outward normals n, in the world.
    normals: Vec<Vector>,
    /// s \[m/s\], in the world.
    pub(super) slip: Vec<Vector>,
    /// −Σ s·(what the fluid got) \[J\]: dissipation that the blur hides, in the last step.
    pub(super) hidden: f64,
    /// c times the changes of velocity that the sheet made by itself in the step under way, τ dt/(ρ h) \[m/s\].
    pub(super) given: Vec<Vector>,
}

/// κ.
const SHARE: f64 = 0.25;
/// Largest θ.
const MOST: f64 = 0.5;

impl Shear {
    /// Markers with these normals on cells of this size; the slip stays if there are as many as before.
    pub(super) fn place(&mut self, kernel: Kernel, spacing: f64, normals: impl Iterator<Item = Vector>) {
        (self.kernel, self.spacing) = (Some(kernel), spacing);
        self.normals.clear();
        self.normals.extend(normals);
        if self.slip.len() != self.normals.len() {
            self.slip.clear();
            self.slip.resize(self.normals.len(), Vector::zeros());
        }
    }
    /// Nothing has been given yet.
    pub(super) fn clear(&mut self) {
        self.given.clear();
        self.given.resize(self.normals.len(), Vector::zeros());
    }
    /// A step is over in which diffusion went over the area ν dt \[m²\]; the part `implicit` of it before the forcing; markers move these `masses` of fluid, and what they ask for is asked for by so many `rivals`, themselves included.
    pub(super) fn finish(&mut self, diffused: f64, implicit: Vector, (masses, rivals): (&[f64], f64)) {
        let Some(kernel) = self.kernel else { return };
        let work = |((slip, given), mass): ((&Vector, &Vector), &f64)| mass * slip.dot(given);
        self.hidden = -self.slip.iter().zip(&self.given).zip(masses).map(work).sum::<f64>();
        let (overlap, diffused) = (kernel.self_overlap(), diffused / (self.spacing * self.spacing));
        for ((slip, given), n) in self.slip.iter_mut().zip(&self.given).zip(&self.normals) {
            let oblique = 1.0 - n.iter().map(|x| x.powi(4)).sum::<f64>();
            let unseen = overlap * diffused * implicit.dot(&n.map(|x| x * x));
            let reach = (kernel.retraction() + overlap / 12.0 * oblique - unseen) / diffused;
            let along = (given - given.dot(n) * n) / overlap;
            let follow = if reach == 0.0 { MOST } else { (SHARE / rivals * overlap / reach.abs()).min(MOST) };
            *slip -= follow * (reach * along + *slip);
        }
    }
    /// s, number by number.
    pub(super) fn numbers(&self) -> Vec<f64> {
        self.slip.iter().flat_map(|s| [s.x, s.y, s.z]).collect()
    }
    /// What was saved.
    pub(super) fn of(numbers: &[f64]) -> Self {
        let slip = numbers.as_chunks().0.iter().map(|s: &[f64; 3]| Vector::from(*s)).collect();
        Self { slip, ..Self::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A force that stays leaves −r(n) τ_t/μ, whatever its part along the normal, and at once no more than the share that is stable.
    #[test]
    fn a_steady_force_leaves_its_slip() {
        let (kernel, diffused) = (Kernel::Yang, 0.05);
        for (n, reach) in [
            (Vector::z(), kernel.retraction()),
            (Vector::new(1.0, 1.0, 0.0) / 2.0_f64.sqrt(), kernel.retraction() + kernel.self_overlap() / 24.0),
        ] {
            let mut shear = Shear::default();
            shear.place(kernel, 0.1, std::iter::once(n));
            shear.clear();
            let along = Vector::new(0.3, -0.3, 0.0);
            shear.given[0] = along + 0.7 * n;
            shear.finish(diffused * 0.01, Vector::zeros(), (&[], 1.0));
            // τ h/μ = given/(c ν dt/h²).
            let last = -reach / (kernel.self_overlap() * diffused) * along;
            let follow = SHARE * kernel.self_overlap() * diffused / reach;
            assert!((shear.slip[0] - follow * last).norm() < 1e-12 * last.norm(), "{shear:?}");
            (0..2000).for_each(|_| shear.finish(diffused * 0.01, Vector::zeros(), (&[], 1.0)));
            assert!((shear.slip[0] - last).norm() < 1e-9 * last.norm(), "{:?} {last:?}", shear.slip);
        }
    }

    /// Of the force that is added after implicit diffusion less is felt, along the axes that are implicit.
    #[test]
    fn implicit_diffusion_takes_from_the_reach() {
        let (kernel, diffused) = (Kernel::Yang, 0.4);
        let slip = |implicit: Vector| {
            let mut shear = Shear::default();
            shear.place(kernel, 0.1, std::iter::once(Vector::z()));
            shear.clear();
            shear.given[0] = Vector::x();
            (0..200).for_each(|_| shear.finish(diffused * 0.01, implicit, (&[], 1.0)));
            shear.slip[0].x * kernel.self_overlap() * diffused
        };
        let half = Vector::new(0.5, 0.5, 0.5);
        assert!((slip(Vector::zeros()) + kernel.retraction()).abs() < 1e-9);
        assert!((slip(half) + kernel.retraction() - 0.2 * kernel.self_overlap()).abs() < 1e-9);
        // The sheet's force does not vary along x and y.
        assert!((slip(Vector::new(0.5, 0.5, 0.0)) + kernel.retraction()).abs() < 1e-9);
    }
}
