//! `siltflow report`.
use crate::outcome::{Failure, print};
use ::report::{Report, ReportError};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

#[derive(Args)]
pub(crate) struct ReportArgs {
    /// Folders of runs; of several, results are compared, and grid studies made.
    #[arg(required = true, value_name = "OUT")]
    folders: Vec<PathBuf>,
    /// The page; without it report.html in the folder of one run, or here of several.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Prints JSON: an object with the path of the page.
    #[arg(long)]
    json: bool,
}

impl ReportArgs {
    /// Writes the page and prints its path; returns the exit code.
    pub(crate) fn report(&self) -> Result<u8, Failure> {
        let page = match (&self.out, &self.folders[..]) {
            (Some(page), _) => page.clone(),
            (None, [folder]) => folder.join(::report::FILE),
            (None, _) => ::report::FILE.into(),
        };
        let failed = |error| match error {
            ReportError::Write { .. } => Failure::of_output(error),
            error => Failure::of_input(error),
        };
        Report::read(&self.folders).and_then(|report| report.write(&page)).map_err(failed)?;
        match self.json {
            true => print(&format!("{:#}\n", json!({ "report": page })))?,
            false => print(&format!("{}\n", page.display()))?,
        }
        Ok(0)
    }
}
