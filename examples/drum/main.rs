//! Grains in a turning drum: the dynamic angle of repose.
//!
//! The drum is one body, a union of convex staves, that turns as it is told and cannot be moved; it repeats along its axis, so it has no end walls. Every
//! other stave stands out by half a grain, so that grains do not slide along the wall. Measured: the angle between the vertical and the line from the
//! axis to the grains' centre of mass, which is the slope of a flat surface, and the slope of the line through the highest grains of columns in the
//! middle half. Both rise with friction (Pohlman et al. 2006, Powder Technology 161, 111, measure them so).
//!
//! Sample runs:
//! ```text
//! cargo run --release --example drum                                # 900 spheres, 3 s, about two minutes
//! cargo run --release --example drum -- --friction 0.1
//! cargo run --release --example drum -- --colour side --speed 3     # mixing: left and right half at the start
//! cargo run --release --example drum -- --shape cube --number 300
//! ```
mod barrel;

use barrel::Barrel;
use clap::{Parser, ValueEnum};
use example_support::Outcome;
use example_support::granular::report::{common, late, over_time, with_level};
use example_support::granular::{Ending, GRAVITY, GrainOptions, History, RunOptions, main_of, run};
use example_support::table::{Table, number, write_json};
use render::sketch::draw;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// Grains in a turning drum.
#[derive(Clone, Debug, Parser)]
#[command(version)]
pub(crate) struct Cli {
    /// How many grains.
    #[arg(long, default_value_t = 900)]
    pub(crate) number: usize,
    /// Inner radius of the drum [m].
    #[arg(long, default_value_t = 0.06, allow_negative_numbers = true)]
    pub(crate) radius: f64,
    /// Length after which it repeats [m].
    #[arg(long, default_value_t = 0.04, allow_negative_numbers = true)]
    pub(crate) length: f64,
    /// Angular velocity [rad/s], clockwise as it is drawn.
    #[arg(long, default_value_t = 1.5, allow_negative_numbers = true)]
    pub(crate) speed: f64,
    /// What colours the grains.
    #[arg(long, value_enum, default_value_t = Colour::Speed)]
    pub(crate) colour: Colour,
    #[command(flatten)]
    pub(crate) grains: GrainOptions,
    #[command(flatten)]
    pub(crate) run: RunOptions,
}

/// What colours the grains.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Colour {
    /// How fast they are.
    Speed,
    /// On which side they were at the start.
    Side,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    main_of(cli.run.threads, |stop| turn(&cli, stop))
}

fn turn(cli: &Cli, stop: &AtomicBool) -> Outcome<Ending> {
    let (mut barrel, mut bodies) = Barrel::build(cli)?;
    let end = cli.run.end.unwrap_or(3.0);
    let out = cli.run.out.clone().unwrap_or_else(|| "out/drum".into());
    let setup = format!("{:?}", (cli.number, cli.radius, cli.length, cli.speed, &cli.grains));
    let (ending, history) = run(&mut barrel, &mut bodies, &cli.run, (end, &out, &setup), stop)?;
    tell(cli, &history, &out)?;
    Ok(ending)
}

fn tell(cli: &Cli, history: &History, out: &Path) -> Outcome<()> {
    let (angle, swing) = late(history, "angle");
    let (slope, _) = late(history, "surface_slope");
    let mut table = Table::new();
    table.section("Drum");
    common(&mut table, history);
    table.row("Froude number ω²R/g", number(cli.speed * cli.speed * cli.radius / GRAVITY), "");
    table.row("dynamic angle of repose, by the centre of mass", number(angle), "°");
    table.row("its standard deviation over time", number(swing), "°");
    table.row("by the surface", number(slope), "°");
    table.note("means over the second half of the run");
    println!("{table}\n  pictures and files: {}", out.display());
    let result = serde_json::json!({
        "grains": cli.number, "friction": cli.grains.friction, "angle": angle, "angle_deviation": swing,
        "surface_slope": slope,
    });
    write_json(&out.join("result.json"), &result)?;
    if !cli.run.no_images {
        let text = format!("mean of the second half: {}°", number(angle));
        let curves = [
            with_level(
                over_time(history, "angle", 1.0, "Angle of the centre of mass", "degrees"),
                angle,
                "centre of mass",
                &text,
            ),
            over_time(history, "surface_slope", 1.0, "Slope of the surface", "degrees"),
            over_time(history, "kinetic_energy", 1e3, "Kinetic energy of all grains", "mJ"),
            over_time(history, "coordination", 1.0, "Contacts per grain", ""),
        ];
        draw(&out.join("summary.png"), 2, &curves)?;
    }
    Ok(())
}
