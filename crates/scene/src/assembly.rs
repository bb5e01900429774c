//! Assembly of a simulation, and the one choice of its types.
use crate::any_simulation::{AnySimulation, Budget, Viewed, Windowed, WithBudget};
use crate::build_error::BuildError;
use crate::cast::Cast;
use crate::physics::Physics;
use crate::run::RunError;
use crate::setup::{Algorithm, ForcingChoice, Setup, StrategyChoice};
use crate::steady::Steady;
use crate::still::Still;
use coupling::{
    CouplingError, Evolving, Exchange, Explicit, FlowRate, FlowSolver, Grains, Immersed, Iterated, Ledger,
    MovingWindow, Particles, Schedule, Simulation, Strategy,
};
use ibm::Forcing;

/// Simulation of a scene.
pub(crate) enum Assembled {
    /// To be marched in time.
    Unsteady(Box<dyn AnySimulation>),
    /// To be iterated to a steady state.
    Steady2(Box<Steady<2>>),
    Steady3(Box<Steady<3>>),
}

impl From<Steady<2>> for Assembled {
    fn from(flow: Steady<2>) -> Self {
        Self::Steady2(Box::new(flow))
    }
}

impl From<Steady<3>> for Assembled {
    fn from(flow: Steady<3>) -> Self {
        Self::Steady3(Box::new(flow))
    }
}

/// Simulation to be marched in time, with its budget or `()`.
fn unsteady<S: Viewed + 'static, K: Budget<S> + 'static>(simulation: S, budget: K) -> Assembled {
    Assembled::Unsteady(Box::new(WithBudget { simulation, budget }))
}

impl Setup {
    /// Assembles the simulation.
    pub(crate) fn assemble(&self) -> Result<Assembled, RunError> {
        match self.dim() {
            2 => self.assemble_in::<2>(),
            _ => self.assemble_in::<3>(),
        }
    }

    /// Steps of a simulation at its start.
    pub(crate) fn schedule(&self, simulation: &(impl Evolving + ?Sized)) -> Schedule {
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

    fn assemble_in<const D: usize>(&self) -> Result<Assembled, RunError>
    where
        Assembled: From<Steady<D>>,
    {
        if self.fluid.is_none() {
            return Ok(unsteady(Grains::new(self.bodies()?), ()));
        }
        let bodies = !self.bodies.list.is_empty() || !self.bodies.inflows.is_empty();
        match self.flow.algorithm {
            Algorithm::Simple => return Ok(self.steady::<D>()?.into()),
            Algorithm::Piso if bodies => {
                let particles = self.particles(Box::new(self.hfdib()))?.with_strategy(Explicit);
                return Ok(unsteady(self.simulation(self.piso::<D>()?, particles)?, self.books()));
            }
            Algorithm::Piso => {
                return Ok(unsteady(self.simulation(self.piso::<D>()?, Still::default())?, ()));
            }
            Algorithm::Projection => {}
        }
        if !self.is_forced() {
            let (flow, still) = self.walled::<D>()?;
            return Ok(unsteady(self.simulation(flow, still)?, ()));
        }
        let forcing: Box<dyn Forcing> = match self.bodies.forcing() {
            ForcingChoice::Hfdib => Box::new(self.hfdib()),
            _ => Box::new(self.smooth()),
        };
        let (flow, particles) = (self.physics(self.projection::<D>()?)?, self.particles(forcing)?);
        match self.bodies.coupling.strategy {
            StrategyChoice::OneSolve => self.with_bodies(flow, particles),
            StrategyChoice::Iterated => self.with_bodies(flow, particles.with_strategy(Iterated::default())),
            StrategyChoice::Explicit => self.with_bodies(flow, particles.with_strategy(Explicit)),
        }
    }

    /// The books, if they are kept.
    fn books(&self) -> Option<Ledger> {
        self.why_no_books().is_none().then(Ledger::new)
    }

    fn particles(&self, forcing: Box<dyn Forcing>) -> Result<Particles<Box<dyn Forcing>, Cast>, BuildError> {
        let particles = Particles::new(self.bodies()?, forcing, self.fluid().density, self.gravity);
        Ok(match self.bodies.coupling.virtual_mass {
            Some(factor) => particles.with_virtual_mass(factor),
            None => particles,
        })
    }

    fn simulation<const D: usize, P: Immersed<D, A>, A: FlowSolver<D>>(
        &self,
        flow: A,
        particles: P,
    ) -> Result<Simulation<D, P, A>, CouplingError> {
        let mut simulation = Simulation::new(flow, particles, self.balance)?;
        if let Some((axis, velocity)) = self.flow_rate.clone() {
            simulation = simulation.with_flow_rate(FlowRate::new(axis, move |t| velocity.needed(&[t])));
        }
        Ok(match self.force.clone() {
            Some(force) => simulation.with_force(move |t| force.each_ref().map(|f| f.needed(&[t])).into()),
            None => simulation,
        })
    }

    fn with_bodies<const D: usize, S>(
        &self,
        flow: Physics<D>,
        particles: Particles<Box<dyn Forcing>, Cast, S>,
    ) -> Result<Assembled, RunError>
    where
        S: Strategy + Exchange<D, Physics<D>> + 'static,
    {
        let window = self.window.map(|w| MovingWindow::following(w.body as u64, w.axis).at(w.place));
        let budget = Windowed { window: window.transpose()?, ledger: self.books() };
        Ok(unsteady(self.simulation(flow, particles)?, budget))
    }
}
