//! A run.
use super::album::{Album, Slice, View};
use super::motion::{Diary, Motion};
use super::options::RunOptions;
use super::save::{Save, load};
use crate::Outcome;
use crate::files::make_folder;
use crate::granular::{Ending, fingerprint};
use coupling::{
    CouplingError, FileOutput, Module, Observer, Particles, RunSummary, Schedule, Simulation, StepInfo,
};
use dem::{Chen, ContactLaw, RigidBodies};
use ibm::SmoothForcing;
use render::cpu::{Elapsed, Stopwatch};
use render::progress::{Progress, Status};
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// Bodies that the flow, gravity and contacts move.
pub type Fall<const D: usize, L = Chen> = Simulation<D, Particles<SmoothForcing, RigidBodies<L>>>;

/// What is to be run.
pub struct Plan<'a, const D: usize, L: ContactLaw = Chen> {
    /// End time \[s\].
    pub end: f64,
    /// Folder for the files.
    pub out: &'a Path,
    /// What a run that goes on must have in common with the one before, besides the options.
    pub setup: &'a str,
    /// What pictures show.
    pub view: View<D, L>,
}

/// What came of it.
pub struct Record<M = Motion> {
    /// Did it come to its end?
    pub ending: Ending,
    /// Steps.
    pub summary: RunSummary,
    /// How the bodies moved.
    pub motion: M,
    /// The flow at every snapshot of this run; none without pictures.
    pub slices: Vec<Slice>,
    /// What it cost.
    pub elapsed: Elapsed,
    /// Wall time by module \[s\].
    pub modules: [(&'static str, f64); 6],
}

/// The observer of every step: motion, progress, saved state.
struct Watch<M> {
    motion: M,
    progress: Progress,
    save: Save,
}

impl<const D: usize, L: ContactLaw, M: Diary<D, L>> Observer<Fall<D, L>> for Watch<M> {
    fn begin(&mut self, fall: &mut Fall<D, L>) {
        self.motion.begin(fall);
    }
    fn step(&mut self, fall: &mut Fall<D, L>, info: &StepInfo) -> Result<(), CouplingError> {
        self.motion.step(fall, info)?;
        self.progress.step(info.step, || Status {
            time: info.time,
            dt: info.dt,
            courant: info.courant,
            divergence: fall.flow.statistics().divergence * info.dt,
        });
        if self.save.is_due() && info.snapshot.is_none() {
            let what = || "saving the state".into();
            self.save
                .now(fall, &mut self.motion)
                .map_err(|source| CouplingError::Output { what: what(), source })?;
        }
        Ok(())
    }
    fn snapshot(
        &mut self,
        fall: &mut Fall<D, L>,
        index: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        self.motion.snapshot(fall, index, info)
    }
}

/// Runs to the end or until `stop` is set; `motion` keeps how the bodies move. Writes to the folder: `motion.csv`, `frames/*.png`, `state.bin`, and for ParaView
/// `fields.pvd` and `bodies.pvd` with what belongs to them.
///
/// # Errors
/// Those of flow and bodies, and of the disk.
pub fn run<const D: usize, L: ContactLaw, M: Diary<D, L>>(
    fall: &mut Fall<D, L>,
    options: &RunOptions,
    plan: &Plan<'_, D, L>,
    mut motion: M,
    stop: &AtomicBool,
) -> Outcome<Record<M>> {
    options.check()?;
    let watch = Stopwatch::start();
    let Plan { end, out, setup, view } = plan;
    let schedule = Schedule {
        end: *end,
        intervals: options.frames - 1,
        dt: options.dt,
        courant: options.courant,
        ..Schedule::default()
    };
    schedule.check()?;
    make_folder(out)?;
    let setup = fingerprint(&format!("{setup} {} {end:?}", options.setup()));
    let mut files = if options.resume {
        load(&out.join("state.bin"), fall, &mut motion, setup).map_err(|e| {
            format!("{e}; without an interrupted run of this scene there, leave out --resume")
        })?;
        motion.read(&out.join("motion.csv"), fall.flow.time())?;
        if options.no_vtk { None } else { Some(FileOutput::resume(out, fall.flow.time())?) }
    } else {
        // What an earlier run left there is not this run's.
        for old in ["state.bin", "state.bin.previous", "motion.csv", "result.json", "summary.png"] {
            let _ = std::fs::remove_file(out.join(old));
        }
        if options.no_vtk { None } else { Some(FileOutput::new(out)?) }
    };
    let mut album = if options.no_images { None } else { Some(Album::new(out, view)?) };
    let progress = Progress::new(fall.flow.time(), *end);
    let mut steps = Watch { motion, progress, save: Save::new(out, setup) };
    let summary = coupling::run(fall, &schedule, &mut (&mut steps, (&mut files, &mut album)), stop)?;
    if let Some(files) = &mut files {
        files.finish()?;
    }
    steps.save.now(fall, &mut steps.motion)?;
    steps.progress.finish(summary.steps, if summary.stopped { "stopped" } else { "done" });
    let ending = if summary.stopped {
        eprintln!("the state is saved; give the same flags with --resume to go on");
        Ending::Stopped
    } else {
        Ending::Whole
    };
    Ok(Record {
        ending,
        summary,
        motion: steps.motion,
        slices: album.map_or_else(Vec::new, |a| a.slices),
        elapsed: watch.elapsed(),
        modules: Module::ALL.map(|m| (m.name(), fall.timings().seconds(m))),
    })
}
