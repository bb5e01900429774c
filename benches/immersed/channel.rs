//! Plane Poiseuille flow in a channel that is turned against the grid; exact.
use crate::{Outcome, largest_error, settle};
use example_support::cpu::Stopwatch;
use example_support::still_bodies::{Banks, StillBodies};
use siltflow::flow::{CartesianGrid, Fluid, Projection, Side};
use siltflow::ibm::cut_walls;

pub(crate) fn table() -> Outcome<()> {
    println!(
        "\nPlane Poiseuille flow turned against the grid: error of the flow rate, largest error of the velocity over its maximum"
    );
    println!("{:>6} {:>6} {:>9} {:>9} {:>8} {:>7}", "angle", "cells", "flow", "velocity", "faces", "CPU s");
    for angle in [10.0_f64, 20.0, 30.0, 40.0] {
        for cells in [10, 20, 40] {
            let start = Stopwatch::start();
            let (width, nu) = (1.0, 0.1);
            let h = width / cells as f64;
            let slope = angle.to_radians();
            let length = 2.0 * width / slope.sin();
            let nx = (length / h).round();
            let ny = (length * slope.tan() / h).round();
            let lengths = [nx * h, ny * h];
            let grid = CartesianGrid::new([nx as usize, ny as usize], lengths)?
                .with_origin([-0.5 * lengths[0], -0.5 * lengths[1]])?;
            let mut flow =
                Projection::new(grid, Side::Periodic.everywhere(), Fluid { density: 1.0, viscosity: nu })?;
            let banks = Banks { lengths, width };
            let [along, _] = banks.axes();
            let place = [0.0123 * h, 0.0371 * h, 0.0];
            let bodies = StillBodies::default().with(Banks { lengths, width }, place, 0.0);
            let walls = cut_walls(flow.velocity(), &bodies)?;
            let faces: usize = walls.components.iter().map(|c| c.faces.len()).sum();
            flow.set_walls(Some(walls))?;
            // Mean velocity 1.
            let f = 12.0 * nu / (width * width);
            let exact = |x: [f64; 2]| {
                let d = banks.across([x[0] - place[0], x[1] - place[1]]);
                let u = (f / (2.0 * nu) * (0.25 * width * width - d * d)).max(0.0);
                [u * along[0], u * along[1]]
            };
            flow.set_velocity(exact);
            let rate = |flow: &mut Projection<2>, _: f64| {
                let total = flow.statistics().volume_flow;
                (total.x * along[0] + total.y * along[1]) / (width * lengths[0].hypot(lengths[1]))
            };
            let found = settle(&mut flow, along.map(|a| a * f), 0.05 / nu, rate)?;
            let worst = largest_error(&flow, exact);
            println!(
                "{angle:>6} {cells:>6} {:>8.3}% {:>8.3}% {faces:>8} {:>7.2}",
                100.0 * (found - 1.0),
                100.0 * worst / 1.5,
                start.elapsed().cpu
            );
        }
    }
    Ok(())
}
