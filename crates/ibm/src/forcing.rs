//! What every immersed boundary offers.
use crate::IbmError;
use interfaces::{Bodies, BodyId, Kinematics, Renumbering, Twist, Vector, VelocityField, Wrench};
use nalgebra::{Matrix3, Matrix6, Vector6};

/// How the fluid that a forcing drags along resists a change of a body's motion: with generalised
/// velocity v = (U, Ω), the forcing hands the body the impulse `momentum` − `mass`·v.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layer {
    /// Σ (1−χ) w JᵀJ \[kg, kg m, kg m²\].
    pub mass: Matrix6<f64>,
    /// Σ (1−χ) w Jᵀ û \[N s, N m s\].
    pub momentum: Vector6<f64>,
    /// Resistance of fluid that other bodies hold as well, which `mass` does not contain: the body
    /// receives −`shared`·(v − v') for other bodies of velocity v' \[kg, kg m, kg m²\].
    pub shared: Matrix6<f64>,
}

impl Layer {
    /// Adds the forced points of velocity component `c`.
    pub(crate) fn add(&mut self, c: usize, sums: &LayerSums) {
        let mut unit = Vector::zeros();
        unit[c] = 1.0;
        // J = (e, r × e), linear in the arm r.
        let turn = sums.mass_arm.cross(&unit);
        let cross = unit.cross_matrix();
        self.mass[(c, c)] += sums.mass;
        for i in 0..3 {
            self.mass[(c, 3 + i)] += turn[i];
            self.mass[(3 + i, c)] += turn[i];
        }
        let mut angular = self.mass.fixed_view_mut::<3, 3>(3, 3);
        angular += cross * sums.mass_arms * cross.transpose();
        self.momentum[c] += sums.momentum;
        let mut angular = self.momentum.fixed_rows_mut::<3>(3);
        angular += sums.momentum_arm.cross(&unit);
    }
    /// Adds `share` of a point at the arm r where a fluid mass w moves along the unit vector n only: `along` is √w n, `momentum` √w n·û.
    pub(crate) fn add_along(&mut self, share: f64, along: Vector, arm: Vector, momentum: f64) {
        let turn = arm.cross(&along);
        let j = Vector6::new(along.x, along.y, along.z, turn.x, turn.y, turn.z);
        self.mass += share * j * j.transpose();
        self.momentum += share * momentum * j;
    }
}

/// Sums over forced points of one velocity component: a fluid mass w at the arm r, whose velocity was û before, is moved to the
/// body's velocity.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LayerSums {
    /// Σ w, Σ w r, Σ w r rᵀ.
    mass: f64,
    mass_arm: Vector,
    mass_arms: Matrix3<f64>,
    /// Σ w û, Σ w û r.
    momentum: f64,
    momentum_arm: Vector,
}

impl LayerSums {
    /// Adds one point.
    #[inline]
    pub(crate) fn add(&mut self, arm: Vector, mass: f64, found: f64) {
        let momentum = mass * found;
        self.mass += mass;
        self.mass_arm += mass * arm;
        self.mass_arms += (mass * arm) * arm.transpose();
        self.momentum += momentum;
        self.momentum_arm += momentum * arm;
    }
}

/// What viscosity does in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViscousStep {
    /// ν dt \[m²\].
    pub diffused: f64,
    /// The part θ of the viscous terms along each axis that was taken at the end of the step, before the forcing: 0 of explicit ones, ½ by Crank–Nicolson's scheme.
    pub implicit: Vector,
}

/// A way to make the fluid move with the bodies, used between the halves of a projection step: [`begin`](Self::begin),
/// [`place`](Self::place), then [`force`](Self::force) before each of
/// [`rounds`](Self::rounds) pressure solutions. Impulses are per step, about each body's centre.
pub trait Forcing: Send {
    /// A step begins. Where the viscosity is not known, what follows from it is left out.
    fn begin(&mut self, _step: Option<ViscousStep>) {}

    /// Takes note of where the bodies are; only those that moved cost anything. What tells of them below is asked for with
    /// the bodies where they are then.
    ///
    /// # Errors
    /// [`IbmError`] for bodies that this forcing cannot represent on this grid.
    fn place(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies) -> Result<(), IbmError>;

    /// Bodies were taken away: what is kept of each goes by its new number from now on.
    fn renumber(&mut self, numbers: &Renumbering);

    /// Density of the fluid it was made for \[kg/m³\].
    fn density(&self) -> f64;

    /// How often forcing and pressure solution alternate within a step.
    fn rounds(&self) -> usize;

    /// The fluid's resistance at body `b`, from the velocity u* before any forcing. Bodies that move as they are told need not ask.
    fn layer(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies, b: BodyId) -> Layer;

    /// Momentum and angular momentum of the fluid inside body `b`: ρ ∫_Ωs (u, r × u) dV
    /// \[N s, N m s\].
    fn internal_momentum(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies, b: BodyId) -> Wrench;

    /// The same if that fluid moved with `twist`, of what of the body is on the grid: ρ ∫ (v, r × v) dV, v = U + Ω×r \[N s, N m s\].
    fn rigid_momentum(
        &mut self,
        velocity: &dyn VelocityField,
        bodies: &dyn Bodies,
        b: BodyId,
        twist: Twist,
    ) -> Wrench;

    /// Adds dt f_ib to the velocity so that it meets the bodies' motion.
    fn force(&mut self, velocity: &mut dyn VelocityField, bodies: &dyn Kinematics);

    /// What was dissipated in the last step where the forcing blurs the flow, besides what the flow itself shows \[J\].
    fn hidden_dissipation(&self) -> f64 {
        0.0
    }

    /// What was lost in the last step because the forcing pushes the fluid inelastically \[J\]: what bodies of the `mean` velocity ½(vⁿ + vⁿ⁺¹) gave, ∫ f_ib·v dV dt, less the
    /// [hidden dissipation](Self::hidden_dissipation) and less what the fluid got, ρ∫ f_ib·½(uⁿ + uⁿ⁺¹) dV dt. The velocity is now `velocity`, and was `before` at the step's start.
    /// Vanishes with the step, unless the fluid is still to be made to follow at once. Nothing where it is not known.
    fn inelastic_loss(
        &mut self,
        _before: &[&[f64]],
        _velocity: &dyn VelocityField,
        _bodies: &dyn Kinematics,
        _mean: &dyn Fn(BodyId) -> Twist,
    ) -> f64 {
        0.0
    }

    /// Work in the last step of the motion that surfaces have of their own \[J\].
    fn surface_work(&self, _bodies: &dyn Kinematics) -> f64 {
        0.0
    }

    /// −ρ ∫ f_ib dV dt over all forcing since [`place`](Self::place): the impulse that the fluid
    /// put on body `b` and on the fluid inside it.
    fn reaction(&self, b: BodyId) -> Wrench;

    /// Root mean square of the velocity that is left between fluid and bodies where the forcing
    /// acts on their surfaces \[m/s\].
    fn slip(&self, velocity: &dyn VelocityField, bodies: &dyn Kinematics) -> f64;
}

/// Forcing that is chosen at run time.
impl Forcing for Box<dyn Forcing> {
    fn begin(&mut self, step: Option<ViscousStep>) {
        (**self).begin(step);
    }
    fn place(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies) -> Result<(), IbmError> {
        (**self).place(velocity, bodies)
    }
    fn renumber(&mut self, numbers: &Renumbering) {
        (**self).renumber(numbers);
    }
    fn density(&self) -> f64 {
        (**self).density()
    }
    fn rounds(&self) -> usize {
        (**self).rounds()
    }
    fn layer(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies, b: BodyId) -> Layer {
        (**self).layer(velocity, bodies, b)
    }
    fn internal_momentum(&mut self, velocity: &dyn VelocityField, bodies: &dyn Bodies, b: BodyId) -> Wrench {
        (**self).internal_momentum(velocity, bodies, b)
    }
    fn rigid_momentum(
        &mut self,
        velocity: &dyn VelocityField,
        bodies: &dyn Bodies,
        b: BodyId,
        twist: Twist,
    ) -> Wrench {
        (**self).rigid_momentum(velocity, bodies, b, twist)
    }
    fn force(&mut self, velocity: &mut dyn VelocityField, bodies: &dyn Kinematics) {
        (**self).force(velocity, bodies);
    }
    fn hidden_dissipation(&self) -> f64 {
        (**self).hidden_dissipation()
    }
    fn inelastic_loss(
        &mut self,
        before: &[&[f64]],
        velocity: &dyn VelocityField,
        bodies: &dyn Kinematics,
        mean: &dyn Fn(BodyId) -> Twist,
    ) -> f64 {
        (**self).inelastic_loss(before, velocity, bodies, mean)
    }
    fn surface_work(&self, bodies: &dyn Kinematics) -> f64 {
        (**self).surface_work(bodies)
    }
    fn reaction(&self, b: BodyId) -> Wrench {
        (**self).reaction(b)
    }
    fn slip(&self, velocity: &dyn VelocityField, bodies: &dyn Kinematics) -> f64 {
        (**self).slip(velocity, bodies)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Σ w JᵀJ and Σ w Jᵀ û, J = (e, r × e), point by point.
    #[test]
    fn sums_make_the_layer() {
        let points =
            [(0.3, [0.2, -0.7, 0.4], 1.3), (0.8, [-0.5, 0.1, 0.9], -0.6), (0.1, [0.6, 0.3, -0.2], 0.4)];
        let (mut layer, mut mass, mut momentum) = (Layer::default(), Matrix6::zeros(), Vector6::zeros());
        for c in 0..3 {
            let mut sums = LayerSums::default();
            for (w, arm, found) in points {
                let (arm, mut unit) = (Vector::from(arm), Vector::zeros());
                unit[c] = 1.0;
                sums.add(arm, w, found);
                let turn = arm.cross(&unit);
                let j = Vector6::new(unit.x, unit.y, unit.z, turn.x, turn.y, turn.z);
                mass += w * j * j.transpose();
                momentum += w * found * j;
            }
            layer.add(c, &sums);
        }
        assert!(
            (layer.mass - mass).norm() < 1e-15 && (layer.momentum - momentum).norm() < 1e-15,
            "{layer:?}"
        );
    }
}
