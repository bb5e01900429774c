//! Overlaps that are deep, and the stiffness that makes them shallow.
use super::*;
use dem::{Chen, ContactLaw, Cuboid, DEEP, HalfSpace, Polygon, Potential, resting_depth};
use interfaces::{Dynamics, Point};

const G: f64 = 9.81;

/// Drops a body from where it touches and lets it rest: its deepest overlap.
fn rest<L: ContactLaw>(law: L, shape: &Arc<dyn Shape>, m: Material) -> dem::Depth {
    let plane = shape.aabb().extent().z == 0.0;
    let (up, freedom) = if plane { (Vector::y(), Freedom::PLANAR) } else { (Vector::z(), Freedom::FREE) };
    let mut bodies = RigidBodies::with_law(Periods::default(), law);
    bodies.set_gravity(-G * up);
    bodies.add_wall(HalfSpace::new(Point::origin(), up).unwrap(), m).unwrap();
    let at = Pose { position: Point::from(-up * shape.aabb().min.coords.dot(&up)), ..Pose::at([0.0; 3]) };
    bodies.add(shape.clone(), m, at, Twist::default(), freedom).unwrap();
    bodies.advance(3.0).unwrap();
    bodies.deepest().unwrap()
}

/// The static load of a body foresees the depth at which it rests, and with the stiffness that is proposed it rests half as deep as a deep
/// overlap begins.
#[test]
fn depth_is_foreseen_and_its_remedy_works() {
    fn case<L: ContactLaw>(law: L, shape: &Arc<dyn Shape>, youngs_modulus: f64) {
        let m = Material { youngs_modulus, damping: 3.0, restitution: 0.2, ..Material::default() };
        let weight = shape.inertia(m.density).mass * G;
        let foreseen = resting_depth(&law, shape.clone(), &m, &m, weight).unwrap();
        let found = rest(law.clone(), shape, m);
        let [ratio, expected] = [found.depth / found.radius, foreseen.depth / foreseen.radius];
        let stiffer = Material { youngs_modulus: found.youngs_modulus, ..m };
        let remedied = rest(law, shape, stiffer);
        let after = remedied.depth / remedied.radius;
        println!(
            "{} at {youngs_modulus:e} Pa: {ratio:.3} of its radius deep, foreseen {expected:.3}; at {:.3e} ({:.3e}) Pa {after:.4}",
            shape.name(),
            found.youngs_modulus,
            foreseen.youngs_modulus
        );
        assert!(ratio > DEEP && (ratio / expected - 1.0).abs() < 0.05);
        assert!((foreseen.youngs_modulus / found.youngs_modulus - 1.0).abs() < 0.1);
        assert!((after / (0.5 * DEEP) - 1.0).abs() < 0.05);
    }
    let ball: Arc<dyn Shape> = Arc::new(Sphere::new(0.1).unwrap());
    let disc: Arc<dyn Shape> = Arc::new(Disc::new(0.1).unwrap());
    let cube: Arc<dyn Shape> = Arc::new(Cuboid::new([0.2; 3]).unwrap());
    let block: Arc<dyn Shape> =
        Arc::new(Polygon::new(&[[-0.1, -0.1], [0.1, -0.1], [0.1, 0.1], [-0.1, 0.1]]).unwrap());
    for shape in [&ball, &disc] {
        case(Chen::default(), shape, 1e5);
        case(Potential::default(), shape, 1e5);
    }
    case(Chen::default(), &cube, 5e4);
    case(Chen::default(), &block, 5e4);
    case(Potential::default(), &cube, 6e4);
}

/// Two balls pressed together, one of them small: depth by the smaller radius.
#[test]
fn the_smaller_radius_counts() {
    let m = Material { youngs_modulus: 1e5, ..Material::default() };
    let mut bodies = RigidBodies::with_law(Periods::default(), Chen::default());
    for (radius, x) in [(0.1, 0.0), (0.02, 0.115)] {
        bodies
            .add(Sphere::new(radius).unwrap(), m, Pose::at([x, 0.0, 0.0]), Twist::default(), Freedom::NONE)
            .unwrap();
    }
    assert!(bodies.deepest().is_none());
    let mut free = RigidBodies::with_law(Periods::default(), Chen::default());
    for (radius, x) in [(0.1, 0.0), (0.02, 0.115)] {
        free.add(Sphere::new(radius).unwrap(), m, Pose::at([x, 0.0, 0.0]), Twist::default(), Freedom::FREE)
            .unwrap();
    }
    free.advance(1e-9).unwrap();
    let found = free.deepest().unwrap();
    assert!((found.depth - 0.005).abs() < 1e-6 && (found.radius - 0.02).abs() < 1e-12, "{found:?}");
    assert!(found.youngs_modulus > 1e5);
}
