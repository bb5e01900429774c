//! Snapshots by wave vectors.
use super::compression::compress;
use super::phases::Phases;
use crate::shifted::lines::Lines;
use crate::shifted::{Grid, ShiftedError, Shifts};
use crate::{Mat, MatRef};
use monomorphic::{add_product, fourier_transforms};
use rayon::prelude::*;
use rustfft::Fft;
use rustfft::num_complex::Complex;
use std::sync::Arc;

/// Snapshots that are transformed at a time.
const BATCH: usize = 16;

/// What all snapshots have at one wave vector of the axes on which something moves, along all others.
pub(super) struct Group {
    /// Wave numbers along x, y, z; 0 on axes on which nothing moves.
    pub(super) wave: [usize; 3],
    /// D: a column holds the real parts at all snapshots, then the imaginary parts. The values at the cells of the other axes
    /// and of all components are D V.
    pub(super) data: Vec<f64>,
    /// V: orthonormal rows, the real parts of all above the imaginary parts of all; the identity if there is none.
    basis: Option<Mat<f64>>,
    /// Which cells of the other axes and components these are.
    places: Vec<usize>,
    /// ‖D‖².
    pub(super) energy: f64,
}

/// Snapshots in Fourier space along the axes on which something moves. Of each pair ±κ there is one.
pub(in crate::shifted) struct Spectrum {
    pub(super) phases: Phases,
    pub(super) groups: Vec<Group>,
    /// What the snapshots were divided by.
    pub(super) scale: f64,
    /// ‖Q‖².
    pub(super) energy: f64,
    /// What of it was left away.
    pub(super) dropped: f64,
    n_snapshots: usize,
    layout: Layout,
}

/// Forward and inverse.
type Transforms = [Arc<dyn Fft<f64>>; 2];

/// Where the unknowns are, and the transforms.
struct Layout {
    cells: [usize; 3],
    n_rows: usize,
    moving: Vec<(usize, Transforms)>,
}

impl Layout {
    /// Transforms all fields along all axes on which something moves, orthogonally.
    fn transform(&self, inverse: bool, fields: &mut [Complex<f64>]) {
        let mut lines = Lines::default();
        for (axis, transforms) in &self.moving {
            let inner = self.cells[..*axis].iter().product();
            lines.transform(&*transforms[usize::from(inverse)], inner, fields);
        }
        let n: usize = self.moving.iter().map(|(a, _)| self.cells[*a]).product();
        let factor = (n as f64).sqrt().recip();
        fields.iter_mut().for_each(|z| *z *= factor);
    }

    fn moves(&self, axis: usize) -> bool {
        self.moving.iter().any(|(a, _)| *a == axis)
    }

    /// −κ.
    fn opposite(&self, wave: [usize; 3]) -> [usize; 3] {
        std::array::from_fn(|a| if wave[a] == 0 { 0 } else { self.cells[a] - wave[a] })
    }

    fn row(&self, place: [usize; 3]) -> usize {
        place[0] + self.cells[0] * (place[1] + self.cells[1] * place[2])
    }

    /// One wave vector of each pair ±κ, and all of its own opposites.
    fn waves(&self) -> Vec<[usize; 3]> {
        let n = [0, 1, 2].map(|a| if self.moves(a) { self.cells[a] } else { 1 });
        let all = (0..n[2]).flat_map(|z| (0..n[1]).flat_map(move |y| (0..n[0]).map(move |x| [x, y, z])));
        all.filter(|&w| self.row(w) <= self.row(self.opposite(w))).collect()
    }

    /// The rows of wave vector 0 at all cells of the other axes and of all components.
    fn others(&self) -> Vec<usize> {
        let n = [0, 1, 2].map(|a| if self.moves(a) { 1 } else { self.cells[a] });
        let cells: usize = self.cells.iter().product();
        let all = (0..self.n_rows / cells).flat_map(|c| {
            (0..n[2]).flat_map(move |z| (0..n[1]).flat_map(move |y| (0..n[0]).map(move |x| (c, [x, y, z]))))
        });
        all.map(|(c, place)| c * cells + self.row(place)).collect()
    }
}

impl Spectrum {
    /// Of Q − E; waves and directions that hold less than `tolerance`² of the energy in all are left away.
    ///
    /// # Errors
    /// If the snapshots, their noise and the shifts do not fit together or are not finite.
    pub(in crate::shifted) fn new(
        grid: &Grid,
        shifts: &dyn Shifts,
        snapshots: MatRef<'_, f64>,
        noise: Option<MatRef<'_, f64>>,
        tolerance: f64,
    ) -> Result<Self, ShiftedError> {
        let [rows, n] = [snapshots.nrows(), snapshots.ncols()];
        if rows == 0 || !rows.is_multiple_of(grid.n_cells()) {
            return Err(ShiftedError::Rows { rows, cells: grid.n_cells() });
        }
        if n == 0 || shifts.n_frames() == 0 {
            return Err(ShiftedError::Empty { snapshots: n, frames: shifts.n_frames() });
        }
        if shifts.n_snapshots() != n {
            return Err(ShiftedError::Snapshots { snapshots: n, shifts: shifts.n_snapshots() });
        }
        if let Some(e) = noise.filter(|e| e.shape() != (rows, n)) {
            let found = [e.nrows(), e.ncols()];
            return Err(ShiftedError::Shape { what: "noise", expected: [rows, n], found });
        }
        let value = |i: usize, j: usize| snapshots[(i, j)] - noise.map_or(0.0, |e| e[(i, j)]);
        let mut largest = 0.0;
        for j in 0..n {
            // A sum is not finite if one of its terms is not.
            let (sum, max) = (0..rows).fold((0.0, 0.0_f64), |(sum, max), i| {
                let x = value(i, j).abs();
                (sum + 0.0 * x, max.max(x))
            });
            if let Some(row) = (sum != 0.0).then(|| (0..rows).find(|&i| !value(i, j).is_finite())).flatten() {
                return Err(ShiftedError::NotFinite { snapshot: j, row, value: value(row, j) });
            }
            largest = f64::max(largest, max);
        }
        // Squares are neither too large nor too small.
        let scale = if largest > 0.0 { largest.log2().floor().clamp(-1000.0, 1000.0).exp2() } else { 1.0 };
        let value = |i: usize, j: usize| value(i, j) / scale;
        let phases = Phases::new(grid, shifts)?;
        let moving = phases.moving.iter().map(|&a| (a, fourier_transforms(grid.cells()[a]))).collect();
        let layout = Layout { cells: grid.cells(), n_rows: rows, moving };
        let others = layout.others();
        let waves = layout.waves();
        let mut blocks: Vec<_> = waves.iter().map(|_| vec![0.0; 2 * n * others.len()]).collect();
        let mut energy = 0.0;
        for first in (0..n).step_by(BATCH) {
            let batch = first..(first + BATCH).min(n);
            // Two real fields are one complex field.
            let pairs: Vec<_> = batch
                .clone()
                .into_par_iter()
                .step_by(2)
                .map(|j| {
                    let next = |i| if j + 1 < n { value(i, j + 1) } else { 0.0 };
                    let mut z: Vec<_> = (0..rows).map(|i| Complex::new(value(i, j), next(i))).collect();
                    let squares: f64 = z.iter().map(Complex::norm_sqr).sum();
                    layout.transform(false, &mut z);
                    (z, squares)
                })
                .collect();
            energy += pairs.iter().map(|(_, squares)| squares).sum::<f64>();
            for (block, &wave) in blocks.iter_mut().zip(&waves) {
                let opposite = layout.opposite(wave);
                let weight = if wave == opposite { 0.5 } else { 0.5_f64.sqrt() };
                let (here, there) = (layout.row(wave), layout.row(opposite));
                for (column, &other) in block.chunks_exact_mut(2 * n).zip(&others) {
                    let (re, im) = column.split_at_mut(n);
                    let to = re[batch.clone()].chunks_mut(2).zip(im[batch.clone()].chunks_mut(2));
                    for ((re, im), (z, _)) in to.zip(&pairs) {
                        let (a, b) = (z[other + here] * weight, z[other + there].conj() * weight);
                        (re[0], im[0]) = (a.re + b.re, a.im + b.im);
                        if re.len() > 1 {
                            (re[1], im[1]) = (a.im - b.im, b.re - a.re);
                        }
                    }
                }
            }
        }
        // In all: as much as is allowed; each group by its own share.
        let allowed = tolerance.powi(2) * energy / blocks.len() as f64;
        let groups: Vec<_> = blocks
            .into_par_iter()
            .zip(&waves)
            .map(|(block, &wave)| {
                let (kept, dropped) = compress(n, block, allowed);
                let places = kept.columns.iter().map(|&c| others[c] + layout.row(wave)).collect();
                let energy = kept.data.iter().map(|x| x * x).sum();
                (Group { wave, data: kept.data, basis: kept.basis, places, energy }, dropped)
            })
            .collect();
        let dropped = groups.iter().map(|g| g.1).sum();
        let groups = groups.into_iter().map(|g| g.0).filter(|g: &Group| !g.data.is_empty()).collect();
        Ok(Self { phases, groups, scale, energy, dropped, n_snapshots: n, layout })
    }

    /// With frames that are elsewhere, but move along the same axes.
    ///
    /// # Errors
    /// If a frame turns, leaves the grid, or moves along a bounded axis.
    pub(in crate::shifted) fn along(self, grid: &Grid, shifts: &dyn Shifts) -> Result<Self, ShiftedError> {
        let phases = Phases::along(grid, shifts, Some(self.phases.moving))?;
        Ok(Self { phases, ..self })
    }

    /// Unknowns of a snapshot.
    pub(super) fn n_rows(&self) -> usize {
        self.layout.n_rows
    }

    pub(super) fn n_snapshots(&self) -> usize {
        self.n_snapshots
    }

    /// Fields from their coefficients: for each column of each group's data the real parts of all fields,
    /// then the imaginary parts.
    pub(super) fn fields(&self, n_fields: usize, mut coefficients: &[f64]) -> Mat<f64> {
        let mut out = Mat::zeros(self.layout.n_rows, n_fields);
        let mut of_groups = Vec::with_capacity(self.groups.len());
        for group in &self.groups {
            let (of_group, others) =
                coefficients.split_at(2 * n_fields * (group.data.len() / (2 * self.n_snapshots)));
            of_groups.push(of_group);
            coefficients = others;
        }
        let full: Vec<_> = self
            .groups
            .par_iter()
            .zip(of_groups)
            .map(|(group, phi)| {
                let Some(basis) = &group.basis else { return phi.to_vec() };
                let (vr, vi) = basis.split_at_row(basis.nrows() / 2);
                let phi = MatRef::from_column_major_slice(phi, 2 * n_fields, vr.nrows());
                let [mut x, mut y] = [(); 2].map(|()| Mat::<f64>::zeros(2 * n_fields, vr.ncols()));
                add_product(x.as_mut(), phi, vr);
                add_product(y.as_mut(), phi, vi);
                // (x + i y) of a complex x and i times a complex y.
                for c in 0..x.ncols() {
                    let ((re, im), (yr, yi)) =
                        (x.col_as_slice_mut(c).split_at_mut(n_fields), y.col_as_slice(c).split_at(n_fields));
                    re.iter_mut().zip(yi).for_each(|(x, y)| *x -= y);
                    im.iter_mut().zip(yr).for_each(|(x, y)| *x += y);
                }
                (0..x.ncols()).flat_map(|c| x.col_as_slice(c).to_vec()).collect()
            })
            .collect();
        for field in (0..n_fields).step_by(2) {
            let mut z = vec![Complex::default(); self.layout.n_rows];
            for (group, full) in self.groups.iter().zip(&full) {
                let opposite = self.layout.opposite(group.wave);
                let alone = group.wave == opposite;
                let weight = if alone { 1.0 } else { 0.5_f64.sqrt() };
                let back = self.layout.row(opposite) as isize - self.layout.row(group.wave) as isize;
                for (of, &row) in full.chunks_exact(2 * n_fields).zip(&group.places) {
                    let (re, im) = of.split_at(n_fields);
                    let part = |f: usize| {
                        if f < n_fields { Complex::new(re[f], im[f]) * weight } else { Complex::ZERO }
                    };
                    let [a, b] = [part(field), part(field + 1)];
                    let i = Complex::<f64>::I;
                    if alone {
                        // Real and imaginary parts of waves that are their own opposites belong to real fields alone.
                        z[row] = Complex::new(a.re, 0.0) + i * b.re;
                    } else {
                        z[row] = a + i * b;
                        z[(row as isize + back) as usize] = a.conj() + i * b.conj();
                    }
                }
            }
            self.layout.transform(true, &mut z);
            out.col_as_slice_mut(field).iter_mut().zip(&z).for_each(|(x, z)| *x = z.re);
            if field + 1 < n_fields {
                out.col_as_slice_mut(field + 1).iter_mut().zip(&z).for_each(|(x, z)| *x = z.im);
            }
        }
        out
    }
}
