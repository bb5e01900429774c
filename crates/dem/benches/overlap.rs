//! CPU time per pair and error of every route.
use dem::{Cuboid, OverlapSolver, Shape, Sphere};
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

fn main() {
    let mut solver = OverlapSolver::new();
    let mut row = |name: &str, a: &dyn Shape, b: &dyn Shape, at_b: Pose| {
        let origin = Pose::at([0.0; 3]);
        let volume: f64 = solver.solve(a, &origin, b, &at_b).unwrap().iter().map(|o| o.volume).sum();
        let us = time(|| {
            std::hint::black_box(solver.solve(a, &origin, std::hint::black_box(b), &at_b).unwrap());
        });
        println!("{name:40} {us:9.3} us  V {volume:.6e}");
    };
    let ball = Sphere::new(1.0).unwrap();
    row("spheres", &ball, &ball, at([1.8, 0.3, 0.1], [0.0; 3]));
    let cube = Cuboid::new([1.0; 3]).unwrap();
    row("cubes, corner in", &cube, &cube, at([0.8, 0.7, 0.75], [0.3, 0.2, 0.5]));
    row("cubes, face in", &cube, &cube, at([0.9, 0.1, 0.05], [0.03, 0.2, 0.05]));
    row("cubes, aligned", &cube, &cube, at([0.9, 0.8, 0.7], [0.0; 3]));
    row("cubes, deep", &cube, &cube, at([0.1, 0.0, 0.0], [0.3, 0.2, 0.5]));
    row("cubes, apart, spheres around meet", &cube, &cube, at([1.2, 0.2, 0.1], [0.3, 0.2, 0.5]));
}
