//! The tridiagonal systems along the swept axis, one per mode.
//!
//! Times the cell width w_i, mode σ (its eigenvalue plus the shift) obeys
//! `g_i (u_{i−1} − u_i) + g_{i+1} (u_{i+1} − u_i) − σ w_i u_i = w_i f_i` with the conductances g of the
//! faces. Elimination from the low end carries the excess e_i of each pivot over g_{i+1},
//!
//! ```text
//! e_i = σ w_i + g_i e_{i−1} / D_{i−1},      D_i = e_i + g_{i+1},
//! ```
//!
//! in which nothing is subtracted: pivots keep all their digits, however thin the cells and however
//! small σ. On a periodic axis the last unknown is set aside: the others are p + (1 − s) u_{n−1}, where
//! s answers the load σ w, so that the last pivot σ w + g_{n−1} s_{n−2} + g_0 s_0 subtracts nothing either.
use super::super::aligned::Aligned;
use super::super::{AxisBounds, PoissonAxis};
use pulp::Simd;

/// Modes that are swept together, next to each other in memory.
pub(super) const LANES: usize = 32;

/// Coefficients of the swept axis.
pub(super) struct Sweep {
    widths: Vec<f64>,
    length: f64,
    conductances: Vec<f64>,
    cyclic: bool,
    /// Factor of the right-hand side.
    scale: f64,
}

/// Work space of one sweep.
pub(super) struct SweepScratch {
    /// 1/D, cell by cell.
    pivots: Aligned<f64>,
    /// s, cell by cell; empty unless the axis is periodic.
    load: Aligned<f64>,
}

impl Sweep {
    pub(super) fn new(axis: &PoissonAxis, scale: f64) -> Self {
        Self {
            widths: axis.widths.clone(),
            length: axis.length(),
            conductances: axis.conductances(),
            cyclic: axis.ends == AxisBounds::Periodic && axis.cells() > 1,
            scale,
        }
    }

    pub(super) fn scratch(&self) -> SweepScratch {
        let size = self.widths.len() * LANES;
        SweepScratch { pivots: Aligned::new(size), load: Aligned::new(if self.cyclic { size } else { 0 }) }
    }

    /// Mean along the axis, weighted with the widths, of what `at` gives for each cell.
    pub(super) fn mean(&self, at: impl Fn(usize) -> f64) -> f64 {
        self.widths.iter().enumerate().map(|(i, w)| w * at(i)).sum::<f64>() / self.length
    }

    /// Solves for [`LANES`] modes in place; `panel` holds them cell by cell. A mode with σ = 0 that
    /// the ends leave free up to a constant gets zero at the last cell.
    #[inline(always)]
    pub(super) fn solve<S: Simd>(
        &self,
        simd: S,
        sigma: &[f64; LANES],
        panel: &mut [f64],
        scratch: &mut SweepScratch,
    ) {
        match (LANES / S::F64_LANES, self.cyclic) {
            (4, false) => self.sweep::<S, 4>(simd, sigma, panel, scratch),
            (4, true) => self.sweep_cyclic::<S, 4>(simd, sigma, panel, scratch),
            (8, false) => self.sweep::<S, 8>(simd, sigma, panel, scratch),
            (8, true) => self.sweep_cyclic::<S, 8>(simd, sigma, panel, scratch),
            (16, false) => self.sweep::<S, 16>(simd, sigma, panel, scratch),
            (16, true) => self.sweep_cyclic::<S, 16>(simd, sigma, panel, scratch),
            (_, false) => self.sweep::<S, LANES>(simd, sigma, panel, scratch),
            (_, true) => self.sweep_cyclic::<S, LANES>(simd, sigma, panel, scratch),
        }
    }

    #[inline(always)]
    fn sweep<S: Simd, const N: usize>(
        &self,
        simd: S,
        sigma: &[f64; LANES],
        panel: &mut [f64],
        scratch: &mut SweepScratch,
    ) {
        self.eliminate::<S, N>(simd, sigma, panel, &mut scratch.pivots);
        // A last pivot of zero: the ends leave the mode free.
        for r in scratch.pivots.rchunks_exact_mut(LANES).next().into_iter().flatten() {
            *r = if r.is_finite() { *r } else { 0.0 };
        }
        self.substitute::<S, N>(simd, panel, &scratch.pivots);
    }

    #[inline(always)]
    fn sweep_cyclic<S: Simd, const N: usize>(
        &self,
        simd: S,
        sigma: &[f64; LANES],
        panel: &mut [f64],
        scratch: &mut SweepScratch,
    ) {
        let n = self.widths.len();
        let (panel, last) = panel.split_at_mut((n - 1) * LANES);
        let pivots = &mut scratch.pivots[..panel.len()];
        let load = &mut scratch.load[..panel.len()];
        // The same sign and scale as the right-hand side gets in the elimination.
        for (row, &w) in load.chunks_exact_mut(LANES).zip(&self.widths) {
            for (s, sigma) in row.iter_mut().zip(sigma) {
                *s = sigma * w;
            }
        }
        self.eliminate::<S, N>(simd, sigma, panel, pivots);
        self.substitute::<S, N>(simd, panel, pivots);
        self.forward_load::<S, N>(simd, load, pivots);
        self.substitute::<S, N>(simd, load, pivots);

        let (g, w) = (&self.conductances, self.widths[n - 1]);
        let top = (n - 2) * LANES;
        for c in 0..LANES {
            let pivot = sigma[c] * w + g[n - 1] * load[top + c] + g[0] * load[c];
            let rhs = g[n - 1] * panel[top + c] + g[0] * panel[c] - w * self.scale * last[c];
            last[c] = if pivot > 0.0 { rhs / pivot } else { 0.0 };
        }
        for (row, load) in panel.chunks_exact_mut(LANES).zip(load.chunks_exact(LANES)) {
            for c in 0..LANES {
                row[c] += (1.0 - load[c]) * last[c];
            }
        }
    }

    /// Forward elimination: the right-hand side −w f times `scale` becomes y, with 1/D in `pivots`.
    #[inline(always)]
    fn eliminate<S: Simd, const N: usize>(
        &self,
        simd: S,
        sigma: &[f64; LANES],
        panel: &mut [f64],
        pivots: &mut [f64],
    ) {
        let mut sigmas = [simd.splat_f64s(0.0); N];
        sigmas.copy_from_slice(S::as_simd_f64s(sigma).0);
        let one = simd.splat_f64s(1.0);
        let mut excess = [simd.splat_f64s(self.conductances[0]); N];
        let mut ratio = [one; N];
        let mut y = [simd.splat_f64s(0.0); N];
        let rows = panel.chunks_exact_mut(LANES).zip(pivots.chunks_exact_mut(LANES));
        for ((row, pivots), (&w, &g)) in rows.zip(self.widths.iter().zip(&self.conductances[1..])) {
            let row = &mut S::as_mut_simd_f64s(row).0[..N];
            let pivots = &mut S::as_mut_simd_f64s(pivots).0[..N];
            let (factor, w, g) = (simd.splat_f64s(-w * self.scale), simd.splat_f64s(w), simd.splat_f64s(g));
            for q in 0..N {
                excess[q] = simd.mul_add_e_f64s(ratio[q], excess[q], simd.mul_f64s(sigmas[q], w));
                y[q] = simd.mul_add_e_f64s(ratio[q], y[q], simd.mul_f64s(factor, row[q]));
                let pivot = simd.div_f64s(one, simd.add_f64s(excess[q], g));
                ratio[q] = simd.mul_f64s(g, pivot);
                pivots[q] = pivot;
                row[q] = y[q];
            }
        }
    }

    /// Forward elimination of a second right-hand side with the pivots of the first.
    #[inline(always)]
    fn forward_load<S: Simd, const N: usize>(&self, simd: S, load: &mut [f64], pivots: &[f64]) {
        let mut y = [simd.splat_f64s(0.0); N];
        let rows = load.chunks_exact_mut(LANES).zip(pivots.chunks_exact(LANES));
        for ((row, pivots), &g) in rows.zip(&self.conductances[1..]) {
            let row = &mut S::as_mut_simd_f64s(row).0[..N];
            let pivots = &S::as_simd_f64s(pivots).0[..N];
            for q in 0..N {
                let total = simd.add_f64s(row[q], y[q]);
                row[q] = total;
                y[q] = simd.mul_f64s(simd.mul_f64s(simd.splat_f64s(g), pivots[q]), total);
            }
        }
    }

    /// Back substitution: u_i = (y_i + g_{i+1} u_{i+1}) / D_i.
    #[inline(always)]
    fn substitute<S: Simd, const N: usize>(&self, simd: S, panel: &mut [f64], pivots: &[f64]) {
        let mut u = [simd.splat_f64s(0.0); N];
        let cells = panel.len() / LANES;
        let rows = panel.chunks_exact_mut(LANES).zip(pivots.chunks_exact(LANES));
        for ((row, pivots), &g) in rows.zip(&self.conductances[1..=cells]).rev() {
            let row = &mut S::as_mut_simd_f64s(row).0[..N];
            let pivots = &S::as_simd_f64s(pivots).0[..N];
            let g = simd.splat_f64s(g);
            for q in 0..N {
                u[q] = simd.mul_f64s(pivots[q], simd.mul_add_e_f64s(g, u[q], row[q]));
                row[q] = u[q];
            }
        }
    }
}
