//! What flows.
use crate::FlowError;

/// A Newtonian fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluid {
    /// Density ρ \[kg/m³\].
    pub density: f64,
    /// Kinematic viscosity ν \[m²/s\].
    pub viscosity: f64,
}

impl Fluid {
    /// An inviscid fluid is allowed; one without mass is not.
    pub(crate) fn check(self) -> Result<(), FlowError> {
        let Self { density, viscosity } = self;
        if !(density.is_finite() && density > 0.0) {
            return Err(FlowError::Fluid { name: "density", value: density, unit: "kg/m³" });
        }
        if !(viscosity.is_finite() && viscosity >= 0.0) {
            return Err(FlowError::Fluid { name: "kinematic viscosity", value: viscosity, unit: "m²/s" });
        }
        Ok(())
    }
}
