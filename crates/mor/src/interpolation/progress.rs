//! Progress of fits.
use super::InterpolationError;
use std::fmt;
use std::ops::ControlFlow;

/// Observer of a fit: called at the begin of every step of a stage, or with its loss; `Break` stops
/// the fit.
pub type FitObserver<'a> = &'a mut dyn FnMut(&FitProgress<'_>) -> ControlFlow<()>;

/// Part of a fit whose steps are counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitStage<'a> {
    /// Paths of all frames of a [`Spodiann`](crate::models::Spodiann).
    Paths,
    /// Coefficients of a frame of a [`Spodiann`](crate::models::Spodiann).
    Frame,
    /// Coefficients without phases as inputs (1), with them (2).
    Inputs,
    /// Cross-validation of the method of this name.
    Method(&'a str),
    /// A fit of all samples but those of a set.
    Fold,
    /// Error estimate along an input, or along all parameters of runs.
    Estimate,
    /// Modes of the snapshots of a [`validation`](crate::models::ModelValidation) that are not left
    /// out.
    Modes,
    /// The fit of all samples by the method of this name.
    Fit(&'a str),
    /// Training of a network from a set of random weights.
    Start,
    /// Steps of Adam.
    Adam,
    /// Iterations of L-BFGS.
    Lbfgs,
    /// Search for a shape parameter ([`Shape::LeaveOneOut`](super::Shape::LeaveOneOut)); the loss
    /// is the sum of squares of leave-one-out errors.
    Shape,
    /// Search for the numbers of terms of a [`Varying`](super::Varying) function; the loss is the
    /// expected square of its error.
    Terms,
}

/// State of a fit: a stage, and the one under way within it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitProgress<'a> {
    /// Part of the fit.
    pub stage: FitStage<'a>,
    /// Number of the step, from 1: it begins, or has the loss.
    pub step: usize,
    /// Number of steps, at most; `None` if no bound is known.
    pub of: Option<usize>,
    /// Value of the loss, if the stage has one.
    pub loss: Option<f64>,
    /// Stage within this one; `None` at the begin of a step.
    pub inner: Option<&'a FitProgress<'a>>,
}

impl<'a> FitProgress<'a> {
    /// Step number `step` of at most `of`.
    #[must_use]
    pub fn new(stage: FitStage<'a>, step: usize, of: impl Into<Option<usize>>) -> Self {
        Self { stage, step, of: of.into(), loss: None, inner: None }
    }
    /// The same with a loss.
    #[must_use]
    pub fn with_loss(self, loss: f64) -> Self {
        Self { loss: Some(loss), ..self }
    }
    /// The stage under way that contains no other.
    #[must_use]
    pub fn innermost(&self) -> &FitProgress<'a> {
        self.inner.map_or(self, FitProgress::innermost)
    }
    /// Reports the step, then runs it; the observer of its parts reports them within this stage.
    ///
    /// # Errors
    /// [`InterpolationError::Stopped`] by the observer, and those of the step.
    pub fn run<T, E: From<InterpolationError>>(
        self,
        observer: FitObserver<'_>,
        step: impl FnOnce(FitObserver<'_>) -> Result<T, E>,
    ) -> Result<T, E> {
        self.report(observer)?;
        step(&mut |inner| observer(&FitProgress { inner: Some(inner), ..self }))
    }
    /// Reports the step.
    ///
    /// # Errors
    /// [`InterpolationError::Stopped`] by the observer.
    pub fn report(&self, observer: FitObserver<'_>) -> Result<(), InterpolationError> {
        if observer(self).is_break() { Err(InterpolationError::Stopped) } else { Ok(()) }
    }
}

impl fmt::Display for FitStage<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Paths => write!(f, "paths"),
            Self::Frame => write!(f, "frame"),
            Self::Inputs => write!(f, "set of inputs"),
            Self::Method(name) => write!(f, "method {name}"),
            Self::Fold => write!(f, "fold"),
            Self::Estimate => write!(f, "error estimate"),
            Self::Modes => write!(f, "modes"),
            Self::Fit(name) => write!(f, "fit by {name}"),
            Self::Start => write!(f, "start"),
            Self::Adam => write!(f, "Adam"),
            Self::Lbfgs => write!(f, "L-BFGS"),
            Self::Shape => write!(f, "shape parameter"),
            Self::Terms => write!(f, "number of terms"),
        }
    }
}

/// From the outermost stage to the innermost: `frame 2/3, method cubic spline 1/3, fold 4/5`.
impl fmt::Display for FitProgress<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.stage, self.step)?;
        self.of.map_or(Ok(()), |of| write!(f, "/{of}"))?;
        self.loss.map_or(Ok(()), |loss| write!(f, ": loss {loss:.3e}"))?;
        self.inner.map_or(Ok(()), |inner| write!(f, ", {inner}"))
    }
}

/// Observer that neither looks nor stops.
pub(crate) fn unobserved(_: &FitProgress<'_>) -> ControlFlow<()> {
    ControlFlow::Continue(())
}
