//! The two sweeps of a time step over the rows of the grid. Rows are handed to threads in fixed
//! chunks of layers, so a result does not depend on the number of threads.
use crate::field::row_start;
use crate::grid::GHOSTS;
use crate::{CartesianGrid, Field};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Layers of the last axis that one task works on.
pub(crate) fn layers_per_task(layers: usize) -> usize {
    layers.div_ceil(16).max(4)
}

/// Coefficients of one predictor sweep.
#[derive(Clone, Copy)]
pub(crate) struct Advance {
    /// Step \[s\].
    pub(crate) dt: f64,
    /// Weights of the new and the last tendency: 1 + r/2 and −r/2 with r = dt/dt_last.
    pub(crate) weights: [f64; 2],
    /// Kinematic viscosity \[m²/s\].
    pub(crate) viscosity: f64,
    /// 1/density \[m³/kg\].
    pub(crate) specific_volume: f64,
    /// Body force per mass along this component \[m/s²\].
    pub(crate) force: f64,
}

/// Calls `f(task, rows)` for fixed runs of rows, with the matching part of two fields to write.
/// `f` gets (first row's number, end row's number, storage index of the parts' first entry).
fn for_layers<const D: usize>(
    grid: &CartesianGrid<D>,
    a: &mut Field<D>,
    b: &mut Field<D>,
    f: impl Fn(std::ops::Range<usize>, usize, &mut [f64], &mut [f64]) + Sync,
) {
    let layer = grid.stride()[D - 1];
    let (layers, rows) = (grid.cells()[D - 1], grid.rows_per_layer());
    let per_task = layers_per_task(layers);
    a.layers_mut()
        .par_chunks_mut(layer * per_task)
        .zip(b.layers_mut().par_chunks_mut(layer * per_task))
        .enumerate()
        .for_each(|(task, (a, b))| {
            let first = task * per_task;
            let end = (first + per_task).min(layers);
            f(first * rows..end * rows, (GHOSTS + first) * layer, a, b);
        });
}

/// One component of u* = uⁿ + dt (w₀ Hⁿ + w₁ Hⁿ⁻¹ − ∂p/∂x_c /ρ + b), H = −∇·(u u_c) + ν∇²u_c, by
/// central differences that conserve momentum and, where ∇·u = 0, kinetic energy (Harlow & Welch
/// 1965; Morinishi et al. 1998). `tendency` comes in as Hⁿ⁻¹ and leaves as Hⁿ.
pub(crate) fn advance_component<const D: usize>(
    grid: &CartesianGrid<D>,
    c: usize,
    k: Advance,
    velocity: &[Field<D>; D],
    pressure: &Field<D>,
    next: &mut Field<D>,
    tendency: &mut Field<D>,
) {
    let u: [&[f64]; D] = std::array::from_fn(|b| velocity[b].data());
    let p = pressure.data();
    for_layers(grid, next, tendency, |rows, start, next, tendency| {
        let job = AdvanceRows { grid, rows, start, k, u, p, next, tendency };
        match c {
            0 => job.run::<0>(),
            1 => job.run::<1>(),
            _ => job.run::<2>(),
        }
    });
}

/// [`advance_component`] for a run of rows.
struct AdvanceRows<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    rows: std::ops::Range<usize>,
    /// Storage index of the first entry of `next` and `tendency`.
    start: usize,
    k: Advance,
    u: [&'a [f64]; D],
    p: &'a [f64],
    next: &'a mut [f64],
    tendency: &'a mut [f64],
}

impl<const D: usize> AdvanceRows<'_, D> {
    fn run<const C: usize>(self) {
        Arch::new().dispatch(OfComponent::<D, C>(self));
    }
}

// Types rather than closures: `pulp` compiles the body of `with_simd` for the processor at hand, while a
// closure that may be called more than once is compiled for the oldest.
struct OfComponent<'a, const D: usize, const C: usize>(AdvanceRows<'a, D>);

impl<const D: usize, const C: usize> WithSimd for OfComponent<'_, D, C> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let AdvanceRows { grid, rows, start, k, u, p, next, tendency } = self.0;
        let n = grid.cells()[0];
        for r in rows {
            let o = row_start(grid, r);
            let local = o - start..o - start + n;
            advance_row::<D, C>(grid, o, k, u, p, &mut next[local.clone()], &mut tendency[local]);
        }
    }
}

/// One row; `o` is the storage index of its first cell.
#[inline(always)]
fn advance_row<const D: usize, const C: usize>(
    grid: &CartesianGrid<D>,
    o: usize,
    k: Advance,
    u: [&[f64]; D],
    p: &[f64],
    next: &mut [f64],
    tendency: &mut [f64],
) {
    let (n, s, h) = (next.len(), grid.stride(), grid.spacing());
    let tendency = &mut tendency[..n];
    // Rows of this component at distance ± one node along each axis, and of the components that
    // carry it: u_b on the lower and upper edge of this node's control volume along b.
    let here = &u[C][o..o + n];
    let above: [&[f64]; D] = std::array::from_fn(|b| &u[C][o + s[b]..][..n]);
    let below: [&[f64]; D] = std::array::from_fn(|b| &u[C][o - s[b]..][..n]);
    let lower: [[&[f64]; 2]; D] = std::array::from_fn(|b| [&u[b][o..][..n], &u[b][o - s[C]..][..n]]);
    let upper: [[&[f64]; 2]; D] =
        std::array::from_fn(|b| [&u[b][o + s[b]..][..n], &u[b][o + s[b] - s[C]..][..n]]);
    let p = [&p[o..][..n], &p[o - s[C]..][..n]];

    let convection: [f64; D] = std::array::from_fn(|b| 0.25 / h[b]);
    let diffusion: [f64; D] = std::array::from_fn(|b| k.viscosity / (h[b] * h[b]));
    let gradient = k.dt * k.specific_volume / h[C];
    let [new, old] = k.weights.map(|w| w * k.dt);
    let force = k.dt * k.force;
    for i in 0..n {
        let centre = here[i];
        let mut sum = 0.0;
        for b in 0..D {
            let (up, down) = (above[b][i], below[b][i]);
            let (flux_up, flux_down) = if b == C {
                ((centre + up) * (centre + up), (down + centre) * (down + centre))
            } else {
                (
                    (upper[b][0][i] + upper[b][1][i]) * (centre + up),
                    (lower[b][0][i] + lower[b][1][i]) * (down + centre),
                )
            };
            sum += convection[b] * (flux_down - flux_up) + diffusion[b] * ((up - centre) - (centre - down));
        }
        next[i] = centre + (new * sum + old * tendency[i]) - gradient * (p[0][i] - p[1][i]) + force;
        tendency[i] = sum;
    }
}

/// Divergence of the cells of row `r` times `scale`.
#[inline(always)]
pub(crate) fn divergence_row<const D: usize>(
    grid: &CartesianGrid<D>,
    r: usize,
    velocity: &[Field<D>; D],
    scale: f64,
    out: &mut [f64],
) {
    let (n, s, h) = (out.len(), grid.stride(), grid.spacing());
    let o = row_start(grid, r);
    let lower: [&[f64]; D] = std::array::from_fn(|b| &velocity[b].data()[o..][..n]);
    let upper: [&[f64]; D] = std::array::from_fn(|b| &velocity[b].data()[o + s[b]..][..n]);
    let scale: [f64; D] = std::array::from_fn(|b| scale / h[b]);
    for i in 0..n {
        let mut sum = 0.0;
        for b in 0..D {
            sum += scale[b] * (upper[b][i] - lower[b][i]);
        }
        out[i] = sum;
    }
}

/// u_c −= dt ∂φ/∂x_c /ρ on every face but those on the boundary; `phi` is dense, x fastest.
pub(crate) fn correct_component<const D: usize>(
    grid: &CartesianGrid<D>,
    c: usize,
    periodic: bool,
    scale: f64,
    phi: &[f64],
    component: &mut Field<D>,
) {
    let n = grid.cells();
    let scale = scale / grid.spacing()[c];
    let layer = grid.stride()[D - 1];
    let per_task = layers_per_task(n[D - 1]);
    let rows_per_layer = grid.rows_per_layer();
    // The row below along c: so many rows down, or from the first of n[c] up to the last.
    let step = if c == 2 { n[1] } else { 1 };
    component.layers_mut().par_chunks_mut(layer * per_task).enumerate().for_each(|(task, out)| {
        let first = task * per_task;
        let end = (first + per_task).min(n[D - 1]);
        let rows = first * rows_per_layer..end * rows_per_layer;
        let start = (GHOSTS + first) * layer;
        Arch::new().dispatch(CorrectRows { grid, c, periodic, scale, step, rows, start, phi, out });
    });
}

/// [`correct_component`] for a run of rows.
struct CorrectRows<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    c: usize,
    periodic: bool,
    scale: f64,
    step: usize,
    rows: std::ops::Range<usize>,
    /// Storage index of the first entry of `out`.
    start: usize,
    phi: &'a [f64],
    out: &'a mut [f64],
}

impl<const D: usize> WithSimd for CorrectRows<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { grid, c, periodic, scale, step, rows, start, phi, out } = self;
        let n = grid.cells();
        for r in rows {
            let local = row_start(grid, r) - start;
            let out = &mut out[local..local + n[0]];
            let here = &phi[r * n[0]..][..n[0]];
            if c == 0 {
                out[0] -= scale * (here[0] - here[if periodic { n[0] - 1 } else { 0 }]);
                for i in 1..n[0] {
                    out[i] -= scale * (here[i] - here[i - 1]);
                }
            } else {
                let below = match ((r / step) % n[c], periodic) {
                    (0, true) => r + (n[c] - 1) * step,
                    (0, false) => continue,
                    _ => r - step,
                };
                let below = &phi[below * n[0]..][..n[0]];
                for i in 0..n[0] {
                    out[i] -= scale * (here[i] - below[i]);
                }
            }
        }
    }
}

/// p += φ.
pub(crate) fn add_dense<const D: usize>(grid: &CartesianGrid<D>, phi: &[f64], p: &mut Field<D>) {
    let n = grid.cells();
    let layer = grid.stride()[D - 1];
    let per_task = layers_per_task(n[D - 1]);
    let rows_per_layer = grid.rows_per_layer();
    p.layers_mut().par_chunks_mut(layer * per_task).enumerate().for_each(|(task, out)| {
        let first = task * per_task;
        let end = (first + per_task).min(n[D - 1]);
        for r in first * rows_per_layer..end * rows_per_layer {
            let local = row_start(grid, r) - (GHOSTS + first) * layer;
            for (p, phi) in out[local..local + n[0]].iter_mut().zip(&phi[r * n[0]..]) {
                *p += phi;
            }
        }
    });
}
