//! Stress by an eddy viscosity.
use crate::field::row_start;
use crate::grid::GHOSTS;
use crate::kernels::{layers_per_task, row_place};
use crate::metrics::Metrics;
use crate::{CartesianGrid, Field};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Adds component `c` of ∇·(2 ν_t S), S = ½(∇u + ∇uᵀ), to `out`; ν_t is given at the cell centres, ghosts included.
pub(crate) fn add_eddy_stress<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    c: usize,
    eddy: &Field<D>,
    velocity: &[Field<D>; D],
    out: &mut Field<D>,
) {
    let layer = grid.stride()[D - 1];
    let layers = grid.cells()[D - 1];
    let (per_task, rows_per_layer) = (layers_per_task(layers), grid.rows_per_layer());
    out.layers_mut().par_chunks_mut(layer * per_task).enumerate().for_each(|(task, out)| {
        let first = task * per_task;
        let rows = first * rows_per_layer..(first + per_task).min(layers) * rows_per_layer;
        let start = (GHOSTS + first) * layer;
        Arch::new().dispatch(Rows { grid, metrics, c, eddy: eddy.data(), velocity, rows, start, out });
    });
}

struct Rows<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    metrics: &'a Metrics<D>,
    c: usize,
    eddy: &'a [f64],
    velocity: &'a [Field<D>; D],
    rows: std::ops::Range<usize>,
    /// Storage index of the first entry of `out`.
    start: usize,
    out: &'a mut [f64],
}

impl<const D: usize> WithSimd for Rows<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { grid, metrics, c, eddy, velocity, rows, start, out } = self;
        let (n, s) = (grid.cells()[0], grid.stride());
        let u = velocity[c].data();
        for r in rows {
            let (o, at) = (row_start(grid, r), row_place(grid, r));
            let out = &mut out[o - start..][..n];
            for b in 0..D {
                let (nodes, v) = (metrics.of(Some(c), b), velocity[b].data());
                // Of the component along b at the edges: its nodes lie along c as cells do.
                let gap_c = &metrics.of(Some(b), c).inv_gap;
                let place = |a: usize, i: usize| GHOSTS + if a == 0 { i } else { at[a] };
                for (i, out) in out.iter_mut().enumerate() {
                    let (k, j) = (o + i, place(b, i));
                    // ν_t (∂u_c/∂x_b + ∂u_b/∂x_c) on the edge below storage index `k`, entry `j` of the metrics.
                    let stress = |k: usize, j: usize| {
                        let slope = nodes.inv_gap[j] * (u[k] - u[k - s[b]]);
                        if b == c {
                            return 2.0 * eddy[k - s[b]] * slope;
                        }
                        let viscosity =
                            0.25 * (eddy[k] + eddy[k - s[c]] + eddy[k - s[b]] + eddy[k - s[b] - s[c]]);
                        viscosity * (slope + gap_c[place(c, i)] * (v[k] - v[k - s[c]]))
                    };
                    *out += nodes.inv_volume[j] * (stress(k + s[b], j + 1) - stress(k, j));
                }
            }
        }
    }
}
