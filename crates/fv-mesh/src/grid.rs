//! The grid.
use crate::{Axis, FlowError, Sides};
use interfaces::{Lattice, Nodes};

/// Ghost layers around every field: what the widest convection scheme looks back.
pub(crate) const GHOSTS: usize = 2;

/// A box of cells, `D` = 2 or 3: the product of `D` [`Axis`]es, uniform or stretched. Cheap to clone.
#[derive(Clone, Debug, PartialEq)]
pub struct CartesianGrid<const D: usize> {
    axes: [Axis; D],
}

impl<const D: usize> CartesianGrid<D> {
    /// A box of `cells` equal cells with edges of `lengths` \[m\] and its lower corner at the origin.
    ///
    /// # Errors
    /// [`FlowError::Grid`] for another dimension than 2 or 3, no cells or a length that is not
    /// positive and finite.
    pub fn new(cells: [usize; D], lengths: [f64; D]) -> Result<Self, FlowError> {
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
        Self::check_size(cells)?;
        let mut axes = Vec::new();
        for a in 0..D {
            axes.push(Axis::uniform(cells[a], 0.0, lengths[a])?);
        }
        // As many as there are dimensions.
        let axes = axes.try_into().map_err(|_| FlowError::Grid { what: format!("{D} axes") })?;
        Self::from_axes(axes)
    }

    /// The box with these axes.
    ///
    /// # Errors
    /// [`FlowError::Grid`] for another dimension than 2 or 3, or more cells than memory can address.
    pub fn from_axes(axes: [Axis; D]) -> Result<Self, FlowError> {
        Self::check_size(std::array::from_fn(|a| axes[a].cells()))?;
        Ok(Self { axes })
    }

    fn check_size(cells: [usize; D]) -> Result<(), FlowError> {
        if !(2..=3).contains(&D) {
            return fail(format!("{D} dimensions; give 2 or 3"));
        }
        let bytes = cells.iter().try_fold(8_usize, |n, &c| n.checked_mul(c.checked_add(2 * GHOSTS)?));
        if bytes.is_none_or(|b| b > isize::MAX as usize) {
            return fail(format!("{cells:?} cells, more than memory can address"));
        }
        Ok(())
    }

    /// The same box with its lower corner at `origin` \[m\].
    ///
    /// # Errors
    /// [`FlowError::Grid`] if the faces there are not distinct finite numbers.
    pub fn with_origin(mut self, origin: [f64; D]) -> Result<Self, FlowError> {
        for a in 0..D {
            self.axes[a] = self.axes[a].moved(origin[a] - self.axes[a].lower())?;
        }
        Ok(self)
    }
    /// The same box moved by `window[a]` cells along every uniform axis a.
    pub(crate) fn slid(&self, window: [i64; D]) -> Result<Self, FlowError> {
        let mut slid = self.clone();
        for a in (0..D).filter(|&a| window[a] != 0) {
            slid.axes[a] = self.axes[a].slid(window[a])?;
        }
        Ok(slid)
    }
    /// Axis `a`.
    pub fn axis(&self, a: usize) -> &Axis {
        &self.axes[a]
    }
    /// Are all cells equal?
    pub fn is_uniform(&self) -> bool {
        self.axes.iter().all(Axis::is_uniform)
    }
    /// Cells along each axis.
    pub fn cells(&self) -> [usize; D] {
        std::array::from_fn(|a| self.axes[a].cells())
    }
    /// Number of cells.
    pub fn n_cells(&self) -> usize {
        self.cells().iter().product()
    }
    /// Lower corner \[m\].
    pub fn origin(&self) -> [f64; D] {
        std::array::from_fn(|a| self.axes[a].lower())
    }
    /// Edge lengths of the box \[m\].
    pub fn lengths(&self) -> [f64; D] {
        std::array::from_fn(|a| self.axes[a].length())
    }
    /// Mean edge lengths of a cell \[m\]: those of every cell if the grid is uniform.
    pub fn spacing(&self) -> [f64; D] {
        std::array::from_fn(|a| self.axes[a].mean_width())
    }
    /// Volume of cell (i, j, k) \[m³\]; area \[m²\] in a plane grid.
    pub fn cell_volume(&self, cell: [usize; D]) -> f64 {
        (0..D).map(|a| self.axes[a].width(cell[a])).product()
    }
    /// Centre of cell (i, j, k) \[m\].
    pub fn centre(&self, cell: [usize; D]) -> [f64; D] {
        std::array::from_fn(|a| self.axes[a].centre(cell[a]))
    }
    /// The cell that holds the point `x`; `None` outside.
    pub fn locate(&self, x: [f64; D]) -> Option<[usize; D]> {
        let mut cell = [0; D];
        for a in 0..D {
            cell[a] = self.axes[a].locate(x[a])?;
        }
        Some(cell)
    }
    /// Volume of the box \[m³\]; area \[m²\] in a plane grid.
    pub fn volume(&self) -> f64 {
        self.lengths().iter().product()
    }
    /// Number of cell (i, j, k) among dense values, x fastest.
    pub fn index(&self, cell: [usize; D]) -> usize {
        let n = self.cells();
        (0..D).rev().fold(0, |sum, a| sum * n[a] + cell[a])
    }
    /// The cell with this number among dense values, x fastest.
    pub fn cell(&self, mut index: usize) -> [usize; D] {
        self.cells().map(|n| {
            let i = index % n;
            index /= n;
            i
        })
    }

    /// Storage distance of neighbours along each axis.
    pub(crate) fn stride(&self) -> [usize; D] {
        let mut s = [1; D];
        for a in 1..D {
            s[a] = s[a - 1] * (self.axes[a - 1].cells() + 2 * GHOSTS);
        }
        s
    }
    /// Stored values of one field, ghosts included.
    pub(crate) fn storage(&self) -> usize {
        self.cells().iter().map(|c| c + 2 * GHOSTS).product()
    }
    /// Storage index of cell (0, 0, 0).
    pub(crate) fn base(&self) -> usize {
        self.stride().iter().map(|s| s * GHOSTS).sum()
    }
    /// Storage index of cell (i, j, k), which is also that of its lower faces.
    pub(crate) fn place(&self, cell: [usize; D]) -> usize {
        let s = self.stride();
        self.base() + (0..D).map(|a| cell[a] * s[a]).sum::<usize>()
    }
    /// The cell with this storage index; `None` for a ghost.
    pub(crate) fn cell_at(&self, place: usize) -> Option<[usize; D]> {
        let (mut rest, mut cell, s, n) = (place, [0; D], self.stride(), self.cells());
        for a in (0..D).rev() {
            cell[a] = (rest / s[a]).checked_sub(GHOSTS).filter(|&i| i < n[a])?;
            rest %= s[a];
        }
        Some(cell)
    }
    /// Rows along x in one layer of the last axis.
    pub(crate) fn rows_per_layer(&self) -> usize {
        self.cells()[1..D - 1].iter().product()
    }

    /// The lattice of the cell centres, or of the faces normal to axis `face` that carry an unknown:
    /// all but those on bounded sides.
    pub fn lattice(&self, face: Option<usize>, sides: &Sides<D>) -> Lattice {
        let stride = self.stride();
        let mut base = self.base();
        let axes = std::array::from_fn(|a| {
            let (axis, periodic) = (&self.axes[a], sides.periodic(a));
            let walled = usize::from(face == Some(a) && !periodic);
            base += walled * stride[a];
            match (face == Some(a), axis.is_uniform()) {
                (false, _) => axis.centres(periodic),
                (true, false) => Nodes::faces(axis.faces(), periodic),
                (true, true) => {
                    let (h, n) = (axis.mean_width(), axis.cells() - walled);
                    Nodes::uniform(axis.lower() + walled as f64 * h, h, n, periodic)
                }
            }
        });
        Lattice::new(axes, base, stride)
    }
}

fn fail<T>(what: String) -> Result<T, FlowError> {
    Err(FlowError::Grid { what })
}
