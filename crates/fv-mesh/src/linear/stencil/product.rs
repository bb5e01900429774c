//! A x, b − A x and H(x).
use super::super::error::check_length;
use super::super::vector::CHUNK;
use super::super::{LinearError, LinearOperator};
use super::StencilMatrix;
use super::matrix::End;
use crate::parts::each_part;
use pulp::{Arch, Simd, WithSimd};

/// The neighbours of a row along the axes but x.
pub(super) struct Cross<'a, const D: usize> {
    /// Coefficients and the index of the row's first cell, lower and upper; entry 0 is not used.
    pub(super) links: [[(&'a [f64], usize); 2]; D],
}

impl<const D: usize> StencilMatrix<D> {
    /// Rows that one task works on.
    pub(super) fn rows_per_task(&self) -> usize {
        (CHUNK / self.cells[0]).max(1)
    }

    /// Neighbours of row `r` that `keep` accepts by their row's number; the others have zeros for coefficients.
    #[inline(always)]
    pub(super) fn cross(&self, r: usize, keep: impl Fn(usize) -> bool) -> Cross<'_, D> {
        let n = self.cells[0];
        let none = (&self.none[..n], r * n);
        let mut links = [[none; 2]; D];
        for axis in 1..D {
            for (link, end) in links[axis].iter_mut().zip([End::Lower, End::Upper]) {
                if let Some(other) = self.row_neighbour(r, axis, end).filter(|&other| keep(other)) {
                    *link = (&self.coefficients(axis, end)[r * n..][..n], other * n);
                }
            }
        }
        Cross { links }
    }
}

/// What comes out of a row of A x.
trait Combine: Copy + Sync {
    /// Whether the diagonal counts.
    const DIAGONAL: bool;
    fn combine(self, b: f64, sum: f64) -> f64;
}
#[derive(Clone, Copy)]
struct Product;
impl Combine for Product {
    const DIAGONAL: bool = true;
    #[inline(always)]
    fn combine(self, _: f64, sum: f64) -> f64 {
        sum
    }
}
#[derive(Clone, Copy)]
struct Residual;
impl Combine for Residual {
    const DIAGONAL: bool = true;
    #[inline(always)]
    fn combine(self, b: f64, sum: f64) -> f64 {
        b - sum
    }
}
#[derive(Clone, Copy)]
struct OffDiagonal;
impl Combine for OffDiagonal {
    const DIAGONAL: bool = false;
    #[inline(always)]
    fn combine(self, b: f64, sum: f64) -> f64 {
        b - sum
    }
}

/// Rows `first`.. into `out`.
struct Rows<'a, C, const D: usize> {
    combine: C,
    matrix: &'a StencilMatrix<D>,
    first: usize,
    b: &'a [f64],
    x: &'a [f64],
    out: &'a mut [f64],
}

impl<C: Combine, const D: usize> WithSimd for Rows<'_, C, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { combine, matrix, first, b, x, out } = self;
        let n = matrix.cells[0];
        for (k, out) in out.chunks_exact_mut(n).enumerate() {
            row(combine, matrix, first + k, &b[(first + k) * n..][..n], x, out);
        }
    }
}

#[inline(always)]
fn row<C: Combine, const D: usize>(
    combine: C,
    matrix: &StencilMatrix<D>,
    r: usize,
    b: &[f64],
    x: &[f64],
    out: &mut [f64],
) {
    let whole = out.len();
    let span = matrix.span(r);
    let (first, n) = (span.start, span.len());
    let (before, out) = out.split_at_mut(first);
    let (out, behind) = out.split_at_mut(n);
    before.fill(0.0);
    behind.fill(0.0);
    if n == 0 {
        return;
    }
    let range = r * whole + first..r * whole + first + n;
    let cross = matrix.cross(r, |other| C::DIAGONAL || other != r);
    let coefficients = cross.links.map(|l| l.map(|(c, _)| &c[first..][..n]));
    let others = cross.links.map(|l| l.map(|(_, start)| &x[start + first..][..n]));
    let (centre, here, b) = (&matrix.centre[range.clone()][..n], &x[range.clone()][..n], &b[first..][..n]);
    let (lower, upper) = (&matrix.lower[0][range.clone()][..n], &matrix.upper[0][range][..n]);
    let base = |i: usize| {
        let mut sum = if C::DIAGONAL { centre[i] * here[i] } else { 0.0 };
        for axis in 1..D {
            sum +=
                coefficients[axis][0][i] * others[axis][0][i] + coefficients[axis][1][i] * others[axis][1][i];
        }
        sum
    };
    let wraps = n == whole && matrix.periodic[0] && (n > 1 || C::DIAGONAL);
    let ends = |i: usize| {
        let mut sum = base(i);
        if i > 0 {
            sum += lower[i] * here[i - 1];
        } else if wraps {
            sum += lower[i] * here[n - 1];
        }
        if i + 1 < n {
            sum += upper[i] * here[i + 1];
        } else if wraps {
            sum += upper[i] * here[0];
        }
        combine.combine(b[i], sum)
    };
    out[0] = ends(0);
    if n > 2 {
        let m = n - 2;
        let (lower, upper, below, above) = (&lower[1..][..m], &upper[1..][..m], &here[..m], &here[2..][..m]);
        for k in 0..m {
            let sum = base(k + 1) + (lower[k] * below[k] + upper[k] * above[k]);
            out[k + 1] = combine.combine(b[k + 1], sum);
        }
    }
    if n > 1 {
        out[n - 1] = ends(n - 1);
    }
}

/// Row `r` of b − A x.
#[inline(always)]
pub(super) fn residual_row<const D: usize>(
    matrix: &StencilMatrix<D>,
    r: usize,
    b: &[f64],
    x: &[f64],
    out: &mut [f64],
) {
    row(Residual, matrix, r, b, x, out);
}

impl<const D: usize> StencilMatrix<D> {
    fn run<C: Combine>(&self, combine: C, b: &[f64], x: &[f64], out: &mut [f64]) {
        let n = self.cells[0];
        if out.len() <= CHUNK {
            return Arch::new().dispatch(Rows { combine, matrix: self, first: 0, b, x, out });
        }
        let per_task = self.rows_per_task();
        each_part(out, per_task * n, &|task, out| {
            Arch::new().dispatch(Rows { combine, matrix: self, first: task * per_task, b, x, out });
        });
    }

    /// H(x) = b − Σ_N a_N x_N: what the neighbours and b leave for a_P x_P.
    ///
    /// # Errors
    /// [`LinearError::Shape`].
    pub fn h(&self, b: &[f64], x: &[f64], out: &mut [f64]) -> Result<(), LinearError> {
        for (what, length) in [("b", b.len()), ("x", x.len()), ("H", out.len())] {
            check_length(what, self.n(), length)?;
        }
        self.run(OffDiagonal, b, x, out);
        Ok(())
    }
}

impl<const D: usize> LinearOperator for StencilMatrix<D> {
    fn n(&self) -> usize {
        self.centre.len()
    }
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        // The right-hand side is not used.
        self.run(Product, x, x, y);
    }
    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        self.run(Residual, b, x, r);
    }
}
