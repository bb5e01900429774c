//! What bounded sides do to the momentum of the fluid.
use crate::grid::GHOSTS;
use crate::kernels::{Momentum, flux};
use crate::metrics::Metrics;
use crate::{CartesianGrid, Field};
use interfaces::Vector;

/// Momentum that convection and viscosity carry through the bounded sides into the unknowns, per
/// density and time \[m⁴/s²\]: for a component along a side the flux through it (friction, at a wall); for the
/// component normal to it, whose first unknown is one face off the side, the flux through the first cell. First
/// convection (by the first of the velocities, of the second) with the viscous flux along axes of `explicit` viscosity, then the viscous flux along those of `implicit`.
pub(crate) fn friction<const D: usize>(
    momentum: &Momentum<D>,
    metrics: &Metrics<D>,
    grid: &CartesianGrid<D>,
    velocities: [&[Field<D>; D]; 2],
    explicit: [f64; D],
    implicit: [f64; D],
) -> [Vector; 2] {
    let (s, n) = (grid.stride(), grid.cells());
    let mut sums = [Vector::zeros(); 2];
    for a in (0..D).filter(|&a| !metrics.periodic[a]) {
        for c in 0..D {
            each_boundary_cell(grid, metrics, a, c, |o, at, area| {
                let first = usize::from(a == c);
                let place = [GHOSTS + at[c], GHOSTS];
                let [low, high] = [first, n[a]]
                    .map(|i| flux(momentum, velocities, [c, a], o + i * s[a], [place[0], place[1] + i]));
                sums[0][c] += area * ((low[0] - high[0]) - explicit[a] * (low[1] - high[1]));
                sums[1][c] -= area * implicit[a] * (low[1] - high[1]);
            });
        }
    }
    sums
}

/// Force of the pressure at the bounded sides on the unknowns \[N\].
pub(crate) fn thrust<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    pressure: &Field<D>,
) -> Vector {
    let (s, n, p) = (grid.stride(), grid.cells(), pressure.data());
    let mut sum = Vector::zeros();
    for a in (0..D).filter(|&a| !metrics.periodic[a]) {
        each_boundary_cell(grid, metrics, a, a, |o, _, area| {
            sum[a] += area * (p[o] - p[o + (n[a] - 1) * s[a]])
        });
    }
    sum
}

/// Calls `f` with the storage index of every cell at the lower side of axis `a` whose node of
/// component `c` is an unknown, its place, and the area across `a` of that node's control volume.
#[inline(always)]
pub(crate) fn each_boundary_cell<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    a: usize,
    c: usize,
    mut f: impl FnMut(usize, [usize; 3], f64),
) {
    let (n, s) = (grid.cells(), grid.stride());
    let range = |b: usize| {
        if b >= D || b == a { 0..1 } else { usize::from(b == c && !metrics.periodic[b])..n[b] }
    };
    let volume = |b: usize, i: usize| {
        if b >= D || b == a { 1.0 } else { metrics.of(Some(c), b).volume[GHOSTS + i] }
    };
    for k in range(2) {
        for j in range(1) {
            let across = volume(1, j) * volume(2, k);
            let start = grid.base() + (1..D).map(|b| [0, j, k][b] * s[b]).sum::<usize>();
            for i in range(0) {
                f(start + i, [i, j, k], volume(0, i) * across);
            }
        }
    }
}
