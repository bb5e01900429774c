//! CPU time per pair of every exact route: `cargo bench -p dem --bench overlap`. Those that approximate have benches of their own
//! (`columns`, `tree`).
use dem::{Cuboid, OverlapSolver, Shape, Sphere, TriangleMesh};
use interfaces::{Point, Pose, Rotation, Vector};
use std::collections::HashMap;

/// Median CPU time of a call \[µs\], over nine runs.
fn time(mut call: impl FnMut()) -> f64 {
    let run = |n: usize, call: &mut dyn FnMut()| {
        let start = cpu_time::ProcessTime::now();
        (0..n).for_each(|_| call());
        start.elapsed().as_secs_f64() * 1e6 / n as f64
    };
    let once = run(3, &mut call).max(1e-3);
    let n = (2e4 / once).clamp(3.0, 1e6) as usize;
    let mut all: Vec<f64> = (0..9).map(|_| run(n, &mut call)).collect();
    all.sort_by(f64::total_cmp);
    all[4]
}

fn at(position: [f64; 3], turn: [f64; 3]) -> Pose {
    Pose { position: Point::from(position), orientation: Rotation::from_scaled_axis(Vector::from(turn)) }
}

/// An icosahedron with every face cut into four, `levels` times, its corners at `radius` of their direction.
fn icosphere(levels: usize, radius: impl Fn(Vector) -> f64) -> TriangleMesh {
    let g = 0.5 * (1.0 + 5f64.sqrt());
    let mut vertices: Vec<Vector> = Vec::new();
    for (s, t) in [(1.0, g), (-1.0, g), (1.0, -g), (-1.0, -g)] {
        vertices.extend([Vector::new(0.0, s, t), Vector::new(s, t, 0.0), Vector::new(t, 0.0, s)]);
    }
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [a, b, c].map(|i: usize| vertices[i]);
                if [p - q, q - r, r - p].iter().all(|e| e.norm() < 2.1) {
                    let outward = p.cross(&q).dot(&r) > 0.0;
                    let [a, b, c] = [a, b, c].map(|i| i as u32);
                    faces.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                vertices.push((vertices[a as usize].normalize() + vertices[b as usize].normalize()) * 0.5);
                vertices.len() as u32 - 1
            })
        };
        let cut = |[a, b, c]: [u32; 3]| {
            let [p, q, r] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, p, r], [p, b, q], [r, q, c], [p, q, r]]
        };
        faces = faces.into_iter().flat_map(cut).collect();
    }
    let place = |v: &Vector| (v.normalize() * radius(v.normalize())).into();
    let vertices: Vec<[f64; 3]> = vertices.iter().map(place).collect();
    TriangleMesh::new(&vertices, &faces).expect("a closed surface")
}

/// Bulges and hollows: not convex.
fn rock(n: Vector) -> f64 {
    1.0 + 0.12 * (5.0 * n.x + 1.0).sin() * (4.0 * n.y).cos() + 0.1 * (6.0 * n.z + 2.0 * n.x).sin()
}

fn main() {
    let mut solver = OverlapSolver::new();
    let mut row = |name: &str, a: &dyn Shape, b: &dyn Shape, at_b: Pose| {
        let origin = Pose::at([0.0; 3]);
        let patches = solver.solve(a, &origin, b, &at_b).expect("an overlap");
        let (n, volume) = (patches.len(), patches.iter().fold(0.0, |sum, o| sum + o.volume));
        let share = volume / a.inertia(1.0).volume.min(b.inertia(1.0).volume);
        let us = time(|| {
            let patches = solver.solve(a, &origin, std::hint::black_box(b), &at_b);
            std::hint::black_box(patches.expect("an overlap"));
        });
        println!("{name:44} {us:9.3} µs  {n} patches, {:8.4} % of the smaller body", 100.0 * share);
    };
    let ball = Sphere::new(1.0).expect("a sphere");
    row("spheres", &ball, &ball, at([1.8, 0.3, 0.1], [0.0; 3]));
    let cube = Cuboid::new([1.0; 3]).expect("a box");
    row("cubes, corner in", &cube, &cube, at([0.8, 0.7, 0.75], [0.3, 0.2, 0.5]));
    row("cubes, face in", &cube, &cube, at([0.9, 0.1, 0.05], [0.03, 0.2, 0.05]));
    row("cubes, aligned", &cube, &cube, at([0.9, 0.8, 0.7], [0.0; 3]));
    row("cubes, deep", &cube, &cube, at([0.1, 0.0, 0.0], [0.3, 0.2, 0.5]));
    row("cubes, apart, spheres around meet", &cube, &cube, at([1.35, 0.2, 0.1], [0.3, 0.2, 0.5]));
    row("sphere and cube", &ball, &cube, at([1.2, 0.6, 0.3], [0.3, 0.2, 0.5]));
    let direction = Vector::new(0.8, 0.5, 0.33).normalize();
    let turn = [0.3, 0.7, -0.4];
    for (levels, faces) in [(0, 20), (3, 1280), (5, 20_480)] {
        for (kind, radius) in [("round", (|_| 1.0) as fn(Vector) -> f64), ("rocks", rock)] {
            let mesh = icosphere(levels, radius);
            for d in [1.95, 1.8, 1.5, 0.7] {
                let name = format!("{kind}, {faces} triangles, centres {d} apart");
                row(&name, &mesh, &mesh, at((direction * d).into(), turn));
            }
            row(
                &format!("sphere and {kind}, {faces} triangles"),
                &ball,
                &mesh,
                at((direction * 1.8).into(), turn),
            );
        }
    }
}
