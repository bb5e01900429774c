//! k–ω SST.
use super::{Invariants, Law, Local, Scale, Terms};
use crate::TurbulenceError;
use crate::error::positive;

/// k–ω SST of Menter, Kuntz & Langtry (2003, *Turbulence, Heat and Mass Transfer* 4, 625–632):
///
/// ```text
/// ν_t = a₁k/max(a₁ω, |S|F₂),   P̃ = min(P, 10 β* k ω)
/// Dk/Dt = P̃ − β* k ω + ∇·((ν + σ_k ν_t)∇k)
/// Dω/Dt = γ P̃/ν_t − β ω² + ∇·((ν + σ_ω ν_t)∇ω) + 2(1 − F₁) σ_ω2 ∇k·∇ω/ω
/// F₁ = tanh(arg₁⁴),   arg₁ = min(max(√k/(β*ωd), 500ν/(d²ω)), 4σ_ω2 k/(CD d²)),   CD = max(2σ_ω2 ∇k·∇ω/ω, 1e-10)
/// F₂ = tanh(arg₂²),   arg₂ = max(2√k/(β*ωd), 500ν/(d²ω))
/// ```
///
/// Its constants are F₁ times those of the layer beside walls plus 1 − F₁ times those outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sst {
    /// β*. Default 0.09.
    pub beta_star: f64,
    /// a₁. Default 0.31.
    pub a_1: f64,
    /// P is at most this many times β* k ω. Default 10.
    pub limit: f64,
    /// σ_k beside walls and outside. Default 0.85, 1.
    pub sigma_k: [f64; 2],
    /// σ_ω. Default 0.5, 0.856.
    pub sigma_omega: [f64; 2],
    /// β. Default 0.075, 0.0828.
    pub beta: [f64; 2],
    /// γ. Default 5/9, 0.44.
    pub gamma: [f64; 2],
}

impl Default for Sst {
    fn default() -> Self {
        Self {
            beta_star: 0.09,
            a_1: 0.31,
            limit: 10.0,
            sigma_k: [0.85, 1.0],
            sigma_omega: [0.5, 0.856],
            beta: [0.075, 0.0828],
            gamma: [5.0 / 9.0, 0.44],
        }
    }
}

/// tanh of what is not negative; most arguments are large.
#[inline(always)]
fn tanh(x: f64) -> f64 {
    if x > 20.0 { 1.0 } else { x.tanh() }
}

#[inline(always)]
fn blend(f: f64, [near, far]: [f64; 2]) -> f64 {
    f * near + (1.0 - f) * far
}

impl Sst {
    /// √k/(β*ωd) and 500ν/(d²ω).
    #[inline(always)]
    fn lengths(&self, c: &Local) -> [f64; 2] {
        let d = c.distance;
        [c.k.sqrt() / (self.beta_star * c.scale * d), 500.0 * c.nu / (d * d * c.scale)]
    }

    /// F₁.
    pub fn f_1(&self, c: &Local) -> f64 {
        let [a, b] = self.lengths(c);
        let cd = (2.0 * self.sigma_omega[1] * c.cross / c.scale).max(1e-10);
        let third = 4.0 * self.sigma_omega[1] * c.k / (cd * c.distance * c.distance);
        tanh(a.max(b).min(third).powi(4))
    }

    /// F₂.
    pub fn f_2(&self, c: &Local) -> f64 {
        let [a, b] = self.lengths(c);
        tanh((2.0 * a).max(b).powi(2))
    }
}

impl Law for Sst {
    const SCALE: Scale = Scale::Omega;
    const CROSS_DIFFUSION: bool = true;
    const AUXILIARY: bool = true;

    fn check(&self) -> Result<(), TurbulenceError> {
        positive("β*", self.beta_star)?;
        positive("a₁", self.a_1)?;
        positive("the limit of the production", self.limit)?;
        for (name, pair) in
            [("σ_k", self.sigma_k), ("σ_ω", self.sigma_omega), ("β", self.beta), ("γ", self.gamma)]
        {
            pair.iter().try_for_each(|&v| positive(name, v))?;
        }
        Ok(())
    }
    /// F₁.
    #[inline(always)]
    fn auxiliary(&self, c: &Local, _: Invariants) -> f64 {
        self.f_1(c)
    }
    #[inline(always)]
    fn scale_terms(&self, c: &Local) -> Terms {
        let f = c.auxiliary;
        // P̃/ν_t; the limit with the ν_t of this state.
        let limit = self.limit * self.beta_star * c.scale * (c.k / c.eddy.max(f64::MIN_POSITIVE));
        let production = (c.strain * c.strain).min(limit);
        let cross = 2.0 * (1.0 - f) * self.sigma_omega[1] * c.cross / c.scale;
        Terms {
            diffusivity: c.nu + blend(f, self.sigma_omega) * c.eddy,
            source: blend(f, self.gamma) * production + cross.max(0.0),
            sink: blend(f, self.beta) * c.scale + (-cross).max(0.0) / c.scale,
        }
    }
    #[inline(always)]
    fn k_terms(&self, c: &Local, production: f64) -> Terms {
        let sink = self.beta_star * c.scale;
        Terms {
            diffusivity: c.nu + blend(c.auxiliary, self.sigma_k) * c.eddy,
            source: production.min(self.limit * sink * c.k),
            sink,
        }
    }
    #[inline(always)]
    fn eddy_viscosity(&self, c: &Local) -> f64 {
        let shear = c.strain;
        // F₂ ≤ 1.
        if shear <= self.a_1 * c.scale {
            return c.k / c.scale;
        }
        self.a_1 * c.k / (self.a_1 * c.scale).max(shear * self.f_2(c))
    }
}
