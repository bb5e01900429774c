//! Scenes without a fluid.
use super::{Quantity, Setup};
use crate::problem::Problem;
use crate::reader::Reader;

/// What only a fluid gives a meaning.
const WET: [&str; 11] = [
    "force",
    "initial",
    "flow",
    "turbulence",
    "scalars",
    "lubrication",
    "coupling",
    "probes",
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
    let quantity = setup.output.images.as_ref().map(|i| &i.quantity);
    if let Some(Quantity::Pressure | Quantity::Vorticity | Quantity::Field(_)) = quantity {
        let output = root.table("output").unwrap_or_else(|| root.clone());
        return Err(
            output.fail("quantity", "without `fluid` pictures show the bodies: their speed, u, v or w")
        );
    }
    Ok(())
}
