//! How flow and bodies learn of each other.
mod explicit;
mod iterated;
mod one_solve;

use crate::particles::State;
use crate::{CouplingError, FlowSolver, Particles, Timings};
use ibm::Forcing;
use interfaces::{Dynamics, Load};
use nalgebra::Vector6;

pub use explicit::Explicit;
pub use iterated::Iterated;
pub use one_solve::OneSolve;

/// A coupling of bodies with a flow. It has no state of its own: what is known of a body is kept by [`Particles`].
///
/// | | pressure solutions per step | stable for | impulse of the fluid reaches the body |
/// |---|---|---|---|
/// | [`OneSolve`] | 1 | any density ratio | within the step, what was not foreseen a step later |
/// | [`Iterated`] | as many as it takes | any density ratio | within the step, to a tolerance |
/// | [`Explicit`] | 1 | bodies a good deal heavier than the fluid | a step later |
pub trait Strategy: sealed::Strategy {}

/// A strategy that works with the flow `A`.
pub trait Exchange<const D: usize, A: FlowSolver<D>>: Strategy + sealed::Exchange<D, A> {}

impl<const D: usize, A: FlowSolver<D>, S: Strategy + sealed::Exchange<D, A>> Exchange<D, A> for S {}

pub(crate) mod sealed {
    use super::*;

    pub trait Strategy: Sized + Send {
        /// What a body feels while it is moved through a step of `dt`. `known`: is the last step a guide?
        fn held(state: &State, weight: Vector6<f64>, dt: f64, known: bool) -> Load;
    }

    pub trait Exchange<const D: usize, A: FlowSolver<D>>: Strategy {
        /// With the bodies at their new places, gives them and the fluid their new velocities.
        fn exchange<F: Forcing, B: Dynamics>(
            particles: &mut Particles<F, B, Self>,
            flow: &mut A,
            dt: f64,
            timings: &mut Timings,
        ) -> Result<(), CouplingError>
        where
            Self: super::Strategy;
    }
}
