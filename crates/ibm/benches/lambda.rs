//! What λ costs, in ns per touched cell: one with λ > 0 after the update. Sample run:
//! `cargo bench -p ibm --bench lambda` (a minute or so; add a number for more repetitions).
//!
//! 1. A sphere, and a sphere of 20 480 triangles, against cells per diameter, at places all over a cell.
//! 2. Spheres against their number.
//! 3. Tessellated spheres against triangles.
//! 4. Bodies at rest.
//! 5. Shapes with edges, and the paper's rule.
use ibm::{FractionRule, SolidFraction, TriangleMesh};
use interfaces::{
    Aabb, Bodies, BodyId, Freedom, Inertia, Kinematics, Lattice, Nodes, Point, Pose, Rotation, Solid, Twist,
    Vector,
};
use std::time::Instant;

/// Equal bodies.
struct Equal {
    solid: Box<dyn Solid>,
    poses: Vec<Pose>,
}

impl Kinematics for Equal {
    fn n_bodies(&self) -> usize {
        self.poses.len()
    }
    fn pose(&self, b: BodyId) -> Pose {
        self.poses[b.0]
    }
    fn twist(&self, _: BodyId) -> Twist {
        Twist::default()
    }
}

impl Bodies for Equal {
    fn solid(&self, _: BodyId) -> &dyn Solid {
        &*self.solid
    }
    fn inertia(&self, _: BodyId) -> Inertia {
        Inertia { mass: 1.0, volume: 1.0, tensor: nalgebra::Matrix3::identity() }
    }
    fn freedom(&self, _: BodyId) -> Freedom {
        Freedom::NONE
    }
}

/// A sphere of diameter 1.
struct Sphere;

impl Solid for Sphere {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        x.coords.norm() - 0.5
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::repeat(0.5))
    }
}

/// A cube of edge 1.
struct Cube;

impl Solid for Cube {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        let q = x.coords.abs() - Vector::repeat(0.5);
        q.map(|q| q.max(0.0)).norm() + q.max().min(0.0)
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::repeat(0.5))
    }
}

/// A periodic box of edge `length` with so many cells per metre.
fn lattice(cells: usize, length: usize) -> Lattice {
    let n = cells * length;
    let axis = || Nodes::uniform(0.5 / cells as f64, 1.0 / cells as f64, n, true);
    Lattice::new([axis(), axis(), axis()], 0, [1, n, n * n])
}

/// Nanoseconds per touched cell of moving all bodies, the best of several, touched cells and
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
        let start = Instant::now();
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

fn report(name: &str, (ns, touched, worst): (f64, usize, f64)) {
    println!("{name:<44} {touched:>9} cells  {ns:>8.1} ns/cell   volume off by at most {worst:.1e}");
}

fn main() {
    let repeat = std::env::args().filter_map(|a| a.parse().ok()).next().unwrap_or(20);
    let sphere = std::f64::consts::PI / 6.0;
    let one = |solid: Box<dyn Solid>| Equal { solid, poses: vec![Pose::at([1.0; 3])] };
    let mesh = |times| TriangleMesh::sphere(0.5, times).expect("a sphere");
    let cut = FractionRule::CutVolume;
    for cells in [10, 20, 40] {
        let lattice = lattice(cells, 2);
        report(
            &format!("sphere, {cells} cells per D"),
            measure(&mut one(Box::new(Sphere)), &lattice, cut, sphere, repeat),
        );
        let mesh = mesh(5);
        let volume = mesh.volume();
        let name = format!("20480 triangles, {cells} cells per D");
        report(&name, measure(&mut one(Box::new(mesh)), &lattice, cut, volume, repeat));
    }
    for edge in [2, 4, 8] {
        let centres = (0..edge * edge * edge).map(|i| [i % edge, i / edge % edge, i / (edge * edge)]);
        let poses = centres.map(|c| Pose::at(c.map(|x| 1.2 * x as f64 + 0.6))).collect();
        let mut bodies = Equal { solid: Box::new(Sphere), poses };
        let name = format!("{} spheres, 10 cells per D", edge * edge * edge);
        report(&name, measure(&mut bodies, &lattice(10, 2 * edge), cut, sphere, repeat));
    }
    for times in [2, 3, 4, 5, 6] {
        let mesh = mesh(times);
        let (volume, name) = (mesh.volume(), format!("{} triangles, 20 cells per D", mesh.n_faces()));
        report(&name, measure(&mut one(Box::new(mesh)), &lattice(20, 2), cut, volume, repeat));
    }
    for cells in [10, 20, 40] {
        let name = format!("cube, {cells} cells per edge");
        report(&name, measure(&mut one(Box::new(Cube)), &lattice(cells, 2), cut, 1.0, repeat));
    }
    let paper = measure(&mut one(Box::new(Sphere)), &lattice(20, 2), FractionRule::Centroid, sphere, repeat);
    report("sphere, the paper's rule, 20 cells per D", paper);

    let poses =
        (0..512).map(|i| Pose::at([i % 8, i / 8 % 8, i / 64].map(|x| 1.2 * f64::from(x) + 0.6))).collect();
    let (bodies, lattice) = (Equal { solid: Box::new(Sphere), poses }, lattice(10, 10));
    let mut fraction = SolidFraction::new();
    fraction.update(&lattice, &bodies).expect("bodies on a grid");
    let start = Instant::now();
    for _ in 0..1000 {
        fraction.update(&lattice, &bodies).expect("bodies on a grid");
    }
    let ns = start.elapsed().as_secs_f64() * 1e9 / 1000.0 / 512.0;
    println!("512 spheres at rest                          {ns:.1} ns per body and update");
}
