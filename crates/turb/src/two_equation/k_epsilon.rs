//! k–ε.
use super::{Law, Local, Scale, Terms};
use crate::TurbulenceError;
use crate::error::positive;

/// k–ε of Launder & Spalding (1974, *Comput. Methods Appl. Mech. Eng.* 3, 269–289):
///
/// ```text
/// ν_t = C_μ k²/ε,   Dk/Dt = P − ε + ∇·((ν + ν_t/σ_k)∇k),   Dε/Dt = (C₁P − C₂ε) ε/k + ∇·((ν + ν_t/σ_ε)∇ε)
/// ```
///
/// It holds for y+ above 30 or so; without damping functions cells nearer to a wall are a guess.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandardKEpsilon {
    /// C_μ. Default 0.09.
    pub c_mu: f64,
    /// C₁. Default 1.44.
    pub c_1: f64,
    /// C₂. Default 1.92.
    pub c_2: f64,
    /// σ_k. Default 1.
    pub sigma_k: f64,
    /// σ_ε. Default 1.3.
    pub sigma_epsilon: f64,
}

impl Default for StandardKEpsilon {
    fn default() -> Self {
        Self { c_mu: 0.09, c_1: 1.44, c_2: 1.92, sigma_k: 1.0, sigma_epsilon: 1.3 }
    }
}

impl Law for StandardKEpsilon {
    const SCALE: Scale = Scale::Epsilon;

    fn check(&self) -> Result<(), TurbulenceError> {
        positive("C_μ", self.c_mu)?;
        positive("C₁", self.c_1)?;
        positive("C₂", self.c_2)?;
        positive("σ_k", self.sigma_k)?;
        positive("σ_ε", self.sigma_epsilon)
    }
    #[inline(always)]
    fn scale_terms(&self, c: &Local) -> Terms {
        Terms {
            diffusivity: c.nu + c.eddy / self.sigma_epsilon,
            source: self.c_1 * self.c_mu * c.k * c.strain * c.strain,
            sink: self.c_2 * c.scale / c.k,
        }
    }
    #[inline(always)]
    fn k_terms(&self, c: &Local, production: f64) -> Terms {
        Terms { diffusivity: c.nu + c.eddy / self.sigma_k, source: production, sink: c.scale / c.k }
    }
    #[inline(always)]
    fn eddy_viscosity(&self, c: &Local) -> f64 {
        self.c_mu * c.k * (c.k / c.scale)
    }
}
