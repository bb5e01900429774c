//! Which axis is swept, which are transformed, and where the data of a solve lie.
use super::super::{PoissonAxis, PoissonError};
use super::gemm::{MR, Side};
use super::sweep::{LANES, Sweep, SweepScratch};
use super::transform::{Transform, TransformScratch};
use crate::parts::least_parts;
use pulp::Simd;

/// Parts that layers and blocks are shared out in, whatever the number of threads.
const PARTS: usize = 16;
/// Real numbers of a cache line.
const LINE: usize = 8;

/// What a solve needs to know. In two dimensions the second axis stands in the last place and the
/// middle one has a single cell.
///
/// Data lie in one of two orders: layer by layer (x fastest, from one index of the last axis to the
/// next), or in blocks of [`LANES`] columns along the last axis, each cell by cell.
pub(super) struct Layout {
    pub(super) cells: [usize; 3],
    /// From layer to layer.
    pub(super) stride: usize,
    /// Layers per part.
    pub(super) layers: usize,
    /// Blocks in all.
    pub(super) blocks: usize,
    /// Blocks per part.
    pub(super) blocks_per_part: usize,
    /// Which axis is swept.
    pub(super) swept: usize,
    pub(super) sweep: Sweep,
    /// None for the swept axis and the one that two dimensions lack.
    pub(super) transforms: [Option<Transform>; 3],
    /// Minus the eigenvalues of the axes \[1/m²\]; zeros where there is no transform.
    eigenvalues: [Vec<f64>; 3],
    shift: f64,
    /// What the mean of f is multiplied with by the transforms.
    pub(super) mean_gain: f64,
    /// No φ exists unless f has zero mean.
    pub(super) singular: bool,
}

impl Layout {
    /// The least number of parts that a thread takes.
    pub(super) fn least_parts(&self) -> usize {
        least_parts(self.cells.iter().product())
    }
}

/// Work space of a part.
pub(super) struct Scratch {
    pub(super) transform: TransformScratch,
    pub(super) sweep: SweepScratch,
    /// Swept lines, side by side.
    pub(super) panel: Vec<f64>,
    /// The first row with a value that is not finite, and the sum of its absolute values.
    pub(super) bad: Option<(usize, f64)>,
}

impl Layout {
    pub(super) fn new(
        axes: [Option<&PoissonAxis>; 3],
        swept: usize,
        shift: f64,
    ) -> Result<Self, PoissonError> {
        let cells = axes.map(|a| a.map_or(1, PoissonAxis::cells));
        let mut transforms = [None, None, None];
        let mut eigenvalues = cells.map(|n| vec![0.0; n]);
        let (mut mean_gain, mut gain) = (1.0, 1.0);
        let mut sweep = None;
        for (a, axis) in axes.iter().enumerate() {
            let Some(axis) = axis else { continue };
            if a == swept {
                sweep = Some(axis);
                continue;
            }
            // The place of the axis as the caller numbers it.
            let place = if axes[1].is_none() { a / 2 } else { a };
            let side = if a == 0 { Side::Right } else { Side::Left };
            let (transform, values, factor) = Transform::new(axis, place, side)?;
            mean_gain *= factor;
            gain *= transform.gain(axis.cells());
            eigenvalues[a] = values;
            transforms[a] = Some(transform);
        }
        let sweep = Sweep::new(sweep.ok_or(PoissonError::NoCells { axis: swept })?, 1.0 / gain);

        let blocks = (cells[0] * cells[1]).div_ceil(LANES);
        // Single rows are put together so that they fill the groups they are worked on in.
        let group = match (&transforms[0], cells[1]) {
            (None, 1) => LANES,
            (Some(Transform::Dense(_)), 1) => MR,
            (Some(Transform::Fast(_)), 1) => 2,
            _ => 1,
        };
        Ok(Self {
            // An odd number of cache lines spreads the layers over the sets of the caches.
            stride: ((blocks * LANES / LINE) | 1) * LINE,
            layers: cells[2].div_ceil(PARTS).next_multiple_of(group).min(cells[2]),
            blocks,
            blocks_per_part: blocks.div_ceil(PARTS),
            swept,
            sweep,
            transforms,
            singular: shift == 0.0 && axes.iter().flatten().all(|a| a.is_free()),
            eigenvalues,
            shift,
            mean_gain,
            cells,
        })
    }

    /// Work space for every part.
    pub(super) fn scratch(&self) -> Vec<Scratch> {
        let parts = self.cells[2].div_ceil(self.layers).max(self.blocks.div_ceil(self.blocks_per_part));
        let [x, y, z] = &self.transforms;
        let panel = if self.swept == 2 { 0 } else { self.cells[self.swept] * LANES };
        let one = || Scratch {
            transform: TransformScratch::new(x.as_ref(), [(y.as_ref(), self.cells[0]), (z.as_ref(), LANES)]),
            sweep: self.sweep.scratch(),
            panel: vec![0.0; panel],
            bad: None,
        };
        (0..parts).map(|_| one()).collect()
    }

    /// σ of the mode with these places along the axes.
    #[inline(always)]
    fn sigma(&self, i: usize, j: usize, k: usize) -> f64 {
        self.eigenvalues[0][i] + self.eigenvalues[1][j] + self.eigenvalues[2][k] + self.shift
    }

    /// Transforms within layers that lie `stride` apart.
    #[inline(always)]
    pub(super) fn transform_layers<S: Simd>(
        &self,
        simd: S,
        data: &mut [f64],
        stride: usize,
        forward: bool,
        scratch: &mut TransformScratch,
    ) {
        let [nx, ny, _] = self.cells;
        let [x, y, _] = &self.transforms;
        if ny == 1 {
            if let Some(x) = x {
                x.rows(simd, data, stride, data.len() / stride, forward, scratch);
            }
            return;
        }
        for layer in data.chunks_exact_mut(stride) {
            if let (Some(x), true) = (x, forward) {
                x.rows(simd, layer, nx, ny, true, scratch);
            }
            if let Some(y) = y {
                y.columns(simd, layer, nx, nx, forward, scratch);
            }
            if let (Some(x), false) = (x, forward) {
                x.rows(simd, layer, nx, ny, false, scratch);
            }
        }
    }

    /// Gathers layer `k` from the blocks.
    #[inline(always)]
    pub(super) fn gather(&self, blocks: &[f64], k: usize, layer: &mut [f64]) {
        let block = self.cells[2] * LANES;
        for (to, block) in layer.chunks_mut(LANES).zip(blocks.chunks_exact(block)) {
            to.copy_from_slice(&block[k * LANES..][..to.len()]);
        }
    }

    /// Sweeps block `b` along the last axis; it is taken from `layers`.
    #[inline(always)]
    pub(super) fn sweep_block<S: Simd>(
        &self,
        simd: S,
        b: usize,
        layers: &[f64],
        block: &mut [f64],
        scratch: &mut SweepScratch,
    ) {
        for (to, layer) in block.chunks_exact_mut(LANES).zip(layers.chunks_exact(self.stride)) {
            to.copy_from_slice(&layer[b * LANES..][..LANES]);
        }
        let [nx, ny, _] = self.cells;
        let sigma = std::array::from_fn(|lane| {
            let column = b * LANES + lane;
            if column < nx * ny { self.sigma(column % nx, column / nx, 0) } else { 1.0 }
        });
        self.solve(simd, b == 0, &sigma, block, scratch);
    }

    /// Sweeps layers, the first of which is layer `first`, along x.
    #[inline(always)]
    pub(super) fn sweep_x<S: Simd>(&self, simd: S, first: usize, layers: &mut [f64], scratch: &mut Scratch) {
        let [nx, ny, _] = self.cells;
        let rows = layers.len() / self.stride * ny;
        let start = |r: usize| r / ny * self.stride + r % ny * nx;
        let panel = &mut scratch.panel[..];
        for group in (0..rows).step_by(LANES) {
            let end = rows.min(group + LANES);
            // Lanes past the end repeat the last row; what they give is dropped.
            for lane in (0..LANES).step_by(LINE) {
                let lines: [&[f64]; LINE] = std::array::from_fn(|q| {
                    let r = (group + lane + q).min(end - 1);
                    &layers[start(r)..][..nx]
                });
                for (i, to) in panel.chunks_exact_mut(LANES).enumerate() {
                    let values: [f64; LINE] = std::array::from_fn(|q| lines[q][i]);
                    to[lane..lane + LINE].copy_from_slice(&values);
                }
            }
            let sigma = std::array::from_fn(|lane| {
                let r = (group + lane).min(end - 1);
                self.sigma(0, r % ny, first + r / ny)
            });
            self.solve(simd, first + group == 0, &sigma, panel, &mut scratch.sweep);
            for i in (0..nx).step_by(LINE) {
                let panel = &panel[i * LANES..nx.min(i + LINE) * LANES];
                for r in group..end {
                    let row = &mut layers[start(r) + i..][..panel.len() / LANES];
                    for (to, from) in row.iter_mut().zip(panel.chunks_exact(LANES)) {
                        *to = from[r - group];
                    }
                }
            }
        }
    }

    /// Sweeps layers, the first of which is layer `first`, along y.
    #[inline(always)]
    pub(super) fn sweep_y<S: Simd>(&self, simd: S, first: usize, layers: &mut [f64], scratch: &mut Scratch) {
        let [nx, ny, _] = self.cells;
        let panel = &mut scratch.panel[..];
        for (k, layer) in layers.chunks_exact_mut(self.stride).enumerate() {
            for start in (0..nx).step_by(LANES) {
                let width = LANES.min(nx - start);
                for (to, from) in panel.chunks_exact_mut(LANES).zip(layer.chunks_exact(nx)) {
                    to[..width].copy_from_slice(&from[start..][..width]);
                }
                let sigma = std::array::from_fn(|lane| {
                    if lane < width { self.sigma(start + lane, 0, first + k) } else { 1.0 }
                });
                self.solve(simd, first + k + start == 0, &sigma, panel, &mut scratch.sweep);
                for (from, to) in panel.chunks_exact(LANES).zip(layer.chunks_exact_mut(nx)).take(ny) {
                    to[start..][..width].copy_from_slice(&from[..width]);
                }
            }
        }
    }

    /// Solves a panel, the first lane of which may be the constant mode of the box.
    #[inline(always)]
    fn solve<S: Simd>(
        &self,
        simd: S,
        first: bool,
        sigma: &[f64; LANES],
        panel: &mut [f64],
        scratch: &mut SweepScratch,
    ) {
        self.sweep.solve(simd, sigma, panel, scratch);
        if first && self.singular {
            let mean = self.sweep.mean(|i| panel[i * LANES]);
            panel.iter_mut().step_by(LANES).for_each(|u| *u -= mean);
        }
    }
}
