//! Gauss–Seidel sweeps.
use super::criterion::Criterion;
use super::error::check_length;
use super::{LinearError, LinearOperator, Preconditioner};

/// Order of one sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sweep {
    /// Rows in ascending order.
    Forward,
    /// Rows in descending order.
    Backward,
}

/// A matrix whose rows can be solved one by one for their own unknown with the latest values of the others.
pub trait GaussSeidelSweep: LinearOperator {
    /// Checks that every diagonal entry can be divided by.
    ///
    /// # Errors
    /// [`LinearError::ZeroPivot`].
    fn check_diagonal(&self) -> Result<(), LinearError>;

    /// x_P = (b_P − Σ_N a_N x_N)/a_P, row after row. The slices have [`n`](LinearOperator::n) entries;
    /// `work` is for an implementation to write to.
    fn sweep(&self, sweep: Sweep, b: &[f64], x: &mut [f64], work: &mut [f64]);
}

/// Order of the sweeps of [`gauss_seidel`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SweepOrder {
    /// Always forward.
    #[default]
    Forward,
    /// Forward and backward in turn.
    Symmetric,
}

/// Tolerances of [`gauss_seidel`]: it ends when ‖b − A x‖ ≤ max(relative ‖b‖, absolute).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussSeidelParams {
    /// Of ‖b‖.
    pub relative: f64,
    /// In the unit of b.
    pub absolute: f64,
    /// Sweeps allowed.
    pub max_iterations: usize,
    /// Sweeps between two looks at the residual, at least 1.
    pub sweeps_per_check: usize,
    /// Order of the sweeps.
    pub order: SweepOrder,
}

impl Default for GaussSeidelParams {
    fn default() -> Self {
        Self {
            relative: 1e-8,
            absolute: 0.0,
            max_iterations: 10_000,
            sweeps_per_check: 4,
            order: SweepOrder::Forward,
        }
    }
}

/// What [`gauss_seidel`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GaussSeidelInfo {
    /// Sweeps made.
    pub iterations: usize,
    /// ‖b − A x‖ / ‖b‖ of the x given.
    pub initial_residual: f64,
    /// ‖b − A x‖ / ‖b‖ of the x found.
    pub residual: f64,
}

/// Work vector of [`gauss_seidel`].
#[derive(Clone, Debug)]
pub struct GaussSeidelScratch {
    r: Vec<f64>,
}

impl GaussSeidelScratch {
    /// For `n` unknowns.
    pub fn new(n: usize) -> Self {
        Self { r: vec![0.0; n] }
    }
}

/// Solves A x = b from the x given by Gauss–Seidel sweeps. They converge for diagonally dominant and for symmetric
/// positive definite A. If b = 0, x becomes zero.
///
/// # Errors
/// [`LinearError::ZeroPivot`], [`LinearError::NotConverged`] with the last iterate in x, [`LinearError::Shape`],
/// [`LinearError::NonFinite`] (x grew beyond all bounds) and [`LinearError::Parameter`].
pub fn gauss_seidel(
    a: &(impl GaussSeidelSweep + ?Sized),
    b: &[f64],
    x: &mut [f64],
    scratch: &mut GaussSeidelScratch,
    params: &GaussSeidelParams,
) -> Result<GaussSeidelInfo, LinearError> {
    let n = a.n();
    check_length("the scratch", n, scratch.r.len())?;
    if params.sweeps_per_check == 0 {
        return Err(LinearError::Parameter { name: "sweeps_per_check", value: 0.0, range: "at least 1" });
    }
    let Some(criterion) = Criterion::new([params.relative, params.absolute], n, b, x)? else {
        return Ok(GaussSeidelInfo::default());
    };
    a.check_diagonal()?;
    let r = &mut scratch.r;
    let initial = criterion.residual(a, b, x, r)?;
    let mut norm = initial;
    let mut iterations = 0;
    while norm > criterion.target {
        if iterations == params.max_iterations {
            return Err(criterion.not_converged(iterations, norm));
        }
        for _ in 0..params.sweeps_per_check.min(params.max_iterations - iterations) {
            match params.order {
                SweepOrder::Symmetric if iterations % 2 == 1 => a.sweep(Sweep::Backward, b, x, r),
                SweepOrder::Forward | SweepOrder::Symmetric => a.sweep(Sweep::Forward, b, x, r),
            }
            iterations += 1;
        }
        norm = criterion.residual(a, b, x, r)?;
    }
    let initial_residual = initial / criterion.scale;
    Ok(GaussSeidelInfo { iterations, initial_residual, residual: norm / criterion.scale })
}

/// Symmetric Gauss–Seidel as a preconditioner: a forward and a backward sweep from zero,
/// M = (D + L) D⁻¹ (D + U). Symmetric if A is.
#[derive(Clone, Debug)]
pub struct SymmetricGaussSeidel<'a, A: ?Sized> {
    matrix: &'a A,
    work: Vec<f64>,
}

impl<'a, A: GaussSeidelSweep + ?Sized> SymmetricGaussSeidel<'a, A> {
    /// Sweeps over `matrix`.
    ///
    /// # Errors
    /// [`LinearError::ZeroPivot`].
    pub fn new(matrix: &'a A) -> Result<Self, LinearError> {
        matrix.check_diagonal()?;
        Ok(Self { matrix, work: vec![0.0; matrix.n()] })
    }
}

impl<A: GaussSeidelSweep + ?Sized> Preconditioner for SymmetricGaussSeidel<'_, A> {
    fn n(&self) -> usize {
        self.matrix.n()
    }
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        z.fill(0.0);
        self.matrix.sweep(Sweep::Forward, r, z, &mut self.work);
        self.matrix.sweep(Sweep::Backward, r, z, &mut self.work);
    }
}
