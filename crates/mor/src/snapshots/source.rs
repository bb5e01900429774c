//! A matrix of snapshots of which parts can be read.
use super::SnapshotError;
use crate::{Mat, MatRef};
use monomorphic::MatMut;

/// Snapshots, one column each, that need not be in memory.
pub trait SnapshotSource {
    /// Unknowns of a snapshot.
    fn n_rows(&self) -> usize;
    /// Snapshots.
    fn n_snapshots(&self) -> usize;

    /// Reads rows from `first_row` and snapshots from `first_snapshot` on, as many as `to` has.
    ///
    /// # Errors
    /// [`SnapshotError`]; [`SnapshotError::Outside`] if there are not so many.
    fn read(&self, first_row: usize, first_snapshot: usize, to: MatMut<'_, f64>)
    -> Result<(), SnapshotError>;

    /// All of it.
    ///
    /// # Errors
    /// Those of [`read`](Self::read).
    fn to_mat(&self) -> Result<Mat<f64>, SnapshotError> {
        let mut all = Mat::zeros(self.n_rows(), self.n_snapshots());
        self.read(0, 0, all.as_mut())?;
        Ok(all)
    }
}

/// Is that part there?
pub(super) fn check_part(
    there: [usize; 2],
    first: [usize; 2],
    to: &MatMut<'_, f64>,
) -> Result<(), SnapshotError> {
    let (rows, snapshots) = ([first[0], first[0] + to.nrows()], [first[1], first[1] + to.ncols()]);
    if rows[1] > there[0] || snapshots[1] > there[1] {
        return Err(SnapshotError::Outside { rows, snapshots, there });
    }
    Ok(())
}

impl SnapshotSource for MatRef<'_, f64> {
    fn n_rows(&self) -> usize {
        self.nrows()
    }
    fn n_snapshots(&self) -> usize {
        self.ncols()
    }
    fn read(
        &self,
        first_row: usize,
        first_snapshot: usize,
        mut to: MatMut<'_, f64>,
    ) -> Result<(), SnapshotError> {
        check_part([self.nrows(), self.ncols()], [first_row, first_snapshot], &to)?;
        let part = self.submatrix(first_row, first_snapshot, to.nrows(), to.ncols());
        to.copy_from(part);
        Ok(())
    }
}
