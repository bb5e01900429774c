//! Reduced models of a run.
use super::{Bodies, Motion};
use crate::problem::Problem;
use crate::reader::Reader;
use fv_mesh::Axis;
use mor::shifted::Interpolation;

/// A model of one field.
#[derive(Clone, Debug)]
pub(crate) struct ModelSetup {
    pub(crate) name: String,
    pub(crate) field: String,
    /// Numbers of the bodies that modes move along with.
    pub(crate) frames: Vec<usize>,
    pub(crate) turning: bool,
    pub(crate) ranks: Option<Vec<usize>>,
    pub(crate) tolerance: f64,
    pub(crate) interpolation: Interpolation,
    pub(crate) coefficients: Coefficients,
    /// One of so many snapshots makes the model.
    pub(crate) every: usize,
}

impl ModelSetup {
    /// Memory of its fit \[bytes\]: all snapshots of the field, those that make the model, and a
    /// decomposition of these.
    pub(crate) fn memory(&self, cells: usize, dim: usize, snapshots: usize) -> f64 {
        let components = if self.field == "velocity" { dim } else { 1 };
        let all = (cells * components * (snapshots + 1) * size_of::<f64>()) as f64;
        all * (1.0 + 2.0 / self.every as f64)
    }
}

/// The functions of time.
#[derive(Clone, Debug)]
pub(crate) enum Coefficients {
    Best,
    Spline,
    Network(Vec<usize>),
}

/// Fewest snapshots that make a model, less one.
const FEWEST: usize = 8;

/// Of fields that are among `fields`.
pub(super) fn read(
    root: &Reader<'_>,
    axes: &[Axis],
    bodies: &Bodies,
    (snapshots, fields): (usize, &[&str]),
) -> Result<Vec<ModelSetup>, Problem> {
    let mut out: Vec<ModelSetup> = Vec::new();
    for t in root.tables("models") {
        let name = super::measures::file_name(&t)?;
        if out.iter().any(|other| other.name == name) {
            return Err(t.fail("name", format!("there is a model \"{name}\" already; give another name")));
        }
        let field = t.text("field").unwrap_or_default().to_owned();
        if !fields.contains(&field.as_str()) {
            let known = fields.join(", ");
            return Err(t.fail("field", format!("there is no field \"{field}\" here; there are: {known}")));
        }
        let every = t.whole("every").unwrap_or(2);
        if snapshots / every < FEWEST {
            let message = format!(
                "{} of the run's snapshots make the model; give output.snapshots of {} at least",
                snapshots / every + 1,
                every * FEWEST
            );
            return Err(t.fail_here(message));
        }
        let frames = frames(&t, axes, bodies)?;
        let ranks = t.wholes("ranks");
        if let Some(ranks) = &ranks
            && ranks.len() != frames.len().max(1)
        {
            let wanted = if frames.is_empty() {
                "one number".into()
            } else {
                format!("{}, one for each frame", frames.len())
            };
            return Err(t.fail("ranks", format!("{} numbers; give {wanted}", ranks.len())));
        }
        let network = || Coefficients::Network(t.wholes("hidden").unwrap_or_else(|| vec![24, 24]));
        out.push(ModelSetup {
            name,
            field,
            frames,
            turning: t.flag("turning").unwrap_or(false),
            ranks,
            tolerance: t.number("tolerance").unwrap_or(1e-3),
            interpolation: match t.text("interpolation") {
                Some("linear") => Interpolation::Lagrange1,
                Some("cubic") => Interpolation::CubicSpline,
                Some("quintic") => Interpolation::QuinticSpline,
                _ => Interpolation::Spectral,
            },
            coefficients: match t.text("coefficients") {
                Some("network") => network(),
                Some("spline") => Coefficients::Spline,
                _ if t.has("hidden") => network(),
                _ => Coefficients::Best,
            },
            every,
        });
    }
    Ok(out)
}

/// Numbers of the bodies that are named.
fn frames(t: &Reader<'_>, axes: &[Axis], bodies: &Bodies) -> Result<Vec<usize>, Problem> {
    let names = t.texts("frames");
    let mut out = Vec::new();
    for name in &names {
        let Some(number) = bodies.list.iter().position(|b| b.name == *name) else {
            return Err(t.fail("frames", format!("there is no body \"{name}\" in `bodies`")));
        };
        if matches!(bodies.list[number].motion, Motion::Fixed) {
            return Err(t.fail("frames", format!("body \"{name}\" does not move; leave it out")));
        }
        out.push(number);
    }
    for key in ["turning", "interpolation"] {
        if out.is_empty() && t.has(key) {
            return Err(
                t.fail(key, "without `frames` modes stay where they are; give these, or leave this out")
            );
        }
    }
    if let Some(a) = axes.iter().position(|axis| !out.is_empty() && !axis.is_uniform()) {
        let axis = ["x", "y", "z"][a];
        return Err(t.fail("frames", format!("modes move on equal cells only, and those along {axis} are not; make them equal, or leave this out")));
    }
    Ok(out)
}
