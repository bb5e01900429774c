//! Derivatives of a staggered velocity at the cell centres.
use super::rows::RowKernel;
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::{CartesianGrid, Field};

/// |S| = √(2 S:S), S = ½(∇u + ∇uᵀ).
pub(crate) struct StrainRate<'a, const D: usize> {
    pub(crate) grid: &'a CartesianGrid<D>,
    pub(crate) metrics: &'a Metrics<D>,
    /// Weights of the centred difference along each axis: below, here, above.
    pub(crate) centred: &'a [[Vec<f64>; 3]; D],
    pub(crate) velocity: &'a [Field<D>; D],
}

impl<const D: usize> RowKernel<D> for StrainRate<'_, D> {
    #[inline(always)]
    fn row(&self, at: [usize; D], o: usize, out: &mut [f64]) {
        let (n, s) = (out.len(), self.grid.stride());
        out.fill(0.0);
        for a in 0..D {
            let u = self.velocity[a].data();
            let (lower, upper) = (&u[o..][..n], &u[o + s[a]..][..n]);
            let inv = &self.metrics.axes[a].centres.inv_volume;
            // 2 S_aa².
            let mut add = |i: usize, inv: f64| {
                let slope = inv * (upper[i] - lower[i]);
                out[i] += 2.0 * slope * slope;
            };
            if a == 0 {
                let inv = &inv[GHOSTS + at[0]..][..n];
                for i in 0..n {
                    add(i, inv[i]);
                }
            } else {
                for i in 0..n {
                    add(i, inv[GHOSTS + at[a]]);
                }
            }
            for b in 0..a {
                // 2 (S_ab² + S_ba²) = (∂u_a/∂x_b + ∂u_b/∂x_a)².
                let v = self.velocity[b].data();
                let along_b = centred_rows(u, o, n, s[a], s[b]);
                let along_a = centred_rows(v, o, n, s[b], s[a]);
                // b < a, so only b can be x.
                let wa = [0, 1, 2].map(|k| self.centred[a][k][GHOSTS + at[a]]);
                if b == 0 {
                    let wb = [0, 1, 2].map(|k| &self.centred[0][k][GHOSTS + at[0]..][..n]);
                    for i in 0..n {
                        let slope =
                            centred(&along_b, [wb[0][i], wb[1][i], wb[2][i]], i) + centred(&along_a, wa, i);
                        out[i] += slope * slope;
                    }
                } else {
                    let wb = [0, 1, 2].map(|k| self.centred[b][k][GHOSTS + at[b]]);
                    for i in 0..n {
                        let slope = centred(&along_b, wb, i) + centred(&along_a, wa, i);
                        out[i] += slope * slope;
                    }
                }
            }
        }
        for out in out.iter_mut() {
            *out = out.sqrt();
        }
    }
}

/// The values on the lower and upper face of the cells below, here and above along another axis.
#[inline(always)]
fn centred_rows(u: &[f64], o: usize, n: usize, face: usize, across: usize) -> [[&[f64]; 2]; 3] {
    [o - across, o, o + across].map(|o| [&u[o..][..n], &u[o + face..][..n]])
}

/// Derivative of the mean of both faces.
#[inline(always)]
fn centred(rows: &[[&[f64]; 2]; 3], w: [f64; 3], i: usize) -> f64 {
    let mean = |k: usize| 0.5 * (rows[k][0][i] + rows[k][1][i]);
    w[0] * mean(0) + w[1] * mean(1) + w[2] * mean(2)
}
