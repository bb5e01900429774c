//! The books of momentum and energy.
use crate::{CouplingError, Observer, Particles, Simulation, StepInfo, Strategy};
use ibm::Forcing;
use interfaces::{BodyId, Dynamics, Twist, Vector};

/// Keeps, step by step, the momentum of fluid and bodies against the impulses on them, the kinetic
/// energy against work and dissipation, and the divergence.
///
/// Momentum: P = ρ∫_Ω u dV − ΣI + Σ(mU + δ), with I the fluid inside a body and δ what is on its
/// way between the two (see [`Particles`]). Impulses: net weight, body force, contacts with walls,
/// what holds bodies that are not free, and what the box's own walls do to the fluid. Energy: E = ½ρ∫_Ω u² + Σ½(1 − ρ/ρ_s)(mU² + ΩIΩ)
/// against the work of net weight, body force and contacts less the viscous dissipation ρν∫|∇u|²
/// (trapezoidal in time).
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    last: Option<Books>,
    /// How the bodies moved at the last books.
    twists: Vec<Twist>,
    report: LedgerReport,
}

/// The state of the books after a step.
#[derive(Clone, Copy, Debug, Default)]
struct Books {
    momentum: Vector,
    energy: f64,
    /// Power of net weight and body force \[W\].
    power: f64,
    dissipation: f64,
}

/// What the books say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LedgerReport {
    /// Largest |∇·u| of any step \[1/s\], times the step's length.
    pub divergence: f64,
    /// Largest momentum residual of a step, relative to that step's Σ|impulse|.
    pub momentum_step: f64,
    /// Momentum gained − impulses over all steps, relative to Σ|impulse| of all steps.
    pub momentum_total: f64,
    /// Σ|impulse| \[N s\].
    pub impulses: f64,
    /// Momentum on its way between fluid and bodies \[N s\], now.
    pub in_transit: f64,
    /// ∫_Ω u dV over fluid and solid \[m⁴/s\] (plane: m³/s per metre), now.
    pub volume_flow: Vector,
    /// Kinetic energy \[J\] at the start and now.
    pub energy: [f64; 2],
    /// Work of net weight and body force \[J\].
    pub work: f64,
    /// Viscous dissipation \[J\].
    pub dissipation: f64,
    /// Work of contacts on the bodies \[J\]: negative while it is stored or lost in them.
    pub contact_work: f64,
    /// Energy gained − work − contact work + dissipation \[J\].
    pub energy_residual: f64,
    residual: Vector,
}

impl Ledger {
    /// Empty books.
    pub fn new() -> Self {
        Self::default()
    }
    /// What they say.
    pub fn report(&self) -> &LedgerReport {
        &self.report
    }

    fn balance<const D: usize, F: Forcing, B: Dynamics, S: Strategy>(
        simulation: &mut Simulation<D, Particles<F, B, S>>,
    ) -> (Books, LedgerReport) {
        let force = simulation.body_force();
        let flow = simulation.flow.statistics();
        let (particles, density) = (&simulation.particles, simulation.flow.fluid().density);
        let mut report = LedgerReport { volume_flow: flow.volume_flow, ..LedgerReport::default() };
        let mut books = Books {
            momentum: density * flow.volume_flow,
            energy: flow.kinetic_energy,
            power: density * force.dot(&flow.volume_flow),
            dissipation: flow.dissipation,
        };
        for b in (0..particles.bodies.n_bodies()).map(BodyId) {
            let (inertia, twist) = (particles.bodies.inertia(b), particles.bodies.twist(b));
            let turned = particles.bodies.pose(b).orientation.inverse_transform_vector(&twist.angular);
            let moving = inertia.mass * twist.linear.norm_squared() + turned.dot(&(inertia.tensor * turned));
            let displaced = density * inertia.volume;
            let transit = particles.momentum_in_transit(b).force;
            books.momentum += inertia.mass * twist.linear + transit - particles.internal_momentum(b).force;
            books.energy += 0.5 * (1.0 - displaced / inertia.mass) * moving;
            books.power += (inertia.mass - displaced) * particles.gravity().dot(&twist.linear);
            report.in_transit += transit.norm();
        }
        report.divergence = flow.divergence;
        (books, report)
    }
}

impl<const D: usize, F: Forcing, B: Dynamics, S: Strategy> Observer<Simulation<D, Particles<F, B, S>>>
    for Ledger
{
    fn begin(&mut self, simulation: &mut Simulation<D, Particles<F, B, S>>) {
        let (books, report) = Self::balance(simulation);
        self.report = LedgerReport { energy: [books.energy; 2], divergence: 0.0, ..report };
        self.last = Some(books);
        let bodies = &simulation.particles.bodies;
        self.twists = (0..bodies.n_bodies()).map(|b| bodies.twist(BodyId(b))).collect();
    }

    fn step(
        &mut self,
        simulation: &mut Simulation<D, Particles<F, B, S>>,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let (books, now) = Self::balance(simulation);
        let Some(last) = self.last.replace(books) else { return Ok(()) };
        let dt = info.dt;
        let (flow, particles) = (&simulation.flow, &simulation.particles);
        let body_force = dt * flow.fluid().density * flow.grid().volume() * simulation.body_force();
        let walls = flow.wall_impulse();
        self.twists.resize(particles.bodies.n_bodies(), Twist::default());
        let (mut contacts, mut weight, mut held) = (Vector::zeros(), Vector::zeros(), Vector::zeros());
        let (mut contact_work, mut sum) = (0.0, 0.0);
        for b in (0..particles.bodies.n_bodies()).map(BodyId) {
            let (impulse, twist) = (particles.bodies.contact_impulse(b), particles.bodies.twist(b));
            contacts += impulse.force;
            weight += dt * particles.weight(b);
            held += particles.constraint_impulse(b).force;
            // What an impulse does to the kinetic energy: its product with the mean velocity.
            let before = std::mem::replace(&mut self.twists[b.0], twist);
            contact_work += 0.5 * impulse.force.dot(&(before.linear + twist.linear));
            contact_work += 0.5 * impulse.torque.dot(&(before.angular + twist.angular));
            sum += impulse.force.norm();
        }
        let impulse = weight + body_force + contacts + walls + held;
        sum += weight.norm() + body_force.norm() + walls.norm() + held.norm();
        let residual = books.momentum - last.momentum - impulse;

        let r = &mut self.report;
        r.residual += residual;
        r.impulses += sum;
        if sum > 0.0 {
            r.momentum_step = r.momentum_step.max(residual.norm() / sum);
        }
        r.momentum_total = r.residual.norm() / r.impulses.max(f64::MIN_POSITIVE);
        r.divergence = r.divergence.max(now.divergence * dt);
        (r.in_transit, r.volume_flow) = (now.in_transit, now.volume_flow);
        r.work += 0.5 * dt * (last.power + books.power);
        r.dissipation += 0.5 * dt * (last.dissipation + books.dissipation);
        r.contact_work += contact_work;
        r.energy[1] = books.energy;
        r.energy_residual = r.energy[1] - r.energy[0] - r.work - r.contact_work + r.dissipation;
        Ok(())
    }
}
