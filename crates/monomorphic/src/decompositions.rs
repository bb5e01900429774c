//! Singular values and eigenvalues.
use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{self, ComputeEigenvectors};
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::svd::{self, ComputeSvdVectors};
use faer::{Accum, Mat, MatMut, MatRef, Par};

/// Eigenvalues of a self-adjoint matrix, ascending, and orthonormal eigenvectors as columns; only the lower triangle is read. None if the decomposition does not
/// converge.
#[must_use]
pub fn self_adjoint_eigen(a: MatRef<'_, f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let n = a.nrows();
    let (mut values, mut vectors) = (Diag::zeros(n), Mat::zeros(n, n));
    let need =
        evd::self_adjoint_evd_scratch::<f64>(n, ComputeEigenvectors::Yes, Par::Seq, Default::default());
    evd::self_adjoint_evd(
        a,
        values.as_mut(),
        Some(vectors.as_mut()),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(need)),
        Default::default(),
    )
    .ok()?;
    Some((values.column_vector().iter().copied().collect(), vectors))
}

/// A = U diag(s) Vᵀ with min(m, n) columns in U and V, s descending. None if the decomposition does not converge.
#[must_use]
pub fn thin_svd(a: MatRef<'_, f64>) -> Option<(Mat<f64>, Vec<f64>, Mat<f64>)> {
    let (m, n) = (a.nrows(), a.ncols());
    let size = m.min(n);
    let (mut s, mut u, mut v) = (Diag::zeros(size), Mat::zeros(m, size), Mat::zeros(n, size));
    let thin = ComputeSvdVectors::Thin;
    let need = svd::svd_scratch::<f64>(m, n, thin, thin, Par::Seq, Default::default());
    svd::svd(
        a,
        s.as_mut(),
        Some(u.as_mut()),
        Some(v.as_mut()),
        Par::Seq,
        MemStack::new(&mut MemBuffer::new(need)),
        Default::default(),
    )
    .ok()?;
    Some((u, s.column_vector().iter().copied().collect(), v))
}

/// The lower triangle of `to` += AᵀA.
///
/// # Panics
/// If the shapes do not fit.
pub fn add_gram(to: MatMut<'_, f64>, a: MatRef<'_, f64>) {
    let full = BlockStructure::Rectangular;
    triangular::matmul(
        to,
        BlockStructure::TriangularLower,
        Accum::Add,
        a.transpose(),
        full,
        a,
        full,
        1.0,
        Par::Seq,
    );
}
