//! Rows of the matrix and of ∇a·∇b.
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::operators::RowKernel;
use crate::{CartesianGrid, Field};

/// Coefficients of the neighbours below (`UPPER` false) or above along `axis`: −(Γ_f A/d + what flows in), Γ_f
/// interpolated linearly, times volumes.
pub(super) struct Neighbour<'a, const UPPER: bool, const D: usize> {
    pub(super) grid: &'a CartesianGrid<D>,
    pub(super) metrics: &'a Metrics<D>,
    pub(super) axis: usize,
    pub(super) gamma: &'a Field<D>,
    pub(super) velocity: &'a Field<D>,
}

impl<const UPPER: bool, const D: usize> RowKernel<D> for Neighbour<'_, UPPER, D> {
    #[inline(always)]
    fn row(&self, at: [usize; D], o: usize, out: &mut [f64]) {
        let (n, a, s) = (out.len(), self.axis, self.grid.stride()[self.axis]);
        let axis = &self.metrics.axes[a];
        // From here on all belongs to the face.
        let (o, first) = if UPPER { (o + s, 1) } else { (o, 0) };
        let gamma = self.gamma.data();
        let (below, above, u) = (&gamma[o - s..][..n], &gamma[o..][..n], &self.velocity.data()[o..][..n]);
        let width = |b: usize| &self.metrics.axes[b].centres.volume;
        // Area of the face but for the factor that changes along x.
        let across: f64 = (1..D).filter(|&b| b != a).map(|b| width(b)[GHOSTS + at[b]]).product();
        let coefficient = |area: f64, share: [f64; 2], inv_gap: f64, [below, above, u]: [f64; 3]| {
            let inflow = if UPPER { -u } else { u };
            let inflow = if inflow > 0.0 { inflow } else { 0.0 };
            -area * ((share[1] * below + share[0] * above) * inv_gap + inflow)
        };
        if a == 0 {
            let from = GHOSTS + at[0] + first;
            let (s0, s1) = (&axis.share[0][from..][..n], &axis.share[1][from..][..n]);
            let inv_gap = &axis.centres.inv_gap[from..][..n];
            for i in 0..n {
                out[i] = coefficient(across, [s0[i], s1[i]], inv_gap[i], [below[i], above[i], u[i]]);
            }
        } else {
            let j = GHOSTS + at[a] + first;
            let share = [axis.share[0][j], axis.share[1][j]];
            let along = &width(0)[GHOSTS + at[0]..][..n];
            for i in 0..n {
                let values = [below[i], above[i], u[i]];
                out[i] = coefficient(across * along[i], share, axis.centres.inv_gap[j], values);
            }
        }
    }
}

/// ∇a·∇b.
pub(super) struct DotGradients<'a, const D: usize> {
    pub(super) grid: &'a CartesianGrid<D>,
    /// Weights of the centred difference along each axis: below, here, above.
    pub(super) centred: &'a [[Vec<f64>; 3]; D],
    pub(super) a: &'a [f64],
    pub(super) b: &'a [f64],
}

impl<const D: usize> RowKernel<D> for DotGradients<'_, D> {
    #[inline(always)]
    fn row(&self, at: [usize; D], o: usize, out: &mut [f64]) {
        let (n, s) = (out.len(), self.grid.stride());
        out.fill(0.0);
        for c in 0..D {
            let rows = |f| -> [&[f64]; 3] { [o - s[c], o, o + s[c]].map(|o| slice(f, o, n)) };
            let (a, b) = (rows(self.a), rows(self.b));
            let slope =
                |r: &[&[f64]; 3], w: [f64; 3], i: usize| w[0] * r[0][i] + w[1] * r[1][i] + w[2] * r[2][i];
            if c == 0 {
                let w = [0, 1, 2].map(|k| &self.centred[0][k][GHOSTS + at[0]..][..n]);
                for i in 0..n {
                    let w = [w[0][i], w[1][i], w[2][i]];
                    out[i] += slope(&a, w, i) * slope(&b, w, i);
                }
            } else {
                let w = [0, 1, 2].map(|k| self.centred[c][k][GHOSTS + at[c]]);
                for i in 0..n {
                    out[i] += slope(&a, w, i) * slope(&b, w, i);
                }
            }
        }
    }
}

#[inline(always)]
fn slice(f: &[f64], o: usize, n: usize) -> &[f64] {
    &f[o..][..n]
}
