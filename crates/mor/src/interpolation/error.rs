//! What can go wrong.
use super::RecordError;

/// Why samples could not be interpolated, or a prediction not be made.
#[derive(Debug, thiserror::Error)]
pub enum InterpolationError {
    /// There is nothing to interpolate.
    #[error(
        "{samples} samples of {outputs} outputs at points with {inputs} inputs were given; give at least one of each"
    )]
    Empty {
        /// m.
        samples: usize,
        /// d.
        inputs: usize,
        /// k.
        outputs: usize,
    },
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
    /// A sample is not a number.
    #[error("{what} {row} of sample {sample} is {value}; leave this sample out or mend it")]
    NotFinite {
        /// "input" or "output".
        what: &'static str,
        /// Which, from 0.
        row: usize,
        /// Which sample, from 0.
        sample: usize,
        /// The value.
        value: f64,
    },
    /// Two samples at one point.
    #[error(
        "samples {first} and {second} are at the same point ({distance:.1e} of the samples' extent apart); keep one of them"
    )]
    Doubled {
        /// The one, from 0.
        first: usize,
        /// The other.
        second: usize,
        /// Largest distance in an input, relative to the extent of this input.
        distance: f64,
    },
    /// A function of this kind needs more samples.
    #[error("{what} needs {needed} {of} and has {found}; give more, or ask for less")]
    TooFew {
        /// Which function.
        what: String,
        /// Of what.
        of: &'static str,
        /// How many it needs at least.
        needed: usize,
        /// How many there are.
        found: usize,
    },
    /// More samples than the method can take.
    #[error(
        "{what} of {found} samples takes {bytes:.1e} bytes; {most} samples are the most it takes: give fewer, or take another method"
    )]
    TooMany {
        /// Which method.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many there may be.
        most: usize,
        /// Memory of the matrices.
        bytes: f64,
    },
    /// The points are not those of a grid.
    #[error(
        "{samples} points are not a full grid: their inputs have {values:?} distinct values each, which would make {nodes}; interpolate them as scattered ones"
    )]
    NotAGrid {
        /// m.
        samples: usize,
        /// Distinct values of every input.
        values: Vec<usize>,
        /// Their product.
        nodes: usize,
    },
    /// The equations have no solution to round-off.
    #[error("the equations of {what} are singular to round-off; {remedy}")]
    Singular {
        /// Which function.
        what: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A parameter of a method is unusable.
    #[error("the {what} is {value}; it must be {must}")]
    Parameter {
        /// Which.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// A training that went out of bounds.
    #[error(
        "after {iterations} iterations the loss is not a number; take smaller steps of Adam, or a smaller bandwidth"
    )]
    Diverged {
        /// How many were made.
        iterations: usize,
    },
    /// The observer stopped the fit.
    #[error("the observer stopped the fit before there was a result")]
    Stopped,
    /// A prediction was asked for at a point that is none.
    #[error("a prediction was asked for where input {input} is {value}; give finite inputs")]
    Point {
        /// Which input, from 0.
        input: usize,
        /// Its value.
        value: f64,
    },
    /// An interpolator could not be saved or loaded.
    #[error(transparent)]
    Record(#[from] RecordError),
}

impl InterpolationError {
    /// `found` must be `expected`.
    pub(super) fn same(what: &'static str, expected: usize, found: usize) -> Result<(), Self> {
        if expected == found { Ok(()) } else { Err(Self::Shape { what, expected, found }) }
    }
    /// An outcome, unless it is a stop by the observer.
    pub(super) fn unless_stopped<T>(outcome: Result<T, Self>) -> Result<Result<T, Self>, Self> {
        if matches!(outcome, Err(Self::Stopped)) { Err(Self::Stopped) } else { Ok(outcome) }
    }
    /// Checks the shapes of a prediction, and that its point is finite.
    pub(super) fn check_prediction(
        [inputs, outputs]: [usize; 2],
        x: &[f64],
        out: &[f64],
    ) -> Result<(), Self> {
        Self::same("inputs of the point", inputs, x.len())?;
        Self::same("outputs", outputs, out.len())?;
        match x.iter().position(|v| !v.is_finite()) {
            Some(input) => Err(Self::Point { input, value: x[input] }),
            None => Ok(()),
        }
    }
}
