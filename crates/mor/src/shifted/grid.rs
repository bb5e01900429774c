//! Where the unknowns of a field are.
use super::ShiftedError;
use interfaces::{Point, Vector};

/// A uniform grid of one to three dimensions, periodic or not along each axis.
///
/// Cell (i, j, k) is row i + n_x (j + n_y k) of a field; its centre is at (i h_x, j h_y, k h_z) from that of the first cell. An axis
/// that is not there has one cell. On a periodic axis cell n is cell 0 again; beyond the ends of another one a field continues
/// with the value at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    cells: [usize; 3],
    spacing: [f64; 3],
    periodic: [bool; 3],
    first: Point,
}

impl Grid {
    /// Periodic along each axis, with so many cells of this width; the first cell's centre is the origin.
    ///
    /// # Errors
    /// [`ShiftedError::Axis`].
    pub fn new<const D: usize>(cells: [usize; D], spacing: [f64; D]) -> Result<Self, ShiftedError> {
        const { assert!(D >= 1 && D <= 3) };
        let mut grid = Self { cells: [1; 3], spacing: [1.0; 3], periodic: [true; 3], first: Point::origin() };
        for axis in 0..D {
            let (n, h) = (cells[axis], spacing[axis]);
            if n == 0 || !(h > 0.0 && h.is_finite()) {
                return Err(ShiftedError::Axis { axis, cells: n, spacing: h });
            }
            (grid.cells[axis], grid.spacing[axis]) = (n, h);
        }
        Ok(grid)
    }

    /// The same with ends along the axes told.
    #[must_use]
    pub fn bounded(mut self, axes: impl IntoIterator<Item = usize>) -> Self {
        axes.into_iter().for_each(|a| self.periodic[a] = false);
        self
    }

    /// The same with the first cell's centre elsewhere.
    #[must_use]
    pub fn starting_at(mut self, first: Point) -> Self {
        self.first = first;
        self
    }

    /// Cells along x, y, z.
    #[must_use]
    pub fn cells(&self) -> [usize; 3] {
        self.cells
    }

    /// Width of the cells along x, y, z.
    #[must_use]
    pub fn spacing(&self) -> [f64; 3] {
        self.spacing
    }

    /// Is it periodic along x, y, z?
    #[must_use]
    pub fn periodic(&self) -> [bool; 3] {
        self.periodic
    }

    /// The centre of the first cell.
    #[must_use]
    pub fn first(&self) -> Point {
        self.first
    }

    /// Cells in all.
    #[must_use]
    pub fn n_cells(&self) -> usize {
        self.cells.iter().product()
    }

    /// The centre of cell number `row`.
    #[must_use]
    pub fn centre(&self, row: usize) -> Point {
        let [nx, ny, _] = self.cells;
        let place = [row % nx, row / nx % ny, row / (nx * ny)];
        self.first + Vector::from_fn(|a, _| place[a] as f64 * self.spacing[a])
    }
}
