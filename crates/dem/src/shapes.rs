//! Shapes.
mod disc;
mod half_space;
mod sphere;

pub use disc::Disc;
pub use half_space::HalfSpace;
pub use sphere::Sphere;

use interfaces::{Inertia, Solid};

/// The shapes a rigid body may have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A disc in the plane z = 0.
    Disc(Disc),
    /// A sphere.
    Sphere(Sphere),
}

impl Shape {
    /// As the others see it.
    pub fn solid(&self) -> &dyn Solid {
        match self {
            Self::Disc(s) => s,
            Self::Sphere(s) => s,
        }
    }
    /// Mass properties at `density` \[kg/m³\].
    pub fn inertia(&self, density: f64) -> Inertia {
        match self {
            Self::Disc(s) => s.inertia(density),
            Self::Sphere(s) => s.inertia(density),
        }
    }
    /// Radius of the smallest sphere around the centre of mass that holds the shape \[m\].
    pub fn bounding_radius(&self) -> f64 {
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
        match self {
            Self::Disc(_) => "disc",
            Self::Sphere(_) => "sphere",
        }
    }
}

impl From<Disc> for Shape {
    fn from(s: Disc) -> Self {
        Self::Disc(s)
    }
}
impl From<Sphere> for Shape {
    fn from(s: Sphere) -> Self {
        Self::Sphere(s)
    }
}
