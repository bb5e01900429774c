//! Rows and columns in other units.
use super::super::error::check_length;
use super::super::{LinearError, LinearOperator};
use super::StencilMatrix;

impl<const D: usize> StencilMatrix<D> {
    /// a_PN becomes `rows`_P a_PN `columns`_N.
    ///
    /// # Errors
    /// [`LinearError::Shape`].
    pub fn scale(&mut self, rows: &[f64], columns: &[f64]) -> Result<(), LinearError> {
        check_length("the factors of rows", self.n(), rows.len())?;
        check_length("the factors of columns", self.n(), columns.len())?;
        for run in self.spans.clone().rows(self.cells[0], self.rows()) {
            multiply(&mut self.centre[run.clone()], &rows[run.clone()], &columns[run]);
        }
        let mut stride = 1;
        for axis in 0..D {
            let n = self.cells[axis];
            // Along the whole axis but for one end the neighbour is one stride away.
            let inner = (n - 1) * stride;
            for start in (0..rows.len()).step_by(n * stride) {
                let (low, high) = (start + stride, start + inner);
                let lower = &mut self.lower[axis];
                multiply(&mut lower[low..][..inner], &rows[low..][..inner], &columns[start..][..inner]);
                multiply(&mut lower[start..][..stride], &rows[start..][..stride], &columns[high..][..stride]);
                let upper = &mut self.upper[axis];
                multiply(&mut upper[start..][..inner], &rows[start..][..inner], &columns[low..][..inner]);
                multiply(&mut upper[high..][..stride], &rows[high..][..stride], &columns[start..][..stride]);
            }
            stride *= n;
        }
        Ok(())
    }
}

fn multiply(a: &mut [f64], rows: &[f64], columns: &[f64]) {
    for ((a, row), column) in a.iter_mut().zip(rows).zip(columns) {
        *a *= row * column;
    }
}
