//! Linear systems A x = b of implicit finite-volume equations.
//!
//! Matrices are [`StencilMatrix`] (a cell and its face neighbours on a box; the fast one) or [`Matrix`] (compressed
//! rows, any pattern). Both have the manipulations of implicit flow algorithms: under-relaxation, pinned and blended
//! rows, H(x), residuals. Solvers work on any [`LinearOperator`] and [`Preconditioner`]:
//!
//! | solver | for | preconditioners |
//! |---|---|---|
//! | [`conjugate_gradient`] | symmetric positive definite | [`Identity`], [`Jacobi`], [`SymmetricGaussSeidel`], |
//! | [`bicgstab`] | any regular A | [`Ilu0`], [`Dilu`], your own |
//! | [`gauss_seidel`] | diagonally dominant; few sweeps | |
//! | [`SparseCholesky`], [`SparseLu`] | direct; small or two-dimensional | |
//!
//! The caller owns the work vectors; a solve allocates nothing. Results do not depend on the number of threads.
//! Products and vector updates run on all threads of the pool they are called from; sweeps and factor solves on one.
//!
//! ```
//! use fv_mesh::linear::{BiCgStabParams, BiCgStabScratch, Dilu, StencilMatrix, bicgstab};
//! // −φ'' = 1 between walls with φ = 0, on 10 cells of size 0.1.
//! let mut a = StencilMatrix::new([10], [false])?;
//! let (centre, lower, upper) = a.parts_mut();
//! centre.fill(200.0);
//! lower[0].fill(-100.0);
//! upper[0].fill(-100.0);
//! (centre[0], centre[9]) = (300.0, 300.0);
//! let dilu = Dilu::new(&a)?;
//! let (b, mut phi) = ([1.0; 10], [0.0; 10]);
//! let mut scratch = BiCgStabScratch::new(10);
//! bicgstab(&a, &mut dilu.with(&a)?, &b, &mut phi, &mut scratch, &BiCgStabParams::default())?;
//! assert!((phi[4] - 0.125).abs() < 1e-12);
//! # Ok::<(), fv_mesh::linear::LinearError>(())
//! ```
mod bicgstab;
mod cholesky;
mod conjugate_gradient;
mod criterion;
mod direct;
mod error;
mod gauss_seidel;
mod ilu0;
mod jacobi;
mod lu;
mod matrix;
mod operator;
mod stencil;
#[cfg(test)]
mod tests;
pub(crate) mod vector;

pub use bicgstab::{BiCgStabInfo, BiCgStabParams, BiCgStabScratch, bicgstab};
pub use cholesky::SparseCholesky;
pub use conjugate_gradient::{CgInfo, CgParams, CgScratch, conjugate_gradient};
pub use direct::{DirectInfo, DirectParams};
pub use error::LinearError;
pub use gauss_seidel::{
    GaussSeidelInfo, GaussSeidelParams, GaussSeidelScratch, GaussSeidelSweep, Sweep, SweepOrder,
    SymmetricGaussSeidel, gauss_seidel,
};
pub use ilu0::Ilu0;
pub use jacobi::Jacobi;
pub use lu::SparseLu;
pub use matrix::Matrix;
pub use operator::{Identity, LinearOperator, Preconditioner};
pub use stencil::{Dilu, DiluPreconditioner, RedBlack, StencilMatrix};
