//! Laws and scenes beyond two spheres.
use super::*;
use dem::{Chen, Cuboid, DemError, HalfSpace, Means, Partner, Rolling};
use interfaces::{Checkpoint, Dynamics, Point, Rotation};

const G: f64 = 9.81;

fn floor() -> HalfSpace {
    HalfSpace::new(Point::origin(), Vector::y()).unwrap()
}

/// A sphere on an incline with rolling friction: it stays where tan α < μ_r, beyond it rolls with (5/7) g (sin α − μ_r cos α), as the torque
/// μ_r R N asks.
#[test]
fn rolling_friction_holds_and_slows() {
    for (degrees, rolls) in [(5.0_f64, false), (15.0, true)] {
        let angle = degrees.to_radians();
        let material = Material {
            youngs_modulus: 1e8,
            damping: 20.0,
            friction: 1.0,
            rolling_friction: 0.1,
            ..Material::default()
        };
        let mut bodies = RigidBodies::with_law(Periods::default(), Rolling(Chen::default()));
        bodies.add_wall(floor(), material).unwrap();
        bodies.set_gravity(Vector::new(angle.sin(), -angle.cos(), 0.0) * G);
        let place = Pose::at([0.0, R, 0.0]);
        bodies.add(sphere().shape(), material, place, Twist::default(), Freedom::FREE).unwrap();
        // It sinks in and the springs are stretched.
        bodies.advance(0.1).unwrap();
        let start = bodies.twist(BodyId(0)).linear.x;
        bodies.advance(0.2).unwrap();
        let gained = bodies.twist(BodyId(0)).linear.x - start;
        let exact = if rolls { 5.0 / 7.0 * G * (angle.sin() - 0.1 * angle.cos()) * 0.2 } else { 0.0 };
        println!("{degrees} degrees: gained {gained:.6} m/s, should be {exact:.6}");
        assert!((gained - exact).abs() < 5e-3 * G * angle.sin() * 0.2);
    }
}

/// A rod longer than half the period, and two images of it beside a ball: the ball is pushed by both ends of the same rod at once.
#[test]
fn images_of_a_long_body() {
    let length = 10.0 * R;
    let mut bodies = RigidBodies::new(Periods::new([Some(length), None, None]));
    let rod = Cuboid::new([8.2 * R, R, R]).unwrap();
    let m = elastic();
    bodies.add(rod, m, Pose::at([0.0; 3]), Twist::default(), Freedom::NONE).unwrap();
    // The gap between the rod's end and its own image's is 1.8 R wide, and the ball, which is 2 R wide, in its middle; three periods off.
    let at = Pose::at([0.5 * length + 3.0 * length, 0.0, 0.0]);
    bodies.add(sphere().shape(), m, at, moving([0.0, 1e-9, 0.0], [0.0; 3]), Freedom::FREE).unwrap();
    assert!(matches!(bodies.check_overlaps(), Err(DemError::OverlappingStart { .. })));
    let dt = bodies.stable_dt();
    bodies.advance(dt).unwrap();
    let touched: Vec<_> = bodies.contacts().map(|c| (c.partner, c.force)).collect();
    assert_eq!(touched.len(), 2, "{touched:?}");
    assert!((touched[0].1 + touched[1].1).x.abs() < 1e-12 * touched[0].1.norm(), "from both sides alike");
    assert!(touched[0].1.x.abs() > 0.0);
}

/// Cubes and spheres tumbling into a heap between walls.
fn heap() -> RigidBodies {
    let mut bodies = RigidBodies::new(Periods::new([Some(9.0 * R), None, Some(9.0 * R)]));
    bodies.add_wall(floor(), Material::default()).unwrap();
    bodies.set_gravity(Vector::new(0.0, -G, 0.0));
    let cube: Arc<dyn Shape> = Arc::new(Cuboid::new([1.5 * R; 3]).unwrap());
    for i in 0..600 {
        let at = [i % 3, i / 9, i / 3 % 3].map(|k| 3.0 * R * f64::from(k));
        let turned = Rotation::from_scaled_axis(Vector::new(0.1, 0.7, 0.3) * f64::from(i));
        let pose = Pose { position: Point::new(at[0], 1.5 * R + at[1], at[2]), orientation: turned };
        let shape = if i % 2 == 0 { cube.clone() } else { sphere().shape() };
        let twist = moving([f64::from(i).sin(), -0.2, 0.1 * f64::from(i % 5)], [1.0, 2.0, 3.0]);
        bodies.add(shape, Material::default(), pose, twist, Freedom::FREE).unwrap();
    }
    bodies
}

/// More threads change no bit, in a scene of several chunks of pairs.
#[test]
fn any_number_of_threads_gives_the_same() {
    let state = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut bodies = heap();
            let dt = bodies.stable_dt();
            for _ in 0..1000 {
                bodies.advance(dt).unwrap();
            }
            assert!(bodies.n_contacts() > 30, "{}", bodies.n_contacts());
            let mut bits = Vec::new();
            bodies.save(&mut |_, values| bits.extend(values.iter().map(|v| v.to_bits())));
            bits
        })
    };
    let one = state(1);
    assert_eq!(one, state(2));
    assert_eq!(one, state(3));
}

/// Literal means double Y, γ, M and L_c of equal bodies: the same elastic force per volume, but √2³ … of the damping; tension only if asked for.
#[test]
fn means_and_adhesion() {
    let pull = |law: Chen, speed: f64| {
        let mut bodies = RigidBodies::with_law(Periods::default(), law);
        let m = Material { friction: 0.0, ..Material::default() };
        for (x, u) in [(-0.99 * R, speed), (0.99 * R, -speed)] {
            let (pose, twist) = (Pose::at([x, 0.0, 0.0]), moving([u, 0.0, 0.0], [0.0; 3]));
            bodies.add(sphere().shape(), m, pose, twist, Freedom::FREE).unwrap();
        }
        bodies.advance(1e-9).unwrap();
        bodies.contacts().next().unwrap().force.x
    };
    let (series, literal) = (Chen::default(), Chen::default().with_means(Means::Literal));
    let still = pull(series, 0.0);
    assert!(still < 0.0 && (pull(literal, 0.0) / still - 1.0).abs() < 1e-9);
    // γ √(YM/L³): 2 √(2·2/8).
    let (a, b) = (pull(series, 0.1) - still, pull(literal, 0.1) - still);
    assert!((b / a - 2.0_f64.sqrt()).abs() < 1e-4, "{}", b / a);
    assert_eq!(pull(series, -10.0), 0.0);
    assert!(pull(series.with_adhesion(true), -10.0) > 0.0);
}

/// A body that comes in far away, amid frictional contacts with a wall and a neighbour, changes no bit of the others' way.
#[test]
fn bodies_come_in() {
    let run = |comes: bool| {
        let mut bodies = RigidBodies::new(Periods::default());
        let material = Material { damping: 5.0, ..Material::default() };
        for k in 0..2 {
            let plane = HalfSpace::new(Point::new(0.0, -f64::from(k), 0.0), Vector::y()).unwrap();
            bodies.add_wall(plane, material).unwrap();
        }
        bodies.set_gravity(Vector::new(1.0, -G, 0.0));
        for x in [0.0, 1.99] {
            let pose = Pose::at([x * R, 0.999 * R, 0.0]);
            bodies.add(sphere().shape(), material, pose, Twist::default(), Freedom::FREE).unwrap();
        }
        for step in 0..400 {
            if comes && step % 100 == 50 {
                let pose = Pose::at([f64::from(step), 1.0, 0.0]);
                bodies.add(sphere().shape(), material, pose, Twist::default(), Freedom::FREE).unwrap();
            }
            bodies.advance(1e-4).unwrap();
        }
        assert!(bodies.contacts().filter(|c| c.partner == dem::Partner::Wall(0)).count() == 2);
        [bodies.pose(BodyId(0)), bodies.pose(BodyId(1))]
    };
    assert_eq!(run(true), run(false));
}

/// So fast that it would fly over a plate within one foreseen sub-step: the plate is met all the same, and as it is too soft, that is told.
#[test]
fn nothing_flies_past_unseen() {
    let soft = Material { youngs_modulus: 1e3, ..Material::default() };
    let mut bodies = RigidBodies::new(Periods::default());
    let plate = Cuboid::new([0.2 * R, 10.0 * R, 10.0 * R]).unwrap();
    bodies.add(plate, soft, Pose::at([0.0; 3]), Twist::default(), Freedom::NONE).unwrap();
    let speed = 1000.0;
    let ball = Pose::at([-1.5 * R, 0.0, 0.0]);
    let fast = moving([speed, 0.0, 0.0], [0.0; 3]);
    bodies.add(sphere().shape(), soft, ball, fast, Freedom::FREE).unwrap();
    let dt = bodies.stable_dt();
    assert!(speed * dt > 4.0 * R, "it would be past it after one step");
    let error = bodies.advance(dt).unwrap_err();
    let plate = Partner::Body(BodyId(1), [0; 3]);
    assert!(matches!(error, DemError::PassedThrough { partner, .. } if partner == plate), "{error}");
    // Told of half way through, after 1.1 R.
    let half = 1.1 * R / speed;
    assert!((bodies.contact_time() / half - 1.0).abs() < 0.1, "{} of {half} s", bodies.contact_time());
    assert!(bodies.pose(BodyId(1)).position.x.abs() < 0.1 * R);
}

/// Two feet of one body have a spring each: it stands on an incline. (Without them, dashpots alone, it would creep.)
#[test]
fn feet_have_a_history_each() {
    use dem::{Part, Union};
    let foot = |x: f64| Part { shape: Arc::new(Cuboid::new([R; 3]).unwrap()), pose: Pose::at([x, 0.0, 0.0]) };
    let stool = Union::new(vec![foot(-1.5 * R), foot(1.5 * R)]).unwrap();
    let material = Material { youngs_modulus: 1e7, damping: 10.0, friction: 0.5, ..Material::default() };
    let mut bodies = RigidBodies::new(Periods::default());
    bodies.add_wall(floor(), material).unwrap();
    let angle = 10.0_f64.to_radians();
    bodies.set_gravity(Vector::new(angle.sin(), -angle.cos(), 0.0) * G);
    bodies.add(stool, material, Pose::at([0.0, 0.5 * R, 0.0]), Twist::default(), Freedom::FREE).unwrap();
    bodies.advance(0.2).unwrap();
    assert_eq!(bodies.n_contacts(), 2);
    let start = bodies.pose(BodyId(0)).position;
    bodies.advance(0.2).unwrap();
    let moved = (bodies.pose(BodyId(0)).position - start).norm();
    println!("moved by {moved:.1e} m");
    assert!(moved < 1e-9);
}
