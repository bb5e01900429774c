//! `run.log`.
use crate::watch::output;
use coupling::CouplingError;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Lines with the seconds since the run began.
pub(crate) struct Log {
    path: PathBuf,
    file: File,
    start: Instant,
}

impl Log {
    /// A new log, or, when a run goes on, the one that is there.
    pub(crate) fn open(folder: &Path, append: bool) -> Result<Self, CouplingError> {
        let path = folder.join("run.log");
        let file = OpenOptions::new().create(true).write(true).append(append).truncate(!append).open(&path);
        Ok(Self { file: file.map_err(output("making", &path))?, path, start: Instant::now() })
    }
    pub(crate) fn line(&mut self, text: &str) -> Result<(), CouplingError> {
        let seconds = self.start.elapsed().as_secs_f64();
        // In one piece.
        self.file
            .write_all(format!("{seconds:10.2} {text}\n").as_bytes())
            .map_err(output("writing", &self.path))
    }
}

/// A warning, in the log and, unless `quiet`, on the terminal.
pub(crate) fn warn(log: &mut Log, warning: &str, quiet: bool) -> Result<(), CouplingError> {
    log.line(&format!("warning: {warning}"))?;
    if !quiet {
        // Nobody may be reading.
        let _ = writeln!(std::io::stderr(), "warning: {warning}");
    }
    Ok(())
}
