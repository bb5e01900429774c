//! The fluid and how its flow is computed.
use super::{Context, of_file};
use crate::expression::Expression;
use crate::problem::Problem;
use crate::reader::Reader;
use crate::start_field::StartField;
use fv_mesh::poisson::multigrid::MultigridParams;
use fv_mesh::{Axis, Convection, Diffusion, Fluid, PressureSolver, Side};
use std::sync::Arc;

/// The algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Algorithm {
    Projection,
    Piso,
    Simple,
}

impl Algorithm {
    /// Its word in the file.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Self::Projection => "projection",
            Self::Piso => "piso",
            Self::Simple => "simple",
        }
    }
}

/// How the flow is computed.
#[derive(Clone, Debug)]
pub(crate) struct FlowSetup {
    pub(crate) algorithm: Algorithm,
    pub(crate) convection: Convection,
    /// Why it is that one, if the scene does not say.
    pub(crate) default_convection: Option<&'static str>,
    pub(crate) diffusion: Option<Diffusion>,
    pub(crate) pressure: PressureSolver,
    /// Of a steady flow.
    pub(crate) tolerance: f64,
    pub(crate) iterations: usize,
}

/// Least viscosity above 0 \[m²/s\], 10⁻¹² of that of liquid helium: below it products of viscous times and of their quotients leave the range of numbers.
const LEAST_VISCOSITY: f64 = 1e-20;

/// The fluid, if there is one.
pub(super) fn fluid(root: &Reader<'_>) -> Result<Option<Fluid>, Problem> {
    let Some(t) = root.table("fluid") else { return Ok(None) };
    let density = t.number("density").unwrap_or(1.0);
    let viscosity = match (t.number("nu"), t.number("mu")) {
        (Some(nu), None) => nu,
        (None, Some(mu)) => mu / density,
        (None, None) => {
            return Err(t.fail_here("the viscosity is missing: give `nu` in m²/s or `mu` in Pa s"));
        }
        (Some(_), Some(_)) => return Err(t.fail("mu", "`nu` is given already; leave out one of the two")),
    };
    if !viscosity.is_finite() {
        return Err(
            t.fail("mu", format!("{viscosity} m²/s follows for the kinematic viscosity; give a finite one"))
        );
    }
    if viscosity > 0.0 && viscosity < LEAST_VISCOSITY {
        let key = if t.has("nu") { "nu" } else { "mu" };
        let least = LEAST_VISCOSITY;
        return Err(t.fail(
            key,
            format!(
                "{viscosity:e} m²/s follows for the kinematic viscosity; give 0, or {least:e} m²/s at least"
            ),
        ));
    }
    Ok(Some(Fluid { density, viscosity }))
}

/// Velocity at the start from the file of the table `initial`.
pub(super) fn start(
    root: &Reader<'_>,
    context: &Context<'_>,
    axes: &[Axis],
    sides: &[[Side; 2]],
) -> Result<Option<Arc<StartField>>, Problem> {
    let Some(t) = root.table("initial").filter(|t| t.has("file")) else { return Ok(None) };
    if t.has("velocity") {
        return Err(t.fail("file", "`velocity` is given already; leave out one of the two"));
    }
    let path = context.path(t.text("file").unwrap_or_default());
    let periodic: Vec<bool> = sides.iter().map(|pair| matches!(pair[0], Side::Periodic)).collect();
    let field = StartField::read(&path, axes, &periodic);
    field.map(|field| Some(Arc::new(field))).map_err(|e| t.fail("file", of_file(&path, &e)))
}

/// Axis and mean velocity of a flow that is driven at a given flow rate.
pub(super) fn flow_rate(
    root: &Reader<'_>,
    sides: &[[Side; 2]],
    steady: bool,
) -> Result<Option<(usize, Expression)>, Problem> {
    let Some(t) = root.table("flow_rate") else { return Ok(None) };
    let word = t.text("axis").unwrap_or_default();
    let axis = ["x", "y", "z"].iter().position(|name| *name == word).unwrap_or(0);
    if steady {
        let message = "a flow rate is held step by step; take flow.algorithm \"projection\" or \"piso\", or give `force`";
        return Err(root.fail("flow_rate", message));
    }
    match sides.get(axis) {
        Some([Side::Periodic, _]) => {}
        Some(_) => {
            let message = format!("{word} is not periodic; take an axis whose sides are, or give an inlet");
            return Err(t.fail("axis", message));
        }
        None => return Err(t.fail("axis", "a plane scene has no axis z; take x or y")),
    }
    Ok(t.formula("velocity", &["t"])?.map(|velocity| (axis, velocity)))
}

/// The flow's algorithm and schemes; `averages` if a turbulence model of mean flows is there.
pub(super) fn read(root: &Reader<'_>, averages: bool) -> Result<FlowSetup, Problem> {
    let t = root.table("flow");
    let word = |key: &str| t.as_ref().and_then(|t| t.text(key));
    let algorithm = match word("algorithm") {
        Some("piso") => Algorithm::Piso,
        Some("simple") => Algorithm::Simple,
        _ => Algorithm::Projection,
    };
    // Mean flows leave no turbulence on the grid for a scheme without damping to keep: its waves in wakes and at the edges of layers are errors.
    let (convection, default_convection) = match (word("convection"), averages, algorithm) {
        (Some("central"), ..) => (Convection::Central, None),
        (Some("upwind"), ..) => (Convection::Upwind, None),
        (Some("linear-upwind"), ..) => (Convection::LinearUpwind, None),
        (Some("quick"), ..) => (Convection::Quick, None),
        (Some("limited"), ..) => (Convection::Limited, None),
        (_, true, Algorithm::Simple) => {
            (Convection::Quick, Some("quick, upwind-biased, as the model resolves no eddies"))
        }
        (_, true, _) => {
            (Convection::Limited, Some("limited, upwind-biased, as the model resolves no eddies"))
        }
        (_, false, _) => (Convection::Central, Some("central, which keeps kinetic energy")),
    };
    Ok(FlowSetup {
        algorithm,
        convection,
        default_convection,
        diffusion: match word("diffusion") {
            Some("explicit") => Some(Diffusion::Explicit),
            Some("implicit") => Some(Diffusion::Implicit),
            _ => None,
        },
        pressure: match word("pressure") {
            Some("direct") => PressureSolver::Direct,
            Some("multigrid") => PressureSolver::Multigrid(MultigridParams::default()),
            _ => PressureSolver::Auto,
        },
        tolerance: t.as_ref().and_then(|t| t.number("tolerance")).unwrap_or(1e-6),
        iterations: t.as_ref().and_then(|t| t.whole("iterations")).unwrap_or(5000),
    })
}
