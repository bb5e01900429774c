//! Reduced models of falling discs at times and parameters that are not among their samples.
//!
//! λ and the paths of the discs are simulated. sPODIANN ([`mor::models::Spodiann`]) is fitted to a
//! part of the snapshots and compared with the projection of the others on its modes:
//!
//! - `ten`: ten discs, every other snapshot;
//! - `densities`: two discs, five densities of the upper one, and four densities between them;
//! - `viscosities`: two discs, five viscosities of the fluid, and four viscosities between them.
//!
//! ```text
//! cargo run --release --example unseen_falls
//! cargo run --release --example unseen_falls -- --kinds ten --seeds 1 --rank 2
//! ```
#[path = "../reduced_discs/fall.rs"]
#[expect(dead_code, reason = "shared with examples that need more of a run")]
mod fall;
mod study;

use clap::{Parser, ValueEnum};
use example_support::Outcome;
use example_support::granular::{Ending, main_of};
use example_support::scene::Scene;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use study::{Part, Run};

/// Reduced models of falling discs at unseen times and parameters.
#[derive(Clone, Debug, Parser)]
#[command(version)]
struct Cli {
    /// Inputs that are unseen.
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = Kind::value_variants().to_vec())]
    kinds: Vec<Kind>,
    /// Seeds of densities, starting places and networks.
    #[arg(long, value_delimiter = ',', default_values_t = [1, 2, 3])]
    seeds: Vec<u64>,
    /// Cells across a disc.
    #[arg(long, default_value_t = 12)]
    cells_per_diameter: usize,
    /// End time of ten discs [s].
    #[arg(long, default_value_t = 0.6)]
    end: f64,
    /// End time of runs with parameters [s].
    #[arg(long, default_value_t = 0.3)]
    end_of_runs: f64,
    /// Modes of each of ten discs.
    #[arg(long, default_value_t = 3)]
    rank: usize,
    /// Modes of each of two discs.
    #[arg(long, default_value_t = 5)]
    rank_of_two: usize,
    /// Snapshots of ten discs that make the model; as many less one are between.
    #[arg(long, default_value_t = 201)]
    snapshots: usize,
    /// Snapshots of each run with parameters.
    #[arg(long, default_value_t = 61)]
    snapshots_of_runs: usize,
    /// Half the range of densities [kg/m³].
    #[arg(long, default_value_t = 10.0)]
    density_range: f64,
    /// Half the range of viscosities, relative to that of water.
    #[arg(long, default_value_t = 0.2)]
    viscosity_range: f64,
}

/// Inputs that are unseen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Kind {
    Ten,
    Densities,
    Viscosities,
}

/// Parameters of runs that make the model, and of those that do not, in half ranges.
const KNOWN: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
const UNSEEN: [f64; 4] = [-0.8, -0.3, 0.25, 0.7];

fn main() -> ExitCode {
    let cli = Cli::parse();
    main_of(1, |stop| run(&cli, stop))
}

/// Number k of an evenly distributed sequence in [−1, 1].
fn spread(seed: u64, k: usize) -> f64 {
    let golden = 0.618_033_988_749_895;
    2.0 * (golden * (17 * seed + k as u64) as f64).fract() - 1.0
}

fn run(cli: &Cli, stop: &AtomicBool) -> Outcome<Ending> {
    for &seed in &cli.seeds {
        for &kind in &cli.kinds {
            let Some([known, unseen]) = parts(cli, kind, seed, stop)? else { return Ok(Ending::Stopped) };
            let (name, ranks) = match kind {
                Kind::Ten => ("ten discs", vec![cli.rank; 10]),
                Kind::Densities => ("five densities", vec![cli.rank_of_two; 2]),
                Kind::Viscosities => ("five viscosities", vec![cli.rank_of_two; 2]),
            };
            println!("{}", study::table(&format!("{name}, seed {seed}"), &ranks, &known, &unseen, seed)?);
        }
    }
    Ok(Ending::Whole)
}

/// Snapshots that make the model, and others; `None` if stopped.
fn parts(cli: &Cli, kind: Kind, seed: u64, stop: &AtomicBool) -> Outcome<Option<[Part; 2]>> {
    let place = |k: usize| 0.5e-3 * spread(seed, k) / cli.cells_per_diameter as f64;
    let scene = Scene {
        cells_per_diameter: cli.cells_per_diameter,
        aside: 0.1e-3 + 0.05e-3 * spread(seed, 2),
        shift: [place(0), place(1)],
        ..Scene::default()
    };
    if kind == Kind::Ten {
        let densities = (0..10).map(|k| 1040.0 + 15.0 * spread(seed, k + 3)).collect();
        let scene = Scene { bodies: 10, densities, ..scene };
        let Some(fallen) = fall::run(&scene, cli.end, 2 * (cli.snapshots - 1), stop)? else {
            return Ok(None);
        };
        let runs = [Run { parameter: None, fallen }];
        return Ok(Some([0, 1].map(|first| Part::new(&runs, first, 2))));
    }
    let runs = |values: &[f64]| -> Outcome<Option<Vec<Run>>> {
        let mut runs = Vec::new();
        for value in values {
            let density = 1050.0 + cli.density_range * value;
            let viscosity = scene.viscosity * (1.0 + cli.viscosity_range * value);
            let (scene, parameter) = if kind == Kind::Densities {
                (Scene { densities: vec![density, 1030.0], ..scene.clone() }, density)
            } else {
                (Scene { viscosity, densities: vec![1050.0, 1030.0], ..scene.clone() }, viscosity)
            };
            let Some(fallen) = fall::run(&scene, cli.end_of_runs, cli.snapshots_of_runs - 1, stop)? else {
                return Ok(None);
            };
            runs.push(Run { parameter: Some(parameter), fallen });
        }
        Ok(Some(runs))
    };
    let (Some(known), Some(unseen)) = (runs(&KNOWN)?, runs(&UNSEEN)?) else { return Ok(None) };
    Ok(Some([Part::new(&known, 0, 1), Part::new(&unseen, 0, 1)]))
}
