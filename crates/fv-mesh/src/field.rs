//! One scalar on the grid.
use crate::grid::GHOSTS;
use crate::{CartesianGrid, FlowError};

/// One scalar per cell (or per lower face of a cell), x fastest, with two ghost layers around.
#[derive(Clone, Debug)]
pub struct Field<const D: usize> {
    grid: CartesianGrid<D>,
    data: Vec<f64>,
}

impl<const D: usize> Field<D> {
    /// A field of zeros.
    pub fn zeros(grid: &CartesianGrid<D>) -> Self {
        Self { grid: grid.clone(), data: vec![0.0; grid.storage()] }
    }
    /// The grid it lives on.
    pub fn grid(&self) -> &CartesianGrid<D> {
        &self.grid
    }
    /// The same values on a grid of the same size.
    pub(crate) fn set_grid(&mut self, grid: &CartesianGrid<D>) {
        self.grid = grid.clone();
    }
    /// Takes `f(x)` at the cell centres x \[m\]; ghosts stay.
    pub fn set(&mut self, mut f: impl FnMut([f64; D]) -> f64) {
        let n = self.grid.cells();
        for r in 0..self.n_rows() {
            let o = self.row_start(r);
            for i in 0..n[0] {
                self.data[o + i] = f(self.grid.centre(self.grid.cell(r * n[0] + i)));
            }
        }
    }
    /// Is this a field on `grid`?
    ///
    /// # Errors
    /// [`FlowError::OtherGrid`] if it is not.
    pub(crate) fn check(&self, grid: &CartesianGrid<D>) -> Result<(), FlowError> {
        if self.grid == *grid {
            return Ok(());
        }
        Err(FlowError::OtherGrid { expected: grid.cells().to_vec(), found: self.grid.cells().to_vec() })
    }
    /// Stored values, ghosts included.
    pub fn data(&self) -> &[f64] {
        &self.data
    }
    /// Stored values, ghosts included, to change.
    pub fn data_mut(&mut self) -> &mut [f64] {
        &mut self.data
    }
    /// The layers of the last axis without its ghost layers, each `stride` long.
    pub(crate) fn layers_mut(&mut self) -> &mut [f64] {
        let (range, _) = self.layer_range();
        &mut self.data[range]
    }
    pub(crate) fn layer_range(&self) -> (std::ops::Range<usize>, usize) {
        let stride = self.grid.stride()[D - 1];
        (GHOSTS * stride..(GHOSTS + self.grid.cells()[D - 1]) * stride, stride)
    }
    /// Storage index of the first cell of row `r` along x, r = j + n_y k.
    pub(crate) fn row_start(&self, r: usize) -> usize {
        row_start(&self.grid, r)
    }
    /// The cells of row `r` along x, r = j + n_y k.
    pub fn row(&self, r: usize) -> &[f64] {
        let o = self.row_start(r);
        &self.data[o..o + self.grid.cells()[0]]
    }
    /// Number of rows along x.
    pub fn n_rows(&self) -> usize {
        self.grid.n_cells() / self.grid.cells()[0]
    }
    /// All cells, row after row, without ghosts.
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.n_rows()).flat_map(|r| self.row(r).iter().copied())
    }
}

/// Storage index of the first cell of row `r` along x.
pub(crate) fn row_start<const D: usize>(grid: &CartesianGrid<D>, r: usize) -> usize {
    let (stride, per_layer) = (grid.stride(), grid.rows_per_layer());
    let inner = if D == 3 { (r % per_layer) * stride[1] } else { 0 };
    grid.base() + (r / per_layer) * stride[D - 1] + inner
}
