//! What walls cost: a step with a ball of 5 % of the box over one without, and what it takes to set it up.
use example_support::Outcome;
use example_support::cpu::Stopwatch;
use example_support::prescribed_bodies::PrescribedBodies;
use siltflow::dem::{Disc, Sphere};
use siltflow::flow::{CartesianGrid, Fluid, Projection, Side};
use siltflow::ibm::cut_walls;
use siltflow::interfaces::Solid;
use std::f64::consts::PI;

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
    Ok(())
}
