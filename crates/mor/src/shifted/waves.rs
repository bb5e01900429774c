//! Frames that only move, in the space of wave vectors.
use super::dense::columns;
use super::lines::Lines;
use super::stencil::phase;
use super::{FrameOperators, Grid, Shifts};
use monomorphic::{Mat, MatMut, MatRef, fourier_transforms};
use rayon::prelude::*;
use rustfft::Fft;
use rustfft::num_complex::Complex;
use std::f64::consts::PI;
use std::sync::Arc;

/// The Fourier coefficients of fields along all axes that frames move along: a shift multiplies each by its phase, nothing else.
///
/// Real and imaginary parts are rows one after the other, scaled so that norms and angles are those of the fields; along the first axis
/// the coefficients of negative waves are left out, and the others weigh √2.
#[derive(Clone)]
pub(super) struct Waves {
    cells: [usize; 3],
    spacing: [f64; 3],
    /// Coefficients along each axis.
    counts: [usize; 3],
    moving: Vec<usize>,
    transforms: Vec<[Arc<dyn Fft<f64>>; 2]>,
    n_components: usize,
    n_frames: usize,
    n_snapshots: usize,
    /// In cells, frame by frame.
    shifts: Vec<[f64; 3]>,
}

impl Waves {
    /// None if a frame turns or moves along an axis that has ends, or if none moves.
    pub(super) fn new(grid: &Grid, shifts: &dyn Shifts, n_rows: usize) -> Option<Self> {
        let numbers = (0..shifts.n_frames()).flat_map(|k| (0..shifts.n_snapshots()).map(move |j| (k, j)));
        let mut moves = [false; 3];
        for motion in numbers.map(|(k, j)| shifts.motion(k, j)) {
            if !motion.is_translation() {
                return None;
            }
            moves = [0, 1, 2].map(|a| moves[a] || motion.displacement[a] != 0.0 && grid.cells()[a] > 1);
        }
        let moving: Vec<_> = (0..3).filter(|&a| moves[a]).collect();
        let possible = !moving.is_empty() && moving.iter().all(|&a| grid.periodic()[a]);
        possible.then(|| Self::along(grid, moving, shifts, n_rows))
    }

    /// Along these axes, which are periodic, at least one.
    pub(super) fn along(grid: &Grid, moving: Vec<usize>, shifts: &dyn Shifts, n_rows: usize) -> Self {
        let cells = grid.cells();
        let (n_frames, n_snapshots) = (shifts.n_frames(), shifts.n_snapshots());
        let numbers = (0..n_frames).flat_map(|k| (0..n_snapshots).map(move |j| (k, j)));
        let ways = numbers.map(|(k, j)| {
            let s = shifts.motion(k, j).displacement;
            [0, 1, 2].map(|a| s[a] / grid.spacing()[a])
        });
        let ways = ways.collect();
        let mut counts = cells;
        counts[moving[0]] = cells[moving[0]] / 2 + 1;
        let transforms = moving.iter().map(|&a| fourier_transforms(cells[a])).collect();
        let n_components = n_rows / grid.n_cells();
        let spacing = grid.spacing();
        Self { cells, spacing, counts, moving, transforms, n_components, n_frames, n_snapshots, shifts: ways }
    }

    /// ∂/∂x along an axis that fields move along; the wave of two cells has no slope at the nodes.
    pub(super) fn differentiate(&self, a: usize, waves: &mut Mat<f64>) {
        let (n, count) = (self.cells[a], self.counts[a]);
        let stride: usize = self.counts[..a].iter().product();
        let number = |m: usize| match (2 * m).cmp(&n) {
            std::cmp::Ordering::Less => m as f64,
            std::cmp::Ordering::Equal => 0.0,
            std::cmp::Ordering::Greater => m as f64 - n as f64,
        };
        let unit = 2.0 * PI / (n as f64 * self.spacing[a]);
        for column in columns(waves) {
            for (i, w) in column.chunks_exact_mut(2).enumerate() {
                let k = unit * number(i / stride % count);
                (w[0], w[1]) = (-k * w[1], k * w[0]);
            }
        }
    }

    /// Of some of the snapshots.
    pub(super) fn thinned(&self, snapshots: &[usize]) -> Self {
        let numbers = (0..self.n_frames).flat_map(|k| snapshots.iter().map(move |j| (k, j)));
        let shifts = numbers.map(|(k, j)| self.shifts[k * self.n_snapshots + j]).collect();
        Self { n_snapshots: snapshots.len(), shifts, ..self.clone() }
    }

    fn n_cells(&self) -> usize {
        self.cells.iter().product()
    }

    fn n_waves(&self) -> usize {
        self.counts.iter().product()
    }

    /// Of the wave with this number along the first axis, √2 but for those that are their own mirror image.
    fn weight(&self, m: usize) -> f64 {
        if m == 0 || 2 * m == self.cells[self.moving[0]] { 1.0 } else { 2_f64.sqrt() }
    }

    /// 1/√(number of values transformed).
    fn scale(&self) -> f64 {
        1.0 / (self.moving.iter().map(|&a| self.cells[a]).product::<usize>() as f64).sqrt()
    }

    /// From fields, one per column.
    pub(super) fn waves(&self, fields: MatRef<'_, f64>) -> Mat<f64> {
        let (n, m) = (self.n_cells(), self.n_waves());
        let mut waves = Mat::zeros(2 * m * self.n_components, fields.ncols());
        columns(&mut waves).into_par_iter().enumerate().for_each(|(j, out)| {
            let column: Vec<f64> = fields.col(j).iter().copied().collect();
            let mut lines = Lines::default();
            for (field, out) in column.chunks_exact(n).zip(out.chunks_exact_mut(2 * m)) {
                let mut z = self.halved(field);
                for (&a, [forward, _]) in self.moving.iter().zip(&self.transforms).skip(1) {
                    lines.transform(&**forward, self.counts[..a].iter().product(), &mut z);
                }
                out.chunks_exact_mut(2).zip(&z).for_each(|(out, z)| (out[0], out[1]) = (z.re, z.im));
            }
        });
        waves
    }

    /// And back.
    pub(super) fn fields(&self, waves: MatRef<'_, f64>) -> Mat<f64> {
        let (n, m) = (self.n_cells(), self.n_waves());
        let mut fields = Mat::zeros(n * self.n_components, waves.ncols());
        columns(&mut fields).into_par_iter().enumerate().for_each(|(j, out)| {
            let column: Vec<f64> = waves.col(j).iter().copied().collect();
            let mut lines = Lines::default();
            for (field, waves) in out.chunks_exact_mut(n).zip(column.chunks_exact(2 * m)) {
                let mut z: Vec<_> = waves.chunks_exact(2).map(|w| Complex::new(w[0], w[1])).collect();
                for (&a, [_, inverse]) in self.moving.iter().zip(&self.transforms).skip(1) {
                    lines.transform(&**inverse, self.counts[..a].iter().product(), &mut z);
                }
                self.whole(&z, field);
            }
        });
        fields
    }

    /// Where lines along the first axis begin in fields and in waves.
    fn lines(&self) -> (Vec<[usize; 2]>, usize) {
        let first = self.moving[0];
        let inner: usize = self.cells[..first].iter().product();
        let (n, half) = (self.cells[first], self.counts[first]);
        let outer = self.n_cells() / (n * inner);
        let starts =
            (0..outer).flat_map(|o| (0..inner).map(move |i| [o * n * inner + i, o * half * inner + i]));
        (starts.collect(), inner)
    }

    /// The half of the coefficients along the first axis, weighed. Two real lines are one complex line.
    fn halved(&self, field: &[f64]) -> Vec<Complex<f64>> {
        let (n, half) = (self.cells[self.moving[0]], self.counts[self.moving[0]]);
        let (starts, stride) = self.lines();
        let mut waves = vec![Complex::default(); self.n_waves()];
        let forward = &self.transforms[0][0];
        let mut scratch = vec![Complex::default(); forward.get_inplace_scratch_len()];
        let mut line = vec![Complex::default(); n];
        for pair in starts.chunks(2) {
            for (i, z) in line.iter_mut().enumerate() {
                let im = pair.get(1).map_or(0.0, |s| field[s[0] + i * stride]);
                *z = Complex::new(field[pair[0][0] + i * stride], im);
            }
            forward.process_with_scratch(&mut line, &mut scratch);
            for m in 0..half {
                let (z, mirrored) = (line[m], line[(n - m) % n].conj());
                let factor = 0.5 * self.scale() * self.weight(m);
                waves[pair[0][1] + m * stride] = (z + mirrored) * factor;
                if let Some(s) = pair.get(1) {
                    waves[s[1] + m * stride] = (z - mirrored) * Complex::new(0.0, -factor);
                }
            }
        }
        waves
    }

    /// And back.
    fn whole(&self, waves: &[Complex<f64>], field: &mut [f64]) {
        let (n, half) = (self.cells[self.moving[0]], self.counts[self.moving[0]]);
        let (starts, stride) = self.lines();
        let inverse = &self.transforms[0][1];
        let mut scratch = vec![Complex::default(); inverse.get_inplace_scratch_len()];
        let mut line = vec![Complex::default(); n];
        let imaginary = Complex::new(0.0, 1.0);
        for pair in starts.chunks(2) {
            for m in 0..half {
                let factor = self.scale() / self.weight(m);
                let mut a = waves[pair[0][1] + m * stride] * factor;
                let mut b = pair.get(1).map_or(Complex::default(), |s| waves[s[1] + m * stride] * factor);
                if m == 0 || 2 * m == n {
                    // Of real lines these are real.
                    (a.im, b.im) = (0.0, 0.0);
                }
                line[(n - m) % n] = a.conj() + imaginary * b.conj();
                line[m] = a + imaginary * b;
            }
            inverse.process_with_scratch(&mut line, &mut scratch);
            for (i, z) in line.iter().enumerate() {
                field[pair[0][0] + i * stride] = z.re;
                if let Some(s) = pair.get(1) {
                    field[s[0] + i * stride] = z.im;
                }
            }
        }
    }

    fn multiply(&self, frame: usize, waves: MatMut<'_, f64>, side: f64) {
        let columns: Option<Vec<_>> =
            waves.col_iter_mut().map(|c| c.try_as_col_major_mut().map(|c| c.as_slice_mut())).collect();
        let columns = columns.expect("columns of a matrix are contiguous");
        let [nx, ny, nz] = self.counts;
        columns.into_par_iter().enumerate().for_each(|(j, column)| {
            let s = self.shifts[frame * self.n_snapshots + j];
            if s == [0.0; 3] {
                return;
            }
            let [x, y, z] = [0, 1, 2].map(|a| {
                let moves = self.moving.contains(&a);
                let factor = |m| if moves { phase(m, self.cells[a], s[a]) } else { [1.0, 0.0] };
                let factors = (0..self.counts[a]).map(factor).map(|[re, im]| Complex::new(re, side * im));
                factors.collect::<Vec<_>>()
            });
            for (l, line) in column.chunks_exact_mut(2 * nx).enumerate() {
                let factor = y[l % ny] * z[l / ny % nz];
                for (w, x) in line.chunks_exact_mut(2).zip(&x) {
                    let f = factor * x;
                    (w[0], w[1]) = (w[0] * f.re - w[1] * f.im, w[0] * f.im + w[1] * f.re);
                }
            }
        });
    }
}

impl FrameOperators for Waves {
    fn n_rows(&self) -> usize {
        2 * self.n_waves() * self.n_components
    }
    fn n_snapshots(&self) -> usize {
        self.n_snapshots
    }
    fn n_frames(&self) -> usize {
        self.n_frames
    }
    fn to_lab(&self, frame: usize, fields: MatMut<'_, f64>) {
        self.multiply(frame, fields, 1.0);
    }
    fn to_frame(&self, frame: usize, fields: MatMut<'_, f64>) {
        self.multiply(frame, fields, -1.0);
    }
    fn to_lab_transposed(&self, frame: usize, fields: MatMut<'_, f64>) {
        self.multiply(frame, fields, -1.0);
    }
}
