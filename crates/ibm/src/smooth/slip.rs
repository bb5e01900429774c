//! What the kernel's blur takes of the shear at the surface.
use crate::{Kernel, ViscousStep};
use interfaces::Vector;

/// The velocity past the surface that markers on it read where the fluid does not slip; none if they lie deeper.
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
/// τ is that of the step under way: with g = c τ dt/(ρ h), the change of velocity that the sheet makes by itself in the step over its share c of it, s = −β g_t with
///
/// ```text
/// β = r h/(c ν dt) − Σ θ_a n_a²,
/// ```
///
/// and each pass solves (1 + β P_t) Δg = U + s − Eu, P_t = 1 − nnᵀ. So at once after a start the surface is impermeable and hardly holds the fluid, as it is without viscosity; after h r/ν, a third of the time in which viscosity crosses a cell, it does.
#[derive(Clone, Debug, Default)]
pub(super) struct Slip {
    /// Outward normals n, in the world.
    normals: Vec<Vector>,
    /// β.
    ratios: Vec<f64>,
    /// Is any β other than zero?
    any: bool,
    /// g so far in the step under way \[m/s\].
    pub(super) given: Vec<Vector>,
}

/// Least β: implicit steps of more than ν dt = (r/c + ¼ h) h are not made up for in full.
const LEAST: f64 = -0.25;

impl Slip {
    /// Markers with these normals.
    pub(super) fn turn(&mut self, normals: impl Iterator<Item = Vector>) {
        self.normals.clear();
        self.normals.extend(normals);
    }
    /// A step begins, on cells of size `h`, with this `share` s of the blur to make up for; nothing has been given yet. Without a step that is known there is no slip.
    pub(super) fn begin(&mut self, step: Option<ViscousStep>, kernel: Kernel, h: f64, share: f64) {
        self.given.clear();
        self.given.resize(self.normals.len(), Vector::zeros());
        self.ratios.clear();
        let Some(ViscousStep { diffused, implicit }) = step else {
            self.ratios.resize(self.normals.len(), 0.0);
            self.any = false;
            return;
        };
        let (retraction, overlap) = (kernel.retraction(), kernel.self_overlap());
        let per_reach = h * h / (overlap * diffused);
        self.ratios.extend(self.normals.iter().map(|n| {
            let squares = n.component_mul(n);
            let reach = share * (retraction + overlap / 12.0 * (1.0 - squares.norm_squared()));
            // None of nothing, even without viscosity.
            let blurred = if reach > 0.0 { reach * per_reach } else { 0.0 };
            (blurred - implicit.dot(&squares)).max(LEAST)
        }));
        self.any = self.ratios.iter().any(|ratio| *ratio != 0.0);
    }
    /// Does anything slip?
    pub(super) fn any(&self) -> bool {
        self.any
    }
    /// The normal of marker `m`.
    #[inline]
    pub(super) fn normal(&self, m: usize) -> Vector {
        self.normals[m]
    }
    /// How much less the tangential part of what a marker asks for has to change g: β/(1 + β); and its normal.
    #[inline]
    pub(super) fn yields(&self, m: usize) -> (f64, Vector) {
        let ratio = self.ratios[m];
        // A fluid without viscosity slips.
        (if ratio < f64::INFINITY { ratio / (1.0 + ratio) } else { 1.0 }, self.normals[m])
    }
    /// s of marker `m`.
    #[inline]
    pub(super) fn of(&self, m: usize) -> Vector {
        let (given, n) = (self.given[m], self.normals[m]);
        let along = given - given.dot(&n) * n;
        if along == Vector::zeros() { along } else { -self.ratios[m] * along }
    }
    /// The Δg by which marker `m` gets what is `missing`: (1 + β P_t)⁻¹ times it.
    #[inline]
    pub(super) fn answer(&self, m: usize, missing: Vector) -> Vector {
        let (yields, n) = self.yields(m);
        missing - yields * (missing - missing.dot(&n) * n)
    }
    /// −Σ s·(what the fluid got) \[J\], markers moving these `masses` of fluid.
    pub(super) fn hidden(&self, masses: &[f64]) -> f64 {
        (0..self.given.len()).map(|m| -masses[m] * self.of(m).dot(&self.given[m])).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(n: Vector, diffused: f64, implicit: Vector) -> Slip {
        let mut slip = Slip::default();
        slip.turn(std::iter::once(n));
        slip.begin(Some(ViscousStep { diffused, implicit }), Kernel::Yang, 0.1, 1.0);
        slip
    }

    /// s = −r(n) τ_t/μ, whatever the force along the normal; the answer to what is missing leaves nothing missing.
    #[test]
    fn a_force_leaves_its_slip() {
        let (kernel, diffused) = (Kernel::Yang, 0.05);
        for (n, reach) in [
            (Vector::z(), kernel.retraction()),
            (Vector::new(1.0, 1.0, 0.0) / 2.0_f64.sqrt(), kernel.retraction() + kernel.self_overlap() / 24.0),
        ] {
            let mut slip = one(n, diffused * 0.01, Vector::zeros());
            let along = Vector::new(0.3, -0.3, 0.0);
            slip.given[0] = along + 0.7 * n;
            // τ h/μ = given/(c ν dt/h²).
            let last = -reach / (kernel.self_overlap() * diffused) * along;
            assert!((slip.of(0) - last).norm() < 1e-12 * last.norm(), "{slip:?}");
            let missing = Vector::new(0.2, 0.5, -0.4);
            slip.given[0] = slip.answer(0, missing);
            assert!((missing + slip.of(0) - slip.given[0]).norm() < 1e-12, "{slip:?}");
            assert!((slip.hidden(&[2.0]) + 2.0 * slip.of(0).dot(&slip.given[0])).abs() < 1e-12);
        }
    }

    /// Of the force that is added after implicit diffusion less is felt, along the axes that are implicit.
    #[test]
    fn implicit_diffusion_takes_from_the_reach() {
        let (kernel, diffused) = (Kernel::Yang, 0.4);
        let reach = |implicit: Vector| {
            let mut slip = one(Vector::z(), diffused * 0.01, implicit);
            slip.given[0] = Vector::x();
            -slip.of(0).x * kernel.self_overlap() * diffused
        };
        assert!((reach(Vector::zeros()) - kernel.retraction()).abs() < 1e-9);
        assert!(
            (reach(Vector::repeat(0.5)) - kernel.retraction() + 0.2 * kernel.self_overlap()).abs() < 1e-9
        );
        // The sheet's force does not vary along x and y.
        assert!((reach(Vector::new(0.5, 0.5, 0.0)) - kernel.retraction()).abs() < 1e-9);
    }

    /// Without viscosity only what goes through the surface is held; without a step all is.
    #[test]
    fn the_ends_are_free_slip_and_no_slip() {
        let missing = Vector::new(0.2, 0.5, -0.4);
        let mut slip = one(Vector::z(), 0.0, Vector::zeros());
        assert_eq!(slip.answer(0, missing), -0.4 * Vector::z());
        slip.given[0] = slip.answer(0, missing);
        assert_eq!(slip.of(0), Vector::zeros());
        slip.begin(None, Kernel::Yang, 0.1, 1.0);
        assert_eq!(slip.answer(0, missing), missing);
    }
}
