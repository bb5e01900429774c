//! Restriction and interpolation when β varies: a cell gets the share 1 − Σ_a t_a of its own group's value and the share
//! t_a of the neighbour's along each axis. Corner neighbours are left out: β between them and the cell says nothing.
use super::axis::{AxisLevel, Transfer};
use super::stencil::{Real, Stencil};
use pulp::{Simd, WithSimd};

/// Adds the interpolated correction to a run of layers.
pub(super) struct WeightedProlong<'a, T> {
    pub(super) stencil: &'a Stencil<T>,
    pub(super) transfer: &'a [Transfer<T>; 3],
    pub(super) pulls: &'a [Vec<T>; 3],
    /// Layout and φ of the coarse level.
    pub(super) coarse: (&'a Stencil<T>, &'a [T]),
    /// First layer of `phi`.
    pub(super) start: usize,
    pub(super) phi: &'a mut [T],
}

impl<T: Real> WithSimd for WeightedProlong<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { stencil: s, transfer: [x, middle, last], pulls, coarse: (coarse, from), start, phi } =
            self;
        let [count, rows, _] = coarse.cells;
        let row = |j: usize, k: usize| &from[(k * rows + j) * coarse.stride() + 1..][..count];
        for (r, phi) in phi.chunks_exact_mut(s.stride()).enumerate() {
            let (j, k) = (r % s.cells[1], start + r / s.cells[1]);
            let [first, n] = s.span(j, k);
            let (own, beside) = (&x.parents[first..][..n], &x.neighbours[first..][..n]);
            let ([g, _], (g_beside, open_middle)) = (middle.parents[j], middle.neighbours[j]);
            let ([h, _], (h_beside, open_last)) = (last.parents[k], last.neighbours[k]);
            let (here, b, c) = (row(g, h), row(g_beside, h), row(g, h_beside));
            let at = (k * s.cells[1] + j) * s.stride();
            let [ta, tb, tc] = pulls.each_ref().map(|t| &t[at + first..][..n]);
            let inside = &mut phi[1 + first..][..n];
            let factor = |open: bool| T::of(if open { 1.0 } else { 0.0 });
            let (fb, fc) = (factor(open_middle), factor(open_last));
            let one = T::of(1.0);
            for i in 0..n {
                let (p, (q, open)) = (own[i][0], beside[i]);
                let a = if open { here[q] } else { T::default() };
                inside[i] += (one - ta[i] - tb[i] - tc[i]) * here[p]
                    + ta[i] * a
                    + tb[i] * fb * b[p]
                    + tc[i] * fc * c[p];
            }
            s.set_ghosts(phi);
        }
    }
}

/// Restricts f − A φ to a run of coarse layers by the adjoint of the interpolation.
pub(super) struct WeightedRestrict<'a, T> {
    pub(super) stencil: &'a Stencil<T>,
    pub(super) transfer: &'a [Transfer<T>; 3],
    pub(super) axes: &'a [AxisLevel; 3],
    pub(super) coarse_axes: &'a [AxisLevel; 3],
    pub(super) pulls: &'a [Vec<T>; 3],
    pub(super) phi: &'a [T],
    pub(super) f: &'a [T],
    /// First coarse layer.
    pub(super) start: usize,
    pub(super) row: &'a mut [T],
    pub(super) out: &'a mut [T],
}

impl<T: Real> WeightedRestrict<'_, T> {
    /// Adds what layer `k` gives to coarse layer `h`, which lies at `base` of the output.
    #[inline(always)]
    fn add(&mut self, k: usize, h: usize, base: usize) {
        let (s, [x, middle, last]) = (self.stencil, self.transfer);
        let stride = self.coarse_axes[0].cells() + 2;
        let around = [-1, 0, 1].map(|d| s.layer_of(self.phi, k as isize + d));
        let own = last.parents[k][0] == h;
        let beside = last.neighbours[k] == (h, true);
        let one = T::of(1.0);
        for j in 0..s.cells[1] {
            s.apply(around, j, k, self.row);
            let at = (k * s.cells[1] + j) * s.stride();
            let [first, n] = s.span(j, k);
            let (f, applied) = (&self.f[at + 1 + first..][..n], &self.row[first..][..n]);
            let [ta, tb, tc] = self.pulls.each_ref().map(|t| &t[at + first..][..n]);
            let (own_groups, beside_groups) = (&x.parents[first..][..n], &x.neighbours[first..][..n]);
            let share = |a: usize, i: usize, g: usize| self.axes[a].widths[i] / self.coarse_axes[a].widths[g];
            let (g, (g_beside, open)) = (middle.parents[j][0], middle.neighbours[j]);
            let here = T::of(share(1, j, g) * share(2, k, h));
            let there = T::of(if open { share(1, j, g_beside) * share(2, k, h) } else { 0.0 });
            let (here_at, there_at) = (base + g * stride + 1, base + g_beside * stride + 1);
            for i in 0..n {
                let (p, (q, open)) = (own_groups[i][0], beside_groups[i]);
                let r = f[i] - applied[i];
                let part = r * T::of(share(0, first + i, p));
                if own {
                    self.out[here_at + p] += here * part * (one - ta[i] - tb[i] - tc[i]);
                    self.out[there_at + p] += there * part * tb[i];
                    if open {
                        self.out[here_at + q] += here * r * T::of(share(0, first + i, q)) * ta[i];
                    }
                }
                if beside {
                    self.out[here_at + p] += here * part * tc[i];
                }
            }
        }
    }
}

impl<T: Real> WithSimd for WeightedRestrict<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        let last = &self.transfer[2];
        let layer = (self.coarse_axes[0].cells() + 2) * self.coarse_axes[1].cells();
        let n = self.stencil.cells[2];
        self.out.fill(T::default());
        for i in 0..self.out.len() / layer {
            let h = self.start + i;
            let (from, to) = (last.groups[h], last.groups[h + 1]);
            for k in from..to {
                self.add(k, h, i * layer);
            }
            // The halves of the groups beside that look here.
            let (below, above) = ((from + n - 1) % n, to % n);
            for (k, is_new) in [(below, true), (above, above != below)] {
                let outside = k < from || k >= to;
                if outside && is_new && last.neighbours[k] == (h, true) {
                    self.add(k, h, i * layer);
                }
            }
        }
    }
}
