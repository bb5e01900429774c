//! Steady scenes: no time, no bodies that move.
use super::{Algorithm, ForcingChoice, Setup};
use crate::problem::Problem;
use crate::reader::Reader;

/// Keys that an algorithm does not use: the algorithm, the table, the keys.
const UNUSED: [(Algorithm, &str, &[&str]); 10] = [
    (Algorithm::Simple, "time", &["steps", "dt", "courant", "ramp"]),
    (Algorithm::Simple, "flow", &["diffusion", "pressure"]),
    (Algorithm::Simple, "forces", &["start", "every"]),
    (Algorithm::Simple, "output", &["snapshots", "image_every", "ledger"]),
    (Algorithm::Simple, "coupling", &["strategy", "balance", "virtual_mass", "passes", "kernel"]),
    (Algorithm::Projection, "flow", &["tolerance", "iterations"]),
    (Algorithm::Projection, "turbulence", &["walls"]),
    (Algorithm::Piso, "flow", &["diffusion", "pressure", "tolerance", "iterations"]),
    (Algorithm::Piso, "time", &["courant"]),
    (Algorithm::Piso, "coupling", &["strategy", "passes", "kernel"]),
];

/// Keys of the file that the algorithm does not use.
pub(super) fn unused(root: &Reader<'_>, algorithm: Algorithm) -> Vec<String> {
    let mut out = Vec::new();
    for (_, table, keys) in UNUSED.iter().filter(|(of, ..)| *of == algorithm) {
        let Some(t) = root.table(table) else { continue };
        out.extend(keys.iter().filter(|key| t.has(key)).map(|key| format!("{table}.{key}")));
    }
    if algorithm == Algorithm::Simple {
        let probes = root.tables("probes").into_iter().enumerate();
        out.extend(probes.filter(|(_, t)| t.has("every")).map(|(k, _)| format!("probes.{k}.every")));
    }
    out
}

/// Whether the parts of a steady scene go together.
pub(super) fn agrees(root: &Reader<'_>, setup: &Setup) -> Result<(), Problem> {
    let bodies = !setup.bodies.list.is_empty() || !setup.bodies.inflows.is_empty();
    let fail = |message: &str| match root.table("flow") {
        Some(flow) => flow.fail("algorithm", message),
        None => root.fail("flow", message),
    };
    if !setup.bodies.inflows.is_empty() {
        return Err(root.fail(
            "factories",
            "bodies of type \"inflow\" come in as time goes on, and a steady flow has no time; leave them out, or take flow.algorithm = \"projection\"",
        ));
    }
    if bodies && setup.bodies.any_moves() {
        return Err(fail(
            "a steady flow has no bodies that move; make them `motion = \"fixed\"`, or take \"projection\"",
        ));
    }
    if let Some(b) = setup.bodies.moving_surface() {
        let message = format!(
            "a steady flow has no surfaces of bodies that move, as that of body {} does; leave out surface_velocity and surface_spin, or take \"projection\"",
            b.name
        );
        return Err(fail(&message));
    }
    if let Some(formula) = root.find_formula(|f| f.uses("t")) {
        let message = format!(
            "the formula {} changes with t, and a steady flow has no time; give one without t, or take flow.algorithm = \"projection\"",
            crate::problem::shown(&formula.text)
        );
        return Err(Problem::new(formula.path, formula.place, message));
    }
    if setup.turbulence.as_ref().is_some_and(|t| !t.model.averages()) {
        return Err(fail(
            "large eddies are not steady; take \"projection\", or a model of two equations such as \"sst\"",
        ));
    }
    if setup.averages.is_some() || !setup.models.is_empty() {
        return Err(fail(
            "a steady flow has no history; leave out averages and models, or take \"projection\"",
        ));
    }
    if setup.scalars.iter().any(|s| bodies && s.bodies.is_none()) {
        return Err(fail(
            "in a steady flow every scalar needs its value on bodies; give scalars.NAME.bodies, or take \"projection\"",
        ));
    }
    if setup.scalars.iter().any(|s| !s.has_value()) {
        return Err(fail(
            "a steady scalar of which only gradients are given is known but for a constant; give its value at a side or on bodies",
        ));
    }
    if let (Some(coupling), ForcingChoice::Smooth | ForcingChoice::Hfdib) =
        (root.table("coupling"), setup.bodies.forcing())
    {
        let message = "bodies in a steady flow are walls of cut cells; leave this out, or take flow.algorithm = \"projection\"";
        return Err(coupling.fail("forcing", message));
    }
    if let Some(fluid) = root.table("fluid").filter(|_| setup.fluid().viscosity == 0.0) {
        let key = if fluid.has("nu") { "nu" } else { "mu" };
        let message = "a steady flow is found from its friction, and this fluid has none; give a viscosity above 0, or take flow.algorithm = \"projection\"";
        return Err(fluid.fail(key, message));
    }
    Ok(())
}
