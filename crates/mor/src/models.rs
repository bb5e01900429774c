//! Models that predict a whole field at any time and parameter from a few numbers: modes, and functions that interpolate their coefficients (figure 8 of Isoz et al. 2023).
//!
//! [`Podiann`]: the modes of a [`Pod`](crate::pod::Pod), with functions for their coefficients. [`Spodiann`]: modes that frames of reference carry along, with functions for their coefficients and for the frames' paths.
//!
//! [`validate_podiann`] and [`validate_spodiann`] cross-validate whole models, modes included.
mod assessment;
mod coefficients;
mod error;
mod extrapolation;
mod leave_out;
mod modes;
mod moving_modes;
mod paths;
mod podiann;
mod saved_model;
mod spodiann;
mod validation;

pub use assessment::Assessment;
pub use error::ModelError;
pub use extrapolation::Extrapolation;
pub use moving_modes::CoefficientFit;
pub use podiann::Podiann;
pub use saved_model::SavedModel;
pub use spodiann::{Spodiann, SpodiannParams};
pub use validation::{
    Decompose, ModelValidation, validate_podiann, validate_podiann_observed, validate_spodiann,
    validate_spodiann_observed,
};
