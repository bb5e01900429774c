//! Realizable k–ε.
use super::{Invariants, Law, Local, Scale, Terms};
use crate::TurbulenceError;
use crate::error::positive;

/// Realizable k–ε of Shih et al. (1995, *Comput. Fluids* 24, 227–238):
///
/// ```text
/// ν_t = C_μ k²/ε,   C_μ = 1/(A₀ + A_s U* k/ε),   U* = √(S:S + Ω:Ω),   A_s = √6 cos(⅓ arccos √6 W),   W = S_ij S_jk S_ki/(S:S)^(3/2)
/// Dk/Dt = P − ε + ∇·((ν + ν_t/σ_k)∇k)
/// Dε/Dt = C₁ |S| ε − C₂ ε²/(k + √(νε)) + ∇·((ν + ν_t/σ_ε)∇ε),   C₁ = max(0.43, η/(η + 5)),   η = |S| k/ε
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Realizable {
    /// A₀. Default 4.0, as in OpenFOAM; the paper has 4.04.
    pub a_0: f64,
    /// C₂. Default 1.9.
    pub c_2: f64,
    /// σ_k. Default 1.
    pub sigma_k: f64,
    /// σ_ε. Default 1.2.
    pub sigma_epsilon: f64,
}

impl Default for Realizable {
    fn default() -> Self {
        Self { a_0: 4.0, c_2: 1.9, sigma_k: 1.0, sigma_epsilon: 1.2 }
    }
}

impl Law for Realizable {
    const SCALE: Scale = Scale::Epsilon;
    const GRADIENT: bool = true;
    const AUXILIARY: bool = true;

    fn check(&self) -> Result<(), TurbulenceError> {
        positive("A₀", self.a_0)?;
        positive("C₂", self.c_2)?;
        positive("σ_k", self.sigma_k)?;
        positive("σ_ε", self.sigma_epsilon)
    }
    /// A_s U* \[1/s\].
    fn auxiliary(&self, _: &Local, i: Invariants) -> f64 {
        let phi = (6.0_f64.sqrt() * i.third).clamp(-1.0, 1.0).acos() / 3.0;
        let speed = (0.5 * (i.strain * i.strain + i.rotation * i.rotation)).sqrt();
        6.0_f64.sqrt() * phi.cos() * speed
    }
    #[inline(always)]
    fn scale_terms(&self, c: &Local) -> Terms {
        let eta = c.strain * c.k / c.scale;
        let c_1 = (eta / (eta + 5.0)).max(0.43);
        Terms {
            diffusivity: c.nu + c.eddy / self.sigma_epsilon,
            source: c_1 * c.strain * c.scale,
            sink: self.c_2 * c.scale / (c.k + (c.nu * c.scale).sqrt()),
        }
    }
    #[inline(always)]
    fn k_terms(&self, c: &Local, production: f64) -> Terms {
        Terms { diffusivity: c.nu + c.eddy / self.sigma_k, source: production, sink: c.scale / c.k }
    }
    #[inline(always)]
    fn eddy_viscosity(&self, c: &Local) -> f64 {
        // C_μ k²/ε.
        c.k * c.k / (self.a_0 * c.scale + c.auxiliary * c.k)
    }
}
