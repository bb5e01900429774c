//! Errors of reports.
use std::path::PathBuf;

/// Why a report cannot be made. What is missing or damaged within a run's folder is a note on the
/// page instead.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// No folder was given.
    #[error("a report needs the folder of one run at least")]
    NoRun,
    /// The folder is not there or cannot be read.
    #[error("{folder}: {source}; give the folder of a run, out/cavity for instance")]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Its cause.
        source: std::io::Error,
    },
    /// The folder is not that of a run.
    #[error("{} holds neither plan.json nor result.json, so it is not the folder of a run; give one that `siltflow run` has written", .0.display())]
    NotARun(PathBuf),
    /// The page cannot be written.
    #[error("writing {file}: {source}; give another file (--out)")]
    Write {
        /// The page.
        file: PathBuf,
        /// Its cause.
        source: std::io::Error,
    },
}
