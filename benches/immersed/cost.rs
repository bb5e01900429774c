//! What bodies cost: a step with 5 % of the box solid over one without. A ball as a wall at rest, with what it takes to set it up;
//! balls about ten cells wide by forcings, at rest and moving.
use render::cpu::Stopwatch;
use siltflow::dem::{Disc, Sphere};
use siltflow::flow::{CartesianGrid, Fluid, Projection, Side};
use siltflow::ibm::{Forcing, Hfdib, SmoothForcing, cut_walls};
use siltflow::interfaces::{Kinematics, Solid, Twist, Vector};
use std::f64::consts::PI;
use validation::Outcome;
use validation::prescribed_bodies::{PrescribedBodies, forced_step};

const SHARE: f64 = 0.05;
const STEPS: usize = 40;
const ROUNDS: usize = 5;

fn flow<const D: usize>(cells: usize) -> Outcome<Projection<D>> {
    let grid = CartesianGrid::new([cells; D], [1.0; D])?;
    let fluid = Fluid { density: 1.0, viscosity: 1e-3 };
    let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid)?;
    flow.set_velocity(|_| std::array::from_fn(|c| if c == 0 { 1.0 } else { 0.0 }));
    Ok(flow)
}

/// CPU seconds of some steps.
fn steps<const D: usize>(flow: &mut Projection<D>) -> Outcome<f64> {
    let start = Stopwatch::start();
    for _ in 0..STEPS {
        let dt = flow.stable_dt(0.2);
        flow.advance(dt, [0.0; D])?;
    }
    Ok(start.elapsed().cpu)
}

fn row<const D: usize>(cells: usize, ball: impl Solid + 'static) -> Outcome<()> {
    let (mut plain, mut walled) = (flow::<D>(cells)?, flow::<D>(cells)?);
    let centre = [0.503, 0.498, if D == 2 { 0.0 } else { 0.507 }];
    let bodies = PrescribedBodies::default().with(ball, centre, 0.0);
    let start = Stopwatch::start();
    let walls = cut_walls(walled.velocity(), &bodies)?;
    let found = start.elapsed().cpu;
    let touched: usize = walls.components.iter().map(|c| c.faces.len()).sum();
    walled.set_walls(Some(walls))?;
    let set_up = start.elapsed().cpu - found;
    steps(&mut plain)?;
    steps(&mut walled)?;
    // Alternating, so that what else runs here weighs on both.
    let mut pairs = Vec::new();
    for _ in 0..ROUNDS {
        pairs.push([steps(&mut plain)?, steps(&mut walled)?]);
    }
    pairs.sort_by(|a, b| (a[1] / a[0]).total_cmp(&(b[1] / b[0])));
    let [without, with] = pairs[ROUNDS / 2];
    let per_cell = 1e9 / (STEPS as f64 * (cells as f64).powi(D as i32));
    println!(
        "{:>8} {touched:>8} {:>10.0} {:>8.1} {:>8.1} {:>7.2} {:>6} {set_up:>9.3}",
        format!("{cells}^{D}"),
        found / touched as f64 * 1e9,
        without * per_cell,
        with * per_cell,
        with / without,
        walled.pressure_info().iterations,
    );
    Ok(())
}

/// CPU seconds of some steps with bodies that a forcing holds.
fn forced_steps<const D: usize>(
    flow: &mut Projection<D>,
    forcing: &mut dyn Forcing,
    bodies: &mut PrescribedBodies,
) -> Outcome<f64> {
    let start = Stopwatch::start();
    for _ in 0..STEPS {
        let dt = flow.stable_dt(0.2);
        for b in bodies.ids() {
            let (mut pose, twist) = (bodies.pose(b), bodies.twist(b));
            pose.position += dt * twist.linear;
            bodies.put(b, pose, twist);
        }
        forced_step(flow, forcing, bodies, dt)?;
    }
    Ok(start.elapsed().cpu)
}

/// `across` balls along each axis.
fn forced_row<const D: usize>(
    cells: usize,
    across: usize,
    radius: f64,
    ball: fn(f64, PrescribedBodies, [f64; 3]) -> Outcome<PrescribedBodies>,
) -> Outcome<()> {
    let mut still = PrescribedBodies::default();
    for k in 0..across.pow(D as u32) {
        let at = |a: usize| {
            if a < D { ((k / across.pow(a as u32) % across) as f64 + 0.503) / across as f64 } else { 0.0 }
        };
        still = ball(radius, still, [at(0), at(1), at(2)])?;
    }
    let mut moving = still.clone();
    for b in still.ids() {
        moving.put(b, still.pose(b), Twist { linear: Vector::new(0.5, 0.2, 0.0), ..Twist::default() });
    }
    for name in ["smooth", "hfdib"] {
        let forcing = || -> Box<dyn Forcing> {
            if name == "smooth" { Box::new(SmoothForcing::new(1.0)) } else { Box::new(Hfdib::new(1.0)) }
        };
        let mut runs = [&still, &moving].map(|bodies| (flow::<D>(cells), forcing(), bodies.clone()));
        let mut plain = flow::<D>(cells)?;
        let mut ratios = [Vec::new(), Vec::new()];
        for round in 0..=ROUNDS {
            let without = steps(&mut plain)?;
            for ((flow, forcing, bodies), ratios) in runs.iter_mut().zip(&mut ratios) {
                let flow = flow.as_mut().map_err(|error| error.to_string())?;
                let with = forced_steps(flow, &mut **forcing, bodies)?;
                // Not the first, which sets up.
                ratios.extend((round > 0).then_some(with / without));
            }
        }
        let [rest, moves] = ratios.map(|mut ratios| {
            ratios.sort_by(f64::total_cmp);
            ratios[ROUNDS / 2]
        });
        println!(
            "{:>8} {name:>8} {:>7} {:>8.1} {rest:>8.2} {moves:>8.2}",
            format!("{cells}^{D}"),
            still.n_bodies(),
            2.0 * radius * cells as f64,
        );
    }
    Ok(())
}

pub(crate) fn table() -> Outcome<()> {
    println!(
        "\nCost of walls, one thread, medians of {ROUNDS} alternating runs: a ball of {SHARE} of a periodic box"
    );
    println!(
        "{:>8} {:>8} {:>10} {:>8} {:>8} {:>7} {:>6} {:>9}",
        "cells", "faces", "ns/face", "plain ns", "walls ns", "ratio", "its", "set up s"
    );
    for cells in [128, 256, 512] {
        row::<2>(cells, Disc::new((SHARE / PI).sqrt())?)?;
    }
    for cells in [32, 64] {
        row::<3>(cells, Sphere::new((SHARE * 0.75 / PI).cbrt())?)?;
    }
    println!("\nCost of forcings: {SHARE} of the same box in balls, a step over a plain one");
    println!("{:>8} {:>8} {:>7} {:>8} {:>8} {:>8}", "cells", "way", "balls", "per D", "at rest", "moving");
    for (cells, across) in [(128, 3), (256, 6), (512, 13)] {
        let radius = (SHARE / PI).sqrt() / across as f64;
        forced_row::<2>(cells, across, radius, |r, bodies, at| Ok(bodies.with(Disc::new(r)?, at, 0.0)))?;
    }
    for (cells, across) in [(32, 1), (64, 3)] {
        let radius = (SHARE * 0.75 / PI).cbrt() / across as f64;
        forced_row::<3>(cells, across, radius, |r, bodies, at| Ok(bodies.with(Sphere::new(r)?, at, 0.0)))?;
    }
    Ok(())
}
