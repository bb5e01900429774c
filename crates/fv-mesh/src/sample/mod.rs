//! Values at points, on lines and planes, and integrals over the grid.
mod flux;
mod integrals;
mod line;
mod plane;
mod probes;
mod sampler;
#[cfg(test)]
mod tests;
mod velocity_norms;

pub use integrals::{Extreme, Integrals, Norms};
pub use line::Line;
pub use plane::Plane;
pub use probes::Probes;
pub use sampler::{Quantity, Sampler};

use crate::GridMismatch;
use std::io;

/// Why a field could not be sampled.
#[derive(Debug, thiserror::Error)]
pub enum SampleError {
    /// A point beyond a bounded side, or not a number.
    #[error(
        "a point at {x} m along axis {axis}; the box goes from {lower} m to {upper} m: take a point inside"
    )]
    Outside {
        /// The axis.
        axis: usize,
        /// The coordinate \[m\].
        x: f64,
        /// Lower end of the axis \[m\].
        lower: f64,
        /// Upper end of the axis \[m\].
        upper: f64,
    },
    /// A plane normal to an axis that there is not.
    #[error("a plane normal to axis {axis}; there are axes 0 to {}", .axes - 1)]
    Axis {
        /// The axis.
        axis: usize,
        /// How many there are.
        axes: usize,
    },
    /// Too few points.
    #[error("{found} points; give at least {least}")]
    Points {
        /// How many.
        found: usize,
        /// How many are needed.
        least: usize,
    },
    /// Other columns than those that the file has.
    #[error("the columns {found:?} for a file with the columns {expected:?}; record the same at every time")]
    Columns {
        /// Header of the file.
        expected: String,
        /// Header of the row.
        found: String,
    },
    /// A field on another grid.
    #[error(transparent)]
    Grid(#[from] GridMismatch),
    /// A file could not be written.
    #[error("writing samples: {0} (choose a place that you may write to, with room on its disk)")]
    Io(#[from] io::Error),
}
