//! Friction along the surface.
use super::law::{Memory, Touch};
use interfaces::Vector;

/// Radius of friction against spin about the normal, ∫|y| dA/A, over the radius of gyration √(∫ y² dA/A), of a disc: 2√2/3.
const FRICTION_RADIUS: f64 = 0.942_809_041_582_063_4;

/// Elastic deformation along a patch, kept from sub-step to sub-step.
#[derive(Clone, Copy, Debug, Default)]
pub struct Springs {
    /// Elastic tangential force on the first body \[N\].
    along: Vector,
    /// Elastic torque on it about the normal \[N m\].
    about: f64,
}

impl Memory for Springs {
    const N: usize = 4;
    fn save(&self, out: &mut Vec<f64>) {
        self.along.save(out);
        out.push(self.about);
    }
    fn load(from: &[f64]) -> Self {
        Self { along: Vector::load(from), about: from[3] }
    }
}

/// A spring that grows with the sliding and a dashpot, together at most what friction holds.
pub(super) struct Friction {
    /// Tangential stiffness \[N/m\].
    pub(super) stiffness: f64,
    /// Tangential dashpot \[N s/m\].
    pub(super) viscosity: f64,
    /// μ|F_n| \[N\].
    pub(super) limit: f64,
}

impl Friction {
    /// Force along the surface on the first body, and torque about the normal: the patch holds against spin as against sliding,
    /// by the polar moment of its area. `springs` are the elastic parts of the last ones.
    #[inline(always)]
    pub(super) fn act(&self, t: &Touch<'_>, springs: &mut Springs) -> (Vector, Vector) {
        let force = self.force(t, &mut springs.along);
        if t.pivot.is_none() {
            return (force, Vector::zeros());
        }
        let polar = t.overlap.pivot.trace();
        if polar <= 0.0 || self.limit <= 0.0 {
            springs.about = 0.0;
            return (force, Vector::zeros());
        }
        let normal = t.overlap.normal;
        let (spin, square) = (t.spin.dot(&normal), polar / t.area);
        let limit = FRICTION_RADIUS * self.limit * square.sqrt();
        springs.about -= spin * (t.dt * self.stiffness * square);
        let torque = springs.about - spin * (self.viscosity * square);
        if torque.abs() > limit {
            springs.about = limit.copysign(torque);
            return (force, normal * springs.about);
        }
        (force, normal * torque)
    }

    /// The tangential force on the first body. `spring` is the elastic part of the last one: it is turned into the present tangent plane, its
    /// length kept, and updated.
    #[inline(always)]
    fn force(&self, t: &Touch<'_>, spring: &mut Vector) -> Vector {
        if self.limit <= 0.0 {
            *spring = Vector::zeros();
            return *spring;
        }
        let n = t.overlap.normal;
        let sliding = t.velocity - n * n.dot(&t.velocity);
        let before = spring.norm_squared();
        *spring -= n * n.dot(spring);
        let turned = spring.norm_squared();
        if turned > 0.0 {
            *spring *= (before / turned).sqrt();
        }
        *spring -= sliding * (t.dt * self.stiffness);
        let along = *spring - sliding * self.viscosity;
        let size = along.norm_squared();
        if size > self.limit * self.limit {
            // The spring holds what friction can hold.
            *spring = along * (self.limit / size.sqrt());
            return *spring;
        }
        along
    }
}
