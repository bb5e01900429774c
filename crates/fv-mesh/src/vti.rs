//! Images of cell data for ParaView.
use crate::CartesianGrid;
use interfaces::vtk::{self, DataArray};
use std::io::{self, Write};

/// Collects cell fields of a grid and writes them as one `.vti` file (VTK image data, raw
/// appended, single precision).
pub struct ImageWriter<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    arrays: Vec<DataArray<'a>>,
}

impl<'a, const D: usize> ImageWriter<'a, D> {
    /// An image without fields.
    pub fn new(grid: &'a CartesianGrid<D>) -> Self {
        Self { grid, arrays: Vec::new() }
    }
    /// Adds a scalar: one value per cell, x fastest.
    #[must_use]
    pub fn scalar(mut self, name: &'a str, values: impl IntoIterator<Item = f64>) -> Self {
        self.arrays.push(DataArray::float32(name, 1, values));
        self
    }
    /// Adds a vector: the components of all cells, one iterator per component. A plane vector gets
    /// a third component of zero, as ParaView wants.
    #[must_use]
    pub fn vector<I: Iterator<Item = f64>>(mut self, name: &'a str, mut components: [I; D]) -> Self {
        let n = self.grid.n_cells();
        let values = (0..3 * n).map(|i| components.get_mut(i % 3).map_or(0.0, |c| c.next().unwrap_or(0.0)));
        self.arrays.push(DataArray::float32(name, 3, values));
        self
    }
    /// Writes the file.
    ///
    /// # Errors
    /// What the writer answers.
    pub fn write(self, out: &mut impl Write) -> io::Result<()> {
        let n: [usize; 3] = std::array::from_fn(|a| *self.grid.cells().get(a).unwrap_or(&1));
        let origin: [f64; 3] = std::array::from_fn(|a| *self.grid.origin().get(a).unwrap_or(&0.0));
        let h: [f64; 3] = std::array::from_fn(|a| *self.grid.spacing().get(a).unwrap_or(&1.0));
        // A plane image is one cell thick, about z = 0.
        let z = if D == 2 { -0.5 } else { origin[2] };
        let extent = format!("0 {} 0 {} 0 {}", n[0], n[1], n[2]);
        vtk::write(
            out,
            "ImageData",
            &format!(
                "WholeExtent=\"{extent}\" Origin=\"{} {} {z}\" Spacing=\"{} {} {}\"",
                origin[0], origin[1], h[0], h[1], h[2]
            ),
            &format!("Extent=\"{extent}\""),
            &[("CellData", "", self.arrays)],
        )
    }
}
