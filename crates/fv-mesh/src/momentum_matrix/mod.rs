//! Implicit momentum equations on the staggered control volumes.
mod assemble;
mod equations;
mod solver;

pub(crate) use assemble::Implicit;
use assemble::{Terms, assemble};
pub(crate) use equations::{Equation, MomentumEquations};
pub(crate) use solver::MomentumSolver;

use crate::boundary::{Boundaries, Extrapolation};
use crate::grid::GHOSTS;
use crate::linear::StencilMatrix;
use crate::metrics::Metrics;
use crate::{CartesianGrid, Field, FlowError};

/// Takes what stands beyond the ends of bounded axes out of the matrix of component `c`: a change δ of the node at an end
/// comes with δ beyond it if the value there is free, and by the parabola of the ghosts if it is fixed half way; the nodes on
/// the sides themselves follow (free) or stay (fixed).
pub(crate) fn fold_ends<const D: usize>(
    grid: &CartesianGrid<D>,
    boundaries: &Boundaries<D>,
    c: usize,
    matrix: &mut StencilMatrix<D>,
) {
    let cells = grid.cells();
    let (centre, lower, upper) = matrix.parts_mut();
    for a in 0..D {
        let Some(ends) = boundaries.ends(a, c) else { continue };
        let (lines, step) = (boundaries.lines(a), cells[..a].iter().product::<usize>());
        if a == c && cells[a] == 1 {
            continue;
        }
        let beyond = [false, true].map(|upper| {
            let e = Extrapolation::beyond(grid, a, upper);
            [e.first, e.second]
        });
        for l in (0..lines.len()).filter(|&l| lines.inside(l)) {
            let kind = ends.kind(l);
            let part = |bit: usize| match (kind & bit != 0, a == c) {
                (true, _) => [1.0, 0.0],
                (false, true) => [0.0; 2],
                (false, false) => beyond[bit - 1],
            };
            let first = lines.end_cell(grid, l, false) + if a == c { step } else { 0 };
            let last = lines.end_cell(grid, l, true);
            let (low, high) = (lower[a][first], upper[a][last]);
            let ([low_0, low_1], [high_0, high_1]) = (part(1), part(2));
            centre[first] += low_0 * low;
            upper[a][first] += low_1 * low;
            centre[last] += high_0 * high;
            lower[a][last] += high_1 * high;
            lower[a][first] = 0.0;
            upper[a][last] = 0.0;
        }
    }
}

/// Makes the equation of an unknown δ = `change`; its diagonal stays.
pub(crate) fn pin<const D: usize>(matrix: &mut StencilMatrix<D>, cell: usize, change: f64, rhs: &mut [f64]) {
    let (centre, lower, upper) = matrix.parts_mut();
    rhs[cell] = centre[cell] * change;
    for list in lower.into_iter().chain(upper) {
        list[cell] = 0.0;
    }
}

/// Σ |r| V over the control volumes of component `c`; r is dense.
pub(crate) fn absolute_sum<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    c: Option<usize>,
    r: &[f64],
) -> f64 {
    let n = grid.cells()[0];
    let along = &metrics.of(c, 0).volume[GHOSTS..][..n];
    let mut sum = 0.0;
    for (row, r) in r.chunks_exact(n).enumerate() {
        let at = crate::kernels::row_place(grid, row);
        let across: f64 = (1..D).map(|b| metrics.of(c, b).volume[GHOSTS + at[b]]).product();
        // Four sums side by side run faster.
        let mut parts = [0.0; 4];
        let (r4, r1) = r.as_chunks::<4>();
        let (w4, w1) = along.as_chunks::<4>();
        for (r, w) in r4.iter().zip(w4) {
            for l in 0..4 {
                parts[l] += r[l].abs() * w[l];
            }
        }
        let rest: f64 = r1.iter().zip(w1).map(|(r, w)| r.abs() * w).sum();
        sum += across * (parts.iter().sum::<f64>() + rest);
    }
    sum
}

/// out = the cells of `a` minus those of `b`.
pub(crate) fn difference<const D: usize>(a: &Field<D>, b: &Field<D>, out: &mut [f64]) {
    let n = out.len() / a.n_rows();
    for (r, out) in out.chunks_exact_mut(n).enumerate() {
        for ((out, a), b) in out.iter_mut().zip(a.row(r)).zip(b.row(r)) {
            *out = a - b;
        }
    }
}

/// Σ |u_c| A over all faces: what flows through the cells.
pub(crate) fn throughput<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    velocity: &[Field<D>; D],
) -> f64 {
    let n = grid.cells()[0];
    let mut sum = 0.0;
    for (c, u) in velocity.iter().enumerate() {
        let along = &metrics.axes[0].width[GHOSTS..][..n];
        for row in 0..u.n_rows() {
            let at = crate::kernels::row_place(grid, row);
            let across: f64 =
                (1..D).filter(|&b| b != c).map(|b| metrics.axes[b].width[GHOSTS + at[b]]).product();
            let mut parts = [0.0; 4];
            for (i, u) in u.row(row).iter().enumerate() {
                parts[i % 4] += if c == 0 { u.abs() } else { u.abs() * along[i] };
            }
            sum += across * parts.iter().sum::<f64>();
        }
    }
    sum
}

/// Number of the dense cell of a node of component `c` at which the velocity is to be `value`.
///
/// # Errors
/// [`FlowError::Parameter`].
pub(crate) fn check_node<const D: usize>(
    grid: &CartesianGrid<D>,
    c: usize,
    index: usize,
    value: f64,
) -> Result<usize, FlowError> {
    let fail = |name, value, range| Err(FlowError::Parameter { name, value, range });
    if c >= D {
        return fail("the component of a node", c as f64, "below the number of dimensions");
    }
    if !value.is_finite() {
        return fail("the velocity of a node", value, "finite");
    }
    match grid.cell_at(index) {
        Some(cell) => Ok(grid.index(cell)),
        None => fail("the index of a node", index as f64, "that of a node, not of a ghost"),
    }
}
