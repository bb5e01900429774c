//! The benchmark 2D-1 of Schäfer & Turek (1996): a cylinder of diameter 0.1 at (0.2, 0.2) in a channel of 2.2 × 0.41 at Re 20,
//! steady; drag and lift coefficients against the spectral values of Nabh (1998), Cd 5.57953523384 and Cl 0.010618948146.
//!
//! [`SmoothForcing`] on uniform cells, with the cylinder's centre on the corner of a cell as the benchmark has it, and with the grid
//! moved by a part of a cell along x. Beside them body-fitted simpleFoam on a machine like this one (relative error of Cd).
use crate::{Outcome, Point, Runs, Table};
use example_support::cpu::Stopwatch;
use siltflow::dem::{Disc, Material, RigidBodies};
use siltflow::flow::{CartesianGrid, Diffusion, Fluid, Profile, Projection, Side};
use siltflow::ibm::{Forcing, SmoothForcing};
use siltflow::interfaces::{BodyId, Freedom, Periods, Pose, Twist, Vector};

const DIAMETER: f64 = 0.1;
const HEIGHT: f64 = 0.41;
const FLUID: Fluid = Fluid { density: 1.0, viscosity: 1e-3 };
/// Largest and mean speed at the inlet.
const PEAK: f64 = 0.3;
const MEAN: f64 = 0.2;
const DRAG: f64 = 5.57953523384;
const LIFT: f64 = 0.010618948146;
/// Only its shape counts.
const MATERIAL: Material =
    Material { density: 1.0, youngs_modulus: 1e6, poisson_ratio: 0.3, damping: 1.0, friction: 0.0 };

/// The flow is steady when the drag changes by less than this part of itself in one unit of time (a flow of mean speed passes
/// two diameters), but not before the fluid at the inlet has passed the cylinder several times.
const STEADY: f64 = 2e-5;
const LEAST: f64 = 6.0;
const MOST: f64 = 60.0;

/// What one grid gives.
struct Found {
    cells: usize,
    drag: f64,
    lift: f64,
    time: f64,
    steps: u64,
    cpu: f64,
}

/// `cells` per diameter, the grid moved by `shift` cells along x.
fn run(cells: usize, shift: f64) -> Outcome<Found> {
    let watch = Stopwatch::start();
    let h = DIAMETER / cells as f64;
    let count = [22 * cells, (HEIGHT / h).round() as usize];
    let grid = CartesianGrid::new(count, [2.2, HEIGHT])?.with_origin([-shift * h, 0.0])?;
    let sides =
        [[Side::Inlet(Profile::Parabolic { peak: PEAK }), Side::PressureOutlet(0.0)], Side::WALL.both()];
    let mut flow = Projection::new(grid, sides, FLUID)?.with_diffusion(Diffusion::Explicit);
    flow.set_velocity(|x| [4.0 * PEAK * x[1] * (HEIGHT - x[1]) / (HEIGHT * HEIGHT), 0.0]);
    let mut bodies = RigidBodies::new(Periods::new([None; 3]));
    let centre = Pose::at([0.2, 0.2, 0.0]);
    bodies.add(Disc::new(0.5 * DIAMETER)?, MATERIAL, centre, Twist::default(), Freedom::NONE)?;
    let mut forcing = SmoothForcing::new(FLUID.density);

    let coefficient = 2.0 / (FLUID.density * MEAN * MEAN * DIAMETER);
    let (mut last, mut next) = (f64::INFINITY, LEAST);
    loop {
        let dt = flow.stable_dt(0.4);
        flow.predict(dt, [0.0; 2])?;
        // Nothing moves: this clears the reaction.
        forcing.place(flow.velocity(), &bodies)?;
        forcing.force(flow.velocity_mut(), &bodies);
        flow.project(dt)?;
        flow.finish(dt)?;
        if flow.time() < next {
            continue;
        }
        let force: Vector = forcing.reaction(BodyId(0)).force * (coefficient / dt);
        let steady = (force.x / last - 1.0).abs() < STEADY;
        if steady || flow.time() > MOST {
            let (time, steps) = (flow.time(), flow.steps());
            let cpu = watch.elapsed().cpu;
            return Ok(Found { cells, drag: force.x, lift: force.y, time, steps, cpu });
        }
        (last, next) = (force.x, flow.time() + 1.0);
    }
}

/// Error of Cd of all runs; prints Cl too.
pub(crate) fn tables() -> Outcome<Vec<Table>> {
    println!("\nImmersed cylinder, Re 20: Cd {DRAG:.6} and Cl {LIFT:.6} wanted");
    println!(
        "{:>12} {:>6} {:>9} {:>9} {:>10} {:>9} {:>7} {:>7} {:>8}",
        "cells per D", "shift", "Cd", "error", "Cl", "error", "time", "steps", "CPU s"
    );
    let mut runs = Vec::new();
    for (label, shift) in [("ours, smooth forcing", 0.0), ("ours, grid moved by 0.37 cells", 0.37)] {
        let mut points = Vec::new();
        for cells in [10, 20, 40] {
            let Found { cells, drag, lift, time, steps, cpu } = run(cells, shift)?;
            let [drag_error, lift_error] = [drag / DRAG - 1.0, lift / LIFT - 1.0];
            println!(
                "{cells:>12} {shift:>6} {drag:>9.5} {:>8.3}% {lift:>10.6} {:>8.1}% {time:>7.1} {steps:>7} {cpu:>8.2}",
                100.0 * drag_error,
                100.0 * lift_error
            );
            points.push(Point::new(format!("{cells}/D"), drag_error.abs(), cpu));
        }
        runs.push(Runs { label, ours: true, points });
    }
    let body_fitted = [(3.0e-3, 0.54), (7.5e-4, 4.5), (1.7e-4, 75.0)];
    runs.push(Runs {
        label: "simpleFoam, body-fitted",
        ours: false,
        points: body_fitted.map(|(error, cpu)| Point::new("", error, cpu)).into(),
    });
    Ok(vec![Table { title: "Cylinder in a channel, Re 20", error: "error of the drag coefficient", runs }])
}
