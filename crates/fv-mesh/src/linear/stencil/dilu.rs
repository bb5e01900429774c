//! Incomplete factors of a stencil matrix.
use super::super::error::check_length;
use super::super::{LinearError, LinearOperator, Preconditioner};
use super::StencilMatrix;
use super::chain::{BLOCK, Terms};
use super::matrix::End;
use pulp::{Arch, Simd, WithSimd};

/// DILU (Pommerell & Fichtner 1994): A ≈ (Δ + L) Δ⁻¹ (Δ + U) with the lower and upper parts of A itself and
/// Δ_P = a_P − Σ_N a_PN a_NP / Δ_N over the neighbours N before P. Only Δ is stored. On a box without periodic axes
/// this is ILU(0); it is incomplete Cholesky if A is symmetric. A wrapped neighbour counts as before or behind P by
/// its index.
///
/// The factors are solved cell by cell, on one thread.
#[derive(Clone, Debug, PartialEq)]
pub struct Dilu {
    inverse: Vec<f64>,
}

/// Smallest pivot over the diagonal entry.
const SMALLEST_PIVOT: f64 = 1e-14;

impl Dilu {
    /// Factorises.
    ///
    /// # Errors
    /// [`LinearError::ZeroPivot`].
    pub fn new<const D: usize>(matrix: &StencilMatrix<D>) -> Result<Self, LinearError> {
        let mut dilu = Self { inverse: vec![0.0; matrix.n()] };
        dilu.refactor(matrix)?;
        Ok(dilu)
    }

    /// Factorises new values in place.
    ///
    /// # Errors
    /// [`LinearError::ZeroPivot`]: the factors are unusable then until a refactorisation succeeds (they give zeros).
    /// [`LinearError::Shape`]: the factors stay.
    pub fn refactor<const D: usize>(&mut self, matrix: &StencilMatrix<D>) -> Result<(), LinearError> {
        check_length("the factors", matrix.n(), self.inverse.len())?;
        self.inverse.fill(0.0);
        let result = Arch::new().dispatch(Factor { matrix, inverse: &mut self.inverse });
        if result.is_err() {
            self.inverse.fill(0.0);
        }
        result
    }

    /// The preconditioner of the matrix factorised.
    ///
    /// # Errors
    /// [`LinearError::Shape`] if it is a matrix of another size.
    pub fn with<'a, const D: usize>(
        &'a self,
        matrix: &'a StencilMatrix<D>,
    ) -> Result<DiluPreconditioner<'a, D>, LinearError> {
        check_length("the factors", matrix.n(), self.inverse.len())?;
        Ok(DiluPreconditioner { matrix, inverse: &self.inverse })
    }
}

/// [`Dilu`] together with its matrix.
#[derive(Clone, Copy, Debug)]
pub struct DiluPreconditioner<'a, const D: usize> {
    matrix: &'a StencilMatrix<D>,
    inverse: &'a [f64],
}

impl<const D: usize> Preconditioner for DiluPreconditioner<'_, D> {
    fn n(&self) -> usize {
        self.inverse.len()
    }
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        Arch::new().dispatch(Solve { matrix: self.matrix, inverse: self.inverse, r, z });
    }
}

struct Factor<'a, const D: usize> {
    matrix: &'a StencilMatrix<D>,
    inverse: &'a mut [f64],
}

impl<const D: usize> WithSimd for Factor<'_, D> {
    type Output = Result<(), LinearError>;
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { matrix, inverse } = self;
        let n = matrix.cells[0];
        for r in 0..matrix.rows() {
            let span = matrix.span(r);
            let (first, whole, n) = (span.start, n, span.len());
            if n == 0 {
                continue;
            }
            let start = r * whole + first;
            let (before, row) = inverse.split_at_mut(start);
            let row = &mut row[..n];
            row.copy_from_slice(&matrix.centre[start..][..n]);
            for axis in matrix.own_axes() {
                let (l, u) = (&matrix.lower[axis][start..][..n], &matrix.upper[axis][start..][..n]);
                for i in 0..n {
                    row[i] += l[i] + u[i];
                }
            }
            for axis in 1..D {
                for (end, back) in [(End::Lower, End::Upper), (End::Upper, End::Lower)] {
                    let Some(other) = matrix.row_neighbour(r, axis, end).filter(|&other| other < r) else {
                        continue;
                    };
                    let to = &matrix.coefficients(axis, end)[start..][..n];
                    let there = other * whole + first;
                    let back = &matrix.coefficients(axis, back)[there..][..n];
                    let inverse = &before[there..][..n];
                    for i in 0..n {
                        row[i] -= to[i] * back[i] * inverse[i];
                    }
                }
            }
            let (lower, upper) = (&matrix.lower[0][start..][..n], &matrix.upper[0][start..][..n]);
            if matrix.periodic[0] && n == whole && n > 1 {
                // Of the first cell, whose pivot is known before.
                row[n - 1] -= upper[n - 1] * lower[0] / row[0];
            }
            let mut last = 0.0;
            for i in 0..n {
                let pivot = if i > 0 { row[i] - lower[i] * upper[i - 1] * last } else { row[i] };
                last = 1.0 / pivot;
                let scale = matrix.centre[start + i].abs();
                if !(pivot.is_finite() && pivot.abs() > SMALLEST_PIVOT * scale && last.is_finite()) {
                    return Err(LinearError::ZeroPivot { row: start + i, value: pivot });
                }
                row[i] = last;
            }
        }
        Ok(())
    }
}

struct Solve<'a, const D: usize> {
    matrix: &'a StencilMatrix<D>,
    inverse: &'a [f64],
    r: &'a [f64],
    z: &'a mut [f64],
}

impl<const D: usize> WithSimd for Solve<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { matrix, inverse, r, z } = self;
        let mut terms = Terms::new();
        // (Δ + L) y = r.
        for row in 0..matrix.rows() {
            solve_row::<true, D>(matrix, inverse, row, r, z, &mut terms);
        }
        // z = y − Δ⁻¹ U z.
        for row in (0..matrix.rows()).rev() {
            solve_row::<false, D>(matrix, inverse, row, r, z, &mut terms);
        }
    }
}

/// Row `row` of the forward solve from `r` into z, or of the backward solve in z.
#[inline(always)]
fn solve_row<const FORWARD: bool, const D: usize>(
    matrix: &StencilMatrix<D>,
    inverse: &[f64],
    row: usize,
    r: &[f64],
    z: &mut [f64],
    terms: &mut Terms,
) {
    let (whole, span) = (matrix.cells[0], matrix.span(row));
    let (first, n) = (span.start, span.len());
    let start = row * whole + first;
    if FORWARD {
        z[row * whole..start].fill(0.0);
        z[start + n..(row + 1) * whole].fill(0.0);
    }
    let cross = matrix.cross(row, |other| if FORWARD { other < row } else { other > row });
    let (lower, upper) = (&matrix.lower[0][start..][..n], &matrix.upper[0][start..][..n]);
    let (ahead, behind) = if FORWARD { (upper, lower) } else { (lower, upper) };
    let mut last = 0.0;
    let blocks = n.div_ceil(BLOCK);
    for k in 0..blocks {
        let s = if FORWARD { k } else { blocks - 1 - k } * BLOCK;
        let m = BLOCK.min(n - s);
        let (t, w) = (&mut terms.t[..m], &mut terms.w[..m]);
        let here = start + s;
        let coefficients = cross.links.map(|l| l.map(|(c, _)| &c[first + s..][..m]));
        let others = cross.links.map(|l| l.map(|(_, place)| &z[place + first + s..][..m]));
        let (inverse, behind) = (&inverse[here..][..m], &behind[s..][..m]);
        let source = if FORWARD { &r[here..][..m] } else { &z[here..][..m] };
        for i in 0..m {
            let mut sum = 0.0;
            for axis in 1..D {
                sum += coefficients[axis][0][i] * others[axis][0][i]
                    + coefficients[axis][1][i] * others[axis][1][i];
            }
            t[i] = if FORWARD { (source[i] - sum) * inverse[i] } else { source[i] - sum * inverse[i] };
            w[i] = behind[i] * inverse[i];
        }
        let out = &mut z[here..here + m];
        last = if FORWARD { terms.ascend(last, out) } else { terms.descend(last, out) };
    }
    if matrix.periodic[0] && n == whole && n > 1 {
        let (first, end) = if FORWARD { (0, n - 1) } else { (n - 1, 0) };
        z[start + end] -= inverse[start + end] * ahead[end] * z[start + first];
    }
}
