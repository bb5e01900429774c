//! Singular values and eigenvalues.
use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::evd::{self, ComputeEigenvectors};
use faer::linalg::householder;
use faer::linalg::matmul::dot::inner_prod;
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::svd::{self, ComputeSvdVectors};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, ColRef, Conj, Mat, MatMut, MatRef, Par};

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

/// Rows of a block that [`TriangularFactor`] takes at once: norms of shorter columns have smaller rounding errors.
const ROWS: usize = 2048;
/// Columns whose reflectors are applied together to the columns after them, and one by one among themselves.
const PANEL: usize = 64;
const NARROW: usize = 8;

/// R of A = Q R, of blocks of rows one after the other (Demmel et al., SIAM J. Sci. Comput. 34 (2012) A206). No column is
/// taken for a combination of others, so that small singular values are those of A.
pub struct TriangularFactor {
    r: Mat<f64>,
    block: Mat<f64>,
    /// T of I − V T⁻¹ Vᵀ of a panel.
    factor: Mat<f64>,
    product: Mat<f64>,
}

impl TriangularFactor {
    /// R = 0 of a matrix without rows.
    #[must_use]
    pub fn new(columns: usize) -> Self {
        Self {
            r: Mat::zeros(columns, columns),
            block: Mat::zeros(ROWS, columns),
            factor: Mat::zeros(PANEL, PANEL),
            product: Mat::zeros(PANEL, columns),
        }
    }

    /// Adds rows to A.
    ///
    /// # Panics
    /// If the numbers of columns differ.
    pub fn add(&mut self, a: MatRef<'_, f64>) {
        let n = self.r.ncols();
        for first in (0..a.nrows()).step_by(ROWS) {
            let rows = ROWS.min(a.nrows() - first);
            let mut block = self.block.as_mut().subrows_mut(0, rows);
            block.copy_from(a.subrows(first, rows));
            for at in (0..n).step_by(PANEL) {
                let width = PANEL.min(n - at);
                let r = self.r.as_mut().submatrix_mut(at, at, width, n - at);
                let block = block.rb_mut().subcols_mut(at, n - at);
                let factor = self.factor.as_mut().submatrix_mut(0, 0, width, width);
                reflect(r, block, width, factor, self.product.as_mut());
            }
        }
    }

    /// R.
    #[must_use]
    pub fn factor(&self) -> MatRef<'_, f64> {
        self.r.as_ref()
    }
}

/// Reflects the first `width` columns of B (rows below) into those of R (as many rows) and applies the reflections to the
/// others. V = [I; B] with what is left in B, T = ½ diag(VᵀV) + the strictly upper triangle of VᵀV.
fn reflect(
    mut r: MatMut<'_, f64>,
    mut b: MatMut<'_, f64>,
    width: usize,
    mut t: MatMut<'_, f64>,
    mut product: MatMut<'_, f64>,
) {
    let (first, rest) = b.rb_mut().split_at_col_mut(width);
    let (mut first, mut rest) = (first, rest);
    let (mut r_first, mut r_rest) = r.rb_mut().split_at_col_mut(width);
    if width <= NARROW {
        for j in 0..width {
            let (v, mut others) = first.rb_mut().subcols_mut(j, width - j).split_at_col_mut(1);
            let mut v = v.col_mut(0);
            let tau = householder::make_householder_in_place(&mut r_first[(j, j)], v.rb_mut()).tau;
            t[(j, j)] = tau;
            for c in j + 1..width {
                let k = (r_first[(j, c)] + inner_product(v.rb(), others.rb().col(c - j - 1))) / tau;
                r_first[(j, c)] -= k;
                let column = others.rb_mut().col_mut(c - j - 1);
                faer::zip!(column, v.rb()).for_each(|faer::unzip!(to, v)| *to -= k * v);
            }
        }
        let v = first.rb();
        for (i, j) in (0..width).flat_map(|j| (0..j).map(move |i| (i, j))) {
            t[(i, j)] = inner_product(v.col(i), v.col(j));
        }
    } else {
        let half = (width / 2).next_multiple_of(NARROW);
        reflect(
            r_first.rb_mut().subrows_mut(0, half),
            first.rb_mut(),
            half,
            t.rb_mut().submatrix_mut(0, 0, half, half),
            product.rb_mut(),
        );
        reflect(
            r_first.rb_mut().submatrix_mut(half, half, width - half, width - half),
            first.rb_mut().subcols_mut(half, width - half),
            width - half,
            t.rb_mut().submatrix_mut(half, half, width - half, width - half),
            product.rb_mut(),
        );
        let (v, w) = first.rb().split_at_col(half);
        let corner = t.rb_mut().submatrix_mut(0, half, half, width - half);
        matmul(corner, Accum::Replace, v.transpose(), w, 1.0, Par::Seq);
    }
    if rest.ncols() == 0 {
        return;
    }
    let mut product = product.submatrix_mut(0, 0, width, rest.ncols());
    product.copy_from(r_rest.rb());
    matmul(product.rb_mut(), Accum::Add, first.rb().transpose(), rest.rb(), 1.0, Par::Seq);
    solve_lower_triangular_in_place(t.rb().transpose(), product.rb_mut(), Par::Seq);
    r_rest -= product.rb();
    matmul(rest.rb_mut(), Accum::Add, first.rb(), product.rb(), -1.0, Par::Seq);
}

fn inner_product(a: ColRef<'_, f64>, b: ColRef<'_, f64>) -> f64 {
    inner_prod(a.transpose(), Conj::No, b, Conj::No)
}
