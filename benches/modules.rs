//! Where the time of the falling discs goes, on one thread: `cargo bench --bench modules`.
//!
//! Per cell and step, in nanoseconds of wall time: the median of five runs of 200 steps each, with output once in
//! 20 steps; the plain flow loop and the paper's forcing beside it.
use siltflow::coupling::{FileOutput, Module, Observer, StepInfo};
use siltflow::ibm::{Forcing, Hfdib, SmoothForcing};
use std::error::Error;
use std::time::Instant;
use validation::falling_discs::{FLUID, FallingDiscs};

const STEPS: usize = 200;
const RUNS: usize = 5;
const OUTPUT_EVERY: usize = 20;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Nanoseconds per cell and step of the plain flow loop.
fn plain(scene: &FallingDiscs) -> Outcome<f64> {
    let mut times = Vec::new();
    for _ in 0..RUNS {
        let mut flow = scene.flow()?;
        flow.set_velocity(|x| [1e-3 * (x[1] * 314.16).sin(), 1e-3 * (x[0] * 628.32).cos()]);
        let dt = flow.stable_dt(0.1);
        let start = Instant::now();
        for _ in 0..STEPS {
            flow.advance(dt, [0.0; 2])?;
        }
        times.push(start.elapsed().as_secs_f64());
    }
    let [nx, ny] = scene.cells();
    Ok(median(times) * 1e9 / (STEPS * nx * ny) as f64)
}

/// The same of every module and of output.
fn coupled<F: Forcing>(scene: &FallingDiscs, forcing: impl Fn() -> F) -> Outcome<Vec<f64>> {
    let folder = std::env::temp_dir().join(format!("siltflow-bench-{}", std::process::id()));
    let mut runs = vec![Vec::new(); Module::ALL.len() + 1];
    for _ in 0..RUNS {
        let mut simulation = scene.build(forcing())?;
        let mut files = FileOutput::new(&folder)?;
        let dt = simulation.flow.stable_dt(0.1);
        for step in 0..STEPS {
            simulation.step(dt)?;
            if step % OUTPUT_EVERY == 0 {
                let info = StepInfo {
                    step: step as u64,
                    time: simulation.flow.time(),
                    dt,
                    courant: 0.0,
                    snapshot: None,
                };
                files.snapshot(&mut simulation, step, &info)?;
            }
        }
        for (run, module) in runs.iter_mut().zip(Module::ALL) {
            run.push(simulation.timings().seconds(module));
        }
        runs[Module::ALL.len()].push(files.seconds());
    }
    std::fs::remove_dir_all(&folder)?;
    let [nx, ny] = scene.cells();
    Ok(runs.into_iter().map(|r| median(r) * 1e9 / (STEPS * nx * ny) as f64).collect())
}

fn main() -> Outcome<()> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| {
        print!("{:28}", "ns per cell and step");
        Module::ALL.iter().for_each(|m| print!("{:>9}", m.name()));
        println!("{:>9}{:>9}{:>9}", "output", "sum", "plain");
        for cells in [10, 15, 30] {
            let smooth = FallingDiscs { cells_per_diameter: cells, ..FallingDiscs::default() };
            let paper = FallingDiscs { virtual_mass: Some(1.0), ..smooth.clone() };
            let rows = [
                ("smooth", coupled(&smooth, || SmoothForcing::new(FLUID.density))?),
                ("hfdib", coupled(&paper, || Hfdib::new(FLUID.density))?),
            ];
            for (name, row) in rows {
                print!("{:28}", format!("{cells} per diameter, {name}"));
                row.iter().for_each(|v| print!("{v:9.2}"));
                println!("{:9.2}{:9.2}", row.iter().sum::<f64>(), plain(&smooth)?);
            }
        }
        Ok(())
    })
}
