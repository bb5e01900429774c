//! How a scene is run.
use std::path::PathBuf;

/// What the scene leaves open.
#[derive(Clone, Debug)]
pub struct Options {
    /// Threads, at least 1.
    pub threads: usize,
    /// Whether the run goes on from the state in the folder.
    pub resume: bool,
    /// Whether it goes on from the state saved before that one, which is dropped.
    pub resume_previous: bool,
    /// Whether the state of an unfinished run in the folder may be deleted, when the run begins
    /// anew.
    pub overwrite: bool,
    /// No progress.
    pub quiet: bool,
    /// Another folder than the scene's.
    pub out: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Self {
        Self { threads: 1, resume: false, resume_previous: false, overwrite: false, quiet: false, out: None }
    }
}
