//! Geometric multigrid for boxes with stretched axes.
//!
//! With cell-centred unknowns φ on cells of widths w_i along each axis, distances d_i = (w_{i−1} + w_i)/2 of their
//! centres and face coefficients β ≥ 0 (1 unless [set](Multigrid::set_coefficients)), [`MultigridCg`] and [`Multigrid`]
//! solve
//!
//! ```text
//! Σ_a (1/w_i) [ β_{i+½} (φ_{i+1} − φ_i)/d_{i+1} − β_{i−½} (φ_i − φ_{i−1})/d_i ] − s φ = f
//! ```
//!
//! in every cell, s ≥ 0 \[1/m²\]. At the ends of an axis the box repeats itself, or the gradient is zero at the face, or
//! the value is (the flux is then 2β(0 − φ)/w), on a whole side or [cell by cell](Multigrid::set_ends). Data are dense
//! with x fastest, in two or three dimensions. Norms are weighted by the volumes of the cells.
//!
//! Coarsening: on each level those cells are merged in twos, axis by axis, that are together no wider than a limit, which
//! doubles from level to level. So narrow cells are merged first, and a level is coarsened, place by place, only along
//! the axes with strong coupling there; this keeps point smoothing effective however the axes are stretched (compare
//! semi-coarsening, Trottenberg, Oosterlee & Schüller, *Multigrid*, 2001, § 5.1). The coarse operators are the same
//! differences on the merged cells, interpolation is linear along each axis, restriction its adjoint, the smoother
//! red–black Gauss–Seidel, the coarsest level is solved by Cholesky factors. If β varies, resistances of fine faces in
//! series add up, as do conductances side by side, and interpolation follows the resistances. β that makes coupling
//! strong along an axis where cells are wide is not seen by the coarsening.
//!
//! ```
//! use fv_mesh::poisson::PoissonAxis;
//! use fv_mesh::poisson::multigrid::{MultigridCg, MultigridParams};
//! use fv_mesh::poisson::{AxisBounds, PoissonSolver};
//! // φ'' = 1 between walls of zero value at 0 and 1: φ = x(x − 1)/2.
//! let x = PoissonAxis { widths: vec![0.25; 4], ends: AxisBounds::Periodic };
//! let y = PoissonAxis { widths: (0..64).map(|i| (1 + i) as f64 / 2080.0).collect(), ends: AxisBounds::Dirichlet };
//! let mut poisson = MultigridCg::new([x, y], 0.0, MultigridParams::default())?;
//! let mut phi = vec![1.0; 256];
//! let info = poisson.solve(&mut phi)?;
//! assert!(info.iterations < 10 && info.residual <= 1e-6);
//! assert!((phi.iter().fold(0.0, |m: f64, p| m.min(*p)) + 0.125).abs() < 1e-3);
//! # Ok::<(), fv_mesh::poisson::PoissonError>(())
//! ```
mod axis;
mod cg;
mod coarsen;
mod coarsest;
mod coefficients;
mod fields;
mod hierarchy;
mod level;
mod params;
mod precision;
mod solver;
mod stencil;
#[cfg(test)]
mod tests;
mod transfer;
mod weighted;

pub use cg::MultigridCg;
pub use params::MultigridParams;
pub use solver::Multigrid;
