//! Costs of putting many bodies together, and the step that comes of it.
use super::*;
use dem::{HalfSpace, Tether};
use interfaces::{Dynamics, Point};
use std::time::{Duration, Instant};

fn tether(stiffness: f64) -> Tether {
    Tether { on_body: Point::origin(), anchor: Point::origin(), stiffness, damping: 0.0 }
}

/// The cost per body does not grow with their number: every body with a density of its own, every
/// second on a spring, every third held with a surface that moves. Sums over all bodies for each
/// would take minutes, and a table of all pairs of densities 90 GB.
#[test]
fn many_bodies_are_added_one_by_one() {
    let n = 40_000;
    let start = Instant::now();
    let mut bodies = RigidBodies::new(Periods::default());
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::y()).unwrap(), Material::default()).unwrap();
    let ball: Arc<dyn Shape> = Arc::new(Sphere::new(R).unwrap());
    for i in 0..n {
        let material = Material { density: 1000.0 + i as f64, ..Material::default() };
        let at = Pose::at([(i % 200) as f64 * 3.0 * R, ((i / 200) as f64 + 0.5) * 3.0 * R, 0.0]);
        let freedom = if i % 3 == 0 { Freedom::NONE } else { Freedom::FREE };
        let b = bodies.add(ball.clone(), material, at, Twist::default(), freedom).unwrap();
        bodies.set_tether(b, (i % 2 == 0).then(|| tether(1.0 + i as f64))).unwrap();
        if i % 3 == 0 {
            bodies.set_surface_motion(b, |_, _| Vector::x()).unwrap();
        }
    }
    bodies.check_overlaps().unwrap();
    assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
}

/// Each pair of many materials has its own properties, in either order; 1500 materials make 2.25e6
/// pairs, which are computed once.
#[test]
fn many_materials_are_paired() {
    let start = Instant::now();
    let soft = |i: usize| Material { youngs_modulus: 1e5 * (1.0 + i as f64), ..elastic() };
    let n = 1500;
    let mut bodies = RigidBodies::new(Periods::default());
    // Neighbours overlap by a tenth of R: 0 and n − 1, 1 and n − 2 …
    let order: Vec<usize> = (0..n / 2).flat_map(|i| [i, n - 1 - i]).collect();
    for i in 0..n {
        let material = soft(i);
        let place = order.iter().position(|k| *k == i).unwrap();
        let at = Pose::at([1.9 * R * (place % 2) as f64, 4.0 * R * (place / 2) as f64, 0.0]);
        bodies.add(sphere().shape(), material, at, Twist::default(), Freedom::FREE).unwrap();
    }
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
    bodies.advance(1e-9).unwrap();
    let forces: Vec<f64> = bodies.contacts().map(|c| c.force.norm()).collect();
    assert_eq!(forces.len(), n / 2);
    // The pair alone, in the other order.
    for (i, force) in forces.iter().enumerate().step_by(50) {
        let mut pair = RigidBodies::new(Periods::default());
        for (k, x) in [(n - 1 - i, 1.9 * R), (i, 0.0)] {
            let at = Pose::at([x, 0.0, 0.0]);
            pair.add(sphere().shape(), soft(k), at, Twist::default(), Freedom::FREE).unwrap();
        }
        pair.advance(1e-9).unwrap();
        let alone = pair.contacts().next().unwrap().force.norm();
        assert!((force / alone - 1.0).abs() < 1e-9, "{i}: {force} {alone}");
    }
}

/// The stable step is that of the bodies and tethers there are, in whatever order they came and
/// went.
#[test]
fn the_step_follows_tethers_and_removals() {
    let mut bodies = RigidBodies::new(Periods::default());
    for i in 0..4 {
        let at = Pose::at([f64::from(i) * 3.0 * R, 0.0, 0.0]);
        bodies.add(sphere().shape(), elastic(), at, Twist::default(), Freedom::FREE).unwrap();
    }
    let free = bodies.stable_dt();
    // Stiffer springs than contacts: steps go as 1/√k.
    let [stiff, stiffer] = [1e9, 4e9].map(tether);
    bodies.set_tether(BodyId(1), Some(stiff)).unwrap();
    let one = bodies.stable_dt();
    assert!(one < free);
    bodies.set_tether(BodyId(2), Some(stiffer)).unwrap();
    assert!((2.0 * bodies.stable_dt() / one - 1.0).abs() < 1e-12);
    bodies.set_tether(BodyId(2), Some(stiff)).unwrap();
    assert_eq!(bodies.stable_dt(), one);
    bodies.set_tether(BodyId(3), Some(stiffer)).unwrap();
    let _ = bodies.remove(&[BodyId(3)]).unwrap();
    assert_eq!(bodies.stable_dt(), one);
    bodies.set_tether(BodyId(1), None).unwrap();
    assert_eq!(bodies.stable_dt(), one);
    let _ = bodies.remove(&[BodyId(2)]).unwrap();
    assert_eq!(bodies.stable_dt(), free);
    assert!(bodies.ids().all(|b| bodies.tether(b).is_none()));
}
