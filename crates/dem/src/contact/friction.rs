//! Friction along the surface.
use interfaces::Vector;

/// A spring that grows with the sliding and a dashpot, together at most what friction holds.
pub(super) struct Friction {
    /// Unit normal.
    pub(super) normal: Vector,
    /// Velocity of the first body against the second at the contact \[m/s\].
    pub(super) velocity: Vector,
    /// Tangential stiffness \[N/m\].
    pub(super) stiffness: f64,
    /// Tangential dashpot \[N s/m\].
    pub(super) viscosity: f64,
    /// μ|F_n| \[N\].
    pub(super) limit: f64,
    /// The sub-step \[s\].
    pub(super) dt: f64,
}

impl Friction {
    /// The tangential force on the first body. `spring` is the elastic part of the last one: it is turned into the present tangent plane, its
    /// length kept, and updated.
    #[inline(always)]
    pub(super) fn force(&self, spring: &mut Vector) -> Vector {
        if self.limit <= 0.0 {
            *spring = Vector::zeros();
            return *spring;
        }
        let n = self.normal;
        let sliding = self.velocity - n * n.dot(&self.velocity);
        let before = spring.norm_squared();
        *spring -= n * n.dot(spring);
        let turned = spring.norm_squared();
        if turned > 0.0 {
            *spring *= (before / turned).sqrt();
        }
        *spring -= sliding * (self.dt * self.stiffness);
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
