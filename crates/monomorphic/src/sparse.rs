//! Sparse matrices.
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::solvers::LltError;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::cholesky::{
    LltRef, SymbolicCholesky, SymbolicCholeskyRaw, factorize_symbolic_cholesky,
};
use faer::sparse::linalg::lu::{LuRef, NumericLu, SymbolicLu, factorize_symbolic_lu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

/// Which entries of a square matrix are stored: those of row `i` in the columns `columns[starts[i]..starts[i + 1]]`, ascending.
#[derive(Clone, Copy, Debug)]
pub struct Pattern<'a> {
    /// As many as there are rows, and one.
    pub starts: &'a [usize],
    /// As many as there are entries.
    pub columns: &'a [usize],
}

impl<'a> Pattern<'a> {
    fn rows(self) -> usize {
        self.starts.len() - 1
    }

    /// The rows as the columns of the transpose.
    fn transposed(self) -> SymbolicSparseColMatRef<'a, usize> {
        SymbolicSparseColMatRef::new_checked(self.rows(), self.rows(), self.starts, None, self.columns)
    }
}

/// Why a matrix has no factors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FactorError {
    /// They do not fit into the memory.
    Memory,
    /// The pivot of this row is not positive.
    NotPositive {
        /// Of the matrix.
        row: usize,
    },
    /// No pivot is left at this step.
    Singular {
        /// From zero.
        step: usize,
    },
}

/// P A Pᵀ = L Lᵀ of a symmetric matrix with a fill-reducing order.
pub struct Cholesky {
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    memory: MemBuffer,
}

impl Cholesky {
    /// Finds the order and makes room.
    ///
    /// # Errors
    /// [`FactorError::Memory`].
    ///
    /// # Panics
    /// If the pattern is none.
    pub fn new(pattern: Pattern<'_>) -> Result<Self, FactorError> {
        let symbolic = factorize_symbolic_cholesky(
            pattern.transposed(),
            Side::Lower,
            Default::default(),
            Default::default(),
        )
        .map_err(|_| FactorError::Memory)?;
        let need =
            symbolic
                .factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default())
                .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let memory = MemBuffer::try_new(need).map_err(|_| FactorError::Memory)?;
        Ok(Self { factor: vec![0.0; symbolic.len_val()], symbolic, memory })
    }

    /// Factorises these values of the pattern that was analysed.
    ///
    /// # Errors
    /// [`FactorError::NotPositive`]; there are no factors then.
    pub fn factorize(&mut self, pattern: Pattern<'_>, values: &[f64]) -> Result<(), FactorError> {
        let result = self.symbolic.factorize_numeric_llt(
            &mut self.factor,
            SparseColMatRef::new(pattern.transposed(), values),
            Side::Lower,
            Default::default(),
            Par::Seq,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
        match result {
            Ok(_) => Ok(()),
            Err(LltError::NonPositivePivot { index }) => {
                let place = match self.symbolic.raw() {
                    // Counted from one.
                    SymbolicCholeskyRaw::Simplicial(_) => index - 1,
                    SymbolicCholeskyRaw::Supernodal(_) => index,
                };
                let row = self.symbolic.perm().map_or(place, |p| p.arrays().0[place]);
                Err(FactorError::NotPositive { row })
            }
        }
    }

    /// Replaces v by A⁻¹ v.
    pub fn solve(&mut self, v: &mut [f64]) {
        let n = v.len();
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(v, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}

/// P A Q = L U with partial pivoting and a fill-reducing order of columns.
pub struct Lu {
    // Of Aᵀ: the rows of A are its columns as they stand.
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    memory: MemBuffer,
}

impl Lu {
    /// Finds the order and makes room.
    ///
    /// # Errors
    /// [`FactorError::Memory`].
    ///
    /// # Panics
    /// If the pattern is none.
    pub fn new(pattern: Pattern<'_>) -> Result<Self, FactorError> {
        let symbolic = factorize_symbolic_lu(pattern.transposed(), Default::default())
            .map_err(|_| FactorError::Memory)?;
        let need = symbolic
            .factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_transpose_in_place_scratch::<f64>(1, Par::Seq));
        let memory = MemBuffer::try_new(need).map_err(|_| FactorError::Memory)?;
        Ok(Self { symbolic, numeric: NumericLu::new(), memory })
    }

    /// Factorises these values of the pattern that was analysed.
    ///
    /// # Errors
    /// [`FactorError::Singular`], [`FactorError::Memory`]; there are no factors then.
    pub fn factorize(&mut self, pattern: Pattern<'_>, values: &[f64]) -> Result<(), FactorError> {
        self.symbolic
            .factorize_numeric_lu(
                &mut self.numeric,
                SparseColMatRef::new(pattern.transposed(), values),
                Par::Seq,
                MemStack::new(&mut self.memory),
                Default::default(),
            )
            .map_err(|e| match e {
                LuError::SymbolicSingular { index } => FactorError::Singular { step: index },
                LuError::Generic(_) => FactorError::Memory,
            })?;
        Ok(())
    }

    /// Replaces v by A⁻¹ v.
    pub fn solve(&mut self, v: &mut [f64]) {
        let n = v.len();
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_transpose_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(v, n, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
    }
}
