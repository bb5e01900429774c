//! What a contact law is asked, and what it answers.
use super::gap::{FilmForce, Gap};
use crate::{DemError, Overlap, PairProperties};
use interfaces::Vector;
use std::fmt::Debug;

/// The force between two bodies that overlap. `()` is none: bodies pass through one another and through walls, and nobody looks who is near.
pub trait ContactLaw: Clone + Debug + Send + Sync {
    /// What is kept per patch from one sub-step to the next.
    type Memory: Memory;

    /// The properties of a pair of materials, which depend on all but their densities.
    fn properties(&self, a: &crate::Material, b: &crate::Material) -> PairProperties {
        PairProperties::new(a, b)
    }

    /// What the first body of a pair feels at the centroid of a patch.
    fn push(&self, p: &PairProperties, touch: &Touch<'_>, memory: &mut Self::Memory) -> Push;

    /// Does it ask for [`Touch::mobility`]?
    const MOBILITY: bool = false;
    /// Whether it needs [`Touch::pivot`]. Others pay nothing for it.
    const PIVOTS: bool = false;
    /// Is there a force at all? If not, pairs are not looked for.
    const TOUCHES: bool = true;

    /// Does it act [across](Self::across) gaps, too? Others pay nothing for it.
    const FILMS: bool = false;

    /// Does it have a meaning in plane scenes?
    const PLANE: bool = true;

    /// The largest gap across which it acts \[m\].
    fn reach(&self) -> f64 {
        0.0
    }

    /// What the first of two bodies feels that do not touch.
    fn across(&self, gap: &Gap) -> FilmForce {
        let _ = gap;
        FilmForce::default()
    }

    /// Are its own numbers in order?
    ///
    /// # Errors
    /// [`DemError::LengthFactor`], [`DemError::Film`], [`DemError::Repulsion`].
    fn check(&self) -> Result<(), DemError>;
}

impl ContactLaw for () {
    type Memory = ();
    const TOUCHES: bool = false;

    #[inline(always)]
    fn push(&self, _: &PairProperties, _: &Touch<'_>, (): &mut ()) -> Push {
        Push { force: Vector::zeros(), couple: Vector::zeros(), stiffness: 0.0 }
    }
    fn check(&self) -> Result<(), DemError> {
        Ok(())
    }
}

/// Where and how two bodies touch at one instant: one patch of their overlap.
#[derive(Clone, Copy, Debug)]
pub struct Touch<'a> {
    /// The patch.
    pub overlap: &'a Overlap,
    /// Area of the patch, |∂V/∂x| \[m²\].
    pub area: f64,
    /// Volume of all patches of the two \[m³\].
    pub volume: f64,
    /// dV/dt of the patch \[m³/s\].
    pub rate: f64,
    /// Velocity of the first body against the second at the centroid \[m/s\].
    pub velocity: Vector,
    /// Angular velocity of the first body against the second \[rad/s\].
    pub spin: Vector,
    /// 1/m of both \[1/kg\]; 0 of what cannot be moved.
    pub inverse_masses: [f64; 2],
    /// Distances from the bodies' centres of mass to the centroid \[m\], at least a twentieth of the radius of the largest sphere around the
    /// centre that is within the body; infinite for a wall.
    pub arms: [f64; 2],
    /// Radii of spheres (in a plane scene discs) as large as the bodies \[m\]; infinite for a wall.
    pub sizes: [f64; 2],
    /// By how much a force −∇V of 1 per m³ changes dV/dt per second: ∇V·m⁻¹∇V over all of both bodies' motions \[m⁴/kg\]. NaN for laws
    /// that do not ask for it.
    pub mobility: f64,
    /// Relative spin about the patch; `None` for balls and discs, whose spin does not move their surface, and for laws without
    /// [`ContactLaw::PIVOTS`].
    pub pivot: Option<Pivot>,
    /// Area of the smaller of both bodies' largest flat faces \[m²\]; 0 if one has none. Flat faces may meet, and the area of contact is
    /// there at once.
    pub face: f64,
    /// Are volumes areas, and forces per metre of depth?
    pub plane: bool,
    /// The sub-step \[s\].
    pub dt: f64,
    /// Time since the middle of the last sub-step, when contacts were found before \[s\].
    pub since: f64,
}

/// Relative spin ω about a patch with second moments of area [K](Overlap::pivot).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pivot {
    /// K ω = ∫ w v_n dA, v_n = w·ω the normal velocity of the patch's points besides its mean \[m⁴/s\].
    pub moment: Vector,
    /// ω·K ω = ∫ v_n² dA \[m⁴/s²\].
    pub square: f64,
    /// K ω·I⁻¹K ω/(ω·K ω) over both bodies: decay rate of v_n² per viscosity \[m²/kg\].
    pub mobility: f64,
}

impl Pivot {
    /// Couple on the first body by a damping pressure −c v_n over the patch, c = `viscosity` \[Pa s/m\], mean over a sub-step of
    /// `dt`. The pressure's root mean square stays below the mean `pressure` \[Pa\] over the `area`, so that no part of the patch
    /// is pulled for long.
    pub(super) fn couple(&self, viscosity: f64, pressure: f64, area: f64, dt: f64) -> Vector {
        if self.square <= 0.0 {
            return Vector::zeros();
        }
        let viscosity = viscosity / (1.0 + 0.5 * dt * viscosity * self.mobility);
        let most = pressure.max(0.0) * (area / self.square).sqrt();
        self.moment * -viscosity.min(most)
    }
}

/// Share of a relative velocity that damping may take in a sub-step: of a few contacts that act on one motion together no more
/// than all of it.
pub(crate) const MOST_TAKEN: f64 = 0.3;
/// Sub-steps per half period of contacts that are stiffer than foreseen.
pub(crate) const LEAST_STEPS: f64 = 28.0;

/// Stiffness over mass \[1/s²\] whose sub-steps damp a velocity that decays at `rate` \[1/s\] by a share of at most 0.3.
#[inline]
pub(crate) fn stiffness_of_decay(rate: f64) -> f64 {
    let root = std::f64::consts::PI * rate / (LEAST_STEPS * MOST_TAKEN);
    root * root
}

/// What the first body of a pair feels; the second feels the opposite.
#[derive(Clone, Copy, Debug)]
pub struct Push {
    /// Force at the centroid \[N\].
    pub force: Vector,
    /// Torque besides \[N m\].
    pub couple: Vector,
    /// Force per depth, raised by what damping adds to it \[N/m\]: what the time step is chosen by.
    pub stiffness: f64,
}

/// What is kept per patch, as numbers for restarts.
pub trait Memory: Copy + Default + Debug + Send + Sync {
    /// How many numbers.
    const N: usize;
    /// Appends them.
    fn save(&self, out: &mut Vec<f64>);
    /// Reads them back.
    fn load(from: &[f64]) -> Self;
}

/// Nothing.
impl Memory for () {
    const N: usize = 0;
    fn save(&self, _: &mut Vec<f64>) {}
    fn load(_: &[f64]) -> Self {}
}

/// The elastic tangential force on the first body.
impl Memory for Vector {
    const N: usize = 3;
    fn save(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(self.as_slice());
    }
    fn load(from: &[f64]) -> Self {
        Self::new(from[0], from[1], from[2])
    }
}

impl<A: Memory, B: Memory> Memory for (A, B) {
    const N: usize = A::N + B::N;
    fn save(&self, out: &mut Vec<f64>) {
        self.0.save(out);
        self.1.save(out);
    }
    fn load(from: &[f64]) -> Self {
        (A::load(&from[..A::N]), B::load(&from[A::N..]))
    }
}
