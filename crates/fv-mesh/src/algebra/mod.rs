//! Algebra of fields that reads as mathematics and makes no temporaries.
//!
//! `+ − * /`, negation, [`abs`](Expr::abs), [`sqrt`](Expr::sqrt), [`square`](Expr::square), [`min`](Expr::min),
//! [`max`](Expr::max) and [`map`](Expr::map) of fields, numbers and functions of place build an [`Expr`]: a tree that
//! knows its operands and holds no values. [`Field::assign`](crate::Field::assign) and its relatives evaluate the tree in one pass over
//! the rows of the grid, in parallel over fixed runs of layers; [`Integrals`](crate::Integrals) sum over it.
//! Values follow IEEE 754: 1/0 is infinite, √−1 is not a number, and `min` and `max` pass on what is not a number.
//! Ghosts are neither read nor written.
//!
//! ```
//! use fv_mesh::{Axis, CartesianGrid, Field};
//!
//! let grid = CartesianGrid::from_axes([Axis::geometric(8, 0.0, 1.0, 1.1)?, Axis::uniform(6, 0.0, 2.0)?])?;
//! let b = Field::from_fn(&grid, |x| x[0]);
//! let c = Field::from_fn(&grid, |x| x[1]);
//! let mut a = Field::zeros(&grid);
//! a.assign(2.0 * &b + &b * &c - 3.0)?;
//! let exact = grid.function(|x| 2.0 * x[0] + x[0] * x[1] - 3.0);
//! assert!(a.max_difference(exact)? < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod evaluate;
mod nodes;
mod operators;
#[cfg(test)]
mod tests;

pub use nodes::{
    Absolute, Binary, BinaryRow, Cells, Constant, Function, FunctionRow, Higher, Lower, Map, MapRow, Minus,
    Negative, Operation, Over, Plus, Root, RowPlace, Square, Times, Transformation, Unary, UnaryRow,
};
pub use operators::Expr;

use crate::CartesianGrid;
use std::fmt;

/// What can be evaluated at the cells of a grid, a row along x at a time.
pub trait Expression<const D: usize>: Sync {
    /// The expression along one row.
    type Row<'r>: RowExpression
    where
        Self: 'r;
    /// Do all operands live on `grid`?
    ///
    /// # Errors
    /// [`GridMismatch`] if one does not.
    fn check(&self, grid: &CartesianGrid<D>) -> Result<(), GridMismatch>;
    /// The expression along the row at `place`.
    fn row(&self, place: &RowPlace<D>) -> Self::Row<'_>;
}

/// An expression along one row.
pub trait RowExpression {
    /// Its value in cell `i` of the row.
    fn at(&self, i: usize) -> f64;
    /// Its values in the cells from `i` on, as many as sums take at once.
    fn block(&self, i: usize) -> [f64; LANES];
}

/// Cells that sums take at once, so that they run in vector registers in a fixed order.
pub const LANES: usize = 8;

/// What can stand in an expression: a field by reference, a number, another expression.
pub trait Operand {
    /// What it is in the tree.
    type Node;
    /// Puts it there.
    fn node(self) -> Self::Node;
}

/// The ends of an axis, for messages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Number of cells.
    pub cells: usize,
    /// Lower end \[m\].
    pub lower: f64,
    /// Upper end \[m\].
    pub upper: f64,
}

impl fmt::Display for Extent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} cells from {} m to {} m", self.cells, self.lower, self.upper)
    }
}

/// Fields of different grids met.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "a field on another grid: along axis {axis} {expected} expected, {found} found (or faces in between differ); \
     use fields of one grid"
)]
pub struct GridMismatch {
    /// The first axis that differs.
    pub axis: usize,
    /// The axis as it should be.
    pub expected: Extent,
    /// The axis as it is.
    pub found: Extent,
}

/// Errs unless `found` has the faces of `expected`.
pub(crate) fn check_grid<const D: usize>(
    expected: &CartesianGrid<D>,
    found: &CartesianGrid<D>,
) -> Result<(), GridMismatch> {
    for axis in 0..D {
        let (ours, theirs) = (expected.axis(axis), found.axis(axis));
        // Clones of a grid share their faces.
        if !std::ptr::eq(ours.faces(), theirs.faces()) && ours.faces() != theirs.faces() {
            let [expected, found] =
                [ours, theirs].map(|a| Extent { cells: a.cells(), lower: a.lower(), upper: a.upper() });
            return Err(GridMismatch { axis, expected, found });
        }
    }
    Ok(())
}
