//! One axis of a box whose cells may differ in width.
use super::{AxisBounds, PoissonError};
use crate::Axis;

/// Cells of one axis and what holds at its two ends.
///
/// With cell widths w_i and the distances d_i = (w_{i−1} + w_i)/2 of their centres, the axis adds
///
/// ```text
/// (1/w_i) [ (φ_{i+1} − φ_i)/d_{i+1} − (φ_i − φ_{i−1})/d_i ]
/// ```
///
/// to the equation of cell i. At an end the flux is zero (Neumann), 2 (0 − φ)/w (Dirichlet, zero value
/// at the face) or that of the other end (periodic).
#[derive(Clone, Debug, PartialEq)]
pub struct PoissonAxis {
    /// Cell widths \[m\], from the low end up.
    pub widths: Vec<f64>,
    /// What holds at the ends.
    pub ends: AxisBounds,
}

impl PoissonAxis {
    /// `cells` cells of one `width` \[m\].
    pub fn uniform(cells: usize, width: f64, ends: AxisBounds) -> Self {
        Self { widths: vec![width; cells], ends }
    }

    /// The cells of a grid's axis.
    pub fn from_axis(axis: &Axis, ends: AxisBounds) -> Self {
        Self { widths: (0..axis.cells()).map(|i| axis.width(i)).collect(), ends }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.widths.len()
    }

    /// Sum of the widths \[m\].
    pub fn length(&self) -> f64 {
        self.widths.iter().sum()
    }

    /// Are all cells equally wide, up to a few roundings?
    pub fn is_uniform(&self) -> bool {
        let first = self.widths.first().copied().unwrap_or(1.0);
        self.widths.iter().all(|w| (w - first).abs() <= 8.0 * f64::EPSILON * first)
    }

    /// Do the two ends differ?
    pub fn is_mixed(&self) -> bool {
        matches!(self.ends, AxisBounds::NeumannDirichlet | AxisBounds::DirichletNeumann)
    }

    /// Do the ends leave a constant free?
    pub(super) fn is_free(&self) -> bool {
        matches!(self.ends, AxisBounds::Periodic | AxisBounds::Neumann)
    }

    /// True if Fourier, cosine or sine transforms diagonalise the axis.
    pub(super) fn is_fast(&self) -> bool {
        self.is_uniform() && !self.is_mixed()
    }

    /// Refuses an axis without cells or with widths that are no lengths.
    pub(super) fn check(&self, axis: usize) -> Result<(), PoissonError> {
        if self.widths.is_empty() {
            return Err(PoissonError::NoCells { axis });
        }
        match self.widths.iter().find(|&&w| !(w > 0.0 && (w * w).is_normal())) {
            Some(&spacing) => Err(PoissonError::Spacing { axis, spacing }),
            None => Ok(()),
        }
    }

    /// Flux per difference of φ through each of the n + 1 faces \[1/m\]: 1/d_i inside, zero or 2/w at
    /// an end. On a periodic axis the first and the last face are the same one; with a single cell
    /// nothing flows through it.
    pub(super) fn conductances(&self) -> Vec<f64> {
        let (w, n) = (&self.widths, self.cells());
        let (low, high) = (2.0 / w[0], 2.0 / w[n - 1]);
        let (first, last) = match self.ends {
            AxisBounds::Periodic if n == 1 => (0.0, 0.0),
            AxisBounds::Periodic => (2.0 / (w[n - 1] + w[0]), 2.0 / (w[n - 1] + w[0])),
            AxisBounds::Neumann => (0.0, 0.0),
            AxisBounds::Dirichlet => (low, high),
            AxisBounds::NeumannDirichlet => (0.0, high),
            AxisBounds::DirichletNeumann => (low, 0.0),
        };
        let inner = w.windows(2).map(|w| 2.0 / (w[0] + w[1]));
        std::iter::once(first).chain(inner).chain(std::iter::once(last)).collect()
    }
}
