//! What is written and measured.
use super::Context;
use crate::problem::Problem;
use crate::reader::Reader;
use fv_mesh::{Axis, Side};
use std::ops::Range;
use std::path::PathBuf;

/// Files of a run.
#[derive(Clone, Debug)]
pub(crate) struct Output {
    pub(crate) folder: PathBuf,
    /// Intervals of the run; 0: the end alone.
    pub(crate) snapshots: usize,
    /// Fields of VTK files, if there are any.
    pub(crate) fields: Option<FieldChoice>,
    pub(crate) bodies: bool,
    /// Are the books of momentum and energy kept?
    pub(crate) ledger: bool,
    /// Whether `report.html` is made.
    pub(crate) report: bool,
    pub(crate) images: Option<Images>,
}

/// Fields of VTK files besides λ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct FieldChoice {
    pub(crate) velocity: bool,
    pub(crate) pressure: bool,
    /// Scalars and what a turbulence model has.
    pub(crate) others: bool,
    pub(crate) vorticity: bool,
    pub(crate) q_criterion: bool,
}

impl FieldChoice {
    fn read(t: &Reader<'_>) -> Option<Self> {
        let given = t.texts("fields");
        let all = given.is_empty() && t.flag("fields").unwrap_or(!t.has("fields"));
        let has = |word: &str| given.contains(&word);
        (all || !given.is_empty()).then(|| Self {
            velocity: all || has("velocity"),
            pressure: all || has("pressure"),
            others: all || has("scalars"),
            vorticity: has("vorticity"),
            q_criterion: has("q_criterion"),
        })
    }
}

/// Pictures of a run.
#[derive(Clone, Debug)]
pub(crate) struct Images {
    /// One at every so many snapshots.
    pub(crate) every: usize,
    pub(crate) quantity: Quantity,
    pub(crate) limits: Option<[f64; 2]>,
    /// Of scenes in space the axis that the slice is normal to, and the number of its cells on it.
    pub(crate) slice: Option<(usize, usize)>,
    /// Its axes across and up, and the cells along them that are shown.
    pub(crate) axes: [usize; 2],
    pub(crate) region: [Range<usize>; 2],
}

impl Images {
    /// What is shown of the values of a slice, which has so many cells across.
    pub(crate) fn part<T: Copy>(&self, slice: &[T], across: usize) -> Vec<T> {
        let [i, j] = self.region.clone();
        let mut part = Vec::with_capacity(i.len() * j.len());
        slice.chunks(across).skip(j.start).take(j.len()).for_each(|row| part.extend(&row[i.clone()]));
        part
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// A scalar, or what a turbulence model has.
    Field(String),
    Speed,
    Component(usize),
    Pressure,
    Vorticity,
}

/// Points where the flow is written down.
#[derive(Clone, Debug)]
pub(crate) struct ProbeSetup {
    pub(crate) name: String,
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) every: Option<f64>,
}

/// Equally spaced points on a straight line, along which the flow is written down.
#[derive(Clone, Debug)]
pub(crate) struct LineSetup {
    pub(crate) name: String,
    pub(crate) points: Vec<[f64; 3]>,
}

/// Means in time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Averages {
    pub(crate) start: f64,
    pub(crate) profile: Option<usize>,
}

/// Number of the results and its reference.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    pub(crate) name: String,
    pub(crate) pointer: String,
    pub(crate) value: f64,
    pub(crate) source: String,
    /// Largest deviation allowed, relative unless the value is 0.
    pub(crate) tolerance: Option<f64>,
}

pub(super) fn references(root: &Reader<'_>) -> Result<Vec<Reference>, Problem> {
    let text = |t: &Reader<'_>, key: &str| t.text(key).unwrap_or_default().to_owned();
    root.tables("references")
        .iter()
        .map(|t| {
            let pointer = text(t, "pointer");
            if !pointer.starts_with('/') {
                return Err(
                    t.fail("pointer", "a JSON pointer begins with a slash: /forces/0/coefficients/mean/0")
                );
            }
            Ok(Reference {
                name: text(t, "name"),
                pointer,
                value: t.number("value").unwrap_or(0.0),
                source: text(t, "source"),
                tolerance: t.number("tolerance"),
            })
        })
        .collect()
}

pub(super) fn output(t: &Reader<'_>, name: &str, axes: &[Axis], snapshots: usize) -> Result<Output, Problem> {
    let flag = |key: &str| t.flag(key).unwrap_or(true);
    Ok(Output {
        folder: t.text("folder").map_or_else(|| PathBuf::from("out").join(name), PathBuf::from),
        snapshots,
        fields: FieldChoice::read(t),
        bodies: flag("bodies"),
        ledger: flag("ledger"),
        report: flag("report"),
        images: flag("images").then(|| images(t, axes, snapshots)).transpose()?,
    })
}

/// So many pictures a run has unless told.
const PICTURES: usize = 20;

fn images(t: &Reader<'_>, axes: &[Axis], snapshots: usize) -> Result<Images, Problem> {
    let quantity = match t.text("quantity") {
        _ if t.has("field") => Quantity::Field(t.text("field").unwrap_or_default().into()),
        Some("u") => Quantity::Component(0),
        Some("v") => Quantity::Component(1),
        Some("w") if axes.len() == 2 => {
            return Err(t.fail("quantity", "a plane flow has no component w; take u, v or speed"));
        }
        Some("w") => Quantity::Component(2),
        Some("pressure") => Quantity::Pressure,
        Some("vorticity") => Quantity::Vorticity,
        _ => Quantity::Speed,
    };
    let limits = t.numbers("limits").and_then(|l| Some([*l.first()?, *l.get(1)?]));
    if limits.is_some_and(|[low, high]| low >= high) {
        return Err(t.fail("limits", "the second limit has to be above the first"));
    }
    let middle = |a: usize| 0.5 * (axes[a].lower() + axes[a].upper());
    let slice = match (t.table("slice"), axes.len()) {
        (Some(_), 2) => return Err(t.fail("slice", "a plane scene is its own slice; leave this out")),
        (None, 2) => None,
        (None, _) => axes[2].locate(middle(2)).map(|layer| (2, layer)),
        (Some(slice), _) => {
            let normal = match slice.text("normal") {
                Some("x") => 0,
                Some("y") => 1,
                _ => 2,
            };
            let at = slice.number("at").unwrap_or(middle(normal));
            let Some(layer) = axes[normal].locate(at) else {
                let (lower, upper) = (axes[normal].lower(), axes[normal].upper());
                return Err(slice.fail(
                    "at",
                    format!("{at} m is outside the box, which reaches from {lower} to {upper} m"),
                ));
            };
            Some((normal, layer))
        }
    };
    let shown = match slice {
        Some((0, _)) => [1, 2],
        Some((1, _)) => [0, 2],
        _ => [0, 1],
    };
    Ok(Images {
        every: t.whole("image_every").unwrap_or((snapshots / PICTURES).max(1)),
        quantity,
        limits,
        slice,
        axes: shown,
        region: region(t, shown.map(|a| &axes[a]))?,
    })
}

/// The cells across and up whose centres are in the region; all, if none is given.
fn region(t: &Reader<'_>, axes: [&Axis; 2]) -> Result<[Range<usize>; 2], Problem> {
    let mut cells = axes.map(|axis| 0..axis.cells());
    for ((axis, ends), cells) in axes.iter().zip(t.rows("region")).zip(&mut cells) {
        let (lower, upper) = (axis.lower(), axis.upper());
        let &[from, to] = &ends[..] else { continue };
        if from >= to {
            return Err(t.fail(
                "region",
                format!("from {from} to {to} m is nothing; the second has to be above the first"),
            ));
        }
        if from < lower || to > upper {
            let box_ = format!("the box reaches from {lower} to {upper} m there");
            return Err(t.fail("region", format!("from {from} to {to} m is not inside the box: {box_}")));
        }
        let count =
            |below: &dyn Fn(f64) -> bool| (0..axis.cells()).take_while(|&i| below(axis.centre(i))).count();
        *cells = count(&|x| x < from)..count(&|x| x <= to);
        if cells.start >= cells.end {
            let width = axis.width(axis.locate(from).unwrap_or(0));
            return Err(t.fail(
                "region",
                format!("from {from} to {to} m there is no cell's centre; cells are {width} m wide"),
            ));
        }
    }
    Ok(cells)
}

/// The key `name`, which becomes a file's.
pub(super) fn file_name(t: &Reader<'_>) -> Result<String, Problem> {
    let name = t.text("name").unwrap_or_default();
    let good = !name.is_empty()
        && name.chars().all(|c| c.is_alphanumeric() || "-_. ".contains(c))
        && !name.starts_with('.');
    if good {
        Ok(name.into())
    } else {
        Err(t.fail("name", "this becomes the name of a file; use letters, digits, -, _ and ."))
    }
}

pub(super) fn probes(
    root: &Reader<'_>,
    context: &Context<'_>,
    axes: &[Axis],
    sides: &[[Side; 2]],
    steady: bool,
) -> Result<Vec<ProbeSetup>, Problem> {
    let mut out: Vec<ProbeSetup> = Vec::new();
    for t in root.tables("probes") {
        let name = file_name(&t)?;
        if out.iter().any(|other| other.name == name) {
            return Err(t.fail("name", format!("there are probes \"{name}\" already; give another name")));
        }
        let mut points = Vec::new();
        for row in t.rows("points") {
            if row.len() != context.dim {
                return Err(t.fail(
                    "points",
                    format!("{row:?} is no point of this scene; give {} coordinates", context.dim),
                ));
            }
            for (a, &x) in row.iter().enumerate() {
                let periodic = matches!(sides[a][0], Side::Periodic);
                if !periodic && axes[a].locate(x).is_none() {
                    let (lower, upper) = (axes[a].lower(), axes[a].upper());
                    let message = format!(
                        "{row:?} is outside the box, which reaches from {lower} to {upper} m along that axis"
                    );
                    return Err(t.fail("points", message));
                }
            }
            points.push(std::array::from_fn(|a| row.get(a).copied().unwrap_or(0.0)));
        }
        out.push(ProbeSetup { name, points, every: t.number("every").filter(|_| !steady) });
    }
    Ok(out)
}

/// Points of a line unless given.
const LINE_POINTS: usize = 101;

pub(super) fn lines(
    root: &Reader<'_>,
    context: &Context<'_>,
    axes: &[Axis],
    sides: &[[Side; 2]],
) -> Result<Vec<LineSetup>, Problem> {
    let mut out: Vec<LineSetup> = Vec::new();
    for t in root.tables("lines") {
        let name = file_name(&t)?;
        if out.iter().any(|other| other.name == name) {
            return Err(t.fail("name", format!("there is a line \"{name}\" already; give another name")));
        }
        let end = |key: &str| -> Result<[f64; 3], Problem> {
            let x = t.point_of(key, context.dim)?.unwrap_or_default();
            for (a, axis) in axes.iter().enumerate() {
                let (lower, upper) = (axis.lower(), axis.upper());
                if !matches!(sides[a][0], Side::Periodic) && !(lower..=upper).contains(&x[a]) {
                    let axis = ["x", "y", "z"][a];
                    return Err(t.fail(key, format!(
                        "{} m along {axis} is outside the box, which reaches from {lower} to {upper} m; give a point inside",
                        x[a]
                    )));
                }
            }
            Ok([x.x, x.y, x.z])
        };
        let (from, to) = (end("from")?, end("to")?);
        if from == to {
            return Err(t.fail("to", "both ends of the line are the same point; give another"));
        }
        let n = t.whole("points").unwrap_or(LINE_POINTS);
        let point = |i: usize| {
            let share = i as f64 / (n - 1) as f64;
            std::array::from_fn(|a| from[a] * (1.0 - share) + to[a] * share)
        };
        out.push(LineSetup { name, points: (0..n).map(point).collect() });
    }
    Ok(out)
}

pub(super) fn averages(t: &Reader<'_>, end: f64, dim: usize) -> Result<Averages, Problem> {
    let profile = match t.text("profile") {
        Some("x") => Some(0),
        Some("y") => Some(1),
        Some("z") if dim == 2 => return Err(t.fail("profile", "a plane scene has no axis z; take x or y")),
        Some("z") => Some(2),
        _ => None,
    };
    Ok(Averages { start: t.number("start").unwrap_or(0.5 * end), profile })
}
