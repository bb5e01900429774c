//! Immersed walls against exact and published values: plane Poiseuille flow turned against the grid, Taylor–Couette flow,
//! simple-cubic arrays of spheres. `cargo bench --bench immersed`, or with the names of cases.
mod scene;

use cpu_time::ProcessTime;
use scene::{Banks, Bore, Scene};
use siltflow::dem::{Disc, Sphere};
use siltflow::flow::{CartesianGrid, Fluid, Projection, Side};
use siltflow::ibm::cut_walls;
use siltflow::interfaces::VelocityField;
use std::f64::consts::PI;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

fn main() -> Outcome<()> {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let want = |name: &str| wanted.is_empty() || wanted.iter().any(|w| w == name);
    if want("channel") {
        channel()?;
    }
    if want("couette") {
        couette()?;
    }
    if want("spheres") {
        spheres()?;
    }
    Ok(())
}

/// Advances until nothing changes any more: the largest change of `value` over an interval, relative to its largest value.
fn settle<const D: usize>(
    flow: &mut Projection<D>,
    force: [f64; D],
    interval: f64,
    mut value: impl FnMut(&mut Projection<D>, f64) -> f64,
) -> Outcome<f64> {
    let mut last = f64::INFINITY;
    loop {
        let end = flow.time() + interval;
        let mut dt = 0.0;
        while flow.time() < end {
            dt = flow.stable_dt(0.4);
            flow.advance(dt, force)?;
        }
        let now = value(flow, dt);
        if (now - last).abs() < 1e-6 * now.abs() {
            return Ok(now);
        }
        last = now;
    }
}

fn channel() -> Outcome<()> {
    println!(
        "\nPlane Poiseuille flow turned against the grid: error of the flow rate, largest error of the velocity over its maximum"
    );
    println!("{:>6} {:>6} {:>9} {:>9} {:>8} {:>7}", "angle", "cells", "flow", "velocity", "faces", "CPU s");
    for angle in [10.0_f64, 20.0, 30.0, 40.0] {
        for cells in [10, 20, 40] {
            let start = ProcessTime::now();
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
            let bodies = Scene::default().with(Banks { lengths, width }, place, 0.0);
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
                "{angle:>6} {cells:>6} {:>8.3}% {:>8.3}% {faces:>8} {:>7.2} its {} steps {}",
                100.0 * (found - 1.0),
                100.0 * worst / 1.5,
                start.elapsed().as_secs_f64(),
                flow.pressure_info().iterations,
                flow.steps()
            );
        }
    }
    Ok(())
}

/// Largest difference of a velocity component from the exact one at the nodes where that is not zero.
fn largest_error<const D: usize>(flow: &Projection<D>, exact: impl Fn([f64; D]) -> [f64; D]) -> f64 {
    let mut worst = 0.0_f64;
    for c in 0..D {
        let lattice = flow.velocity().lattice(c);
        let [nx, ny, nz] = lattice.shape();
        for at in (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / (nx * ny)].map(|i| i as isize)) {
            let x = lattice.position(at);
            let wanted = exact(std::array::from_fn(|a| x[a]))[c];
            if wanted != 0.0
                && let Some(index) = lattice.index(at)
            {
                worst = worst.max((flow.velocity().component(c)[index] - wanted).abs());
            }
        }
    }
    worst
}

fn couette() -> Outcome<()> {
    println!(
        "\nTaylor–Couette flow, R 0.25 turning at 1 in R 0.5 at rest: largest and rms error of the velocity, error of the torque"
    );
    println!("{:>6} {:>10} {:>10} {:>9} {:>9} {:>7}", "cells", "max", "rms", "inner", "outer", "CPU s");
    for (cells, shift) in [(32, 0.0), (64, 0.0), (128, 0.0), (32, 0.3), (64, 0.3), (128, 0.3)] {
        let start = ProcessTime::now();
        let nu = 0.1;
        let half = 0.5 + 2.0 / cells as f64;
        let h = 1.0 / cells as f64;
        let origin = [-half + shift * h, -half + 0.7 * shift * h];
        let grid = CartesianGrid::new([cells + 4; 2], [2.0 * half; 2])?.with_origin(origin)?;
        let mut flow = Projection::new(grid, Side::WALL.everywhere(), Fluid { density: 1.0, viscosity: nu })?;
        let bodies = Scene::default().with(Disc::new(0.25)?, [0.0; 3], 1.0).with(
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
            start.elapsed().as_secs_f64()
        );
    }
    Ok(())
}

fn spheres() -> Outcome<()> {
    println!("\nSimple-cubic arrays of spheres in Stokes flow: K = F/(6πμaU)");
    println!(
        "{:>7} {:>8} {:>6} {:>8} {:>8} {:>9} {:>8} {:>7}",
        "φ", "cells/D", "cells", "K", "exact", "error", "faces", "CPU s"
    );
    for (fraction, exact) in [(0.125_f64, 4.292), (0.343, 15.4)] {
        let radius = (fraction * 3.0 / (4.0 * PI)).cbrt();
        for per_diameter in [12.0, 24.0] {
            let start = ProcessTime::now();
            let cells = (per_diameter / (2.0 * radius)).round() as usize;
            let grid = CartesianGrid::new([cells; 3], [1.0; 3])?;
            // Inertia plays no part at Re ≪ 1.
            let mut flow =
                Projection::new(grid, Side::Periodic.everywhere(), Fluid { density: 1.0, viscosity: 1.0 })?;
            let bodies = Scene::default().with(Sphere::new(radius)?, [0.513, 0.487, 0.505], 0.0);
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
                start.elapsed().as_secs_f64()
            );
        }
    }
    Ok(())
}
