//! Grains are poured onto a tray and make a heap: its angle of repose.
//!
//! Grains come in at a spout, during the run, and fall onto the middle of a round tray with a low rim; what does not stay on the heap rolls over the
//! rim. The angle is that of the line through the highest tops in rings around the axis, between 0.35 and 0.95 of the tray's radius. It rises with
//! friction, and more with rolling friction (Zhou et al. 2002, Powder Technology 125, 45).
//!
//! Sample runs:
//! ```text
//! cargo run --release --example pouring                                          # 2000 spheres, about two minutes
//! cargo run --release --example pouring -- --friction 0.1
//! cargo run --release --example pouring -- --rolling-friction 0.1
//! cargo run --release --example pouring -- --shape ellipsoid --number 800
//! ```
mod tray;

use clap::Parser;
use example_support::Outcome;
use example_support::granular::report::{common, last, late, over_time};
use example_support::granular::{Ending, GrainOptions, History, RunOptions, main_of, run};
use example_support::table::{Table, number, write_json};
use render::sketch::draw;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use tray::Tray;

/// Grains are poured onto a tray and make a heap.
#[derive(Clone, Debug, Parser)]
#[command(version)]
pub(crate) struct Cli {
    /// How many grains.
    #[arg(long, default_value_t = 2000)]
    pub(crate) number: usize,
    /// Radius of the tray [m]; without it, such that half of the grains make a heap of 22 degrees on it.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) radius: Option<f64>,
    /// Height of the spout over the tray [m]; without it, a little above the heap's top.
    #[arg(long, allow_negative_numbers = true)]
    pub(crate) spout: Option<f64>,
    #[command(flatten)]
    pub(crate) grains: GrainOptions,
    #[command(flatten)]
    pub(crate) run: RunOptions,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    main_of(cli.run.threads, |stop| pour(&cli, stop))
}

fn pour(cli: &Cli, stop: &AtomicBool) -> Outcome<Ending> {
    let end = cli.run.end.unwrap_or(2.0);
    cli.run.check(end)?;
    let (mut tray, mut bodies) = Tray::build(cli, end)?;
    let out = cli.run.out.clone().unwrap_or_else(|| "out/pouring".into());
    let setup = format!("{:?}", (cli.number, cli.radius, cli.spout, &cli.grains));
    let (ending, history) = run(&mut tray, &mut bodies, &cli.run, (end, &out, &setup), stop)?;
    tell(cli, &history, &out)?;
    Ok(ending)
}

fn tell(cli: &Cli, history: &History, out: &Path) -> Outcome<()> {
    let mut table = Table::new();
    table.section("Pouring");
    common(&mut table, history);
    table.row("angle of repose at the end", number(last(history, "angle")), "°");
    table.row("mean of the last half", number(late(history, "angle").0), "°");
    table.row("grains over the rim", last(history, "over_the_rim"), "");
    println!("{table}\n  pictures and files: {}", out.display());
    let result = serde_json::json!({
        "grains": last(history, "grains"), "friction": cli.grains.friction,
        "rolling_friction": cli.grains.rolling_friction, "angle": last(history, "angle"),
        "over_the_rim": last(history, "over_the_rim"), "kinetic_energy": last(history, "kinetic_energy"),
    });
    write_json(&out.join("result.json"), &result)?;
    if !cli.run.no_images {
        let curves = [
            over_time(history, "angle", 1.0, "Angle of the heap's flank", "degrees"),
            over_time(history, "grains", 1.0, "Grains", ""),
            over_time(history, "kinetic_energy", 1e3, "Kinetic energy of all grains", "mJ"),
            over_time(history, "coordination", 1.0, "Contacts per grain", ""),
        ];
        draw(&out.join("summary.png"), 2, &curves)?;
    }
    Ok(())
}
