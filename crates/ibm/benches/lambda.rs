//! What λ costs, in ns of CPU time per touched cell: one with λ > 0 after the update. Sample run:
//! `cargo bench -p siltflow-ibm --bench lambda` (a minute or so). `-- 50` repeats more often,
//! `-- cube` takes only the rows with this word.
//!
//! 1. A sphere, and one of 20 480 triangles, against cells per diameter, at places all over a cell.
//! 2. Spheres against their number.
//! 3. Tessellated spheres against triangles.
//! 4. Cubes, and the paper's rule.
//! 5. Bodies at rest.
#[path = "support/brick.rs"]
mod brick;
#[path = "../src/testing/faceted.rs"]
mod faceted;
mod support;

use brick::Brick;
use cpu_time::ProcessTime;
use faceted::Faceted;
use ibm::{FractionRule, SolidFraction};
use interfaces::{BodyId, Lattice, Nodes, Pose, Rotation, Solid, Vector};
use support::{Ball, Equal};

/// Of diameter 1.
const SPHERE: Ball = Ball { radius: 0.5, dim: 3 };

/// A periodic box of edge `length` with so many cells per metre.
fn lattice(cells: usize, length: usize) -> Lattice {
    let n = cells * length;
    let axis = || Nodes::uniform(0.5 / cells as f64, 1.0 / cells as f64, n, true);
    Lattice::new([axis(), axis(), axis()], 0, [1, n, n * n])
}

/// Nanoseconds of CPU time per touched cell of moving all bodies, the best of several, touched cells and
/// (Σ λ V − V)/V for a body of `volume`.
fn measure(
    bodies: &mut Equal,
    lattice: &Lattice,
    rule: FractionRule,
    volume: f64,
    repeat: usize,
) -> (f64, usize, f64) {
    let mut fraction = SolidFraction::new().with_rule(rule);
    fraction.update(lattice, bodies).expect("bodies on a grid");
    let (mut best, mut touched, mut worst) = (f64::INFINITY, 0, 0.0_f64);
    for step in 0..repeat {
        // Somewhere else in a cell, and turned.
        let s = step as f64;
        for (b, pose) in bodies.poses.iter_mut().enumerate() {
            pose.position += Vector::new(0.011, 0.023, 0.017) * (1.0 + 0.1 * (b as f64 + s).sin());
            pose.orientation = Rotation::from_euler_angles(0.3 * s, 0.7 * s, 0.2 * s);
        }
        let start = ProcessTime::now();
        fraction.update(lattice, bodies).expect("bodies on a grid");
        let time = start.elapsed().as_secs_f64();
        let nodes = || (0..bodies.poses.len()).flat_map(|b| fraction.nodes(BodyId(b)));
        touched = nodes().count();
        best = best.min(time * 1e9 / touched as f64);
        let sum: f64 = nodes().map(|n| n.fraction * n.volume).sum();
        worst = worst.max((sum / (volume * bodies.poses.len() as f64) - 1.0).abs());
    }
    (best, touched, worst)
}

/// Prints the rows that were asked for.
struct Table {
    repeat: usize,
    only: Option<String>,
}

impl Table {
    fn wants(&self, name: &str) -> bool {
        self.only.as_ref().is_none_or(|o| name.contains(o))
    }
    /// A body of `volume`, or several, on the lattice of so many cells per diameter and `length` diameters.
    fn row(
        &self,
        name: &str,
        mut bodies: Equal,
        [cells, length]: [usize; 2],
        volume: f64,
        rule: FractionRule,
    ) {
        if !self.wants(name) {
            return;
        }
        let (ns, touched, worst) = measure(&mut bodies, &lattice(cells, length), rule, volume, self.repeat);
        println!("{name:<42} {touched:>8} cells {ns:>8.1} ns/cell, volume off by at most {worst:.1e}");
    }
}

fn main() {
    let arguments = || std::env::args().skip(1).filter(|a| !a.starts_with('-'));
    let table = Table {
        repeat: arguments().find_map(|a| a.parse().ok()).unwrap_or(20),
        only: arguments().find(|a| a.parse::<usize>().is_err()),
    };
    let sphere = std::f64::consts::PI / 6.0;
    let one = |solid: Box<dyn Solid>| Equal { solid, poses: vec![Pose::at([1.0; 3])] };
    let mesh = |name: &str, times, cells| {
        let triangles = 20 << (2 * times);
        // Not made for nothing.
        if !table.wants(&format!("{triangles} triangles{name}, {cells} cells per D")) {
            return;
        }
        let mesh = Faceted::sphere(0.5, times);
        let (volume, name) = (mesh.volume(), format!("{triangles} triangles{name}, {cells} cells per D"));
        table.row(&name, one(Box::new(mesh)), [cells, 2], volume, FractionRule::CutVolume);
    };
    for cells in [10, 20, 40] {
        let name = format!("one sphere, {cells} cells per D");
        table.row(&name, one(Box::new(SPHERE)), [cells, 2], sphere, FractionRule::CutVolume);
        mesh("", 5, cells);
    }
    for edge in [2, 4, 8] {
        let centres = (0..edge * edge * edge).map(|i| [i % edge, i / edge % edge, i / (edge * edge)]);
        let poses = centres.map(|c| Pose::at(c.map(|x| 1.2 * x as f64 + 0.6))).collect();
        let bodies = Equal { solid: Box::new(SPHERE), poses };
        let name = format!("{} spheres, 10 cells per D", edge * edge * edge);
        table.row(&name, bodies, [10, 2 * edge], sphere, FractionRule::CutVolume);
    }
    for times in [2, 3, 4, 6] {
        mesh(" (series)", times, 20);
    }
    for cells in [10, 20, 40] {
        let name = format!("cube, {cells} cells per edge");
        table.row(&name, one(Box::new(Brick(Vector::repeat(0.5)))), [cells, 2], 1.0, FractionRule::CutVolume);
    }
    let name = "sphere, the paper's rule, 20 cells per D";
    table.row(name, one(Box::new(SPHERE)), [20, 2], sphere, FractionRule::Centroid);

    if !table.wants("at rest") {
        return;
    }
    let poses =
        (0..512).map(|i| Pose::at([i % 8, i / 8 % 8, i / 64].map(|x| 1.2 * f64::from(x) + 0.6))).collect();
    let (bodies, lattice) = (Equal { solid: Box::new(SPHERE), poses }, lattice(10, 10));
    let mut fraction = SolidFraction::new();
    fraction.update(&lattice, &bodies).expect("bodies on a grid");
    let start = ProcessTime::now();
    for _ in 0..1000 {
        fraction.update(&lattice, &bodies).expect("bodies on a grid");
    }
    let ns = start.elapsed().as_secs_f64() * 1e9 / 1000.0 / 512.0;
    println!("512 spheres at rest: {ns:.1} ns per body and update");
}
