//! Bodies of any shape fall into a box and come to rest.
//!
//! Measured: energies, contacts per grain, and the solid fraction between a quarter and seven tenths of the height, away from floor and surface.
//! Frictionless spheres between periodic sides should come to random close packing, 0.63–0.64, with μ = 0.5 to 0.58–0.60 (Scott & Kilgour 1969,
//! J. Phys. D 2, 863; Silbert 2010, Soft Matter 6, 2918).
//!
//! Sample runs:
//! ```text
//! cargo run --release --example settling                                       # 400 spheres, cubes, ellipsoids, polyhedra: about two minutes
//! cargo run --release --example settling -- --shape sphere --spread 1.4 --number 2000
//! cargo run --release --example settling -- --table out/settling/bodies.csv --out out/again  # goes on from a table
//! cargo run --release --example settling -- --stl rock.stl --number 50
//!
//! # random close packing, several minutes each
//! cargo run --release --example settling -- --shape sphere --periodic --number 3000 --start random --friction 0 --youngs-modulus 1e9 --end 0.8
//! cargo run --release --example settling -- --shape sphere --periodic --number 3000 --start random --youngs-modulus 1e9 --end 0.8
//! ```
mod heap;

use clap::{Parser, ValueEnum};
use example_support::Outcome;
use example_support::granular::report::{common, last, over_time};
use example_support::granular::{Ending, GrainOptions, History, RunOptions, Start, main_of, run};
use example_support::table::{Table, number, write_json};
use heap::Heap;
use render::sketch::draw;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// Bodies of any shape fall into a box and come to rest.
#[derive(Clone, Debug, Parser)]
#[command(version, mut_arg("shape", |a| a.default_value("mixed")), mut_arg("youngs_modulus", |a| a.default_value("5e6")))]
pub(crate) struct Cli {
    /// How many grains.
    #[arg(long, default_value_t = 400)]
    pub(crate) number: usize,
    /// Grains from a table instead (CSV: x, y, z; qw, qx, qy, qz; vx, vy, vz, wx, wy, wz; size; kind), in the box 0 to width along x and y.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["number", "start", "stl"])]
    pub(crate) table: Option<PathBuf>,
    /// Width of the box [m]; without it, such that the heap is a little higher than wide.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) width: Option<f64>,
    /// No walls at the sides: the box repeats.
    #[arg(long)]
    pub(crate) periodic: bool,
    /// How grains are arranged at first.
    #[arg(long, value_enum, default_value_t = Start::Random)]
    pub(crate) start: Start,
    /// What colours the grains.
    #[arg(long, value_enum, default_value_t = Colour::Height)]
    pub(crate) colour: Colour,
    #[command(flatten)]
    pub(crate) grains: GrainOptions,
    #[command(flatten)]
    pub(crate) run: RunOptions,
}

/// What colours the grains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Colour {
    /// How high they were at the start.
    Height,
    /// How fast they are.
    Speed,
    /// How large they are.
    Size,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    main_of(cli.run.threads, |stop| settle(&cli, stop))
}

fn settle(cli: &Cli, stop: &AtomicBool) -> Outcome<Ending> {
    let (mut heap, mut bodies) = Heap::build(cli)?;
    let end = cli.run.end.unwrap_or(0.4);
    let out = cli.run.out.clone().unwrap_or_else(|| "out/settling".into());
    let setup = format!("{:?}", (cli.number, &cli.table, cli.width, cli.periodic, cli.start, &cli.grains));
    let (ending, history) = run(&mut heap, &mut bodies, &cli.run, (end, &out, &setup), stop)?;
    tell(cli, &history, &out)?;
    Ok(ending)
}

fn tell(cli: &Cli, history: &History, out: &Path) -> Outcome<()> {
    let mut table = Table::new();
    table.section("Settling");
    common(&mut table, history);
    table.row("solid fraction amid the heap", number(last(history, "fraction")), "");
    println!("{table}\n  pictures and files: {}", out.display());
    let result = serde_json::json!({
        "grains": last(history, "grains"), "fraction": last(history, "fraction"),
        "coordination": last(history, "coordination"), "overlap": last(history, "overlap"),
        "kinetic_energy": last(history, "kinetic_energy"), "outside": last(history, "outside"),
    });
    write_json(&out.join("result.json"), &result)?;
    if !cli.run.no_images {
        let curves = [
            over_time(history, "kinetic_energy", 1e3, "Kinetic energy of all grains", "mJ"),
            over_time(history, "fraction", 1.0, "Solid fraction amid the heap", ""),
            over_time(history, "coordination", 1.0, "Contacts per grain", ""),
            over_time(history, "overlap", 100.0, "Depth of overlaps by radius, mean", "%"),
        ];
        draw(&out.join("summary.png"), 2, &curves)?;
    }
    Ok(())
}
