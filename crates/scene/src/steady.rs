//! Steady flow.
use crate::build_error::BuildError;
use crate::log::Log;
use crate::look::Extremes;
use crate::physics::{Lift, Model, Scalars};
use crate::result::{Ending, RunResult};
use crate::run::{RunError, Stage};
use crate::setup::Setup;
use crate::still::Still;
use crate::view::{Seen, View};
use coupling::StepInfo;
use example_support::cpu::Stopwatch;
use example_support::progress::Progress;
use fv_mesh::{FlowError, ScalarTransport, Simple, SimpleInfo, SimpleParams, TransportParams, WallStress};
use ibm::cut_cells;
use interfaces::{Kinematics, ThinPart, Wrench};
use std::sync::atomic::Ordering;

/// The steady algorithm, its turbulence model, and the loads of its walls.
pub(crate) struct Steady<const D: usize> {
    pub(crate) flow: Simple<D>,
    pub(crate) model: Option<Model<D>>,
    pub(crate) scalars: Scalars<D>,
    /// Buoyancy, by which the scalars are found along with the flow.
    pub(crate) lift: Option<Lift>,
    /// Of every body at rest \[N, N m\]: pressure and friction.
    pub(crate) loads: Vec<Wrench>,
    /// Parts of bodies that are too thin for the grid.
    pub(crate) thin: Vec<ThinPart>,
    /// When the flow is said to be \[s\].
    pub(crate) time: f64,
}

impl<const D: usize> Steady<D> {
    /// One iteration; the largest of its residuals, and of the relative changes of scalars that drive the flow.
    pub(crate) fn iterate(&mut self) -> Result<(SimpleInfo, f64), FlowError> {
        let mut change = 0.0;
        if self.lift.is_some() {
            self.mix()?;
            change = self.scalars.approach(self.flow.velocity(), self.time)?;
        }
        if let Some(lift) = &self.lift {
            lift.put(&self.scalars, self.flow.source_mut());
        }
        let info = match &mut self.model {
            Some(model) => self.flow.iterate_with(model)?,
            None => self.flow.iterate()?,
        };
        Ok((info, info.largest().max(change)))
    }
    /// Shows the scalars what the model says.
    fn mix(&mut self) -> Result<(), FlowError> {
        let viscosity = self.flow.fluid().viscosity;
        if let Some(model) = &mut self.model
            && let Some(eddy) = model.eddy_stress(viscosity, self.time)?
        {
            self.scalars.mix(eddy, viscosity);
        }
        match &self.model {
            Some(_) => self.scalars.rub(&self.flow.wall_friction_velocities(), viscosity),
            None => Ok(()),
        }
    }
    /// Brings the scalars to their steady state.
    pub(crate) fn settle(&mut self) -> Result<(), FlowError> {
        self.mix()?;
        self.scalars.settle(self.flow.velocity(), self.time)
    }
    /// Takes the loads from the flow.
    pub(crate) fn weigh(&mut self) {
        let (pressure, friction) = (self.flow.wall_pressure_force(), self.flow.wall_friction());
        self.loads = pressure.into_iter().zip(friction).map(|(p, f)| p + f).collect();
    }
}

impl Setup {
    /// The steady algorithm with bodies at rest as walls.
    pub(crate) fn steady<const D: usize>(&self) -> Result<Steady<D>, BuildError> {
        self.check_memory()?;
        let grid = self.grid()?;
        let params =
            if self.turbulence.is_some() { SimpleParams::turbulent() } else { SimpleParams::default() };
        let mut flow = Simple::new(grid.clone(), self.all_sides(), self.fluid())?
            .with_convection(self.flow.convection)
            .with_params(params)?;
        let mut scalars = self.scalars(flow.grid(), flow.sides())?;
        let bodies = self.still();
        let mut thin = Vec::new();
        if bodies.n_bodies() > 0 {
            let cuts = cut_cells(flow.velocity(), &bodies)?;
            let walls = self.turbulence.as_ref().map(|t| t.walls).unwrap_or_default();
            flow.set_walls(Some((&cuts, walls)))?;
            thin.clone_from(&cuts.thin);
            if matches!(walls, WallStress::Law { .. }) {
                scalars.stand_beside(&cuts, self.end)?;
            }
        }
        if let Some(u) = self.initial(&grid)? {
            flow.set_velocity(u);
        }
        if let Some(force) = &self.force {
            flow.set_force(std::array::from_fn(|a| force[a].at(&[self.end])));
        }
        let mut model = self.model(flow.grid(), flow.sides(), TransportParams::steady())?;
        if let Some(model) = &mut model {
            self.stand_beside(model, flow.sides())?;
        }
        Ok(Steady { flow, model, scalars, lift: self.lift(), loads: Vec::new(), thin, time: self.end })
    }
}

impl Stage<'_> {
    /// Iterates to the steady flow.
    pub(crate) fn steady<const D: usize>(&self, mut flow: Steady<D>) -> Result<RunResult, RunError> {
        let watch = Stopwatch::start();
        let setup = self.setup;
        self.make_folder()?;
        let mut audience = self.audience(None)?;
        let mut log = Log::open(self.folder(), false)?;
        log.line(&format!(
            "iterating {}: {} cells, to residuals of {:e}",
            setup.name,
            setup.cells(),
            setup.flow.tolerance
        ))?;
        self.warn(&mut log)?;
        // Progress is the way of the residual's logarithm.
        let target = -setup.flow.tolerance.log10();
        let mut progress = (!self.options.quiet).then(|| Progress::new(0.0, target));
        let mut ending = Ending::NotConverged;
        let mut residual = f64::INFINITY;
        for _ in 0..setup.flow.iterations {
            if self.stop.load(Ordering::Relaxed) {
                ending = Ending::Stopped;
                break;
            }
            let (info, largest) = flow.iterate().map_err(BuildError::from)?;
            residual = largest;
            if let Some(progress) = &mut progress {
                progress.tell(info.iterations as u64, (-residual.log10()).clamp(0.0, target), || {
                    format!("residual {residual:.2e}")
                });
            }
            if info.iterations % 50 == 1 {
                log.line(&format!("iteration {}: residual {residual:.3e}", info.iterations))?;
            }
            if residual <= setup.flow.tolerance {
                ending = Ending::Done;
                break;
            }
        }
        if let Some(progress) = progress.take() {
            let word = match ending {
                Ending::Done => "converged",
                Ending::Stopped => "stopped",
                Ending::NotConverged => "not converged",
            };
            progress.finish(flow.flow.iterations() as u64, word);
        }
        log.line(&format!("{} iterations, residual {residual:.3e}", flow.flow.iterations()))?;
        flow.weigh();
        if !matches!(ending, Ending::Stopped) {
            flow.settle().map_err(BuildError::from)?;
        }
        let still = Still(setup.still());
        let given_off = flow.scalars.given_off();
        let mut seen = Seen { flow: &mut flow, guests: &still, timings: coupling::Timings::default() };
        // One "step" of a second, whose impulses are the loads.
        let info = StepInfo { step: seen.steps(), time: setup.end, dt: 1.0, courant: 0.0, snapshot: None };
        audience.step(&mut seen, &info)?;
        audience.snapshot(&mut seen, 0, &info)?;
        audience.finish(&mut seen, self.stop)?;
        let extremes = Extremes::default();
        let seconds = [audience.seconds, 0.0];
        let mut result = RunResult::new(setup, &mut seen, &extremes, None, &audience, ending, self.folder());
        result.set("residual", residual.into());
        if !given_off.is_empty() {
            result.set("given_off", given_off.into_iter().collect());
        }
        Ok(result.with_timings(watch.elapsed(), self.options.threads, seconds, &seen).write()?)
    }
}
