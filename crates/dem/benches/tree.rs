//! What the adaptive tree costs against its error, in µs of CPU time per pair, for bodies of which only a signed distance is
//! known. Sample run: `cargo bench -p dem --bench tree` (a minute or so); `-- torus` takes only the pairs with this word.
//!
//! Each pair is posed twenty times at random, between a graze and half its depth; the error is that of the volume against the exact
//! one (spheres) or against a tolerance of 3e-6.
use cpu_time::ProcessTime;
use dem::{OverlapSolver, Refinement, Route, Shape};
use interfaces::{Aabb, Inertia, Point, Pose, Rotation, Solid, Vector};
use std::f64::consts::PI;

/// A signed distance and a box.
struct Body {
    name: &'static str,
    distance: fn(Vector) -> f64,
    half: Vector,
}

impl Solid for Body {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        (self.distance)(x.coords)
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), self.half)
    }
}

impl Shape for Body {
    fn name(&self) -> &'static str {
        self.name
    }
    fn inertia(&self, _: f64) -> Inertia {
        unimplemented!("only overlaps are asked for")
    }
    fn bounding_radius(&self) -> f64 {
        self.half.norm()
    }
}

fn ball(x: Vector) -> f64 {
    x.norm() - 1.0
}
fn torus(x: Vector) -> f64 {
    (x.x.hypot(x.y) - 0.7).hypot(x.z) - 0.3
}
/// Three balls about a fourth.
fn union(x: Vector) -> f64 {
    let centres = [[0.0, 0.0, 0.0], [0.5, 0.1, 0.0], [-0.2, 0.45, 0.2], [-0.1, -0.3, 0.5]];
    centres.iter().map(|c| (x - Vector::from(*c)).norm() - 0.45).fold(f64::INFINITY, f64::min)
}
fn brick(x: Vector) -> f64 {
    let q = x.abs() - Vector::new(0.8, 0.6, 0.5);
    q.map(|q| q.max(0.0)).norm() + q.max().min(0.0)
}
/// |x|⁴ + |y|⁴ + |z|⁴ = 1, stretched and twisted about z; to first order the distance.
fn superellipsoid(x: Vector) -> f64 {
    let (sin, cos) = (0.8 * x.z).sin_cos();
    let p = Vector::new((cos * x.x + sin * x.y) / 0.9, (cos * x.y - sin * x.x) / 0.5, x.z / 0.7);
    let r = p.norm().max(1e-3);
    let sum = p.map(|c| c.powi(4)).sum().max(1e-12);
    let f = sum.powf(0.25) - 1.0;
    let inner = p.map(|c| c.powi(3)) * sum.powf(-0.75);
    let along = Vector::new(inner.x / 0.9, inner.y / 0.5, inner.z / 0.7);
    f / (along.norm().max(0.2 / r) * 1.5)
}

struct Draw(u64);
impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
    fn pose(&mut self, distance: f64) -> Pose {
        let direction = loop {
            let v = Vector::from_fn(|_, _| 2.0 * self.next() - 1.0);
            if v.norm() < 1.0 && v.norm() > 0.1 {
                break v.normalize();
            }
        };
        let orientation =
            Rotation::from_euler_angles(6.0 * self.next(), 3.0 * self.next(), 6.0 * self.next());
        Pose { position: Point::from(direction * distance), orientation }
    }
}

fn volume(solver: &mut OverlapSolver, a: &Body, at_a: &Pose, b: &Body, at_b: &Pose) -> f64 {
    let patches = solver.solve(a, at_a, b, at_b).expect("a route");
    patches.iter().map(|p| p.volume).sum()
}

fn main() {
    let only = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    let body = |name, distance, half: [f64; 3]| Body { name, distance, half: half.into() };
    let ball = body("ball", ball, [1.0; 3]);
    let torus = body("torus", torus, [1.0, 1.0, 0.3]);
    let union = body("union", union, [0.95, 0.9, 0.95]);
    let superellipsoid = body("superellipsoid", superellipsoid, [1.05, 1.05, 0.72]);
    let brick = body("brick", brick, [0.8, 0.6, 0.5]);
    let pairs = [
        (&ball, &ball),
        (&torus, &torus),
        (&union, &union),
        (&torus, &union),
        (&superellipsoid, &superellipsoid),
        (&superellipsoid, &torus),
        (&ball, &brick),
        (&brick, &brick),
    ];
    println!("pair; per tolerance: median µs | median and largest relative error of the volume");
    for (a, b) in pairs {
        let name = format!("{}-{}", a.name, b.name);
        if only.as_ref().is_some_and(|o| !name.contains(o.as_str())) {
            continue;
        }
        let tree = || OverlapSolver::new().with_route(Some(Route::Tree));
        let mut finest = tree().with_refinement(Refinement::Tolerance(3e-6));
        let (mut draw, mut poses) = (Draw(7), Vec::new());
        while poses.len() < 20 {
            let turn = draw.pose(0.0);
            // Push together until they overlap, then somewhat more.
            let mut at = draw.pose(2.2);
            let step = 0.995;
            let mut rough = tree().with_refinement(Refinement::Tolerance(1e-1));
            while volume(&mut rough, a, &turn, b, &at) == 0.0 && at.position.coords.norm() > 0.3 {
                at.position.coords *= step;
            }
            at.position.coords *= 1.0 - 0.2 * draw.next().powi(2);
            let exact = if a.name == "ball" && b.name == "ball" {
                let d = 2.0 - at.position.coords.norm();
                PI * d * d * (6.0 - d) / 12.0
            } else {
                volume(&mut finest, a, &turn, b, &at)
            };
            if exact > 0.0 {
                poses.push((turn, at, exact));
            }
        }
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
            let mut solver = tree().with_refinement(Refinement::Tolerance(tolerance));
            let (mut errors, mut times, mut boxes) = (Vec::new(), Vec::new(), 0);
            for (at_a, at_b, exact) in &poses {
                let found = volume(&mut solver, a, at_a, b, at_b);
                errors.push((found / exact - 1.0).abs());
                boxes += solver.boxes().count();
                let mut best = f64::INFINITY;
                for _ in 0..3 {
                    let repeat = if tolerance > 1e-4 { 20 } else { 3 };
                    let start = ProcessTime::now();
                    for _ in 0..repeat {
                        std::hint::black_box(volume(&mut solver, a, at_a, b, at_b));
                    }
                    best = best.min(start.elapsed().as_secs_f64() / f64::from(repeat));
                }
                times.push(1e6 * best);
            }
            errors.sort_by(f64::total_cmp);
            times.sort_by(f64::total_cmp);
            println!(
                "{name:<30} {tolerance:7.0e}: {:9.1} µs (most {:9.1}) | {:8.1e} {:8.1e} | {:6} boxes",
                times[times.len() / 2],
                times[times.len() - 1],
                errors[errors.len() / 2],
                errors[errors.len() - 1],
                boxes / poses.len()
            );
        }
    }
}
