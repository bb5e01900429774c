//! Runs a scene.
use crate::any_simulation::AnySimulation;
use crate::assembly::Assembled;
use crate::build_error::BuildError;
use crate::folder_lock::FolderLock;
use crate::history::{HISTORY, History};
use crate::identity::Identity;
use crate::log::{Log, warn};
use crate::look::{Extremes, Kept, Look, Whole};
use crate::options::Options;
use crate::problem::Problems;
use crate::record::Record;
use crate::result::{Ending, RunResult};
use crate::setup::Setup;
use crate::stop::StopCheck;
use crate::watch::output;
use coupling::{CheckpointError, CouplingError, SavedState};
use interfaces::{RestartError, ThinPart};
use render::cpu::Stopwatch;
use render::progress::Progress;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Why a run ended before its time.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The scene could not be put together.
    #[error(transparent)]
    Build(#[from] BuildError),
    /// A step or a file could not be made.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// A step could not be made because of what a key of the scene says.
    #[error(transparent)]
    Step(Box<Problems>),
    /// The saved state.
    #[error("{}; {}", .0, remedy(.0))]
    Resume(CheckpointError),
    /// Another scene was saved there.
    #[error("the state in {} was saved by another scene, or by this one with other values than time.end and output; begin anew with --overwrite, which deletes it, or in another folder (--out)", .0.display())]
    OtherScene(PathBuf),
    /// A file that the scene names is not the one with which the state was saved.
    #[error("{} ({key}) has changed since the state in {} was saved: the hash of its contents is {found:016x}, and {saved:016x} was expected; put the file back as it was, begin anew with --overwrite, which deletes the state, or in another folder (--out)", file.display(), state.display())]
    ChangedFile {
        /// The file.
        file: PathBuf,
        /// The first key that names it.
        key: String,
        /// The state.
        state: PathBuf,
        /// Hash (64-bit FNV-1a) of its contents when the state was saved.
        saved: u64,
        /// The hash now.
        found: u64,
    },
    /// The folder holds the state of a run that is not at its end.
    #[error("{} holds the state of a run that was stopped, killed or not converged; `siltflow resume` goes on from it, --overwrite deletes it and begins anew, and --out gives another folder", .0.display())]
    Unfinished(PathBuf),
    /// Another run writes to the folder.
    #[error("the folder {} is in use by another run ({}); wait for its end or stop it, or give another folder (--out)", folder.display(), if process.is_empty() { "of an unknown process".to_owned() } else { format!("process {process}") })]
    InUse {
        /// The folder.
        folder: PathBuf,
        /// Number of the process, empty if it is unknown.
        process: String,
    },
    /// Threads.
    #[error("the threads could not be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Remedy for a state that cannot be loaded.
fn remedy(error: &CheckpointError) -> &'static str {
    match error {
        CheckpointError::Corrupt { older: Some(_), .. } => "`siltflow resume --previous` goes on from it",
        CheckpointError::Corrupt { .. } => "--overwrite does so",
        CheckpointError::Io { .. } => {
            "without an interrupted run of this scene in the folder, begin with `siltflow run`"
        }
        CheckpointError::Mismatch(_) => "--overwrite begins anew and deletes the state",
    }
}

impl Setup {
    /// Folder of the run.
    pub(crate) fn folder<'a>(&'a self, options: &'a Options) -> &'a Path {
        options.out.as_deref().unwrap_or(&self.output.folder)
    }

    /// Runs the scene.
    pub(crate) fn run(
        &self,
        options: &Options,
        identity: &Identity,
        record: Record<'_>,
        stop: &AtomicBool,
    ) -> Result<RunResult, RunError> {
        let stage = Stage { setup: self, options, identity, record, stop };
        match self.assemble()? {
            Assembled::Unsteady(mut simulation) => stage.march(&mut *simulation),
            Assembled::Steady2(flow) => stage.steady(*flow),
            Assembled::Steady3(flow) => stage.steady(*flow),
        }
    }
}

/// A run that is about to begin.
pub(crate) struct Stage<'a> {
    pub(crate) setup: &'a Setup,
    pub(crate) options: &'a Options,
    pub(crate) identity: &'a Identity,
    pub(crate) record: Record<'a>,
    pub(crate) stop: &'a AtomicBool,
}

/// Names of the results in the folder; the first tells whether the run came to its end.
const RESULTS: [&str; 2] = ["result.json", "timings.json"];
/// Name of the saved state in the folder.
pub(crate) const STATE: &str = "state.bin";

impl Stage<'_> {
    pub(crate) fn folder(&self) -> &Path {
        self.setup.folder(self.options)
    }

    /// Whether the run goes on from a saved state.
    pub(crate) fn resumes(&self) -> bool {
        self.options.resume || self.options.resume_previous
    }

    /// Makes the folder, locks it, and removes what an earlier run left if this one begins anew.
    ///
    /// # Errors
    /// [`RunError::InUse`]; [`RunError::Unfinished`] if a state would be lost that no flag gives
    /// up.
    pub(crate) fn take_folder(&self) -> Result<FolderLock, RunError> {
        let folder = self.folder();
        std::fs::create_dir_all(folder).map_err(output("making the folder", folder))?;
        let lock = FolderLock::take(folder)?;
        if self.resumes() {
            return Ok(lock);
        }
        let state = folder.join(STATE);
        let older = coupling::previous(&state);
        if !self.options.overwrite && (state.exists() || older.exists()) && !is_complete(folder) {
            return Err(RunError::Unfinished(folder.into()));
        }
        let others = RESULTS.into_iter().chain(["residuals.csv", report::FILE]).map(|name| folder.join(name));
        for old in others.chain([state, older]) {
            let _ = std::fs::remove_file(old);
        }
        Ok(lock)
    }

    /// The state from which the run goes on, if it does, after the check that it is this scene's.
    pub(crate) fn saved_state(&self) -> Result<Option<SavedState>, RunError> {
        if !self.resumes() {
            return Ok(None);
        }
        let mut path = self.folder().join(STATE);
        if self.options.resume_previous {
            path = coupling::previous(&path);
        }
        let state = SavedState::read(&path).map_err(RunError::Resume)?;
        self.identity.check(&state, &path)?;
        Ok(Some(state))
    }

    /// Makes the folder that of an unfinished run whose last state is the one that was loaded.
    pub(crate) fn reopen(&self) -> Result<(), RunError> {
        let folder = self.folder();
        if self.options.resume_previous {
            let state = folder.join(STATE);
            std::fs::rename(coupling::previous(&state), &state)
                .map_err(output("replacing the state in", &state))?;
        }
        for old in RESULTS {
            let _ = std::fs::remove_file(folder.join(old));
        }
        Ok(())
    }

    /// Logs warnings of the plan, and of thin parts of bodies that it has not found.
    pub(crate) fn warn(&self, log: &mut Log, thin: &[ThinPart]) -> Result<(), CouplingError> {
        let mut thin = self.setup.thin_warnings(thin);
        let planned = &self.record.plan.warnings;
        thin.retain(|warning| !planned.contains(warning));
        for warning in planned.iter().chain(&thin) {
            warn(log, warning, self.options.quiet)?;
        }
        Ok(())
    }

    /// Error of a state that does not fit.
    pub(crate) fn not_resumed(&self, error: RestartError) -> RunError {
        match error {
            RestartError::Differs(_) => RunError::OtherScene(self.folder().join(STATE)),
            error => RunError::Resume(error.into()),
        }
    }
}

/// Whether the results in `folder` are those of a run that came to its end. Reads line by line:
/// results of many bodies are long.
fn is_complete(folder: &Path) -> bool {
    let Ok(file) = File::open(folder.join(RESULTS[0])) else { return false };
    let mut lines = BufReader::new(file).lines().map_while(Result::ok);
    lines.find_map(|line| Some(line.strip_prefix("  \"complete\": ")?.starts_with("true"))).unwrap_or(false)
}

impl Stage<'_> {
    /// Steps to the end of the run, or until it is stopped.
    fn march(&self, simulation: &mut (dyn AnySimulation + 'static)) -> Result<RunResult, RunError> {
        let watch = Stopwatch::start();
        let setup = self.setup;
        let _lock = self.take_folder()?;
        let state = self.folder().join(STATE);
        let mut extremes = Extremes::default();
        let mut stop = setup.stop.clone().map(StopCheck::new);
        // Schedule of the flow at its start, also of a run that goes on.
        let schedule = setup.schedule(simulation);
        schedule.check()?;
        let mut resume = None;
        let saved = self.saved_state()?;
        if let Some(saved) = &saved {
            // First the simulation and its time; then what the observers have kept, in files that go on from that time.
            let (extremes, stop) = (&mut extremes, &mut stop);
            let mut whole = Whole { simulation, extremes, stop, identity: self.identity, audience: None };
            saved.restore(&mut whole).map_err(|e| self.not_resumed(e))?;
            self.reopen()?;
            resume = Some(simulation.time());
        }
        let mut audience = setup.audience(self.folder(), resume, self.options.quiet)?;
        if let Some(saved) = saved {
            saved.restore(&mut Kept(&mut audience)).map_err(|e| self.not_resumed(e))?;
        }
        let ledger = simulation.budget().is_some();
        let flow_rate = setup.flow_rate.as_ref().map(|(axis, _)| *axis);
        let history = History::open(self.folder(), setup.end, ledger, flow_rate, resume)?;
        self.record.write(setup, self.folder(), audience.tables(HISTORY))?;
        let mut log = Log::open(self.folder(), self.resumes())?;
        let begin = simulation.time();
        log.line(&format!(
            "{} {} from t = {begin:.6e} s, step {}, to {} s: {} cells, {} bodies",
            if resume.is_some() { "going on with" } else { "running" },
            setup.name,
            simulation.steps(),
            setup.end,
            setup.cells(),
            setup.bodies.list.len(),
        ))?;
        self.warn(&mut log, simulation.view(setup).thin())?;
        let mut look = Look {
            setup,
            audience,
            history,
            extremes,
            stop,
            progress: (!self.options.quiet).then(|| Progress::new(begin, setup.end)),
            log,
            state: state.clone(),
            identity: self.identity,
            save_every: Duration::try_from_secs_f64(setup.save_every).unwrap_or(Duration::MAX),
            saved: Instant::now(),
            only_end: setup.output.snapshots == 0,
            output: 0.0,
            ledger: 0.0,
        };
        let summary = coupling::run(simulation, &schedule, &mut look, self.stop);
        let summary = match summary {
            Ok(summary) => summary,
            Err(error) => {
                let _ = look.log.line(&format!("ended by an error: {error}"));
                // Tables are of use where a run went wrong.
                let _ = look.flush();
                return Err(error.into());
            }
        };
        if summary.stopped || setup.save_at_end {
            look.save(simulation)?;
        }
        if let Some(progress) = look.progress.take() {
            progress.finish(summary.steps, if summary.stopped { "stopped" } else { "done" });
        }
        let Look { mut audience, mut history, extremes, stop, mut log, output, ledger, .. } = look;
        history.flush()?;
        let (mut seen, budget) = simulation.view_with_budget(setup);
        if summary.stopped {
            audience.flush()?;
        } else {
            audience.finish(&mut *seen, self.stop)?;
        }
        let stopped = summary.stopped || self.stop.load(Ordering::Relaxed);
        let early = stop.and_then(|stop| stop.ending());
        let ending = if stopped { Ending::Stopped } else { early.unwrap_or(Ending::Done) };
        if summary.repeats > 0 {
            log.line(&format!(
                "steps repeated with a shorter one, to keep to the Courant number: {}",
                summary.repeats
            ))?;
        }
        log.line(match ending {
            Ending::Stopped => "stopped; `siltflow resume` goes on",
            Ending::Steady => "steady: time.stop.steady ends the run",
            Ending::Event => "event: time.stop.event ends the run",
            Ending::Done | Ending::NotConverged => "done",
        })?;
        let seconds = [audience.seconds + output, ledger];
        let result = RunResult::new(setup, &mut *seen, &extremes, budget, &audience, ending, self.folder());
        Ok(result.with_timings(watch.elapsed(), self.options.threads, seconds, &*seen).write()?)
    }
}
