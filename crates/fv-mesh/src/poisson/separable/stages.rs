//! The passes of a solve over memory, each a task for `pulp` on a part of the data.
use super::super::Rows;
use super::layout::{Layout, Scratch};
use super::sweep::LANES;
use pulp::{Simd, WithSimd};

/// Fills layers with the right-hand side and transforms them.
pub(super) struct Forward<'a> {
    pub(super) layout: &'a Layout,
    /// First layer.
    pub(super) first: usize,
    pub(super) fill: Rows<'a>,
    pub(super) layers: &'a mut [f64],
    pub(super) scratch: &'a mut Scratch,
}

// A type rather than a closure: `pulp` compiles the body of `with_simd` for the processor at hand.
impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { layout, first, fill, layers, scratch } = self;
        let [nx, ny, _] = layout.cells;
        scratch.bad = None;
        for (k, layer) in layers.chunks_exact_mut(layout.stride).enumerate() {
            for (j, row) in layer[..nx * ny].chunks_exact_mut(nx).enumerate() {
                let r = (first + k) * ny + j;
                fill(r, row);
                let size = magnitude(row);
                if !size.is_finite() && scratch.bad.is_none() {
                    scratch.bad = Some((r, size));
                }
            }
            if ny > 1 {
                layout.transform_layers(simd, layer, layout.stride, true, &mut scratch.transform);
            }
        }
        if ny == 1 {
            layout.transform_layers(simd, layers, layout.stride, true, &mut scratch.transform);
        }
    }
}

/// What is done to the columns along the last axis.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Along {
    Sweep,
    Forward,
    Backward,
}

/// Sweeps or transforms columns along the last axis, from layers to blocks.
pub(super) struct Columns<'a> {
    pub(super) layout: &'a Layout,
    pub(super) along: Along,
    /// First block.
    pub(super) first: usize,
    /// All layers.
    pub(super) layers: &'a [f64],
    pub(super) blocks: &'a mut [f64],
    pub(super) scratch: &'a mut Scratch,
}

impl WithSimd for Columns<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { layout, along, first, layers, blocks, scratch } = self;
        for (b, block) in blocks.chunks_exact_mut(layout.cells[2] * LANES).enumerate() {
            let b = first + b;
            if along == Along::Sweep {
                layout.sweep_block(simd, b, layers, block, &mut scratch.sweep);
            } else if let Some(z) = &layout.transforms[2] {
                let from = (&layers[b * LANES..], layout.stride);
                z.columns_to(
                    simd,
                    from,
                    (block, LANES),
                    LANES,
                    along == Along::Forward,
                    &mut scratch.transform,
                );
            }
        }
    }
}

/// Sweeps along x or y, from blocks to layers.
pub(super) struct Layers<'a> {
    pub(super) layout: &'a Layout,
    /// First layer.
    pub(super) first: usize,
    /// All blocks.
    pub(super) blocks: &'a [f64],
    pub(super) layers: &'a mut [f64],
    pub(super) scratch: &'a mut Scratch,
}

impl WithSimd for Layers<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { layout, first, blocks, layers, scratch } = self;
        let cells = layout.cells[0] * layout.cells[1];
        for (k, layer) in layers.chunks_exact_mut(layout.stride).enumerate() {
            layout.gather(blocks, first + k, &mut layer[..cells]);
        }
        if layout.swept == 0 {
            layout.sweep_x(simd, first, layers, scratch);
        } else {
            layout.sweep_y(simd, first, layers, scratch);
        }
    }
}

/// Gathers layers of φ from the blocks and transforms them back.
pub(super) struct Backward<'a> {
    pub(super) layout: &'a Layout,
    /// First layer.
    pub(super) first: usize,
    /// All blocks.
    pub(super) blocks: &'a [f64],
    pub(super) phi: &'a mut [f64],
    pub(super) scratch: &'a mut Scratch,
}

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { layout, first, blocks, phi, scratch } = self;
        let cells = layout.cells[0] * layout.cells[1];
        // Whatever is transformed together is gathered together.
        let group = if layout.cells[1] == 1 { phi.len() } else { cells };
        let mut k = first;
        for part in phi.chunks_mut(group) {
            for layer in part.chunks_exact_mut(cells) {
                layout.gather(blocks, k, layer);
                k += 1;
            }
            layout.transform_layers(simd, part, cells, false, &mut scratch.transform);
        }
    }
}

/// Sum of the absolute values, in lanes.
#[inline(always)]
fn magnitude(row: &[f64]) -> f64 {
    let (lanes, rest) = row.as_chunks::<16>();
    let mut sums = [0.0; 16];
    for lane in lanes {
        for (sum, x) in sums.iter_mut().zip(lane) {
            *sum += x.abs();
        }
    }
    sums.iter().sum::<f64>() + rest.iter().map(|x| x.abs()).sum::<f64>()
}
