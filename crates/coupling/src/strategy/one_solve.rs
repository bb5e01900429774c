//! One pressure solution per step, the fluid's reaction foreseen.
use super::{Strategy, sealed};
use crate::particles::{State, six, wrench};
use crate::{CouplingError, FlowSolver, Module, Particles, Timings};
use ibm::Forcing;
use interfaces::{BodyId, Dynamics, Load};
use nalgebra::Vector6;

/// The new velocity from one linear system per body before the forcing, with the fluid's reaction predicted implicitly
/// ([`ibm::Layer`]: M_l, b_l from the velocity u*):
///
/// ```text
/// (M_s + C + M_l) vⁿ⁺¹ = M_s vⁿ + C vⁿ + b_l + I(u*) − Iⁿ + δⁿ + dt [(ρ_s − ρ) V g + C ā] + J_contact
/// ```
///
/// C is a virtual mass that is given back through the last acceleration ā (for light bodies with [`Layer::shared`](ibm::Layer::shared) of
/// fluid that other bodies hold, too), and δⁿ the impulse by which the last prediction missed the true
/// one. One pressure solution per step, stable at any density ratio.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OneSolve {
    /// C as a multiple of the displaced fluid's mass. Unless told, 0.3 for bodies lighter than 0.7 of the fluid, which are unstable without,
    /// and none for others; 0.5 and 1 where forcing and pressure take turns in a step; both twice as large with BDF2. From the condition that velocities may
    /// not alternate, M + 2C > w (A − M_l), A being the fluid's added mass and w = (w₀ − w₁ + w₂)/2: 1, or 2 with BDF2.
    pub virtual_mass: Option<f64>,
}

impl Strategy for OneSolve {}

impl sealed::Strategy for OneSolve {
    fn held(state: &State, _: Vector6<f64>, _: f64, known: bool) -> Load {
        if !known {
            return Load::default();
        }
        Load { wrench: wrench(state.load), added_mass: state.added[0], added_moment: state.added[1] }
    }
}

impl<const D: usize, A: FlowSolver<D>> sealed::Exchange<D, A> for OneSolve {
    fn exchange<F: Forcing, B: Dynamics>(
        particles: &mut Particles<F, B, Self>,
        flow: &mut A,
        dt: f64,
        timings: &mut Timings,
    ) -> Result<(), CouplingError> {
        timings.measure(Module::Forcing, || foresee(particles, flow, dt, particles.strategy.virtual_mass))?;
        particles.force(flow, dt, timings)?;
        timings.measure(Module::Forcing, || {
            for b in 0..particles.states.len() {
                let [impulse, internal] = particles.impulse(flow, BodyId(b));
                let s = &mut particles.states[b];
                s.deferred = impulse - s.foreseen;
                s.keep(internal);
                s.hydrodynamic = impulse / dt;
            }
        });
        Ok(())
    }
}

/// Gives all bodies the velocities that the linear systems foresee.
pub(super) fn foresee<const D: usize, A: FlowSolver<D>, F: Forcing, B: Dynamics, S: Strategy>(
    particles: &mut Particles<F, B, S>,
    flow: &A,
    dt: f64,
    virtual_mass: Option<f64>,
) -> Result<(), CouplingError> {
    for body in (0..particles.states.len()).map(BodyId) {
        solve(particles, body, flow, dt, virtual_mass)
            .ok_or_else(|| CouplingError::Motion { body: particles.known_as(body), time: flow.time() })?;
    }
    Ok(())
}

/// Gives body `b` its velocity at the end of the step, and notes the impulse of the fluid that it foresees.
fn solve<const D: usize, A: FlowSolver<D>, F: Forcing, B: Dynamics, S: Strategy>(
    particles: &mut Particles<F, B, S>,
    b: BodyId,
    flow: &A,
    dt: f64,
    virtual_mass: Option<f64>,
) -> Option<()> {
    let (own, displaced) = (particles.bodies.inertia(b).mass, particles.displaced(b));
    let mut layer = particles.layer(flow.velocity(), b);
    let weights = flow.weights();
    layer.mass *= weights[0];
    layer.momentum *= weights[0];
    let internal = particles.inside(flow.velocity(), b);
    let mass = particles.mass_matrix(b);
    let factor = virtual_mass.unwrap_or_else(|| {
        // How the fluid's inertia weighs against the body's when velocities alternate.
        let weight = 0.5 * (weights[0] - weights[1] + weights[2]);
        // Repeated forcing leaves less of the reaction to be foreseen.
        let [light, factor] = if particles.rounds(flow) > 1 { [1.0, 0.5] } else { [0.7, 0.3] };
        if own < light * weight * displaced { factor * weight } else { 0.0 }
    });
    let mut virtual_mass = mass * (factor * displaced / own);
    if factor > 0.0 {
        virtual_mass += weights[0] * layer.shared;
    }
    let (weight, contact) = (particles.pull(b), six(particles.bodies.contact_impulse(b)));
    // What is not free moves as the bodies say: on as it did, unless they were told otherwise in this step.
    let (freedom, told) = (particles.freedom(b), particles.velocity(b));

    let s = &mut particles.states[b.0];
    let inside = s.inside(weights, internal);
    let (momentum, before) = (s.momentum, s.before);
    let mut matrix = mass + virtual_mass + layer.mass;
    let mut free = momentum
        + virtual_mass * (before + dt * s.acceleration)
        + layer.momentum
        + inside
        + s.deferred
        + dt * weight;
    let mut kick = contact;
    for i in (0..6).filter(|&i| !freedom[i]) {
        matrix.row_mut(i).fill(0.0);
        matrix[(i, i)] = 1.0;
        (free[i], kick[i]) = (told[i], 0.0);
    }
    let lu = matrix.lu();
    let (free, kick) = (lu.solve(&free)?, lu.solve(&kick)?);
    let after = free + kick;
    if !after.iter().all(|v| v.is_finite()) {
        return None;
    }
    // Contacts act again in the next step; what is left of the load is held on to.
    let change = free - before;
    s.added = [
        (virtual_mass[(0, 0)] + (layer.mass[(0, 0)] + layer.mass[(1, 1)]) / 2.0),
        virtual_mass[(5, 5)] + layer.mass[(5, 5)],
    ];
    let added = Vector6::from_fn(|i, _| s.added[i / 3]);
    s.load = (mass * free - momentum + added.component_mul(&change)) / dt;
    let given_back = virtual_mass * (dt * s.acceleration - (after - before));
    s.held -= given_back;
    s.foreseen = layer.momentum - layer.mass * after + inside;
    s.constraint = mass * after - momentum - s.foreseen - s.deferred - dt * weight - contact - given_back;
    s.acceleration = (after - before) / dt;
    particles.set_velocity(b, after);
    Some(())
}
