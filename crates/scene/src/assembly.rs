//! Assembly of a simulation, and the one choice of its types.
use crate::cast::Cast;
use crate::look::{Books, Show};
use crate::physics::Physics;
use crate::run::RunError;
use crate::setup::{Algorithm, ContactLawChoice, ForcingChoice, Setup, StrategyChoice};
use crate::steady::Steady;
use crate::still::Still;
use coupling::{
    CouplingError, Evolving, Exchange, Explicit, FlowSolver, Grains, Immersed, Iterated, Ledger, Particles,
    Schedule, Simulation, Strategy,
};
use dem::{ContactLaw, Population, Rolling};
use ibm::Forcing;
use interfaces::Checkpoint;

/// Use of an assembled simulation: a whole run, or its first steps.
pub(crate) trait Execution {
    /// Result.
    type Output;

    /// Marches in time.
    fn march<S: Show, K: Books<S>>(&self, simulation: S, books: K) -> Result<Self::Output, RunError>;

    /// Iterates to a steady state.
    fn converge<const D: usize>(&self, steady: Steady<D>) -> Result<Self::Output, RunError>;
}

impl Setup {
    /// Assembles the simulation and executes it.
    pub(crate) fn execute<E: Execution>(&self, execution: &E) -> Result<E::Output, RunError> {
        match self.dim() {
            2 => self.assemble::<2, E>(execution),
            _ => self.assemble::<3, E>(execution),
        }
    }

    /// Steps of a simulation at its start.
    pub(crate) fn schedule(&self, simulation: &impl Evolving) -> Schedule {
        let first = self.first_step() / simulation.stable_dt(self.courant).min(self.end);
        Schedule {
            end: self.end,
            intervals: self.output.snapshots.max(1),
            dt: self.dt,
            courant: self.courant,
            ramp: match Schedule::default().ramp {
                [share, growth] if self.ramp => [share.min(first), growth],
                [_, growth] if self.dt.is_none() && first < 1.0 => [first, growth],
                _ => [1.0, 2.0],
            },
        }
    }

    fn assemble<const D: usize, E: Execution>(&self, execution: &E) -> Result<E::Output, RunError> {
        if self.fluid.is_none() {
            return self.grains(execution);
        }
        let bodies = !self.bodies.list.is_empty() || !self.bodies.inflows.is_empty();
        match self.flow.algorithm {
            Algorithm::Simple => return execution.converge(self.steady::<D>()?),
            Algorithm::Piso if bodies => {
                let particles = self.particles(self.hfdib(), self.cast(self.chen())?).with_strategy(Explicit);
                return execution.march(self.simulation(self.piso::<D>()?, particles)?, self.books());
            }
            Algorithm::Piso => {
                return execution.march(self.simulation(self.piso::<D>()?, Still::default())?, ());
            }
            Algorithm::Projection => {}
        }
        if !self.is_forced() {
            let (flow, still) = self.walled::<D>()?;
            return execution.march(self.simulation(flow, still)?, ());
        }
        match self.bodies.forcing() {
            ForcingChoice::Hfdib => self.bodies_by::<D, _, _>(execution, self.hfdib()),
            _ => self.bodies_by::<D, _, _>(execution, self.smooth()),
        }
    }

    /// Bodies without a fluid.
    fn grains<E: Execution>(&self, execution: &E) -> Result<E::Output, RunError> {
        if let Some(repulsion) = self.bodies.repulsion {
            return execution.march(Grains::new(self.cast(self.repulsive(repulsion)?)?), ());
        }
        match self.bodies.law {
            ContactLawChoice::Chen => execution.march(Grains::new(self.cast(self.chen())?), ()),
            ContactLawChoice::Potential => execution.march(Grains::new(self.cast(self.potential())?), ()),
            ContactLawChoice::Rolling => execution.march(Grains::new(self.cast(Rolling(self.chen()))?), ()),
            ContactLawChoice::None => execution.march(Grains::new(self.cast(())?), ()),
        }
    }

    fn bodies_by<const D: usize, F: Forcing, E: Execution>(
        &self,
        execution: &E,
        forcing: F,
    ) -> Result<E::Output, RunError> {
        let flow = self.physics(self.projection::<D>()?)?;
        if let Some(repulsion) = self.bodies.repulsion {
            return self.with_bodies(
                execution,
                flow,
                self.particles(forcing, self.cast(self.repulsive(repulsion)?)?),
            );
        }
        match (self.bodies.law, self.bodies.coupling.strategy, self.bodies.lubrication) {
            (ContactLawChoice::Chen, StrategyChoice::OneSolve, Some(roughness)) => self.with_bodies(
                execution,
                flow,
                self.particles(forcing, self.cast(self.lubricated(roughness)?)?),
            ),
            (ContactLawChoice::Chen, StrategyChoice::Iterated, _) => self.with_bodies(
                execution,
                flow,
                self.particles(forcing, self.cast(self.chen())?).with_strategy(Iterated::default()),
            ),
            (ContactLawChoice::Chen, StrategyChoice::Explicit, _) => self.with_bodies(
                execution,
                flow,
                self.particles(forcing, self.cast(self.chen())?).with_strategy(Explicit),
            ),
            (ContactLawChoice::Chen, ..) => {
                self.with_bodies(execution, flow, self.particles(forcing, self.cast(self.chen())?))
            }
            (ContactLawChoice::Potential, ..) => {
                self.with_bodies(execution, flow, self.particles(forcing, self.cast(self.potential())?))
            }
            (ContactLawChoice::Rolling, ..) => {
                self.with_bodies(execution, flow, self.particles(forcing, self.cast(Rolling(self.chen()))?))
            }
            (ContactLawChoice::None, ..) => {
                self.with_bodies(execution, flow, self.particles(forcing, self.cast(())?))
            }
        }
    }

    /// The books, if they are kept.
    fn books(&self) -> Option<Ledger> {
        self.why_no_books().is_none().then(Ledger::new)
    }

    fn particles<F: Forcing, L: ContactLaw>(&self, forcing: F, cast: Cast<L>) -> Particles<F, Cast<L>>
    where
        Population<L>: Checkpoint,
    {
        let particles = Particles::new(cast, forcing, self.fluid().density, self.gravity);
        match self.bodies.coupling.virtual_mass {
            Some(factor) => particles.with_virtual_mass(factor),
            None => particles,
        }
    }

    fn simulation<const D: usize, P: Immersed<D, A>, A: FlowSolver<D>>(
        &self,
        flow: A,
        particles: P,
    ) -> Result<Simulation<D, P, A>, CouplingError> {
        let simulation = Simulation::new(flow, particles, self.balance)?;
        Ok(match self.force.clone() {
            Some(force) => simulation.with_force(move |t| force.each_ref().map(|f| f.needed(&[t])).into()),
            None => simulation,
        })
    }

    fn with_bodies<const D: usize, F, L, S, E>(
        &self,
        execution: &E,
        flow: Physics<D>,
        particles: Particles<F, Cast<L>, S>,
    ) -> Result<E::Output, RunError>
    where
        F: Forcing,
        L: ContactLaw,
        S: Strategy + Exchange<D, Physics<D>>,
        Population<L>: Checkpoint,
        E: Execution,
    {
        execution.march(self.simulation(flow, particles)?, self.books())
    }
}
