//! Turbulence that enters.
use crate::TurbulenceError;
use crate::error::positive;

/// C_μ of the length scale.
const C_MU: f64 = 0.09;

/// Turbulence of a stream: on inlets, or everywhere at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inflow {
    /// Kinetic energy k \[m²/s²\].
    pub k: f64,
    /// Specific dissipation rate ω = ε/(C_μ k) \[1/s\], C_μ = 0.09.
    pub omega: f64,
}

impl Inflow {
    /// Of a stream of speed `speed` \[m/s\] with the turbulence intensity I = √(2k/3)/U and the length scale `length` L \[m\]:
    /// k = 3/2 (U I)², ω = √k/(C_μ^¼ L), so that ε = C_μ^¾ k^(3/2)/L. In ducts L is about 0.07 hydraulic diameters.
    ///
    /// # Errors
    /// [`TurbulenceError::Value`] for what is not positive and finite.
    pub fn from_length(speed: f64, intensity: f64, length: f64) -> Result<Self, TurbulenceError> {
        positive("the length scale", length)?;
        let k = kinetic_energy(speed, intensity)?;
        Ok(Self { k, omega: k.sqrt() / (C_MU.powf(0.25) * length) })
    }

    /// The same with the ratio ν_t/ν = `ratio` of a fluid of kinematic viscosity `nu` \[m²/s\]: ω = k/(ratio ν). In outer flows the
    /// ratio is about 0.01 to 10.
    ///
    /// # Errors
    /// [`TurbulenceError::Value`] for what is not positive and finite.
    pub fn from_viscosity_ratio(
        speed: f64,
        intensity: f64,
        ratio: f64,
        nu: f64,
    ) -> Result<Self, TurbulenceError> {
        positive("the viscosity ratio", ratio)?;
        positive("the kinematic viscosity", nu)?;
        let k = kinetic_energy(speed, intensity)?;
        Ok(Self { k, omega: k / (ratio * nu) })
    }

    /// Dissipation rate ε = C_μ k ω \[m²/s³\].
    pub fn epsilon(&self) -> f64 {
        C_MU * self.k * self.omega
    }

    pub(crate) fn check(&self) -> Result<(), TurbulenceError> {
        positive("k of the inflow", self.k)?;
        positive("ω of the inflow", self.omega)
    }
}

fn kinetic_energy(speed: f64, intensity: f64) -> Result<f64, TurbulenceError> {
    positive("the speed", speed)?;
    positive("the turbulence intensity", intensity)?;
    Ok(1.5 * (speed * intensity).powi(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inflow_of_the_reference_runs() {
        // k, ω and ε of the body-fitted bends: I 5 %, L 0.07, U 1.
        let a = Inflow::from_length(1.0, 0.05, 0.07).unwrap();
        assert!((a.k - 0.00375).abs() < 1e-15 && (a.omega - 1.59719).abs() < 1e-5);
        assert!((a.epsilon() - 5.3907e-4).abs() < 3e-8);
        let b = Inflow::from_viscosity_ratio(2.0, 0.01, 5.0, 1e-5).unwrap();
        assert!((b.k / b.omega / 1e-5 - 5.0).abs() < 1e-12);
        assert!(Inflow::from_length(1.0, 0.0, 0.07).is_err());
        assert!(Inflow::from_length(1.0, 0.05, f64::NAN).is_err());
        assert!(Inflow::from_viscosity_ratio(1.0, 0.05, 1.0, -1.0).is_err());
    }
}
