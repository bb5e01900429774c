//! The algorithm of the paper.
use crate::{CouplingError, Explicit, Particles, Simulation, WeightBalance};
use dem::{Chen, ContactLaw, RigidBodies};
use fv_mesh::{Piso, PisoParams, TimeScheme};
use ibm::Hfdib;
use interfaces::Vector;

/// A simulation by [`hfdib_dem`].
pub type HfdibDem<const D: usize, L = Chen> =
    Simulation<D, Particles<Hfdib, RigidBodies<L>, Explicit>, Piso<D>>;

/// The algorithm of Isoz et al. (2023): PISO, by Euler's scheme in time, with the hybrid fictitious domain–immersed boundary forcing (equations 1–2) inside its pressure
/// corrections, bodies that feel in a step what the flow did to them in the last, and, with [`Chen`]'s law, contact by equation 4.
///
/// It is here to be compared with; [`OneSolve`](crate::OneSolve) with [`SmoothForcing`](ibm::SmoothForcing) on a [`Projection`](fv_mesh::Projection) is
/// quieter and stable for light bodies, which this is not (by BDF2 not even for discs of 1.2 times the fluid's density). The step has to be given ([`Schedule::dt`](crate::Schedule)) or is that of the Courant number: implicit
/// viscous terms set no limit.
///
/// # Errors
/// [`CouplingError`] when flow and bodies do not fit.
pub fn hfdib_dem<const D: usize, L: ContactLaw>(
    flow: Piso<D>,
    bodies: RigidBodies<L>,
    gravity: Vector,
    balance: WeightBalance,
) -> Result<HfdibDem<D, L>, CouplingError> {
    let params = PisoParams { time_scheme: TimeScheme::Euler, ..*flow.params() };
    let flow = flow.with_params(params)?;
    let density = flow.fluid().density;
    let particles = Particles::new(bodies, Hfdib::new(density), density, gravity).with_strategy(Explicit);
    Simulation::new(flow, particles, balance)
}
