//! CPU time of random addition: spheres, and bodies that are placed tightly. `cargo bench -p siltflow-dem --bench placing`
use cpu_time::ProcessTime;
use dem::placing::{PlacingError, RandomAddition, Region, SizeDistribution};
use dem::{Capsule, Cuboid, Ellipsoid, Shape, Sphere};
use interfaces::{Aabb, Vector};

/// A periodic cube in which this volume is this share.
fn cube(volume: f64, share: f64) -> Region<'static> {
    let edge = (volume / share).cbrt();
    let bounds = Aabb { min: [0.0; 3].into(), max: Vector::repeat(edge).into() };
    Region::cuboid(bounds, [true; 3]).expect("a cube")
}
fn run(name: &str, shapes: &[&dyn Shape], share: f64, gap: f64, tight: bool) {
    let volume = shapes.iter().map(|s| s.inertia(1.0).volume).sum();
    let adding = RandomAddition::new(cube(volume, share)).with_gap(gap).expect("a gap");
    let adding = if tight { adding.tight() } else { adding };
    let mut times = Vec::new();
    let mut reached = share;
    for seed in 0..3 {
        let start = ProcessTime::now();
        if let Err(PlacingError::Jammed(jammed)) = adding.place(shapes, seed) {
            reached = jammed.fraction;
        }
        times.push(start.elapsed().as_secs_f64());
    }
    times.sort_by(f64::total_cmp);
    println!(
        "{name:<44} {:>8} bodies, share {share:.2}, reached {reached:.4}: {:>8.3} s",
        shapes.len(),
        times[1]
    );
}

fn main() {
    let ball = Sphere::new(0.5).expect("a sphere");
    for (number, share) in
        [(10_000, 0.3), (100_000, 0.1), (100_000, 0.2), (100_000, 0.3), (10_000, 0.34), (1000, 0.38)]
    {
        run("spheres of one size", &vec![&ball as &dyn Shape; number], share, 0.0, false);
    }
    let law = SizeDistribution::log_normal(1.0, 1.6, [0.2, 5.0]).expect("a distribution");
    let spheres: Vec<Sphere> =
        law.sizes(1).take(100_000).map(|d| Sphere::new(0.5 * d).expect("a sphere")).collect();
    run(
        "log-normal spheres, 1 : 25",
        &spheres.iter().map(|s| s as &dyn Shape).collect::<Vec<_>>(),
        0.3,
        0.0,
        false,
    );
    let rod = Capsule::new(0.1, 0.8).expect("a capsule");
    let brick = Cuboid::new([1.0, 0.6, 0.4]).expect("a box");
    let egg = Ellipsoid::new([0.5, 0.25, 0.3]).expect("an ellipsoid");
    for gap in [0.0, 0.02] {
        for (name, shape) in [("capsules 1 : 5", &rod as &dyn Shape), ("boxes", &brick), ("ellipsoids", &egg)]
        {
            run(&format!("{name}, tight, gap {gap}"), &vec![shape; 2000], 0.15, gap, true);
        }
    }
}
