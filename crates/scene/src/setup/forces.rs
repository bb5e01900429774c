//! Loads on bodies as they are written down.
use super::{Algorithm, ForcingChoice, Setup};
use crate::problem::Problem;
use crate::reader::Reader;

/// How loads are written down.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Forces {
    /// Speed U and area A of coefficients.
    pub(crate) reference: Option<(f64, f64)>,
    pub(crate) start: f64,
    pub(crate) every: Option<f64>,
    /// Measures of a steady flow: one load.
    pub(crate) steady: bool,
    /// D of Strouhal numbers \[m\].
    pub(crate) length: Option<f64>,
    /// Whether pressure and friction are written.
    pub(crate) parts: bool,
    /// Speed \[m/s\] and reference pressure \[Pa\] of coefficients along surfaces, if these are written.
    pub(crate) surfaces: Option<[f64; 2]>,
}

/// The table `forces`.
pub(super) fn read(t: &Reader<'_>, end: f64, dim: usize, steady: bool) -> Result<Forces, Problem> {
    let (area, speed) = (t.number("area"), t.number("velocity"));
    let surfaces = t.flag("surfaces").unwrap_or(false);
    if surfaces && dim == 3 {
        return Err(t.fail("surfaces", "these are lines in plane scenes; leave this out in space"));
    }
    if surfaces && speed.is_none() {
        return Err(t.fail("surfaces", "coefficients along surfaces need a speed U; give `velocity`"));
    }
    Ok(Forces {
        reference: speed.zip(area),
        start: t.number("start").filter(|_| !steady).unwrap_or(0.5 * end),
        every: t.number("every").filter(|_| !steady),
        steady,
        length: t.number("length").or(area.filter(|_| dim == 2)),
        parts: t.flag("parts").unwrap_or(false),
        surfaces: speed.filter(|_| surfaces).map(|u| [u, t.number("pressure").unwrap_or(0.0)]),
    })
}

/// Whether the bodies have the loads that are to be written.
pub(super) fn agrees(root: &Reader<'_>, setup: &Setup) -> Result<(), Problem> {
    let (Some(forces), Some(t)) = (&setup.forces, root.table("forces")) else { return Ok(()) };
    let key = if forces.parts { "parts" } else { "surfaces" };
    let sharp = match setup.flow.algorithm {
        Algorithm::Simple => true,
        Algorithm::Projection => setup.bodies.forcing() == ForcingChoice::CutLinks,
        Algorithm::Piso => false,
    };
    if (forces.parts || forces.surfaces.is_some()) && !sharp {
        let message = "the forcing of these bodies is distributed over cells on both sides of their surface, where pressure and friction cannot be told apart; take bodies that are all \"fixed\", as walls by cut links or in a steady flow, or leave this out";
        return Err(t.fail(key, message));
    }
    if forces.surfaces.is_some() && setup.turbulence.as_ref().is_some_and(|t| t.model.averages()) {
        let message = "the stress next to walls is a law of the wall's with this turbulence model, not that of the resolved velocity; leave this out";
        return Err(t.fail("surfaces", message));
    }
    Ok(())
}
