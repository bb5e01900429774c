//! Simulation of a scene behind one type, for which the loops over its steps are compiled once.
use crate::setup::Setup;
use crate::view::{Flow, Guests, Seen, View};
use coupling::{
    CouplingError, Evolving, FlowSolver, Immersed, Ledger, LedgerReport, MovingWindow, Observer, Simulation,
    StepInfo,
};
use interfaces::{Checkpoint, RestartError};

/// Simulation of any types, with its budget if it has one.
pub(crate) trait AnySimulation: Evolving {
    /// State, and the budget up to the last step.
    fn view_with_budget<'a>(&'a mut self, setup: &'a Setup)
    -> (Box<dyn View + 'a>, Option<&'a LedgerReport>);
    fn view<'a>(&'a mut self, setup: &'a Setup) -> Box<dyn View + 'a> {
        self.view_with_budget(setup).0
    }
    /// Begins the budget before the first step.
    fn begin_budget(&mut self);
    /// Adds a step to the budget.
    ///
    /// # Errors
    /// Those of [`Ledger`].
    fn track_budget(&mut self, info: &StepInfo) -> Result<(), CouplingError>;
    fn budget(&self) -> Option<&LedgerReport>;
    /// Budget as part of a saved state.
    fn budget_state(&self) -> &dyn Checkpoint;
    fn budget_state_mut(&mut self) -> &mut dyn Checkpoint;
}

/// Simulation that shows its state.
pub(crate) trait Viewed: Evolving {
    fn view<'a>(&'a mut self, setup: &'a Setup) -> Box<dyn View + 'a>;
}

impl<const D: usize, P, A> Viewed for Simulation<D, P, A>
where
    P: Guests + Immersed<D, A>,
    A: Flow<D> + FlowSolver<D>,
{
    fn view<'a>(&'a mut self, _: &'a Setup) -> Box<dyn View + 'a> {
        let (timings, force) = (*self.timings(), self.body_force());
        Box::new(Seen { flow: &mut self.flow, guests: &self.particles, timings, force })
    }
}

/// Budget of a simulation, or none.
pub(crate) trait Budget<S>: Observer<S> + Checkpoint {
    fn report(&self) -> Option<&LedgerReport>;
}

impl<S> Budget<S> for Option<Ledger>
where
    Ledger: Observer<S>,
{
    fn report(&self) -> Option<&LedgerReport> {
        self.as_ref().map(Ledger::report)
    }
}

/// A window that follows a body, and the budget; the window moves before anything is written.
pub(crate) struct Windowed {
    pub(crate) window: Option<MovingWindow>,
    pub(crate) ledger: Option<Ledger>,
}

impl<S> Observer<S> for Windowed
where
    Ledger: Observer<S>,
    MovingWindow: Observer<S>,
{
    fn begin(&mut self, simulation: &mut S) {
        self.ledger.begin(simulation);
    }
    fn step(&mut self, simulation: &mut S, info: &StepInfo) -> Result<(), CouplingError> {
        self.window.step(simulation, info)?;
        self.ledger.step(simulation, info)
    }
}

impl Checkpoint for Windowed {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.ledger.save(sink);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.ledger.restore(source)
    }
}

impl<S> Budget<S> for Windowed
where
    Ledger: Observer<S>,
    MovingWindow: Observer<S>,
{
    fn report(&self) -> Option<&LedgerReport> {
        self.ledger.as_ref().map(Ledger::report)
    }
}

/// Simulations that cannot have a budget.
impl<S> Budget<S> for () {
    fn report(&self) -> Option<&LedgerReport> {
        None
    }
}

/// Simulation with its budget.
pub(crate) struct WithBudget<S, K> {
    pub(crate) simulation: S,
    pub(crate) budget: K,
}

impl<S: Viewed, K: Budget<S>> AnySimulation for WithBudget<S, K> {
    fn view_with_budget<'a>(
        &'a mut self,
        setup: &'a Setup,
    ) -> (Box<dyn View + 'a>, Option<&'a LedgerReport>) {
        (self.simulation.view(setup), self.budget.report())
    }
    fn begin_budget(&mut self) {
        self.budget.begin(&mut self.simulation);
    }
    fn track_budget(&mut self, info: &StepInfo) -> Result<(), CouplingError> {
        self.budget.step(&mut self.simulation, info)
    }
    fn budget(&self) -> Option<&LedgerReport> {
        self.budget.report()
    }
    fn budget_state(&self) -> &dyn Checkpoint {
        &self.budget
    }
    fn budget_state_mut(&mut self) -> &mut dyn Checkpoint {
        &mut self.budget
    }
}

/// State of the simulation alone.
impl<S: Checkpoint, K> Checkpoint for WithBudget<S, K> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.simulation.save(sink);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.simulation.restore(source)
    }
    fn save_start(&mut self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.simulation.save_start(sink);
    }
    fn take_back<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.simulation.take_back(source)
    }
}

impl<S: Evolving, K> Evolving for WithBudget<S, K> {
    fn begin(&mut self) -> Result<(), CouplingError> {
        self.simulation.begin()
    }
    fn step(&mut self, dt: f64) -> Result<(), CouplingError> {
        self.simulation.step(dt)
    }
    fn time(&self) -> f64 {
        self.simulation.time()
    }
    fn set_time(&mut self, time: f64) {
        self.simulation.set_time(time);
    }
    fn steps(&self) -> u64 {
        self.simulation.steps()
    }
    fn last_dt(&self) -> f64 {
        self.simulation.last_dt()
    }
    fn courant(&self, dt: f64) -> f64 {
        self.simulation.courant(dt)
    }
    fn convects(&self) -> bool {
        self.simulation.convects()
    }
    fn stable_dt(&self, courant: f64) -> f64 {
        self.simulation.stable_dt(courant)
    }
    fn longest_dt(&self) -> f64 {
        self.simulation.longest_dt()
    }
}
