//! What bounded sides do to the momentum of the fluid.
use crate::{CartesianGrid, Field, Sides};
use interfaces::Vector;

/// Momentum that convection and viscosity carry through the bounded sides into the unknowns, per
/// density and time \[m⁴/s²\]: for a component along a wall the friction, ν ∂u/∂n; for the component
/// normal to it, whose first unknown is one face off the wall, the flux through the first cell.
pub(crate) fn friction<const D: usize>(
    grid: &CartesianGrid<D>,
    sides: &Sides<D>,
    velocity: &[Field<D>; D],
    viscosity: f64,
) -> Vector {
    let (h, s, n) = (grid.spacing(), grid.stride(), grid.cells());
    let mut sum = Vector::zeros();
    for a in (0..D).filter(|&a| !sides.periodic(a)) {
        let area = grid.cell_volume() / h[a];
        for c in 0..D {
            let u = velocity[c].data();
            // Flux from node i−1 to node i along a, at storage index i.
            let flux = |i: usize| {
                let viscous = -viscosity * (u[i] - u[i - s[a]]) / h[a];
                if a == c { 0.25 * (u[i] + u[i - s[a]]).powi(2) + viscous } else { viscous }
            };
            each_boundary_cell(grid, sides, a, c, |o| {
                let first = if a == c { o + s[a] } else { o };
                sum[c] += area * (flux(first) - flux(o + n[a] * s[a]));
            });
        }
    }
    sum
}

/// Force of the pressure at the bounded sides on the unknowns \[N\].
pub(crate) fn thrust<const D: usize>(
    grid: &CartesianGrid<D>,
    sides: &Sides<D>,
    pressure: &Field<D>,
) -> Vector {
    let (h, s, n, p) = (grid.spacing(), grid.stride(), grid.cells(), pressure.data());
    let mut sum = Vector::zeros();
    for a in (0..D).filter(|&a| !sides.periodic(a)) {
        let area = grid.cell_volume() / h[a];
        each_boundary_cell(grid, sides, a, a, |o| sum[a] += area * (p[o] - p[o + (n[a] - 1) * s[a]]));
    }
    sum
}

/// Calls `f` with the storage index of every cell at the lower side of axis `a` whose node of
/// component `c` is an unknown.
fn each_boundary_cell<const D: usize>(
    grid: &CartesianGrid<D>,
    sides: &Sides<D>,
    a: usize,
    c: usize,
    mut f: impl FnMut(usize),
) {
    let (n, s) = (grid.cells(), grid.stride());
    let range = |b: usize| {
        if b >= D || b == a { 0..1 } else { usize::from(b == c && !sides.periodic(b))..n[b] }
    };
    for k in range(2) {
        for j in range(1) {
            for i in range(0) {
                let index = [i, j, k];
                f(grid.base() + (0..D).map(|b| index[b] * s[b]).sum::<usize>());
            }
        }
    }
}
