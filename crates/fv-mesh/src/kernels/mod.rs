//! The sweeps of a time step over the rows of the grid. Rows are handed to threads in fixed
//! chunks of layers, so a result does not depend on the number of threads.
mod advance;
mod eddy;
mod project;
#[cfg(test)]
mod tests;

pub(crate) use advance::{Advance, LIMITED, LINEAR, Momentum, flux, upwinded};
pub(crate) use eddy::add_eddy_stress;
pub(crate) use project::{
    Conductance, add_dense, change, copy_dense, correct_component, divergence, divergence_row,
    subtract_second_differences, sum_dense,
};

use crate::grid::GHOSTS;
use crate::parts::{each_pair, each_part};
use crate::{CartesianGrid, Field};

/// Layers of the last axis that one task works on.
pub(crate) fn layers_per_task(layers: usize) -> usize {
    layers.div_ceil(16).max(4)
}

/// Calls `f` for fixed runs of rows, with the matching part of a field to write: `f` gets the numbers of the rows, the
/// storage index of the part's first entry and the part.
pub(crate) fn for_rows<const D: usize>(
    grid: &CartesianGrid<D>,
    field: &mut Field<D>,
    f: impl Fn(std::ops::Range<usize>, usize, &mut [f64]) + Sync,
) {
    let layer = grid.stride()[D - 1];
    let (layers, rows) = (grid.cells()[D - 1], grid.rows_per_layer());
    let per_task = layers_per_task(layers);
    each_part(field.layers_mut(), layer * per_task, &|task, part| {
        let first = task * per_task;
        let end = (first + per_task).min(layers);
        f(first * rows..end * rows, (GHOSTS + first) * layer, part);
    });
}

/// [`for_rows`] with two fields to write.
pub(crate) fn for_layers<const D: usize>(
    grid: &CartesianGrid<D>,
    a: &mut Field<D>,
    b: &mut Field<D>,
    f: impl Fn(std::ops::Range<usize>, usize, &mut [f64], &mut [f64]) + Sync,
) {
    let layer = grid.stride()[D - 1];
    let (layers, rows) = (grid.cells()[D - 1], grid.rows_per_layer());
    let per_task = layers_per_task(layers);
    each_pair(a.layers_mut(), b.layers_mut(), [layer * per_task; 2], &|task, a, b| {
        let first = task * per_task;
        let end = (first + per_task).min(layers);
        f(first * rows..end * rows, (GHOSTS + first) * layer, a, b);
    });
}

/// Cell numbers along the axes other than x of row `r` = j + n_y k.
pub(crate) fn row_place<const D: usize>(grid: &CartesianGrid<D>, r: usize) -> [usize; D] {
    let per_layer = grid.rows_per_layer();
    let mut at = [0; D];
    at[D - 1] = r / per_layer;
    if D == 3 {
        at[1] = r % per_layer;
    }
    at
}

/// Place of the face below the first cell of row `r` among the n_c + 1 faces of component `c` on each line, x fastest.
pub(crate) fn face_row<const D: usize>(grid: &CartesianGrid<D>, c: usize, r: usize) -> usize {
    let n = grid.cells();
    match (D, c) {
        (_, 0) => r * (n[0] + 1),
        (3, 1) => (r / n[1] * (n[1] + 1) + r % n[1]) * n[0],
        _ => r * n[0],
    }
}
