//! `siltflow run` and `siltflow resume`.
use crate::outcome::{Failure, print};
use crate::shipped::Shipped;
use clap::Args;
use scene::{Ending, Options, Scene, TABLE_HEAD, empty_row};
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Arguments that a run and its continuation share.
#[derive(Args)]
struct Common {
    /// Sets a value, whatever the file says: --set fluid.nu=2e-6, --set bodies.0.density=1100.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Threads.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
    /// Shows neither progress nor a summary.
    #[arg(long)]
    quiet: bool,
    /// Prints what result.json and timings.json hold instead of the summary.
    #[arg(long)]
    json: bool,
    /// Folder for the files, whatever the scene says; of several scenes each has a folder in it.
    #[arg(long)]
    out: Option<PathBuf>,
}

#[derive(Args)]
pub(crate) struct RunArgs {
    /// Scene files, or names of scenes that come with the command (`siltflow list`).
    #[arg(required = true)]
    scenes: Vec<String>,
    /// Begins anew where an unfinished run has left its state, which is deleted.
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    common: Common,
}

#[derive(Args)]
pub(crate) struct ResumeArgs {
    /// Scene files, or names of scenes that come with the command.
    #[arg(required = true)]
    scenes: Vec<String>,
    /// Goes on from the state before the last, which is dropped: for a last state that is damaged
    /// or went wrong.
    #[arg(long)]
    previous: bool,
    #[command(flatten)]
    common: Common,
}

impl RunArgs {
    /// Runs the scenes; returns the exit code.
    pub(crate) fn run(&self) -> Result<u8, Failure> {
        self.common.run(&self.scenes, &Options { overwrite: self.overwrite, ..Options::default() })
    }
}

impl ResumeArgs {
    /// Goes on with the scenes; returns the exit code.
    pub(crate) fn run(&self) -> Result<u8, Failure> {
        let [resume, resume_previous] = [!self.previous, self.previous];
        self.common.run(&self.scenes, &Options { resume, resume_previous, ..Options::default() })
    }
}

impl Common {
    fn run(&self, scenes: &[String], options: &Options) -> Result<u8, Failure> {
        let stop = stop_on_interrupt()?;
        let shipped = Shipped::default();
        let several = scenes.len() > 1;
        let (mut table, mut worst) = (String::new(), 0);
        for scene in scenes {
            let name = Path::new(scene).file_stem().unwrap_or_default().to_string_lossy();
            if stop.load(Ordering::Relaxed) {
                table += &empty_row(&name, "**not run**: stopped before");
                continue;
            }
            let out = self.out.as_ref().map(|out| if several { out.join(&*name) } else { out.clone() });
            let options = Options { threads: self.threads.into(), quiet: self.quiet, out, ..options.clone() };
            let ran = shipped.path(scene).and_then(|path| self.run_one(&path, &options, &mut table, &stop));
            let code = ran.unwrap_or_else(|failure| {
                table += &empty_row(&name, &format!("**error**: {}", failure.message()));
                failure.report()
            });
            worst = worst.max(code);
        }
        if several && !self.json {
            print(&format!("{TABLE_HEAD}{table}"))?;
        }
        Ok(worst)
    }

    /// Runs one scene and adds its row to the table; returns the exit code.
    fn run_one(
        &self,
        path: &Path,
        options: &Options,
        table: &mut String,
        stop: &AtomicBool,
    ) -> Result<u8, Failure> {
        let scene = Scene::load(path, &self.set).map_err(Failure::of_input)?;
        let result = scene.run(options, stop).map_err(Failure::of_run)?;
        if self.json {
            let both = json!({ "result": result.result, "timings": result.timings });
            print(&format!("{both:#}\n"))?;
        } else if !self.quiet {
            print(&result.summary())?;
        }
        *table += &result.row();
        Ok(match result.ending {
            Ending::Done | Ending::Steady | Ending::Event => 0,
            Ending::NotConverged => 3,
            Ending::Stopped => 130,
        })
    }
}

/// Flag that Ctrl-C sets; a second one ends the program at once.
pub(crate) fn stop_on_interrupt() -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    let handler = ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    handler.map_err(Failure::of_output)?;
    Ok(stop)
}
