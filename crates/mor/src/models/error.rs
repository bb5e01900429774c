//! What can go wrong.
use crate::interpolation::{InterpolationError, RecordError};
use crate::pod::PodError;
use crate::shifted::ShiftedError;

/// Why a model could not be made, asked, saved or loaded.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// Two sizes that must agree do not.
    #[error("{what}: {found} were given, {expected} are needed")]
    Shape {
        /// Of what.
        what: &'static str,
        /// How many there must be.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// The function of the coefficients or of the paths.
    #[error(transparent)]
    Interpolation(#[from] InterpolationError),
    /// The modes.
    #[error(transparent)]
    Pod(#[from] PodError),
    /// The frames of reference.
    #[error(transparent)]
    Shifted(#[from] ShiftedError),
    /// The file.
    #[error(transparent)]
    Record(#[from] RecordError),
}

impl ModelError {
    /// Whether the observer stopped the fit.
    #[must_use]
    pub fn is_stopped(&self) -> bool {
        matches!(self, Self::Interpolation(InterpolationError::Stopped))
    }
    /// An outcome, unless it is a stop by the observer.
    pub(super) fn unless_stopped<T>(outcome: Result<T, Self>) -> Result<Result<T, Self>, Self> {
        match outcome {
            Err(stopped) if stopped.is_stopped() => Err(stopped),
            outcome => Ok(outcome),
        }
    }
    /// `found` must be `expected`.
    pub(super) fn same(what: &'static str, expected: usize, found: usize) -> Result<(), Self> {
        if expected == found { Ok(()) } else { Err(Self::Shape { what, expected, found }) }
    }
}
