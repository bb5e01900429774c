//! What walls leave of the cells of a staggered grid.
use crate::{Point, ThinPart, Vector};

/// The part of the cells and their faces that walls at rest leave to the fluid: what who knows the walls' shape tells who
/// balances fluxes over it.
///
/// ```text
/// Σ_f ±open_f A_f e_f = area·normal     (sum over the faces of a cell, + upper, − lower)
/// ```
///
/// closes every cell: a uniform flow along a plane wall has no divergence, and a uniform pressure no force.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CutCells {
    /// Per axis: the faces that are not wholly open, those on the sides of the box included; empty beyond the space
    /// dimensions.
    pub faces: [Vec<OpenFace>; 3],
    /// The wall in the cells that it goes through.
    pub walls: Vec<WallPiece>,
    /// Parts of bodies that are too thin for the grid, so fluid leaks through them: one entry per body that has such parts.
    pub thin: Vec<ThinPart>,
}

/// The open part of a face between two cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenFace {
    /// Storage index of the velocity component normal to it, by that component's [`Lattice`](crate::Lattice).
    pub index: usize,
    /// Share of the face that is open, in \[0, 1).
    pub open: f64,
    /// Centroid of the open part; of the whole face if none is open \[m\].
    pub centre: Point,
    /// Distance of that centroid from the wall \[m\], not negative.
    pub distance: f64,
}

/// The wall in a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPiece {
    /// Number of the cell, x fastest.
    pub cell: usize,
    /// The body it belongs to.
    pub body: usize,
    /// Its area \[m²\]; length in the plane.
    pub area: f64,
    /// Unit normal, into the fluid.
    pub normal: Vector,
    /// A point on it \[m\].
    pub foot: Point,
    /// The same from the body's centre of mass \[m\].
    pub arm: Vector,
    /// Velocity of the wall there \[m/s\].
    pub velocity: Vector,
}
