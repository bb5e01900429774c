//! What can be wrong with a model.
use thiserror::Error;

/// Why a model cannot be made.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum TurbulenceError {
    /// A number that makes no sense.
    #[error("{name} is {value}; it must be {range}")]
    Value {
        /// Which one.
        name: &'static str,
        /// What it is.
        value: f64,
        /// What it has to be.
        range: &'static str,
    },
    /// A list of the wrong length.
    #[error("{what} has {found} entries for {expected} cells; give one per cell")]
    Length {
        /// Which one.
        what: &'static str,
        /// Cells of the model.
        expected: usize,
        /// Its length.
        found: usize,
    },
}

/// # Errors
/// [`TurbulenceError::Value`] for a number that is not positive and finite.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<(), TurbulenceError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(TurbulenceError::Value { name, value, range: "positive and finite" })
}
