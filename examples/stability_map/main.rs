//! Where the coupling is stable: bodies from far lighter to far heavier than the fluid, at several Courant numbers, in several shapes.
//!
//! One body (a sphere, an ellipsoid with axes 1 : 1.5 : 2, a rock from an STL file) of every density ratio ρ_s/ρ is let go in fluid at rest, in a
//! periodic box of 4 × 4 × 8 diameters of a sphere of its volume, at Galileo number √(|ρ_s/ρ − 1| g d³)/ν = 50. Nothing is tuned: one pressure solution
//! per step by the coupling's own choices. Speeds at t√(g/d) = 10 and 30 are held against those of the finest run (`--finest` cells per diameter).
//!
//! Sample run: `cargo run --release --example stability_map -- --ratios 0.001,1.1 --shapes sphere --cells 8 --finest 12`, a minute or so. All of it
//! (no flags) takes an hour. Every run that is done is written to `map.csv` at once, and is not made again. `--no-runs` draws what is there. Files are in `out/stability_map`: `map.csv`,
//! `stability_map.png`, `rock.stl`.
mod map;
mod report;

use clap::Parser;
use example_support::{Outcome, told};
use map::{Kind, Map, Viscous};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, Parser)]
#[command(about = "Bodies from far lighter to far heavier than the fluid, at several Courant numbers")]
pub(crate) struct Options {
    /// ρ_s/ρ.
    #[arg(long, value_delimiter = ',', default_value = "0.001,0.01,0.1,0.5,0.9,1.1,2.5,10,1000")]
    ratios: Vec<f64>,
    /// Courant numbers that the step may reach; with explicit diffusion it also stays within that limit.
    #[arg(long, value_delimiter = ',', default_value = "0.1,0.5,0.9")]
    courants: Vec<f64>,
    /// Shapes.
    #[arg(long, value_enum, value_delimiter = ',', default_value = "sphere,ellipsoid,rock")]
    shapes: Vec<Kind>,
    /// A closed triangle mesh (STL) instead of the rock; its volume is made that of the others.
    #[arg(long)]
    stl: Option<PathBuf>,
    /// Cells per diameter.
    #[arg(long, default_value_t = 12)]
    cells: usize,
    /// Cells per diameter of the finest run, at Courant number 0.25; 0: none.
    #[arg(long, default_value_t = 16)]
    finest: usize,
    /// Viscous terms: explicit, implicit, or implicit where the step asks for it.
    #[arg(long, value_enum, default_value = "auto")]
    diffusion: Viscous,
    /// Galileo number.
    #[arg(long, default_value_t = 50.0)]
    galileo: f64,
    /// End time in √(d/g).
    #[arg(long, default_value_t = 30.0)]
    end: f64,
    /// Folder for all files.
    #[arg(long, default_value = "out/stability_map")]
    out: PathBuf,
    /// Make the runs that are in map.csv anew.
    #[arg(long)]
    anew: bool,
    /// Make no runs: table and picture of those that are in map.csv.
    #[arg(long, conflicts_with = "anew")]
    no_runs: bool,
}

fn main() -> ExitCode {
    told(run())
}

fn run() -> Outcome<()> {
    let options = Options::parse();
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| {
        let map = Map::run(&options)?;
        report::write(&options, &map)
    })
}
