//! Bodies on a wall: rest, rolling, sliding. Gravity is tilted instead of the wall.
use super::*;
use approx::assert_relative_eq;
use dem::HalfSpace;
use interfaces::{Bodies, Dynamics, Point};

const G: f64 = 9.81;

/// Hard, so that depth hardly shortens the lever; damped, so that the start is forgotten.
fn hard(friction: f64) -> Material {
    Material { youngs_modulus: 1e9, damping: 20.0, friction, ..Material::default() }
}
/// Y of a pair of these.
fn stiffness(m: &Material) -> f64 {
    m.youngs_modulus / (2.0 * (1.0 - m.poisson_ratio.powi(2)))
}
/// What the body at `at` shares with the floor.
fn on_wall(shape: Ball, at: Point) -> dem::Overlap {
    let pose = Pose { position: at, ..Pose::at([0.0; 3]) };
    dem::overlap(&shape.shape(), &pose, &floor(), &Pose::at([0.0; 3])).unwrap()[0]
}
fn floor() -> HalfSpace {
    HalfSpace::new(Point::origin(), Vector::y()).unwrap()
}

/// The body with its weight on the floor y = 0, gravity turned by `angle` towards +x; it stands as deep as its
/// weight presses it.
fn on_floor(shape: Ball, material: Material, angle: f64, speed: f64) -> RigidBodies {
    let weight = shape.mass(&material) * G;
    let force = |depth: f64| {
        let at = Point::new(0.0, R - depth, 0.0);
        let o = on_wall(shape, at);
        stiffness(&material) * o.volume / (4.0 * (o.centroid - at).norm())
    };
    let (mut low, mut high) = (1e-12 * R, 0.5 * R);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if force(middle) < weight * angle.cos() { low = middle } else { high = middle }
    }
    let mut bodies = scene(shape, material, &[([0.0, R - low, 0.0], moving([speed, 0.0, 0.0], [0.0; 3]))]);
    bodies.add_wall(floor(), material).unwrap();
    bodies.apply(BodyId(0), push(weight * Vector::new(angle.sin(), -angle.cos(), 0.0)));
    bodies
}

/// A disc rolls down an incline with (2/3) g sin α iff μ ≥ tan α/3, a sphere with (5/7) g sin α iff μ ≥ (2/7) tan α;
/// else they slide with g (sin α − μ cos α).
#[test]
fn rolling_and_sliding_down_an_incline() {
    let angle = 30.0_f64.to_radians();
    for (shape, threshold, rolling) in [(disc(), 1.0 / 3.0, 2.0 / 3.0), (sphere(), 2.0 / 7.0, 5.0 / 7.0)] {
        for share in [0.5, 0.95, 1.05, 2.0] {
            let friction = share * threshold * angle.tan();
            let mut bodies = on_floor(shape, hard(friction), angle, 0.0);
            let time = 0.2;
            bodies.advance(time).unwrap();
            let Twist { linear, angular } = bodies.twist(BodyId(0));
            let exact =
                if share < 1.0 { angle.sin() - friction * angle.cos() } else { rolling * angle.sin() };
            assert_relative_eq!(linear.x / time, exact * G, max_relative = 3e-3);
            let slip = (linear.x + angular.z * R) / linear.x;
            assert_eq!(slip.abs() < 2e-3, share > 1.0, "share {share}: slip {slip}");
        }
    }
}

/// Sliding start: it rolls from t = 2v₀/(7μg) on, at 5v₀/7.
#[test]
fn a_sliding_sphere_comes_to_roll() {
    let (speed, friction) = (0.5, 0.2);
    let mut bodies = on_floor(sphere(), hard(friction), 0.0, speed);
    let exact = 2.0 * speed / (7.0 * friction * G);
    let (dt, mut time) = (1e-4, 0.0);
    let slip = |b: &RigidBodies| b.twist(BodyId(0)).linear.x + b.twist(BodyId(0)).angular.z * R;
    while slip(&bodies) > 2e-3 * speed {
        bodies.advance(dt).unwrap();
        time += dt;
        assert!(time < 2.0 * exact, "it never rolls");
    }
    assert_relative_eq!(time, exact, max_relative = 1e-2);
    bodies.advance(exact).unwrap();
    let Twist { linear, angular } = bodies.twist(BodyId(0));
    assert_relative_eq!(linear.x, 5.0 / 7.0 * speed, max_relative = 1e-3);
    assert_relative_eq!(-angular.z * R, 5.0 / 7.0 * speed, max_relative = 2e-3);
}

/// On an incline a body that may not turn sticks iff tan α ≤ μ.
#[test]
fn a_block_sticks_or_slides() {
    for (degrees, sticks) in [(16.0_f64, true), (17.5, false)] {
        let (angle, friction) = (degrees.to_radians(), 0.3);
        let block = Freedom { angular: [false; 3], ..Freedom::PLANAR };
        let free = on_floor(disc(), hard(friction), angle, 0.0);
        let mut bodies = RigidBodies::new(Periods::default());
        bodies.add(disc().shape(), hard(friction), free.pose(BodyId(0)), Twist::default(), block).unwrap();
        bodies.add_wall(floor(), hard(friction)).unwrap();
        let weight = bodies.inertia(BodyId(0)).mass * G;
        bodies.apply(BodyId(0), push(weight * Vector::new(angle.sin(), -angle.cos(), 0.0)));
        // The spring is stretched first.
        bodies.advance(0.1).unwrap();
        let start = bodies.twist(BodyId(0)).linear.x;
        bodies.advance(0.3).unwrap();
        let speed = bodies.twist(BodyId(0)).linear.x - start;
        let exact = if sticks { 0.0 } else { 0.3 * G * (angle.sin() - friction * angle.cos()) };
        assert!((speed - exact).abs() < 2e-5, "{degrees}°: gained {speed} m/s, should be {exact}");
    }
}

/// Dropped from a little above, it settles where Y V/L_c bears its weight.
#[test]
fn at_rest_the_contact_bears_the_weight() {
    for shape in [disc(), sphere()] {
        let material = Material { youngs_modulus: 1e5, damping: 20.0, ..Material::default() };
        let weight = shape.mass(&material) * G;
        let mut bodies = scene(shape, material, &[([0.0, 1.01 * R, 0.0], Twist::default())]);
        bodies.add_wall(floor(), material).unwrap();
        bodies.apply(BodyId(0), push(Vector::new(0.0, -weight, 0.0)));
        bodies.advance(3.0).unwrap();
        assert!(bodies.twist(BodyId(0)).linear.norm() < 1e-9);
        let at = bodies.pose(BodyId(0)).position;
        let o = on_wall(shape, at);
        let length = 4.0 * (o.centroid - at).norm();
        assert_relative_eq!(stiffness(&material) * o.volume / length, weight, max_relative = 1e-9);
        // Standing, what the wall gives over a step is the weight's impulse.
        bodies.advance(0.01).unwrap();
        assert_relative_eq!(bodies.contact_impulse(BodyId(0)).force.y, 0.01 * weight, max_relative = 1e-8);
    }
}

/// Ten cubes on one another, and ten spheres: at rest contact k bears the weight of what is above it.
#[test]
fn a_stack_of_ten() {
    use dem::{Cuboid, Shape};
    let cube: std::sync::Arc<dyn Shape> = std::sync::Arc::new(Cuboid::new([2.0 * R; 3]).unwrap());
    for (shape, drop, damping, time) in [(cube, 0.001, 5.0, 3.0), (sphere().shape(), 0.0, 20.0, 6.0)] {
        let mut bodies = RigidBodies::new(Periods::default());
        let material = Material { damping, youngs_modulus: 1e7, ..Material::default() };
        bodies.add_wall(floor(), material).unwrap();
        bodies.set_gravity(Vector::new(0.0, -G, 0.0));
        for k in 0..10 {
            let y = R * (1.0 + (2.0 + drop) * f64::from(k));
            bodies
                .add(shape.clone(), material, Pose::at([0.0, y, 0.0]), Twist::default(), Freedom::FREE)
                .unwrap();
        }
        bodies.advance(time).unwrap();
        let weight = bodies.inertia(BodyId(0)).mass * G;
        let fastest = bodies.ids().map(|b| bodies.twist(b).linear.norm()).fold(0.0, f64::max);
        println!("{}: fastest {fastest:.2e} m/s", shape.name());
        assert!(fastest < 1e-5);
        let mut carried: Vec<_> = bodies.contacts().map(|c| (c.point.y, c.force.y.abs())).collect();
        carried.sort_by(|p, q| p.0.total_cmp(&q.0));
        assert_eq!(carried.len(), 10);
        for (k, (_, force)) in carried.iter().enumerate() {
            assert_relative_eq!(*force, weight * (10 - k) as f64, max_relative = 1e-4);
        }
    }
}

/// Wheels that turn against one another roll upon one another; wheels that turn the same way rub, and each slows the other.
#[test]
fn wheels_roll_or_rub() {
    let force = |spins: [f64; 2]| {
        let m = Material { friction: 10.0, ..Material::default() };
        let bodies = [(-0.99 * R, spins[0]), (0.99 * R, spins[1])]
            .map(|(x, w)| ([x, 0.0, 0.0], moving([0.0; 3], [0.0, 0.0, w])));
        let mut bodies = scene(sphere(), m, &bodies);
        let dt = 1e-3 * bodies.stable_dt();
        bodies.advance(dt).unwrap();
        let felt = bodies.contacts().next().unwrap().force;
        let torques = [0, 1].map(|b| bodies.contact_impulse(BodyId(b)).torque.z / dt);
        (felt.y, torques)
    };
    let (rolls, _) = force([5.0, -5.0]);
    let (rubs, torques) = force([5.0, 5.0]);
    assert!(rolls.abs() < 1e-12 * rubs.abs(), "{rolls:e} {rubs:e}");
    // The surface of the first moves up where they touch.
    assert!(rubs < 0.0, "{rubs:e}");
    for torque in torques {
        assert!((torque / (0.99 * R * rubs) - 1.0).abs() < 1e-9, "{torque:e} {rubs:e}");
    }
    // As much as if one alone turned twice as fast.
    let (alone, _) = force([0.0, 10.0]);
    assert!((alone / rubs - 1.0).abs() < 1e-9, "{alone:e} {rubs:e}");
}
