//! Parameters of the unsteady segregated algorithm.
use crate::FlowError;

/// How the velocity is advanced in time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeScheme {
    /// (uⁿ⁺¹ − uⁿ)/dt. First order.
    Euler,
    /// Backward differentiation over two steps of any lengths: (3uⁿ⁺¹ − 4uⁿ + uⁿ⁻¹)/(2 dt) if they are equal; the first
    /// step is Euler's. Second order.
    #[default]
    Bdf2,
}

/// Parameters of [`Piso`](super::Piso).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PisoParams {
    /// Pressure corrections per step, at least 1. Default 2.
    pub correctors: usize,
    /// Default [`TimeScheme::Bdf2`].
    pub time_scheme: TimeScheme,
    /// Residual to which the momentum equations are solved, relative to that of the first guess. Default 10⁻⁴.
    pub momentum_tolerance: f64,
    /// Residual to which pressure equations are solved, relative to their right-hand sides. Default 10⁻⁶.
    pub pressure_tolerance: f64,
}

impl Default for PisoParams {
    fn default() -> Self {
        Self {
            correctors: 2,
            time_scheme: TimeScheme::Bdf2,
            momentum_tolerance: 1e-4,
            pressure_tolerance: 1e-6,
        }
    }
}

impl PisoParams {
    pub(super) fn check(&self) -> Result<(), FlowError> {
        let fail = |name, value, range| Err(FlowError::Parameter { name, value, range });
        if self.correctors == 0 {
            return fail("the number of pressure corrections", 0.0, "at least 1");
        }
        for (name, value) in [
            ("the tolerance of the momentum equations", self.momentum_tolerance),
            ("the tolerance of the pressure equation", self.pressure_tolerance),
        ] {
            if !(1e-13..1.0).contains(&value) {
                return fail(name, value, "at least 1e-13 and below 1");
            }
        }
        Ok(())
    }
}
