//! Stabilised bi-conjugate gradients.
use super::criterion::Criterion;
use super::error::check_length;
use super::{LinearError, LinearOperator, Preconditioner, vector};

/// Tolerances of [`bicgstab`]: it ends when ‖b − A x‖ ≤ max(relative ‖b‖, absolute).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BiCgStabParams {
    /// Of ‖b‖.
    pub relative: f64,
    /// In the unit of b.
    pub absolute: f64,
    /// Iterations allowed, each with two products with A and two uses of the preconditioner.
    pub max_iterations: usize,
}

impl Default for BiCgStabParams {
    fn default() -> Self {
        Self { relative: 1e-8, absolute: 0.0, max_iterations: 1000 }
    }
}

/// What [`bicgstab`] did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BiCgStabInfo {
    /// Iterations made; the last one may have been a half.
    pub iterations: usize,
    /// Restarts from the true residual after a breakdown.
    pub restarts: usize,
    /// ‖b − A x‖ / ‖b‖ of the x given.
    pub initial_residual: f64,
    /// ‖b − A x‖ / ‖b‖ of the x found, computed from x itself.
    pub residual: f64,
}

/// Work vectors of [`bicgstab`].
#[derive(Clone, Debug)]
pub struct BiCgStabScratch {
    r: Vec<f64>,
    shadow: Vec<f64>,
    p: Vec<f64>,
    v: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    t: Vec<f64>,
}

impl BiCgStabScratch {
    /// For `n` unknowns.
    pub fn new(n: usize) -> Self {
        let zeros = || vec![0.0; n];
        Self { r: zeros(), shadow: zeros(), p: zeros(), v: zeros(), y: zeros(), z: zeros(), t: zeros() }
    }
}

/// How a run of [`run`] ended.
enum End {
    /// The recurred residual is small enough.
    Small,
    /// The iterations ran out.
    Exhausted,
    /// A denominator vanished: which and its value.
    Breakdown(&'static str, f64),
}

/// |cos| of the angle between two vectors below which a product of theirs counts as zero.
const ORTHOGONAL: f64 = 1e-14;

/// Solves A x = b for any regular A from the x given, by BiCGSTAB (van der Vorst 1992) preconditioned from the right,
/// so that the residuals are those of A x = b. It restarts from the true residual when a denominator vanishes. A
/// preconditioner that changes from call to call delays convergence but does no harm to the answer. If b = 0, x
/// becomes zero.
///
/// # Errors
/// [`LinearError::Breakdown`] if a restart does not help, [`LinearError::NotConverged`] with the last iterate in x,
/// [`LinearError::Shape`], [`LinearError::NonFinite`] and [`LinearError::Parameter`].
pub fn bicgstab(
    a: &(impl LinearOperator + ?Sized),
    preconditioner: &mut (impl Preconditioner + ?Sized),
    b: &[f64],
    x: &mut [f64],
    scratch: &mut BiCgStabScratch,
    params: &BiCgStabParams,
) -> Result<BiCgStabInfo, LinearError> {
    let n = a.n();
    check_length("the preconditioner", n, preconditioner.n())?;
    check_length("the scratch", n, scratch.r.len())?;
    let Some(criterion) = Criterion::new([params.relative, params.absolute], n, b, x)? else {
        return Ok(BiCgStabInfo::default());
    };
    let initial = criterion.residual(a, b, x, &mut scratch.r)?;
    let mut norm = initial;
    let mut info = BiCgStabInfo { initial_residual: initial / criterion.scale, ..BiCgStabInfo::default() };
    while norm > criterion.target {
        let before = info.iterations;
        let end =
            run(a, preconditioner, x, scratch, norm, criterion.target, params.max_iterations, &mut info);
        let reached = criterion.residual(a, b, x, &mut scratch.r)?;
        match end {
            _ if reached <= criterion.target => {}
            End::Exhausted => return Err(criterion.not_converged(info.iterations, reached)),
            // Round-off separates the recurred residual from the true one; starting over helps while it falls.
            End::Small if reached > 0.5 * norm => {
                return Err(criterion.not_converged(info.iterations, reached));
            }
            End::Breakdown(what, value) if info.iterations == before => {
                return Err(LinearError::Breakdown { iteration: before, what, value });
            }
            End::Small | End::Breakdown(..) => info.restarts += 1,
        }
        norm = reached;
    }
    info.residual = norm / criterion.scale;
    Ok(info)
}

/// Whether a product of two vectors is no more than round-off of the product of their norms, or not a number.
fn vanishes(product: f64, norms: f64) -> bool {
    let counts = product.abs() > ORTHOGONAL * norms;
    !counts
}

/// Iterates from the residual in the scratch, whose norm is given.
#[expect(clippy::too_many_arguments, reason = "the state of one iteration")]
fn run(
    a: &(impl LinearOperator + ?Sized),
    preconditioner: &mut (impl Preconditioner + ?Sized),
    x: &mut [f64],
    scratch: &mut BiCgStabScratch,
    start: f64,
    target: f64,
    max_iterations: usize,
    info: &mut BiCgStabInfo,
) -> End {
    let BiCgStabScratch { r, shadow, p, v, y, z, t } = scratch;
    shadow.copy_from_slice(r);
    p.copy_from_slice(r);
    let mut rho = start * start;
    while info.iterations < max_iterations {
        preconditioner.apply(p, y);
        a.apply(y, v);
        let [projection, v_squared] = vector::dot_two(v, shadow, v);
        if vanishes(projection, start * v_squared.sqrt()) {
            return End::Breakdown("r̂ · A M⁻¹ p", projection);
        }
        let alpha = rho / projection;
        let half = vector::add_scaled(-alpha, v, r).sqrt();
        if half <= target {
            vector::add_scaled(alpha, y, x);
            info.iterations += 1;
            return End::Small;
        }
        preconditioner.apply(r, z);
        a.apply(z, t);
        let [along, t_squared] = vector::dot_two(t, r, t);
        if vanishes(along, half * t_squared.sqrt()) {
            // The half step counts.
            vector::add_scaled(alpha, y, x);
            if half < start {
                info.iterations += 1;
            }
            return End::Breakdown("s · A M⁻¹ s", along);
        }
        let omega = along / t_squared;
        let [squared, next] = vector::stabilise([alpha, omega], [y, z, t, shadow], x, r);
        info.iterations += 1;
        let norm = squared.sqrt();
        if norm <= target {
            return End::Small;
        }
        if vanishes(next, start * norm) {
            return End::Breakdown("r̂ · r", next);
        }
        vector::direction(r, (next / rho) * (alpha / omega), omega, v, p);
        rho = next;
    }
    End::Exhausted
}
