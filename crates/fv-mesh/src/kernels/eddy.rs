//! The stress of an eddy viscosity.
use super::row_place;
use crate::field::row_start;
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::{CartesianGrid, Field};

/// source_c += ∂/∂x_b [ν_t (∂u_c/∂x_b + ∂u_b/∂x_c)] at the nodes of component `c`; `eddy` is ν_t at the centres with its
/// ghosts filled. On edges ν_t is interpolated linearly from the four cells around.
pub(crate) fn add_eddy_stress<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    c: usize,
    velocity: &[Field<D>; D],
    eddy: &Field<D>,
    source: &mut Field<D>,
) {
    let (n, s) = (grid.cells()[0], grid.stride());
    let u: [&[f64]; D] = std::array::from_fn(|b| velocity[b].data());
    let nu = eddy.data();
    // Linear between the cells on both sides of a face: the farther cell's width counts for the nearer one.
    let share = |b: usize, i: usize| {
        let share = &metrics.axes[b].share;
        [share[1][i], share[0][i]]
    };
    for r in 0..source.n_rows() {
        let (o, mut at) = (row_start(grid, r), row_place(grid, r));
        for i in 0..n {
            at[0] = i;
            let o = o + i;
            let along = |b: usize| GHOSTS + at[b];
            let [low_c, high_c] = share(c, along(c));
            let mut sum = 0.0;
            for b in 0..D {
                let nodes = metrics.of(Some(c), b);
                // Flux through the interface between node k − 1 and node k along b, node k at p.
                let flux = |p: usize, k: usize| {
                    let slope = nodes.inv_gap[k] * (u[c][p] - u[c][p - s[b]]);
                    if b == c {
                        return 2.0 * nu[p - s[b]] * slope;
                    }
                    let [low_b, high_b] = share(b, k);
                    let at_edge = low_b * (low_c * nu[p - s[b] - s[c]] + high_c * nu[p - s[b]])
                        + high_b * (low_c * nu[p - s[c]] + high_c * nu[p]);
                    let across = metrics.axes[c].faces.inv_volume[along(c)] * (u[b][p] - u[b][p - s[c]]);
                    at_edge * (slope + across)
                };
                let k = along(b);
                sum += nodes.inv_volume[k] * (flux(o + s[b], k + 1) - flux(o, k));
            }
            source.data_mut()[o] += sum;
        }
    }
}
