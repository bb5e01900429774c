//! Taylor–Couette flow between circular cylinders; exact.
use crate::{Outcome, largest_error, settle};
use example_support::cpu::Stopwatch;
use example_support::still_bodies::{Bore, StillBodies};
use siltflow::dem::Disc;
use siltflow::flow::{CartesianGrid, Fluid, Projection, Side};
use siltflow::ibm::cut_walls;
use siltflow::interfaces::VelocityField;
use std::f64::consts::PI;

pub(crate) fn table() -> Outcome<()> {
    println!(
        "\nTaylor–Couette flow, R 0.25 turning at 1 in R 0.5 at rest: largest and rms error of the velocity, error of the torque"
    );
    println!("{:>6} {:>10} {:>10} {:>9} {:>9} {:>7}", "cells", "max", "rms", "inner", "outer", "CPU s");
    for (cells, shift) in [(32, 0.0), (64, 0.0), (128, 0.0), (32, 0.3), (64, 0.3), (128, 0.3)] {
        let start = Stopwatch::start();
        let nu = 0.1;
        let half = 0.5 + 2.0 / cells as f64;
        let h = 1.0 / cells as f64;
        let origin = [-half + shift * h, -half + 0.7 * shift * h];
        let grid = CartesianGrid::new([cells + 4; 2], [2.0 * half; 2])?.with_origin(origin)?;
        let mut flow = Projection::new(grid, Side::WALL.everywhere(), Fluid { density: 1.0, viscosity: nu })?;
        let bodies = StillBodies::default().with(Disc::new(0.25)?, [0.0; 3], 1.0).with(
            Bore { radius: 0.5, half: [2.0 * half; 2] },
            [0.0; 3],
            0.0,
        );
        flow.set_walls(Some(cut_walls(flow.velocity(), &bodies)?))?;
        let exact = |x: [f64; 2]| {
            let r = x[0].hypot(x[1]);
            let turn = if (0.25..0.5).contains(&r) { -1.0 / 3.0 + 1.0 / (12.0 * r * r) } else { 0.0 };
            [-turn * x[1], turn * x[0]]
        };
        flow.set_velocity(exact);
        let torque = 4.0 * PI * nu / 12.0;
        let found = settle(&mut flow, [0.0; 2], 0.05, |flow, dt| flow.wall_impulses()[0].torque.z / dt)?;
        let dt = flow.last_dt();
        let outer = flow.wall_impulses()[1].torque.z / dt;
        let (mut sum, mut n) = (0.0, 0.0);
        for c in 0..2 {
            let lattice = flow.velocity().lattice(c);
            let [nx, ny, _] = lattice.shape();
            for at in (0..nx * ny).map(|i| [(i % nx) as isize, (i / nx) as isize, 0]) {
                let x = lattice.position(at);
                let wanted = exact([x[0], x[1]])[c];
                if wanted != 0.0
                    && let Some(index) = lattice.index(at)
                {
                    sum += (flow.velocity().component(c)[index] - wanted).powi(2);
                    n += 0.5;
                }
            }
        }
        println!(
            "{cells:>6} {:>10.2e} {:>10.2e} {:>8.3}% {:>8.3}% {:>7.2}",
            largest_error(&flow, exact),
            f64::sqrt(sum / n),
            100.0 * (-found / torque - 1.0),
            100.0 * (outer / torque - 1.0),
            start.elapsed().cpu
        );
    }
    Ok(())
}
