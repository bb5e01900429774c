//! What bounded sides do to the kinetic energy of the fluid.
use crate::grid::GHOSTS;
use crate::metrics::Metrics;
use crate::statistics::Measure;
use crate::walls::each_boundary_cell;
use crate::{CartesianGrid, Field, Fluid};
use interfaces::Vector;

/// Power of the bounded sides on the fluid: with it, forces of the body of the fluid and its [dissipation](crate::FlowStatistics::dissipation) the kinetic energy is in balance,
/// up to what the scheme in time and an upwind scheme take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SidePower {
    /// What convection and viscosity carry in, Σ A ρ (½ u_n u₀u₁ − ν ∂u/∂n ū), from the nodes on both sides of a side (their mean ū), and what
    /// the nodes on the sides dissipate \[W\].
    pub carried: f64,
    /// Σ A p u_n of what enters \[W\]; the pressure is that of the middle of the last step ([`Projection`](crate::Projection)).
    pub pressure: f64,
    /// Kinetic energy of the nodes on the sides, whose velocity is given \[J\].
    pub given: f64,
    /// ∫ u dV of these nodes \[m⁴/s\].
    pub given_flow: Vector,
}

impl<const D: usize> Measure<D> {
    pub(crate) fn side_power(
        &self,
        grid: &CartesianGrid<D>,
        metrics: &Metrics<D>,
        velocity: &[Field<D>; D],
        pressure: &Field<D>,
        fluid: Fluid,
    ) -> SidePower {
        let (n, s, p) = (grid.cells(), grid.stride(), pressure.data());
        let (nu, mut out) = (fluid.viscosity, SidePower::default());
        for a in (0..D).filter(|&a| !metrics.periodic[a]) {
            let through = velocity[a].data();
            for c in 0..D {
                let (u, inv_gap) = (velocity[c].data(), &metrics.of(Some(c), a).inv_gap);
                let share = &metrics.axes[c].share;
                let mut carried = 0.0;
                each_boundary_cell(grid, metrics, a, c, |o, at, area| {
                    // Upwards through the side; of the component normal to it through the first cell.
                    let ends = [(usize::from(a == c), 1.0), (n[a], -1.0)];
                    for (i, sign) in ends {
                        let q = o + i * s[a];
                        let [below, here] = [u[q - s[a]], u[q]];
                        let place = GHOSTS + at[c];
                        let (carry, side) = if a == c {
                            (0.5 * (below + here), if sign > 0.0 { below } else { here })
                        } else {
                            let carry = share[0][place] * through[q - s[c]] + share[1][place] * through[q];
                            (carry, 0.5 * (below + here))
                        };
                        let slope = inv_gap[GHOSTS + i] * (here - below);
                        carried += sign * area * (0.5 * carry * below * here - nu * slope * side);
                    }
                });
                out.carried += carried;
            }
            each_boundary_cell(grid, metrics, a, a, |o, _, area| {
                let top = o + n[a] * s[a];
                out.pressure += area * (p[o] * through[o] - p[top - s[a]] * through[top]);
            });
            for i in [0, n[a]] {
                let [flow, square, gradient] = self.on_side(grid, through, a, i);
                out.given_flow[a] += flow;
                out.given += 0.5 * square;
                out.carried += nu * gradient;
            }
        }
        out.carried *= fluid.density;
        out.given *= fluid.density;
        out
    }

    /// Σ V u, Σ V u² and Σ V |∇u|² of the faces normal to axis `a` at place `i` on it.
    fn on_side(&self, grid: &CartesianGrid<D>, u: &[f64], a: usize, i: usize) -> [f64; 3] {
        let (n, s, mut sums) = (grid.cells(), grid.stride(), [0.0; 3]);
        let (volumes, gaps) = (&self.volumes[a], &self.gaps[a]);
        // The axes along the side; in the plane there is one.
        let b = usize::from(a == 0);
        let c = (D == 3).then(|| 3 - a - b);
        for k in 0..=c.map_or(0, |c| n[c]) {
            let step = c.map_or(0, |c| s[c]);
            let [volume, gap] = [volumes, gaps].map(|of| volumes[a][i] * c.map_or(1.0, |c| of[c][k]));
            let start = grid.base() + i * s[a] + k * step;
            for j in 0..=n[b] {
                let o = start + j * s[b];
                let [along, across] = [u[o] - u[o - s[b]], u[o] - u[o - step]];
                let part = volume * volumes[b][j] * u[o];
                sums[0] += part;
                sums[1] += part * u[o];
                sums[2] += volume * gaps[b][j] * along * along + gap * volumes[b][j] * across * across;
            }
        }
        sums
    }
}
