//! k–ω.
use super::{Law, Local, Scale, Terms};
use crate::TurbulenceError;
use crate::error::positive;

/// k–ω of Wilcox (1988, *AIAA J.* 26, 1299–1310):
///
/// ```text
/// ν_t = k/ω,   Dk/Dt = P − β* k ω + ∇·((ν + σ_k ν_t)∇k),   Dω/Dt = γ S² − β ω² + ∇·((ν + σ_ω ν_t)∇ω)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wilcox {
    /// β*. Default 0.09.
    pub beta_star: f64,
    /// β. Default 3/40.
    pub beta: f64,
    /// γ. Default 5/9.
    pub gamma: f64,
    /// σ_k. Default 0.5.
    pub sigma_k: f64,
    /// σ_ω. Default 0.5.
    pub sigma_omega: f64,
}

impl Default for Wilcox {
    fn default() -> Self {
        Self { beta_star: 0.09, beta: 0.075, gamma: 5.0 / 9.0, sigma_k: 0.5, sigma_omega: 0.5 }
    }
}

impl Wilcox {
    /// With β = 0.072 and γ = 0.52, as OpenFOAM's kOmega has them.
    pub fn openfoam() -> Self {
        Self { beta: 0.072, gamma: 0.52, ..Self::default() }
    }
}

impl Law for Wilcox {
    const SCALE: Scale = Scale::Omega;

    fn check(&self) -> Result<(), TurbulenceError> {
        positive("β*", self.beta_star)?;
        positive("β", self.beta)?;
        positive("γ", self.gamma)?;
        positive("σ_k", self.sigma_k)?;
        positive("σ_ω", self.sigma_omega)
    }
    #[inline(always)]
    fn scale_terms(&self, c: &Local) -> Terms {
        Terms {
            diffusivity: c.nu + self.sigma_omega * c.eddy,
            source: self.gamma * c.strain * c.strain,
            sink: self.beta * c.scale,
        }
    }
    #[inline(always)]
    fn k_terms(&self, c: &Local, production: f64) -> Terms {
        Terms {
            diffusivity: c.nu + self.sigma_k * c.eddy,
            source: production,
            sink: self.beta_star * c.scale,
        }
    }
    #[inline(always)]
    fn eddy_viscosity(&self, c: &Local) -> f64 {
        c.k / c.scale
    }
}
