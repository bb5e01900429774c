//! Linear least squares, many times over.
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::qr::no_pivoting as qr;
use faer::{Conj, Mat, MatMut, Par};

/// min |A X − B| for matrices of one shape, one after another, without allocation.
pub struct LeastSquares {
    a: Mat<f64>,
    coefficients: Mat<f64>,
    memory: MemBuffer,
}

impl LeastSquares {
    /// For A of m rows and n columns and B of k columns.
    ///
    /// # Panics
    /// If there are fewer rows than columns.
    #[must_use]
    pub fn new(m: usize, n: usize, k: usize) -> Self {
        assert!(m >= n, "{m} rows and {n} columns");
        let block = qr::factor::recommended_block_size::<f64>(m, n);
        let need = qr::factor::qr_in_place_scratch::<f64>(m, n, block, Par::Seq, Default::default())
            .or(qr::solve::solve_lstsq_in_place_scratch::<f64>(m, n, block, k, Par::Seq));
        Self { a: Mat::zeros(m, n), coefficients: Mat::zeros(block, n), memory: MemBuffer::new(need) }
    }
    /// A, to be written in full before every [`solve`](Self::solve).
    pub fn matrix(&mut self) -> MatMut<'_, f64> {
        self.a.as_mut()
    }
    /// Replaces the first n rows of B by X and the others by the rest of Qᵀ B, by Householder reflections; A is lost.
    ///
    /// # Panics
    /// If B is not m × k.
    pub fn solve(&mut self, b: MatMut<'_, f64>) {
        let stack = MemStack::new(&mut self.memory);
        qr::factor::qr_in_place(
            self.a.as_mut(),
            self.coefficients.as_mut(),
            Par::Seq,
            stack,
            Default::default(),
        );
        let (a, coefficients) = (self.a.as_ref(), self.coefficients.as_ref());
        qr::solve::solve_lstsq_in_place_with_conj(a, coefficients, a, Conj::No, b, Par::Seq, stack);
    }
}
