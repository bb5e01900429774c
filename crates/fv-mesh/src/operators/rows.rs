//! Kernels that fill one row along x, and who runs them. Rows are handed to threads in fixed chunks of layers, so a
//! result does not depend on the number of threads.
use crate::grid::GHOSTS;
use crate::kernels::layers_per_task;
use crate::parts::each_part;
use crate::spans::Spans;
use crate::{CartesianGrid, Field};
use pulp::{Arch, Simd, WithSimd};

/// Fills rows along x.
pub(crate) trait RowKernel<const D: usize>: Sync {
    /// A part of a row; `at` is the place of its first value, `o` the storage index of that. Implementations are
    /// `#[inline(always)]`, so that they are compiled for the processor at hand.
    fn row(&self, at: [usize; D], o: usize, out: &mut [f64]);
}

/// Runs `kernel` over the values 0 … `extent` − 1 along each axis of a field; `spans` are those of the cells.
pub(crate) fn fill_rows<const D: usize>(
    grid: &CartesianGrid<D>,
    extent: [usize; D],
    spans: &Spans,
    kernel: &impl RowKernel<D>,
    out: &mut Field<D>,
) {
    let layer = grid.stride()[D - 1];
    let inner = if D == 3 { grid.stride()[1] } else { 0 };
    let start = GHOSTS + GHOSTS * inner;
    let values = &mut out.data_mut()[GHOSTS * layer..(GHOSTS + extent[D - 1]) * layer];
    run(grid, (extent, spans), kernel, [layer, inner, start], values);
}

/// Runs `kernel` over all cells in `spans`, into dense values, x fastest.
pub(crate) fn fill_dense<const D: usize>(
    grid: &CartesianGrid<D>,
    spans: &Spans,
    kernel: &impl RowKernel<D>,
    out: &mut [f64],
) {
    let n = grid.cells();
    run(grid, (n, spans), kernel, [n[0] * grid.rows_per_layer(), n[0], 0], out);
}

/// `shape` is the distance of layers and of rows in `out`, and where the first row starts in a layer.
fn run<const D: usize>(
    grid: &CartesianGrid<D>,
    (extent, spans): ([usize; D], &Spans),
    kernel: &impl RowKernel<D>,
    shape: [usize; 3],
    out: &mut [f64],
) {
    let per_task = layers_per_task(extent[D - 1]);
    each_part(out, shape[0] * per_task, &|task, out| {
        Arch::new().dispatch(Run { grid, extent, spans, kernel, shape, first: task * per_task, out });
    });
}

/// A run of layers.
struct Run<'a, K, const D: usize> {
    grid: &'a CartesianGrid<D>,
    extent: [usize; D],
    spans: &'a Spans,
    kernel: &'a K,
    shape: [usize; 3],
    first: usize,
    out: &'a mut [f64],
}

impl<K: RowKernel<D>, const D: usize> WithSimd for Run<'_, K, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { grid, extent, spans, kernel, shape: [layer, inner, start], first, out } = self;
        let s = grid.stride();
        for (k, out) in out.chunks_exact_mut(layer).enumerate() {
            for j in 0..if D == 3 { extent[1] } else { 1 } {
                let mut at = [0; D];
                at[D - 1] = first + k;
                if D == 3 {
                    at[1] = j;
                }
                let row = if D == 3 { j + extent[1] * at[2] } else { at[D - 1] };
                let span = spans.of(row, extent[0]);
                at[0] = span.start;
                let o = grid.base() + at[0] + (1..D).map(|b| at[b] * s[b]).sum::<usize>();
                let local = start + j * inner;
                kernel.row(at, o, &mut out[local..][span]);
            }
        }
    }
}
