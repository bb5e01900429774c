//! `report.html` at the end of a run.
use crate::log::{Log, warn};
use crate::options::Options;
use crate::result::RunResult;
use crate::run::RunError;
use crate::setup::Setup;
use report::{Report, ReportError};
use std::path::{Path, PathBuf};

impl Setup {
    /// Writes the report of a run that has ended, also by an error of a step, if the scene wants
    /// it. A report that cannot be made is a warning: the run's files are whole.
    pub(crate) fn with_report(
        &self,
        ran: Result<RunResult, RunError>,
        options: &Options,
    ) -> Result<RunResult, RunError> {
        let began = matches!(ran, Ok(_) | Err(RunError::Coupling(_) | RunError::Step(_)));
        if !self.output.report || !began {
            return ran;
        }
        let folder = self.folder(options);
        let written = write(folder);
        if let Err(error) = &written {
            let warning = format!("{} could not be made: {error}", report::FILE);
            // The run has reported a folder that cannot be written to.
            if let Ok(mut log) = Log::open(folder, true) {
                let _ = warn(&mut log, &warning, options.quiet);
            }
        }
        ran.map(|result| RunResult { report: written.ok(), ..result })
    }
}

fn write(folder: &Path) -> Result<PathBuf, ReportError> {
    let page = folder.join(report::FILE);
    Report::read(&[folder])?.write(&page)?;
    Ok(page)
}
