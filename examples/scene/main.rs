//! Runs a scene file.
//!
//! ```text
//! cargo run --release --example scene -- scenes/cavity.toml
//! cargo run --release --example scene -- scenes/cavity.toml --check
//! cargo run --release --example scene -- scenes/two_discs.toml --set fluid.nu=2e-6 --set time.end=0.1 --threads 2
//! cargo run --release --example scene -- scenes/two_discs.toml --resume              # or
//! --overwrite, after Ctrl-C
//! cargo run --release --example scene -- scenes/*.toml --quiet         # all of them, with a table at the end
//! ```
//!
//! Ctrl-C stops a run with whole files and a saved state. Exit codes: 0 done, 1 an error of the run, 2 an error of the scene or the command line, 3 not converged,
//! 130 stopped.
use clap::Parser;
use scene::{Ending, Options, RunError, Scene, TABLE_HEAD, empty_row};
use serde_json::json;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Runs a scene of flow and bodies from a TOML file. docs/scene.md lists all keys.
#[derive(Parser, Debug)]
#[command(version)]
struct Cli {
    /// The scene files; of several a table is printed at the end.
    #[arg(required_unless_present_any = ["manual", "schema"])]
    scenes: Vec<PathBuf>,
    /// Sets a value, whatever the file says: --set fluid.nu=2e-6, --set bodies.0.density=1100.
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Checks the scene and tells what would be run: cells, memory, step, cost, what is at work and what is skipped.
    #[arg(long)]
    check: bool,
    /// Goes on from the state that an interrupted run of this scene saved.
    #[arg(long, conflicts_with = "check")]
    resume: bool,
    /// Goes on from the state saved before that one, which is dropped: for a last state that is
    /// damaged or went wrong.
    #[arg(long, conflicts_with_all = ["check", "resume"])]
    resume_previous: bool,
    /// Begins anew where an interrupted run has left its state, which is deleted.
    #[arg(long, conflicts_with_all = ["check", "resume", "resume_previous"])]
    overwrite: bool,
    /// Threads.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: u16,
    /// No progress and no summary.
    #[arg(long)]
    quiet: bool,
    /// Prints what result.json and timings.json hold instead of the summary.
    #[arg(long)]
    json: bool,
    /// Folder for the files, whatever the scene says.
    #[arg(long)]
    out: Option<PathBuf>,
    /// Prints the manual of scene files (docs/scene.md).
    #[arg(long)]
    manual: bool,
    /// Prints the schema of scene files as JSON Schema (scenes/schema.json).
    #[arg(long)]
    schema: bool,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    if cli.manual || cli.schema {
        return code_of(print(&if cli.manual { scene::manual() } else { scene::json_schema() }), 0);
    }
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    let handler = ctrlc::set_handler(move || {
        // A second Ctrl-C ends the program at once.
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    if let Err(error) = handler {
        return fail(1, &error);
    }
    let several = cli.scenes.len() > 1;
    let (mut table, mut worst) = (String::new(), 0);
    for path in &cli.scenes {
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        if stop.load(Ordering::Relaxed) {
            table += &empty_row(&name, "**not run**: stopped before");
            continue;
        }
        let code = match one(&cli, path, several, &mut table, &stop) {
            Ok(code) => code,
            Err((code, error)) => {
                fail(code, &*error);
                table += &empty_row(&name, &format!("**error**: {error}"));
                code
            }
        };
        worst = worst.max(code);
    }
    let printed = if several && !cli.check { print(&format!("{TABLE_HEAD}{table}")) } else { Ok(()) };
    code_of(printed, worst)
}

type Failure = (u8, Box<dyn std::error::Error>);

/// Checks or runs one scene; answers the exit code.
fn one(cli: &Cli, path: &Path, several: bool, table: &mut String, stop: &AtomicBool) -> Result<u8, Failure> {
    let scene = Scene::load(path, &cli.set).map_err(|e| (2, e.into()))?;
    if cli.check {
        let plan = scene.plan().map_err(|e| (2, e.into()))?;
        print(&plan.to_string())?;
        return Ok(0);
    }
    // A folder of its own for each.
    let out = cli.out.as_ref().map(|out| match path.file_stem() {
        Some(name) if several => out.join(name),
        _ => out.clone(),
    });
    let options = Options {
        threads: cli.threads.into(),
        resume: cli.resume,
        resume_previous: cli.resume_previous,
        overwrite: cli.overwrite,
        quiet: cli.quiet,
        out,
    };
    let result = scene.run(&options, stop).map_err(|e| (code_of_error(&e), e.into()))?;
    if cli.json {
        let both = json!({ "result": result.result, "timings": result.timings });
        print(&format!("{both:#}\n"))?;
    } else if !cli.quiet {
        print(&result.summary())?;
    }
    *table += &result.row();
    Ok(match result.ending {
        Ending::Done => 0,
        Ending::NotConverged => 3,
        Ending::Stopped => 130,
    })
}

/// Exit code of an error of a run: what a check finds has that of a check.
fn code_of_error(error: &RunError) -> u8 {
    if matches!(error, RunError::Build(_)) { 2 } else { 1 }
}

fn fail(code: u8, error: &dyn std::error::Error) -> ExitCode {
    let _ = writeln!(std::io::stderr(), "error: {error}");
    ExitCode::from(code)
}

/// This code, unless something could not be printed.
fn code_of(printed: Result<(), Failure>, code: u8) -> ExitCode {
    match printed {
        Ok(()) => ExitCode::from(code),
        Err((code, error)) => fail(code, &*error),
    }
}

/// Nobody may be reading any more: that is no error. A full disk is one.
fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err((1, format!("what was to be printed could not be: {error}").into()))
        }
        _ => Ok(()),
    }
}
