//! What the cuts of walls at rest cost, in ns of CPU time per cut or closed face: `cargo bench -p siltflow-ibm --bench cut_walls`; `-- cube` takes only
//! the rows with this word. A body of 5 % of a periodic box, best of several places.
#[path = "support/brick.rs"]
mod brick;
#[path = "support/staggered.rs"]
mod staggered;
mod support;

use brick::Brick;
use cpu_time::ProcessTime;
use ibm::cut_walls;
use interfaces::{Pose, Rotation, Solid, Vector};
use staggered::Staggered;
use std::f64::consts::PI;
use support::{Ball, Equal};

fn row<const D: usize>(name: &str, cells: usize, solid: impl Solid + 'static) {
    let only = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    if only.is_some_and(|o| !name.contains(&o)) {
        return;
    }
    let field = Staggered::new::<D>(cells);
    let flat = if D == 2 { 0.0 } else { 1.0 };
    let mut body = Equal { solid: Box::new(solid), poses: vec![Pose::at([0.5, 0.5, 0.5 * flat])] };
    let (mut best, mut faces, mut links) = (f64::INFINITY, 0, 0);
    for step in 0..20 {
        let s = f64::from(step);
        body.poses[0].position += Vector::new(0.13, 0.17, 0.11 * flat) / cells as f64;
        body.poses[0].orientation = Rotation::from_euler_angles(0.3 * s * flat, 0.2 * s * flat, 0.7 * s);
        let start = ProcessTime::now();
        let walls = cut_walls(&field, &body).expect("a body that the grid sees");
        let time = start.elapsed().as_secs_f64();
        faces = walls.components.iter().map(|c| c.faces.len()).sum();
        links = walls.components.iter().map(|c| c.links.len()).sum();
        best = best.min(time * 1e9 / faces as f64);
    }
    println!(
        "{name:<10} {:>7} {faces:>8} faces {links:>8} nodes {best:>8.1} ns/face",
        format!("{cells}^{D}")
    );
}

fn main() {
    for cells in [128, 256, 512] {
        row::<2>("disc", cells, Ball { radius: (0.05 / PI).sqrt(), dim: 2 });
    }
    let radius = (0.0375 / PI).cbrt();
    for cells in [32, 64, 128] {
        row::<3>("sphere", cells, Ball { radius, dim: 3 });
        row::<3>("cube", cells, Brick(Vector::repeat(0.5 * 0.05_f64.cbrt())));
    }
}
