//! The volume that two bodies share; one file per route to it.
mod ball_faces;
mod cells;
mod clip;
pub(crate) mod closed;
mod columns;
mod doubling;
mod ellipsoids;
mod facets;
mod half_space;
mod integrals;
mod outline;
pub(crate) mod plane;
mod sheets;
mod slices;
mod solver;
pub(crate) mod tree;
mod tube;
mod tube_faces;
mod walls;

pub use cells::CellOverlap;
pub use solver::{OverlapSolver, Route, overlap};
#[cfg(feature = "mesh")]
pub use tree::FacetIndex;
pub use tree::{BoxKind, Normal, Refinement, SubBox};

use interfaces::{Point, Vector};
use nalgebra::Matrix3;

/// A connected region that two bodies share.
///
/// In a plane scene its volume is an area \[m²\], its gradient a length \[m\] and so on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Volume V \[m³\].
    pub volume: f64,
    /// Centroid of the region \[m\].
    pub centroid: Point,
    /// Contact normal, of unit length: the way the first body is pushed. −S/|S| unless asked for otherwise.
    pub normal: Vector,
    /// S = ∂V/∂x, x the place of the first body \[m²\]: ∫ n dA over the part of the first body's surface that lies
    /// within the second, n outward. Zero where one body is within the other.
    pub gradient: Vector,
    /// ∂V/∂φ, φ a small turn of the first body about the centroid \[m³\]: ∫ (x − centroid) × n dA over the same part
    /// (Feng 2021, Comput. Methods Appl. Mech. Eng. 373, 113495).
    pub moment: Vector,
    /// Second moments of the patch's area, projected along its normal n and about its centroid x_a \[m⁴\]:
    /// K = ∫ w wᵀ dA, w = (x − x_a) × n, so that relative spin ω gives points of the patch the normal velocity w·ω
    /// besides its mean; in a plane scene ℓ³/12 about z \[m³\]. Zero unless
    /// [requested](OverlapSolver::with_pivots), and for spheres and discs, whose spin does not move their surface.
    pub pivot: Matrix3<f64>,
}

impl Overlap {
    /// Area of the contact, |∂V/∂x| \[m²\]; its length \[m\] in a plane scene.
    #[inline]
    pub fn area(&self) -> f64 {
        self.gradient.norm()
    }
    /// dV/dt = S·v + moment·ω, where `velocity` is that of the first body against the second at the centroid \[m/s\]
    /// and `spin` its angular velocity against the second's \[rad/s\].
    #[inline]
    pub fn rate(&self, velocity: Vector, spin: Vector) -> f64 {
        self.gradient.dot(&velocity) + self.moment.dot(&spin)
    }
    /// All of a body that lies within the other, where nothing changes when it moves.
    pub(crate) fn whole(volume: f64, centroid: Point, normal: Vector) -> Self {
        Self {
            volume,
            centroid,
            normal,
            gradient: Vector::zeros(),
            moment: Vector::zeros(),
            pivot: Matrix3::zeros(),
        }
    }
    /// As the second body sees it.
    #[must_use]
    pub fn swapped(&self) -> Self {
        Self { normal: -self.normal, gradient: -self.gradient, moment: -self.moment, ..*self }
    }
}

#[cfg(test)]
mod routes_tests;
#[cfg(test)]
mod smooth_tests;
#[cfg(test)]
mod tests;

#[cfg(all(test, feature = "mesh"))]
mod every_pair_tests;
#[cfg(all(test, feature = "mesh"))]
mod memory_tests;
#[cfg(test)]
mod polyhedra_tests;
