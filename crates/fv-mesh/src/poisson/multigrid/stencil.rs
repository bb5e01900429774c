//! The operator A = −(Σ_a ∂_a β ∂_a − s) of a level, row by row.
use super::axis::AxisLevel;
use std::ops::{Add, AddAssign, Div, Mul, Sub};

/// Single or double precision.
pub(super) trait Real:
    Copy
    + Default
    + PartialOrd
    + Send
    + Sync
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
{
    fn of(x: f64) -> Self;
}

impl Real for f32 {
    fn of(x: f64) -> Self {
        x as Self
    }
}

impl Real for f64 {
    fn of(x: f64) -> Self {
        x
    }
}

/// Coefficients of the operator and the layout of a level: three axes (the middle one has one cell in two
/// dimensions), x fastest, one ghost value at both ends of a row.
pub(super) struct Stencil<T> {
    pub(super) cells: [usize; 3],
    pub(super) periodic: [bool; 3],
    /// Coefficients of the differences to the lower and the upper neighbours.
    low: [Vec<T>; 3],
    high: [Vec<T>; 3],
    shift: T,
    /// β at the faces, if it is not 1: rows of faces along x, rows between rows, rows between layers.
    pub(super) beta: Option<[Vec<T>; 3]>,
    /// 1, 0, 1, 0, … for one colour of a row.
    colours: Vec<T>,
    /// Stands for the layers behind the ends.
    zeros: Vec<T>,
}

/// Rows around a row and the coefficients of the differences to them.
struct Around<'a, T> {
    rows: [&'a [T]; 4],
    coefficients: [T; 4],
    /// β between this row and those; empty if it is 1.
    betas: [&'a [T]; 4],
    beta_x: &'a [T],
}

impl<T: Real> Stencil<T> {
    pub(super) fn new(axes: &[AxisLevel; 3], unit: f64, shift: f64, variable: bool) -> Self {
        let cells: [usize; 3] = std::array::from_fn(|a| axes[a].cells());
        let tables = axes.each_ref().map(|axis| {
            axis.coefficients(variable).map(|t| t.into_iter().map(|c| T::of(c * unit)).collect::<Vec<T>>())
        });
        let [x, m, l] = tables;
        let (low, high) = ([x[0].clone(), m[0].clone(), l[0].clone()], [x[1].clone(), m[1].clone(), l[1].clone()]);
        let stride = cells[0] + 2;
        let beta = variable.then(|| {
            std::array::from_fn(|a| {
                let mut faces = cells;
                if a > 0 {
                    faces[a] += 1;
                }
                vec![T::default(); stride * faces[1] * faces[2]]
            })
        });
        Self {
            cells,
            periodic: axes.each_ref().map(AxisLevel::periodic),
            low,
            high,
            shift: T::of(shift * unit),
            beta,
            colours: (0..=cells[0]).map(|i| T::of(if i % 2 == 0 { 1.0 } else { 0.0 })).collect(),
            zeros: vec![T::default(); stride * cells[1]],
        }
    }

    /// Values of a row with its ghosts.
    #[inline(always)]
    pub(super) fn stride(&self) -> usize {
        self.cells[0] + 2
    }

    /// Values of a layer.
    #[inline(always)]
    pub(super) fn layer(&self) -> usize {
        self.stride() * self.cells[1]
    }

    /// Values of the level.
    pub(super) fn len(&self) -> usize {
        self.layer() * self.cells[2]
    }

    /// The layer `k` of `field`, where −1 and the number of layers stand for those behind the ends.
    #[inline(always)]
    pub(super) fn layer_of<'a>(&'a self, field: &'a [T], k: isize) -> &'a [T] {
        let n = self.cells[2] as isize;
        if (0..n).contains(&k) {
            &field[k as usize * self.layer()..][..self.layer()]
        } else if self.periodic[2] {
            &field[k.rem_euclid(n) as usize * self.layer()..][..self.layer()]
        } else {
            &self.zeros
        }
    }

    /// Sets the ghosts of a row.
    #[inline(always)]
    pub(super) fn set_ghosts(&self, row: &mut [T]) {
        let n = self.cells[0];
        if self.periodic[0] {
            row[0] = row[n];
            row[n + 1] = row[1];
        } else {
            row[0] = T::default();
            row[n + 1] = T::default();
        }
    }

    /// What surrounds row `j` of layer `k`.
    #[inline(always)]
    fn around<'a>(&'a self, [below, here, above]: [&'a [T]; 3], j: usize, k: usize) -> Around<'a, T> {
        let ([n, rows, _], stride) = (self.cells, self.stride());
        let row = |layer: &'a [T], j: usize| &layer[j * stride + 1..][..n];
        let before = if j > 0 {
            row(here, j - 1)
        } else if self.periodic[1] {
            row(here, rows - 1)
        } else {
            row(&self.zeros, 0)
        };
        let after = if j + 1 < rows {
            row(here, j + 1)
        } else if self.periodic[1] {
            row(here, 0)
        } else {
            row(&self.zeros, 0)
        };
        let (mut betas, mut beta_x): ([&[T]; 4], &[T]) = ([&[]; 4], &[]);
        if let Some([x, m, l]) = &self.beta {
            let at = |r: usize| r * stride;
            beta_x = &x[at(k * rows + j)..][..n + 1];
            let (a, b) = (at(k * (rows + 1) + j), at(k * rows + j));
            betas =
                [&m[a..][..n], &m[a + stride..][..n], &l[b..][..n], &l[b + self.layer()..][..n]];
        }
        Around {
            rows: [before, after, row(below, j), row(above, j)],
            coefficients: [self.low[1][j], self.high[1][j], self.low[2][k], self.high[2][k]],
            betas,
            beta_x,
        }
    }

    /// A φ in row `j` of layer `k`, from the layers below, here and above.
    #[inline(always)]
    pub(super) fn apply(&self, layers: [&[T]; 3], j: usize, k: usize, out: &mut [T]) {
        let (n, stride) = (self.cells[0], self.stride());
        let around = self.around(layers, j, k);
        let Around { rows: [a, b, c, d], coefficients: [ca, cb, cc, cd], betas, beta_x } = around;
        let (a, b, c, d) = (&a[..n], &b[..n], &c[..n], &d[..n]);
        let row = &layers[1][j * stride..][..n + 2];
        let (left, x, right) = (&row[..n], &row[1..n + 1], &row[2..n + 2]);
        let (low, high, out) = (&self.low[0][..n], &self.high[0][..n], &mut out[..n]);
        if self.beta.is_some() {
            let [ba, bb, bc, bd] = betas;
            let (ba, bb, bc, bd) = (&ba[..n], &bb[..n], &bc[..n], &bd[..n]);
            let (bl, br) = (&beta_x[..n], &beta_x[1..n + 1]);
            for i in 0..n {
                let mut sum = self.shift * x[i];
                sum += low[i] * bl[i] * (x[i] - left[i]) + high[i] * br[i] * (x[i] - right[i]);
                sum += ca * ba[i] * (x[i] - a[i]) + cb * bb[i] * (x[i] - b[i]);
                sum += cc * bc[i] * (x[i] - c[i]) + cd * bd[i] * (x[i] - d[i]);
                out[i] = sum;
            }
        } else if self.cells[1] == 1 {
            let centre = self.shift + ca + cb;
            for i in 0..n {
                let mut sum = low[i] * (x[i] - left[i]) + high[i] * (x[i] - right[i]);
                sum += cc * (x[i] - c[i]) + cd * (x[i] - d[i]);
                out[i] = sum + centre * x[i];
            }
        } else {
            for i in 0..n {
                let mut sum = self.shift * x[i];
                sum += low[i] * (x[i] - left[i]) + high[i] * (x[i] - right[i]);
                sum += ca * (x[i] - a[i]) + cb * (x[i] - b[i]);
                sum += cc * (x[i] - c[i]) + cd * (x[i] - d[i]);
                out[i] = sum;
            }
        }
    }

    /// One half of a red–black Gauss–Seidel sweep in row `j` of layer `k`: cells of the colour (i + j + k + colour
    /// even) satisfy their equation, the others are copied. Sets the ghosts.
    #[inline(always)]
    pub(super) fn relax(
        &self,
        layers: [&[T]; 3],
        (j, k): (usize, usize),
        colour: usize,
        f: &[T],
        out: &mut [T],
    ) {
        let (n, stride) = (self.cells[0], self.stride());
        let around = self.around(layers, j, k);
        let Around { rows: [a, b, c, d], coefficients: [ca, cb, cc, cd], betas, beta_x } = around;
        let (a, b, c, d) = (&a[..n], &b[..n], &c[..n], &d[..n]);
        let row = &layers[1][j * stride..][..n + 2];
        let (left, x, right) = (&row[..n], &row[1..n + 1], &row[2..n + 2]);
        let (low, high) = (&self.low[0][..n], &self.high[0][..n]);
        let mask = &self.colours[(j + k + colour) % 2..][..n];
        let f = &f[1..n + 1];
        {
            let out = &mut out[1..n + 1];
            if self.beta.is_some() {
                let [ba, bb, bc, bd] = betas;
                let (ba, bb, bc, bd) = (&ba[..n], &bb[..n], &bc[..n], &bd[..n]);
                let (bl, br) = (&beta_x[..n], &beta_x[1..n + 1]);
                for i in 0..n {
                    let (wl, wr) = (low[i] * bl[i], high[i] * br[i]);
                    let (wa, wb, wc, wd) = (ca * ba[i], cb * bb[i], cc * bc[i], cd * bd[i]);
                    let diagonal = (wl + wr) + (wa + wb) + (wc + wd) + self.shift;
                    let sum = f[i] + wl * left[i] + wr * right[i] + (wa * a[i] + wb * b[i]) + (wc * c[i] + wd * d[i]);
                    // A cell that β cuts off from all others and from the ends.
                    let new = if diagonal > T::default() { sum / diagonal } else { T::default() };
                    out[i] = x[i] + mask[i] * (new - x[i]);
                }
            } else if self.cells[1] == 1 {
                let rest = ca + cb + cc + cd + self.shift;
                for i in 0..n {
                    let sum = f[i] + (low[i] * left[i] + high[i] * right[i]) + (cc * c[i] + cd * d[i]);
                    out[i] = x[i] + mask[i] * (sum / (low[i] + high[i] + rest) - x[i]);
                }
            } else {
                let rest = ca + cb + cc + cd + self.shift;
                for i in 0..n {
                    let sum = f[i] + (low[i] * left[i] + high[i] * right[i]);
                    let sum = sum + (ca * a[i] + cb * b[i]) + (cc * c[i] + cd * d[i]);
                    out[i] = x[i] + mask[i] * (sum / (low[i] + high[i] + rest) - x[i]);
                }
            }
        }
        self.set_ghosts(out);
    }

    /// [`relax`](Self::relax) of φ = 0.
    #[inline(always)]
    pub(super) fn relax_zero(&self, (j, k): (usize, usize), colour: usize, f: &[T], out: &mut [T]) {
        let n = self.cells[0];
        let mask = &self.colours[(j + k + colour) % 2..][..n];
        let (low, high, f) = (&self.low[0][..n], &self.high[0][..n], &f[1..n + 1]);
        {
            let out = &mut out[1..n + 1];
            let zeros = [self.zeros.as_slice(); 3];
            let around = self.around(zeros, j, k);
            let Around { coefficients: [ca, cb, cc, cd], betas, beta_x, .. } = around;
            if self.beta.is_some() {
                let [ba, bb, bc, bd] = betas;
                let (ba, bb, bc, bd) = (&ba[..n], &bb[..n], &bc[..n], &bd[..n]);
                let (bl, br) = (&beta_x[..n], &beta_x[1..n + 1]);
                for i in 0..n {
                    let diagonal = (low[i] * bl[i] + high[i] * br[i])
                        + (ca * ba[i] + cb * bb[i])
                        + (cc * bc[i] + cd * bd[i])
                        + self.shift;
                    let new = if diagonal > T::default() { f[i] / diagonal } else { T::default() };
                    out[i] = mask[i] * new;
                }
            } else {
                let rest = ca + cb + cc + cd + self.shift;
                for i in 0..n {
                    // Alone in a box without ends a cell has no equation.
                    let diagonal = low[i] + high[i] + rest;
                    out[i] = mask[i] * (f[i] / diagonal);
                }
            }
        }
        self.set_ghosts(out);
    }
}
