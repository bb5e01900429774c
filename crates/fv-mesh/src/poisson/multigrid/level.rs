//! One level of the hierarchy: its operator and its fields.
use super::axis::{AxisLevel, Transfer};
use super::stencil::{Real, Stencil};
use super::transfer::{Prolong, ProlongScratch, Restrict, RestrictScratch};
use super::weighted::{WeightedProlong, WeightedRestrict};
use crate::parts::each_pair;
use pulp::{Arch, Simd, WithSimd};

/// Cells below which a level is one task.
const TASK_CELLS: usize = 8192;

/// Layers of the last axis that one task works on.
pub(super) fn layers_per_task(cells: [usize; 3]) -> usize {
    let [n, rows, layers] = cells;
    layers.div_ceil(16).max(TASK_CELLS.div_ceil(n * rows)).max(4)
}

/// Operator and fields of a level.
pub(super) struct Level<T> {
    pub(super) axes: [AxisLevel; 3],
    pub(super) stencil: Stencil<T>,
    /// Right-hand side; the ghosts are not used.
    pub(super) f: Vec<T>,
    pub(super) phi: Vec<T>,
    /// Receives the next φ.
    next: Vec<T>,
    per_task: usize,
    /// Three layers per task.
    rings: Vec<Vec<T>>,
    /// To the next coarser level; none on the coarsest.
    pub(super) transfer: Option<[Transfer<T>; 3]>,
    /// What part of the interpolated value comes from the neighbour group along each axis, if β varies.
    pub(super) pulls: [Vec<T>; 3],
    restrict_scratch: Vec<RestrictScratch<T>>,
    prolong_scratch: Vec<ProlongScratch<T>>,
}

impl<T: Real> Level<T> {
    pub(super) fn new(
        axes: [AxisLevel; 3],
        transfer: Option<[Transfer<T>; 3]>,
        unit: f64,
        shift: f64,
        variable: bool,
    ) -> Self {
        let stencil = Stencil::new(&axes, unit, shift, variable);
        let per_task = layers_per_task(stencil.cells);
        let tasks = stencil.cells[2].div_ceil(per_task);
        let zeros = vec![T::default(); stencil.len()];
        let mut level = Self {
            f: zeros.clone(),
            next: if transfer.is_some() { zeros.clone() } else { Vec::new() },
            phi: zeros,
            rings: vec![vec![T::default(); 3 * stencil.layer()]; if transfer.is_some() { tasks } else { 0 }],
            per_task,
            pulls: std::array::from_fn(|_| {
                vec![T::default(); if variable && transfer.is_some() { stencil.len() } else { 0 }]
            }),
            restrict_scratch: Vec::new(),
            prolong_scratch: Vec::new(),
            axes,
            stencil,
            transfer,
        };
        if let Some([_, middle, last]) = &level.transfer {
            let coarse = [0, middle.children.len(), last.children.len()];
            let tasks_below = coarse[2].div_ceil(level.coarse_per_task());
            level.restrict_scratch =
                (0..tasks_below).map(|_| RestrictScratch::new(&level.stencil, coarse[1])).collect();
            level.prolong_scratch =
                (0..tasks).map(|_| ProlongScratch::new(&level.stencil, coarse[1])).collect();
        }
        level
    }

    /// Coarse layers per task of the restriction.
    fn coarse_per_task(&self) -> usize {
        self.transfer.as_ref().map_or(1, |t| {
            let (fine, coarse) = (self.stencil.cells[2], t[2].children.len());
            if fine <= self.per_task { coarse } else { (coarse * self.per_task).div_ceil(fine).max(2) }
        })
    }

    /// A sweep of red–black Gauss–Seidel, the colour `first` first; from φ = 0 if `zero`.
    pub(super) fn smooth(&mut self, first: usize, zero: bool) {
        let (stencil, phi, f) = (&self.stencil, &self.phi, &self.f);
        let chunk = self.per_task * stencil.layer();
        let job = |task: usize, out: &mut [T], ring: &mut [T]| {
            Arch::new().dispatch(Smooth {
                stencil,
                phi,
                f,
                first,
                zero,
                start: task * self.per_task,
                out,
                ring,
            });
        };
        if let [ring] = self.rings.as_mut_slice() {
            job(0, &mut self.next, ring);
        } else {
            each_pair(&mut self.next, &mut self.rings, [chunk, 1], &|task, out, ring| {
                job(task, out, &mut ring[0])
            });
        }
        std::mem::swap(&mut self.phi, &mut self.next);
    }

    /// Restricts the residual to the right-hand side of the next coarser level.
    pub(super) fn restrict(&mut self, coarse: &mut Self) {
        let per_task = self.coarse_per_task();
        let Some(transfer) = &self.transfer else { return };
        let (stencil, phi, f) = (&self.stencil, &self.phi, &self.f);
        let (layer, stride) = (coarse.stencil.layer(), coarse.stencil.stride());
        let (axes, coarse_axes, pulls) = (&self.axes, &coarse.axes, &self.pulls);
        let job = |task: usize, out: &mut [T], scratch: &mut RestrictScratch<T>| {
            let start = task * per_task;
            if stencil.beta.is_some() {
                let row = scratch.row();
                let job =
                    WeightedRestrict { stencil, transfer, axes, coarse_axes, pulls, phi, f, start, row, out };
                return Arch::new().dispatch(job);
            }
            Arch::new().dispatch(Restrict { stencil, transfer, phi, f, start, layer, stride, out, scratch });
        };
        if let [scratch] = self.restrict_scratch.as_mut_slice() {
            job(0, &mut coarse.f, scratch);
        } else {
            let lengths = [per_task * layer, 1];
            each_pair(&mut coarse.f, &mut self.restrict_scratch, lengths, &|task, out, scratch| {
                job(task, out, &mut scratch[0]);
            });
        }
    }

    /// Adds the interpolated φ of the next coarser level.
    pub(super) fn prolong(&mut self, coarse: &Self) {
        let Some(transfer) = &self.transfer else { return };
        let (stencil, per_task, pulls) = (&self.stencil, self.per_task, &self.pulls);
        let job = |task: usize, phi: &mut [T], scratch: &mut ProlongScratch<T>| {
            let start = task * per_task;
            let coarse = (&coarse.stencil, coarse.phi.as_slice());
            if stencil.beta.is_some() {
                return Arch::new().dispatch(WeightedProlong {
                    stencil,
                    transfer,
                    pulls,
                    coarse,
                    start,
                    phi,
                });
            }
            Arch::new().dispatch(Prolong { stencil, transfer, coarse, start, phi, scratch });
        };
        if let [scratch] = self.prolong_scratch.as_mut_slice() {
            job(0, &mut self.phi, scratch);
        } else {
            let lengths = [per_task * stencil.layer(), 1];
            each_pair(&mut self.phi, &mut self.prolong_scratch, lengths, &|task, phi, scratch| {
                job(task, phi, &mut scratch[0]);
            });
        }
    }
}

/// Both half sweeps in a run of layers. The first one is made in a ring of three layers that moves ahead of the
/// second.
struct Smooth<'a, T> {
    stencil: &'a Stencil<T>,
    phi: &'a [T],
    f: &'a [T],
    first: usize,
    zero: bool,
    /// First layer of `out`.
    start: usize,
    out: &'a mut [T],
    ring: &'a mut [T],
}

impl<T: Real> Smooth<'_, T> {
    /// First half sweep in layer `start` − 1 + `ahead`, into its place in the ring.
    #[inline(always)]
    fn first_half(&mut self, ahead: usize) {
        let (s, layer) = (self.stencil, self.stencil.layer());
        let [_, rows, layers] = s.cells;
        let slot = &mut self.ring[ahead % 3 * layer..][..layer];
        let at = (self.start + ahead) as isize - 1;
        if !s.periodic[2] && !(0..layers as isize).contains(&at) {
            slot.fill(T::default());
            return;
        }
        let k = at.rem_euclid(layers as isize) as usize;
        let f = &self.f[k * layer..][..layer];
        for (j, out) in slot.chunks_exact_mut(s.stride()).enumerate().take(rows) {
            let f = &f[j * s.stride()..][..s.stride()];
            if self.zero {
                s.relax_zero((j, k), self.first, f, out);
            } else {
                let k = k as isize;
                let around = [k - 1, k, k + 1].map(|k| s.layer_of(self.phi, k));
                s.relax(around, (j, k as usize), self.first, f, out);
            }
        }
    }
}

impl<T: Real> WithSimd for Smooth<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        let (s, layer) = (self.stencil, self.stencil.layer());
        let count = self.out.len() / layer;
        self.first_half(0);
        self.first_half(1);
        for i in 0..count {
            self.first_half(i + 2);
            let k = self.start + i;
            let around = [i, i + 1, i + 2].map(|slot| &self.ring[slot % 3 * layer..][..layer]);
            let f = &self.f[k * layer..][..layer];
            for (j, out) in self.out[i * layer..][..layer].chunks_exact_mut(s.stride()).enumerate() {
                s.relax(around, (j, k), 1 - self.first, &f[j * s.stride()..][..s.stride()], out);
            }
        }
    }
}
