//! A sparse matrix whose pattern is fixed.
use super::error::check_length;
use super::{GaussSeidelSweep, LinearError, LinearOperator, Sweep};
use crate::parts::each_part;
use sprs::CsMat;
use std::cmp::Ordering;

/// Rows that one task works on.
const ROWS: usize = 2048;

/// A square matrix in compressed rows with a fixed pattern, whose values are rewritten in place.
///
/// The pattern always holds the diagonal and, with (i, j), also (j, i). Row P of the system A x = b reads
/// a_P x_P + Σ_N a_N x_N = b_P.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    rows: CsMat<f64>,
    /// Place of each row's diagonal among the values.
    diagonal: Vec<usize>,
}

impl Matrix {
    /// Zeros at the given places (row, column) of a matrix of `n` unknowns, at their mirror images and on the
    /// diagonal; repeated places count once.
    ///
    /// # Errors
    /// [`LinearError::Pattern`] for a place outside the matrix.
    pub fn from_pattern(
        n: usize,
        places: impl IntoIterator<Item = (usize, usize)>,
    ) -> Result<Self, LinearError> {
        let mut columns: Vec<Vec<usize>> = (0..n).map(|row| vec![row]).collect();
        for (row, col) in places {
            if row >= n || col >= n {
                return Err(LinearError::Pattern { row, col, n });
            }
            columns[row].push(col);
            columns[col].push(row);
        }
        let mut starts = Vec::with_capacity(n + 1);
        let mut indices = Vec::new();
        let mut diagonal = Vec::with_capacity(n);
        starts.push(0);
        for (row, mut columns) in columns.into_iter().enumerate() {
            columns.sort_unstable();
            columns.dedup();
            diagonal.push(indices.len() + columns.partition_point(|&c| c < row));
            indices.extend(columns);
            starts.push(indices.len());
        }
        let values = vec![0.0; indices.len()];
        Ok(Self { rows: CsMat::new((n, n), starts, indices, values), diagonal })
    }

    /// The sum of the triplets (row, column, value), with the pattern of [`from_pattern`](Self::from_pattern).
    ///
    /// # Errors
    /// [`LinearError::Pattern`] for a place outside the matrix.
    pub fn from_triplets(n: usize, triplets: &[(usize, usize, f64)]) -> Result<Self, LinearError> {
        let mut matrix = Self::from_pattern(n, triplets.iter().map(|&(row, col, _)| (row, col)))?;
        for &(row, col, value) in triplets {
            matrix.add(row, col, value)?;
        }
        Ok(matrix)
    }

    /// The values of a square matrix of either storage, with the pattern of [`from_pattern`](Self::from_pattern).
    ///
    /// # Errors
    /// [`LinearError::Shape`] if it is not square.
    pub fn from_sprs(matrix: &CsMat<f64>) -> Result<Self, LinearError> {
        check_length("the number of columns", matrix.rows(), matrix.cols())?;
        let triplets: Vec<_> = matrix.iter().map(|(&value, (row, col))| (row, col, value)).collect();
        Self::from_triplets(matrix.rows(), &triplets)
    }

    /// The storage: compressed rows with sorted columns.
    pub fn as_sprs(&self) -> &CsMat<f64> {
        &self.rows
    }

    /// The values in the order of [`as_sprs`](Self::as_sprs), to rewrite.
    pub fn values_mut(&mut self) -> &mut [f64] {
        self.rows.data_mut()
    }

    /// Starts of the rows, columns and values.
    pub(super) fn parts(&self) -> (&[usize], &[usize], &[f64]) {
        // The storage is built here, so that its rows start at zero.
        (self.rows.indptr().into_raw_storage(), self.rows.indices(), self.rows.data())
    }

    /// Place of each row's diagonal among the values.
    pub(super) fn diagonal_slots(&self) -> &[usize] {
        &self.diagonal
    }

    /// Columns and values of a row.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn row(&self, row: usize) -> (&[usize], &[f64]) {
        let (starts, columns, values) = self.parts();
        let range = starts[row]..starts[row + 1];
        (&columns[range.clone()], &values[range])
    }

    /// Place of entry (row, col) among the values, to look up once and write to often.
    ///
    /// # Errors
    /// [`LinearError::Pattern`] if the pattern lacks the entry.
    pub fn slot(&self, row: usize, col: usize) -> Result<usize, LinearError> {
        let missing = LinearError::Pattern { row, col, n: self.n() };
        if row >= self.n() {
            return Err(missing);
        }
        match self.row(row).0.binary_search(&col) {
            Ok(place) => Ok(self.parts().0[row] + place),
            Err(_) => Err(missing),
        }
    }

    /// Sets every value to zero.
    pub fn clear(&mut self) {
        self.values_mut().fill(0.0);
    }

    /// Adds to entry (row, col).
    ///
    /// # Errors
    /// [`LinearError::Pattern`] if the pattern lacks the entry.
    pub fn add(&mut self, row: usize, col: usize, value: f64) -> Result<(), LinearError> {
        let slot = self.slot(row, col)?;
        self.values_mut()[slot] += value;
        Ok(())
    }

    /// a_P of a row.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn diagonal(&self, row: usize) -> f64 {
        self.rows.data()[self.diagonal[row]]
    }

    /// Writes a_P of all rows.
    ///
    /// # Errors
    /// [`LinearError::Shape`].
    pub fn write_diagonal(&self, out: &mut [f64]) -> Result<(), LinearError> {
        check_length("the diagonal", self.n(), out.len())?;
        for (out, &slot) in out.iter_mut().zip(&self.diagonal) {
            *out = self.rows.data()[slot];
        }
        Ok(())
    }

    /// Under-relaxation (Patankar 1980): a_P becomes a_P/α and b gains (1 − α)/α a_P x, with the last x.
    ///
    /// # Errors
    /// [`LinearError::Parameter`] unless 0 < α ≤ 1; [`LinearError::Shape`].
    pub fn under_relax(&mut self, alpha: f64, x: &[f64], b: &mut [f64]) -> Result<(), LinearError> {
        check_fraction("the relaxation factor", alpha)?;
        check_length("x", self.n(), x.len())?;
        check_length("b", self.n(), b.len())?;
        let values = self.rows.data_mut();
        for ((&slot, x), b) in self.diagonal.iter().zip(x).zip(b) {
            let relaxed = values[slot] / alpha;
            *b += (1.0 - alpha) * relaxed * x;
            values[slot] = relaxed;
        }
        Ok(())
    }

    /// Fixes an unknown: its row becomes a_P x_P = a_P `value`, where a_P stays unless it vanishes (then 1).
    ///
    /// # Errors
    /// [`LinearError::Pattern`] if there is no such row; [`LinearError::NonFinite`], [`LinearError::Shape`].
    pub fn pin(&mut self, row: usize, value: f64, b: &mut [f64]) -> Result<(), LinearError> {
        self.blend(row, 1.0, value, b)
    }

    /// As [`pin`](Self::pin), and takes the known value out of the other rows, b_N −= a_NP `value`, so that a
    /// symmetric matrix stays symmetric.
    ///
    /// # Errors
    /// As [`pin`](Self::pin).
    pub fn pin_symmetric(&mut self, row: usize, value: f64, b: &mut [f64]) -> Result<(), LinearError> {
        self.pin(row, value, b)?;
        for place in self.parts().0[row]..self.parts().0[row + 1] {
            let other = self.rows.indices()[place];
            if other != row {
                let slot = self.slot(other, row)?;
                b[other] -= self.rows.data()[slot] * value;
                self.values_mut()[slot] = 0.0;
            }
        }
        Ok(())
    }

    /// Mixes a row with x_P = `value`: its neighbours and b are weighted by 1 − `weight`, and b gains
    /// `weight` a_P `value`. Weight 1 is [`pin`](Self::pin).
    ///
    /// # Errors
    /// [`LinearError::Parameter`] unless 0 ≤ weight ≤ 1; else as [`pin`](Self::pin).
    pub fn blend(&mut self, row: usize, weight: f64, value: f64, b: &mut [f64]) -> Result<(), LinearError> {
        check_blend(weight, row, value)?;
        check_length("b", self.n(), b.len())?;
        let slot = self.slot(row, row)?;
        let (start, end) = (self.parts().0[row], self.parts().0[row + 1]);
        let values = self.rows.data_mut();
        if values[slot] == 0.0 && weight > 0.0 {
            values[slot] = 1.0;
        }
        let centre = values[slot];
        for value in &mut values[start..end] {
            *value *= 1.0 - weight;
        }
        values[slot] = centre;
        b[row] = (1.0 - weight) * b[row] + weight * centre * value;
        Ok(())
    }

    /// H(x) = b − Σ_N a_N x_N: what the neighbours and b leave for a_P x_P.
    ///
    /// # Errors
    /// [`LinearError::Shape`].
    pub fn h(&self, b: &[f64], x: &[f64], out: &mut [f64]) -> Result<(), LinearError> {
        for (what, length) in [("b", b.len()), ("x", x.len()), ("H", out.len())] {
            check_length(what, self.n(), length)?;
        }
        self.for_rows(out, |row, columns, values| {
            let mut sum = b[row];
            for (&col, value) in columns.iter().zip(values) {
                sum -= if col == row { 0.0 } else { value * x[col] };
            }
            sum
        });
        Ok(())
    }

    /// `out[row] = f(row, columns, values)`.
    fn for_rows(&self, out: &mut [f64], f: impl Fn(usize, &[usize], &[f64]) -> f64 + Sync) {
        let (starts, columns, values) = self.parts();
        let run = |first: usize, out: &mut [f64]| {
            let starts = &starts[first..=first + out.len()];
            for (k, out) in out.iter_mut().enumerate() {
                let range = starts[k]..starts[k + 1];
                *out = f(first + k, &columns[range.clone()], &values[range]);
            }
        };
        if out.len() <= ROWS {
            return run(0, out);
        }
        each_part(out, ROWS, &|task, out| run(task * ROWS, out));
    }

    /// Smallest a_P − Σ_N |a_N| over a_P: not negative if the matrix is diagonally dominant by rows.
    /// Not finite if an entry is not or a diagonal vanishes.
    pub fn dominance(&self) -> f64 {
        (0..self.n())
            .map(|row| {
                let (columns, values) = self.row(row);
                let others: f64 =
                    columns.iter().zip(values).filter(|(c, _)| **c != row).map(|(_, v)| v.abs()).sum();
                1.0 - others / self.diagonal(row).abs()
            })
            .fold(f64::INFINITY, smallest)
    }

    /// Whether a_P > 0, a_N ≤ 0 and every row is diagonally dominant to round-off: sufficient, with one row strictly
    /// so, for an M-matrix, whose solutions of positive b are positive.
    pub fn is_m_matrix(&self) -> bool {
        let signs = (0..self.n()).all(|row| {
            let (columns, values) = self.row(row);
            columns.iter().zip(values).all(|(c, v)| if *c == row { *v > 0.0 } else { *v <= 0.0 })
        });
        signs && self.dominance() >= -1e-12
    }
}

/// The smaller one; NaN stays.
pub(super) fn smallest(a: f64, b: f64) -> f64 {
    match a.partial_cmp(&b) {
        Some(Ordering::Greater) => b,
        Some(_) => a,
        None => f64::NAN,
    }
}

/// Checks 0 < fraction ≤ 1.
pub(super) fn check_fraction(name: &'static str, value: f64) -> Result<(), LinearError> {
    if value > 0.0 && value <= 1.0 {
        Ok(())
    } else {
        Err(LinearError::Parameter { name, value, range: "above 0 and at most 1" })
    }
}

/// Checks what a row is blended with.
pub(super) fn check_blend(weight: f64, row: usize, value: f64) -> Result<(), LinearError> {
    if !(0.0..=1.0).contains(&weight) {
        return Err(LinearError::Parameter { name: "the weight", value: weight, range: "from 0 to 1" });
    }
    if !value.is_finite() {
        return Err(LinearError::NonFinite { what: "the pinned value", row, value });
    }
    Ok(())
}

impl LinearOperator for Matrix {
    fn n(&self) -> usize {
        self.diagonal.len()
    }
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.for_rows(y, |_, columns, values| columns.iter().zip(values).map(|(&col, v)| v * x[col]).sum());
    }
    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        self.for_rows(r, |row, columns, values| {
            columns.iter().zip(values).fold(b[row], |sum, (&col, v)| sum - v * x[col])
        });
    }
}

impl GaussSeidelSweep for Matrix {
    fn check_diagonal(&self) -> Result<(), LinearError> {
        for row in 0..self.n() {
            let value = self.diagonal(row);
            if !(value.is_finite() && value.recip().is_finite()) {
                return Err(LinearError::ZeroPivot { row, value });
            }
        }
        Ok(())
    }

    fn sweep(&self, sweep: Sweep, b: &[f64], x: &mut [f64], _: &mut [f64]) {
        let (starts, columns, values) = self.parts();
        let update = |row: usize, x: &mut [f64]| {
            let range = starts[row]..starts[row + 1];
            let mut sum = b[row];
            for (&col, v) in columns[range.clone()].iter().zip(&values[range]) {
                sum -= v * x[col];
            }
            x[row] += sum / values[self.diagonal[row]];
        };
        match sweep {
            Sweep::Forward => (0..self.n()).for_each(|row| update(row, x)),
            Sweep::Backward => (0..self.n()).rev().for_each(|row| update(row, x)),
        }
    }
}
