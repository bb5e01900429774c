//! Steady flow.
use crate::build_error::BuildError;
use crate::identity::Identity;
use crate::log::Log;
use crate::look::Extremes;
use crate::physics::{Lift, Model, Scalars};
use crate::result::{Ending, RunResult, number};
use crate::run::{RunError, STATE, Stage};
use crate::setup::Setup;
use crate::still::Still;
use crate::view::{Seen, View};
use crate::watch::{Table, output};
use coupling::StepInfo;
use cpu_time::ThreadTime;
use fv_mesh::{FlowError, ScalarTransport, Simple, SimpleInfo, SimpleParams, TransportParams, WallStress};
use ibm::cut_cells;
use interfaces::{Checkpoint, Kinematics, RestartError, ThinPart, Vector, Wrench};
use render::cpu::Stopwatch;
use render::progress::Progress;
use std::io;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

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
    /// One iteration: its residuals, and the largest relative change of a scalar that drives the flow.
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
        Ok((info, change))
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

/// Cells of the finer of two coarse grids whose iterations are counted, in the plane and in space,
/// and CPU time that each may take \[s\]. The other has half as many along each axis.
const COARSE: [usize; 2] = [4_000, 16_000];
const TIME: f64 = 1.0;

impl Setup {
    /// Iterations to convergence, extrapolated from two coarse grids as a power of the cells; none
    /// if the finer one needs more than are allowed, diverges or cannot be built.
    pub(crate) fn expected_iterations<const D: usize>(&self) -> Option<f64> {
        let cells = COARSE[D - 2];
        let (coarse, known) = self.iterations_with::<D>(cells)?;
        let Some((coarser, fewer)) = self.iterations_with::<D>(cells >> D) else { return Some(known) };
        let ratio = |fine: f64, coarse: f64| (fine / coarse).ln();
        if coarser >= coarse || known <= fewer {
            return Some(known);
        }
        let power = ratio(known, fewer) / ratio(coarse, coarser);
        Some((known * (self.cells() as f64 / coarse).powf(power)).ceil().min(self.flow.iterations as f64))
    }

    /// Cells of a coarse grid with at most `most` of them, and iterations to convergence there,
    /// extrapolated by the last residuals where they take long.
    fn iterations_with<const D: usize>(&self, most: usize) -> Option<(f64, f64)> {
        let (tolerance, allowed) = (self.flow.tolerance, self.flow.iterations);
        let coarse = self.coarser(most).ok()?;
        let cells = coarse.cells() as f64;
        let mut steady = coarse.steady::<D>().ok()?;
        let start = ThreadTime::now();
        let mut residuals = Vec::new();
        for done in 1..=allowed {
            let (info, change) = steady.iterate().ok()?;
            let residual = info.largest().max(change);
            residuals.push(residual.ln());
            if residual <= tolerance {
                return Some((cells, done as f64));
            }
            if start.elapsed().as_secs_f64() > TIME {
                let half = done / 2;
                let slope = (residuals[half] - residual.ln()) / (done - 1 - half).max(1) as f64;
                let left = (residual / tolerance).ln() / slope.max(f64::MIN_POSITIVE);
                let all = (done as f64 + left).ceil();
                return (all <= allowed as f64).then_some((cells, all));
            }
        }
        None
    }

    /// The steady algorithm with bodies at rest as walls.
    pub(crate) fn steady<const D: usize>(&self) -> Result<Steady<D>, BuildError> {
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

impl<const D: usize> Checkpoint for Steady<D> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.flow.save(&mut |name, values| sink(&format!("flow.{name}"), values));
        self.scalars.save(&mut |name, values| sink(&format!("scalars.{name}"), values));
        if let Some(model) = &self.model {
            model.save(&mut |name, values| sink(&format!("model.{name}"), values));
        }
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.flow.restore(&|name| source(&format!("flow.{name}")))?;
        self.scalars.restore(&|name| source(&format!("scalars.{name}")))?;
        match &mut self.model {
            Some(model) => model.restore(&|name| source(&format!("model.{name}"))),
            None => Ok(()),
        }
    }
}

/// All that is saved of a steady run.
struct Saved<'a, const D: usize> {
    flow: &'a mut Steady<D>,
    residual: &'a mut f64,
    identity: &'a Identity,
}

impl<const D: usize> Checkpoint for Saved<'_, D> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.identity.save(sink);
        sink("residual", &[*self.residual]);
        self.flow.save(sink);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        *self.residual = RestartError::take(source, "residual", 1)?[0];
        self.flow.restore(source)
    }
}

/// Head of `residuals.csv`.
const RESIDUALS: &str = "# largest residuals of every iteration, each relative to the terms of its equation: momentum along x, y, z; continuity; turbulence model; relative change of scalars that drive the flow\niteration,x,y,z,continuity,closure,scalars";

impl Stage<'_> {
    /// Iterates to the steady flow, from a saved state on if the run is resumed.
    pub(crate) fn steady<const D: usize>(&self, mut flow: Steady<D>) -> Result<RunResult, RunError> {
        let watch = Stopwatch::start();
        let setup = self.setup;
        let _lock = self.take_folder()?;
        let state = self.folder().join(STATE);
        let mut residual = f64::INFINITY;
        if let Some(saved) = self.saved_state()? {
            let (flow, residual) = (&mut flow, &mut residual);
            let mut whole = Saved { flow, residual, identity: self.identity };
            saved.restore(&mut whole).map_err(|e| self.not_resumed(e))?;
            self.reopen()?;
        }
        let begin = flow.flow.iterations();
        let resume = self.resumes().then_some(begin as f64);
        let mut audience = setup.audience(self.folder(), None, self.options.quiet)?;
        let mut table = Table::open(&self.folder().join("residuals.csv"), RESIDUALS, resume)?;
        self.record.write(setup, self.folder(), audience.tables("residuals.csv"))?;
        let mut log = Log::open(self.folder(), self.resumes())?;
        let (tolerance, allowed) = (setup.flow.tolerance, setup.flow.iterations);
        let cells = setup.cells();
        log.line(&match resume {
            None => format!("iterating {}: {cells} cells, to residuals of {tolerance:e}", setup.name),
            Some(_) if residual <= tolerance => {
                format!("{} has converged at iteration {begin} with residual {residual:.3e}: nothing is left to do", setup.name)
            }
            Some(_) => format!("going on with {} from iteration {begin}, residual {residual:.3e}: {cells} cells, to residuals of {tolerance:e}", setup.name),
        })?;
        let still = Still { bodies: setup.still(), thin: std::mem::take(&mut flow.thin) };
        self.warn(&mut log, &still.thin)?;
        let mut progress = (!self.options.quiet).then(|| Progress::steady(tolerance));
        let every = Duration::try_from_secs_f64(setup.save_every).unwrap_or(Duration::MAX);
        let mut saved = Instant::now();
        let save = |flow: &mut Steady<D>, mut residual: f64, table: &mut Table| {
            table.flush()?;
            let whole = Saved { flow, residual: &mut residual, identity: self.identity };
            coupling::save(&state, &whole)
                .map_err(|e| output("saving the state in", &state)(io::Error::other(e)))
        };
        let mut stopped = false;
        while residual > tolerance && flow.flow.iterations() < allowed {
            if self.stop.load(Ordering::Relaxed) {
                stopped = true;
                break;
            }
            let (info, change) = flow.iterate().map_err(BuildError::from)?;
            residual = info.largest().max(change);
            let [x, y, z] = info.momentum;
            table.row(info.iterations as f64, None, [x, y, z, info.continuity, info.closure, change])?;
            if let Some(progress) = &mut progress {
                progress
                    .tell(info.iterations as u64, -residual.log10(), || format!("residual {residual:.2e}"));
            }
            if info.iterations % 50 == 1 {
                log.line(&format!("iteration {}: residual {residual:.3e}", info.iterations))?;
            }
            if saved.elapsed() >= every {
                save(&mut flow, residual, &mut table)?;
                saved = Instant::now();
            }
        }
        let ending = match residual <= tolerance {
            true => Ending::Done,
            false if stopped => Ending::Stopped,
            false => Ending::NotConverged,
        };
        if stopped || setup.save_at_end {
            save(&mut flow, residual, &mut table)?;
        }
        table.flush()?;
        let iterations = flow.flow.iterations();
        if let Some(progress) = progress.take() {
            let word = match ending {
                Ending::Done if iterations == begin => "converged already: nothing was left to do",
                Ending::Done | Ending::Steady | Ending::Event => "converged",
                Ending::Stopped => "stopped",
                Ending::NotConverged => "not converged",
            };
            progress.finish(iterations as u64, word);
        }
        log.line(&format!("{iterations} iterations, residual {residual:.3e}"))?;
        flow.weigh();
        if !stopped {
            flow.settle().map_err(BuildError::from)?;
        }
        let given_off = flow.scalars.given_off();
        let timings = coupling::Timings::default();
        let mut seen = Seen { flow: &mut flow, guests: &still, timings, force: Vector::zeros() };
        // One "step" of a second, whose impulses are the loads.
        let info = StepInfo { step: seen.steps(), time: setup.end, dt: 1.0, courant: 0.0, snapshot: None };
        audience.step(&mut seen, &info)?;
        audience.snapshot(&mut seen, 0, &info)?;
        audience.finish(&mut seen, self.stop)?;
        let extremes = Extremes::default();
        let seconds = [audience.seconds, 0.0];
        let mut result = RunResult::new(setup, &mut seen, &extremes, None, &audience, ending, self.folder());
        result.set("residual", number(residual));
        if !given_off.is_empty() {
            result.set("given_off", given_off.into_iter().collect());
        }
        Ok(result.with_timings(watch.elapsed(), self.options.threads, seconds, &seen).write()?)
    }
}
