//! What the adaptive tree costs against its error, in µs of CPU time per pair, for bodies of which only a signed distance is
//! known. Sample run: `cargo bench -p siltflow-dem --bench tree` (a minute or so); `-- torus` takes only the pairs with this word.
//!
//! Each pair is posed twenty times (or as often as POSES says) at random, between a graze and half its depth. The errors are those of the volume, and of the
//! normal of the largest region in degrees, against the exact ones (spheres) or against a tolerance of 3e-6. The rows go to
//! `out/overlap/tree.csv`, too: pair, tolerance, median and largest µs, median and largest error, median and largest degrees,
//! median number of distances asked for, and the poses with boxes.
use cpu_time::ProcessTime;
use dem::{OverlapSolver, Refinement, Route, Shape};
use interfaces::{Aabb, Inertia, Point, Pose, Rotation, Solid, Vector};
use std::f64::consts::PI;
use std::fmt::Write;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// A signed distance and a box, as a user's type would have them.
struct Body<F> {
    name: &'static str,
    distance: F,
    half: Vector,
}

/// The same, and counts how often its distance is asked for.
struct Counted<'a>(&'a dyn Shape, AtomicUsize);

impl Solid for Counted<'_> {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        self.1.fetch_add(1, Relaxed);
        self.0.signed_distance(x, band)
    }
    fn aabb(&self) -> Aabb {
        self.0.aabb()
    }
}

impl Shape for Counted<'_> {
    fn name(&self) -> &'static str {
        self.0.name()
    }
    fn inertia(&self, density: f64) -> Inertia {
        self.0.inertia(density)
    }
    fn bounding_radius(&self) -> f64 {
        self.0.bounding_radius()
    }
}

impl<F: Fn(Vector) -> f64 + Send + Sync> Solid for Body<F> {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        (self.distance)(x.coords)
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), self.half)
    }
}

impl<F: Fn(Vector) -> f64 + Send + Sync> Shape for Body<F> {
    fn name(&self) -> &'static str {
        self.name
    }
    /// That of its box.
    fn inertia(&self, density: f64) -> Inertia {
        let (h, volume) = (self.half, 8.0 * self.half.product());
        let third = |a: f64, b: f64| density * volume * (a * a + b * b) / 3.0;
        let diagonal = Vector::new(third(h.y, h.z), third(h.x, h.z), third(h.x, h.y));
        Inertia { mass: density * volume, volume, tensor: nalgebra::Matrix3::from_diagonal(&diagonal) }
    }
    fn bounding_radius(&self) -> f64 {
        self.half.norm()
    }
}

fn ball(x: Vector) -> f64 {
    x.norm() - 1.0
}
fn torus(x: Vector) -> f64 {
    let out = (x.x * x.x + x.y * x.y).sqrt() - 0.7;
    (out * out + x.z * x.z).sqrt() - 0.3
}
/// Three balls about a fourth.
fn union(x: Vector) -> f64 {
    let centres = [[0.0, 0.0, 0.0], [0.5, 0.1, 0.0], [-0.2, 0.45, 0.2], [-0.1, -0.3, 0.5]];
    centres.iter().map(|c| (x - Vector::from(*c)).norm() - 0.45).fold(f64::INFINITY, f64::min)
}
fn brick(x: Vector) -> f64 {
    block(x, [0.8, 0.6, 0.5])
}
fn block(x: Vector, half: [f64; 3]) -> f64 {
    let q = x.abs() - Vector::from(half);
    q.map(|q| q.max(0.0)).norm() + q.max().min(0.0)
}
/// Two bars of square section at a right angle.
fn angle(x: Vector) -> f64 {
    let lying = block(x - Vector::new(0.0, -0.5, 0.0), [0.8, 0.3, 0.3]);
    lying.min(block(x - Vector::new(-0.5, 0.0, 0.0), [0.3, 0.8, 0.3]))
}
/// A cube with a groove along its top.
fn grooved(x: Vector) -> f64 {
    block(x, [0.6, 0.6, 0.6]).max(-block(x - Vector::new(0.0, 0.0, 0.6), [0.7, 0.2, 0.3]))
}
/// |x|⁴ + |y|⁴ + |z|⁴ = 1, stretched and twisted about z; to first order the distance.
fn superellipsoid(x: Vector) -> f64 {
    let (sin, cos) = (0.8 * x.z).sin_cos();
    let p = Vector::new((cos * x.x + sin * x.y) / 0.9, (cos * x.y - sin * x.x) / 0.5, x.z / 0.7);
    let r = p.norm().max(1e-3);
    let cubes = p.component_mul(&p).component_mul(&p);
    let sum = cubes.dot(&p).max(1e-12);
    let root = sum.sqrt().sqrt();
    // Of the fourth root of the sum.
    let slope = cubes.component_div(&Vector::new(0.9, 0.5, 0.7)).norm() * root / sum;
    (root - 1.0) / (slope.max(0.2 / r) * 1.5)
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

/// Volume of all regions, centroid and normal of the largest one.
fn measure(
    solver: &mut OverlapSolver,
    a: &dyn Shape,
    at_a: &Pose,
    b: &dyn Shape,
    at_b: &Pose,
) -> [Vector; 3] {
    // Too many boxes: not a number.
    let Ok(patches) = solver.solve(a, at_a, b, at_b) else { return [Vector::repeat(f64::NAN); 3] };
    let volume: f64 = patches.iter().map(|p| p.volume).sum();
    let largest = patches.iter().max_by(|p, q| p.volume.total_cmp(&q.volume));
    let [centroid, normal] = largest.map_or([Vector::zeros(); 2], |p| [p.centroid.coords, p.normal]);
    [Vector::x() * volume, centroid, normal]
}

fn sorted(mut values: Vec<f64>) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    [values[values.len() / 2], values[values.len() - 1]]
}

fn main() {
    let only = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    fn body(
        name: &'static str,
        distance: impl Fn(Vector) -> f64 + Send + Sync + 'static,
        half: [f64; 3],
    ) -> Box<dyn Shape> {
        Box::new(Body { name, distance, half: half.into() })
    }
    let ball = body("ball", ball, [1.0; 3]);
    let torus = body("torus", torus, [1.0, 1.0, 0.3]);
    let union = body("union", union, [0.95, 0.9, 0.95]);
    let superellipsoid = body("superellipsoid", superellipsoid, [1.05, 1.05, 0.72]);
    let brick = body("brick", brick, [0.8, 0.6, 0.5]);
    let angle = body("angle", angle, [0.8, 0.8, 0.3]);
    let grooved = body("grooved", grooved, [0.6; 3]);
    let pairs: [[&dyn Shape; 2]; 10] = [
        [&*ball, &*ball],
        [&*torus, &*torus],
        [&*union, &*union],
        [&*torus, &*union],
        [&*superellipsoid, &*superellipsoid],
        [&*superellipsoid, &*torus],
        [&*ball, &*brick],
        [&*angle, &*angle],
        [&*grooved, &*grooved],
        [&*angle, &*torus],
    ];
    let n_poses: usize = std::env::var("POSES").ok().and_then(|n| n.parse().ok()).unwrap_or(20);
    let mut csv = String::from(
        "pair,tolerance,us_median,us_largest,error_median,error_largest,degrees_median,degrees_largest,distances_median,poses_with_boxes\n",
    );
    for [a, b] in pairs {
        let name = format!("{}-{}", a.name(), b.name());
        if only.as_ref().is_some_and(|o| !name.contains(o.as_str())) {
            continue;
        }
        let tree = || OverlapSolver::new().with_route(Some(Route::Tree));
        let mut finest = tree().with_refinement(Refinement::Tolerance(3e-6));
        let (mut draw, mut poses) = (Draw(7), Vec::new());
        while poses.len() < n_poses {
            let turn = draw.pose(0.0);
            // Push together until they overlap, then somewhat more.
            let mut at = draw.pose(2.2);
            let step = 0.995;
            let mut rough = tree().with_refinement(Refinement::Tolerance(1e-1));
            while measure(&mut rough, a, &turn, b, &at)[0].x == 0.0 && at.position.coords.norm() > 0.3 {
                at.position.coords *= step;
            }
            at.position.coords *= 1.0 - 0.2 * draw.next().powi(2);
            let mut exact = measure(&mut finest, a, &turn, b, &at);
            if name == "ball-ball" {
                let d = 2.0 - at.position.coords.norm();
                exact[0].x = PI * d * d * (6.0 - d) / 12.0;
                exact[2] = -at.position.coords.normalize();
            }
            if exact[0].x > 0.0 {
                poses.push((turn, at, exact));
            }
        }
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4] {
            let mut solver = tree().with_refinement(Refinement::Tolerance(tolerance));
            let (mut errors, mut degrees, mut counts, mut times) = (vec![], vec![], vec![], vec![]);
            let mut boxes = 0;
            for (at_a, at_b, exact) in &poses {
                let counted = [a, b].map(|body| Counted(body, AtomicUsize::new(0)));
                let found = measure(&mut solver, &counted[0], at_a, &counted[1], at_b);
                counts.push(counted.iter().map(|c| c.1.load(Relaxed) as f64).sum::<f64>());
                let error = (found[0].x / exact[0].x - 1.0).abs();
                if std::env::var("SHOW").is_ok() {
                    println!("  {error:.1e} {} {}", solver.boxes().count(), counts[counts.len() - 1]);
                }
                errors.push(error);
                // Of regions of about the same size the other one may come first.
                if (found[1] - exact[1]).norm() < 0.02 {
                    degrees.push(found[2].angle(&exact[2]).to_degrees());
                }
                boxes += usize::from(solver.boxes().next().is_some());
                let mut best = f64::INFINITY;
                for _ in 0..3 {
                    let repeat = if tolerance > 1e-4 { 20 } else { 3 };
                    let start = ProcessTime::now();
                    for _ in 0..repeat {
                        std::hint::black_box(measure(&mut solver, a, at_a, b, at_b));
                    }
                    best = best.min(start.elapsed().as_secs_f64() / f64::from(repeat));
                }
                times.push(1e6 * best);
            }
            let [time, error, degree] = [sorted(times), sorted(errors), sorted(degrees)];
            let count = sorted(counts);
            println!(
                "{name:<30} {tolerance:6.0e}: {:8.1} µs (most {:8.1}) | {:7.1e} {:7.1e} | {:7.1e}° {:7.1e}° | {:6} distances, {boxes} with boxes",
                time[0], time[1], error[0], error[1], degree[0], degree[1], count[0]
            );
            writeln!(
                csv,
                "{name},{tolerance:e},{:.1},{:.1},{:.2e},{:.2e},{:.2e},{:.2e},{},{boxes}",
                time[0], time[1], error[0], error[1], degree[0], degree[1], count[0]
            )
            .expect("memory");
        }
    }
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../out/overlap");
    std::fs::create_dir_all(&folder).expect("a folder for results");
    std::fs::write(folder.join("tree.csv"), csv).expect("a file for results");
}
