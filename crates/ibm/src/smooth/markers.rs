//! The markers of one body.
use super::slip::Slip;
use super::stencils::Stencils;
use interfaces::{BodyId, Kinematics, Lattice, Pose, SurfaceElement, Twist, Vector, VelocityField, Wrench};

/// The markers of one body.
#[derive(Clone, Debug, Default)]
pub(super) struct Markers {
    pub(super) pose: Option<Pose>,
    /// Volume of a cell around the body \[m³\].
    pub(super) cell: f64,
    /// In the body's frame.
    pub(super) elements: Vec<SurfaceElement>,
    /// No other body's markers reach where these do.
    pub(super) alone: bool,
    /// From the centre of mass, in the world.
    pub(super) arms: Vec<Vector>,
    /// ρ ΔV_m / c: the fluid mass that a marker moves \[kg\].
    pub(super) masses: Vec<f64>,
    pub(super) stencils: Stencils,
    pub(super) reaction: Wrench,
    /// What they read past the surface, if they lie on it.
    pub(super) slip: Option<Slip>,
}

impl Markers {
    /// What the markers of body `b` read of component `c`, without what their surface does besides moving with it.
    pub(super) fn read(
        &self,
        c: usize,
        lattice: &Lattice,
        u: &[f64],
        (bodies, b): (&(impl Kinematics + ?Sized), BodyId),
        out: &mut Vec<f64>,
    ) {
        self.stencils.read(c, lattice, u, out);
        if self.arms.first().is_some_and(|arm| bodies.surface_motion(b, *arm).is_some()) {
            for (value, arm) in out.iter_mut().zip(&self.arms) {
                *value -= bodies.surface_motion(b, *arm).unwrap_or_default()[c];
            }
        }
    }

    /// U + Ω×r + s − E u of marker `m`, of which the markers read `found`.
    #[inline]
    pub(super) fn missing(&self, m: usize, twist: &Twist, found: &[Vec<f64>], dim: usize) -> Vector {
        let mut missing = twist.at(self.arms[m]);
        missing += self.slip.as_ref().map_or(Vector::zeros(), |slip| slip.of(m));
        (0..dim).for_each(|c| missing[c] -= found[c][m]);
        (dim..3).for_each(|c| missing[c] = 0.0);
        missing
    }

    /// Brings component `c` nearer to the body's motion: without slip they do not see one another.
    pub(super) fn pass(
        &mut self,
        c: usize,
        (lattice, u): (&Lattice, &mut [f64]),
        (bodies, b): (&dyn Kinematics, BodyId),
        density: f64,
        values: &mut Vec<f64>,
    ) {
        // All markers read before any of them spreads: their order must not matter.
        self.read(c, lattice, u, (bodies, b), values);
        let (twist, per_mass) = (bodies.twist(b), 1.0 / (density * self.cell));
        let (mut impulse, mut moment) = (0.0, Vector::zeros());
        let weights = self.masses.iter().zip(&self.stencils.relax[c]);
        for ((value, arm), (mass, relax)) in values.iter_mut().zip(&self.arms).zip(weights) {
            let given = mass * relax * (twist.at(*arm)[c] - *value);
            impulse += given;
            moment += given * arm;
            *value = given * per_mass;
        }
        self.stencils.spread(c, lattice, values, u);
        let mut unit = Vector::zeros();
        unit[c] = 1.0;
        self.reaction.force[c] -= impulse;
        self.reaction.torque -= moment.cross(&unit);
    }

    /// Brings the velocity nearer to the body's motion and the slip along its surface.
    pub(super) fn pass_with_slip(
        &mut self,
        (velocity, lattices): (&mut dyn VelocityField, &[Lattice; 3]),
        (bodies, b): (&dyn Kinematics, BodyId),
        density: f64,
        values: &mut [Vec<f64>; 3],
    ) {
        let dim = velocity.dim();
        for (c, values) in values.iter_mut().enumerate().take(dim) {
            self.read(c, &lattices[c], velocity.component(c), (bodies, b), values);
        }
        let (twist, per_mass) = (bodies.twist(b), 1.0 / (density * self.cell));
        for m in 0..self.arms.len() {
            let mut change = self.missing(m, &twist, values, dim);
            if let Some(slip) = &mut self.slip {
                change = slip.answer(m, change);
                (0..dim).for_each(|c| change[c] *= self.stencils.relax[c][m]);
                slip.given[m] += change;
            }
            let impulse = self.masses[m] * change;
            self.reaction.force -= impulse;
            self.reaction.torque -= self.arms[m].cross(&impulse);
            (0..dim).for_each(|c| values[c][m] = per_mass * impulse[c]);
        }
        for (c, values) in values.iter().enumerate().take(dim) {
            self.stencils.spread(c, &lattices[c], values, velocity.component_mut(c));
        }
    }
}
