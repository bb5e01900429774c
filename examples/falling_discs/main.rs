//! Two discs of different weight fall through a fluid (Isoz et al. 2023, section 5 and figure 9).
//!
//! The paper gives: two discs of d = 1 mm with ρ = 1060 and 1030 kg/m³ in a periodic box of 10 d × 20 d
//! filled with a fluid of ρ = 1000 kg/m³ and ν = 1e-6 m²/s, 45 000 cells (15 per d), 601 snapshots.
//! It leaves open, and this file chooses: gravity 9.81 m/s² along −y; the heavier disc starts at rest at
//! (5 d, 16 d), the lighter at (5.05 d, 13.5 d); 0.6 s; the net weight is balanced by a uniform body force,
//! since a periodic box has nothing else to bear it; contact: Young's modulus 1 MPa, Poisson's ratio 0.3,
//! damping 4, friction 0.3 (the discs hardly touch, unless on the `--floor`).
//!
//! Sample runs:
//! ```text
//! cargo run --release --example falling_discs
//! cargo run --release --example falling_discs -- --cells-per-diameter 30 --end 0.2 --no-images
//! cargo run --release --example falling_discs -- --floor --bodies 12
//! cargo run --release --example falling_discs -- --forcing hfdib      # the paper's forcing
//! ```
//!
//! The flags (cli.rs) become a scene (examples/support/src/scene.rs); `coupling::run` makes the steps and calls the
//! observers: files, ledger, progress, pictures, saved state (observers.rs); what came out is drawn and told (report.rs).
mod cli;
mod observers;
mod report;

use clap::Parser;
use cli::{BalanceChoice, Cli, ForcingChoice};
use example_support::scene::{FLUID, Scene};
use observers::{History, Pictures, Resumable, Save, Show};
use render::cpu::Stopwatch;
use siltflow::coupling::{self, FileOutput, Ledger, Schedule, WeightBalance};
use siltflow::ibm::{Forcing, Hfdib, SmoothForcing};
use std::error::Error;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

fn main() -> ExitCode {
    let cli = Cli::parse();
    match run(&cli) {
        Ok(Ending::Whole) => ExitCode::SUCCESS,
        // As shells do for a program that Ctrl-C ended.
        Ok(Ending::Stopped) => ExitCode::from(130),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Did the run come to its end?
enum Ending {
    Whole,
    Stopped,
}

fn run(cli: &Cli) -> Result<Ending, Box<dyn Error>> {
    if !(1..=256).contains(&cli.threads) {
        return Err(format!("{} threads; give 1 to 256", cli.threads).into());
    }
    if cli.snapshots < 2 {
        return Err(format!("{} snapshots; give at least 2, one at each end", cli.snapshots).into());
    }
    let scene = Scene {
        cells_per_diameter: cli.cells_per_diameter,
        bodies: cli.bodies,
        densities: cli.densities.clone(),
        diameter: cli.diameter,
        floor: cli.floor,
        balance: match cli.balance {
            BalanceChoice::NetWeight => WeightBalance::NetWeight,
            BalanceChoice::ZeroFlow => WeightBalance::ZeroFlow,
            BalanceChoice::None => WeightBalance::None,
        },
        // The paper's forcing lets the bodies' added mass act through the pressure, a step late.
        virtual_mass: (cli.forcing == ForcingChoice::Hfdib).then_some(1.0),
        ..Scene::default()
    };
    let schedule = Schedule {
        end: cli.end.unwrap_or(if cli.floor { 1.2 } else { 0.6 }),
        intervals: cli.snapshots - 1,
        dt: cli.dt,
        ..Schedule::default()
    };
    schedule.check()?;
    let stop = Arc::new(AtomicBool::new(false));
    let flag = stop.clone();
    ctrlc::set_handler(move || {
        // A second Ctrl-C ends the program at once.
        if flag.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    })?;
    // Steps run inside the pool, where handing out work allocates nothing.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(cli.threads).build()?;
    pool.install(|| match cli.forcing {
        ForcingChoice::Smooth => fall(cli, &scene, &schedule, SmoothForcing::new(FLUID.density), &stop),
        ForcingChoice::Hfdib => fall(cli, &scene, &schedule, Hfdib::new(FLUID.density), &stop),
    })
    .map_err(|e| e.to_string().into())
}

fn fall<F: Forcing>(
    cli: &Cli,
    scene: &Scene,
    schedule: &Schedule,
    forcing: F,
    stop: &AtomicBool,
) -> Result<Ending, Box<dyn Error + Send + Sync>> {
    let watch = Stopwatch::start();
    let mut simulation = scene.build(forcing)?;
    let state = cli.out.join("state.bin");
    let setup = setup(cli, scene, schedule);
    let mut history = History::new(scene, schedule);
    let mut files = if cli.resume {
        coupling::load(&state, &mut Resumable { fall: &mut simulation, setup: &setup }).map_err(|e| {
            format!("{e}; without an interrupted run of this scene there, leave out --resume")
        })?;
        let files = FileOutput::resume(&cli.out, simulation.flow.time())?;
        history.read(&cli.out.join("trajectories.csv"))?;
        files
    } else {
        let files = FileOutput::new(&cli.out)?;
        // What an earlier run left there is not this run's.
        for old in ["state.bin", "state.bin.previous", "result.json", "summary.png"] {
            let _ = std::fs::remove_file(cli.out.join(old));
        }
        files
    };
    let mut ledger = Ledger::new();
    let mut show = Show::new(simulation.flow.time(), schedule.end);
    let mut pictures = if cli.no_images { None } else { Some(Pictures::new(&cli.out, scene, schedule)?) };
    let mut save = Save::new(state, setup);
    let observers = &mut (&mut files, (&mut ledger, (&mut history, (&mut show, (&mut pictures, &mut save)))));
    let summary = coupling::run(&mut simulation, schedule, observers, stop)?;
    files.finish()?;
    save.now(&mut simulation)?;
    show.finish(summary.steps, if summary.stopped { "stopped" } else { "done" });

    if let Some(pictures) = &pictures {
        let path = cli.out.join("summary.png");
        pictures.summary(&path, scene, &history).map_err(|e| format!("drawing {}: {e}", path.display()))?;
    }
    let outcome = report::Outcome {
        scene,
        schedule,
        summary,
        simulation: &mut simulation,
        ledger: ledger.report(),
        history: &history,
        elapsed: watch.elapsed(),
        output_seconds: files.seconds() + pictures.as_ref().map_or(0.0, Pictures::seconds) + save.seconds(),
        threads: cli.threads,
        out: &cli.out,
    };
    outcome.tell()?;
    Ok(if summary.stopped { Ending::Stopped } else { Ending::Whole })
}

/// The numbers that a run may not change when it goes on: the scene, the forcing and the intervals.
fn setup(cli: &Cli, scene: &Scene, schedule: &Schedule) -> Vec<f64> {
    let mut numbers = vec![
        scene.cells_per_diameter as f64,
        scene.bodies as f64,
        scene.diameter,
        f64::from(u8::from(scene.floor)),
        cli.balance as u8 as f64,
        cli.forcing as u8 as f64,
        schedule.end,
        schedule.intervals as f64,
        cli.dt.unwrap_or(0.0),
    ];
    numbers.extend(&scene.densities);
    numbers
}
