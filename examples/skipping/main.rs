//! What absent physics costs, to be counted in instructions: see `docs/skipping.md`.
//!
//! Sample run: `cargo run --release --example skipping -- plain 20`; `docs/skipping.sh` counts.
//!
//! 1. `plain`: the flow loop by hand, `Projection::advance`.
//! 2. `hooks`: the same through `Projection::advance_with` and empty `Hooks`: no body force, forcing, closure, scalar.
//! 3. `nobody`: `Simulation<2, ()>`, the coupled loop with nothing immersed.
//! 4. `fixed`: one disc at rest. 5. `moving`: one free disc. 6. `apart`: two free discs far apart.
use example_support::scene::{FLUID, Scene};
use siltflow::coupling::{Simulation, WeightBalance};
use siltflow::flow::Hooks;
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::Freedom;

const DT: f64 = 1e-4;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let mode = args.next().unwrap_or_else(|| "plain".into());
    let steps: usize = args.next().map_or(Ok(20), |n| n.parse())?;
    let mut scene = Scene { cells_per_diameter: 8, ..Scene::default() };
    // A vortex, so that there is something to compute.
    let swirl = |x: [f64; 2]| [1e-3 * (x[1] * 314.16).sin(), 1e-3 * (x[0] * 628.32).cos()];
    match mode.as_str() {
        "plain" => {
            let mut flow = scene.flow()?;
            flow.set_velocity(swirl);
            for _ in 0..steps {
                flow.advance(DT, [0.0; 2])?;
            }
        }
        "hooks" => {
            let mut flow = scene.flow()?;
            flow.set_velocity(swirl);
            for _ in 0..steps {
                flow.advance_with(DT, &mut Hooks::none())?;
            }
        }
        "nobody" => {
            let mut simulation = Simulation::new(scene.flow()?, (), WeightBalance::NetWeight)?;
            simulation.flow.set_velocity(swirl);
            for _ in 0..steps {
                simulation.step(DT)?;
            }
        }
        "fixed" | "moving" | "apart" => {
            scene.bodies = if mode == "apart" { 2 } else { 1 };
            scene.freedom = if mode == "fixed" { Freedom::NONE } else { Freedom::PLANAR };
            let mut simulation = scene.build(SmoothForcing::new(FLUID.density))?;
            simulation.flow.set_velocity(swirl);
            for _ in 0..steps {
                simulation.step(DT)?;
            }
            let particles = &simulation.particles;
            println!(
                "{mode}: {steps} steps, lambda computed {} times, {} overlap calls",
                particles.forcing.updates(),
                particles.bodies.overlap_calls()
            );
        }
        other => {
            return Err(format!("no mode `{other}`; use plain, hooks, nobody, fixed, moving or apart").into());
        }
    }
    Ok(())
}
