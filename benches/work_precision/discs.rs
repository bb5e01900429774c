//! Error against cost of the falling discs.
//!
//! 1. Speeds at 0.005 s and 0.03 s against unsteady Stokes theory (tests/data/startup_two_discs.csv).
//! 2. Speeds at 0.2 s on 10, 15, 20 and 30 cells per diameter against 60 (takes about two minutes), and the order.
//! 3. Half and double the time step at 15 cells per diameter.
use render::cpu::Stopwatch;
use siltflow::coupling::{self, Exchange, FlowSolver, Particles, Schedule, Simulation};
use siltflow::dem::RigidBodies;
use siltflow::ibm::{Forcing, Hfdib, SmoothForcing};
use siltflow::interfaces::{BodyId, Kinematics};
use std::sync::atomic::AtomicBool;
use validation::Outcome;
use validation::falling_discs::{FLUID, FallingDiscs};

/// Speeds at each of `times`, the steps made and the CPU seconds that took.
fn speeds(
    scene: &FallingDiscs,
    times: &[f64],
    dt: Option<f64>,
    forcing: impl Forcing,
) -> Outcome<(Vec<[f64; 2]>, u64, f64)> {
    speeds_of(scene.build(forcing)?, times, dt)
}

/// The same of any discs.
fn speeds_of<A: FlowSolver<2>, F: Forcing, S: Exchange<2, A>>(
    mut simulation: Simulation<2, Particles<F, RigidBodies, S>, A>,
    times: &[f64],
    dt: Option<f64>,
) -> Outcome<(Vec<[f64; 2]>, u64, f64)> {
    let watch = Stopwatch::start();
    let mut speeds = Vec::new();
    for &end in times {
        // Intervals of a millisecond, as in the example.
        let schedule = Schedule { end, intervals: (end / 1e-3).round() as usize, dt, ..Schedule::default() };
        coupling::run(&mut simulation, &schedule, &mut (), &AtomicBool::new(false))?;
        let bodies = &simulation.particles.bodies;
        speeds.push([0, 1].map(|b| bodies.twist(BodyId(b)).linear.norm()));
    }
    Ok((speeds, simulation.flow.steps(), watch.elapsed().cpu))
}

/// Speeds of both discs by unsteady Stokes theory.
pub(crate) fn theory(time: f64) -> Outcome<[f64; 2]> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/startup_two_discs.csv");
    let text = std::fs::read_to_string(path)?;
    let rows =
        text.lines().filter_map(|l| l.split(',').map(|v| v.parse().ok()).collect::<Option<Vec<f64>>>());
    let row = rows.into_iter().find(|r| (r[0] - time).abs() < 1e-9).ok_or("no such time in the table")?;
    Ok([row[1], row[2]])
}

/// How far `value` is from `reference` \[%\].
pub(crate) fn percent(value: f64, reference: f64) -> f64 {
    100.0 * (value / reference - 1.0)
}

/// The scene with so many cells across a disc.
pub(crate) fn at(cells_per_diameter: usize) -> FallingDiscs {
    FallingDiscs { cells_per_diameter, ..FallingDiscs::default() }
}

/// Prints the tables.
pub(crate) fn run() -> Outcome<()> {
    let smooth = || SmoothForcing::new(FLUID.density);
    println!("\nstart-up: error of the speeds against unsteady Stokes theory in %");
    println!(
        "{:>6}{:>8} {:>16} {:>16} {:>16}",
        "cells", "forcing", "at 0.005 s", "at 0.03 s", "CPU s to 0.03 s"
    );
    for cells in [10, 15, 20, 30, 60] {
        let paper = FallingDiscs { virtual_mass: Some(1.0), ..at(cells) };
        let times = [0.005, 0.03];
        let mut rows = vec![
            ("smooth", speeds(&at(cells), &times, None, smooth())?),
            ("hfdib", speeds(&paper, &times, None, Hfdib::new(FLUID.density))?),
        ];
        if cells < 60 {
            // With the longest step of the others; on the finest grid it takes a quarter of an hour.
            let dt = Some(at(cells).flow()?.stable_dt(0.1));
            rows.push(("paper", speeds_of(at(cells).hfdib_dem()?, &times, dt)?));
        }
        for (name, (speeds, _, seconds)) in rows {
            print!("{cells:6}{name:>8} ");
            for (v, t) in speeds.iter().zip(times) {
                let exact = theory(t)?;
                print!("{:8.2}{:8.2} ", percent(v[0], exact[0]), percent(v[1], exact[1]));
            }
            println!("{seconds:16.3}");
        }
    }

    println!("\nspeeds at 0.2 s, against 60 cells per diameter");
    println!("{:>6}{:>22}{:>18}{:>16}{:>8}{:>9}", "cells", "mm/s", "difference %", "order", "steps", "CPU s");
    let (finest, steps, seconds) = speeds(&at(60), &[0.2], None, smooth())?;
    let mut last: Option<(f64, [f64; 2])> = None;
    for cells in [10, 15, 20, 30] {
        let (v, steps, seconds) = speeds(&at(cells), &[0.2], None, smooth())?;
        let error = [0, 1].map(|b| percent(v[0][b], finest[0][b]));
        let order = last.map_or([f64::NAN; 2], |(n, e)| {
            [0, 1].map(|b: usize| (e[b] / error[b]).ln() / (cells as f64 / n).ln())
        });
        println!(
            "{cells:6}{:11.4}{:11.4}{:9.3}{:9.3}{:8.2}{:8.2}{steps:8}{seconds:9.2}",
            1e3 * v[0][0],
            1e3 * v[0][1],
            error[0],
            error[1],
            order[0],
            order[1]
        );
        last = Some((cells as f64, error));
    }
    println!("{:6}{:11.4}{:11.4}{:42}{seconds:9.2}", 60, 1e3 * finest[0][0], 1e3 * finest[0][1], steps);

    println!("\ntime step at 15 cells per diameter: speeds in mm/s at 0.005, 0.03 and 0.2 s");
    for dt in [5e-4, 2.5e-4, 1.25e-4, 6.25e-5] {
        let (v, steps, _) = speeds(&at(15), &[0.005, 0.03, 0.2], Some(dt), smooth())?;
        print!("{dt:9.2e} s {steps:6} steps");
        v.iter().for_each(|v| print!("{:11.5}{:11.5}", 1e3 * v[0], 1e3 * v[1]));
        println!();
    }
    Ok(())
}
