//! The markers of one body.
use super::shear::Shear;
use super::stencils::Stencils;
use interfaces::{BodyId, Kinematics, Lattice, Pose, SurfaceElement, Vector, Wrench};

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
    /// If they make up for the blur of the shear.
    pub(super) shear: Option<Shear>,
}

impl Markers {
    /// What the markers of body `b` read of component `c`, without what their surface does besides moving with it and what the blur leaves.
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
        if let Some(shear) = &self.shear {
            out.iter_mut().zip(&shear.slip).for_each(|(value, slip)| *value -= slip[c]);
        }
    }

    /// Brings component `c` nearer to the body's motion.
    pub(super) fn pass(
        &mut self,
        c: usize,
        lattice: &Lattice,
        u: &mut [f64],
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
        if let Some(shear) = &mut self.shear {
            // given/(ρ A h), c times what this part of the sheet changes by itself.
            for ((sum, given), mass) in shear.given.iter_mut().zip(&*values).zip(&self.masses) {
                sum[c] += given / (per_mass * mass);
            }
        }
        self.stencils.spread(c, lattice, values, u);
        let mut unit = Vector::zeros();
        unit[c] = 1.0;
        self.reaction.force[c] -= impulse;
        self.reaction.torque -= moment.cross(&unit);
    }
}
