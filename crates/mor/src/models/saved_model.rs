//! Model of either kind, read from a file.
use super::{ModelError, Podiann, Spodiann};
use crate::interpolation::Record;
use crate::shifted::Grid;
use std::path::Path;

/// Model that was saved by `record().save(path)` of a [`Podiann`] or a [`Spodiann`].
pub enum SavedModel {
    /// Modes at rest.
    Podiann(Box<Podiann>),
    /// Modes that move with frames of reference.
    Spodiann(Box<Spodiann>),
}

impl SavedModel {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// [`ModelError::Record`] if it cannot be read or holds neither kind.
    pub fn load(path: &Path) -> Result<Self, ModelError> {
        let record = Record::load(path)?;
        Ok(match record.kind() {
            "PODIANN" => Self::Podiann(Box::new(Podiann::from_record(&record)?)),
            // Its error names the kind that was found.
            _ => Self::Spodiann(Box::new(Spodiann::from_record(&record)?)),
        })
    }

    /// Number of inputs: time, then parameters.
    pub fn inputs(&self) -> usize {
        match self {
            Self::Podiann(model) => model.inputs(),
            Self::Spodiann(model) => model.inputs(),
        }
    }

    /// Number of unknowns of a field.
    pub fn rows(&self) -> usize {
        match self {
            Self::Podiann(model) => model.rows(),
            Self::Spodiann(model) => model.rows(),
        }
    }

    /// Whether `x` lies within the inputs of the snapshots.
    pub fn covers(&self, x: &[f64]) -> bool {
        match self {
            Self::Podiann(model) => model.covers(x),
            Self::Spodiann(model) => model.covers(x),
        }
    }

    /// Grid of the snapshots; none for modes at rest, which do not need it.
    pub fn grid(&self) -> Option<&Grid> {
        match self {
            Self::Podiann(_) => None,
            Self::Spodiann(model) => Some(model.grid()),
        }
    }

    /// Writes the field at `x` to `out`; returns an estimate of its relative error.
    ///
    /// # Errors
    /// [`ModelError::Shape`] if `x` or `out` has another length than [`Self::inputs`] or
    /// [`Self::rows`].
    pub fn predict(&self, x: &[f64], out: &mut [f64]) -> Result<f64, ModelError> {
        match self {
            Self::Podiann(model) => model.predict(x, out).and_then(|()| model.error_indicator(x)),
            Self::Spodiann(model) => model.predict(x, out).and_then(|()| model.error_indicator(x)),
        }
    }
}
