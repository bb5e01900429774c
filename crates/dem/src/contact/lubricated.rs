//! Films of fluid between bodies that are close.
use super::gap::{FilmForce, Gap};
use super::law::{ContactLaw, Push, Touch};
use super::properties::PairProperties;
use crate::{DemError, Material};
use interfaces::UnresolvedFilm;
use std::f64::consts::PI;
use std::sync::Arc;

/// A contact law with lubrication: the viscous film between two surfaces that do not touch yet resists their approach, sliding and rolling as (Cox 1974, Int. J. Multiphase Flow
/// 1, 343; Jeffrey & Onishi 1984, J. Fluid Mech. 139, 261)
///
/// ```text
/// F_n = −6πμ R² U_n / δ,      R² = 2/((λ₁ + λ₂)√(λ₁λ₂))
/// F_t = −6πμ r ln(1/δ) [(8/15 − 4/5 f g) S + 2/5 (g − f) r ω×n]
/// C   = −6πμ r ln(1/δ) [2/5 (g − f) r n×S + 4/5 r² ω_t],    r = 1/(k₁ + k₂),  f = k₁ r,  g = k₂ r,
/// ```
///
/// U_n and S being the first surface's velocity against the second's along and across the normal n, ω the first body's angular velocity against the second's, C a couple besides
/// F in the middle of the gap, λ the principal curvatures of the gap and k the mean ones of both surfaces: exact to leading order for two spheres or a sphere and a wall; other
/// shapes count as their closest places are curved, flat ones as curved with their own radius. What a flow solver resolves of 1/δ and ln(1/δ) is left out, as its [`UnresolvedFilm`] tells;
/// without one all is modelled up to a [`reach`](WholeFilm). Surfaces are rough: a film gets no thinner than a share of R.
///
/// Solids in space only.
#[derive(Clone, Debug)]
pub struct Lubricated<L> {
    /// The law of what touches.
    pub law: L,
    film: Arc<dyn UnresolvedFilm>,
    viscosity: f64,
    roughness: f64,
}

impl<L: ContactLaw> Lubricated<L> {
    /// The same law with films of a fluid of dynamic `viscosity` \[Pa s\], of which `film` tells what is left to model; roughness 1e-3.
    ///
    /// # Errors
    /// [`DemError::Film`] unless viscosity and reach are positive and finite.
    pub fn new(law: L, viscosity: f64, film: impl UnresolvedFilm + 'static) -> Result<Self, DemError> {
        let law = Self { law, film: Arc::new(film), viscosity, roughness: 1e-3 };
        law.check_film()?;
        Ok(law)
    }

    /// The same with films that get no thinner than `roughness` R.
    ///
    /// # Errors
    /// [`DemError::Film`] unless it is positive and at most 1.
    pub fn with_roughness(mut self, roughness: f64) -> Result<Self, DemError> {
        self.roughness = roughness;
        self.check_film()?;
        Ok(self)
    }

    fn check_film(&self) -> Result<(), DemError> {
        let numbers = [
            ("viscosity in Pa s", self.viscosity, f64::MAX),
            ("reach in m", self.film.reach(), f64::MAX),
            ("roughness, a share of the radius,", self.roughness, 1.0),
        ];
        match numbers.into_iter().find(|(_, value, most)| !(*value > 0.0 && value <= most)) {
            Some((what, value, _)) => Err(DemError::Film { what, value }),
            None => Ok(()),
        }
    }
}

impl<L: ContactLaw> ContactLaw for Lubricated<L> {
    type Memory = L::Memory;
    const MOBILITY: bool = L::MOBILITY;
    const PIVOTS: bool = L::PIVOTS;
    const FILMS: bool = true;
    const PLANE: bool = false;

    fn properties(&self, a: &Material, b: &Material) -> PairProperties {
        self.law.properties(a, b)
    }
    #[inline]
    fn push(&self, p: &PairProperties, touch: &Touch<'_>, memory: &mut Self::Memory) -> Push {
        self.law.push(p, touch, memory)
    }
    fn reach(&self) -> f64 {
        self.film.reach()
    }
    fn across(&self, gap: &Gap) -> FilmForce {
        let n = gap.normal;
        let thickness = gap.distance.max(self.roughness * gap.radius);
        let squeeze = 6.0
            * PI
            * self.viscosity
            * gap.radius
            * gap.radius
            * self.film.squeeze(thickness, gap.radius, gap.wall);
        let [k, l] = gap.curvatures;
        let r = 1.0 / (k + l);
        let (f, g) = (k * r, l * r);
        let shear = 6.0 * PI * self.viscosity * r * self.film.shear(thickness);
        let approach = gap.velocity.dot(&n);
        let (sliding, turning) = (gap.velocity - approach * n, gap.spin - gap.spin.dot(&n) * n);
        let (direct, mixed) = (8.0 / 15.0 - 0.8 * f * g, 0.4 * (g - f) * r);
        let force = -squeeze * approach * n - shear * (direct * sliding + mixed * turning.cross(&n));
        let couple = -shear * (mixed * n.cross(&sliding) + 0.8 * r * r * turning);
        // Turning a ball by a force at its surface is 3.5 times as easy as moving it.
        FilmForce { force, couple, resistance: squeeze.abs().max(3.5 * shear) }
    }
    fn check(&self) -> Result<(), DemError> {
        self.check_film()?;
        self.law.check()
    }
}

/// Nothing is resolved: films are modelled whole, up to where they are as thick as `reach`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WholeFilm {
    /// \[m\].
    pub reach: f64,
}

impl UnresolvedFilm for WholeFilm {
    fn reach(&self) -> f64 {
        self.reach
    }
    fn squeeze(&self, gap: f64, _: f64, _: bool) -> f64 {
        (1.0 / gap - 1.0 / self.reach).max(0.0)
    }
    fn shear(&self, gap: f64) -> f64 {
        (self.reach / gap).ln().max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Chen;
    use interfaces::Vector;

    /// Two balls of radii 1 and `b` (a wall if infinite).
    fn gap(b: f64, velocity: Vector, spin: Vector) -> Gap {
        let (wall, k) = (b.is_infinite(), 1.0 / b);
        Gap {
            distance: 0.01,
            normal: Vector::z(),
            velocity,
            spin,
            radius: 1.0 / (1.0 + k),
            curvatures: [1.0, k],
            wall,
        }
    }

    fn law() -> Lubricated<Chen> {
        Lubricated::new(Chen::default(), 1.0, WholeFilm { reach: 0.1 }).unwrap()
    }

    #[test]
    fn a_ball_at_a_wall_is_held_as_goldman_cox_and_brenner_found() {
        let log = 10.0_f64.ln();
        let (six, eight) = (6.0 * PI, 8.0 * PI);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * b.abs().max(1.0), "{a} {b}");
        let down = law().across(&gap(f64::INFINITY, Vector::z(), Vector::zeros()));
        near(down.force.z, -six * (100.0 - 10.0));
        // The centre moves, nothing turns.
        let along = law().across(&gap(f64::INFINITY, Vector::x(), Vector::zeros()));
        near(along.force.x, -six * 8.0 / 15.0 * log);
        near((Vector::z().cross(&along.force) + along.couple).y, eight * 0.1 * -log);
        // It turns about y at its place: the surface below it moves along x.
        let spin = law().across(&gap(f64::INFINITY, Vector::y().cross(&Vector::z()), Vector::y()));
        near(spin.force.x, -six * 2.0 / 15.0 * log);
        near((Vector::z().cross(&spin.force) + spin.couple).y, -eight * 0.4 * log);
    }

    #[test]
    fn balls_of_any_sizes_obey_jeffrey_and_onishi() {
        let log = 10.0_f64.ln();
        for b in [0.2, 1.0, 3.0_f64] {
            let along = law().across(&gap(b, Vector::x(), Vector::zeros()));
            let y = 4.0 * b * (2.0 + b + 2.0 * b * b) / (15.0 * (1.0 + b).powi(3));
            assert!((along.force.x / (-6.0 * PI * y * log) - 1.0).abs() < 1e-12, "{b}");
            let spin = law().across(&gap(b, Vector::y().cross(&Vector::z()), Vector::y()));
            let y = b * (4.0 + b) / (5.0 * (1.0 + b).powi(2));
            assert!((spin.force.x / (-4.0 * PI * y * log) - 1.0).abs() < 1e-12, "{b}");
            let torque = (Vector::z().cross(&spin.force) + spin.couple).y;
            assert!((torque / (-8.0 * PI * 0.4 * b / (1.0 + b) * log) - 1.0).abs() < 1e-12, "{b}");
        }
    }

    #[test]
    fn rough_films_get_no_thinner_and_senseless_ones_are_refused() {
        let rough = law().with_roughness(0.05).unwrap();
        let down = |distance| {
            rough.across(&Gap { distance, ..gap(f64::INFINITY, Vector::z(), Vector::zeros()) }).force.z
        };
        assert_eq!(down(0.01), down(0.05));
        assert!(down(0.06) > down(0.05));
        for viscosity in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let made = Lubricated::new(Chen::default(), viscosity, WholeFilm { reach: 0.1 });
            assert!(matches!(made, Err(DemError::Film { .. })), "{viscosity}");
        }
        assert!(matches!(law().with_roughness(0.0), Err(DemError::Film { .. })));
        assert!(Lubricated::new(Chen::default(), 1.0, WholeFilm { reach: f64::NAN }).is_err());
    }
}
