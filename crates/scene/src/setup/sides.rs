//! The sides of the box.
use super::{Context, surfaces, tables};
use crate::expression::Expression;
use crate::problem::Problem;
use crate::reader::Reader;
use fv_mesh::{Patch, Profile, Side};

/// What happens at the lower and upper side of every axis.
pub(super) fn read(root: &Reader<'_>, context: &Context<'_>) -> Result<Vec<[Side; 2]>, Problem> {
    let Some(sides) = root.table("sides") else { return Err(root.fail("sides", "the sides are missing")) };
    if context.dim == 2
        && let Some(key) = ["z", "z_min", "z_max"].into_iter().find(|key| sides.has(key))
    {
        return Err(sides
            .fail(key, "a plane scene has no sides along z; give the grid a third axis, or leave this out"));
    }
    let pair = |name: &str| -> Result<[Side; 2], Problem> {
        let axis = ["x", "y", "z"].iter().position(|axis| *axis == name).unwrap_or(0);
        let mut pair = [const { None }; 2];
        for (slot, end) in pair.iter_mut().zip(["min", "max"]) {
            let own = format!("{name}_{end}");
            *slot = match (sides.has(&own), sides.has(name)) {
                (true, true) => {
                    return Err(sides.fail(
                        &own,
                        format!("`{name}` stands for both sides already; leave out one of the two"),
                    ));
                }
                (true, false) => Some(side(&sides, &own, context, axis)?),
                (false, true) => Some(side(&sides, name, context, axis)?),
                (false, false) => {
                    let message = format!(
                        "what happens at the side {own}? Give `{own}`, or `{name}` for both sides of the axis"
                    );
                    return Err(sides.fail_here(message));
                }
            };
        }
        Ok(pair.map(|side| side.unwrap_or(Side::Periodic)))
    };
    ["x", "y", "z"][..context.dim].iter().map(|name| pair(name)).collect()
}

/// Boundary condition of the side `key` normal to `axis`.
fn side(sides: &Reader<'_>, key: &str, context: &Context<'_>, axis: usize) -> Result<Side, Problem> {
    let Some((kind, t)) = sides.choice(key, "type") else {
        return Err(sides.fail(key, "what happens at this side?"));
    };
    Ok(match kind {
        "periodic" => Side::Periodic,
        "wall" => {
            if t.changes("velocity", axis) {
                return Err(t.fail("velocity", format!(
                    "a wall keeps its place and slides only; its component along {} has to be 0 and no formula",
                    ["x", "y", "z"][axis]
                )));
            }
            surfaces::wall(&t, context.dim)?
        }
        "symmetry" => Side::FreeSlip,
        "inlet" => Side::Inlet(inlet(&t, context)?),
        "outlet" => Side::ConvectiveOutlet,
        "pressure" => Side::PressureOutlet(t.number("value").unwrap_or(0.0)),
        _ => Side::Patches(
            t.tables("list")
                .iter()
                .map(|patch| {
                    let corner =
                        |key: &str| patch.vector_of(key, context.dim).map(|v| v.unwrap_or_default().into());
                    Ok(Patch {
                        lower: corner("lower")?,
                        upper: corner("upper")?,
                        side: side(patch, "side", context, axis)?,
                    })
                })
                .collect::<Result<_, _>>()?,
        ),
    })
}

fn inlet(t: &Reader<'_>, context: &Context<'_>) -> Result<Profile, Problem> {
    let given: Vec<&str> = ["velocity", "peak", "table"].into_iter().filter(|key| t.has(key)).collect();
    if let [first, second, ..] = given[..] {
        return Err(t.fail(second, format!("`{first}` is given already; leave out one of the two")));
    }
    if let Some(peak) = t.number("peak") {
        return Ok(Profile::Parabolic { peak });
    }
    let u = if t.has("table") {
        let columns = tables::read(t, "table", context, ["u", "v", "w"], 3)?;
        if context.dim == 2 && columns[2].is_some() {
            return Err(t.fail("table", "a plane flow has no component w; leave out that column"));
        }
        columns.map(|column| column.unwrap_or(Expression::constant(0.0)))
    } else {
        t.formulas("velocity", &["x", "y", "z", "t"], context.dim)?
            .ok_or_else(|| t.fail_here("what enters? Give `velocity`, `table`, or `peak` for a parabola"))?
    };
    if let [Some(x), Some(y), Some(z)] = u.each_ref().map(|u| u.fixed()) {
        return Ok(Profile::Uniform([x, y, z]));
    }
    Ok(Profile::function(move |x, time| {
        let variables = [x[0], x[1], x[2], time];
        u.each_ref().map(|u| u.needed(&variables))
    }))
}

/// Whether fluid may enter or leave there, on a part of the side at least.
pub(crate) fn is_open(side: &Side) -> bool {
    match side {
        Side::Patches(patches) => patches.iter().any(|p| is_open(&p.side)),
        side => matches!(side, Side::Inlet(_) | Side::ConvectiveOutlet | Side::PressureOutlet(_)),
    }
}
