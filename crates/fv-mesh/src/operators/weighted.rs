//! Weighted sums of neighbouring values, and second differences.
use super::rows::RowKernel;
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::{CartesianGrid, Field};

/// out = Σ_k w_k φ at storage distance d_k, with weights that change along `axis` only.
pub(super) struct Weighted<'a, const N: usize> {
    pub(super) phi: &'a [f64],
    pub(super) axis: usize,
    /// Storage distances.
    pub(super) distance: [isize; N],
    /// Weights along the axis, from its outermost ghost.
    pub(super) weight: [&'a [f64]; N],
}

impl<const N: usize, const D: usize> RowKernel<D> for Weighted<'_, N> {
    #[inline(always)]
    fn row(&self, at: [usize; D], o: usize, out: &mut [f64]) {
        let n = out.len();
        let phi: [&[f64]; N] =
            std::array::from_fn(|k| &self.phi[o.wrapping_add_signed(self.distance[k])..][..n]);
        if self.axis == 0 {
            let w: [&[f64]; N] = std::array::from_fn(|k| &self.weight[k][GHOSTS + at[0]..][..n]);
            for i in 0..n {
                let mut sum = w[0][i] * phi[0][i];
                for k in 1..N {
                    sum += w[k][i] * phi[k][i];
                }
                out[i] = sum;
            }
        } else {
            let w: [f64; N] = std::array::from_fn(|k| self.weight[k][GHOSTS + at[self.axis]]);
            for i in 0..n {
                let mut sum = w[0] * phi[0][i];
                for k in 1..N {
                    sum += w[k] * phi[k][i];
                }
                out[i] = sum;
            }
        }
    }
}

/// ∇·F of a face field.
pub(super) struct Divergence<'a, const D: usize> {
    pub(super) grid: &'a CartesianGrid<D>,
    pub(super) metrics: &'a Metrics<D>,
    pub(super) faces: [&'a [f64]; D],
}

impl<const D: usize> RowKernel<D> for Divergence<'_, D> {
    #[inline(always)]
    fn row(&self, at: [usize; D], o: usize, out: &mut [f64]) {
        let (n, s) = (out.len(), self.grid.stride());
        let lower: [&[f64]; D] = std::array::from_fn(|b| &self.faces[b][o..][..n]);
        let upper: [&[f64]; D] = std::array::from_fn(|b| &self.faces[b][o + s[b]..][..n]);
        let axes = &self.metrics.axes;
        let inv = &axes[0].centres.inv_volume[GHOSTS + at[0]..][..n];
        let inv_b: [f64; D] = std::array::from_fn(|b| axes[b].centres.inv_volume[GHOSTS + at[b]]);
        for i in 0..n {
            let mut sum = inv[i] * (upper[0][i] - lower[0][i]);
            for b in 1..D {
                sum += inv_b[b] * (upper[b][i] - lower[b][i]);
            }
            out[i] = sum;
        }
    }
}

/// Γ ∇²φ with one Γ.
pub(super) struct Laplacian<'a, const D: usize> {
    pub(super) grid: &'a CartesianGrid<D>,
    pub(super) metrics: &'a Metrics<D>,
    pub(super) gamma: f64,
    pub(super) phi: &'a [f64],
}

impl<const D: usize> RowKernel<D> for Laplacian<'_, D> {
    #[inline(always)]
    fn row(&self, at: [usize; D], o: usize, out: &mut [f64]) {
        let (n, s) = (out.len(), self.grid.stride());
        let here = &self.phi[o..][..n];
        let above: [&[f64]; D] = std::array::from_fn(|b| &self.phi[o + s[b]..][..n]);
        let below: [&[f64]; D] = std::array::from_fn(|b| &self.phi[o - s[b]..][..n]);
        let axes = &self.metrics.axes;
        let x = GHOSTS + at[0];
        let (up, down) = (&axes[0].centres.up[x..][..n], &axes[0].centres.down[x..][..n]);
        let up_b: [f64; D] = std::array::from_fn(|b| axes[b].centres.up[GHOSTS + at[b]]);
        let down_b: [f64; D] = std::array::from_fn(|b| axes[b].centres.down[GHOSTS + at[b]]);
        for i in 0..n {
            let mut sum = up[i] * (above[0][i] - here[i]) - down[i] * (here[i] - below[0][i]);
            for b in 1..D {
                sum += up_b[b] * (above[b][i] - here[i]) - down_b[b] * (here[i] - below[b][i]);
            }
            out[i] = self.gamma * sum;
        }
    }
}

/// ∇·(Γ∇φ) with Γ interpolated to the faces.
pub(super) struct VariableLaplacian<'a, const D: usize> {
    pub(super) grid: &'a CartesianGrid<D>,
    pub(super) metrics: &'a Metrics<D>,
    pub(super) gamma: &'a Field<D>,
    pub(super) phi: &'a [f64],
}

impl<const D: usize> RowKernel<D> for VariableLaplacian<'_, D> {
    #[inline(always)]
    fn row(&self, at: [usize; D], o: usize, out: &mut [f64]) {
        let n = out.len();
        let (phi, gamma) = (self.phi, self.gamma.data());
        out.fill(0.0);
        for b in 0..D {
            let (axis, s) = (&self.metrics.axes[b], self.grid.stride()[b]);
            let (here, above, below) = (&phi[o..][..n], &phi[o + s..][..n], &phi[o - s..][..n]);
            let (g, g_above, g_below) = (&gamma[o..][..n], &gamma[o + s..][..n], &gamma[o - s..][..n]);
            let [below_share, above_share] = &axis.share;
            let (up, down) = (&axis.centres.up, &axis.centres.down);
            // The face value takes each centre by the other cell's share of their distance.
            let mut cell = |i: usize, [low, high]: [[f64; 2]; 2], up: f64, down: f64| {
                let low = low[1] * g_below[i] + low[0] * g[i];
                let high = high[1] * g[i] + high[0] * g_above[i];
                out[i] += high * up * (above[i] - here[i]) - low * down * (here[i] - below[i]);
            };
            if b == 0 {
                let x = GHOSTS + at[0];
                let (l0, l1) = (&below_share[x..][..n], &above_share[x..][..n]);
                let (h0, h1) = (&below_share[x + 1..][..n], &above_share[x + 1..][..n]);
                let (up, down) = (&up[x..][..n], &down[x..][..n]);
                for i in 0..n {
                    cell(i, [[l0[i], l1[i]], [h0[i], h1[i]]], up[i], down[i]);
                }
            } else {
                let j = GHOSTS + at[b];
                let shares = [[below_share[j], above_share[j]], [below_share[j + 1], above_share[j + 1]]];
                for i in 0..n {
                    cell(i, shares, up[j], down[j]);
                }
            }
        }
    }
}
