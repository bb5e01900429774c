//! What the layer beside a smooth wall is like, at any distance.
use crate::TurbulenceError;
use crate::error::positive;

/// Wall functions of Kalitzin et al. (2005), in the form that rests on k: with y* = C_μ^¼ √k y/ν, which is y+ in a layer in
/// equilibrium.
///
/// | | viscous sublayer | logarithmic layer | between |
/// |---|---|---|---|
/// | ν_t/ν on the wall | 0 | κy*/ln(E y*) − 1 | from y+_lam on the latter |
/// | ω | 6ν/(β₁y²) | √k/(C_μ^¼ κ y) | √(Σ²) |
/// | ε | 2νk/y² | C_μ^¾ k^(3/2)/(κy) | √(Σ²) |
/// | production | ν_t S² | (ν + ν_t) \|u_t\|/y C_μ^¼ √k/(κy) | the two weighted by [`turbulent_share`](Self::turbulent_share) |
/// | k | 0 on the wall | ∂k/∂n = 0 | the flux νk/y weighted likewise |
///
/// (ν + ν_t) u_t/y is the wall's friction. y+_lam is where y+ = ln(E y+)/κ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallFunctions {
    /// von Kármán's constant κ. Default 0.41.
    pub kappa: f64,
    /// E of the logarithmic law u+ = ln(E y+)/κ. Default 9.8.
    pub e: f64,
    /// C_μ. Default 0.09.
    pub c_mu: f64,
    /// β₁ of ω in the viscous sublayer. Default 0.075.
    pub beta_1: f64,
    /// |S| of the cells beside walls. Default [`WallShear::Mean`].
    pub shear: WallShear,
}

/// What a model is told of |S| in a cell beside a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WallShear {
    /// The mean over the cell, from the velocity on its far face to the wall's: what a finite-volume gradient is, and what OpenFOAM
    /// takes. It is larger than the shear at the centre, so models whose ν_t depends on |S| (SST, realizable k–ε) have a ν_t that
    /// is too low in this cell.
    #[default]
    Mean,
    /// C_μ^¼ √k/(κy) of the logarithmic layer.
    Logarithmic,
}

impl Default for WallFunctions {
    fn default() -> Self {
        Self { kappa: 0.41, e: 9.8, c_mu: 0.09, beta_1: 0.075, shear: WallShear::Mean }
    }
}

impl WallFunctions {
    pub(crate) fn check(&self) -> Result<(), TurbulenceError> {
        positive("κ", self.kappa)?;
        positive("C_μ", self.c_mu)?;
        positive("β₁", self.beta_1)?;
        // Else the linear and the logarithmic law do not meet.
        if self.e.is_finite() && self.e > (std::f64::consts::E * self.kappa).max(1.0) {
            return Ok(());
        }
        let range =
            "finite and above the larger of 1 and e κ, so that the linear and the logarithmic law meet";
        Err(TurbulenceError::Value { name: "E", value: self.e, range })
    }

    /// y+_lam, where y+ = ln(E y+)/κ.
    pub fn y_plus_laminar(&self) -> f64 {
        let mut y = 11.0;
        for _ in 0..60 {
            y = (self.e * y).max(1.0).ln() / self.kappa;
        }
        y
    }

    /// y* of a point at distance `y` \[m\] with `k` \[m²/s²\] in a fluid of kinematic viscosity `nu` \[m²/s\].
    pub fn y_star(&self, y: f64, k: f64, nu: f64) -> f64 {
        self.c_mu.sqrt().sqrt() * k.max(0.0).sqrt() * y / nu
    }

    /// u+: y+ or ln(E y+)/κ.
    pub fn u_plus(&self, y_plus: f64) -> f64 {
        if y_plus <= self.y_plus_laminar() { y_plus } else { (self.e * y_plus).ln() / self.kappa }
    }

    /// ν_t/ν on the wall.
    pub fn viscosity_ratio(&self, y_plus: f64) -> f64 {
        self.ratio_above(y_plus, self.y_plus_laminar())
    }

    pub(crate) fn ratio_above(&self, y_plus: f64, laminar: f64) -> f64 {
        if y_plus <= laminar { 0.0 } else { self.kappa * y_plus / (self.e * y_plus).ln() - 1.0 }
    }

    /// k+ of a boundary layer (Kalitzin et al. 2005): −0.416/κ ln y+ + 8.366, or
    /// (2400/1.9²)(1/(y+ + 11)² + 2y+/11³ − 1/11²) in the viscous sublayer.
    pub fn k_plus(&self, y_plus: f64) -> f64 {
        if y_plus > self.y_plus_laminar() {
            -0.416 / self.kappa * y_plus.ln() + 8.366
        } else {
            let c = 11.0_f64;
            2400.0 / (1.9 * 1.9) * ((y_plus + c).powi(-2) + 2.0 * y_plus / c.powi(3) - 1.0 / (c * c))
        }
    }

    /// ω+ = ων/u_τ² = √((6/(β₁y+²))² + (1/(√C_μ κ y+))²).
    pub fn omega_plus(&self, y_plus: f64) -> f64 {
        let viscous = 6.0 / (self.beta_1 * y_plus * y_plus);
        viscous.hypot(1.0 / (self.c_mu.sqrt() * self.kappa * y_plus))
    }

    /// ω \[1/s\].
    pub fn omega(&self, y: f64, k: f64, nu: f64) -> f64 {
        let viscous = 6.0 * nu / (self.beta_1 * y * y);
        viscous.hypot(k.max(0.0).sqrt() / (self.c_mu.sqrt().sqrt() * self.kappa * y))
    }

    /// ε \[m²/s³\].
    pub fn epsilon(&self, y: f64, k: f64, nu: f64) -> f64 {
        let k = k.max(0.0);
        let viscous = 2.0 * nu * k / (y * y);
        viscous.hypot(self.c_mu.sqrt().sqrt().powi(3) * k * k.sqrt() / (self.kappa * y))
    }

    /// ∂u/∂y \[1/s\] in the logarithmic layer: C_μ^¼ √k/(κy).
    pub fn log_shear(&self, y: f64, k: f64) -> f64 {
        self.c_mu.sqrt().sqrt() * k.max(0.0).sqrt() / (self.kappa * y)
    }

    /// Production of k \[m²/s³\] in the logarithmic layer, `friction` = τ_w/ρ \[m²/s²\].
    pub fn production(&self, y: f64, k: f64, friction: f64) -> f64 {
        friction * self.log_shear(y, k)
    }

    /// 1 − e^−(y*/y+_lam)⁴: 0 in the viscous sublayer, 1 in the logarithmic layer.
    pub fn turbulent_share(&self, y_star: f64) -> f64 {
        share(y_star, self.y_plus_laminar())
    }
}

pub(crate) fn share(y_star: f64, laminar: f64) -> f64 {
    -(-(y_star / laminar).powi(4)).exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_values_of_the_reference_page() {
        let w = WallFunctions::default();
        assert!((w.y_plus_laminar() - 11.5301).abs() < 1e-4);
        let near = |a: f64, b: f64, digits: f64| assert!((a - b).abs() <= 0.51 * digits, "{a} {b}");
        near(w.omega_plus(5.0), 3.589, 1e-3);
        assert_eq!(w.viscosity_ratio(5.0), 0.0);
        for (y, k, omega, ratio, last) in [
            (30.0, 4.915, 0.2852, 1.164, 1e-3),
            (100.0, 3.693, 0.0817, 4.953, 1e-3),
            (300.0, 2.579, 0.0271, 14.40, 1e-2),
        ] {
            near(w.k_plus(y), k, 1e-3);
            near(w.omega_plus(y), omega, 1e-4);
            near(w.viscosity_ratio(y), ratio, last);
        }
    }

    #[test]
    fn the_laws_meet_between_the_layers() {
        let w = WallFunctions::default();
        let y = w.y_plus_laminar();
        assert!((w.u_plus(y * (1.0 - 1e-9)) - w.u_plus(y * (1.0 + 1e-9))).abs() < 1e-6);
        assert!(w.viscosity_ratio(y * (1.0 + 1e-9)) < 1e-6);
        assert!(w.turbulent_share(1.0) < 1e-4 && w.turbulent_share(27.0) > 1.0 - 1e-10);
        for e in [0.5, 1.0, f64::NAN] {
            assert!(WallFunctions { e, ..w }.check().is_err());
        }
        assert!(WallFunctions { kappa: -1.0, ..w }.check().is_err());
    }

    proptest! {
        /// In a layer in equilibrium, k = u_τ²/√C_μ, what is dimensional is what y+ says.
        #[test]
        fn wall_units_are_consistent(u_tau in 1e-3..10.0f64, y_plus in 0.1..1e3f64, nu in 1e-7..1e-2f64) {
            let w = WallFunctions::default();
            let (y, k) = (y_plus * nu / u_tau, u_tau * u_tau / w.c_mu.sqrt());
            prop_assert!((w.y_star(y, k, nu) / y_plus - 1.0).abs() < 1e-12);
            let unit = u_tau * u_tau / nu;
            prop_assert!((w.omega(y, k, nu) / unit / w.omega_plus(y_plus) - 1.0).abs() < 1e-12);
            // Production is dissipation far out.
            let (p, e) = (w.production(y, k, u_tau * u_tau), w.epsilon(y, k, nu));
            prop_assert!(e >= p * (1.0 - 1e-12) && (y_plus < 100.0 || e < 1.05 * p), "{p} {e}");
        }
    }
}
