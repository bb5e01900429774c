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
    /// Damping coefficient γ of the contact model (no unit).
    pub damping: f64,
    /// Coefficient of friction μ.
    pub friction: f64,
}

impl Default for Material {
    /// A soft solid: 1000 kg/m³, 1 MPa, ν = 0.3, γ = 0.5, μ = 0.3.
    fn default() -> Self {
        Self { density: 1000.0, youngs_modulus: 1e6, poisson_ratio: 0.3, damping: 0.5, friction: 0.3 }
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
            ("friction", self.friction, self.friction >= 0.0, not_negative),
        ];
        match tests.into_iter().find(|(_, value, good, _)| !(value.is_finite() && *good)) {
            Some((property, value, _, remedy)) => Err(DemError::Material { property, value, remedy }),
            None => Ok(()),
        }
    }
}
