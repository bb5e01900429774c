use dem::*;
use interfaces::{Pose, Rotation, Vector};
use cpu_time::ThreadTime;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let d: f64 = args[2].parse().unwrap();
    let s: Box<dyn Shape> = match &*args[1] {
        "e" => Box::new(Ellipsoid::new([1.0, 1.5, 2.0]).unwrap()),
        "c" => Box::new(Capsule::new(0.5, 2.0).unwrap()),
        "y" => Box::new(Cylinder::new(0.5, 2.0).unwrap()),
        _ => Box::new(Sphere::new(1.0).unwrap()),
    };
    let (a, b) = (&*s, &*s);
    let route = match &*args[3] { "curve" => Some(Route::Curve), "columns" => Some(Route::Columns), _ => None };
    let mut solver = OverlapSolver::new().with_route(route);
    let t = Rotation::from_scaled_axis(Vector::new(0.3, 0.5, -0.8));
    let at_a = Pose { orientation: t, ..Pose::at([0.0; 3]) };
    let n = 200000;
    for _ in 0..3 {
        let start = ThreadTime::now();
        let mut sum = 0.0;
        for i in 0..n {
            let at_b = Pose::at([d + 1e-9 * i as f64, 0.1, 0.2]);
            sum += solver.solve(a, &at_a, b, &at_b).unwrap().first().map_or(0.0, |o| o.volume);
        }
        println!("{:.3} us, {}", start.elapsed().as_secs_f64() * 1e6 / n as f64, sum / n as f64);
    }
}
