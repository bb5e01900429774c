//! Instructions of a step with absent physics, counted by `docs/skipping.sh` (`docs/skipping.md`).
//!
//! `cargo bench --bench skipping -- MODE STEPS` makes the steps. Modes:
//! 1. `plain`: the flow loop by hand, `Projection::advance`.
//! 2. `hooks`: the same through `Projection::advance_with` and empty `Hooks`.
//! 3. `nobody`: `Simulation<2, ()>`, the coupled loop with nothing immersed.
//! 4. `fixed`: one disc at rest; `moving`: one free disc; `apart`: two free discs far apart.
//! 5. `contactless`: two free discs whose contact law is `()`.
//! 6. `closure`, `scalar`: hooks of which one is used and the others are `()`; `closure_by_hand`,
//!    `scalar_by_hand`: the same without hooks.
use siltflow::coupling::{Immersed, Particles, Simulation, WeightBalance};
use siltflow::dem::{Disc, Material, RigidBodies};
use siltflow::flow::{CellTransport, FlowError, Hooks, Modelled, Projection, Scalar, ScalarSide};
use siltflow::flow::{ScalarTransport, TransportParams};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::WallRow;
use siltflow::interfaces::{Bodies, Closure, Freedom, Kinematics, SolveError, Transport, Vector};
use std::error::Error;
use validation::falling_discs::{FLUID, FallingDiscs, GRAVITY};

const DT: f64 = 1e-4;

/// A closure that reads the strain rate and does nothing to the flow.
struct Strain(Vec<f64>);

impl Closure for Strain {
    fn eddy_viscosity(&self) -> Option<&[f64]> {
        None
    }
    fn correct(
        &mut self,
        flow: &mut dyn Transport,
        _: &[WallRow],
        _: f64,
        _: Option<f64>,
    ) -> Result<(), SolveError> {
        flow.strain_rate(&mut self.0)
    }
}

/// Vortices, so that there is something to compute.
fn swirl(x: [f64; 2]) -> [f64; 2] {
    [1e-3 * (x[1] * 314.16).sin(), 1e-3 * (x[0] * 628.32).cos()]
}

/// `n` steps of a flow, each made by `step`.
fn march(
    mut flow: Projection<2>,
    n: usize,
    mut step: impl FnMut(&mut Projection<2>) -> Result<(), FlowError>,
) -> Result<(), Box<dyn Error>> {
    flow.set_velocity(swirl);
    Ok((0..n).try_for_each(|_| step(&mut flow))?)
}

/// `n` steps of a coupled simulation.
fn run<P: Immersed<2>>(mut simulation: Simulation<2, P>, n: usize) -> Result<(), Box<dyn Error>> {
    simulation.flow.set_velocity(swirl);
    Ok((0..n).try_for_each(|_| simulation.step(DT))?)
}

/// A step of the flow alone, in its three parts.
fn advance_by_parts(flow: &mut Projection<2>) -> Result<(), FlowError> {
    flow.predict(DT, [0.0; 2])?;
    flow.project(DT)?;
    flow.finish(DT)
}

/// The discs of the scene with the contact law `()`.
fn contactless(scene: &FallingDiscs) -> Result<RigidBodies<()>, Box<dyn Error>> {
    let discs = scene.discs()?;
    let mut bodies = RigidBodies::with_law(discs.periods(), ());
    for b in discs.ids() {
        let density = discs.inertia(b).mass / discs.inertia(b).volume;
        let material = Material { density, ..Material::default() };
        let disc = Disc::new(0.5 * scene.diameter)?;
        bodies.add(disc, material, discs.pose(b), discs.twist(b), discs.freedom(b))?;
    }
    Ok(bodies)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1).filter(|arg| !arg.starts_with("--"));
    let mode = args.next().unwrap_or_else(|| "plain".into());
    let n: usize = args.next().map_or(Ok(20), |n| n.parse())?;
    let mut scene = FallingDiscs { cells_per_diameter: 8, ..FallingDiscs::default() };
    let flow = scene.flow()?;
    let mut scalar = Scalar::new(flow.grid(), [const { [const { ScalarSide::Periodic }; 2] }; 2], 1e-6)?;
    scalar.set(|x| (x[0] * 628.32).sin());
    let mut strain = Strain(vec![0.0; flow.grid().n_cells()]);
    match mode.as_str() {
        "plain" => march(flow, n, |flow| flow.advance(DT, [0.0; 2])),
        "hooks" => march(flow, n, |flow| flow.advance_with(DT, &mut Hooks::none())),
        "scalar" => {
            let mut hooks = Hooks::none().with_scalars(scalar);
            march(flow, n, |flow| flow.advance_with(DT, &mut hooks))
        }
        "scalar_by_hand" => march(flow, n, |flow| {
            scalar.advance(flow.velocity(), flow.time(), DT)?;
            advance_by_parts(flow)
        }),
        "closure" => {
            let params = TransportParams::default();
            let modelled = Modelled::new(strain, flow.grid(), flow.sides(), params)?;
            let mut hooks = Hooks::none().with_closure(modelled);
            march(flow, n, |flow| flow.advance_with(DT, &mut hooks))
        }
        "closure_by_hand" => {
            let params = TransportParams::default();
            let mut cells = CellTransport::new(flow.grid(), flow.sides(), params)?;
            march(flow, n, |flow| {
                advance_by_parts(flow)?;
                let (nu, time) = (flow.fluid().viscosity, flow.time());
                let corrected = strain.correct(&mut cells.on(flow.velocity())?, &[], nu, Some(DT));
                corrected.map_err(|source| FlowError::Closure { time, source })
            })
        }
        "nobody" => run(Simulation::new(flow, (), WeightBalance::NetWeight)?, n),
        "contactless" => {
            let (forcing, gravity) = (SmoothForcing::new(FLUID.density), -GRAVITY * Vector::y());
            let discs = Particles::new(contactless(&scene)?, forcing, FLUID.density, gravity);
            run(Simulation::new(flow, discs, scene.balance)?, n)
        }
        "fixed" | "moving" | "apart" => {
            scene.bodies = if mode == "apart" { 2 } else { 1 };
            scene.freedom = if mode == "fixed" { Freedom::NONE } else { Freedom::PLANAR };
            run(scene.build(SmoothForcing::new(FLUID.density))?, n)
        }
        other => Err(format!("no mode `{other}`; docs/skipping.sh has them all").into()),
    }
}
