//! When an iteration is done.
use super::error::{check_finite, check_length};
use super::{LinearError, LinearOperator, vector};

/// The sum of squares is formed of values scaled to this range at most.
const LARGEST: f64 = 1e150;

/// The norm the residual must reach, and what it is told relative to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Criterion {
    /// ‖b‖.
    pub(super) scale: f64,
    /// Largest residual norm that will do.
    pub(super) target: f64,
}

impl Criterion {
    /// Checks the tolerances and vectors. `None` if b vanishes; x is zero then.
    pub(super) fn new(
        [relative, absolute]: [f64; 2],
        n: usize,
        b: &[f64],
        x: &mut [f64],
    ) -> Result<Option<Self>, LinearError> {
        for (name, value) in [("the relative tolerance", relative), ("the absolute tolerance", absolute)] {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(LinearError::Parameter { name, value, range: "finite and not negative" });
            }
        }
        check_length("b", n, b.len())?;
        check_length("x", n, x.len())?;
        check_finite("x", x)?;
        let scale = vector::norm(b);
        if scale >= LARGEST || scale.is_nan() {
            check_finite("b", b)?;
            return Err(LinearError::Parameter {
                name: "the 2-norm of b",
                value: scale,
                range: "below 1e150: choose other units",
            });
        }
        if scale == 0.0 {
            x.fill(0.0);
            return Ok(None);
        }
        Ok(Some(Self { scale, target: absolute.max(relative * scale) }))
    }

    /// r = b − A x; gives ‖r‖.
    pub(super) fn residual(
        &self,
        a: &(impl LinearOperator + ?Sized),
        b: &[f64],
        x: &[f64],
        r: &mut [f64],
    ) -> Result<f64, LinearError> {
        a.residual(b, x, r);
        let norm = vector::norm(r);
        if !norm.is_finite() {
            check_finite("b − A x", r)?;
            return Err(LinearError::Parameter {
                name: "the residual's 2-norm",
                value: norm,
                range: "finite",
            });
        }
        Ok(norm)
    }

    pub(super) fn not_converged(&self, iterations: usize, norm: f64) -> LinearError {
        LinearError::NotConverged {
            iterations,
            residual: norm / self.scale,
            tolerance: self.target / self.scale,
        }
    }
}
