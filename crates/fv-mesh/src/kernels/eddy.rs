//! The stress of an eddy viscosity.
use super::{for_rows, row_place};
use crate::field::row_start;
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::spans::Spans;
use crate::{CartesianGrid, Field};
use pulp::{Arch, Simd, WithSimd};

/// out += ∂/∂x_b [ν_t (∂u_c/∂x_b + ∂u_b/∂x_c)] at the nodes of component `c`; `eddy` is ν_t at the centres with its
/// ghosts filled. On edges ν_t is interpolated linearly from the four cells around.
pub(crate) fn add_eddy_stress<const D: usize>(
    (grid, metrics, spans): (&CartesianGrid<D>, &Metrics<D>, &Spans),
    c: usize,
    velocity: &[Field<D>; D],
    eddy: &Field<D>,
    out: &mut Field<D>,
) {
    for_rows(grid, out, |rows, start, out| {
        let (u, eddy) = (velocity.each_ref().map(Field::data), eddy.data());
        Arch::new().dispatch(Rows { grid, metrics, spans, c, u, eddy, rows, start, out });
    });
}

struct Rows<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    metrics: &'a Metrics<D>,
    spans: &'a Spans,
    c: usize,
    u: [&'a [f64]; D],
    eddy: &'a [f64],
    rows: std::ops::Range<usize>,
    /// Storage index of the first entry of `out`.
    start: usize,
    out: &'a mut [f64],
}

impl<const D: usize> WithSimd for Rows<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { grid, metrics, spans, c, u, eddy, rows, start, out } = self;
        let (n, s) = (grid.cells()[0], grid.stride());
        for r in rows {
            let (span, at) = (spans.of(r, n), row_place(grid, r));
            let (o, from) = (row_start(grid, r) + span.start, span.start);
            let out = &mut out[o - start..][..span.len()];
            let place = |a: usize, i: usize| GHOSTS + if a == 0 { from + i } else { at[a] };
            for b in 0..D {
                let (nodes, gap_c) = (metrics.of(Some(c), b), &metrics.axes[c].faces.inv_volume);
                // Linear between the cells on both sides of a face: the farther cell's width counts for the nearer.
                let (along_b, along_c) = (&metrics.axes[b].share, &metrics.axes[c].share);
                for (i, out) in out.iter_mut().enumerate() {
                    let (o, j, m) = (o + i, place(b, i), place(c, i));
                    // Through the interface below storage index `k`, entry `j` of the metrics along b.
                    let flux = |k: usize, j: usize| {
                        let slope = nodes.inv_gap[j] * (u[c][k] - u[c][k - s[b]]);
                        if b == c {
                            return 2.0 * eddy[k - s[b]] * slope;
                        }
                        let beside = |k: usize| along_c[1][m] * eddy[k - s[c]] + along_c[0][m] * eddy[k];
                        let viscosity = along_b[1][j] * beside(k - s[b]) + along_b[0][j] * beside(k);
                        viscosity * (slope + gap_c[m] * (u[b][k] - u[b][k - s[c]]))
                    };
                    *out += nodes.inv_volume[j] * (flux(o + s[b], j + 1) - flux(o, j));
                }
            }
        }
    }
}
