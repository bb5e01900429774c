//! The command `siltflow`: flow and bodies from scene files.
//!
//! ```text
//! siltflow list                                  # scenes that come with the command
//! siltflow run two_discs                         # one of them
//! siltflow new first.toml                        # a scene to begin with
//! siltflow check first.toml                      # cells, memory, steps, cost, doubts
//! siltflow run first.toml --set time.end=0.1 --threads 2
//! siltflow resume first.toml                     # after Ctrl-C
//! siltflow mesh rock.stl --unit 1e-3 --picture rock.png
//! siltflow report out/first                      # its page again; of several runs, a comparison
//! siltflow table                                 # results beside references, sources, tolerances
//! siltflow predict out/reduced_discs/models/velocity.model --at 0.31
//! ```
mod check;
mod mesh;
mod outcome;
mod predict;
mod report;
mod run;
mod shipped;
mod table;
mod template;

use crate::report::ReportArgs;
use check::CheckArgs;
use clap::{Parser, Subcommand};
use mesh::MeshArgs;
use outcome::{Failure, print};
use predict::PredictArgs;
use run::{ResumeArgs, RunArgs};
use std::path::PathBuf;
use std::process::ExitCode;
use table::TableArgs;

/// Particle-resolved flow from scene files.
#[derive(Parser)]
#[command(version, after_help = outcome::EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Runs scenes; of several, a table of times and errors is printed at the end.
    Run(RunArgs),
    /// Goes on with a run that was stopped or killed.
    Resume(ResumeArgs),
    /// Tells what runs of scenes would take, and what is wrong with the files.
    Check(CheckArgs),
    /// Makes a page (HTML) of the folders of one or several runs.
    Report(ReportArgs),
    /// Examines a mesh file (STL, OBJ): faults, thin walls, mass properties, a picture.
    Mesh(MeshArgs),
    /// Prints the references of scenes beside the results of their runs.
    Table(TableArgs),
    /// Predicts fields by a reduced model that a run has left.
    Predict(PredictArgs),
    /// Lists the scenes that come with the command and are run by their names.
    List {
        /// Prints JSON.
        #[arg(long)]
        json: bool,
    },
    /// Writes a scene file with comments, to begin with.
    New {
        /// Its path, which must not exist.
        path: PathBuf,
    },
    /// Prints the manual of scene files.
    Manual,
    /// Prints the JSON Schema of scene files, for editors.
    Schema,
}

fn main() -> ExitCode {
    let done = match Cli::parse().command {
        Command::Run(args) => args.run(),
        Command::Resume(args) => args.run(),
        Command::Check(args) => args.check(),
        Command::Report(args) => args.report(),
        Command::Mesh(args) => args.mesh(),
        Command::Table(args) => args.table(),
        Command::Predict(args) => args.predict(),
        Command::List { json } => print(&shipped::list(json)).map(|()| 0),
        Command::New { path } => template::write(&path).map(|()| 0),
        Command::Manual => print(&scene::manual()).map(|()| 0),
        Command::Schema => print(&scene::json_schema()).map(|()| 0),
    };
    done.unwrap_or_else(Failure::report).into()
}
