//! Restriction of the residual and interpolation of the correction, layer by layer.
use super::axis::Transfer;
use super::stencil::Stencil;
use pulp::{Simd, WithSimd};

/// Layers that the restriction keeps.
const KEPT: usize = 4;

/// Work space of a task of the restriction.
pub(super) struct RestrictScratch {
    /// Layers of the residual, restricted along the middle axis.
    layers: Vec<f32>,
    /// Which layer each of them is.
    tags: [usize; KEPT],
    row: Vec<f32>,
}

impl RestrictScratch {
    pub(super) fn new(stencil: &Stencil<f32>, coarse_rows: usize) -> Self {
        let n = stencil.cells[0];
        Self { layers: vec![0.0; KEPT * n * coarse_rows], tags: [usize::MAX; KEPT], row: vec![0.0; n] }
    }
}

/// Restricts f − A φ to a run of coarse layers.
pub(super) struct Restrict<'a> {
    pub(super) stencil: &'a Stencil<f32>,
    pub(super) transfer: &'a [Transfer; 3],
    pub(super) phi: &'a [f32],
    pub(super) f: &'a [f32],
    /// First coarse layer.
    pub(super) start: usize,
    /// Values of a coarse layer and of a coarse row.
    pub(super) layer: usize,
    pub(super) stride: usize,
    pub(super) out: &'a mut [f32],
    pub(super) scratch: &'a mut RestrictScratch,
}

impl Restrict<'_> {
    /// Computes the residual in layer `k`, restricts it along the middle axis and keeps it.
    #[inline(always)]
    fn residual(&mut self, k: usize) {
        let (s, [_, middle, _]) = (self.stencil, self.transfer);
        let n = s.cells[0];
        let size = n * middle.children.len();
        let kept = &mut self.scratch.layers[k % KEPT * size..][..size];
        self.scratch.tags[k % KEPT] = k;
        let row = &mut self.scratch.row[..n];
        let around = [-1, 0, 1].map(|d| s.layer_of(self.phi, k as isize + d));
        kept.fill(0.0);
        for j in 0..s.cells[1] {
            s.apply(around, j, k, row);
            let f = &self.f[k * s.layer() + j * s.stride() + 1..][..n];
            for m in 0..2 {
                let share = middle.shares[j][m];
                if share != 0.0 {
                    let kept = &mut kept[middle.parents[j][m] * n..][..n];
                    for i in 0..n {
                        kept[i] += share * (f[i] - row[i]);
                    }
                }
            }
        }
    }
}

impl WithSimd for Restrict<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        let (n, [x, middle, last]) = (self.stencil.cells[0], self.transfer);
        let rows = middle.children.len();
        self.scratch.tags = [usize::MAX; KEPT];
        for i in 0..self.out.len() / self.layer {
            let children = &last.children[self.start + i];
            for &(k, _) in children {
                if self.scratch.tags[k % KEPT] != k {
                    self.residual(k);
                }
            }
            for j in 0..rows {
                let RestrictScratch { layers, row, .. } = &mut *self.scratch;
                let row = &mut row[..n];
                row.fill(0.0);
                for &(k, share) in children {
                    let kept = &layers[(k % KEPT * rows + j) * n..][..n];
                    for i in 0..n {
                        row[i] += share * kept[i];
                    }
                }
                let out = &mut self.out[i * self.layer + j * self.stride + 1..][..x.children.len()];
                for (out, children) in out.iter_mut().zip(&x.children) {
                    *out = children.iter().map(|&(i, share)| share * row[i]).sum();
                }
            }
        }
    }
}

/// Work space of a task of the interpolation.
pub(super) struct ProlongScratch {
    /// Two coarse layers, interpolated along x.
    layers: Vec<f32>,
    /// Which layer each of them is.
    tags: [usize; 2],
}

impl ProlongScratch {
    pub(super) fn new(stencil: &Stencil<f32>, coarse_rows: usize) -> Self {
        Self { layers: vec![0.0; 2 * stencil.cells[0] * coarse_rows], tags: [usize::MAX; 2] }
    }
}

/// Adds the interpolated correction to a run of layers.
pub(super) struct Prolong<'a> {
    pub(super) stencil: &'a Stencil<f32>,
    pub(super) transfer: &'a [Transfer; 3],
    /// Layout and φ of the coarse level.
    pub(super) coarse: (&'a Stencil<f32>, &'a [f32]),
    /// First layer of `phi`.
    pub(super) start: usize,
    pub(super) phi: &'a mut [f32],
    pub(super) scratch: &'a mut ProlongScratch,
}

impl Prolong<'_> {
    /// Interpolates coarse layer `k` along x unless that is done, in a place that is not `busy`; tells the place.
    #[inline(always)]
    fn along_x(&mut self, k: usize, busy: Option<usize>) -> usize {
        if let Some(place) = self.scratch.tags.iter().position(|&tag| tag == k) {
            return place;
        }
        let place = busy.map_or(0, |busy| 1 - busy);
        self.scratch.tags[place] = k;
        let (n, x) = (self.stencil.cells[0], &self.transfer[0]);
        let (coarse, phi) = self.coarse;
        let [count, rows, _] = coarse.cells;
        for j in 0..rows {
            let from = &phi[(k * rows + j) * coarse.stride() + 1..][..count];
            let to = &mut self.scratch.layers[(place * rows + j) * n..][..n];
            for ((to, p), w) in to.iter_mut().zip(&x.parents).zip(&x.weights) {
                *to = w[0] * from[p[0]] + w[1] * from[p[1]];
            }
        }
        place
    }
}

impl WithSimd for Prolong<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        let (s, [_, middle, last]) = (self.stencil, self.transfer);
        let (n, rows) = (s.cells[0], self.coarse.0.cells[1]);
        self.scratch.tags = [usize::MAX; 2];
        for i in 0..self.phi.len() / s.layer() {
            let k = self.start + i;
            let [near, far] = last.parents[k];
            // What the next layers need stays.
            let first = self.along_x(near, self.scratch.tags.iter().position(|&tag| tag == far));
            let second = self.along_x(far, Some(first));
            let [u, v] = last.weights[k];
            for j in 0..s.cells[1] {
                let ([p, q], [a, b]) = (middle.parents[j], middle.weights[j]);
                let from = |place: usize, j: usize| &self.scratch.layers[(place * rows + j) * n..][..n];
                let to = &mut self.phi[i * s.layer() + j * s.stride()..][..n + 2];
                let inner = &mut to[1..n + 1];
                let (x, y) = (from(first, p), from(second, p));
                if b == 0.0 {
                    let (u, v) = (a * u, a * v);
                    for i in 0..n {
                        inner[i] += u * x[i] + v * y[i];
                    }
                } else {
                    let (z, w) = (from(first, q), from(second, q));
                    for i in 0..n {
                        inner[i] += u * (a * x[i] + b * z[i]) + v * (a * y[i] + b * w[i]);
                    }
                }
                s.set_ghosts(to);
            }
        }
    }
}
