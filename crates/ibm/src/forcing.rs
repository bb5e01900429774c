//! What every immersed boundary offers.
use crate::IbmError;
use interfaces::{Bodies, BodyId, Kinematics, Vector, VelocityField, Wrench};
use nalgebra::{Matrix6, Vector6};

/// How the fluid that a forcing drags along resists a change of a body's motion: with generalised
/// velocity v = (U, Ω), the forcing hands the body the impulse `momentum` − `mass`·v.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layer {
    /// Σ (1−χ) w JᵀJ \[kg, kg m, kg m²\].
    pub mass: Matrix6<f64>,
    /// Σ (1−χ) w Jᵀ û \[N s, N m s\].
    pub momentum: Vector6<f64>,
}

impl Layer {
    /// Adds one forced point at `arm`: its velocity component `c` is `found` before the forcing,
    /// and the forcing moves the fluid mass `weight` there to the body's velocity.
    pub(crate) fn add(&mut self, c: usize, arm: Vector, weight: f64, found: f64) {
        let mut unit = Vector::zeros();
        unit[c] = 1.0;
        let turn = arm.cross(&unit);
        let j = Vector6::new(unit.x, unit.y, unit.z, turn.x, turn.y, turn.z);
        self.mass += weight * j * j.transpose();
        self.momentum += weight * found * j;
    }
}

/// A way to make the fluid move with the bodies, used between the halves of a projection step:
/// [`place`](Self::place), then [`force`](Self::force) before each of
/// [`rounds`](Self::rounds) pressure solutions. Impulses are per step, about each body's centre.
pub trait Forcing: Send {
    /// Takes note of where the bodies are; only those that moved cost anything.
    ///
    /// # Errors
    /// [`IbmError`] for bodies that this forcing cannot represent on this grid.
    fn place(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies) -> Result<(), IbmError>;

    /// Density of the fluid it was made for \[kg/m³\].
    fn density(&self) -> f64;

    /// How often forcing and pressure solution alternate within a step.
    fn rounds(&self) -> usize;

    /// The fluid's resistance at body `b`, from the velocity u* before any forcing.
    fn layer(&self, velocity: &dyn VelocityField, b: BodyId) -> Layer;

    /// Momentum and angular momentum of the fluid inside body `b`: ρ ∫_Ωs (u, r × u) dV
    /// \[N s, N m s\].
    fn internal_momentum(&self, velocity: &dyn VelocityField, b: BodyId) -> Wrench;

    /// Adds dt f_ib to the velocity so that it meets the bodies' motion.
    fn force(&mut self, velocity: &mut dyn VelocityField, bodies: &dyn Kinematics);

    /// −ρ ∫ f_ib dV dt over all forcing since [`place`](Self::place): the impulse that the fluid
    /// put on body `b` and on the fluid inside it.
    fn reaction(&self, b: BodyId) -> Wrench;

    /// Root mean square of the velocity that is left between fluid and bodies where the forcing
    /// acts on their surfaces \[m/s\].
    fn slip(&self, velocity: &dyn VelocityField, bodies: &dyn Kinematics) -> f64;
}
