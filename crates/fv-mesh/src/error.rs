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
        "the sides let {:.6e} m³/s more {} ({inflow:.6e} m³/s enters) and no outlet can make up for it; \
         give an outlet or inlets that balance",
        net.abs(),
        if *net > 0.0 { "out than in" } else { "in than out" }
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
    /// The velocity is no longer finite, or grew beyond what a step can carry.
    #[error(
        "the velocity diverged in {}, first or most in cell {cell:?}; {}",
        step_text(*step, *time, *dt, Some(*courant)),
        if *dt > 0.0 { "take a smaller time step" } else { "check that the sides determine the flow, or take a finer grid or upwind convection" }
    )]
    Diverged {
        /// Step number.
        step: u64,
        /// Time \[s\].
        time: f64,
        /// Step length \[s\].
        dt: f64,
        /// Courant number, as far as it is known.
        courant: f64,
        /// The cell (i, j, k) where it is largest or not finite.
        cell: [usize; 3],
    },
    /// A scalar is no longer finite.
    #[error(
        "the scalar is not finite any more in {}; {}",
        step_text(*step, *time, *dt, None),
        if *dt > 0.0 { "take a smaller time step" } else { "check its values at the sides" }
    )]
    ScalarDiverged {
        /// Step number.
        step: u64,
        /// Time \[s\].
        time: f64,
        /// Step length \[s\].
        dt: f64,
    },
    /// A field of another grid.
    #[error(
        "a field on a grid of {found:?} cells was given where one on a grid of {expected:?} cells is needed; \
         make both with the same grid (that of a box which has moved is another)"
    )]
    OtherGrid {
        /// Cells along the axes of the grid that is needed.
        expected: Vec<usize>,
        /// Those of the field.
        found: Vec<usize>,
    },
    /// The turbulence model could not go on.
    #[error("the closure could not be brought up to date at t = {time} s: {source}")]
    Closure {
        /// When \[s\].
        time: f64,
        /// Why.
        source: interfaces::SolveError,
    },
    /// A scalar could not be held where bodies are.
    #[error("a scalar could not be held where the bodies are at t = {time} s: {source}")]
    Scalar {
        /// When \[s\].
        time: f64,
        /// Why.
        source: interfaces::SolveError,
    },
    /// A scalar did not come to its steady state.
    #[error(
        "a scalar is not steady after {iterations} iterations: its largest change in the last was {change:.1e} of its largest value, and {tolerance:.1e} is asked for; allow more iterations, or take upwind convection for it"
    )]
    ScalarNotSteady {
        /// Iterations made.
        iterations: usize,
        /// Its largest change in the last one over its largest value.
        change: f64,
        /// What is asked for.
        tolerance: f64,
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
        "after {iterations} iterations the residuals are {momentum:.3e} (momentum), {continuity:.3e} (continuity) and \
         {closure:.3e} (turbulence model), above the tolerance {tolerance:.3e}; allow more iterations, relax more (a smaller factor), or compute the flow in time if \
         it is not steady"
    )]
    NotSteady {
        /// Iterations made.
        iterations: usize,
        /// Largest residual of the momentum equations.
        momentum: f64,
        /// Residual of the continuity equation.
        continuity: f64,
        /// Residual of the turbulence model; 0 without one.
        closure: f64,
        /// What was asked for.
        tolerance: f64,
    },
    /// The box cannot be moved.
    #[error("the box cannot be moved along axis {axis}: {what}")]
    Window {
        /// Axis, 0 for x.
        axis: usize,
        /// Why, and what to do instead.
        what: &'static str,
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

/// A step in words; an iteration of a steady algorithm has no length.
fn step_text(step: u64, time: f64, dt: f64, courant: Option<f64>) -> String {
    if dt > 0.0 {
        let courant = courant.map_or(String::new(), |c| format!(", Courant number {c:.3e}"));
        format!("step {step} (t = {time} s, dt = {dt} s{courant})")
    } else {
        format!("iteration {step}")
    }
}
