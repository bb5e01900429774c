//! A box that follows a body.
use super::{Bodies, Context, ForcingChoice, Motion};
use crate::problem::Problem;
use crate::reader::Reader;
use fv_mesh::Side;

/// A box that moves along an axis with a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WindowSetup {
    /// Number of the body at the start.
    pub(crate) body: usize,
    pub(crate) axis: usize,
    /// Place of the body as a share of the box's length.
    pub(crate) place: f64,
}

pub(super) fn read(
    root: &Reader<'_>,
    context: &Context<'_>,
    bodies: &Bodies,
    sides: &[[Side; 2]],
) -> Result<Option<WindowSetup>, Problem> {
    let Some(t) = root.table("window") else { return Ok(None) };
    let flow = root.table("flow");
    let algorithm = flow.as_ref().and_then(|t| t.text("algorithm")).unwrap_or("projection");
    if algorithm != "projection" || bodies.forcing() == ForcingChoice::CutLinks {
        let message =
            "the box follows bodies that move by forcing in a flow by \"projection\"; leave this out";
        return Err(root.fail("window", message));
    }
    if let Some(key) = ["probes", "lines", "averages", "models", "scalars", "turbulence"]
        .into_iter()
        .find(|key| root.has(key))
    {
        let message = format!("`{key}` cannot follow the box; leave out one of the two");
        return Err(root.fail("window", message));
    }
    let name = t.text("body").unwrap_or_default();
    let body = bodies.list.iter().position(|b| b.name == name);
    let Some(body) = body.filter(|b| !matches!(bodies.list[*b].motion, Motion::Fixed)) else {
        return Err(t.fail("body", format!("no body \"{name}\" moves; give the name of one that does")));
    };
    let word = t.text("axis").unwrap_or_default();
    let axis = ["x", "y", "z"].iter().position(|name| *name == word).unwrap_or(0);
    if axis >= context.dim {
        return Err(t.fail("axis", "a plane scene has no axis z; take x or y"));
    }
    if let Some(Side::Periodic) = sides[axis].first() {
        let message = format!("{word} is periodic: fluid that leaves comes in again; leave out `window`");
        return Err(t.fail("axis", message));
    }
    Ok(Some(WindowSetup { body, axis, place: t.number("place").unwrap_or(0.5) }))
}
