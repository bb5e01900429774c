//! Overlaps of round bodies with one another: relative errors against a much finer run, and CPU time per pair. The depth is a share of
//! the cube root of the smaller volume.
//!
//! `cargo bench -p siltflow-dem --bench columns`
use cpu_time::ThreadTime;
use dem::{Capsule, Cylinder, Ellipsoid, OverlapSolver, Route, Shape, Sphere};
use interfaces::{Pose, Rotation, Vector};
use std::hint::black_box;

/// Numbers between 0 and 1 (Knuth's linear congruence).
struct Random(u64);
impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
    fn turn(&mut self) -> Rotation {
        Rotation::from_scaled_axis(Vector::from_fn(|_, _| 6.0 * self.next() - 3.0))
    }
}

fn main() {
    let ellipsoid = |a, b, c| Box::new(Ellipsoid::new([a, b, c]).unwrap()) as Box<dyn Shape>;
    let capsule = |r, l| Box::new(Capsule::new(r, l).unwrap()) as Box<dyn Shape>;
    let cylinder = |r, l| Box::new(Cylinder::new(r, l).unwrap()) as Box<dyn Shape>;
    let sphere = |r| Box::new(Sphere::new(r).unwrap()) as Box<dyn Shape>;
    let pairs = [
        ("spheres", sphere(1.0), sphere(0.7)),
        ("ellipsoids 1:1.5:2", ellipsoid(1.0, 1.5, 2.0), ellipsoid(1.0, 1.5, 2.0)),
        ("ellipsoids 1:3:10", ellipsoid(0.3, 1.0, 3.0), ellipsoid(0.3, 1.0, 3.0)),
        ("ellipsoid 1:1:10, sphere", ellipsoid(0.3, 0.3, 3.0), sphere(1.0)),
        ("ellipsoid 10:10:1, small sphere", ellipsoid(3.0, 3.0, 0.3), sphere(0.01)),
        ("capsules", capsule(0.5, 2.0), capsule(0.5, 2.0)),
        ("cylinders", cylinder(0.5, 2.0), cylinder(0.5, 2.0)),
        ("flat cylinders", cylinder(1.0, 0.2), cylinder(1.0, 0.2)),
        ("capsule, cylinder", capsule(0.5, 2.0), cylinder(0.5, 2.0)),
        ("ball, capsule", sphere(0.7), capsule(0.5, 2.0)),
        ("ball, cylinder", sphere(0.7), cylinder(0.5, 2.0)),
        ("capsule, ellipsoid", capsule(0.5, 2.0), ellipsoid(0.5, 0.75, 1.0)),
        ("cylinder, ellipsoid", cylinder(0.5, 2.0), ellipsoid(0.5, 0.75, 1.0)),
    ];
    println!(
        "pair | depth of the size | median error | 99 % | worst | gradient, median | moment, median | µs per pair"
    );
    // Only pairs whose name contains the argument, if there is one.
    let only = std::env::args().skip(1).find(|a| !a.starts_with('-')).unwrap_or_default();
    for (name, a, b) in pairs.iter().filter(|(name, ..)| name.contains(&only)) {
        for depth in [1e-6, 1e-4, 1e-2, 0.1, 0.3, 0.6, 1.0] {
            measure(name, &**a, &**b, depth);
        }
    }
}

/// Random orientations, the centres as far apart as lets the bodies overlap by a share of `depth` of the smaller one's size
/// along the line of centres.
fn measure(name: &str, a: &dyn Shape, b: &dyn Shape, depth: f64) {
    let mut random = Random(1);
    let count = 100;
    let round = name.starts_with("sphere") || name.starts_with("ellipsoid");
    // Spheres not by their closed form.
    let route = round.then_some(Route::Curve);
    let exact = if name == "spheres" { Some(Route::ClosedForm) } else { route };
    let mut fine = OverlapSolver::new().with_route(exact).with_tolerance(if round { 1e-10 } else { 1e-11 });
    let mut solver = OverlapSolver::new().with_route(route);
    let poses: Vec<[Pose; 2]> = (0..count)
        .map(|_| {
            let u = random.turn() * Vector::x();
            let at_a = Pose { orientation: random.turn(), ..Pose::at([0.0; 3]) };
            let turn = random.turn();
            // Where they touch, by bisection.
            let (mut near, mut far) = (0.0, a.bounding_radius() + b.bounding_radius());
            let at = |d: f64| Pose { position: (d * u).into(), orientation: turn };
            for _ in 0..50 {
                let middle = 0.5 * (near + far);
                let apart = solver.solve(a, &at_a, b, &at(middle)).unwrap().is_empty();
                if apart { far = middle } else { near = middle }
            }
            let size = (a.inertia(1.0).volume.min(b.inertia(1.0).volume)).cbrt();
            [at_a, at((near - depth * size).max(0.0))]
        })
        .collect();
    let (mut errors, mut gradients, mut moments) = (Vec::new(), Vec::new(), Vec::new());
    for [at_a, at_b] in &poses {
        let exact = fine.solve(a, at_a, b, at_b).unwrap().first().copied();
        let found = solver.solve(a, at_a, b, at_b).unwrap().first().copied();
        if let (Some(o), Some(e)) = (found, exact) {
            errors.push((o.volume / e.volume - 1.0).abs());
            gradients.push((o.gradient - e.gradient).norm() / e.area());
            moments.push((o.moment - e.moment).norm() / (e.area() * e.area().sqrt()));
        } else {
            errors.push(f64::INFINITY);
        }
    }
    for list in [&mut errors, &mut gradients, &mut moments] {
        list.sort_by(f64::total_cmp);
    }
    let mut times: Vec<f64> = (0..9)
        .map(|_| {
            let start = ThreadTime::now();
            for [at_a, at_b] in &poses {
                black_box(solver.solve(a, at_a, b, at_b).unwrap().len());
            }
            start.elapsed().as_secs_f64() * 1e6 / count as f64
        })
        .collect();
    times.sort_by(f64::total_cmp);
    let middle = |list: &[f64]| list.get(list.len() / 2).copied().unwrap_or(f64::NAN);
    println!(
        "{name} | {depth:.0e} | {:.0e} | {:.0e} | {:.0e} | {:.0e} | {:.0e} | {:.2}",
        middle(&errors),
        errors[errors.len() * 99 / 100],
        errors[errors.len() - 1],
        middle(&gradients),
        middle(&moments),
        times[0]
    );
}
