//! Scalars with conditions on the surfaces of bodies.
use crate::{FractionRule, Given, IbmError, Profile, Reconstruction, SolidFraction};
use interfaces::{Bodies, BodyId, Lattice, Vector};

/// Values or gradients of a scalar (temperature, concentration) given on the surfaces of bodies: after every step of the scalar
/// the surface cells get what follows from the surface and the fluid beside it ([`Reconstruction`]), the cells inside what is
/// given for them. The paper's way for "any intensive tensorial property" (Isoz et al. 2023, figure 3), with its λ.
///
/// Surface cells whose centre is inside the body get the profile's value there too, beyond the surface; that makes conduction of second
/// order up to the surface. (Velocities of free bodies do not take that: see [`Reconstruction`].)
#[derive(Clone, Debug)]
pub struct ImmersedScalar {
    inside: SolidFraction,
    surface: Reconstruction,
}

impl ImmersedScalar {
    /// With parabolas along the normals.
    pub fn new(given: Given) -> Self {
        Self::with_profile(Profile::Quadratic, given)
    }
    /// With another profile.
    pub fn with_profile(profile: Profile, given: Given) -> Self {
        Self {
            inside: SolidFraction::new().with_rule(FractionRule::Centroid),
            surface: Reconstruction::new(profile, given).extrapolating(),
        }
    }

    /// Takes note of where the bodies are on `lattice`, whose fields have `storage` values; only those that moved cost anything.
    ///
    /// # Errors
    /// Those of [`SolidFraction::update`].
    pub fn place(&mut self, lattice: &Lattice, storage: usize, bodies: &dyn Bodies) -> Result<(), IbmError> {
        self.inside.update(lattice, bodies)?;
        self.surface.place(lattice, storage, bodies, &self.inside);
        Ok(())
    }

    /// Sets the cells of body `b` in `field`: those at the surface by what is `given` at (S, outward normal there), S from the centre of
    /// mass (a value, or a derivative along the normal \[1/m\]); those inside to `inside`.
    pub fn apply(
        &self,
        b: BodyId,
        field: &mut [f64],
        given: impl Fn(Vector, Vector) -> f64,
        inside: impl Fn(Vector) -> f64,
    ) {
        for node in self.inside.nodes(b).iter().filter(|node| node.fraction >= 1.0) {
            field[node.index] = inside(node.arm);
        }
        self.surface.apply(b, field, given);
    }

    /// Storage indices of the cells of body `b` that [`apply`](Self::apply) sets.
    pub fn held(&self, b: BodyId) -> impl Iterator<Item = usize> + '_ {
        let inside = self.inside.nodes(b).iter().filter(|node| node.fraction >= 1.0);
        inside.map(|node| node.index).chain(self.surface.cells(b).iter().map(|cell| cell.node.index))
    }

    /// How many surface cells had to do with fewer fluid points than their profile takes, so far.
    pub fn lowered(&self) -> u64 {
        self.surface.lowered()
    }
}
