use dem::{Capsule, Cylinder, Ellipsoid, OverlapSolver, Route, Shape, Sphere};
use interfaces::{Pose, Rotation, Vector};
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
    let args: Vec<String> = std::env::args().collect();
    let depth: f64 = args[2].parse().unwrap();
    let s: Box<dyn Shape> = match &*args[1] {
        "e" => Box::new(Ellipsoid::new([0.3, 1.0, 3.0]).unwrap()),
        "f" => Box::new(Ellipsoid::new([1.0, 1.5, 2.0]).unwrap()),
        "c" => Box::new(Capsule::new(0.5, 2.0).unwrap()),
        "y" => Box::new(Cylinder::new(0.5, 2.0).unwrap()),
        _ => Box::new(Sphere::new(1.0).unwrap()),
    };
    let (a, b) = (&*s, &*s);
    let mut solver = OverlapSolver::new().with_route(Some(Route::Columns));
    let mut random = Random(1);
    for _ in 0..40 {
        let u = random.turn() * Vector::x();
        let at_a = Pose { orientation: random.turn(), ..Pose::at([0.0; 3]) };
        let turn = random.turn();
        let (mut near, mut far) = (0.0, a.bounding_radius() + b.bounding_radius());
        let at = |d: f64| Pose { position: (d * u).into(), orientation: turn };
        for _ in 0..60 {
            let middle = 0.5 * (near + far);
            let apart = solver.solve(a, &at_a, b, &at(middle)).unwrap().is_empty();
            if apart { far = middle } else { near = middle }
        }
        let size = (a.inertia(1.0).volume.min(b.inertia(1.0).volume)).cbrt();
        eprintln!("DBG --");
        let n = solver.solve(a, &at_a, b, &at((near - depth * size).max(0.0))).unwrap().len();
        if n == 0 { eprintln!("DBG none near {near}"); }
        eprintln!("DBG ==");
    }
}
