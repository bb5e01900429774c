//! Divergence, correction of the velocity, pressure.
use super::{face_row, for_rows, layers_per_task, row_place};
use crate::field::row_start;
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::parts::each_part;
use crate::{CartesianGrid, Field};
use pulp::{Arch, Simd, WithSimd};

/// Divergence of the cells of row `r` times `scale`.
#[inline(always)]
pub(crate) fn divergence_row<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    r: usize,
    velocity: &[Field<D>; D],
    scale: f64,
    out: &mut [f64],
) {
    let (n, s) = (out.len(), grid.stride());
    let (o, at) = (row_start(grid, r), row_place(grid, r));
    let lower: [&[f64]; D] = std::array::from_fn(|b| &velocity[b].data()[o..][..n]);
    let upper: [&[f64]; D] = std::array::from_fn(|b| &velocity[b].data()[o + s[b]..][..n]);
    let inv = &metrics.axes[0].centres.inv_volume[GHOSTS..][..n];
    let inv_b: [f64; D] = std::array::from_fn(|b| scale * metrics.axes[b].centres.inv_volume[GHOSTS + at[b]]);
    for i in 0..n {
        let mut sum = scale * inv[i] * (upper[0][i] - lower[0][i]);
        for b in 1..D {
            sum += inv_b[b] * (upper[b][i] - lower[b][i]);
        }
        out[i] = sum;
    }
}

/// [`divergence_row`] times `scale`, compiled for the processor at hand.
pub(crate) fn divergence<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    velocity: &[Field<D>; D],
    scale: f64,
) -> impl Fn(usize, &mut [f64]) + Sync {
    struct Row<'a, const D: usize> {
        grid: &'a CartesianGrid<D>,
        metrics: &'a Metrics<D>,
        r: usize,
        velocity: &'a [Field<D>; D],
        scale: f64,
        out: &'a mut [f64],
    }
    impl<const D: usize> WithSimd for Row<'_, D> {
        type Output = ();
        #[inline(always)]
        fn with_simd<S: Simd>(self, _: S) {
            divergence_row(self.grid, self.metrics, self.r, self.velocity, self.scale, self.out);
        }
    }
    let arch = Arch::new();
    move |r, out| arch.dispatch(Row { grid, metrics, r, velocity, scale, out })
}

/// What the velocity on a face answers to a gradient of φ.
#[derive(Clone, Copy)]
pub(crate) enum Conductance<'a> {
    /// The same on all faces.
    Same(f64),
    /// One number per face of the component ([`face_row`]).
    Faces(&'a [f64]),
}

/// u_c −= β ∂φ/∂x_c on every face but those on the boundary; `phi` is dense, x fastest.
pub(crate) fn correct_component<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    c: usize,
    beta: Conductance,
    phi: &[f64],
    component: &mut Field<D>,
) {
    for_rows(grid, component, |rows, start, out| {
        let job = Correct { grid, metrics, c, rows, start, phi, out };
        match beta {
            Conductance::Same(beta) => Arch::new().dispatch(Same { job, beta }),
            Conductance::Faces(beta) => Arch::new().dispatch(Varying { job, beta }),
        }
    });
}

/// A run of rows to correct.
struct Correct<'a, const D: usize> {
    grid: &'a CartesianGrid<D>,
    metrics: &'a Metrics<D>,
    c: usize,
    rows: std::ops::Range<usize>,
    /// Storage index of the first entry of `out`.
    start: usize,
    phi: &'a [f64],
    out: &'a mut [f64],
}

struct Same<'a, const D: usize> {
    job: Correct<'a, D>,
    beta: f64,
}
struct Varying<'a, const D: usize> {
    job: Correct<'a, D>,
    beta: &'a [f64],
}

impl<const D: usize> WithSimd for Same<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let beta = self.beta;
        self.job.run(|_| move |_| beta);
    }
}
impl<const D: usize> WithSimd for Varying<'_, D> {
    type Output = ();
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (grid, c, n) = (self.job.grid, self.job.c, self.job.grid.cells()[0]);
        self.job.run(|r| {
            let row = &self.beta[face_row(grid, c, r)..][..n];
            move |i| row[i]
        });
    }
}

impl<const D: usize> Correct<'_, D> {
    /// `beta(r)(i)` is that of the face below cell i of row r.
    #[inline(always)]
    fn run<B: Fn(usize) -> f64>(self, beta: impl Fn(usize) -> B) {
        let Self { grid, metrics, c, rows, start, phi, out } = self;
        let (n, periodic) = (grid.cells(), metrics.periodic[c]);
        let inv = &metrics.axes[c].faces.inv_volume[GHOSTS..];
        // The row below along c: so many rows down, or from the first of n[c] up to the last.
        let step = if c == 2 { n[1] } else { 1 };
        for r in rows {
            let local = row_start(grid, r) - start;
            let out = &mut out[local..local + n[0]];
            let (beta, here) = (beta(r), &phi[r * n[0]..][..n[0]]);
            if c == 0 {
                out[0] -= beta(0) * inv[0] * (here[0] - here[if periodic { n[0] - 1 } else { 0 }]);
                let inv = &inv[..n[0]];
                for i in 1..n[0] {
                    out[i] -= beta(i) * inv[i] * (here[i] - here[i - 1]);
                }
            } else {
                let at = (r / step) % n[c];
                let below = match (at, periodic) {
                    (0, true) => r + (n[c] - 1) * step,
                    (0, false) => continue,
                    _ => r - step,
                };
                let (below, inv) = (&phi[below * n[0]..][..n[0]], inv[at]);
                for i in 0..n[0] {
                    out[i] -= beta(i) * inv * (here[i] - below[i]);
                }
            }
        }
    }
}

/// p += φ.
pub(crate) fn add_dense<const D: usize>(grid: &CartesianGrid<D>, phi: &[f64], p: &mut Field<D>) {
    let n = grid.cells()[0];
    for_rows(grid, p, |rows, start, out| {
        for r in rows {
            let local = row_start(grid, r) - start;
            for (p, phi) in out[local..local + n].iter_mut().zip(&phi[r * n..]) {
                *p += phi;
            }
        }
    });
}

/// out = φ + p in all cells.
pub(crate) fn sum_dense<const D: usize>(
    grid: &CartesianGrid<D>,
    phi: &[f64],
    p: &Field<D>,
    out: &mut Field<D>,
) {
    let n = grid.cells()[0];
    let p = p.data();
    for_rows(grid, out, |rows, start, out| {
        for r in rows {
            let o = row_start(grid, r);
            let terms = p[o..o + n].iter().zip(&phi[r * n..]);
            for (out, (p, phi)) in out[o - start..o - start + n].iter_mut().zip(terms) {
                *out = p + phi;
            }
        }
    });
}

/// Fills the cells of `out` from dense values.
pub(crate) fn copy_dense<const D: usize>(grid: &CartesianGrid<D>, dense: &[f64], out: &mut Field<D>) {
    let n = grid.cells()[0];
    for (r, row) in dense.chunks_exact(n).enumerate() {
        let o = row_start(grid, r);
        out.data_mut()[o..o + n].copy_from_slice(row);
    }
}

/// out += factor·u, ghosts left alone.
pub(crate) fn change<const D: usize>(grid: &CartesianGrid<D>, factor: f64, u: &Field<D>, out: &mut Field<D>) {
    let layer = grid.stride()[D - 1];
    let per_task = layers_per_task(grid.cells()[D - 1]);
    let (range, _) = u.layer_range();
    let (u, length) = (&u.data()[range], layer * per_task);
    each_part(out.layers_mut(), length, &|task, out| {
        for (out, u) in out.iter_mut().zip(&u[task * length..]) {
            *out += factor * u;
        }
    });
}

/// p −= Σ_a κ_a ∂²φ/∂x_a², the ghosts of φ filled.
pub(crate) fn subtract_second_differences<const D: usize>(
    grid: &CartesianGrid<D>,
    metrics: &Metrics<D>,
    kappa: [f64; D],
    phi: &Field<D>,
    p: &mut Field<D>,
) {
    let (n, s) = (grid.cells()[0], grid.stride());
    let phi = phi.data();
    for_rows(grid, p, |rows, start, out| {
        for r in rows {
            let (o, at) = (row_start(grid, r), row_place(grid, r));
            let out = &mut out[o - start..][..n];
            for a in (0..D).filter(|&a| kappa[a] > 0.0) {
                let nodes = &metrics.axes[a].centres;
                let (here, above, below) = (&phi[o..][..n], &phi[o + s[a]..][..n], &phi[o - s[a]..][..n]);
                for i in 0..n {
                    let j = GHOSTS + if a == 0 { i } else { at[a] };
                    let second = nodes.up[j] * (above[i] - here[i]) - nodes.down[j] * (here[i] - below[i]);
                    out[i] -= kappa[a] * second;
                }
            }
        }
    });
}
