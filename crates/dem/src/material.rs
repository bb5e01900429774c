//! Materials.
use crate::DemError;

/// What a body is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Density \[kg/m³\].
    pub density: f64,
    /// Young's modulus Y \[Pa\].
    pub youngs_modulus: f64,
    /// Poisson's ratio ν.
    pub poisson_ratio: f64,
    /// Damping coefficient γ of [`Chen`](crate::Chen)'s contact law (no unit).
    pub damping: f64,
    /// Coefficient of restitution e of [`Potential`](crate::Potential)'s contact law: speed after over speed before a central impact.
    pub restitution: f64,
    /// Coefficient of friction μ.
    pub friction: f64,
    /// Coefficient of rolling friction μ_r: the arm, in radii, at which the normal force resists [`Rolling`](crate::Rolling).
    pub rolling_friction: f64,
}

impl Default for Material {
    /// A soft solid: 1000 kg/m³, 1 MPa, ν = 0.3, γ = 0.5, e = 0.9, μ = 0.3, no rolling friction.
    fn default() -> Self {
        Self {
            density: 1000.0,
            youngs_modulus: 1e6,
            poisson_ratio: 0.3,
            damping: 0.5,
            restitution: 0.9,
            friction: 0.3,
            rolling_friction: 0.0,
        }
    }
}

impl Material {
    /// Is it physical?
    ///
    /// # Errors
    /// [`DemError::Material`] that names the property.
    pub fn check(&self) -> Result<(), DemError> {
        let positive = "give a positive, finite number";
        let not_negative = "give zero or a positive, finite number";
        let tests = [
            ("density", self.density, self.density > 0.0, positive),
            ("Young's modulus", self.youngs_modulus, self.youngs_modulus > 0.0, positive),
            (
                "Poisson's ratio",
                self.poisson_ratio,
                (-1.0..=0.5).contains(&self.poisson_ratio),
                "give a number from -1 to 0.5",
            ),
            ("damping", self.damping, self.damping >= 0.0, not_negative),
            (
                "restitution",
                self.restitution,
                (0.0..=1.0).contains(&self.restitution),
                "give a number from 0 to 1",
            ),
            ("friction", self.friction, self.friction >= 0.0, not_negative),
            ("rolling friction", self.rolling_friction, self.rolling_friction >= 0.0, not_negative),
        ];
        match tests.into_iter().find(|(_, value, good, _)| !(value.is_finite() && *good)) {
            Some((property, value, _, remedy)) => Err(DemError::Material { property, value, remedy }),
            None => Ok(()),
        }
    }
}
