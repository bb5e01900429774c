//! What can go wrong.
use interfaces::{BodyId, ThinPart};

/// Why bodies could not be put on a grid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IbmError {
    /// The shape has no surface where it is asked for.
    #[error(
        "body {} has no surface at signed distance {offset:.3e} m, where its markers are to be: refine the grid or take thicker bodies",
        body.0
    )]
    NoSurface {
        /// The body.
        body: BodyId,
        /// Signed distance from the surface \[m\].
        offset: f64,
    },
    /// The body is too small for the grid.
    #[error(
        "body {} is {size:.3e} m across, {:.1} cells of {spacing:.3e} m; at least {least} are needed: refine the grid or take larger bodies", body.0, size / spacing
    )]
    TooCoarse {
        /// The body.
        body: BodyId,
        /// Its smallest extent \[m\].
        size: f64,
        /// Cell size \[m\].
        spacing: f64,
        /// Cells that are needed.
        least: f64,
    },
    /// The grid is not uniform around a body.
    #[error(
        "around body {} the nodes along axis {axis} are {least:.6e} to {most:.6e} m apart, but the smooth forcing needs equal spacing there: make the grid uniform wherever the body may go, or use `Hfdib`", body.0)]
    Stretched {
        /// The body.
        body: BodyId,
        /// Axis, 0 for x.
        axis: usize,
        /// Smallest distance of neighbouring nodes \[m\].
        least: f64,
        /// Largest distance of neighbouring nodes \[m\].
        most: f64,
    },
    /// A spacing is not a length.
    #[error("the spacing of the cells is {spacing} m: give a positive, finite length")]
    Spacing {
        /// The spacing \[m\].
        spacing: f64,
    },
    /// A body is longer than the period of the grid by more than a cell (and
    /// [`interfaces::LENGTH_PRECISION`] of both).
    #[error(
        "body {} is {size:.3e} m long along axis {axis}, longer than the period of {period:.3e} m by more than a cell: make the body smaller or the box larger", body.0)]
    TooLarge {
        /// The body.
        body: BodyId,
        /// Axis, 0 for x.
        axis: usize,
        /// Extent of the body \[m\].
        size: f64,
        /// Period of the grid \[m\].
        period: f64,
    },
    /// No velocity node is inside the body.
    #[error(
        "body {} is too thin for the grid: it is {size:.3e} m across and no node of some velocity component is inside it (the nodes are \
         about {spacing:.3e} m apart): refine the grid there or make the body thicker than a cell", body.0
    )]
    Unseen {
        /// The body.
        body: BodyId,
        /// Its smallest extent \[m\].
        size: f64,
        /// Mean distance of the nodes \[m\].
        spacing: f64,
    },
    /// A body at rest reaches beyond a bounded side, and no node is in what is left of it inside the box.
    #[error(
        "body {} reaches from {low:.6e} to {high:.6e} m along axis {axis}, the box from {:.6e} to {:.6e} m, and no node of some velocity \
         component is in the part of the body inside the box: move it inside, or leave it out", body.0, box_[0], box_[1])]
    Outside {
        /// The body.
        body: BodyId,
        /// Axis, 0 for x.
        axis: usize,
        /// Lower end of the body \[m\].
        low: f64,
        /// Upper end of the body \[m\].
        high: f64,
        /// Both ends of the box \[m\].
        box_: [f64; 2],
    },
    /// Most of a body is thinner than a cell, so fluid leaks through.
    #[error(
        "body {} is too thin for the grid: {:.3e} m thick at ({}), where walls need {:.3e} m, and thinner than they need on {:.0} % of its \
         surface, so fluid would leak through: refine the grid there or make the body thicker",
        part.body, part.thickness, part.place_text(), part.needed, 100.0 * part.share
    )]
    Thin {
        /// Its place and thickness.
        part: ThinPart,
    },
    /// A control volume holds no cells, or reaches the sides of the flow.
    #[error(
        "along axis {axis} no cells have their centres between {low:.6e} and {high:.6e} m, or more than a period's, or less than two more \
         lie before a side of the flow: take other corners"
    )]
    NoRoom {
        /// Axis, 0 for x.
        axis: usize,
        /// Lower corner \[m\].
        low: f64,
        /// Upper corner \[m\].
        high: f64,
    },
    /// A field is not one of this lattice.
    #[error(
        "a field of {found} values was given with a lattice that stores {needed}: give both of the same grid"
    )]
    Storage {
        /// Values that the lattice reaches.
        needed: usize,
        /// Values there are.
        found: usize,
    },
    /// A velocity has too few or too many components.
    #[error(
        "a velocity of {found} components was given for a lattice of {needed} dimensions: give one field per dimension"
    )]
    Components {
        /// Dimensions of the lattice.
        needed: usize,
        /// Components there are.
        found: usize,
    },
    /// A wall on a side that is none.
    #[error(
        "the sides across axis {axis} are said to be walls, but that axis is periodic or missing: name walls of bounded axes only"
    )]
    NoSide {
        /// Axis, 0 for x.
        axis: usize,
    },
    /// A body's place is not finite.
    #[error("body {} stands at {position:?}, which is not finite; the run has diverged: take a smaller time step", body.0)]
    Lost {
        /// The body.
        body: BodyId,
        /// Where it is.
        position: [f64; 3],
    },
}
