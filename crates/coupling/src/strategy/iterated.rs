//! Forcing, pressure and bodies in turn until they agree.
use super::one_solve::{OneSolve, foresee};
use super::{Strategy, sealed};
use crate::particles::{State, six};
use crate::{CouplingError, FlowSolver, Module, Particles, Timings};
use fv_mesh::{Prediction, Projection};
use ibm::Forcing;
use interfaces::{BodyId, Dynamics, Load};
use nalgebra::Vector6;

/// Starts like [`OneSolve`], then corrects the bodies' velocities by what their equations of motion leave,
///
/// ```text
/// r = M_s v − M_s vⁿ − J(v) − δⁿ − dt (ρ_s − ρ) V g − J_contact,    v ← v − ω (M_s + M_l + ½ρV)⁻¹ r,
/// ```
///
/// goes back to u* and forces the fluid anew, until |r| is small or `most` rounds are made. ω follows from the last two r of a body
/// (Aitken's relaxation, one for its translation and one for its rotation), begins with 1 and stays between 0.05 and 5. Every round costs a pressure solution. What is left of r is handed on like δ.
#[derive(Clone, Debug)]
pub struct Iterated {
    /// |r| over the sum of what acts on the body, at which it is enough.
    pub tolerance: f64,
    /// Rounds at most, at least 1.
    pub most: usize,
    /// Rounds of the last step.
    rounds: usize,
    prediction: Prediction,
}

impl Default for Iterated {
    fn default() -> Self {
        Self::new(1e-3, 20)
    }
}

impl Iterated {
    /// Until |r| is at most `tolerance` of what acts on every body, in `most` rounds.
    pub fn new(tolerance: f64, most: usize) -> Self {
        Self { tolerance, most, rounds: 0, prediction: Prediction::default() }
    }
    /// Rounds that the last step took.
    pub fn rounds(&self) -> usize {
        self.rounds
    }
}

impl Strategy for Iterated {}

/// Bounds of ω.
const RELAXATION: [f64; 2] = [0.05, 5.0];

impl sealed::Strategy for Iterated {
    fn held(state: &State, weight: Vector6<f64>, dt: f64, known: bool) -> Load {
        OneSolve::held(state, weight, dt, known)
    }
}

/// The flow has to go back to u*, as a projection can.
impl<const D: usize, A> sealed::Exchange<D, A> for Iterated
where
    A: FlowSolver<D> + AsRef<Projection<D>> + AsMut<Projection<D>>,
{
    fn exchange<F: Forcing, B: Dynamics>(
        particles: &mut Particles<F, B, Self>,
        flow: &mut A,
        dt: f64,
        timings: &mut Timings,
    ) -> Result<(), CouplingError> {
        timings.measure(Module::Forcing, || foresee(particles, flow, dt, Some(0.0)))?;
        let Self { tolerance, most, .. } = particles.strategy;
        flow.as_ref().note(&mut particles.strategy.prediction);
        let n = particles.states.len();
        let mut round = 0;
        loop {
            particles.force(flow, dt, timings)?;
            round += 1;
            let agreed = timings.measure(Module::Forcing, || {
                (0..n).filter(|&b| !particles.compare(flow, BodyId(b), dt, tolerance)).count() == 0
            });
            if agreed || round >= most {
                break;
            }
            (0..n).for_each(|b| particles.correct(BodyId(b), dt, round == 1));
            flow.as_mut().go_back(&particles.strategy.prediction);
            particles.forcing.place(flow.velocity(), &particles.bodies)?;
        }
        particles.strategy.rounds = round;
        for b in (0..n).map(BodyId) {
            let (now, reaction) = (particles.velocity(b), six(particles.forcing.reaction(b)));
            let s = &mut particles.states[b.0];
            s.acceleration = (now - s.before) / dt;
            s.deferred = -s.residuals[0];
            s.keep(s.internal[0] + s.foreseen - reaction);
            s.hydrodynamic = s.foreseen / dt;
        }
        Ok(())
    }
}

impl<F: Forcing, B: Dynamics> Particles<F, B, Iterated> {
    /// The diagonal of M_s + M_l + ½ρV, as far as it is known.
    fn resistance(&self, b: BodyId) -> Vector6<f64> {
        let (mass, s) = (self.mass_matrix(b), &self.states[b.0]);
        let around = 1.0 + 0.5 * self.displaced(b) / self.bodies.inertia(b).mass;
        Vector6::from_fn(|i, _| mass[(i, i)] * around + s.added[i / 3])
    }

    /// Notes J and what the equation of motion of body `b` leaves; is that little?
    fn compare<const D: usize, A: FlowSolver<D>>(
        &mut self,
        flow: &A,
        b: BodyId,
        dt: f64,
        tolerance: f64,
    ) -> bool {
        let [impulse, _] = self.impulse(flow, b);
        let now = self.mass_matrix(b) * self.velocity(b);
        let (weight, contact) = (dt * self.pull(b), six(self.bodies.contact_impulse(b)));
        let (freedom, resistance) = (self.freedom(b), self.resistance(b));
        let s = &mut self.states[b.0];
        let left = now - s.momentum - impulse - s.deferred - weight - contact;
        s.foreseen = impulse;
        s.constraint = Vector6::from_fn(|i, _| if freedom[i] { 0.0 } else { left[i] });
        s.residuals = [left - s.constraint, s.residuals[0]];
        let all = impulse.abs() + weight.abs() + contact.abs() + s.deferred.abs();
        product(&s.residuals[0], &s.residuals[0], &resistance)
            <= tolerance * tolerance * product(&all, &all, &resistance)
    }

    /// Gives body `b` the velocity by which less should be left.
    fn correct(&mut self, b: BodyId, dt: f64, first: bool) {
        let (resistance, mass) = (self.resistance(b), self.mass_matrix(b));
        let s = &mut self.states[b.0];
        let [now, last] = &s.residuals;
        let change = now - last;
        // Translation and rotation drag different shares of the fluid along.
        for (part, relaxation) in s.relaxation.iter_mut().enumerate() {
            let of = |a: &Vector6<f64>, b: &Vector6<f64>| {
                (3 * part..3 * part + 3).map(|i| a[i] * b[i] / resistance[i]).sum::<f64>()
            };
            let curved = of(&change, &change);
            *relaxation = if first || curved == 0.0 {
                1.0
            } else {
                (-*relaxation * of(last, &change) / curved).clamp(RELAXATION[0], RELAXATION[1])
            };
        }
        let step = Vector6::from_fn(|i, _| -s.relaxation[i / 3] * now[i] / resistance[i]);
        let added = Vector6::from_fn(|i, _| s.added[i / 3]);
        s.load += (mass * step + added.component_mul(&step)) / dt;
        let velocity = self.velocity(b) + step;
        self.set_velocity(b, velocity);
    }
}

/// a·b, weighted as energies are.
fn product(a: &Vector6<f64>, b: &Vector6<f64>, resistance: &Vector6<f64>) -> f64 {
    a.component_div(resistance).dot(b)
}
