//! One page of one or several runs: what was run, warnings, results against references, curves,
//! pictures, cost, the scene's text.
//!
//! The page is one HTML file that needs no other file and no network. It is made from the folders
//! that `siltflow run` writes; what is missing in them or damaged is named on the page. Several
//! runs are shown side by side, and those that differ in their grid alone as a [grid
//! study](GridConvergence).
//!
//! ```no_run
//! use std::path::Path;
//!
//! let report = report::Report::read(&[Path::new("out/coarse"), Path::new("out/fine")])?;
//! report.write(Path::new("report.html"))?;
//! # Ok::<(), report::ReportError>(())
//! ```
#![doc(html_root_url = "https://docs.rs/siltflow-report/latest")]
mod comparison;
mod error;
mod figures;
mod grid_convergence;
mod page;
mod pictures;
mod run_folder;
mod run_page;
mod run_results;
mod run_table;
mod series;
mod shared_charts;
mod text;

pub use error::ReportError;
pub use grid_convergence::{GridConvergence, GridValue};

/// The program of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

use run_folder::RunFolder;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Name of the page in a run's folder.
pub const FILE: &str = "report.html";

/// Runs that a page is made of.
#[derive(Debug)]
pub struct Report {
    runs: Vec<RunFolder>,
}

impl Report {
    /// Reads the folders of runs.
    ///
    /// # Errors
    /// [`ReportError`] if there is none, or one that is not that of a run.
    pub fn read<P: AsRef<Path>>(folders: &[P]) -> Result<Self, ReportError> {
        if folders.is_empty() {
            return Err(ReportError::NoRun);
        }
        let mut runs = folders.iter().map(|f| RunFolder::read(f.as_ref())).collect::<Result<Vec<_>, _>>()?;
        // Paths distinguish folders of the same name.
        let labels: Vec<String> = runs.iter().map(|run| run.label.clone()).collect();
        for run in &mut runs {
            if labels.iter().filter(|label| **label == run.label).count() > 1 {
                run.label = run.folder.display().to_string();
            }
        }
        Ok(Self { runs })
    }

    /// The page.
    pub fn html(&self) -> String {
        let mut page = Vec::new();
        // A vector takes all that is written to it.
        let _ = page::write(&self.runs, &mut page);
        String::from_utf8_lossy(&page).into_owned()
    }

    /// Writes the page, next to the file first: what is there is whole.
    ///
    /// # Errors
    /// [`ReportError::Write`].
    pub fn write(&self, file: &Path) -> Result<(), ReportError> {
        let mut part = file.as_os_str().to_owned();
        part.push(".part");
        let write = || {
            let mut out = BufWriter::new(File::create(&part)?);
            page::write(&self.runs, &mut out)?;
            out.flush()?;
            std::fs::rename(&part, file)
        };
        write().map_err(|source| ReportError::Write { file: file.into(), source })
    }
}
