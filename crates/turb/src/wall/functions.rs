//! What the layer beside a smooth wall is like, at any distance.
use crate::error::positive;
use crate::{Scale, TurbulenceError};
use interfaces::LawOfTheWall;

/// Wall functions of Kalitzin et al. (2005), in the form that rests on k: with y* = C_μ^¼ √k y/ν, which is y+ in a layer in
/// equilibrium.
///
/// | | viscous sublayer | logarithmic layer | between |
/// |---|---|---|---|
/// | ν_t/ν on the wall, with the velocity's share in y* | 0 | κy*/ln(E y*) − 1 | y*/u+(y*) − 1 with [`u_plus`](Self::u_plus) of Reichardt (1951) |
/// | ω | ω_v = 6ν/(β₁y²) | ω_l = √k/(C_μ^¼ κ y) | ω_v + ω_l, and √(ω_v² + ω_l²) beyond the buffer layer ([`omega`](Self::omega)) |
/// | ε | 2νk/y² | C_μ^¾ k^(3/2)/(κy) | √(Σ²) |
/// | production | ν_t S² | τ √C_μ ω or τ ε/(√C_μ k), times u_*/u_k of the [velocity's share](Self::velocity_weight) | the two weighted by [`turbulent_share`](Self::turbulent_share) |
/// | k | 0 on the wall | ∂k/∂n = 0 | the flux νk/y weighted likewise |
///
/// τ = (ν + ν_t) u_t/y is the wall's friction over ρ. Production is what ω or ε takes where τ = √C_μ k, with the viscous part that these
/// have at y+ of 30: with the slope of the logarithmic law alone k were 6 % too low there. y+_lam is where y+ = ln(E y+)/κ.
///
/// ω between the two laws is that of the models themselves: of wall-resolved k–ω (1988) and SST it is 0.99 to 1.11 of ω_v + ω_l from y+ 1 to 200, of √(ω_v² + ω_l²)
/// (Menter 1994, Kalitzin et al. 2005) up to 1.57, at y+ 12. Beyond the buffer layer that form stays, whose ω at y+ 30 to 100 goes with the law of the wall.
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
    /// w of the velocity in the friction velocity of ν_t on the wall, beside k's ([`shared_friction_velocity`](LawOfTheWall::shared_friction_velocity)), 0 to 1. Default 0.4, as
    /// immersed walls have; with 0 it is k's alone (Launder & Spalding 1974).
    pub velocity_weight: f64,
    /// |S| of the cells beside walls. Default [`WallShear::Logarithmic`].
    pub shear: WallShear,
    /// ω of the cells that resolve a viscous sublayer. Default [`Sublayer::InverseSquare`].
    pub sublayer: Sublayer,
}

/// How ω is balanced in the cells of a viscous sublayer, where it goes like 6ν/(β₁y²).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sublayer {
    /// With 1/√ω linear from cell to cell and the mean of ω² over the cell ([`Equation::steep`](interfaces::Equation::steep)): friction of second order in the first
    /// cell's y+, 0.6 % off at y+ 1.
    #[default]
    InverseSquare,
    /// With ω linear, as elsewhere and in other codes: ω is too large beyond the first cell, friction of first order, 9 % too low
    /// at y+ 1 and 4 % at 0.3.
    Linear,
}

/// The buffer layer ends at this many y+_lam.
const BUFFER: f64 = 1.25;

/// What a model is told of |S| in a cell beside a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WallShear {
    /// The mean over the cell, from the velocity on its far face to the wall's: what a finite-volume gradient is, and what OpenFOAM
    /// takes. It is larger than the shear at the centre, so models whose ν_t depends on |S| (SST, realizable k–ε) have a ν_t that
    /// is too low in this cell, and too little friction.
    Mean,
    /// C_μ^¼ √k/(κy) of the logarithmic layer, as far as the cell is in one.
    #[default]
    Logarithmic,
}

impl Default for WallFunctions {
    fn default() -> Self {
        let LawOfTheWall { kappa, e } = LawOfTheWall::USUAL;
        Self {
            kappa,
            e,
            c_mu: 0.09,
            beta_1: 0.075,
            velocity_weight: LawOfTheWall::VELOCITY_WEIGHT,
            shear: WallShear::Logarithmic,
            sublayer: Sublayer::InverseSquare,
        }
    }
}

impl WallFunctions {
    /// Friction by k alone, and |S| the mean over the cell, as OpenFOAM has them.
    pub fn of_k_alone() -> Self {
        Self { velocity_weight: 0.0, shear: WallShear::Mean, ..Self::default() }
    }

    pub(crate) fn check(&self) -> Result<(), TurbulenceError> {
        positive("κ", self.kappa)?;
        positive("C_μ", self.c_mu)?;
        positive("β₁", self.beta_1)?;
        if !(0.0..=1.0).contains(&self.velocity_weight) {
            let name = "the weight of the velocity in the friction velocity";
            return Err(TurbulenceError::Value { name, value: self.velocity_weight, range: "0 to 1" });
        }
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
        // Newton's method, from where κy − ln(E y) grows.
        let mut y = f64::max(11.0, 2.0 / self.kappa);
        for _ in 0..60 {
            let step = (self.kappa * y - (self.e * y).ln()) / (self.kappa - 1.0 / y);
            y -= step;
            if step.abs() <= 1e-15 * y {
                break;
            }
        }
        y
    }

    /// y* of a point at distance `y` \[m\] with `k` \[m²/s²\] in a fluid of kinematic viscosity `nu` \[m²/s\].
    pub fn y_star(&self, y: f64, k: f64, nu: f64) -> f64 {
        self.c_mu.sqrt().sqrt() * k.max(0.0).sqrt() * y / nu
    }

    /// The same with the friction velocity that k and the velocity tell together, \[y, u\] at `place`.
    pub fn shared_y_star(&self, place: [f64; 2], k: f64, nu: f64) -> f64 {
        let of_k = self.y_star(1.0, k, nu) * nu;
        self.law().shared_friction_velocity(of_k, place, nu, self.velocity_weight) * place[0] / nu
    }

    /// k of the layer \[m²/s²\]: û²/√C_μ where the velocity at `place` belongs to a logarithmic layer that k has not followed
    /// ([`LawOfTheWall::layer_velocity`]), otherwise `k`. A turbulent first cell without k so has the ω or ε, and produces k by the shear, of its layer.
    pub fn layer_k(&self, place: [f64; 2], k: f64, nu: f64) -> f64 {
        let of_k = self.y_star(1.0, k, nu) * nu;
        let layer = self.law().layer_velocity(of_k, place, nu, self.velocity_weight);
        if layer > of_k { layer * layer / self.c_mu.sqrt() } else { k }
    }

    fn law(&self) -> LawOfTheWall {
        LawOfTheWall { kappa: self.kappa, e: self.e }
    }

    /// u+ at any y+ by the [law of the wall](LawOfTheWall).
    pub fn u_plus(&self, y_plus: f64) -> f64 {
        self.law().u_plus(y_plus)
    }

    /// ν_t/ν on the wall: y+/u+ − 1.
    pub fn viscosity_ratio(&self, y_plus: f64) -> f64 {
        if y_plus > 0.0 { y_plus / self.u_plus(y_plus) - 1.0 } else { 0.0 }
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

    /// ω+ = ων/u_τ² = √((6/(β₁y+²))² + (1/(√C_μ κ y+))²) of Kalitzin et al. (2005), which [`omega`](Self::omega) is beyond y+ of 25.
    pub fn omega_plus(&self, y_plus: f64) -> f64 {
        let viscous = 6.0 / (self.beta_1 * y_plus * y_plus);
        viscous.hypot(1.0 / (self.c_mu.sqrt() * self.kappa * y_plus))
    }

    /// ω \[1/s\] = ω_v + ω_l − t (ω_v + ω_l − √(ω_v² + ω_l²)), t = 1 − e^−(y*/(1.25 y+_lam))⁴.
    pub fn omega(&self, y: f64, k: f64, nu: f64) -> f64 {
        let viscous = 6.0 * nu / (self.beta_1 * y * y);
        let log = k.max(0.0).sqrt() / (self.c_mu.sqrt().sqrt() * self.kappa * y);
        let sum = viscous + log;
        sum - self.turbulent_share(self.y_star(y, k, nu) / BUFFER) * (sum - viscous.hypot(log))
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

    /// Production of k \[m²/s³\] in turbulence that consumes what it produces where `friction` = τ_w/ρ \[m²/s²\] is √C_μ k, `value` the ω
    /// or ε of the wall functions.
    pub fn production(&self, scale: Scale, value: f64, k: f64, friction: f64) -> f64 {
        friction
            * match scale {
                Scale::Omega => self.c_mu.sqrt() * value,
                Scale::Epsilon => value / (self.c_mu.sqrt() * k.max(f64::MIN_POSITIVE)),
            }
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
        for (y, k, omega, ratio, part) in [
            (30.0, 4.915, 0.2852, 1.164, 0.05),
            (100.0, 3.693, 0.0817, 4.953, 5e-3),
            (300.0, 2.579, 0.0271, 14.40, 2e-3),
        ] {
            near(w.k_plus(y), k, 1e-3);
            near(w.omega_plus(y), omega, 1e-4);
            // Of the logarithmic law.
            assert!((w.viscosity_ratio(y) / ratio - 1.0).abs() < part, "{y}");
        }
    }

    /// The DNS of Lee & Moser (2015, *J. Fluid Mech.* 774, 395–415) at Re_τ 1000, through all layers.
    #[test]
    fn the_law_of_the_wall_is_that_of_the_dns() {
        let w = WallFunctions::default();
        for (y, u) in [
            (1.64508, 1.64168),
            (4.42998, 4.3187),
            (8.60248, 7.59261),
            (12.1522, 9.52401),
            (18.6235, 11.6584),
            (29.3778, 13.3881),
            (58.0683, 15.1912),
            (101.479, 16.4894),
        ] {
            assert!((w.u_plus(y) / u - 1.0).abs() < 0.03, "{y} {u} {}", w.u_plus(y));
        }
        assert_eq!([w.viscosity_ratio(0.0), w.viscosity_ratio(1.0)], [0.0; 2]);
        assert!(w.viscosity_ratio(5.0) < 0.03);
    }

    #[test]
    fn the_laws_meet_between_the_layers() {
        let w = WallFunctions::default();
        let mut ratio = w.viscosity_ratio(2.0);
        assert!(ratio < 1e-3);
        for y in (21..3000).map(|i| 0.1 * f64::from(i)) {
            let next = w.viscosity_ratio(y);
            assert!((ratio..ratio + 0.01).contains(&next), "{y} {ratio} {next}");
            ratio = next;
        }
        assert!(w.turbulent_share(1.0) < 1e-4 && w.turbulent_share(27.0) > 1.0 - 1e-10);
        for (kappa, e) in [(0.41, 9.8), (0.41, 1.2), (0.4, 0.5), (0.05, 1.0), (0.41, 1e4)] {
            let f = WallFunctions { kappa, e, ..w };
            let (y, least) = (f.y_plus_laminar(), 1.0 / kappa);
            assert!(
                y >= least && ((e * y).ln() / kappa / y - 1.0).abs() < 1e-12
                    || e < std::f64::consts::E * kappa
            );
        }
        for velocity_weight in [-0.1, 1.1, f64::NAN] {
            assert!(WallFunctions { velocity_weight, ..w }.check().is_err());
        }
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
            let ratio = w.omega(y, k, nu) / unit / w.omega_plus(y_plus);
            prop_assert!((1.0 - 1e-12..=f64::sqrt(2.0)).contains(&ratio), "{ratio}");
            prop_assert!((ratio - 1.0).abs() < 1e-3 || y_plus < 25.0, "{ratio}");
            // Production is dissipation, and far out that of the logarithmic law.
            let (omega, e) = (w.omega(y, k, nu), w.epsilon(y, k, nu));
            let p = [(Scale::Omega, omega), (Scale::Epsilon, e)].map(|(s, v)| w.production(s, v, k, u_tau * u_tau));
            prop_assert!((p[0] / (w.c_mu * k * omega) - 1.0).abs() < 1e-12 && (p[1] / e - 1.0).abs() < 1e-12);
            prop_assert!((w.log_shear(y, k) * u_tau * u_tau / p[1] - 1.0).abs() < 0.05 || y_plus < 30.0);
        }
    }
}
