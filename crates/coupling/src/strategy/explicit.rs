//! Bodies feel what the flow did to them in the step before.
use super::{Strategy, sealed};
use crate::particles::{State, six, wrench};
use crate::{CouplingError, FlowSolver, Module, Particles, Timings};
use ibm::Forcing;
use interfaces::{BodyId, Dynamics, Load};
use nalgebra::Vector6;

/// The impulse of the fluid in one step acts on the body in the next:
///
/// ```text
/// M_s vⁿ⁺¹ = M_s vⁿ + Jⁿ + dt (ρ_s − ρ) V g + J_contact
/// ```
///
/// the way of many codes, the paper's among them. The fluid's added mass acts a step late, so this is unstable for bodies lighter than about
/// the fluid, however short the step, and accurate to first order in time. It costs nothing but the one pressure solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Explicit;

impl Strategy for Explicit {}

impl sealed::Strategy for Explicit {
    fn held(state: &State, weight: Vector6<f64>, dt: f64, _: bool) -> Load {
        Load { wrench: wrench(state.deferred / dt + weight), ..Load::default() }
    }
}

impl<const D: usize, A: FlowSolver<D>> sealed::Exchange<D, A> for Explicit {
    fn exchange<F: Forcing, B: Dynamics>(
        particles: &mut Particles<F, B, Self>,
        flow: &mut A,
        dt: f64,
        timings: &mut Timings,
    ) -> Result<(), CouplingError> {
        particles.force(flow, dt, timings)?;
        timings.measure(Module::Forcing, || {
            for b in (0..particles.states.len()).map(BodyId) {
                let [impulse, internal] = particles.impulse(flow, b);
                let now = particles.mass_matrix(b) * particles.velocity(b);
                let given = dt * particles.pull(b) + six(particles.bodies.contact_impulse(b));
                let s = &mut particles.states[b.0];
                s.constraint = now - s.momentum - s.deferred - given;
                s.deferred = impulse;
                s.keep(internal);
                s.hydrodynamic = impulse / dt;
            }
        });
        Ok(())
    }
}
