//! What can go wrong.
use crate::poisson::PoissonError;

/// Why a grid, a field or a step could not be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FlowError {
    /// The grid makes no sense.
    #[error("the grid asks for {what}")]
    Grid {
        /// What is wrong and what to give instead.
        what: String,
    },
    /// The boundary conditions make no sense.
    #[error("the boundary conditions ask for {what}")]
    Boundary {
        /// What is wrong and what to give instead.
        what: String,
    },
    /// What enters the box cannot leave it.
    #[error(
        "the sides let {net:.6e} m³/s more out than in ({inflow:.6e} m³/s enters) and no outlet can make up for it; \
         give an outlet or inlets that balance"
    )]
    MassBalance {
        /// Net outflow \[m³/s\] (plane: m²/s).
        net: f64,
        /// Inflow \[m³/s\] (plane: m²/s).
        inflow: f64,
    },
    /// A fluid property is not physical.
    #[error("the fluid's {name} is {value} {unit}; it must be positive and finite")]
    Fluid {
        /// Which property.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// The step's length is unusable.
    #[error("a time step of {dt} s was asked for at t = {time} s; it must be positive and finite")]
    TimeStep {
        /// The step \[s\].
        dt: f64,
        /// When \[s\].
        time: f64,
    },
    /// The step is longer than explicit diffusion is stable for.
    #[error(
        "a time step of {dt:.3e} s is beyond the stability limit of explicit diffusion, {limit:.3e} s on this grid; take at most that, or a coarser grid"
    )]
    Unstable {
        /// The step \[s\].
        dt: f64,
        /// The longest stable one \[s\].
        limit: f64,
    },
    /// The velocity is no longer finite.
    #[error(
        "the velocity is not finite any more in step {step} (t = {time} s, dt = {dt} s, last Courant number {courant:.3e}); take a smaller time step"
    )]
    Diverged {
        /// Step number.
        step: u64,
        /// Time \[s\].
        time: f64,
        /// Step length \[s\].
        dt: f64,
        /// Courant number of the last good step.
        courant: f64,
    },
    /// A parameter of an algorithm makes no sense.
    #[error("{name} is {value}; it must be {range}")]
    Parameter {
        /// Which parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// A steady solution was not reached.
    #[error(
        "after {iterations} iterations the residuals are {momentum:.3e} (momentum) and {continuity:.3e} (continuity), above \
         the tolerance {tolerance:.3e}; allow more iterations, relax more (a smaller factor), or compute the flow in time if \
         it is not steady"
    )]
    NotSteady {
        /// Iterations made.
        iterations: usize,
        /// Largest residual of the momentum equations.
        momentum: f64,
        /// Residual of the continuity equation.
        continuity: f64,
        /// What was asked for.
        tolerance: f64,
    },
    /// A linear solver could not work.
    #[error(transparent)]
    Linear(#[from] crate::linear::LinearError),
    /// The pressure solver could not work.
    #[error(transparent)]
    Poisson(PoissonError),
}

impl From<PoissonError> for FlowError {
    fn from(e: PoissonError) -> Self {
        Self::Poisson(e)
    }
}
