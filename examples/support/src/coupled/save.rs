//! Saved state, so that an interrupted run can go on.
use super::motion::Diary;
use super::run::Fall;
use coupling::{self, CheckpointError};
use dem::ContactLaw;
use interfaces::{Checkpoint, RestartError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const SAVE_EVERY: Duration = Duration::from_secs(30);

/// A run and what is kept of its motion, together with a number for its set-up, which must be the same when it goes on.
struct Resumable<'a, const D: usize, L: ContactLaw, M> {
    fall: &'a mut Fall<D, L>,
    motion: &'a mut M,
    setup: u64,
}

impl<const D: usize, L: ContactLaw, M> Resumable<'_, D, L, M> {
    /// All bits as numbers that a state can hold.
    fn setup(&self) -> [f64; 2] {
        [f64::from((self.setup >> 32) as u32), f64::from(self.setup as u32)]
    }
}

impl<const D: usize, L: ContactLaw, M: Checkpoint> Checkpoint for Resumable<'_, D, L, M> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("setup", &self.setup());
        self.fall.save(sink);
        self.motion.save(&mut |name, values| sink(&format!("motion.{name}"), values));
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        if RestartError::take(source, "setup", 2)? != self.setup() {
            return Err(RestartError::Differs("flags".into()));
        }
        self.fall.restore(source)?;
        self.motion.restore(&|name| source(&format!("motion.{name}")))
    }
}

/// Takes up the state saved in `path`.
pub(super) fn load<const D: usize, L: ContactLaw, M: Checkpoint>(
    path: &Path,
    fall: &mut Fall<D, L>,
    motion: &mut M,
    setup: u64,
) -> Result<(), CheckpointError> {
    coupling::load(path, &mut Resumable { fall, motion, setup })
}

/// Saves the state, and beside it the motion so far, every half a minute and when told.
pub(super) struct Save {
    folder: PathBuf,
    setup: u64,
    last: Instant,
}

impl Save {
    pub(super) fn new(folder: &Path, setup: u64) -> Self {
        Self { folder: folder.into(), setup, last: Instant::now() }
    }
    pub(super) fn is_due(&self) -> bool {
        self.last.elapsed() >= SAVE_EVERY
    }
    /// The motion first: what it knows beyond a state is dropped when a run goes on.
    pub(super) fn now<const D: usize, L: ContactLaw, M: Diary<D, L>>(
        &mut self,
        fall: &mut Fall<D, L>,
        motion: &mut M,
    ) -> io::Result<()> {
        motion.write(&self.folder.join("motion.csv"))?;
        let state = self.folder.join("state.bin");
        coupling::save(&state, &Resumable { fall, motion, setup: self.setup }).map_err(io::Error::other)?;
        self.last = Instant::now();
        Ok(())
    }
}
