//! CPU time of bodies that settle and lie: `cargo bench -p siltflow-dem --bench motion -- [names of scenes]`.
//!
//! Spheres fall from a loose lattice into a box and come to rest; the time is that of steps after the fall, per particle and step. Cubes and
//! polyhedra of 26 vertices pile up; there it is per pair that touches and step. Each figure is the median of several blocks of steps.
use cpu_time::ProcessTime;
use dem::{
    Chen, ContactLaw, ConvexPolyhedron, Cuboid, HalfSpace, Material, Potential, RigidBodies, Shape, Sleep,
    Sphere,
};
use interfaces::{BodyId, Dynamics, Freedom, Kinematics, Periods, Point, Pose, Rotation, Twist, Vector};
use std::f64::consts::PI;
use std::sync::Arc;
use std::time::Instant;

const R: f64 = 0.01;

fn material() -> Material {
    Material {
        density: 2500.0,
        youngs_modulus: 1e9,
        damping: 2.0,
        restitution: 0.7,
        friction: 0.5,
        ..Material::default()
    }
}

/// Numbers in [−½, ½).
struct Draw(u64);
impl Draw {
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    }
}

/// `n` bodies on a loose lattice over a floor between four walls, turned anyhow unless they are round.
fn scene<L: ContactLaw>(law: L, shape: &Arc<dyn Shape>, n: usize, youngs_modulus: f64) -> RigidBodies<L> {
    let material = || Material { youngs_modulus, ..material() };
    let turned = shape.polyhedron().is_some();
    let spacing = 2.2 * shape.bounding_radius();
    let side = ((n as f64 / 2.0).cbrt()).ceil() as usize;
    let width = side as f64 * spacing;
    let mut bodies = RigidBodies::with_law(Periods::default(), law);
    bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
    let walls = [
        (Point::origin(), Vector::z()),
        (Point::origin(), Vector::x()),
        (Point::origin(), Vector::y()),
        (Point::new(width, 0.0, 0.0), -Vector::x()),
        (Point::new(0.0, width, 0.0), -Vector::y()),
    ];
    for (point, normal) in walls {
        bodies.add_wall(HalfSpace::new(point, normal).unwrap(), material()).unwrap();
    }
    let mut draw = Draw(7);
    for i in 0..n {
        let at = [i % side, i / side % side, i / (side * side)];
        let place = at.map(|k| (k as f64 + 0.5) * spacing + 0.1 * shape.bounding_radius() * draw.number());
        let mut pose = Pose::at(place);
        if turned {
            let about = Vector::new(draw.number(), draw.number(), draw.number());
            pose.orientation = Rotation::from_scaled_axis(about * 6.0);
        }
        bodies.add(shape.clone(), material(), pose, Twist::default(), Freedom::FREE).unwrap();
    }
    bodies
}

/// Runs `seconds` of the scene, then blocks of `steps`; prints medians of CPU and wall time.
fn time<L: ContactLaw>(name: &str, mut bodies: RigidBodies<L>, seconds: f64, steps: usize) {
    let dt = bodies.stable_dt();
    let n = bodies.n_bodies() as f64;
    let start = ProcessTime::now();
    let mut done = 0_u64;
    while (done as f64) * dt < seconds {
        bodies.advance(dt).unwrap();
        done += 1;
    }
    let fall = start.elapsed().as_secs_f64() / (n * done as f64);
    let mut blocks = Vec::new();
    for _ in 0..7 {
        let (cpu, wall, calls) = (ProcessTime::now(), Instant::now(), bodies.overlap_calls());
        let mut touching = 0;
        for _ in 0..steps {
            bodies.advance(dt).unwrap();
            touching += bodies.n_contacts();
        }
        let (cpu, wall) = (cpu.elapsed().as_secs_f64(), wall.elapsed().as_secs_f64());
        let calls = (bodies.overlap_calls() - calls) as f64 / steps as f64;
        blocks.push((cpu / steps as f64, wall / steps as f64, touching as f64 / steps as f64, calls));
    }
    blocks.sort_by(|p, q| p.0.total_cmp(&q.0));
    let (cpu, wall, touching, calls) = blocks[blocks.len() / 2];
    println!(
        "{name:34} {n:7} bodies ({} asleep), {:5.2} touching and {:5.2} overlaps per body: {:7.3} us per body-step ({:.3} in the fall), {:7.3} us per touching pair, wall {:7.3}",
        bodies.n_asleep(),
        touching / n,
        calls / n,
        1e6 * cpu / n,
        1e6 * fall,
        1e6 * cpu / touching,
        1e6 * wall / n,
    );
}

/// Points on a sphere's spiral.
fn polyhedron(n: usize) -> Arc<dyn Shape> {
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    let points: Vec<_> = (0..n)
        .map(|i| {
            let z = 1.0 - (2 * i + 1) as f64 / n as f64;
            let (sin, cos) = (golden * i as f64).sin_cos();
            let rho = (1.0 - z * z).sqrt();
            [R * rho * cos, R * rho * sin, R * z]
        })
        .collect();
    Arc::new(ConvexPolyhedron::from_points(&points).unwrap())
}

/// Elastic spheres in a periodic box: drift of the mean energy over 1e5 steps.
fn gas() {
    let n = 10;
    let spacing = 3.0 * R;
    let mut bodies =
        RigidBodies::with_law(Periods::new([Some(f64::from(n) * spacing); 3]), Potential::default());
    let mut draw = Draw(12345);
    let elastic = Material { restitution: 1.0, friction: 0.0, ..material() };
    for i in 0..n * n * n {
        let place = [i % n, i / n % n, i / (n * n)].map(|k| f64::from(k) * spacing);
        let linear = Vector::new(draw.number(), draw.number(), draw.number());
        let twist = Twist { linear, ..Twist::default() };
        bodies.add(Sphere::new(R).unwrap(), elastic, Pose::at(place), twist, Freedom::FREE).unwrap();
    }
    let momentum =
        |b: &RigidBodies<Potential>| (0..b.n_bodies()).map(|i| b.twist(BodyId(i)).linear).sum::<Vector>();
    let (p, dt, start) = (momentum(&bodies), bodies.stable_dt(), ProcessTime::now());
    let speeds: f64 = (0..bodies.n_bodies()).map(|i| bodies.twist(BodyId(i)).linear.norm()).sum();
    let mut first = 0.0;
    for block in 0..10 {
        let mut mean = 0.0;
        for step in 0..10_000 {
            bodies.advance(dt).unwrap();
            if step % 20 == 0 {
                mean += (bodies.kinetic_energy() + bodies.elastic_energy().unwrap()) / 500.0;
            }
        }
        if block == 0 {
            first = mean;
        }
        println!(
            "gas of 1000, {:6} steps: energy {:+.2e} of the first mean, momentum {:.1e} of all, {:.0} s",
            (block + 1) * 10_000,
            mean / first - 1.0,
            (momentum(&bodies) - p).norm() / speeds,
            start.elapsed().as_secs_f64()
        );
    }
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let asked = |name: &str| words.is_empty() || words.iter().any(|w| name == w);
    let ball: Arc<dyn Shape> = Arc::new(Sphere::new(R).unwrap());
    let cube: Arc<dyn Shape> = Arc::new(Cuboid::new([2.0 * R; 3]).unwrap());
    // Many are softer, so that they lie after fewer steps.
    for (n, stiffness, seconds, steps) in
        [(1_000, 1e9, 0.6, 1000), (10_000, 1e8, 0.4, 100), (100_000, 1e8, 0.25, 20)]
    {
        let name = format!("spheres {n}");
        if asked(&name) {
            time(&name, scene(Chen::default(), &ball, n, stiffness), seconds, steps);
        }
    }
    if asked("spheres, potential") {
        time("spheres, potential", scene(Potential::default(), &ball, 1000, 1e9), 0.3, 300);
    }
    if asked("spheres asleep") {
        let mut bodies = scene(Chen::default(), &ball, 1000, 1e9);
        bodies.set_sleep(Some(Sleep { speed: 0.02, time: 0.02 })).unwrap();
        time("spheres asleep", bodies, 3.0, 1000);
    }
    if asked("cubes") {
        time("cubes", scene(Chen::default(), &cube, 500, 1e9), 0.4, 100);
    }
    if asked("polyhedra of 26 vertices") {
        time("polyhedra of 26 vertices", scene(Chen::default(), &polyhedron(26), 500, 1e9), 0.4, 100);
    }
    if asked("gas") {
        gas();
    }
}
