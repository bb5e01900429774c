//! The books of momentum and energy.
use crate::{CouplingError, Observer, Particles, Simulation, StepInfo, Strategy};
use ibm::Forcing;
use interfaces::{BodyId, Checkpoint, Dynamics, RestartError, Twist, Vector};

/// Keeps, step by step, the momentum of fluid and bodies against the impulses on them, the kinetic
/// energy against work and dissipation, and the divergence.
///
/// Momentum: P = ρ∫_Ω u dV − ΣI + Σ(mU + δ), with I the fluid inside a body and δ what is on its
/// way between the two (see [`Particles`]). Impulses: net weight, body force, contacts with walls,
/// what holds bodies that are not free, and what the box's own walls do to the fluid. Energy: E = ½ρ∫_Ω u² + Σ½(1 − ρ/ρ_s)(mU² + ΩIΩ)
/// against the work of net weight, body force and contacts less the viscous dissipation ρν∫|∇u|²
/// (trapezoidal in time).
///
/// The books open where a run begins. Those of an interrupted run go on, bit for bit, if they are saved beside the simulation and restored
/// before the next.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    last: Option<Books>,
    /// How the bodies moved at the last books.
    twists: Vec<Twist>,
    report: LedgerReport,
    /// They go on from a saved state.
    resumed: bool,
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
        if std::mem::take(&mut self.resumed) {
            return;
        }
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

impl LedgerReport {
    /// All numbers.
    const LENGTH: usize = 17;

    fn numbers(&self) -> [f64; Self::LENGTH] {
        let Self { divergence, momentum_step, momentum_total, impulses, in_transit, .. } = *self;
        let Self { work, dissipation, contact_work, energy_residual, .. } = *self;
        let (flow, [before, now], residual) = (self.volume_flow, self.energy, self.residual);
        [
            divergence,
            momentum_step,
            momentum_total,
            impulses,
            in_transit,
            flow.x,
            flow.y,
            flow.z,
            before,
            now,
            work,
            dissipation,
            contact_work,
            energy_residual,
            residual.x,
            residual.y,
            residual.z,
        ]
    }
    fn of(n: &[f64]) -> Self {
        Self {
            divergence: n[0],
            momentum_step: n[1],
            momentum_total: n[2],
            impulses: n[3],
            in_transit: n[4],
            volume_flow: Vector::new(n[5], n[6], n[7]),
            energy: [n[8], n[9]],
            work: n[10],
            dissipation: n[11],
            contact_work: n[12],
            energy_residual: n[13],
            residual: Vector::new(n[14], n[15], n[16]),
        }
    }
}

impl Checkpoint for Ledger {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("report", &self.report.numbers());
        let last = self.last.map(|l| {
            let p = l.momentum;
            [p.x, p.y, p.z, l.energy, l.power, l.dissipation]
        });
        sink("last", last.as_ref().map_or(&[], |l| &l[..]));
        let six = |t: &Twist| [t.linear.x, t.linear.y, t.linear.z, t.angular.x, t.angular.y, t.angular.z];
        sink("twists", &self.twists.iter().flat_map(six).collect::<Vec<_>>());
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let missing = |name: &str| RestartError::Missing(name.into());
        let report = LedgerReport::of(RestartError::take(source, "report", LedgerReport::LENGTH)?);
        let last = source("last").ok_or_else(|| missing("last"))?;
        let twists = source("twists").ok_or_else(|| missing("twists"))?;
        let last = match last {
            [] => None,
            &[x, y, z, energy, power, dissipation] => {
                Some(Books { momentum: Vector::new(x, y, z), energy, power, dissipation })
            }
            other => {
                return Err(RestartError::Length { name: "last".into(), expected: 6, found: other.len() });
            }
        };
        let (rows, rest) = twists.as_chunks::<6>();
        if !rest.is_empty() {
            let (expected, found) = (6 * rows.len(), twists.len());
            return Err(RestartError::Length { name: "twists".into(), expected, found });
        }
        let twists = rows
            .iter()
            .map(|&[x, y, z, a, b, c]| Twist { linear: Vector::new(x, y, z), angular: Vector::new(a, b, c) });
        *self = Self { last, twists: twists.collect(), report, resumed: last.is_some() };
        Ok(())
    }
}
