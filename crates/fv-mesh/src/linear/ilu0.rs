//! Incomplete factors without fill-in.
use super::error::check_length;
use super::{LinearError, LinearOperator, Matrix, Preconditioner};

/// ILU(0) (Meijerink & van der Vorst 1977): A ≈ L U with unit lower L and upper U in the pattern of A. Exact where
/// elimination makes no fill-in, such as tridiagonal matrices.
///
/// The factors are solved row by row, on one thread.
#[derive(Clone, Debug)]
pub struct Ilu0 {
    starts: Vec<usize>,
    columns: Vec<usize>,
    diagonal: Vec<usize>,
    /// L below the diagonal, U above it, and the inverse of U's diagonal.
    factors: Vec<f64>,
    /// Place of a column in the row at work.
    place: Vec<usize>,
}

const NOWHERE: usize = usize::MAX;
/// Smallest pivot over the largest entry of its row.
const SMALLEST_PIVOT: f64 = 1e-14;

impl Ilu0 {
    /// Analyses the pattern and factorises.
    ///
    /// # Errors
    /// As [`refactor`](Self::refactor).
    pub fn new(matrix: &Matrix) -> Result<Self, LinearError> {
        let (starts, columns, values) = matrix.parts();
        let mut ilu = Self {
            starts: starts.to_vec(),
            columns: columns.to_vec(),
            diagonal: matrix.diagonal_slots().to_vec(),
            factors: values.to_vec(),
            place: vec![NOWHERE; matrix.n()],
        };
        ilu.refactor(matrix)?;
        Ok(ilu)
    }

    /// Factorises new values of the same pattern in place.
    ///
    /// # Errors
    /// [`LinearError::ZeroPivot`]: the factors are unusable then until a refactorisation succeeds (they give zeros).
    /// [`LinearError::PatternChanged`]: the factors stay.
    pub fn refactor(&mut self, matrix: &Matrix) -> Result<(), LinearError> {
        let (starts, columns, values) = matrix.parts();
        if starts != self.starts || columns != self.columns {
            return Err(LinearError::PatternChanged { expected: self.columns.len(), found: columns.len() });
        }
        self.factors.copy_from_slice(values);
        let result = self.eliminate();
        if result.is_err() {
            self.factors.fill(0.0);
            self.place.fill(NOWHERE);
        }
        result
    }

    fn eliminate(&mut self) -> Result<(), LinearError> {
        let Self { starts, columns, diagonal, factors, place } = self;
        for row in 0..diagonal.len() {
            let range = starts[row]..starts[row + 1];
            let largest = factors[range.clone()].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            for slot in range.clone() {
                place[columns[slot]] = slot;
            }
            for slot in range.start..diagonal[row] {
                let pivot_row = columns[slot];
                let factor = factors[slot] * factors[diagonal[pivot_row]];
                factors[slot] = factor;
                for upper in diagonal[pivot_row] + 1..starts[pivot_row + 1] {
                    let target = place[columns[upper]];
                    if target != NOWHERE {
                        factors[target] -= factor * factors[upper];
                    }
                }
            }
            for slot in range {
                place[columns[slot]] = NOWHERE;
            }
            let pivot = factors[diagonal[row]];
            if !(pivot.is_finite() && pivot.abs() > SMALLEST_PIVOT * largest && pivot.recip().is_finite()) {
                return Err(LinearError::ZeroPivot { row, value: pivot });
            }
            factors[diagonal[row]] = pivot.recip();
        }
        Ok(())
    }

    /// Solves L U z = r.
    ///
    /// # Errors
    /// [`LinearError::Shape`].
    pub fn solve(&self, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        check_length("r", self.diagonal.len(), r.len())?;
        check_length("z", self.diagonal.len(), z.len())?;
        self.solve_into(r, z);
        Ok(())
    }

    fn solve_into(&self, r: &[f64], z: &mut [f64]) {
        let Self { starts, columns, diagonal, factors, .. } = self;
        for row in 0..diagonal.len() {
            let range = starts[row]..diagonal[row];
            let mut sum = r[row];
            for (&col, factor) in columns[range.clone()].iter().zip(&factors[range]) {
                sum -= factor * z[col];
            }
            z[row] = sum;
        }
        for row in (0..diagonal.len()).rev() {
            let range = diagonal[row] + 1..starts[row + 1];
            let mut sum = z[row];
            for (&col, factor) in columns[range.clone()].iter().zip(&factors[range]) {
                sum -= factor * z[col];
            }
            z[row] = sum * factors[diagonal[row]];
        }
    }
}

impl Preconditioner for Ilu0 {
    fn n(&self) -> usize {
        self.diagonal.len()
    }
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        self.solve_into(r, z);
    }
}
