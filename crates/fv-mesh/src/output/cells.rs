//! The writer of cell fields.
use super::{Arrays, OutputError, Precision, unstructured, write_cells};
use crate::CartesianGrid;
use std::io::Write;

/// Collects cell fields of a grid and writes them as one VTK XML file, raw appended: an image (`.vti`) of a uniform
/// grid, a rectilinear grid (`.vtr`) of a stretched one, an unstructured grid (`.vtu`) of chosen cells.
/// [`extension`](Self::extension) tells which. The cells of a plane grid are one metre thick about z = 0 in images and
/// rectilinear grids, quadrilaterals in z = 0 in unstructured ones.
///
/// ```
/// use fv_mesh::{CartesianGrid, CellWriter, Field};
///
/// let grid = CartesianGrid::new([4, 2], [1.0, 1.0])?;
/// let p = Field::from_fn(&grid, |x| x[0]);
/// let mut file = Vec::new();
/// let writer = CellWriter::new(&grid).double_precision().scalar("p", p.values());
/// assert_eq!(writer.extension(), "vti");
/// writer.write(&mut file)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct CellWriter<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    /// The cells to write, if not all.
    keep: Option<Vec<bool>>,
    precision: Precision,
    arrays: Arrays<'a>,
    /// What went wrong first.
    error: Option<OutputError>,
}

impl<'a, const D: usize> CellWriter<'a, D> {
    /// All cells, no fields yet, single precision.
    pub fn new(grid: &'a CartesianGrid<D>) -> Self {
        Self { grid, keep: None, precision: Precision::Single, arrays: Arrays::new(), error: None }
    }

    /// The cells (i, j, k) of which `keep` holds, as an unstructured grid.
    pub fn of_cells(grid: &'a CartesianGrid<D>, keep: impl Fn([usize; D]) -> bool) -> Self {
        let keep = (0..grid.n_cells()).map(|i| keep(grid.cell(i))).collect();
        Self { keep: Some(keep), ..Self::new(grid) }
    }

    /// The cells whose centres are in the box from `lower` to `upper` \[m\], as an unstructured grid.
    pub fn in_box(grid: &'a CartesianGrid<D>, lower: [f64; D], upper: [f64; D]) -> Self {
        Self::of_cells(grid, |cell| {
            let x = grid.centre(cell);
            (0..D).all(|a| lower[a] <= x[a] && x[a] <= upper[a])
        })
    }

    /// What is added from here on is written in double precision.
    #[must_use]
    pub fn double_precision(mut self) -> Self {
        self.precision = Precision::Double;
        self
    }

    /// Adds a scalar: one value per cell of the grid (chosen or not), x fastest.
    #[must_use]
    pub fn scalar(mut self, name: &'a str, values: impl IntoIterator<Item = f64>) -> Self {
        self.add(name, 1, [values]);
        self
    }

    /// Adds a vector: the components of all cells of the grid, one iterator per component. A plane vector gets a
    /// third component of zero, as ParaView wants.
    #[must_use]
    pub fn vector<I: IntoIterator<Item = f64>>(mut self, name: &'a str, components: [I; D]) -> Self {
        self.add(name, 3, components);
        self
    }

    fn add<I: IntoIterator<Item = f64>, const N: usize>(
        &mut self,
        name: &'a str,
        components: usize,
        parts: [I; N],
    ) {
        if self.error.is_none() {
            let cells = self.grid.n_cells();
            let keep = self.keep.as_deref();
            self.error = self.arrays.add(name, components, cells, self.precision, keep, parts).err();
        }
    }

    /// The extension of the file's name: `vti`, `vtr` or `vtu`.
    pub fn extension(&self) -> &'static str {
        match (&self.keep, self.grid.is_uniform()) {
            (Some(_), _) => "vtu",
            (None, true) => "vti",
            (None, false) => "vtr",
        }
    }

    /// Writes the file.
    ///
    /// # Errors
    /// [`OutputError::Count`] if an array has more or fewer values than the grid has cells, [`OutputError::Name`] for
    /// names that are empty or come twice, [`OutputError::Range`] for a value beyond single precision; nothing is
    /// written then. [`OutputError::Io`] for what the writer answers.
    pub fn write(self, out: &mut impl Write) -> Result<(), OutputError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        if let Some(keep) = self.keep {
            return unstructured::write(out, self.grid, &keep, self.arrays);
        }
        let depth = [-0.5, 0.5];
        let faces = std::array::from_fn(|a| if a < D { self.grid.axis(a).faces() } else { &depth[..] });
        write_cells(out, faces, self.grid.is_uniform(), self.arrays)
    }
}
