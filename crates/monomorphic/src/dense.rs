//! Dense matrices.
use crate::self_adjoint_eigen;
use faer::linalg::matmul::matmul;
use faer::linalg::solvers::DenseSolveCore;
use faer::{Accum, Mat, MatMut, MatRef, Par};

/// Orthonormal eigenvectors of a self-adjoint matrix as columns, in the order of ascending eigenvalues; only the lower triangle is
/// read. None if the decomposition does not converge.
#[must_use]
pub fn self_adjoint_eigenvectors(a: MatRef<'_, f64>) -> Option<Mat<f64>> {
    Some(self_adjoint_eigen(a)?.1)
}

/// `to` += A B.
///
/// # Panics
/// If the shapes do not fit.
pub fn add_product(to: MatMut<'_, f64>, a: MatRef<'_, f64>, b: MatRef<'_, f64>) {
    matmul(to, Accum::Add, a, b, 1.0, Par::Seq);
}

/// A⁻¹ by LU with partial pivoting; entries are not finite if A is singular.
///
/// # Panics
/// If A is not square.
#[must_use]
pub fn inverse(a: MatRef<'_, f64>) -> Mat<f64> {
    a.partial_piv_lu().inverse()
}
