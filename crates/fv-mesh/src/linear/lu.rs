//! Sparse LU.
use super::direct::{self, Pattern};
use super::error::check_length;
use super::{DirectInfo, DirectParams, LinearError, LinearOperator, Matrix};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::{Conj, MatMut, Par};

/// P A Q = L U with partial pivoting and a fill-reducing order of columns, by `faer`. The order is found once per
/// pattern.
pub struct SparseLu {
    pattern: Pattern,
    // Of Aᵀ: the rows of A are its columns as they stand.
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    memory: MemBuffer,
    residual: Vec<f64>,
    ready: bool,
}

impl SparseLu {
    /// Analyses the pattern and factorises.
    ///
    /// # Errors
    /// [`LinearError::Memory`], and as [`refactor`](Self::refactor).
    pub fn new(matrix: &Matrix) -> Result<Self, LinearError> {
        let memory_error = || LinearError::Memory { n: matrix.n(), entries: matrix.as_sprs().nnz() };
        direct::check_entries(matrix)?;
        let symbolic = factorize_symbolic_lu(direct::transposed(matrix), Default::default())
            .map_err(|_| memory_error())?;
        let need = symbolic
            .factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_transpose_in_place_scratch::<f64>(1, Par::Seq));
        let memory = MemBuffer::try_new(need).map_err(|_| memory_error())?;
        let mut lu = Self {
            pattern: Pattern::new(matrix),
            symbolic,
            numeric: NumericLu::new(),
            memory,
            residual: vec![0.0; matrix.n()],
            ready: false,
        };
        lu.refactor(matrix)?;
        Ok(lu)
    }

    /// Factorises new values of the same pattern, with the order found before.
    ///
    /// # Errors
    /// [`LinearError::PatternChanged`], [`LinearError::NonFinite`], [`LinearError::Singular`] and
    /// [`LinearError::Memory`].
    pub fn refactor(&mut self, matrix: &Matrix) -> Result<(), LinearError> {
        self.pattern.check(matrix)?;
        direct::check_entries(matrix)?;
        self.ready = false;
        let transposed = SparseColMatRef::new(direct::transposed(matrix), matrix.as_sprs().data());
        self.symbolic
            .factorize_numeric_lu(
                &mut self.numeric,
                transposed,
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .map_err(|e| match e {
                LuError::SymbolicSingular { index } => LinearError::Singular { step: index },
                LuError::Generic(_) => LinearError::Memory { n: matrix.n(), entries: matrix.as_sprs().nnz() },
            })?;
        self.ready = true;
        Ok(())
    }

    /// Solves A x = b; `matrix` is the one factorised (or one close to it: x is then refined). What x held is not
    /// read. If b = 0, x becomes zero.
    ///
    /// # Errors
    /// [`LinearError::NotConverged`] or [`LinearError::NonFinite`] if the matrix is singular to round-off;
    /// [`LinearError::Shape`], [`LinearError::Parameter`], [`LinearError::PatternChanged`], and
    /// [`LinearError::Singular`] after a failed [`refactor`](Self::refactor).
    pub fn solve(
        &mut self,
        matrix: &Matrix,
        b: &[f64],
        x: &mut [f64],
        params: &DirectParams,
    ) -> Result<DirectInfo, LinearError> {
        self.pattern.check(matrix)?;
        check_length("b", matrix.n(), b.len())?;
        check_length("x", matrix.n(), x.len())?;
        if !self.ready {
            return Err(LinearError::Singular { step: 0 });
        }
        let Self { symbolic, numeric, memory, residual, .. } = self;
        direct::solve_refined(matrix, b, x, residual, params, |v| {
            let n = v.len();
            LuRef::new_unchecked(symbolic, numeric).solve_transpose_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(v, n, 1),
                Par::Seq,
                MemStack::new(memory),
            );
        })
    }
}
