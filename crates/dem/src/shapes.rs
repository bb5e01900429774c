//! Shapes.
mod disc;
mod half_space;
mod implicit;
mod sphere;

pub use disc::Disc;
pub use half_space::HalfSpace;
pub use implicit::Implicit;
pub use sphere::Sphere;

#[cfg(feature = "mesh")]
use crate::Facets;
use interfaces::{Inertia, Solid};

/// A shape with mass, centre of mass at the origin of its frame.
///
/// A type of your own that is a [`Solid`] needs `inertia` and `bounding_radius` only; its overlaps are then computed from
/// its signed distance.
pub trait Shape: Solid {
    /// A word for messages.
    fn name(&self) -> &'static str;
    /// Mass properties at `density` \[kg/m³\].
    fn inertia(&self, density: f64) -> Inertia;
    /// Radius of the smallest sphere around the centre of mass that holds the shape \[m\].
    fn bounding_radius(&self) -> f64;
    /// What is known of the shape besides its distance: this decides how its overlaps are computed.
    fn form(&self) -> Form<'_> {
        Form::Distance
    }
    /// Its facets in a tree, if it is made of triangles: these then decide which boxes of the adaptive tree its surface
    /// cuts. Build them once.
    #[cfg(feature = "mesh")]
    fn facets(&self) -> Option<&Facets> {
        None
    }
}

/// What is known of a shape.
#[derive(Clone, Copy)]
pub enum Form<'a> {
    /// A disc in the plane z = 0.
    Disc(&'a Disc),
    /// A sphere.
    Sphere(&'a Sphere),
    /// All behind a plane.
    HalfSpace(&'a HalfSpace),
    /// Its signed distance only.
    Distance,
}
