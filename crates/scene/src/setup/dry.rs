//! Scenes without a fluid.
use super::{Quantity, Setup};
use crate::problem::Problem;
use crate::reader::Reader;
use fv_mesh::Side;

/// What only a fluid gives a meaning.
const WET: [&str; 14] = [
    "force",
    "flow_rate",
    "initial",
    "flow",
    "turbulence",
    "scalars",
    "lubrication",
    "coupling",
    "probes",
    "lines",
    "window",
    "forces",
    "averages",
    "models",
];

/// Does a scene without a fluid ask for nothing that needs one?
pub(super) fn agrees(root: &Reader<'_>, setup: &Setup) -> Result<(), Problem> {
    if let Some(key) = WET.into_iter().find(|key| root.has(key)) {
        return Err(root.fail(
            key,
            "this needs a fluid; give `fluid`, or leave this out: without `fluid` there are bodies alone",
        ));
    }
    if !setup.bodies.any_moves() {
        return Err(root.fail(
            "bodies",
            "without `fluid` and without a body that moves nothing happens; give one of these",
        ));
    }
    for (a, pair) in setup.sides.iter().enumerate() {
        for side in pair {
            let known =
                side.is_wall() || matches!(side, Side::Periodic | Side::FreeSlip | Side::ConvectiveOutlet);
            if !known {
                let sides = root.table("sides").unwrap_or_else(|| root.clone());
                let axis = ["x", "y", "z"][a];
                return Err(sides.fail_here(format!("along {axis}: without `fluid` nothing enters; take \"wall\", \"symmetry\", \"periodic\", or \"outlet\" for a side that bodies may leave by")));
            }
        }
    }
    let output = root.table("output");
    if output.as_ref().is_some_and(|t| t.flag("fields") == Some(true) || !t.texts("fields").is_empty()) {
        return Err(root.fail("output", "without `fluid` there are no fields to write; leave out `fields`"));
    }
    let quantity = setup.output.images.as_ref().map(|i| &i.quantity);
    if let Some(Quantity::Pressure | Quantity::Vorticity | Quantity::Field(_)) = quantity {
        return Err(output
            .unwrap_or_else(|| root.clone())
            .fail("quantity", "without `fluid` pictures show the bodies: their speed, u, v or w"));
    }
    Ok(())
}
