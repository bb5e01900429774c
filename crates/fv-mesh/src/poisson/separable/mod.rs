//! The direct solver for boxes whose cells may be stretched along every axis.
mod eigen;
mod fast;
mod gemm;
mod layout;
mod stages;
mod sweep;
#[cfg(test)]
mod tests;
mod transform;

use super::aligned::Aligned;
use super::{PoissonAxis, PoissonError, PoissonInfo, PoissonSolver, Rows, rows_of};
use layout::{Layout, Scratch};
use rayon::prelude::*;
use stages::{Along, Backward, Columns, Forward, Layers};
use sweep::LANES;

/// Direct solver on a box with any cell widths and any ends along each axis:
///
/// ```text
/// Σ_a (1/w_i) [ (φ_{i+1} − φ_i)/d_{i+1} − (φ_i − φ_{i−1})/d_i ] − s φ = f
/// ```
///
/// with the widths w along axis a and the distances d of the cell centres; see [`PoissonAxis`].
///
/// One axis is swept: a tridiagonal system per mode. The others are diagonalised, a uniform axis with
/// like ends by Fourier, cosine or sine transforms, every other axis of n cells by products with its
/// n × n eigenvectors (fast diagonalisation: Lynch, Rice & Thomas, Numer. Math. 6, 1964), at 4 n
/// operations per cell. The swept axis is the one that would cost most, so a plane needs one dense
/// transform at most and a box two. Making the solver takes of order n³ operations for each.
///
/// The residual is that of rounding φ: of order 1e-16 |φ| Σ 1/(w d), which on finely stretched axes
/// exceeds 1e-16 |f| by far.
///
/// Memory, two doubles per cell and n² for each dense transform, is taken when the solver is made; a
/// solve inside a rayon pool (`ThreadPool::install`) allocates nothing. The result does not depend on
/// the number of threads, bit by bit.
///
/// ```
/// use fv_mesh::poisson::{AxisBounds, PoissonAxis, PoissonSolver, SeparablePoisson};
/// // Between a wall with zero φ below and one without flux above; cells of two sizes.
/// let y = PoissonAxis { widths: vec![0.1, 0.1, 0.2], ends: AxisBounds::DirichletNeumann };
/// let mut poisson = SeparablePoisson::new([PoissonAxis::uniform(4, 0.5, AxisBounds::Periodic), y])?;
/// let mut phi = vec![-1.0; 12];
/// poisson.solve(&mut phi)?;
/// // The wall takes in all of the sources: 2 φ₀ / 0.1 = 0.1 + 0.1 + 0.2.
/// assert!((phi[0] - 0.02).abs() < 1e-15);
/// # Ok::<(), fv_mesh::poisson::PoissonError>(())
/// ```
pub struct SeparablePoisson<const D: usize>(Passes);

/// What a solve needs and does, in any dimension.
struct Passes {
    layout: Layout,
    /// Layer by layer.
    layers: Aligned<f64>,
    /// Block by block.
    blocks: Aligned<f64>,
    scratch: Vec<Scratch>,
}

impl<const D: usize> SeparablePoisson<D> {
    /// Solver for a box with these axes; D is 2 or 3.
    ///
    /// # Errors
    ///
    /// [`PoissonError::NoCells`], [`PoissonError::Spacing`] and [`PoissonError::Eigen`].
    pub fn new(axes: [PoissonAxis; D]) -> Result<Self, PoissonError> {
        Self::new_helmholtz(axes, 0.0)
    }

    /// The same with a `shift` s ≥ 0 \[1/m²\].
    ///
    /// # Errors
    ///
    /// Those of [`Self::new`] and [`PoissonError::Shift`].
    pub fn new_helmholtz(axes: [PoissonAxis; D], shift: f64) -> Result<Self, PoissonError> {
        const { assert!(D == 2 || D == 3, "boxes have two or three dimensions") };
        for (axis, a) in axes.iter().enumerate() {
            a.check(axis)?;
        }
        if !(shift >= 0.0 && shift.is_finite()) {
            return Err(PoissonError::Shift { shift });
        }
        let swept = if D == 3 { swept_axis(&axes) } else { 2 * swept_axis(&axes) };
        let middle = if D == 3 { Some(&axes[1]) } else { None };
        let layout = Layout::new([Some(&axes[0]), middle, Some(&axes[D - 1])], swept, shift)?;
        Ok(Self(Passes {
            layers: Aligned::new(layout.cells[2] * layout.stride),
            blocks: Aligned::new(layout.blocks * layout.cells[2] * LANES),
            scratch: layout.scratch(),
            layout,
        }))
    }

    /// Solves for the right-hand side that `fill` makes row by row: `fill(r, row)` has to write all
    /// values of x-row r = j + n_y k to `row`, which holds anything before. `phi` (dense, x fastest)
    /// receives the solution; what it held does not matter.
    ///
    /// Each row is asked for once, in any order and from any thread of the pool.
    ///
    /// # Errors
    ///
    /// [`PoissonError::Length`] and [`PoissonError::NonFinite`]; `phi` is then left as it was.
    pub fn solve_rows<F>(&mut self, fill: F, phi: &mut [f64]) -> Result<PoissonInfo, PoissonError>
    where
        F: Fn(usize, &mut [f64]) + Sync,
    {
        self.0.check_length(phi)?;
        let info = self.0.solve_modes(&fill)?;
        self.0.transform_back(phi);
        Ok(info)
    }
}

impl Passes {
    fn check_length(&self, field: &[f64]) -> Result<(), PoissonError> {
        let cells = self.layout.cells.iter().product();
        if field.len() == cells { Ok(()) } else { Err(PoissonError::Length { length: field.len(), cells }) }
    }

    /// From the right-hand side to blocks of solutions that lack the transforms within layers.
    fn solve_modes(&mut self, fill: Rows<'_>) -> Result<PoissonInfo, PoissonError> {
        self.transform(fill);
        for scratch in &self.scratch {
            if let Some((row, sum)) = scratch.bad {
                let layer = row / self.layout.cells[1];
                return Err(PoissonError::NonFinite { low: layer, high: layer, sum });
            }
        }
        let removed_mean;
        if self.layout.swept == 2 {
            removed_mean = self.remove_mean();
            self.columns(Along::Sweep);
        } else {
            self.columns(Along::Forward);
            removed_mean = self.remove_mean();
            self.sweep_layers();
            self.columns(Along::Backward);
        }
        Ok(PoissonInfo { removed_mean, ..Default::default() })
    }

    /// Right-hand side to transformed layers.
    fn transform(&mut self, fill: Rows<'_>) {
        let layout = &self.layout;
        let parts = self.layers.par_chunks_mut(layout.layers * layout.stride);
        let parts = parts.zip(&mut self.scratch).enumerate().with_min_len(layout.least_parts());
        parts.for_each(|(p, (layers, scratch))| {
            let first = p * layout.layers;
            pulp::Arch::new().dispatch(Forward { layout, first, fill, layers, scratch });
        });
    }

    /// Layers to blocks.
    fn columns(&mut self, along: Along) {
        let (layout, layers) = (&self.layout, &*self.layers);
        let part = layout.blocks_per_part;
        let parts = self.blocks.par_chunks_mut(part * layout.cells[2] * LANES);
        let parts = parts.zip(&mut self.scratch).enumerate().with_min_len(layout.least_parts());
        parts.for_each(|(p, (blocks, scratch))| {
            let first = p * part;
            pulp::Arch::new().dispatch(Columns { layout, along, first, layers, blocks, scratch });
        });
    }

    /// Blocks to layers, with a sweep along x or y.
    fn sweep_layers(&mut self) {
        let (layout, blocks) = (&self.layout, &*self.blocks);
        let parts = self.layers.par_chunks_mut(layout.layers * layout.stride);
        let parts = parts.zip(&mut self.scratch).enumerate().with_min_len(layout.least_parts());
        parts.for_each(|(p, (layers, scratch))| {
            let first = p * layout.layers;
            pulp::Arch::new().dispatch(Layers { layout, first, blocks, layers, scratch });
        });
    }

    /// Blocks to φ.
    fn transform_back(&mut self, phi: &mut [f64]) {
        let (layout, blocks) = (&self.layout, &*self.blocks);
        let parts = phi.par_chunks_mut(layout.layers * layout.cells[0] * layout.cells[1]);
        let parts = parts.zip(&mut self.scratch).enumerate().with_min_len(layout.least_parts());
        parts.for_each(|(p, (phi, scratch))| {
            let first = p * layout.layers;
            pulp::Arch::new().dispatch(Backward { layout, first, blocks, phi, scratch });
        });
    }

    /// If the operator is singular, takes the mean out of the constant mode just before it is swept.
    fn remove_mean(&mut self) -> f64 {
        let layout = &self.layout;
        if !layout.singular {
            return 0.0;
        }
        let [nx, _, nz] = layout.cells;
        let (data, place): (&mut [f64], &dyn Fn(usize) -> usize) = match layout.swept {
            0 => (&mut self.blocks, &|i| i / LANES * nz * LANES + i % LANES),
            1 => (&mut self.blocks, &|j| j * nx / LANES * nz * LANES + j * nx % LANES),
            _ => (&mut self.layers, &|k| k * layout.stride),
        };
        let mean = layout.sweep.mean(|i| data[place(i)]);
        for i in 0..layout.cells[layout.swept] {
            data[place(i)] -= mean;
        }
        mean / layout.mean_gain
    }
}

/// The axis whose transform would cost most: the longest one that has no fast transform, else the last.
pub(super) fn swept_axis<const D: usize>(axes: &[PoissonAxis; D]) -> usize {
    let cost = |a: &usize| if axes[*a].is_fast() { 0 } else { axes[*a].cells() };
    (0..D).max_by_key(cost).unwrap_or(D - 1)
}

impl<const D: usize> std::fmt::Debug for SeparablePoisson<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [nx, ny, nz] = self.0.layout.cells;
        let cells = if D == 3 { vec![nx, ny, nz] } else { vec![nx, nz] };
        f.debug_struct("SeparablePoisson").field("cells", &cells).finish_non_exhaustive()
    }
}

impl<const D: usize> PoissonSolver<D> for SeparablePoisson<D> {
    fn solve(&mut self, rhs_in_phi_out: &mut [f64]) -> Result<PoissonInfo, PoissonError> {
        self.0.check_length(rhs_in_phi_out)?;
        let info = self.0.solve_modes(&rows_of(rhs_in_phi_out, self.0.layout.cells[0]))?;
        self.0.transform_back(rhs_in_phi_out);
        Ok(info)
    }
}
