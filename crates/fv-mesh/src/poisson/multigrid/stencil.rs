//! The operator A = −(Σ_a ∂_a β ∂_a − s) of a level, row by row.
use super::axis::AxisLevel;
use std::ops::{Add, AddAssign, Div, Mul, Sub};

/// Factor of over-relaxation. Little above 1 is best for the smoother (Yavneh 1996).
const OVER_RELAXATION: f64 = 1.15;

/// Single or double precision.
pub(super) trait Real:
    Copy
    + Default
    + PartialEq
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
    fn double(self) -> f64;
}

impl Real for f32 {
    #[inline(always)]
    fn of(x: f64) -> Self {
        x as Self
    }
    #[inline(always)]
    fn double(self) -> f64 {
        f64::from(self)
    }
}

impl Real for f64 {
    #[inline(always)]
    fn of(x: f64) -> Self {
        x
    }
    #[inline(always)]
    fn double(self) -> f64 {
        self
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
    /// First and number of the cells of every row beyond which β cuts off all, where φ is 0; empty if those are all cells of all rows.
    spans: Vec<[usize; 2]>,
    /// ω, 0, ω, 0, … for one colour of a row, with the factor ω of over-relaxation.
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
        let (low, high) =
            ([x[0].clone(), m[0].clone(), l[0].clone()], [x[1].clone(), m[1].clone(), l[1].clone()]);
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
        // Around a periodic axis of an odd number of cells two neighbours have the same colour.
        let odd = axes.iter().any(|axis| axis.periodic() && axis.cells() % 2 == 1 && axis.cells() > 1);
        let over = if odd { 1.0 } else { OVER_RELAXATION };
        Self {
            cells,
            periodic: axes.each_ref().map(AxisLevel::periodic),
            low,
            high,
            shift: T::of(shift * unit),
            beta,
            spans: Vec::new(),
            colours: (0..=cells[0]).map(|i| T::of(if i % 2 == 0 { over } else { 0.0 })).collect(),
            zeros: vec![T::default(); stride * cells[1]],
        }
    }

    /// Looks where β cuts off the first and the last cells of rows from all others.
    pub(super) fn find_spans(&mut self) {
        self.spans.clear();
        let (Some([x, m, l]), true) = (&self.beta, self.shift == T::default()) else { return };
        let ([n, rows, layers], stride) = (self.cells, self.stride());
        let is_open = |b: &T| *b > T::default();
        let mut all = true;
        for (k, j) in (0..layers).flat_map(|k| (0..rows).map(move |j| (k, j))) {
            let (a, b) = ((k * (rows + 1) + j) * stride, (k * rows + j) * stride);
            let across = [&m[a..][..n], &m[a + stride..][..n], &l[b..][..n], &l[b + self.layer()..][..n]];
            let along = &x[b..][..n + 1];
            let firsts = across.iter().filter_map(|beta| beta.iter().position(is_open));
            let first = firsts.chain(along.iter().position(is_open).map(|face| face.saturating_sub(1))).min();
            let ends = across.iter().filter_map(|beta| beta.iter().rposition(is_open).map(|cell| cell + 1));
            let end = ends.chain(along.iter().rposition(is_open).map(|face| (face + 1).min(n))).max();
            let from = first.unwrap_or(0);
            let span = [from, end.unwrap_or(0) - from];
            all &= span == [0, n];
            self.spans.push(span);
        }
        if all {
            self.spans.clear();
        }
    }

    /// First and number of the cells of row `j` of layer `k` that β does not cut off.
    #[inline(always)]
    pub(super) fn span(&self, j: usize, k: usize) -> [usize; 2] {
        if self.spans.is_empty() { [0, self.cells[0]] } else { self.spans[k * self.cells[1] + j] }
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

    /// Sets to zero what is outside of a span of a row with ghosts, and gives what is inside.
    #[inline(always)]
    fn cut_off<'a>(&self, [from, n]: [usize; 2], row: &'a mut [T]) -> &'a mut [T] {
        let cells = &mut row[1..=self.cells[0]];
        cells[..from].fill(T::default());
        cells[from + n..].fill(T::default());
        &mut cells[from..][..n]
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
            betas = [&m[a..][..n], &m[a + stride..][..n], &l[b..][..n], &l[b + self.layer()..][..n]];
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
        let ([from, n], stride) = (self.span(j, k), self.stride());
        let around = self.around(layers, j, k);
        let Around { rows: [a, b, c, d], coefficients: [ca, cb, cc, cd], betas, beta_x } = around;
        let (a, b, c, d) = (&a[from..][..n], &b[from..][..n], &c[from..][..n], &d[from..][..n]);
        let row = &layers[1][j * stride + from..][..n + 2];
        let (left, x, right) = (&row[..n], &row[1..n + 1], &row[2..n + 2]);
        out[..from].fill(T::default());
        out[from + n..].fill(T::default());
        let (low, high, out) = (&self.low[0][from..][..n], &self.high[0][from..][..n], &mut out[from..][..n]);
        if self.beta.is_some() {
            let [ba, bb, bc, bd] = betas.map(|beta| &beta[from..][..n]);
            let (bl, br) = (&beta_x[from..][..n], &beta_x[from + 1..][..n]);
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
    /// even) are moved towards the value that satisfies their equation, the others are copied. Sets the ghosts.
    #[inline(always)]
    pub(super) fn relax(
        &self,
        layers: [&[T]; 3],
        (j, k): (usize, usize),
        colour: usize,
        f: &[T],
        out: &mut [T],
    ) {
        let ([from, n], stride) = (self.span(j, k), self.stride());
        let around = self.around(layers, j, k);
        let Around { rows: [a, b, c, d], coefficients: [ca, cb, cc, cd], betas, beta_x } = around;
        let (a, b, c, d) = (&a[from..][..n], &b[from..][..n], &c[from..][..n], &d[from..][..n]);
        let row = &layers[1][j * stride + from..][..n + 2];
        let (left, x, right) = (&row[..n], &row[1..n + 1], &row[2..n + 2]);
        let (low, high) = (&self.low[0][from..][..n], &self.high[0][from..][..n]);
        let mask = &self.colours[(j + k + colour) % 2 + from..][..n];
        let f = &f[1 + from..][..n];
        {
            let out = self.cut_off([from, n], out);
            if self.beta.is_some() {
                let [ba, bb, bc, bd] = betas.map(|beta| &beta[from..][..n]);
                let (bl, br) = (&beta_x[from..][..n], &beta_x[from + 1..][..n]);
                for i in 0..n {
                    let (wl, wr) = (low[i] * bl[i], high[i] * br[i]);
                    let (wa, wb, wc, wd) = (ca * ba[i], cb * bb[i], cc * bc[i], cd * bd[i]);
                    let diagonal = (wl + wr) + (wa + wb) + (wc + wd) + self.shift;
                    let sum = f[i]
                        + wl * left[i]
                        + wr * right[i]
                        + (wa * a[i] + wb * b[i])
                        + (wc * c[i] + wd * d[i]);
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
        let [from, n] = self.span(j, k);
        let mask = &self.colours[(j + k + colour) % 2 + from..][..n];
        let (low, high, f) = (&self.low[0][from..][..n], &self.high[0][from..][..n], &f[1 + from..][..n]);
        {
            let out = self.cut_off([from, n], out);
            let zeros = [self.zeros.as_slice(); 3];
            let around = self.around(zeros, j, k);
            let Around { coefficients: [ca, cb, cc, cd], betas, beta_x, .. } = around;
            if self.beta.is_some() {
                let [ba, bb, bc, bd] = betas.map(|beta| &beta[from..][..n]);
                let (bl, br) = (&beta_x[from..][..n], &beta_x[from + 1..][..n]);
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
