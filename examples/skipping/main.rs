//! What absent physics costs, to be counted in instructions: see `docs/skipping.md`.
//!
//! Sample run: `cargo run --release --example skipping -- plain 20`; `docs/skipping.sh` counts.
//!
//! 1. `plain`: the flow loop by hand, `Projection::advance`.
//! 2. `hooks`: the same through `Projection::advance_with` and empty `Hooks`: no body force, forcing, closure, scalar.
//! 3. `nobody`: `Simulation<2, ()>`, the coupled loop with nothing immersed.
//! 4. `fixed`: one disc at rest. 5. `moving`: one free disc. 6. `apart`: two free discs far apart.
//! 7. `closure` and `scalar`: hooks of which one is used and the other is `()`; `closure_by_hand` and `scalar_by_hand` do the same without hooks.
//! 8. `contactless`: two free discs whose contact law is `()`; `contactless_by_hand` has bodies that know of no contacts (contactless.rs).
mod contactless;
mod slots;

use contactless::Drifting;
use example_support::scene::{FLUID, GRAVITY, Scene};
use siltflow::coupling::{Immersed, Particles, Simulation, WeightBalance};
use siltflow::flow::{FlowError, Hooks, Projection};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{Dynamics, Freedom, Vector};

const DT: f64 = 1e-4;
/// Diffusivity of the scalar \[m²/s\].
const DIFFUSIVITY: f64 = 1e-6;

/// A step of the flow, in one of the ways that are compared.
type Step = Box<dyn FnMut(&mut Projection<2>) -> Result<(), FlowError>>;

/// A vortex, so that there is something to compute.
fn swirl(x: [f64; 2]) -> [f64; 2] {
    [1e-3 * (x[1] * 314.16).sin(), 1e-3 * (x[0] * 628.32).cos()]
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let mode = args.next().unwrap_or_else(|| "plain".into());
    let steps: usize = args.next().map_or(Ok(20), |n| n.parse())?;
    let mut scene = Scene { cells_per_diameter: 8, ..Scene::default() };
    let flow = |mut step: Step| {
        let mut flow = scene.flow()?;
        flow.set_velocity(swirl);
        (0..steps).try_for_each(|_| step(&mut flow))?;
        Ok(())
    };
    match mode.as_str() {
        "plain" => flow(Box::new(|flow| flow.advance(DT, [0.0; 2]))),
        "hooks" => flow(Box::new(|flow| flow.advance_with(DT, &mut Hooks::none()))),
        "scalar" => {
            let mut hooks = Hooks::none().with_scalars(slots::scalar(&scene.flow()?, DIFFUSIVITY)?);
            flow(Box::new(move |flow| flow.advance_with(DT, &mut hooks)))
        }
        "scalar_by_hand" => {
            let mut scalar = slots::scalar(&scene.flow()?, DIFFUSIVITY)?;
            flow(Box::new(move |flow| slots::with_scalar(flow, &mut scalar, DT)))
        }
        "closure" => {
            let mut hooks = Hooks::none().with_closure(slots::modelled(&scene.flow()?)?);
            flow(Box::new(move |flow| flow.advance_with(DT, &mut hooks)))
        }
        "closure_by_hand" => {
            let (mut closure, mut cells) = slots::closure_and_cells(&scene.flow()?)?;
            flow(Box::new(move |flow| slots::with_closure(flow, &mut closure, &mut cells, DT)))
        }
        "nobody" => {
            run(Simulation::new(scene.flow()?, (), WeightBalance::NetWeight)?, steps)?;
            Ok(())
        }
        "contactless" => fall(&scene, contactless::passing(&scene)?, steps),
        "contactless_by_hand" => fall(&scene, Drifting::new(&scene)?, steps),
        "fixed" | "moving" | "apart" => {
            scene.bodies = if mode == "apart" { 2 } else { 1 };
            scene.freedom = if mode == "fixed" { Freedom::NONE } else { Freedom::PLANAR };
            let simulation = run(scene.build(SmoothForcing::new(FLUID.density))?, steps)?;
            let particles = &simulation.particles;
            println!(
                "{mode}: {steps} steps, lambda computed {} times, {} overlap calls",
                particles.forcing.updates(),
                particles.bodies.overlap_calls()
            );
            Ok(())
        }
        other => Err(format!("no mode `{other}`; docs/skipping.sh knows them all").into()),
    }
}

/// So many steps of a coupled simulation.
fn run<P: Immersed<2>>(
    mut simulation: Simulation<2, P>,
    steps: usize,
) -> Result<Simulation<2, P>, Box<dyn std::error::Error>> {
    simulation.flow.set_velocity(swirl);
    (0..steps).try_for_each(|_| simulation.step(DT))?;
    Ok(simulation)
}

/// The discs of the scene, moved by `bodies`.
fn fall<B: Dynamics>(scene: &Scene, bodies: B, steps: usize) -> Result<(), Box<dyn std::error::Error>> {
    let (forcing, gravity) = (SmoothForcing::new(FLUID.density), Vector::new(0.0, -GRAVITY, 0.0));
    let particles = Particles::new(bodies, forcing, FLUID.density, gravity);
    let simulation = run(Simulation::new(scene.flow()?, particles, scene.balance)?, steps)?;
    for b in simulation.particles.bodies.ids() {
        let place = simulation.particles.bodies.pose(b).position;
        println!("disc {} has come to {:e} m, {:e} m", b.0, place.x, place.y);
    }
    Ok(())
}
