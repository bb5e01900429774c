//! The shapes that `RigidBodies` can collide yet.
use crate::overlap::closed;
use crate::{DemError, Disc, HalfSpace, Overlap, Shape, Sphere};
use interfaces::{Inertia, Point, Solid};

/// A disc or a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Round {
    /// A disc in the plane z = 0.
    Disc(Disc),
    /// A sphere.
    Sphere(Sphere),
}

impl Round {
    /// As the others see it.
    pub fn solid(&self) -> &dyn Solid {
        match self {
            Self::Disc(s) => s,
            Self::Sphere(s) => s,
        }
    }
    fn shape(&self) -> &dyn Shape {
        match self {
            Self::Disc(s) => s,
            Self::Sphere(s) => s,
        }
    }
    /// Mass properties at `density` \[kg/m³\].
    pub fn inertia(&self, density: f64) -> Inertia {
        self.shape().inertia(density)
    }
    /// Its radius \[m\].
    pub fn radius(&self) -> f64 {
        match self {
            Self::Disc(s) => s.radius(),
            Self::Sphere(s) => s.radius(),
        }
    }
    /// Does it live in the plane z = 0?
    pub(crate) fn is_plane(&self) -> bool {
        matches!(self, Self::Disc(_))
    }
    /// A word for messages.
    pub(crate) fn name(&self) -> &'static str {
        self.shape().name()
    }
    /// What it shares, at `at`, with another one at `at_other`.
    pub(crate) fn overlap(
        &self,
        at: Point,
        other: &Self,
        at_other: Point,
    ) -> Result<Option<Overlap>, DemError> {
        match (self, other) {
            (Self::Disc(a), Self::Disc(b)) => Ok(closed::discs(a.radius(), at, b.radius(), at_other)),
            (Self::Sphere(a), Self::Sphere(b)) => Ok(closed::spheres(a.radius(), at, b.radius(), at_other)),
            _ => Err(DemError::Unsupported { a: self.name(), b: other.name() }),
        }
    }
    /// What it shares, at `at`, with a wall.
    pub(crate) fn wall_overlap(&self, at: Point, wall: &HalfSpace) -> Option<Overlap> {
        let distance = wall.signed_distance(at);
        match self {
            Self::Disc(s) => closed::disc_wall(s.radius(), at, distance, wall.normal()),
            Self::Sphere(s) => closed::sphere_wall(s.radius(), at, distance, wall.normal()),
        }
    }
}

impl From<Disc> for Round {
    fn from(s: Disc) -> Self {
        Self::Disc(s)
    }
}
impl From<Sphere> for Round {
    fn from(s: Sphere) -> Self {
        Self::Sphere(s)
    }
}
