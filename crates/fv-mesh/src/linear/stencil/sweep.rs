//! Gauss–Seidel sweeps.
use super::super::vector::CHUNK;
use super::super::{GaussSeidelSweep, LinearError, LinearOperator, Sweep};
use super::StencilMatrix;
use super::chain::{BLOCK, Terms};
use super::product::residual_row;
use crate::parts::each_part;
use pulp::{Arch, Simd, WithSimd};

impl<const D: usize> GaussSeidelSweep for StencilMatrix<D> {
    fn check_diagonal(&self) -> Result<(), LinearError> {
        for row in 0..self.n() {
            let value = self.diagonal(row);
            if !(value.is_finite() && value.recip().is_finite()) {
                return Err(LinearError::ZeroPivot { row, value });
            }
        }
        Ok(())
    }

    /// In the order of the cells, on one thread.
    fn sweep(&self, sweep: Sweep, b: &[f64], x: &mut [f64], _: &mut [f64]) {
        let arch = Arch::new();
        match sweep {
            Sweep::Forward => arch.dispatch(Lexicographic::<true, D> { matrix: self, b, x }),
            Sweep::Backward => arch.dispatch(Lexicographic::<false, D> { matrix: self, b, x }),
        }
    }
}

struct Lexicographic<'a, const FORWARD: bool, const D: usize> {
    matrix: &'a StencilMatrix<D>,
    b: &'a [f64],
    x: &'a mut [f64],
}

impl<const FORWARD: bool, const D: usize> WithSimd for Lexicographic<'_, FORWARD, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { matrix, b, x } = self;
        let rows = matrix.rows();
        let mut terms = Terms::new();
        for k in 0..rows {
            sweep_row::<FORWARD, D>(matrix, if FORWARD { k } else { rows - 1 - k }, b, x, &mut terms);
        }
    }
}

/// Row `r`: x_i = t_i − w_i x_{i∓1}, where t holds b and all neighbours but the one solved just before.
#[inline(always)]
fn sweep_row<const FORWARD: bool, const D: usize>(
    matrix: &StencilMatrix<D>,
    r: usize,
    b: &[f64],
    x: &mut [f64],
    terms: &mut Terms,
) {
    let (whole, span) = (matrix.cells[0], matrix.span(r));
    let (offset, n) = (span.start, span.len());
    if n == 0 {
        return;
    }
    let start = r * whole + offset;
    let cross = matrix.cross(r, |other| other != r);
    let (lower, upper) = (&matrix.lower[0][start..][..n], &matrix.upper[0][start..][..n]);
    // Coefficients of the neighbour ahead and of the one solved before.
    let (ahead, behind) = if FORWARD { (upper, lower) } else { (lower, upper) };
    let wraps = matrix.periodic[0] && n == whole && n > 1;
    let (first, end) = if FORWARD { (0, n - 1) } else { (n - 1, 0) };
    // What the first cell's neighbour behind it holds still.
    let mut last = if wraps { x[start + end] } else { 0.0 };
    let blocks = n.div_ceil(BLOCK);
    for k in 0..blocks {
        let s = if FORWARD { k } else { blocks - 1 - k } * BLOCK;
        let m = BLOCK.min(n - s);
        let (t, w) = (&mut terms.t[..m], &mut terms.w[..m]);
        let here = start + s;
        let (b, centre) = (&b[here..][..m], &matrix.centre[here..][..m]);
        let coefficients = cross.links.map(|l| l.map(|(c, _)| &c[offset + s..][..m]));
        let others = cross.links.map(|l| l.map(|(_, place)| &x[place + offset + s..][..m]));
        for i in 0..m {
            let mut sum = b[i];
            for axis in 1..D {
                sum -= coefficients[axis][0][i] * others[axis][0][i]
                    + coefficients[axis][1][i] * others[axis][1][i];
            }
            t[i] = sum;
            w[i] = centre[i];
        }
        for axis in matrix.own_axes() {
            let (l, u) = (&matrix.lower[axis][here..][..m], &matrix.upper[axis][here..][..m]);
            for i in 0..m {
                w[i] += l[i] + u[i];
            }
        }
        // The last cell to be solved has nothing ahead of it, or what was solved first.
        if FORWARD {
            let m = m.min(n - 1 - s);
            let (ahead, values) = (&ahead[s..][..m], &x[here + 1..][..m]);
            for i in 0..m {
                t[i] -= ahead[i] * values[i];
            }
        } else {
            let skip = usize::from(s == 0);
            let m = m - skip;
            let (ahead, values) = (&ahead[s + skip..][..m], &x[here + skip - 1..][..m]);
            let t = &mut t[skip..];
            for i in 0..m {
                t[i] -= ahead[i] * values[i];
            }
        }
        let behind = &behind[s..][..m];
        for i in 0..m {
            let inverse = 1.0 / w[i];
            t[i] *= inverse;
            w[i] = behind[i] * inverse;
        }
        let row = &mut x[here..here + m];
        last = if FORWARD { terms.ascend(last, row) } else { terms.descend(last, row) };
    }
    if wraps {
        x[start + end] -= ahead[end] * x[start + first] / matrix.diagonal(start + end);
    }
}

/// A stencil matrix whose sweeps solve all cells with an even sum of indices first and then the others (forward), or
/// the other way round (backward). All threads take part. Where a periodic axis has an odd number of cells, neighbours
/// across the seam are of one colour: they then see each other's last value.
#[derive(Clone, Copy, Debug)]
pub struct RedBlack<'a, const D: usize> {
    matrix: &'a StencilMatrix<D>,
}

impl<'a, const D: usize> RedBlack<'a, D> {
    /// Sweeps over `matrix`.
    pub fn new(matrix: &'a StencilMatrix<D>) -> Self {
        Self { matrix }
    }

    /// `out` is x with the cells of one colour solved.
    fn colour(&self, odd: usize, b: &[f64], x: &[f64], out: &mut [f64]) {
        let matrix = self.matrix;
        if out.len() <= CHUNK {
            return Arch::new().dispatch(Colour { matrix, first: 0, odd, b, x, out });
        }
        let per_task = matrix.rows_per_task();
        each_part(out, per_task * matrix.cells[0], &|task, out| {
            Arch::new().dispatch(Colour { matrix, first: task * per_task, odd, b, x, out });
        });
    }
}

impl<const D: usize> LinearOperator for RedBlack<'_, D> {
    fn n(&self) -> usize {
        self.matrix.n()
    }
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        self.matrix.apply(x, y);
    }
    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        self.matrix.residual(b, x, r);
    }
}

impl<const D: usize> GaussSeidelSweep for RedBlack<'_, D> {
    fn check_diagonal(&self) -> Result<(), LinearError> {
        self.matrix.check_diagonal()
    }
    fn sweep(&self, sweep: Sweep, b: &[f64], x: &mut [f64], work: &mut [f64]) {
        let odd = match sweep {
            Sweep::Forward => 0,
            Sweep::Backward => 1,
        };
        self.colour(odd, b, x, work);
        self.colour(1 - odd, b, work, x);
    }
}

/// Rows `first`.. into `out`.
struct Colour<'a, const D: usize> {
    matrix: &'a StencilMatrix<D>,
    first: usize,
    odd: usize,
    b: &'a [f64],
    x: &'a [f64],
    out: &'a mut [f64],
}

impl<const D: usize> WithSimd for Colour<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { matrix, first, odd, b, x, out } = self;
        let n = matrix.cells[0];
        for (k, out) in out.chunks_exact_mut(n).enumerate() {
            let r = first + k;
            let b = &b[r * n..][..n];
            residual_row(matrix, r, b, x, out);
            // Sum of the indices along y and z.
            let mut sum = odd;
            let mut rest = r;
            for axis in 1..D {
                sum += rest % matrix.cells[axis];
                rest /= matrix.cells[axis];
            }
            let (here, centre) = (&x[r * n..][..n], &matrix.centre[r * n..][..n]);
            let chosen = &matrix.checker[sum % 2..][..n];
            if matrix.own_axes().next().is_some() {
                for i in 0..n {
                    out[i] = here[i] + chosen[i] * (out[i] / matrix.diagonal(r * n + i));
                }
            } else {
                for i in 0..n {
                    out[i] = here[i] + chosen[i] * (out[i] / centre[i]);
                }
            }
        }
    }
}
