//! What can go wrong.
use super::OdeError;

/// Why there is no reduced model.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GalerkinError {
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
    /// The modes are not orthonormal in the inner product of the weights.
    #[error("the product of modes {} and {} is off by {by:.1e}; give modes that are orthonormal with these weights", modes[0], modes[1])]
    NotOrthonormal {
        /// Which two.
        modes: [usize; 2],
        /// By how much.
        by: f64,
    },
    /// The full model is not what it is taken for.
    #[error(
        "the rate of the full model is off a quadratic one by {by:.1e} of its size where that was tried; keep to linear and quadratic terms, and sample others ({})",
        "HyperReduced"
    )]
    NotQuadratic {
        /// Relative to the rate.
        by: f64,
    },
    /// The full model gives no numbers.
    #[error("the rate of the full model is {value} in row {row} for {at}")]
    NotFinite {
        /// Which row.
        row: usize,
        /// What it is.
        value: f64,
        /// Where it was asked.
        at: String,
    },
    /// The modes of a term that is to be sampled depend on one another.
    #[error(
        "mode {mode} of the sampled term is a combination of those before (to {left:.1e}); give independent ones"
    )]
    Dependent {
        /// Which, from 0.
        mode: usize,
        /// What is left of it.
        left: f64,
    },
    /// Too few samples for so many coefficients.
    #[error(
        "{samples} samples are too few for {unknowns} coefficients per equation, or do not tell them apart; give more samples, fewer modes or a larger regularisation"
    )]
    Undetermined {
        /// Samples.
        samples: usize,
        /// Coefficients of one equation.
        unknowns: usize,
    },
    /// The model could not be integrated.
    #[error(transparent)]
    Ode(#[from] OdeError),
}

impl GalerkinError {
    pub(super) fn same(what: &'static str, expected: usize, found: usize) -> Result<(), Self> {
        if expected == found { Ok(()) } else { Err(Self::Shape { what, expected, found }) }
    }
}
