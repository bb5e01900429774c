//! What the solvers need to know of a matrix and of a preconditioner.
use super::vector;

/// A square linear map x ↦ A x. Slices have one entry per unknown.
pub trait LinearOperator: Sync {
    /// Number of unknowns.
    fn n(&self) -> usize;

    /// y = A x. The slices have [`n`](Self::n) entries.
    fn apply(&self, x: &[f64], y: &mut [f64]);

    /// r = b − A x.
    fn residual(&self, b: &[f64], x: &[f64], r: &mut [f64]) {
        self.apply(x, r);
        vector::subtract_from(b, r);
    }
}

/// An approximate inverse, z ≈ A⁻¹ r. It may change from call to call (a multigrid cycle, a few sweeps): the
/// solvers here are flexible as far as their pages say.
pub trait Preconditioner {
    /// Number of unknowns.
    fn n(&self) -> usize;

    /// Writes z; what z held is not read. The slices have [`n`](Self::n) entries.
    fn apply(&mut self, r: &[f64], z: &mut [f64]);
}

/// z = r.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    n: usize,
}

impl Identity {
    /// For `n` unknowns.
    pub fn new(n: usize) -> Self {
        Self { n }
    }
}

impl Preconditioner for Identity {
    fn n(&self) -> usize {
        self.n
    }
    fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        z.copy_from_slice(r);
    }
}
