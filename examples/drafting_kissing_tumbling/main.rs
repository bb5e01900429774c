//! Two discs sink one behind the other in a plane box: they draft, kiss and tumble (Uhlmann 2005, J. Comput. Phys. 209, 448). Or one alone sinks
//! (Glowinski et al. 2001, J. Comput. Phys. 169, 363; Wan & Turek 2006, Int. J. Numer. Meth. Fluids 51, 531).
//!
//! Box 2 × 6 cm, gravity along the long side, discs of 0.25 cm. Two: ρ_s/ρ_f = 1.5, ν = 0.01 cm²/s, the upper one 1 cm below the top, the other
//! 0.5 cm further down, 0.001 cm to either side of the middle line. One: ρ_s/ρ_f = 1.25, ν = 0.1 cm²/s, 4 cm above the floor. From when the two touch
//! on, small differences grow: contact model and resolution decide on which side the trailing disc falls and when.
//!
//! Sample runs:
//! ```text
//! cargo run --release --example drafting_kissing_tumbling
//! cargo run --release --example drafting_kissing_tumbling -- --bodies 1
//! cargo run --release --example drafting_kissing_tumbling -- --cells-per-diameter 64 --no-vtk
//! ```
mod report;

use clap::Parser;
use example_support::Outcome;
use example_support::coupled::{Motion, Plan, RunOptions, run};
use example_support::granular::{Ending, main_of};
use example_support::sinking_discs::{FLUID_DENSITY, SinkingDiscs};
use siltflow::dem::{Chen, ContactLaw};
use siltflow::ibm::SmoothForcing;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// Two discs sink one behind the other: they draft, kiss and tumble; or one alone.
#[derive(Clone, Debug, Parser)]
#[command(version)]
struct Cli {
    /// Two discs or one.
    #[arg(long, default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=2))]
    bodies: u8,
    /// Cells across a disc, at least 4.
    #[arg(long, default_value_t = 32)]
    cells_per_diameter: usize,
    /// Coefficient of friction between the discs.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true)]
    friction: f64,
    /// Cells over which the discs and the walls repel one another (Uhlmann's: two); 0: they just collide.
    #[arg(long, default_value_t = 2.0, allow_negative_numbers = true)]
    repulsion: f64,
    #[command(flatten)]
    run: RunOptions,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let scene = match cli.bodies {
        1 => SinkingDiscs::single(cli.cells_per_diameter),
        _ => SinkingDiscs::drafting(cli.cells_per_diameter),
    };
    let scene = SinkingDiscs { friction: cli.friction, ..scene };
    main_of(cli.run.threads, |stop| match cli.repulsion {
        0.0 => sink(&cli, &scene, Chen::default(), stop),
        cells => sink(&cli, &scene, scene.repulsive(cells)?, stop),
    })
}

fn sink<L: ContactLaw>(cli: &Cli, scene: &SinkingDiscs, law: L, stop: &AtomicBool) -> Outcome<Ending> {
    let end = if cli.bodies == 1 { 0.9 } else { 0.3 };
    let mut forcing = SmoothForcing::new(FLUID_DENSITY);
    if let Some(kernel) = cli.run.kernel {
        forcing = forcing.with_kernel(kernel);
    }
    let setup = format!("{scene:?} {law:?}");
    let mut fall = scene.build(forcing, law)?;
    let out = cli.run.out.clone().unwrap_or_else(|| "out/drafting_kissing_tumbling".into());
    let plan = Plan { end: cli.run.end.unwrap_or(end), out: &out, setup: &setup, view: scene.view() };
    let record = run(&mut fall, &cli.run, &plan, Motion::default(), stop)?;
    match cli.bodies {
        1 => report::one(scene, &record, &plan, cli.run.no_images)?,
        _ => report::two(scene, &record, &plan, cli.run.no_images)?,
    }
    Ok(record.ending)
}
