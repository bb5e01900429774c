//! Fields between the centres of their cells.
use super::axis::{Axis, Side};
use super::{Grid, Interpolation};
use interfaces::Vector;

/// Shifts fields on a grid. Nothing is stored but factors along the axes.
///
/// A field is a slice of one value per cell, or of several components one after the other.
pub struct FieldShift {
    grid: Grid,
    axes: [Axis; 3],
}

impl FieldShift {
    /// On this grid.
    #[must_use]
    pub fn new(grid: Grid, interpolation: Interpolation) -> Self {
        let axis = |a: usize| Axis::new(grid.cells()[a], grid.periodic()[a], interpolation);
        Self { axes: [0, 1, 2].map(axis), grid }
    }

    /// Of these fields.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// T^s q, that is q(x − s).
    ///
    /// # Panics
    /// If `q` is not a whole number of fields.
    #[must_use]
    pub fn shift(&self, s: Vector, q: &[f64]) -> Vec<f64> {
        self.translate(s, Side::Operator, q)
    }

    /// (T^s)ᵀ q.
    ///
    /// # Panics
    /// If `q` is not a whole number of fields.
    #[must_use]
    pub fn shift_transposed(&self, s: Vector, q: &[f64]) -> Vec<f64> {
        self.translate(s, Side::Transpose, q)
    }

    fn translate(&self, s: Vector, side: Side, q: &[f64]) -> Vec<f64> {
        let cells = self.grid.cells();
        assert!(q.len().is_multiple_of(self.grid.n_cells()), "not a whole number of fields");
        let mut data = q.to_vec();
        // The operators along the axes commute.
        for (a, axis) in self.axes.iter().enumerate() {
            let s = s[a] / self.grid.spacing()[a];
            if s != 0.0 && cells[a] > 1 {
                axis.shift(s, side, cells[..a].iter().product(), &mut data);
            }
        }
        data
    }
}
