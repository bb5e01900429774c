//! A dense suspension of polyhedra settles in a fluid and becomes a bed.
//!
//! 500 irregular convex polyhedra of 26 vertices, of twenty shapes and of 85 % to 115 % of the middle diameter, fill 0.4 of a closed box of fluid at
//! random; they are 2.5 times as heavy as the fluid. They are placed by random addition in a higher box whose lid then comes down step by step, bodies that overlap
//! being moved and turned apart, all of it 3 % larger than they are. Then fluid and bodies are let go from rest. Every body is resolved by the grid and the
//! markers on its surface; bodies that touch push and rub by Chen's law on the volume that they share.
//!
//! With `--lubrication` the films between bodies that are close, which the grid does not resolve, act as well (`Lubricated`).
//!
//! Told at the end: where the bodies are, the books of momentum and energy, the porosity of the bed, and what each module cost. The porosity is that
//! from a quarter to seven tenths of the height below which 19 of 20 centres are, away from floor and surface, over the whole width, and without what is
//! less than a diameter from a wall; bodies are cut exactly where these regions end.
//!
//! Sample runs:
//! ```text
//! cargo run --release --example dense_suspension                                            # 500 bodies, 8 cells per diameter: about 13 CPU minutes
//! cargo run --release --example dense_suspension -- --bodies 40 --cells-per-diameter 6      # half a minute
//! cargo run --release --example dense_suspension -- --periodic --friction 0
//! ```
mod report;

use clap::Parser;
use example_support::Outcome;
use example_support::coupled::{Plan, RunOptions, run};
use example_support::granular::{Ending, main_of};
use example_support::suspension::{Diary, Portraits, Suspension};
use siltflow::dem::{Chen, ContactLaw};
use siltflow::ibm::SmoothForcing;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// A dense suspension of polyhedra settles in a fluid and becomes a bed.
#[derive(Clone, Debug, Parser)]
#[command(version, mut_arg("courant", |a| a.default_value("0.3")))]
struct Cli {
    /// How many bodies.
    #[arg(long, default_value_t = 500)]
    bodies: usize,
    /// Cells across a body of the middle diameter, at least 5.
    #[arg(long, default_value_t = 8)]
    cells_per_diameter: usize,
    /// Solid fraction at the start, at most 0.5.
    #[arg(long, default_value_t = 0.4, allow_negative_numbers = true)]
    fraction: f64,
    /// Middle diameter of spheres of the bodies' volumes, in m.
    #[arg(long, default_value_t = 2e-3, allow_negative_numbers = true)]
    diameter: f64,
    /// Diameters are drawn evenly from 1 − spread to 1 + spread times the middle one.
    #[arg(long, default_value_t = 0.15, allow_negative_numbers = true)]
    spread: f64,
    /// Density of the bodies over that of the fluid.
    #[arg(long, default_value_t = 2.5, allow_negative_numbers = true)]
    density_ratio: f64,
    /// Kinematic viscosity of the fluid in m²/s.
    #[arg(long, default_value_t = 1e-5, allow_negative_numbers = true)]
    viscosity: f64,
    /// Coefficient of friction, between bodies and at walls.
    #[arg(long, default_value_t = 0.3, allow_negative_numbers = true)]
    friction: f64,
    /// Young's modulus in Pa. Steps of the contacts get shorter with its root; a soft one makes bodies sink into one another.
    #[arg(long, default_value_t = 3e5, allow_negative_numbers = true)]
    youngs_modulus: f64,
    /// Model what the grid does not resolve of the films between bodies that are close.
    #[arg(long)]
    lubrication: bool,
    /// No walls at the sides: the box repeats.
    #[arg(long)]
    periodic: bool,
    /// Seed of all that is drawn at random.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    run: RunOptions,
}

impl Cli {
    fn scene(&self) -> Suspension {
        Suspension {
            number: self.bodies,
            fraction: self.fraction,
            diameter: self.diameter,
            spread: self.spread,
            cells_per_diameter: self.cells_per_diameter,
            density_ratio: self.density_ratio,
            viscosity: self.viscosity,
            friction: self.friction,
            youngs_modulus: self.youngs_modulus,
            periodic: self.periodic,
            seed: self.seed,
        }
    }
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    main_of(cli.run.threads, |stop| match cli.lubrication {
        true => settle(&cli, cli.scene().lubricated()?, stop),
        false => settle(&cli, Chen::default(), stop),
    })
}

fn settle<L: ContactLaw>(cli: &Cli, law: L, stop: &AtomicBool) -> Outcome<Ending> {
    let scene = cli.scene();
    let mut forcing = SmoothForcing::new(scene.fluid().density);
    if let Some(kernel) = cli.run.kernel {
        forcing = forcing.with_kernel(kernel);
    }
    let setup = format!("{scene:?} {law:?}");
    let mut fall = scene.build(forcing, law)?;
    let out = cli.run.out.clone().unwrap_or_else(|| "out/dense_suspension".into());
    let plan =
        Plan { end: cli.run.end.unwrap_or(scene.end()), out: &out, setup: &setup, view: scene.view(&fall) };
    let portraits = if cli.run.no_images { None } else { Some(Portraits::new(&out, &fall, scene.periodic)?) };
    let diary = Diary::new(scene.diameter, scene.periodic, portraits);
    let record = run(&mut fall, &cli.run, &plan, diary, stop)?;
    report::tell(&scene, &fall, &record, &plan, cli.run.no_images)?;
    Ok(record.ending)
}
