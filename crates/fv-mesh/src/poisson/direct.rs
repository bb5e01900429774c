//! The direct solver: transforms across the layers, sweeps along the last axis.
use super::aligned::Aligned;
use super::layers::{Backward, Forward, Layout, Scratch};
use super::modes::Modes;
use super::transform::AxisTransform;
use super::tridiagonal::{BlockSolve, LANES, Sweep};
use super::{AxisBounds, PoissonError, PoissonInfo, PoissonSolver, Rows, column, rows_of};
use pulp::bytemuck;
use rayon::prelude::*;
use rustfft::num_complex::Complex;

/// Parts that the layers are shared out in, whatever the number of threads.
const CHUNKS: usize = 16;

/// Direct solver of `Σ_a (φ_{i−1} − 2 φ_i + φ_{i+1}) / h_a² − s φ = f` on a uniform box; see the
/// [module](super) for the equation.
///
/// All memory is taken when the solver is made: about two doubles per cell. The work is shared out
/// over the rayon pool that a solve runs in and the result does not depend on the number of threads,
/// bit by bit. Inside a pool (`ThreadPool::install`) a solve allocates nothing; a solve called from
/// outside of one enters the global pool, which does.
///
/// The residual is a few times what rounding φ costs, 2e-16 (|f| + |φ| Σ 1/h²), at its maximum. It is
/// larger, though still small, in a box hundreds of times longer along a transformed axis than along a
/// last axis with Dirichlet ends.
pub struct DirectPoisson<const D: usize>(Passes);

/// What a solve needs and does, in any dimension.
struct Passes {
    layout: Layout,
    last: AxisBounds,
    sweep: Sweep,
    /// No φ exists unless f has zero mean.
    singular: bool,
    /// The mode that is constant across a layer has no eigenvalue, so the sweep leaves it out.
    bare: bool,
    /// Factor of the right-hand side in the sweeps.
    scale: f64,
    /// Complex layers, transformed.
    spectra: Aligned<Complex<f64>>,
    /// Solutions of the sweeps, block by block.
    solutions: Aligned<f64>,
    /// Constant mode of every layer.
    column: Vec<f64>,
    scratch: Vec<Scratch>,
}

impl<const D: usize> DirectPoisson<D> {
    /// Solver for `cells` cells of size `spacing` \[m\] along each axis; D is 2 or 3.
    ///
    /// # Errors
    ///
    /// [`PoissonError::NoCells`], [`PoissonError::Spacing`] and [`PoissonError::MixedEnds`].
    pub fn new(cells: [usize; D], spacing: [f64; D], bounds: [AxisBounds; D]) -> Result<Self, PoissonError> {
        Self::new_helmholtz(cells, spacing, bounds, 0.0)
    }

    /// The same with a `shift` s ≥ 0 \[1/m²\].
    ///
    /// # Errors
    ///
    /// Those of [`Self::new`] and [`PoissonError::Shift`].
    pub fn new_helmholtz(
        cells: [usize; D],
        spacing: [f64; D],
        bounds: [AxisBounds; D],
        shift: f64,
    ) -> Result<Self, PoissonError> {
        const { assert!(D == 2 || D == 3, "boxes have two or three dimensions") };
        for axis in 0..D {
            let (h, ends) = (spacing[axis], bounds[axis]);
            if cells[axis] == 0 {
                return Err(PoissonError::NoCells { axis });
            }
            if !(h > 0.0 && (h * h).is_normal()) {
                return Err(PoissonError::Spacing { axis, spacing: h });
            }
            if axis < D - 1 && matches!(ends, AxisBounds::NeumannDirichlet | AxisBounds::DirichletNeumann) {
                return Err(PoissonError::MixedEnds { axis, bounds: ends });
            }
        }
        if !(shift >= 0.0 && shift.is_finite()) {
            return Err(PoissonError::Shift { shift });
        }

        let x = AxisTransform::new(cells[0], bounds[0]);
        let y = (D == 3).then(|| AxisTransform::new(cells[1], bounds[1]));
        let modes = Modes::new(&x, y.as_ref());
        let (nx, rows, layers) = (cells[0], if D == 3 { cells[1] } else { 1 }, cells[D - 1]);
        let complex_layers = layers.div_ceil(2);

        let h2 = spacing.map(|h| h * h);
        let scale = h2[D - 1] / (nx * rows) as f64;
        let lambda = |kx: usize, ky: usize| {
            let along_y = y.as_ref().map_or(0.0, |y| y.eigenvalue(ky) / h2[1]);
            (x.eigenvalue(kx) / h2[0] + along_y + shift) * h2[D - 1]
        };
        let bare = lambda(0, 0) == 0.0;
        let sweep = Sweep::new(layers, bounds[D - 1], scale, &modes, lambda);

        let chunk = complex_layers.div_ceil(CHUNKS);
        Ok(Self(Passes {
            last: bounds[D - 1],
            singular: bare && column::free(bounds[D - 1]),
            bare,
            scale,
            spectra: Aligned::new(complex_layers * modes.layer_stride),
            solutions: Aligned::new(modes.blocks.len() * complex_layers * LANES),
            column: vec![0.0; layers],
            scratch: (0..complex_layers.div_ceil(chunk)).map(|_| Scratch::new(&x, y.as_ref())).collect(),
            layout: Layout { x, y, modes, nx, rows, layers, chunk },
            sweep,
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
        self.0.transform(&fill);
        self.0.finish(phi)
    }
}

impl Passes {
    fn check_length(&self, field: &[f64]) -> Result<(), PoissonError> {
        let cells = self.layout.nx * self.layout.rows * self.layout.layers;
        if field.len() == cells { Ok(()) } else { Err(PoissonError::Length { length: field.len(), cells }) }
    }

    /// Right-hand side to spectra.
    fn transform(&mut self, fill: Rows<'_>) {
        let layout = &self.layout;
        let stride = layout.modes.layer_stride;
        let chunks = self.spectra.par_chunks_mut(layout.chunk * stride);
        chunks.zip(&mut self.scratch).enumerate().for_each(|(c, (spectra, scratch))| {
            let first = c * layout.chunk;
            pulp::Arch::new().dispatch(Forward { layout, first, fill, spectra, scratch });
        });
    }

    /// Spectra to φ.
    fn finish(&mut self, phi: &mut [f64]) -> Result<PoissonInfo, PoissonError> {
        let info = self.take_column()?;
        self.sweep();
        self.transform_back(phi);
        Ok(info)
    }

    /// Gathers the mode that is constant across the layers, makes sure that the right-hand side is
    /// finite and solves for that mode if the sweeps cannot.
    fn take_column(&mut self) -> Result<PoissonInfo, PoissonError> {
        let layers = self.column.len();
        let (front, stride) = (self.layout.modes.front, self.layout.modes.layer_stride);
        for (low, layer) in self.spectra.chunks_exact(stride).enumerate() {
            let (z, high) = (layer[front], layers - 1 - low);
            if !(z.re.is_finite() && z.im.is_finite()) {
                let sum = if z.re.is_finite() { z.im } else { z.re };
                return Err(PoissonError::NonFinite { low, high, sum });
            }
            self.column[low] = z.re;
            self.column[high] = z.im;
        }
        let per_layer = (self.layout.nx * self.layout.rows) as f64;
        let mean = if self.singular { self.column.iter().sum::<f64>() / layers as f64 } else { 0.0 };
        if self.bare {
            self.column.iter_mut().for_each(|g| *g = self.scale * (*g - mean));
            column::solve(self.last, &mut self.column);
        }
        Ok(PoissonInfo { removed_mean: mean / per_layer, ..Default::default() })
    }

    /// Spectra to solutions.
    fn sweep(&mut self) {
        let (sweep, modes) = (&self.sweep, &self.layout.modes);
        let spectra = bytemuck::cast_slice(&self.spectra);
        let block = self.layout.layers.div_ceil(2) * LANES;
        self.solutions.par_chunks_exact_mut(block).enumerate().for_each(|(b, out)| {
            pulp::Arch::new().dispatch(BlockSolve { sweep, modes, b, spectra, out });
        });
    }

    /// Solutions to φ, by way of the spectra.
    fn transform_back(&mut self, phi: &mut [f64]) {
        let layout = &self.layout;
        let cells = layout.nx * layout.rows;
        let (front, back) = phi.split_at_mut(layout.layers.div_ceil(2) * cells);
        let part = layout.chunk * cells;
        let stride = layout.modes.layer_stride;
        let (solutions, column) = (&*self.solutions, self.bare.then_some(&*self.column));
        // Without its middle layer the back may have one part less.
        let none: &mut [f64] = &mut [];
        let back = back.par_rchunks_mut(part).chain(rayon::iter::once(none));
        let chunks =
            front.par_chunks_mut(part).zip(back).zip(self.spectra.par_chunks_mut(layout.chunk * stride));
        chunks.zip(&mut self.scratch).enumerate().for_each(|(c, (((front, back), spectra), scratch))| {
            let first = c * layout.chunk;
            let task = Backward { layout, first, solutions, column, spectra, scratch, front, back };
            pulp::Arch::new().dispatch(task);
        });
    }
}

impl<const D: usize> std::fmt::Debug for DirectPoisson<D> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Layout { nx, rows, layers, .. } = self.0.layout;
        let cells = if D == 3 { vec![nx, rows, layers] } else { vec![nx, layers] };
        f.debug_struct("DirectPoisson").field("cells", &cells).finish_non_exhaustive()
    }
}

impl<const D: usize> PoissonSolver<D> for DirectPoisson<D> {
    fn solve(&mut self, rhs_in_phi_out: &mut [f64]) -> Result<PoissonInfo, PoissonError> {
        self.0.check_length(rhs_in_phi_out)?;
        self.0.transform(&rows_of(rhs_in_phi_out, self.0.layout.nx));
        self.0.finish(rhs_in_phi_out)
    }
}
