//! The books of momentum and energy.
use crate::accounts::accounts;
use crate::particles::Stake;
use crate::{Accounts, CouplingError, FlowSolver, Immersed, Observer, Simulation, StepInfo};
use fv_mesh::SidePower;
use interfaces::{BodyId, Checkpoint, RestartError, Vector};

/// Keeps, step by step, the momentum of fluid and bodies against the impulses on them, the kinetic
/// energy against work and dissipation, and the divergence.
///
/// Momentum: P = ρ∫_Ω u dV − ΣI + Σ(mU + δ), with I the fluid inside a body and δ what is on its
/// way between the two (see [`Particles`](crate::Particles)). Impulses: net weight, forces of the body of the fluid, contacts with walls,
/// what holds or drives bodies that are not free, what the box's own sides do to the fluid, and an eddy viscosity's friction there.
///
/// Energy: E = ½ρ∫_Ω u² + Σ½(1 − ρ/ρ_s)(mU² + ΩIΩ). With v̄ = ½(vⁿ + vⁿ⁺¹) of a body and ū = ½(uⁿ + uⁿ⁺¹) of the fluid a step makes
///
/// ```text
/// ΔE = W + W_sides + Σ v̄·(J_contact + J_held) + Σ [v̄·Δ(I − δ) − Δ½(ρ/ρ_s)(mU² + ΩIΩ)] − D − D_t − (hidden + lost)
/// hidden + lost = ∫ f_ib·(v̄ − ū) dV dt
/// ```
///
/// W is the work of net weight and forces, W_sides that of the sides, the bracket the [work inside](LedgerReport::inner_work), D = ∫ρν∫|∇u|² dV dt (trapezoidal, as W is), D_t what an eddy viscosity
/// takes; the last two are what the forcing [hides](ibm::Forcing::hidden_dissipation) of the dissipation, in D, and [loses](ibm::Forcing::inelastic_loss). All are measured by themselves; what is left is of second order in the step for
/// a [`Projection`](fv_mesh::Projection) with central convection from a smooth start, and else what a scheme takes by itself: upwind convection, Euler's scheme in time, boundary values that jump (first order), forcings that do not tell their loss
/// ([`Hfdib`](ibm::Hfdib)).
///
/// What bodies bring that are put into the flow, and take along that are taken out, is no residual. The fluid that a [`MovingWindow`](crate::MovingWindow) leaves behind is. Momentum of a
/// [`Piso`](fv_mesh::Piso) is kept to its tolerances by Euler's scheme,
/// between walls to what its last correction leaves; by BDF2 it is not a difference of two times, and the books do not close. Walls by cut links are not in the books.
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
    /// ρ∫u over what uniform forces act on \[kg m/s\].
    moved: Vector,
    /// Power of net weight \[W\].
    power: f64,
    dissipation: f64,
    /// Of the sides: power of what they carry \[W\], and energy of their own nodes \[J\].
    sides: [f64; 2],
}

/// What the books say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LedgerReport {
    /// Largest |∇·u| of any step \[1/s\], times the step's length.
    pub divergence: f64,
    /// Largest momentum residual of a step, relative to that step's Σ|impulse|, or to 1.5e-8 (half of the digits) of the momentum where impulses on a fluid that
    /// moves cancel.
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
    /// Work of net weight and of forces of the body of the fluid, buoyancy for one \[J\].
    pub work: f64,
    /// Work of the sides of the box \[J\]: what enters and leaves, and walls that move.
    pub side_work: f64,
    /// Work of what holds or drives bodies that are not free, and of the motion that surfaces have of their own \[J\].
    pub driving_work: f64,
    /// Work of bodies on the fluid inside them beyond what a rigid body would take, and on what is on its way, Σ v̄·Δ(I − δ) − Δ½(ρ/ρ_s)(mU² + ΩIΩ) \[J\]: that fluid lags behind
    /// bodies that turn, and takes ρVU² of a body put into fluid at rest with the speed U.
    pub inner_work: f64,
    /// Viscous dissipation \[J\].
    pub dissipation: f64,
    /// What an eddy viscosity took \[J\].
    pub eddy_dissipation: f64,
    /// What the forcing took of the kinetic energy, numerically or where a body meets the fluid with another velocity: see [`Forcing::inelastic_loss`](ibm::Forcing::inelastic_loss) \[J\].
    pub forcing_loss: f64,
    /// Work of contacts on the bodies \[J\]: negative while it is stored or lost in them.
    pub contact_work: f64,
    /// Kinetic energy that bodies brought which came, less what those took along that went \[J\].
    pub brought: f64,
    /// Energy gained − all work + both dissipations + the forcing's loss − brought \[J\].
    pub energy_residual: f64,
    residual: Vector,
}

/// Half of the digits of a number, √ε.
const HALF_DIGITS: f64 = 1.5e-8;

/// The volume of the fluid whose velocity along each axis is an unknown \[m³\]: the nodes on bounded sides are not.
fn moved<const D: usize>(flow: &impl FlowSolver<D>) -> Vector {
    let grid = flow.grid();
    Vector::from_fn(|a, _| {
        if a >= D || flow.sides().periodic(a) {
            return grid.volume();
        }
        let axis = grid.axis(a);
        let ends = 0.5 * (axis.width(0) + axis.width(axis.cells() - 1));
        grid.volume() * (1.0 - ends / axis.length())
    })
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

    fn note_stakes(&mut self, immersed: &impl Accounts) {
        std::mem::swap(&mut self.stakes, &mut self.last_stakes);
        self.stakes.clear();
        self.stakes.extend(accounts(immersed).filter_map(|(_, one)| Some((one.serial?, one.stake))));
    }

    /// What those brought that came since the last books, less what those had that went.
    fn turnover(&mut self, immersed: &impl Accounts) -> Stake {
        self.note_stakes(immersed);
        let mut brought = Stake::default();
        // Both lists ascend.
        let mut old = self.last_stakes.iter().peekable();
        for (b, (serial, _)) in self.stakes.iter().enumerate() {
            while let Some((_, gone)) = old.next_if(|(s, _)| s < serial) {
                brought.momentum -= gone.momentum;
                brought.energy -= gone.energy;
            }
            if old.next_if(|(s, _)| s == serial).is_none() {
                let new = immersed.account(BodyId(b)).brought;
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

    fn balance<const D: usize, P: Accounts, A: FlowSolver<D>>(
        simulation: &mut Simulation<D, P, A>,
    ) -> (Books, LedgerReport, SidePower) {
        let flow = simulation.flow.statistics();
        let (sides, density) = (simulation.flow.side_power(), simulation.flow.fluid().density);
        let mut report = LedgerReport { volume_flow: flow.volume_flow, ..LedgerReport::default() };
        let moved = density * (flow.volume_flow - sides.given_flow);
        let mut books = Books {
            momentum: moved,
            moved,
            energy: flow.kinetic_energy,
            power: 0.0,
            dissipation: flow.dissipation,
            sides: [sides.carried, sides.given],
        };
        for (_, one) in accounts(&simulation.particles) {
            books.momentum += one.stake.momentum;
            books.energy += one.stake.energy;
            books.power += one.weight.dot(&one.twists[1].linear);
            report.in_transit += one.in_transit;
        }
        report.divergence = flow.divergence;
        (books, report, sides)
    }
}

/// Per mass \[m/s²\], of the last step.
fn uniform_force<const D: usize, P, A: FlowSolver<D>>(simulation: &Simulation<D, P, A>) -> Vector {
    let own = simulation.flow.own_force();
    simulation.body_force() + Vector::from_fn(|a, _| own.get(a).copied().unwrap_or(0.0))
}

impl<const D: usize, P, A> Observer<Simulation<D, P, A>> for Ledger
where
    P: Accounts + Immersed<D, A>,
    A: FlowSolver<D>,
{
    fn begin(&mut self, simulation: &mut Simulation<D, P, A>) {
        simulation.flow.keep_books();
        if std::mem::take(&mut self.resumed) {
            return;
        }
        let (books, report, _) = Self::balance(simulation);
        self.report = LedgerReport { energy: [books.energy; 2], divergence: 0.0, ..report };
        self.last = Some(books);
        self.note_stakes(&simulation.particles);
    }

    fn step(&mut self, simulation: &mut Simulation<D, P, A>, info: &StepInfo) -> Result<(), CouplingError> {
        let (books, now, sides) = Self::balance(simulation);
        let Some(last) = self.last.replace(books) else { return Ok(()) };
        let dt = info.dt;
        let (flow, immersed) = (&simulation.flow, &simulation.particles);
        let acceleration = uniform_force(simulation);
        let body_force = dt * flow.fluid().density * moved(flow).component_mul(&acceleration);
        let (walls, sources) = (flow.wall_impulse(), flow.source_work());
        let brought = self.turnover(immersed);
        let (mut contacts, mut weight, mut held) = (Vector::zeros(), Vector::zeros(), Vector::zeros());
        let (mut contact_work, mut driving_work, mut inner_work, mut sum) = (0.0, 0.0, 0.0, 0.0);
        for (_, one) in accounts(immersed) {
            contacts += one.contact.force;
            weight += dt * one.weight;
            held += one.held.force;
            contact_work += one.work(one.contact);
            driving_work += one.work(one.held);
            inner_work += one.work(one.inner) - one.carried;
            sum += one.contact.force.norm();
        }
        let impulse = weight + body_force + sources.impulse + contacts + walls + held;
        sum += weight.norm() + body_force.norm() + sources.impulse.norm() + walls.norm() + held.norm();
        let residual = books.momentum - last.momentum - brought.momentum - impulse;

        let surfaces = immersed.surface_work();
        let hidden = immersed.hidden_dissipation();
        let before: [&[f64]; D] = std::array::from_fn(|c| flow.before(c).data());
        let lost = simulation.particles.inelastic_loss(&before, flow.velocity());

        let r = &mut self.report;
        r.forcing_loss += lost;
        r.residual += residual;
        r.impulses += sum;
        let scale = sum.max(HALF_DIGITS * books.momentum.norm());
        if scale > 0.0 {
            r.momentum_step = r.momentum_step.max(residual.norm() / scale);
        }
        r.momentum_total = r.residual.norm() / r.impulses.max(f64::MIN_POSITIVE);
        r.divergence = r.divergence.max(now.divergence * dt);
        (r.in_transit, r.volume_flow) = (now.in_transit, now.volume_flow);
        r.work += 0.5 * dt * (last.power + books.power + acceleration.dot(&(last.moved + books.moved)));
        r.work += sources.work;
        r.side_work += 0.5 * dt * (last.sides[0] + books.sides[0]) + dt * sides.pressure;
        r.side_work += books.sides[1] - last.sides[1];
        r.driving_work += driving_work + surfaces;
        r.inner_work += inner_work;
        r.dissipation += 0.5 * dt * (last.dissipation + books.dissipation) + hidden;
        r.eddy_dissipation += sources.eddy_dissipation;
        r.contact_work += contact_work;
        r.brought += brought.energy;
        r.energy[1] = books.energy;
        let gained = r.energy[1] - r.energy[0] - r.brought;
        let work = r.work + r.side_work + r.driving_work + r.contact_work + r.inner_work;
        r.energy_residual = gained - work + r.dissipation + r.eddy_dissipation + r.forcing_loss;
        Ok(())
    }
}

impl LedgerReport {
    /// All numbers.
    const LENGTH: usize = 23;

    fn numbers(&self) -> [f64; Self::LENGTH] {
        let Self { divergence, momentum_step, momentum_total, impulses, in_transit, .. } = *self;
        let Self { work, dissipation, contact_work, energy_residual, brought, .. } = *self;
        let Self { side_work, driving_work, inner_work, eddy_dissipation, forcing_loss, .. } = *self;
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
            side_work,
            driving_work,
            eddy_dissipation,
            inner_work,
            forcing_loss,
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
            side_work: n[18],
            driving_work: n[19],
            eddy_dissipation: n[20],
            inner_work: n[21],
            forcing_loss: n[22],
        }
    }
}

impl Checkpoint for Ledger {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("report", &self.report.numbers());
        let last = self.last.map(|l| {
            let (p, m) = (l.momentum, l.moved);
            [p.x, p.y, p.z, m.x, m.y, m.z, l.energy, l.power, l.dissipation, l.sides[0], l.sides[1]]
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
            &[x, y, z, u, v, w, energy, power, dissipation, carried, given] => {
                let (momentum, moved) = (Vector::new(x, y, z), Vector::new(u, v, w));
                Some(Books { momentum, moved, energy, power, dissipation, sides: [carried, given] })
            }
            other => {
                return Err(RestartError::Length { name: "last".into(), expected: 11, found: other.len() });
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
