//! Conjugate gradients.
use super::criterion::Criterion;
use super::error::check_length;
use super::{LinearError, LinearOperator, Preconditioner, vector};

/// Tolerances of [`conjugate_gradient`]: it ends when ‖b − A x‖ ≤ max(relative ‖b‖, absolute).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CgParams {
    /// Of ‖b‖.
    pub relative: f64,
    /// In the unit of b.
    pub absolute: f64,
    /// Iterations allowed, each with one product A p and one use of the preconditioner.
    pub max_iterations: usize,
}

impl Default for CgParams {
    fn default() -> Self {
        Self { relative: 1e-8, absolute: 0.0, max_iterations: 1000 }
    }
}

/// What [`conjugate_gradient`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CgInfo {
    /// Iterations made.
    pub iterations: usize,
    /// ‖b − A x‖ / ‖b‖ of the x given.
    pub initial_residual: f64,
    /// ‖b − A x‖ / ‖b‖ of the x found, computed from x itself.
    pub residual: f64,
}

/// Work vectors of [`conjugate_gradient`].
#[derive(Clone, Debug)]
pub struct CgScratch {
    r: Vec<f64>,
    z: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
}

impl CgScratch {
    /// For `n` unknowns.
    pub fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Self { r: zeros(), z: zeros(), p: zeros(), q: zeros() }
    }
}

/// Solves A x = b for symmetric positive definite A from the x given, by preconditioned conjugate gradients
/// (Hestenes & Stiefel 1952) with β = z_{k+1}·(r_{k+1} − r_k) / z_k·r_k (Notay 2000), which lets the preconditioner
/// be slightly non-symmetric or change between iterations. A singular A (all sides Neumann) is fine if b sums up
/// to zero; x then keeps its component along the null space. If b = 0, x becomes zero.
///
/// # Errors
/// [`LinearError::Indefinite`] if p·A p or r·z is not positive, [`LinearError::NotConverged`] with the last iterate
/// in x, [`LinearError::Shape`], [`LinearError::NonFinite`] and [`LinearError::Parameter`].
pub fn conjugate_gradient(
    a: &(impl LinearOperator + ?Sized),
    preconditioner: &mut (impl Preconditioner + ?Sized),
    b: &[f64],
    x: &mut [f64],
    scratch: &mut CgScratch,
    params: &CgParams,
) -> Result<CgInfo, LinearError> {
    let n = a.n();
    check_length("the preconditioner", n, preconditioner.n())?;
    check_length("the scratch", n, scratch.r.len())?;
    let Some(criterion) = Criterion::new([params.relative, params.absolute], n, b, x)? else {
        return Ok(CgInfo::default());
    };
    let CgScratch { r, z, p, q } = scratch;
    let initial = criterion.residual(a, b, x, r)?;
    // The residual that the present run of conjugate directions began with.
    let mut start = initial;
    let mut norm = initial;
    let mut iteration = 0;
    loop {
        if norm <= criterion.target {
            return Ok(CgInfo {
                iterations: iteration,
                initial_residual: initial / criterion.scale,
                residual: norm / criterion.scale,
            });
        }
        preconditioner.apply(r, z);
        p.copy_from_slice(z);
        let mut rho = vector::dot(r, z);
        while norm > criterion.target {
            if iteration == params.max_iterations {
                return Err(criterion.not_converged(iteration, criterion.residual(a, b, x, r)?));
            }
            let indefinite = |what, value| LinearError::Indefinite { iteration, what, value };
            if rho <= 0.0 || rho.is_nan() {
                return Err(indefinite("r · M⁻¹ r", rho));
            }
            a.apply(p, q);
            let curvature = vector::dot(p, q);
            if curvature <= 0.0 || curvature.is_nan() {
                return Err(indefinite("p · A p", curvature));
            }
            let alpha = rho / curvature;
            norm = vector::step(alpha, p, q, x, r).sqrt();
            iteration += 1;
            if norm <= criterion.target {
                break;
            }
            preconditioner.apply(r, z);
            // r_k = r_{k+1} + α q.
            let [next, along] = vector::dot_two(z, r, q);
            vector::scale_add(z, -alpha * along / rho, p);
            rho = next;
        }
        // Round-off separates the recurred residual from the true one.
        norm = criterion.residual(a, b, x, r)?;
        if norm > criterion.target && norm > 0.5 * start {
            return Err(criterion.not_converged(iteration, norm));
        }
        start = norm;
    }
}
