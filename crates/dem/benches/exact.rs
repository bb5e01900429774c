//! CPU time per pair of every exact route: `cargo bench -p siltflow-dem --bench exact`. Those that approximate have benches of their own
//! (`columns`, `tree`). `-- spheres` takes only the pairs with this word.
use dem::{Capsule, ConvexPolyhedron, Cuboid, Cylinder, OverlapSolver, Shape, Sphere, TriangleMesh};
use interfaces::{Point, Pose, Rotation, Vector};

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

/// A tessellated sphere of 20·4ⁿ triangles, its corners put at `radius` of their direction.
fn mesh(times: u32, radius: impl Fn(Vector) -> f64) -> TriangleMesh {
    let ball = TriangleMesh::sphere(1.0, times).expect("a closed surface");
    let place = |v: &Point| (v.coords * radius(v.coords)).into();
    let vertices: Vec<[f64; 3]> = ball.vertices().iter().map(place).collect();
    TriangleMesh::new(&vertices, ball.faces()).expect("a closed surface")
}

/// Bulges and hollows: not convex.
fn rock(n: Vector) -> f64 {
    1.0 + 0.12 * (5.0 * n.x + 1.0).sin() * (4.0 * n.y).cos() + 0.1 * (6.0 * n.z + 2.0 * n.x).sin()
}

/// Numbers between 0 and 1 (Knuth's linear congruence).
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn turn(&mut self) -> Rotation {
        Rotation::from_scaled_axis(Vector::from_fn(|_, _| 6.0 * self.next() - 3.0))
    }
}

/// Pairs of poses in which two bodies share this part of the smaller one: the second comes along a random line until they do.
fn poses(a: &dyn Shape, b: &dyn Shape, share: f64) -> Vec<[Pose; 2]> {
    let (mut draw, mut solver) = (Draw(7), OverlapSolver::new());
    let wanted = share * a.inertia(1.0).volume.min(b.inertia(1.0).volume);
    let mut place = |_| {
        let (along, turns) = (draw.turn() * Vector::x(), [draw.turn(), draw.turn()]);
        let at = |d: f64| {
            [(0.0, turns[0]), (d, turns[1])]
                .map(|(d, orientation)| Pose { position: Point::from(d * along), orientation })
        };
        let (mut near, mut far) = (0.0, a.bounding_radius() + b.bounding_radius());
        for _ in 0..30 {
            let middle = 0.5 * (near + far);
            let [p, q] = at(middle);
            let patches = solver.solve(a, &p, b, &q).expect("an overlap");
            let volume: f64 = patches.iter().map(|o| o.volume).sum();
            *(if volume > wanted { &mut near } else { &mut far }) = middle;
        }
        at(near)
    };
    (0..64).map(&mut place).collect()
}

fn main() {
    let mut solver = OverlapSolver::new();
    let word = std::env::args().skip(1).find(|word| !word.starts_with("--"));
    let mut row = |name: &str, a: &dyn Shape, b: &dyn Shape, at_b: Pose| {
        if word.as_ref().is_some_and(|word| !name.contains(word)) {
            return;
        }
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
    let places: Vec<Point> = (0..1024).map(|i| Point::new(1.8 + 1e-4 * f64::from(i), 0.3, 0.1)).collect();
    let us = time(|| {
        let sum = |sum: f64, at: &Point| {
            sum + ball.overlap(Point::origin(), &ball, *at).map_or(0.0, |o| o.volume + o.centroid.x)
        };
        std::hint::black_box(std::hint::black_box(&places).iter().fold(0.0, sum));
    });
    println!("{:44} {:9.4} µs", "spheres, by Sphere::overlap", us / places.len() as f64);
    // The same through the solver, which is told of two shapes only.
    let (mut balls, origin) = (OverlapSolver::new(), Pose::at([0.0; 3]));
    let posed: Vec<Pose> = places.iter().map(|at| Pose::at((*at).into())).collect();
    let us = time(|| {
        let [a, b] = std::hint::black_box([&ball as &dyn Shape; 2]);
        let mut sum = 0.0;
        for at in std::hint::black_box(&posed) {
            let patches = balls.solve(a, &origin, b, at);
            sum += patches.expect("an overlap").iter().fold(0.0, |sum, o| sum + o.volume + o.centroid.x);
        }
        std::hint::black_box(sum);
    });
    println!("{:44} {:9.4} µs", "spheres, by OverlapSolver::solve", us / places.len() as f64);
    row("spheres", &ball, &ball, at([1.8, 0.3, 0.1], [0.0; 3]));
    let cube = Cuboid::new([1.0; 3]).expect("a box");
    row("cubes, corner in", &cube, &cube, at([0.8, 0.7, 0.75], [0.3, 0.2, 0.5]));
    row("cubes, face in", &cube, &cube, at([0.9, 0.1, 0.05], [0.03, 0.2, 0.05]));
    row("cubes, aligned", &cube, &cube, at([0.9, 0.8, 0.7], [0.0; 3]));
    row("cubes, deep", &cube, &cube, at([0.1, 0.0, 0.0], [0.3, 0.2, 0.5]));
    row("cubes, apart, spheres around meet", &cube, &cube, at([1.35, 0.2, 0.1], [0.3, 0.2, 0.5]));
    row("sphere and cube", &ball, &cube, at([1.2, 0.6, 0.3], [0.3, 0.2, 0.5]));
    let capsule = Capsule::new(0.3, 1.0).expect("a capsule");
    let cylinder = Cylinder::new(0.3, 1.0).expect("a cylinder");
    for (name, tube) in [("capsule", &capsule as &dyn Shape), ("cylinder", &cylinder)] {
        row(&format!("{name} and cube, side in"), tube, &cube, at([0.7, 0.1, 0.0], [0.3, 0.2, 0.5]));
        row(&format!("{name} and cube, deep"), tube, &cube, at([0.2, 0.1, 0.0], [0.3, 0.2, 0.5]));
        let rocks = mesh(3, rock);
        row(&format!("{name} and rocks, 1280 triangles"), tube, &rocks, at([1.0, 0.4, 0.3], [0.3, 0.2, 0.5]));
    }
    let direction = Vector::new(0.8, 0.5, 0.33).normalize();
    let turn = [0.3, 0.7, -0.4];
    let corners: Vec<[f64; 3]> = mesh(0, |_| 1.0).vertices().iter().map(|v| (*v).into()).collect();
    let icosahedron = ConvexPolyhedron::from_points(&corners).expect("a hull");
    for d in [1.8, 1.5, 0.7] {
        let name = format!("convex polyhedra of 20 faces, centres {d} apart");
        row(&name, &icosahedron, &icosahedron, at((direction * d).into(), turn));
    }
    for (levels, faces) in [(0, 20), (3, 1280), (5, 20_480)] {
        for (kind, radius) in [("round", (|_| 1.0) as fn(Vector) -> f64), ("rocks", rock)] {
            let mesh = mesh(levels, radius);
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
    // Poses that the branch predictor cannot learn.
    for (kind, radius) in [("round", (|_| 1.0) as fn(Vector) -> f64), ("rocks", rock)] {
        let mesh = mesh(3, radius);
        for share in [0.005, 0.02, 0.09, 0.31, 0.55, 0.79] {
            let name = format!("{kind}, 1280 triangles, 64 random poses, {} %", 100.0 * share);
            if word.as_ref().is_some_and(|word| !name.contains(word)) {
                continue;
            }
            let poses = poses(&mesh, &mesh, share);
            let us = time(|| {
                for [p, q] in &poses {
                    std::hint::black_box(
                        solver.solve(&mesh, p, std::hint::black_box(&mesh), q).expect("an overlap"),
                    );
                }
            });
            println!("{name:55} {:9.3} µs", us / poses.len() as f64);
        }
    }
}
