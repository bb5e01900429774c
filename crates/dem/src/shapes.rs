//! Shapes.
mod capsule;
mod cylinder;
mod disc;
mod ellipsoid;
mod ellipsoid_surface;
mod half_space;
mod lines;
mod smooth_convex;
mod sphere;
mod spiral;
#[cfg(test)]
mod tests;

pub use capsule::Capsule;
pub use cylinder::Cylinder;
pub use disc::Disc;
pub use ellipsoid::Ellipsoid;
pub use half_space::HalfSpace;
pub use smooth_convex::SmoothConvex;
pub use sphere::Sphere;

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
    /// An ellipsoid.
    Ellipsoid(&'a Ellipsoid),
    /// A cylinder.
    Cylinder(&'a Cylinder),
    /// A capsule.
    Capsule(&'a Capsule),
    /// A convex shape that answers for straight lines and planes.
    Smooth(&'a dyn SmoothConvex),
    /// Its signed distance only.
    Distance,
}
