//! The mean velocity beside a smooth wall.

/// u+ = u/u_τ over y+ = u_τ y/ν in a turbulent layer in equilibrium, from the wall to its logarithmic part (Reichardt 1951, *Z. Angew.
/// Math. Mech.* 31, 208–219), and at most y+:
///
/// ```text
/// u+ = ln(1 + κy+)/κ + ln(E/κ)/κ (1 − e^(−y+/11) − y+/11 e^(−y+/3))
/// ```
///
/// Far out this is ln(E y+)/κ, which is 2 % more at y+ 30 and 29 % at 11.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawOfTheWall {
    /// von Kármán's constant κ.
    pub kappa: f64,
    /// E of the logarithmic law ln(E y+)/κ.
    pub e: f64,
}

impl Default for LawOfTheWall {
    fn default() -> Self {
        Self::USUAL
    }
}

impl LawOfTheWall {
    /// κ = 0.41, E = 9.8.
    pub const USUAL: Self = Self { kappa: 0.41, e: 9.8 };
    /// y+ above which a layer is logarithmic.
    pub const LOGARITHMIC: f64 = 30.0;
    /// The usual weight of the velocity in the [friction velocity](Self::shared_friction_velocity): between what bends and what ducts past a force would have
    /// (0.3 and 1; docs/results.md, "Friction where the flow speeds up or slows down").
    pub const VELOCITY_WEIGHT: f64 = 0.4;

    /// u_τ \[m/s\] of a layer in equilibrium with k \[m²/s²\]: C_μ^¼ √k with C_μ = 0.09, 0 where k is not positive (Launder & Spalding 1974,
    /// *Comput. Methods Appl. Mech. Eng.* 3, 269–289).
    pub fn friction_velocity(k: f64) -> f64 {
        // 0.09^¼.
        0.547_722_557_505_166_1 * k.max(0.0).sqrt()
    }

    /// Is the layer logarithmic at y+? 1 − e^−(y+/30)⁴, from 0 in the viscous sublayer to 1.
    pub fn logarithmic(y_plus: f64) -> f64 {
        -(-(y_plus / Self::LOGARITHMIC).powi(4)).exp_m1()
    }

    /// Velocity scale of the layer \[m/s\] by k and the tangential velocity `u` \[m/s\] at distance `y` \[m\]:
    ///
    /// ```text
    /// û = u_k + L max(1 − (u_k/u_u)², 0) (u_u − u_k),   L = 1 − e^(−(u_u y/30ν)⁴),   u/u_u = u+(u_u y/ν)
    /// ```
    ///
    /// u_k = `of_k` the [friction velocity](Self::friction_velocity) of k, u_u that of the velocity (Spalding 1961, *J. Appl. Mech.* 28, 455–458). It is u_k
    /// in the viscous sublayer and in equilibrium, and goes over to u_u by the share of k, 1 − (u_k/u_u)², that a logarithmic layer lacks: by k alone the
    /// wall of a first cell that the stream has passed before it produced any k has the friction of a laminar layer, or a part of the turbulent one.
    /// A `weight` of 0 leaves the velocity out: û is u_k.
    pub fn layer_velocity(&self, of_k: f64, place: [f64; 2], nu: f64, weight: f64) -> f64 {
        if weight > 0.0 { self.of_layer(of_k, place, nu)[0] } else { of_k }
    }

    /// û, and u_u where the layer may be logarithmic, otherwise û again.
    fn of_layer(&self, of_k: f64, [y, u]: [f64; 2], nu: f64) -> [f64; 2] {
        // y+ is at most √(u y/ν), as u+ is at most y+; next to none is none, which costs nothing.
        if Self::logarithmic(of_k * y / nu).max(Self::logarithmic((u * y / nu).sqrt())) < 1e-3 {
            return [of_k; 2];
        }
        let of_u = self.y_plus(u * y / nu) * nu / y;
        if of_k >= of_u {
            return [of_k, of_u];
        }
        let missing = Self::logarithmic(of_u * y / nu) * (1.0 - (of_k / of_u).powi(2));
        [of_k + missing * (of_u - of_k), of_u]
    }

    /// u_* \[m/s\] that k and the tangential velocity `u` \[m/s\] at distance `y` \[m\] give together:
    ///
    /// ```text
    /// u_* = û^(1 − s) u_u^s,   s = w (1 − e^−(û y/30ν)⁴)
    /// ```
    ///
    /// û the [velocity scale](Self::layer_velocity) of the layer, w = `weight` in 0 … 1. In
    /// equilibrium u_k, u_u and û are the same; where the flow along the wall speeds up or slows down the stress changes within half a cell, k comes late, and u_k
    /// misses the friction by three times as much as u_u. In the viscous sublayer u_k is taken, which resolved layers have.
    pub fn shared_friction_velocity(&self, of_k: f64, place: [f64; 2], nu: f64, weight: f64) -> f64 {
        if weight == 0.0 {
            return of_k;
        }
        let [layer, of_u] = self.of_layer(of_k, place, nu);
        let share = weight * Self::logarithmic(layer * place[0] / nu);
        if share < 1e-3 {
            return layer;
        }
        layer.powf(1.0 - share) * of_u.powf(share)
    }

    /// u+ at y+.
    pub fn u_plus(&self, y_plus: f64) -> f64 {
        self.with_slope(y_plus).0
    }

    /// du+/dy+ at y+.
    pub fn slope(&self, y_plus: f64) -> f64 {
        self.with_slope(y_plus).1
    }

    /// u+ and du+/dy+ at y+.
    #[inline]
    fn with_slope(&self, y_plus: f64) -> (f64, f64) {
        let (near, far) = ((-y_plus / 3.0).exp(), (-y_plus / 11.0).exp());
        let layer = (self.e / self.kappa).ln() / self.kappa;
        let curve = (self.kappa * y_plus).ln_1p() / self.kappa + layer * (1.0 - far - y_plus / 11.0 * near);
        if curve >= y_plus {
            return (y_plus, 1.0);
        }
        let rise = (far - (1.0 - y_plus / 3.0) * near) / 11.0;
        (curve, 1.0 / (1.0 + self.kappa * y_plus) + layer * rise)
    }

    /// y+ where u+ y+ is `reynolds` = u y/ν: what the velocity u at the distance y tells of the friction, u_τ = y+ ν/y.
    pub fn y_plus(&self, reynolds: f64) -> f64 {
        if reynolds.is_nan() || reynolds <= 0.0 {
            return 0.0;
        }
        // Newton's method for the logarithms: in the viscous sublayer the first guess is the solution.
        let mut y = reynolds.sqrt();
        for _ in 0..20 {
            let (u, slope) = self.with_slope(y);
            let step = (reynolds / (y * u)).ln() / (1.0 + y * slope / u);
            y *= step.exp();
            // What is left is a tenth of its square.
            if step.abs() <= 1e-7 {
                break;
            }
        }
        y
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_layers_and_what_is_between() {
        let law = LawOfTheWall::default();
        assert_eq!(law.u_plus(0.0), 0.0);
        assert!((law.u_plus(1.0) - 1.0).abs() < 0.02);
        let logarithmic = |y: f64| (law.e * y).ln() / law.kappa;
        assert!((logarithmic(30.0) / law.u_plus(30.0) - 1.03).abs() < 0.01);
        assert!((logarithmic(11.0) / law.u_plus(11.0) - 1.29).abs() < 0.01);
        assert!((law.u_plus(1e4) / logarithmic(1e4) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn the_velocity_has_a_share_where_the_layer_is_logarithmic() {
        let (law, nu, weight) = (LawOfTheWall::USUAL, 1e-6, 0.4);
        let of_u: f64 = 0.05;
        for (y_plus, share) in [(1.0, 0.0), (100.0, weight), (200.0, weight)] {
            let of_k = 0.04;
            let y = y_plus * nu / of_k;
            let u = of_u * law.u_plus(of_u * y / nu);
            let found = law.shared_friction_velocity(of_k, [y, u], nu, weight);
            let layer: f64 = of_k + (1.0 - (of_k / of_u).powi(2)) * (of_u - of_k) * f64::from(y_plus > 2.0);
            let wanted = layer.powf(1.0 - share) * of_u.powf(share);
            assert!((found / wanted - 1.0).abs() < 1e-9, "{y_plus}: {found} {wanted}");
            assert!((law.layer_velocity(of_k, [y, u], nu, weight) / layer - 1.0).abs() < 1e-9);
            // Both tell the same.
            let same = law.shared_friction_velocity(of_u, [y, u], nu, weight);
            assert!((same / of_u - 1.0).abs() < 1e-9);
            assert_eq!(law.shared_friction_velocity(of_k, [y, u], nu, 0.0), of_k);
        }
        // A flow at rest.
        assert_eq!(law.shared_friction_velocity(1.0, [0.1, 0.0], nu, weight), 0.0);
    }

    /// Without any k the layer is that of the velocity where this is logarithmic, laminar where it is a sublayer, and never beyond either.
    #[test]
    fn a_layer_without_k_is_that_of_the_velocity() {
        let (law, nu, of_u) = (LawOfTheWall::USUAL, 1e-6, 0.05);
        for (y_plus, least, most) in
            [(3.0, 0.0, 0.0), (20.0, 0.1, 0.3), (60.0, 0.999, 1.0), (1e3, 0.999_999, 1.0)]
        {
            let y = y_plus * nu / of_u;
            let place = [y, of_u * law.u_plus(y_plus)];
            let found = law.shared_friction_velocity(0.0, place, nu, 0.4) / of_u;
            assert!((least - 1e-9..=most + 1e-9).contains(&found), "{y_plus}: {found}");
            for part in [0.01, 0.3, 0.9, 1.0, 1.5] {
                let layer = law.layer_velocity(part * of_u, place, nu, 0.4) / of_u;
                assert!((part - 1e-12..=part.max(1.0) + 1e-9).contains(&layer), "{y_plus} {part}: {layer}");
            }
            // In equilibrium the scale is that of k, to the last digits.
            assert!((law.layer_velocity(of_u, place, nu, 0.4) / of_u - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn slope_is_the_derivative_and_y_plus_the_inverse() {
        let law = LawOfTheWall::default();
        for y in [0.01, 0.5, 2.0, 5.0, 11.0, 30.0, 200.0, 1e4] {
            let h = 1e-5 * y;
            let difference = (law.u_plus(y + h) - law.u_plus(y - h)) / (2.0 * h);
            assert!((law.slope(y) - difference).abs() < 1e-6, "{y}: {} {difference}", law.slope(y));
            let back = law.y_plus(y * law.u_plus(y));
            assert!((back / y - 1.0).abs() < 1e-11, "{y} {back}");
        }
        assert_eq!(law.y_plus(0.0), 0.0);
    }
}
