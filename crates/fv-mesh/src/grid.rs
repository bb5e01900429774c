//! The grid.
use crate::{FlowError, Sides};
use interfaces::Lattice;

/// Ghost layers around every field.
pub(crate) const GHOSTS: usize = 1;

/// A box of equal cells, `D` = 2 or 3. Cell (i, j, k) has its lower corner at origin + (i, j, k)·h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CartesianGrid<const D: usize> {
    cells: [usize; D],
    origin: [f64; D],
    lengths: [f64; D],
}

impl<const D: usize> CartesianGrid<D> {
    /// A box of `cells` cells with edges of `lengths` \[m\] and its lower corner at the origin.
    ///
    /// # Errors
    /// [`FlowError::Grid`] for another dimension than 2 or 3, no cells or a length that is not
    /// positive and finite.
    pub fn new(cells: [usize; D], lengths: [f64; D]) -> Result<Self, FlowError> {
        let fail = |what: String| Err(FlowError::Grid { what });
        if !(2..=3).contains(&D) {
            return fail(format!("{D} dimensions; give 2 or 3"));
        }
        for a in 0..D {
            if cells[a] == 0 {
                return fail(format!("no cells along axis {a}; give at least 1"));
            }
            if !(lengths[a].is_finite() && lengths[a] > 0.0) {
                return fail(format!(
                    "a length of {} m along axis {a}; give a positive, finite one",
                    lengths[a]
                ));
            }
        }
        let bytes = cells.iter().try_fold(8_usize, |n, &c| n.checked_mul(c.checked_add(2 * GHOSTS)?));
        if bytes.is_none_or(|b| b > isize::MAX as usize) {
            return fail(format!("{cells:?} cells, more than memory can address"));
        }
        Ok(Self { cells, origin: [0.0; D], lengths })
    }
    /// The same box with its lower corner at `origin` \[m\].
    #[must_use]
    pub fn with_origin(mut self, origin: [f64; D]) -> Self {
        self.origin = origin;
        self
    }
    /// Cells along each axis.
    pub fn cells(&self) -> [usize; D] {
        self.cells
    }
    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.cells.iter().product()
    }
    /// Lower corner \[m\].
    pub fn origin(&self) -> [f64; D] {
        self.origin
    }
    /// Edge lengths of the box \[m\].
    pub fn lengths(&self) -> [f64; D] {
        self.lengths
    }
    /// Edge lengths of a cell \[m\].
    pub fn spacing(&self) -> [f64; D] {
        std::array::from_fn(|a| self.lengths[a] / self.cells[a] as f64)
    }
    /// Volume of a cell \[m³\]; area \[m²\] in a plane grid.
    pub fn cell_volume(&self) -> f64 {
        self.spacing().iter().product()
    }
    /// Volume of the box \[m³\]; area \[m²\] in a plane grid.
    pub fn volume(&self) -> f64 {
        self.lengths.iter().product()
    }

    /// Storage distance of neighbours along each axis.
    pub(crate) fn stride(&self) -> [usize; D] {
        let mut s = [1; D];
        for a in 1..D {
            s[a] = s[a - 1] * (self.cells[a - 1] + 2 * GHOSTS);
        }
        s
    }
    /// Stored values of one field, ghosts included.
    pub(crate) fn storage(&self) -> usize {
        self.cells.iter().map(|c| c + 2 * GHOSTS).product()
    }
    /// Storage index of cell (0, 0, 0).
    pub(crate) fn base(&self) -> usize {
        self.stride().iter().map(|s| s * GHOSTS).sum()
    }
    /// Rows along x in one layer of the last axis.
    pub(crate) fn rows_per_layer(&self) -> usize {
        self.cells[1..D - 1].iter().product()
    }

    /// The lattice of the cell centres, or of the faces normal to axis `face` that carry an unknown:
    /// all but those on bounded sides.
    pub fn lattice(&self, face: Option<usize>, sides: &Sides<D>) -> Lattice {
        let (h, stride) = (self.spacing(), self.stride());
        let mut l = Lattice {
            dim: D,
            origin: [0.0; 3],
            spacing: [1.0; 3],
            shape: [1; 3],
            periodic: [false; 3],
            base: self.base(),
            stride: [0; 3],
        };
        for a in 0..D {
            l.spacing[a] = h[a];
            l.periodic[a] = sides.periodic(a);
            l.stride[a] = stride[a];
            let walled = usize::from(face == Some(a) && !l.periodic[a]);
            let shift = if face == Some(a) { walled as f64 } else { 0.5 };
            l.origin[a] = self.origin[a] + shift * h[a];
            l.shape[a] = self.cells[a] - walled;
            l.base += walled * stride[a];
        }
        l
    }
}
