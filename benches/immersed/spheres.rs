//! Simple-cubic arrays of spheres in Stokes flow, against Zick & Homsy (1982).
use crate::{Outcome, settle};
use example_support::cpu::Stopwatch;
use example_support::still_bodies::StillBodies;
use siltflow::dem::Sphere;
use siltflow::flow::{CartesianGrid, Fluid, Projection, Side};
use siltflow::ibm::cut_walls;
use std::f64::consts::PI;

pub(crate) fn table() -> Outcome<()> {
    println!("\nSimple-cubic arrays of spheres in Stokes flow: K = F/(6πμaU)");
    println!(
        "{:>7} {:>8} {:>6} {:>8} {:>8} {:>9} {:>8} {:>7}",
        "φ", "cells/D", "cells", "K", "exact", "error", "faces", "CPU s"
    );
    for (fraction, exact) in [(0.125_f64, 4.292), (0.343, 15.4)] {
        let radius = (fraction * 3.0 / (4.0 * PI)).cbrt();
        for per_diameter in [12.0, 24.0] {
            let start = Stopwatch::start();
            let cells = (per_diameter / (2.0 * radius)).round() as usize;
            let grid = CartesianGrid::new([cells; 3], [1.0; 3])?;
            // Inertia plays no part at Re ≪ 1.
            let mut flow =
                Projection::new(grid, Side::Periodic.everywhere(), Fluid { density: 1.0, viscosity: 1.0 })?;
            let bodies = StillBodies::default().with(Sphere::new(radius)?, [0.513, 0.487, 0.505], 0.0);
            let walls = cut_walls(flow.velocity(), &bodies)?;
            let faces: usize = walls.components.iter().map(|c| c.faces.len()).sum();
            flow.set_walls(Some(walls))?;
            let force = 1e-3;
            let speed =
                settle(&mut flow, [force, 0.0, 0.0], 0.01, |flow, _| flow.statistics().volume_flow.x)?;
            // All the force on the box is borne by the sphere.
            let drag = force;
            let k = drag / (6.0 * PI * radius * speed);
            println!(
                "{fraction:>7} {:>8.1} {cells:>6} {k:>8.3} {exact:>8} {:>8.2}% {faces:>8} {:>7.1}",
                2.0 * radius * cells as f64,
                100.0 * (k / exact - 1.0),
                start.elapsed().cpu
            );
        }
    }
    Ok(())
}
