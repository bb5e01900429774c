//! The books of momentum and energy.
use crate::particles::Stake;
use crate::{CouplingError, FlowSolver, Observer, Particles, Simulation, StepInfo, Strategy};
use ibm::Forcing;
use interfaces::{BodyId, Checkpoint, Dynamics, RestartError, Vector};

/// Keeps, step by step, the momentum of fluid and bodies against the impulses on them, the kinetic
/// energy against work and dissipation, and the divergence.
///
/// Momentum: P = ρ∫_Ω u dV − ΣI + Σ(mU + δ), with I the fluid inside a body and δ what is on its
/// way between the two (see [`Particles`]). Impulses: net weight, body force, contacts with walls,
/// what holds bodies that are not free, and what the box's own walls do to the fluid. Energy: E = ½ρ∫_Ω u² + Σ½(1 − ρ/ρ_s)(mU² + ΩIΩ)
/// against the work of net weight, body force and contacts less the viscous dissipation ρν∫|∇u|²
/// (trapezoidal in time) and what the forcing [hides](ibm::Forcing::hidden_dissipation). What bodies bring that are put into the flow, and take along that are taken out, is no residual. (The fluid that a [`MovingWindow`](crate::MovingWindow) leaves behind is, and so is what a [`Hooked`](fv_mesh::Hooked) flow's own hooks do: forces that differ
/// from place to place, an eddy viscosity. Momentum of a [`Piso`](fv_mesh::Piso) is kept to its tolerances by Euler's scheme,
/// between walls to what its last correction leaves; by BDF2 it is not a difference of two times, and the books do not close.)
///
/// The books open where a run begins. Those of an interrupted run go on, bit for bit, if they are saved beside the simulation and restored
/// before the next.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    last: Option<Books>,
    /// What every body, by its serial number, had of it; and before.
    stakes: Vec<(u64, Stake)>,
    last_stakes: Vec<(u64, Stake)>,
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
    /// Kinetic energy that bodies brought which came, less what those took along that went \[J\].
    pub brought: f64,
    /// Energy gained − work − contact work + dissipation − brought \[J\].
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

    fn note_stakes<F: Forcing, B: Dynamics, S: Strategy>(&mut self, particles: &Particles<F, B, S>) {
        std::mem::swap(&mut self.stakes, &mut self.last_stakes);
        let ids = (0..particles.bodies.n_bodies()).map(BodyId);
        self.stakes.clear();
        self.stakes.extend(ids.filter_map(|b| Some((particles.serial(b)?, particles.stake(b)))));
    }

    /// What those brought that came since the last books, less what those had that went.
    fn turnover<F: Forcing, B: Dynamics, S: Strategy>(&mut self, particles: &Particles<F, B, S>) -> Stake {
        self.note_stakes(particles);
        let mut brought = Stake::default();
        // Both lists ascend.
        let mut old = self.last_stakes.iter().peekable();
        for (b, (serial, _)) in self.stakes.iter().enumerate() {
            while let Some((_, gone)) = old.next_if(|(s, _)| s < serial) {
                brought.momentum -= gone.momentum;
                brought.energy -= gone.energy;
            }
            if old.next_if(|(s, _)| s == serial).is_none() {
                let new = particles.stake_brought(BodyId(b));
                brought.momentum += new.momentum;
                brought.energy += new.energy;
            }
        }
        for (_, gone) in old {
            brought.momentum -= gone.momentum;
            brought.energy -= gone.energy;
        }
        brought
    }

    fn balance<const D: usize, F: Forcing, B: Dynamics, S: Strategy, A: FlowSolver<D>>(
        simulation: &mut Simulation<D, Particles<F, B, S>, A>,
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
            let Stake { momentum, energy } = particles.stake(b);
            books.momentum += momentum;
            books.energy += energy;
            books.power += particles.weight(b).dot(&particles.bodies.twist(b).linear);
            report.in_transit += particles.momentum_in_transit(b).force.norm();
        }
        report.divergence = flow.divergence;
        (books, report)
    }
}

impl<const D: usize, F, B, S, A> Observer<Simulation<D, Particles<F, B, S>, A>> for Ledger
where
    F: Forcing,
    B: Dynamics,
    S: Strategy,
    A: FlowSolver<D>,
{
    fn begin(&mut self, simulation: &mut Simulation<D, Particles<F, B, S>, A>) {
        if std::mem::take(&mut self.resumed) {
            return;
        }
        let (books, report) = Self::balance(simulation);
        self.report = LedgerReport { energy: [books.energy; 2], divergence: 0.0, ..report };
        self.last = Some(books);
        self.note_stakes(&simulation.particles);
    }

    fn step(
        &mut self,
        simulation: &mut Simulation<D, Particles<F, B, S>, A>,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let (books, now) = Self::balance(simulation);
        let Some(last) = self.last.replace(books) else { return Ok(()) };
        let dt = info.dt;
        let (flow, particles) = (&simulation.flow, &simulation.particles);
        let body_force = dt * flow.fluid().density * flow.grid().volume() * simulation.body_force();
        let walls = flow.wall_impulse();
        let brought = self.turnover(particles);
        let (mut contacts, mut weight, mut held) = (Vector::zeros(), Vector::zeros(), Vector::zeros());
        let (mut contact_work, mut sum) = (0.0, 0.0);
        for b in (0..particles.bodies.n_bodies()).map(BodyId) {
            let (impulse, twist) = (particles.bodies.contact_impulse(b), particles.bodies.twist(b));
            contacts += impulse.force;
            weight += dt * particles.weight(b);
            held += particles.constraint_impulse(b).force;
            // What an impulse does to the kinetic energy: its product with the mean velocity.
            let before = particles.twist_before(b);
            contact_work += 0.5 * impulse.force.dot(&(before.linear + twist.linear));
            contact_work += 0.5 * impulse.torque.dot(&(before.angular + twist.angular));
            sum += impulse.force.norm();
        }
        let hidden = particles.forcing.hidden_dissipation();
        let impulse = weight + body_force + contacts + walls + held;
        sum += weight.norm() + body_force.norm() + walls.norm() + held.norm();
        let residual = books.momentum - last.momentum - brought.momentum - impulse;

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
        r.dissipation += 0.5 * dt * (last.dissipation + books.dissipation) + hidden;
        r.contact_work += contact_work;
        r.brought += brought.energy;
        r.energy[1] = books.energy;
        r.energy_residual = r.energy[1] - r.energy[0] - r.work - r.contact_work + r.dissipation - r.brought;
        Ok(())
    }
}

impl LedgerReport {
    /// All numbers.
    const LENGTH: usize = 18;

    fn numbers(&self) -> [f64; Self::LENGTH] {
        let Self { divergence, momentum_step, momentum_total, impulses, in_transit, .. } = *self;
        let Self { work, dissipation, contact_work, energy_residual, brought, .. } = *self;
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
            brought,
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
            brought: n[17],
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
        let row =
            |(serial, s): &(u64, Stake)| [*serial as f64, s.momentum.x, s.momentum.y, s.momentum.z, s.energy];
        sink("stakes", &self.stakes.iter().flat_map(row).collect::<Vec<_>>());
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        let missing = |name: &str| RestartError::Missing(name.into());
        let report = LedgerReport::of(RestartError::take(source, "report", LedgerReport::LENGTH)?);
        let last = source("last").ok_or_else(|| missing("last"))?;
        let stakes = source("stakes").ok_or_else(|| missing("stakes"))?;
        let last = match last {
            [] => None,
            &[x, y, z, energy, power, dissipation] => {
                Some(Books { momentum: Vector::new(x, y, z), energy, power, dissipation })
            }
            other => {
                return Err(RestartError::Length { name: "last".into(), expected: 6, found: other.len() });
            }
        };
        let (rows, rest) = stakes.as_chunks::<5>();
        if !rest.is_empty() {
            let (expected, found) = (5 * rows.len(), stakes.len());
            return Err(RestartError::Length { name: "stakes".into(), expected, found });
        }
        let row =
            |&[s, x, y, z, energy]: &[f64; 5]| (s as u64, Stake { momentum: Vector::new(x, y, z), energy });
        let stakes = rows.iter().map(row).collect();
        *self = Self { last, stakes, last_stakes: Vec::new(), report, resumed: last.is_some() };
        Ok(())
    }
}
