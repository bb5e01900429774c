//! Turbulence models and scalars.
use super::Context;
use crate::expression::Expression;
use crate::problem::Problem;
use crate::reader::Reader;
use fv_mesh::{Convection, Given, ScalarSide, Side, WallStress};

/// A turbulence model.
#[derive(Clone, Debug)]
pub(crate) struct TurbulenceSetup {
    pub(crate) model: ModelChoice,
    pub(crate) intensity: f64,
    pub(crate) scale: ScaleChoice,
    /// The speed that the intensity is of \[m/s\].
    pub(crate) speed: Option<f64>,
    /// What bodies at rest do to a steady flow.
    pub(crate) walls: WallStress,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ModelChoice {
    Sst,
    /// β and γ, where they are given.
    KOmega(Option<f64>, Option<f64>),
    KEpsilon,
    Realizable,
    Smagorinsky(Option<f64>),
    Wale(Option<f64>),
}

impl ModelChoice {
    /// Does it model the large eddies, too?
    pub(crate) fn averages(self) -> bool {
        !matches!(self, Self::Smagorinsky(_) | Self::Wale(_))
    }
    /// Whether it lacks terms for the viscous sublayer, so that first cells have to be in the
    /// logarithmic layer.
    pub(crate) fn needs_log_layer(self) -> bool {
        matches!(self, Self::KEpsilon | Self::Realizable)
    }
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Sst => "k–ω SST",
            Self::KOmega(..) => "k–ω",
            Self::KEpsilon => "k–ε",
            Self::Realizable => "realizable k–ε",
            Self::Smagorinsky(_) => "Smagorinsky's model",
            Self::Wale(_) => "WALE",
        }
    }
}

/// The length scale of what enters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ScaleChoice {
    Length(f64),
    ViscosityRatio(f64),
}

/// A scalar.
#[derive(Clone, Debug)]
pub(crate) struct ScalarSetup {
    pub(crate) name: String,
    pub(crate) unit: String,
    pub(crate) diffusivity: f64,
    pub(crate) turbulent_prandtl: f64,
    /// Per time, of the place.
    pub(crate) source: Option<Expression>,
    pub(crate) initial: Expression,
    pub(crate) convection: Convection,
    pub(crate) sides: Vec<[ScalarSide; 2]>,
    /// Its value on bodies, of the time.
    pub(crate) bodies: Option<Expression>,
    /// What their surfaces give off per area and time, of the time.
    pub(crate) flux: Option<Expression>,
    /// β and φ₀.
    pub(crate) buoyancy: Option<(f64, f64)>,
}

impl ScalarSetup {
    /// Is its value given anywhere?
    pub(crate) fn has_value(&self) -> bool {
        self.bodies.is_some() || self.sides.iter().flatten().any(|side| matches!(side, ScalarSide::Value(_)))
    }
}

pub(super) fn turbulence(root: &Reader<'_>, dim: usize) -> Result<Option<TurbulenceSetup>, Problem> {
    let Some((word, t)) = root.choice("turbulence", "model") else { return Ok(None) };
    let number = |key: &str| t.number(key);
    let model = match word {
        "sst" => ModelChoice::Sst,
        "k-omega" => ModelChoice::KOmega(number("beta"), number("gamma")),
        "k-epsilon" => ModelChoice::KEpsilon,
        "realizable" => ModelChoice::Realizable,
        "smagorinsky" => ModelChoice::Smagorinsky(number("constant")),
        _ => ModelChoice::Wale(number("constant")),
    };
    if dim == 2 && !model.averages() {
        return Err(root
            .fail("turbulence", "large eddies live in space; give the grid a third axis, or take \"sst\""));
    }
    let scale = match (number("length"), number("viscosity_ratio")) {
        (Some(_), Some(_)) => {
            return Err(t.fail("viscosity_ratio", "`length` is given already; leave out one of the two"));
        }
        (Some(length), None) => ScaleChoice::Length(length),
        (None, ratio) => ScaleChoice::ViscosityRatio(ratio.unwrap_or(10.0)),
    };
    Ok(Some(TurbulenceSetup {
        model,
        scale,
        intensity: number("intensity").unwrap_or(0.05),
        speed: number("speed"),
        walls: match t.text("walls") {
            Some("no-slip") => WallStress::NoSlip,
            Some("slip") => WallStress::Slip,
            _ => WallStress::LAW_OF_THE_WALL,
        },
    }))
}

pub(super) fn scalars(
    root: &Reader<'_>,
    context: &Context<'_>,
    sides: &[[Side; 2]],
) -> Result<Vec<ScalarSetup>, Problem> {
    let mut out = Vec::new();
    for (name, t) in root.named("scalars") {
        let taken = ["velocity", "pressure", "lambda", "eddy_viscosity"];
        if taken.contains(&name) {
            return Err(
                root.fail("scalars", format!("\"{name}\" is the name of another field; give another"))
            );
        }
        let buoyancy = t.number("expansion").map(|beta| (beta, t.number("reference").unwrap_or(0.0)));
        if t.has("reference") && buoyancy.is_none() {
            return Err(
                t.fail("reference", "without `expansion` nothing is buoyant; give it, or leave this out")
            );
        }
        if buoyancy.is_some() && out.iter().any(|s: &ScalarSetup| s.buoyancy.is_some()) {
            return Err(t.fail("expansion", "another scalar is buoyant already; only one can be"));
        }
        if t.has("bodies") && t.has("bodies_flux") {
            return Err(
                t.fail("bodies_flux", "`bodies` gives its value there already; leave out one of the two")
            );
        }
        out.push(ScalarSetup {
            name: name.into(),
            unit: t.text("unit").unwrap_or_default().into(),
            diffusivity: t.number("diffusivity").unwrap_or(0.0),
            turbulent_prandtl: t.number("turbulent_prandtl").unwrap_or(0.85),
            source: t.formula("source", &["x", "y", "z"])?,
            initial: t.formula("initial", &["x", "y", "z"])?.unwrap_or(Expression::constant(0.0)),
            convection: match t.text("convection") {
                Some("central") => Convection::Central,
                Some("upwind") => Convection::Upwind,
                Some("quick") => Convection::Quick,
                _ => Convection::Limited,
            },
            sides: scalar_sides(&t, context, sides)?,
            bodies: t.formula("bodies", &["t"])?,
            flux: t.formula("bodies_flux", &["t"])?,
            buoyancy,
        });
    }
    Ok(out)
}

/// What holds for a scalar where the flow has these sides.
fn scalar_sides(
    t: &Reader<'_>,
    context: &Context<'_>,
    flow: &[[Side; 2]],
) -> Result<Vec<[ScalarSide; 2]>, Problem> {
    let table = t.table("sides");
    let has = |key: &str| table.as_ref().filter(|t| t.has(key));
    if context.dim == 2
        && let Some((key, t)) = ["z", "z_min", "z_max"].into_iter().find_map(|key| Some((key, has(key)?)))
    {
        return Err(t.fail(key, "a plane scene has no sides along z; leave this out"));
    }
    let side = |a: usize, end: usize| -> Result<ScalarSide, Problem> {
        let axis = ["x", "y", "z"][a];
        let own = format!("{axis}_{}", ["min", "max"][end]);
        let told = match (has(&own), has(axis)) {
            (Some(t), Some(_)) => {
                return Err(t.fail(
                    &own,
                    format!("`{axis}` stands for both sides already; leave out one of the two"),
                ));
            }
            (Some(t), None) => Some((own.as_str(), t)),
            (None, Some(t)) => Some((axis, t)),
            (None, None) => None,
        };
        let periodic = matches!(flow[a][end], Side::Periodic);
        match told {
            Some((key, t)) if periodic => Err(t.fail(key, "this side is periodic; leave it out")),
            Some((key, t)) => given(t, key),
            None if periodic => Ok(ScalarSide::Periodic),
            None => Ok(match flow[a][end] {
                Side::Inlet(_) => ScalarSide::value(0.0),
                _ => ScalarSide::NO_GRADIENT,
            }),
        }
    };
    (0..context.dim).map(|a| Ok([side(a, 0)?, side(a, 1)?])).collect()
}

fn given(t: &Reader<'_>, key: &str) -> Result<ScalarSide, Problem> {
    let Some((kind, t)) = t.choice(key, "type") else {
        return Err(t.fail(key, "what holds at this side?"));
    };
    let of = |key: &str| -> Result<Given, Problem> {
        let formula = t.formula(key, &["x", "y", "z", "t"])?.unwrap_or(Expression::constant(0.0));
        Ok(match formula.fixed() {
            Some(value) => Given::Uniform(value),
            None => Given::function(move |x, time| formula.needed(&[x[0], x[1], x[2], time])),
        })
    };
    Ok(match kind {
        "value" => ScalarSide::Value(of("value")?),
        "gradient" => ScalarSide::Gradient(of("gradient")?),
        _ => ScalarSide::NO_GRADIENT,
    })
}
