//! Dense systems of equations.
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::{cholesky::llt, lu::partial_pivoting as lu, qr::no_pivoting as qr};
use faer::perm::PermRef;
use faer::{Conj, Mat, MatMut, MatRef, Par};

/// P A = L U of a square matrix, with partial pivoting.
pub struct DenseLu {
    /// L below the diagonal, U on it and above.
    factors: Mat<f64>,
    order: Vec<usize>,
    inverse_order: Vec<usize>,
}

impl DenseLu {
    /// Factorises.
    ///
    /// # Panics
    /// If A is not square.
    #[must_use]
    pub fn new(mut a: Mat<f64>) -> Self {
        let n = a.nrows();
        assert_eq!(n, a.ncols());
        let (mut order, mut inverse_order) = (vec![0; n], vec![0; n]);
        let need = lu::factor::lu_in_place_scratch::<usize, f64>(n, n, Par::Seq, Default::default());
        let stack = &mut MemBuffer::new(need);
        let stack = MemStack::new(stack);
        lu::factor::lu_in_place(
            a.as_mut(),
            &mut order,
            &mut inverse_order,
            Par::Seq,
            stack,
            Default::default(),
        );
        Self { factors: a, order, inverse_order }
    }
    fn permutation(&self) -> PermRef<'_, usize> {
        PermRef::new_checked(&self.order, &self.inverse_order, self.order.len())
    }
    /// Replaces B by A⁻¹ B; entries are not finite if A is singular.
    ///
    /// # Panics
    /// If the shapes do not fit.
    pub fn solve(&self, b: MatMut<'_, f64>) {
        let need = lu::solve::solve_in_place_scratch::<usize, f64>(self.order.len(), b.ncols(), Par::Seq);
        let stack = &mut MemBuffer::new(need);
        let stack = MemStack::new(stack);
        let factors = self.factors.as_ref();
        lu::solve::solve_in_place_with_conj(
            factors,
            factors,
            self.permutation(),
            Conj::No,
            b,
            Par::Seq,
            stack,
        );
    }
    /// A⁻¹; entries are not finite if A is singular.
    #[must_use]
    pub fn inverse(&self) -> Mat<f64> {
        let n = self.order.len();
        let need = lu::inverse::inverse_scratch::<usize, f64>(n, Par::Seq);
        let stack = &mut MemBuffer::new(need);
        let stack = MemStack::new(stack);
        let mut inverse = Mat::zeros(n, n);
        let factors = self.factors.as_ref();
        lu::inverse::inverse(inverse.as_mut(), factors, factors, self.permutation(), Par::Seq, stack);
        inverse
    }
}

/// A = Q R of a matrix with at least as many rows as columns, by Householder reflections.
pub struct Qr {
    /// The reflections below the diagonal, R on it and above.
    factors: Mat<f64>,
    coefficients: Mat<f64>,
}

impl Qr {
    /// Factorises.
    ///
    /// # Panics
    /// If A has fewer rows than columns.
    #[must_use]
    pub fn new(mut a: Mat<f64>) -> Self {
        let (m, n) = a.shape();
        assert!(m >= n, "{m} rows and {n} columns");
        let block = qr::factor::recommended_block_size::<f64>(m, n);
        let mut coefficients = Mat::zeros(block, n);
        let need = qr::factor::qr_in_place_scratch::<f64>(m, n, block, Par::Seq, Default::default());
        let stack = &mut MemBuffer::new(need);
        let stack = MemStack::new(stack);
        qr::factor::qr_in_place(a.as_mut(), coefficients.as_mut(), Par::Seq, stack, Default::default());
        Self { factors: a, coefficients }
    }
    /// R, square.
    #[must_use]
    pub fn upper(&self) -> Mat<f64> {
        let n = self.factors.ncols();
        Mat::from_fn(n, n, |i, j| if i <= j { self.factors[(i, j)] } else { 0.0 })
    }
    /// The diagonal of R: zeros to round-off where a column depends on those before.
    pub fn diagonal(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.factors.ncols()).map(|i| self.factors[(i, i)])
    }
    /// Replaces the first rows of B by the X that makes |A X − B| smallest, column by column, and the others by the rest of Qᵀ B,
    /// whose norm is that smallest one.
    ///
    /// # Panics
    /// If B has another number of rows than A.
    pub fn solve(&self, b: MatMut<'_, f64>) {
        let (m, n) = self.factors.shape();
        let block = self.coefficients.nrows();
        let need = qr::solve::solve_lstsq_in_place_scratch::<f64>(m, n, block, b.ncols(), Par::Seq);
        let stack = &mut MemBuffer::new(need);
        let stack = MemStack::new(stack);
        let (factors, coefficients) = (self.factors.as_ref(), self.coefficients.as_ref());
        qr::solve::solve_lstsq_in_place_with_conj(
            factors,
            coefficients,
            factors,
            Conj::No,
            b,
            Par::Seq,
            stack,
        );
    }
}

/// Replaces B by A⁻¹ B of a positive definite matrix, of which the lower triangle is read, by Cholesky's factors; false, and B is
/// as it was, if it is not positive definite to round-off.
///
/// # Panics
/// If the shapes do not fit.
#[must_use]
pub fn solve_positive(a: MatRef<'_, f64>, b: MatMut<'_, f64>) -> bool {
    let n = a.nrows();
    let mut factor = a.to_owned();
    let need = llt::factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, Default::default())
        .or(llt::solve::solve_in_place_scratch::<f64>(n, b.ncols(), Par::Seq));
    let stack = &mut MemBuffer::new(need);
    let stack = MemStack::new(stack);
    let factorised = llt::factor::cholesky_in_place(
        factor.as_mut(),
        Default::default(),
        Par::Seq,
        stack,
        Default::default(),
    );
    if factorised.is_err() {
        return false;
    }
    llt::solve::solve_in_place_with_conj(factor.as_ref(), Conj::No, b, Par::Seq, stack);
    true
}
