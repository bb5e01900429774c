//! Shapes.
mod capsule;
mod convex_polyhedron;
mod cuboid;
mod cylinder;
mod disc;
mod ellipsoid;
mod ellipsoid_surface;
mod facets;
mod half_space;
mod hull;
#[cfg(any(test, feature = "mesh"))]
mod icosphere;
mod implicit;
mod lines;
mod moments;
mod polygon;
mod smooth_convex;
mod sphere;
mod spiral;
#[cfg(test)]
mod tests;
pub(crate) mod triangle;
#[cfg(feature = "mesh")]
mod triangle_mesh;
mod union;

pub use capsule::Capsule;
pub use convex_polyhedron::ConvexPolyhedron;
pub(crate) use convex_polyhedron::Plane;
pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use disc::Disc;
pub use ellipsoid::Ellipsoid;
pub use facets::Facets;
pub(crate) use facets::{Patches, Places, WIDTH, Words, moved, parts, slack};
pub use half_space::HalfSpace;
#[cfg(any(test, feature = "mesh"))]
pub(crate) use icosphere::icosphere;
pub use implicit::Implicit;
pub(crate) use moments::Moments;
pub use polygon::Polygon;
pub(crate) use polygon::{Piece, nearest_on_edge};
pub use smooth_convex::SmoothConvex;
pub use sphere::Sphere;
#[cfg(feature = "mesh")]
pub use triangle_mesh::{
    AdmissionReport, Changes, MeshError, RepairReport, Shell, Thinnest, TriangleMesh, TriangleSoup,
};
pub use union::{Part, Union};

#[cfg(feature = "mesh")]
use crate::FacetIndex;
use interfaces::{Inertia, Solid};
use std::sync::Arc;

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
    fn facet_index(&self) -> Option<&FacetIndex> {
        None
    }
}

impl<T: Shape + ?Sized> Shape for Arc<T> {
    fn name(&self) -> &'static str {
        (**self).name()
    }
    fn inertia(&self, density: f64) -> Inertia {
        (**self).inertia(density)
    }
    fn bounding_radius(&self) -> f64 {
        (**self).bounding_radius()
    }
    fn form(&self) -> Form<'_> {
        (**self).form()
    }
    #[cfg(feature = "mesh")]
    fn facet_index(&self) -> Option<&FacetIndex> {
        (**self).facet_index()
    }
}

/// What is known of a shape.
#[derive(Clone, Copy)]
pub enum Form<'a> {
    /// A disc in the plane z = 0.
    Disc(&'a Disc),
    /// A polygon in the plane z = 0.
    Polygon(&'a Polygon),
    /// A sphere.
    Sphere(&'a Sphere),
    /// All behind a plane.
    HalfSpace(&'a HalfSpace),
    /// A convex body between flat faces.
    Hull(&'a ConvexPolyhedron),
    /// A closed surface of triangles.
    Facets(&'a Facets),
    /// Parts that do not overlap.
    Union(&'a [Part]),
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

impl<'a> Form<'a> {
    /// Is it of the plane z = 0?
    pub(crate) fn is_plane(&self) -> bool {
        match self {
            Self::Disc(_) | Self::Polygon(_) => true,
            Self::Union(parts) => parts.iter().all(|part| part.shape.form().is_plane()),
            _ => false,
        }
    }
    /// The triangles of a flat-faced shape.
    pub(crate) fn facets(&self) -> Option<&'a Facets> {
        match self {
            Self::Hull(hull) => Some(hull.facets()),
            Self::Facets(facets) => Some(facets),
            _ => None,
        }
    }
}
