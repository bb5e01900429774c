//! How a scene is run.
use std::path::PathBuf;

/// What the scene leaves open.
#[derive(Clone, Debug)]
pub struct Options {
    /// Threads, at least 1.
    pub threads: usize,
    /// Go on from the state in the folder?
    pub resume: bool,
    /// No progress.
    pub quiet: bool,
    /// Another folder than the scene's.
    pub out: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Self {
        Self { threads: 1, resume: false, quiet: false, out: None }
    }
}
