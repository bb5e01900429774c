//! Order of the cells of a grid in NumPy's arrays.
use super::{NpyArray, SnapshotAxis, SnapshotError};

impl NpyArray {
    /// The same, checked to have the rows of a [`Grid`](crate::shifted::Grid) of these cells: x
    /// fastest, then y, z, and the components of a vector one field below the other.
    ///
    /// The axes but that of the snapshots, from the fastest in memory, must be n_x, n_y, n_z, then
    /// those of components; axes of length 1 count as none. Neither axes of equal length nor cells
    /// that are one axis (`reshape`) tell their order: these are taken as given.
    ///
    /// # Errors
    /// [`SnapshotError::CellOrder`] with the NumPy command that writes the array in this order, if
    /// an order of its axes has these cells.
    pub fn on_cells<const D: usize>(self, cells: [usize; D]) -> Result<Self, SnapshotError> {
        let order = self.order(self.axis);
        if self.fits(&order, &cells) {
            return Ok(self);
        }
        let (shape, axis) = (&self.shape, self.axis);
        let lengths: Vec<usize> = order.iter().map(|&axis| shape[axis]).collect();
        let found = format!(
            "the array of shape {shape:?} read with `SnapshotAxis::{axis:?}` has {lengths:?}, fastest first"
        );
        let remedy = self.remedy(&cells);
        Err(SnapshotError::CellOrder { path: self.path, cells: cells.to_vec(), found, remedy })
    }

    /// The axes but that of the snapshots, from the fastest in memory.
    fn order(&self, axis: SnapshotAxis) -> Vec<usize> {
        let snapshots = self.snapshot_axis(axis);
        let axes = (0..self.shape.len()).filter(|&axis| Some(axis) != snapshots);
        if self.fortran { axes.collect() } else { axes.rev().collect() }
    }

    /// `None` if the array is one snapshot.
    fn snapshot_axis(&self, axis: SnapshotAxis) -> Option<usize> {
        match axis {
            SnapshotAxis::First => (!self.shape.is_empty()).then_some(0),
            SnapshotAxis::Last => (self.shape.len() > 1).then(|| self.shape.len() - 1),
        }
    }

    fn fits(&self, order: &[usize], cells: &[usize]) -> bool {
        let several =
            |lengths: &mut dyn Iterator<Item = usize>| lengths.filter(|&n| n != 1).collect::<Vec<_>>();
        let lengths = several(&mut order.iter().map(|&axis| self.shape[axis]));
        let flat =
            matches!(lengths[..], [rows] if rows.is_multiple_of(cells.iter().product::<usize>().max(1)));
        flat || lengths.starts_with(&several(&mut cells.iter().copied()))
    }

    /// Command that makes the array fit, or advice if none does.
    fn remedy(&self, cells: &[usize]) -> String {
        let other = match self.axis {
            SnapshotAxis::First => SnapshotAxis::Last,
            SnapshotAxis::Last => SnapshotAxis::First,
        };
        let found = match self.transposition(self.axis, cells) {
            None if self.fits(&self.order(other), cells) => {
                return format!("open it with `SnapshotAxis::{other:?}`");
            }
            None => self.transposition(other, cells),
            found => found,
        };
        match found {
            Some(axes) => {
                let axes: Vec<String> = axes.iter().map(ToString::to_string).collect();
                let transposed = format!("a.transpose({})", axes.join(", "));
                format!(
                    "save `np.ascontiguousarray({transposed})` of this array a, and open it with `SnapshotAxis::First`"
                )
            }
            None => "no order of its axes has these cells: check the cells, and which axis counts snapshots"
                .into(),
        }
    }

    /// Axes in the order snapshots, components, z, y, x; later axes of equal length are those of
    /// lower dimensions.
    fn transposition(&self, axis: SnapshotAxis, cells: &[usize]) -> Option<Vec<usize>> {
        let snapshots = self.snapshot_axis(axis)?;
        let mut left: Vec<usize> = (0..self.shape.len()).filter(|&axis| axis != snapshots).collect();
        let mut fastest = Vec::new();
        for &n in cells.iter().filter(|&&n| n != 1) {
            fastest.push(left.remove(left.iter().rposition(|&axis| self.shape[axis] == n)?));
        }
        Some([snapshots].into_iter().chain(left).chain(fastest.into_iter().rev()).collect())
    }
}

#[cfg(test)]
mod tests;
