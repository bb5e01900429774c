//! Bodies pushed apart before they touch.
use super::gap::{FilmForce, Gap};
use super::law::{ContactLaw, Push, Touch};
use super::properties::PairProperties;
use crate::{DemError, Material};

/// A contact law with a short-range repulsion (Glowinski, Pan, Hesla & Joseph 1999, Int. J. Multiphase Flow 25, 755, equation 43 for balls):
///
/// ```text
/// F = −F₀ (1 − δ/ζ)² n   for 0 < δ < ζ,   −F₀ n where the surfaces overlap
/// ```
///
/// on the first of two bodies whose closest places are δ apart, n pointing from there to the second; between bodies and walls, too. It is the gradient of ⅓ F₀ ζ (1 − δ/ζ)³, so it
/// takes no energy. Take for ζ one or two cells of the flow, for F₀ some ten times what presses bodies together: they stay apart then, so that the flow between them is computed, if
/// coarsely. It stands for no film: bodies bounce off it and slide along it. In space and in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repulsive<L> {
    /// The law of what touches.
    pub law: L,
    strength: f64,
    range: f64,
}

impl<L: ContactLaw> Repulsive<L> {
    /// The same law with a repulsion of `strength` F₀ \[N; in a plane scene N/m\] where surfaces touch, and `range` ζ \[m\].
    ///
    /// # Errors
    /// [`DemError::Repulsion`] unless both are positive and finite.
    pub fn new(law: L, strength: f64, range: f64) -> Result<Self, DemError> {
        let law = Self { law, strength, range };
        law.check_numbers()?;
        Ok(law)
    }

    fn check_numbers(&self) -> Result<(), DemError> {
        let numbers = [("strength in N (in a plane scene N/m)", self.strength), ("range in m", self.range)];
        match numbers.into_iter().find(|(_, value)| !(*value > 0.0 && value.is_finite())) {
            Some((what, value)) => Err(DemError::Repulsion { what, value }),
            None => Ok(()),
        }
    }
}

impl<L: ContactLaw> ContactLaw for Repulsive<L> {
    type Memory = L::Memory;
    const MOBILITY: bool = L::MOBILITY;
    const PIVOTS: bool = L::PIVOTS;
    const FILMS: bool = true;
    const PLANE: bool = L::PLANE;

    fn properties(&self, a: &Material, b: &Material) -> PairProperties {
        self.law.properties(a, b)
    }
    #[inline]
    fn push(&self, p: &PairProperties, touch: &Touch<'_>, memory: &mut Self::Memory) -> Push {
        let mut push = self.law.push(p, touch, memory);
        // As stiff as it is where surfaces touch: what the step is chosen by, far from one another, too.
        push.stiffness += 2.0 * self.strength / self.range;
        // Of several patches each has its share.
        push.force += touch.overlap.normal * (self.strength * touch.overlap.volume / touch.volume);
        push
    }
    fn reach(&self) -> f64 {
        self.range.max(self.law.reach())
    }
    fn across(&self, gap: &Gap) -> FilmForce {
        let mut film = if L::FILMS { self.law.across(gap) } else { FilmForce::default() };
        let near = (1.0 - gap.distance / self.range).max(0.0);
        film.force -= self.strength * near * near * gap.normal;
        film
    }
    fn check(&self) -> Result<(), DemError> {
        self.check_numbers()?;
        self.law.check()
    }
}
