//! What bodies of 20 480 triangles cost on grids, in ns of CPU time, best of several: `cargo bench --bench meshes`.
//!
//! 1. Walls at rest: per cut or closed face. A body of 5 % of a periodic box.
//! 2. Distances of all cells of 48³ from one of a diameter of 0.4 boxes: from scratch, after it moved, at rest.
use cpu_time::ProcessTime;
use siltflow::dem::TriangleMesh;
use siltflow::flow::{CartesianGrid, Fluid, Projection, Side};
use siltflow::ibm::{WallDistance, cut_walls};
use siltflow::interfaces::{BodyId, Lattice, Nodes, Point, Pose, Rotation, Twist, Vector};
use std::error::Error;
use std::f64::consts::PI;
use validation::prescribed_bodies::PrescribedBodies;

/// The least CPU time of several \[ns\].
fn best<T>(mut work: impl FnMut(f64) -> Result<T, Box<dyn Error>>) -> Result<(f64, T), Box<dyn Error>> {
    let mut timed = |step: u32| {
        let start = ProcessTime::now();
        let result = work(f64::from(step))?;
        Ok::<_, Box<dyn Error>>((start.elapsed().as_secs_f64() * 1e9, result))
    };
    let mut best = timed(0)?;
    for step in 1..10 {
        let next = timed(step)?;
        best = if next.0 < best.0 { next } else { best };
    }
    Ok(best)
}

/// Somewhere else about `centre`, and turned.
fn pose(centre: [f64; 3], step: f64) -> Pose {
    let position = Point::from(centre) + Vector::new(0.013, 0.017, 0.011) * step;
    Pose { position, orientation: Rotation::from_euler_angles(0.3 * step, 0.2 * step, 0.7 * step) }
}

fn walls(cells: usize) -> Result<(), Box<dyn Error>> {
    let radius = (0.0375 / PI).cbrt();
    let mut body = PrescribedBodies::default().with(TriangleMesh::sphere(radius, 5)?, [0.5; 3], 0.0);
    let grid = CartesianGrid::new([cells; 3], [1.0; 3])?;
    let flow = Projection::new(grid, Side::Periodic.everywhere(), Fluid { density: 1.0, viscosity: 1e-3 })?;
    let (time, faces) = best(|step| {
        body.put(BodyId(0), pose([0.5; 3], step), Twist::default());
        let walls = cut_walls(flow.velocity(), &body)?;
        Ok(walls.components.iter().map(|c| c.faces.len()).sum::<usize>())
    })?;
    println!("walls, {cells}³ cells: {faces} faces, {:.1} ns/face", time / faces as f64);
    Ok(())
}

fn distances() -> Result<(), Box<dyn Error>> {
    const N: usize = 48;
    let axis = || Nodes::uniform(0.5 * 2.5 / N as f64, 2.5 / N as f64, N, true);
    let lattice = Lattice::new([axis(), axis(), axis()], 0, [1, N, N * N]);
    let mut body = PrescribedBodies::default().with(TriangleMesh::sphere(0.5, 5)?, [0.6; 3], 0.0);
    let cells = (N * N * N) as f64;
    let fresh = best(|_| Ok(WallDistance::new().update(&lattice, &body)?))?.0;
    let mut distance = WallDistance::new();
    let moved = best(|step| {
        body.put(BodyId(0), pose([0.6; 3], step), Twist::default());
        Ok(distance.update(&lattice, &body)?)
    })?;
    let rest = best(|_| Ok(distance.update(&lattice, &body)?))?.0;
    println!(
        "distances, {N}³ cells: {:.1} ns/cell at first, {:.1} when it moved, {rest:.0} ns at rest",
        fresh / cells,
        moved.0 / cells
    );
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    for cells in [32, 64, 128] {
        walls(cells)?;
    }
    distances()
}
