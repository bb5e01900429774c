//! Surfaces that slide: friction takes bodies along with them.
use super::*;
use dem::{Chen, ContactLaw, Cuboid, DemError, HalfSpace, Polygon, Potential, Sleep};
use interfaces::{Checkpoint, Dynamics, Point, Rotation};

const G: f64 = 9.81;
const BELT: f64 = 0.5;

fn material() -> Material {
    Material { friction: 0.3, youngs_modulus: 1e7, restitution: 0.2, ..Material::default() }
}
/// The moving surface under the body.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Belt {
    /// A wall of one velocity, and one whose velocity is a function of the place.
    Wall,
    Field,
    /// A body at rest whose surface slides, and one that moves.
    Surface,
    Moving,
}
const BELTS: [Belt; 4] = [Belt::Wall, Belt::Field, Belt::Surface, Belt::Moving];

/// A body on a belt along `along`, the weight along −z or, in the plane, −y.
fn on_belt<L: ContactLaw>(
    law: L,
    belt: Belt,
    shape: Arc<dyn Shape>,
    half: f64,
    along: Vector,
) -> RigidBodies<L> {
    let plane = shape.aabb().extent().z == 0.0;
    let (up, freedom) = if plane { (Vector::y(), Freedom::PLANAR) } else { (Vector::z(), Freedom::FREE) };
    let mut bodies = RigidBodies::with_law(Periods::default(), law);
    bodies.set_gravity(-G * up);
    let at = |height: f64| Pose { position: Point::from(up * height), orientation: Rotation::identity() };
    bodies.add(shape, material(), at(half), Twist::default(), freedom).unwrap();
    let velocity = BELT * along;
    if matches!(belt, Belt::Wall | Belt::Field) {
        bodies.add_wall(HalfSpace::new(Point::origin(), up).unwrap(), material()).unwrap();
        match belt {
            Belt::Wall => bodies.set_wall_velocity(0, velocity).unwrap(),
            _ => bodies.set_wall_motion(0, move |_, _| velocity).unwrap(),
        }
        return bodies;
    }
    let below: Arc<dyn Shape> = if plane {
        Arc::new(Polygon::new(&[[-2.0, -0.1], [2.0, -0.1], [2.0, 0.1], [-2.0, 0.1]]).unwrap())
    } else {
        Arc::new(Cuboid::new([4.0, 4.0, 0.2]).unwrap())
    };
    let twist =
        Twist { linear: if belt == Belt::Moving { velocity } else { Vector::zeros() }, ..Twist::default() };
    let b = bodies.add(below, material(), at(-0.1), twist, Freedom::NONE).unwrap();
    if belt == Belt::Surface {
        // Blows, too, which contacts take no notice of.
        bodies.set_surface_motion(b, move |_, _| velocity + 0.3 * up).unwrap();
        assert_eq!(bodies.surface_motion(b, Vector::zeros()), Some(velocity + 0.3 * up));
    }
    bodies
}

/// Sliding bodies are quickened by μ g until they go along: a box, a ball (which first slides, then rolls), in 3D and 2D, by both laws.
#[test]
fn belts_take_bodies_along() {
    fn case<L: ContactLaw>(law: L, name: &str) {
        let boxes: [(Arc<dyn Shape>, &[Vector]); 2] = [
            (
                Arc::new(Cuboid::new([0.06, 0.06, 0.04]).unwrap()),
                &[Vector::new(0.6, 0.8, 0.0), Vector::new(-1.0, 0.0, 0.0)],
            ),
            (
                Arc::new(
                    Polygon::new(&[[-0.03, -0.02], [0.03, -0.02], [0.03, 0.02], [-0.03, 0.02]]).unwrap(),
                ),
                &[Vector::new(1.0, 0.0, 0.0)],
            ),
        ];
        for belt in BELTS {
            for (shape, directions) in &boxes {
                for along in *directions {
                    let mut bodies = on_belt(law.clone(), belt, shape.clone(), 0.02, *along);
                    bodies.advance(0.05).unwrap();
                    let early = bodies.twist(BodyId(0)).linear.dot(along);
                    bodies.advance(0.25).unwrap();
                    let late = bodies.twist(BodyId(0)).linear;
                    println!("{name}, {belt:?}: {early:.4} m/s after 0.05 s, {:.4} at last", late.dot(along));
                    // It bounces a little before it lies.
                    assert!((early / (0.3 * G * 0.05) - 1.0).abs() < 0.03);
                    assert!((late - BELT * along).norm() < 0.01 * BELT);
                }
            }
        }
    }
    case(Chen::default(), "Chen");
    case(Potential::default(), "Potential");
}

/// A ball on a belt slides at μ g and, from 2/7 of the belt's velocity on, rolls against it.
#[test]
fn a_ball_rolls_on_a_belt() {
    for belt in BELTS {
        let ball: Arc<dyn Shape> = Arc::new(Sphere::new(0.02).unwrap());
        let mut bodies = on_belt(Chen::default(), belt, ball, 0.02, Vector::x());
        bodies.advance(0.3).unwrap();
        let twist = bodies.twist(BodyId(0));
        println!("{belt:?}: {:.4} m/s, {:.3} rad/s", twist.linear.x, twist.angular.y);
        // The contact is nearer to the centre than the radius by its depth.
        assert!((twist.linear.x / (2.0 / 7.0 * BELT) - 1.0).abs() < 0.02);
        // The material at the contact goes with the belt: U + Ω × r, r downwards.
        assert!((twist.linear.x - twist.angular.y * 0.02 - BELT).abs() < 0.02 * BELT);
    }
}

/// The work of the belt is the energy of the parcel and what sliding loses: contacts do F·U on the body.
#[test]
fn work_of_the_belt() {
    let shape: Arc<dyn Shape> = Arc::new(Cuboid::new([0.06, 0.06, 0.04]).unwrap());
    let mut bodies = on_belt(Potential::default(), Belt::Wall, shape, 0.02, Vector::x());
    let (b, dt) = (BodyId(0), 1e-4);
    let (mut by_belt, mut on_body) = (0.0, 0.0);
    for _ in 0..3000 {
        let before = bodies.twist(b).linear;
        bodies.advance(dt).unwrap();
        let impulse = bodies.contact_impulse(b).force;
        by_belt += impulse.x * BELT;
        on_body += impulse.dot(&(0.5 * (before + bodies.twist(b).linear)));
    }
    let kinetic = 0.5 * bodies.inertia(b).mass * BELT * BELT;
    println!("belt {:.5}, body {:.5} of m U²/2", by_belt / kinetic, on_body / kinetic);
    // Half of it is lost by sliding.
    assert!((by_belt / kinetic - 2.0).abs() < 0.02 && (on_body / kinetic - 1.0).abs() < 0.02);
}

/// Sleeping bodies wake when a belt starts, and do not fall asleep on one that runs.
#[test]
fn sleepers_wake() {
    let shape: Arc<dyn Shape> = Arc::new(Cuboid::new([0.06, 0.06, 0.04]).unwrap());
    for belt in [Belt::Wall, Belt::Surface] {
        let mut bodies = on_belt(Potential::default(), Belt::Wall, shape.clone(), 0.02, Vector::zeros());
        if belt == Belt::Surface {
            bodies = on_belt(Potential::default(), Belt::Moving, shape.clone(), 0.02, Vector::zeros());
        }
        bodies.set_sleep(Some(Sleep { speed: 1e-3, time: 0.02 })).unwrap();
        (0..300).for_each(|_| bodies.advance(1e-3).unwrap());
        assert_eq!(bodies.n_asleep(), 1);
        match belt {
            Belt::Wall => bodies.set_wall_velocity(0, BELT * Vector::x()).unwrap(),
            _ => bodies.set_surface_motion(BodyId(1), |_, _| BELT * Vector::x()).unwrap(),
        }
        assert_eq!(bodies.n_asleep(), 0);
        (0..300).for_each(|_| bodies.advance(1e-3).unwrap());
        assert!((bodies.twist(BodyId(0)).linear.x / BELT - 1.0).abs() < 0.01, "{belt:?}");
        // Held by a stop it is slow, but friction goes on.
        assert_eq!(bodies.n_asleep(), 0);
    }
}

#[test]
fn motions_of_walls_are_checked() {
    let mut bodies = RigidBodies::with_law(Periods::default(), Chen::default());
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), material()).unwrap();
    assert!(matches!(
        bodies.set_wall_velocity(1, Vector::x()),
        Err(DemError::NoSuchWall { wall: 1, walls: 1 })
    ));
    assert!(matches!(
        bodies.set_wall_motion(3, |_, _| Vector::x()),
        Err(DemError::NoSuchWall { wall: 3, .. })
    ));
    for bad in [Vector::z(), Vector::new(1.0, 0.0, -1e-3), Vector::new(f64::NAN, 0.0, 0.0)] {
        let error = bodies.set_wall_velocity(0, bad).unwrap_err();
        assert!(
            matches!(error, DemError::WallVelocity { wall: 0, .. })
                && error.to_string().contains("along the plane")
        );
    }
    assert!(matches!(
        bodies.set_surface_motion(BodyId(0), |_, _| Vector::x()),
        Err(DemError::NoSuchBody { .. })
    ));
}

/// Velocity of a body that starts at rest on a belt of velocity `belt(t)` under Coulomb friction, by small steps: it slides at
/// ±μ g, or goes along with the belt if that takes no more.
fn coulomb(belt: impl Fn(f64) -> f64, end: f64) -> f64 {
    let (steps, mut v) = (200_000, 0.0);
    let dt = end / f64::from(steps);
    for step in 0..steps {
        let u = belt(f64::from(step + 1) * dt);
        v += (u - v).clamp(-0.3 * G * dt, 0.3 * G * dt);
    }
    v
}

/// On a belt that oscillates a body slides at μ g until it has caught up, and slides back when the belt is quicker than friction.
#[test]
fn bodies_follow_belts_that_oscillate() {
    let of_time = |t: f64| BELT * (20.0 * t).cos();
    let shape: Arc<dyn Shape> = Arc::new(Cuboid::new([0.06, 0.06, 0.04]).unwrap());
    for on_body in [false, true] {
        let belt = if on_body { Belt::Surface } else { Belt::Wall };
        let mut bodies = on_belt(Potential::default(), belt, shape.clone(), 0.02, Vector::x());
        if on_body {
            bodies.set_surface_motion(BodyId(1), move |_, t| Vector::x() * of_time(t)).unwrap();
        } else {
            bodies.set_wall_motion(0, move |_, t| Vector::x() * of_time(t)).unwrap();
        }
        for step in 1..=12 {
            // Steps of several sub-steps: the belt moves within them.
            let t = 0.02 * f64::from(step);
            bodies.renew(t - 0.02).unwrap();
            bodies.advance(0.02).unwrap();
            let (v, exact) = (bodies.twist(BodyId(0)).linear.x, coulomb(of_time, t));
            println!("{belt:?}, {t:.2} s: {v:.4} m/s for {exact:.4}");
            // It bounces a little before it lies.
            assert!((v - exact).abs() < 0.01 * BELT, "{belt:?}, {t:.2} s: {v:.4} for {exact:.4}");
        }
    }
}

/// Velocities of surfaces turn along with their bodies, and depend on the place on them.
#[test]
fn surfaces_turn_with_their_bodies() {
    let shape: Arc<dyn Shape> = Arc::new(Cuboid::new([0.06, 0.06, 0.04]).unwrap());
    let mut bodies = RigidBodies::with_law(Periods::default(), Potential::default());
    bodies.set_gravity(-G * Vector::z());
    bodies.add(shape, material(), Pose::at([0.0, 0.0, 0.02]), Twist::default(), Freedom::FREE).unwrap();
    let quarter = Rotation::from_scaled_axis(Vector::z() * std::f64::consts::FRAC_PI_2);
    let pose = Pose { position: Point::new(0.0, 0.0, -0.1), orientation: quarter };
    let below = Cuboid::new([4.0, 4.0, 0.2]).unwrap();
    let b = bodies.add(below, material(), pose, Twist::default(), Freedom::NONE).unwrap();
    bodies.set_surface_motion(b, |x, _| BELT * Vector::x() * x.z.signum()).unwrap();
    assert!((bodies.surface_motion(b, -0.1 * Vector::z()).unwrap() + BELT * Vector::y()).norm() < 1e-12);
    bodies.advance(0.3).unwrap();
    assert!((bodies.twist(BodyId(0)).linear - BELT * Vector::y()).norm() < 0.01 * BELT);
}

/// A ball dropped at `arm` from the axis of a disc that turns about it: while it slides, the force is μ m g along the velocity
/// of the disc there; a box on the axis picks up the disc's spin at the rate of its friction torque, and then turns with it.
#[test]
fn turntables_take_bodies_along() {
    for turns in [Turns::Body, Turns::Surface, Turns::Wall] {
        turntable_of(turns);
    }
}

/// The turning part of a turntable.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Turns {
    Body,
    Surface,
    Wall,
}

fn turntable_of(turns: Turns) {
    const SPIN: f64 = 4.0;
    let turntable = || {
        let mut bodies = RigidBodies::with_law(Periods::default(), Potential::default());
        bodies.set_gravity(-G * Vector::z());
        let spin = SPIN * Vector::z();
        if turns == Turns::Wall {
            bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), material()).unwrap();
            bodies.set_wall_motion(0, move |x, _| spin.cross(&x.coords)).unwrap();
            return bodies;
        }
        let table = dem::Cylinder::new(1.0, 0.2).unwrap();
        let angular = if turns == Turns::Body { spin } else { Vector::zeros() };
        let twist = Twist { angular, ..Twist::default() };
        let b = bodies.add(table, material(), Pose::at([0.0, 0.0, -0.1]), twist, Freedom::NONE).unwrap();
        if turns == Turns::Surface {
            bodies.set_surface_motion(b, move |x, _| spin.cross(&x.coords)).unwrap();
        }
        bodies
    };
    println!("{turns:?}");
    let mut bodies = turntable();
    let ball = Sphere::new(0.02).unwrap();
    let at = Pose::at([0.5, 0.0, 0.02]);
    let b = bodies.add(ball, material(), at, Twist::default(), Freedom::FREE).unwrap();
    let t = 0.04;
    bodies.advance(t).unwrap();
    let v = bodies.twist(b);
    println!("ball: {:?}", v);
    // The disc is ω r along y there; the ball's centre and spin follow at μ g and 5/2 μ g/R.
    assert!((v.linear.y / (0.3 * G * t) - 1.0).abs() < 0.03 && v.linear.x.abs() < 0.03 * v.linear.y);
    assert!((v.angular.x / (2.5 * 0.3 * G * t / 0.02) - 1.0).abs() < 0.03);

    let mut bodies = turntable();
    let cube = Cuboid::new([0.2; 3]).unwrap();
    let at = Pose::at([0.0, 0.0, 0.1 - 1e-6]);
    let b = bodies.add(cube, material(), at, Twist::default(), Freedom::FREE).unwrap();
    // μ m g times the mean distance 0.3826 a from the axis, over m a²/6.
    let rate = 6.0 * 0.3826 * 0.3 * G / 0.2;
    bodies.advance(0.1).unwrap();
    println!("cube: {:?} for {:.4}", bodies.twist(b), rate * 0.1);
    assert!((bodies.twist(b).angular.z / (rate * 0.1) - 1.0).abs() < 0.03);
    bodies.advance(0.4).unwrap();
    println!("cube: {:?}", bodies.twist(b));
    assert!((bodies.twist(b).angular.z / SPIN - 1.0).abs() < 0.01 && bodies.twist(b).linear.norm() < 1e-3);

    // Off the axis, where static friction bears the centripetal force, it goes round with the disc.
    let mut bodies = turntable();
    let small = Cuboid::new([0.04; 3]).unwrap();
    let at = Pose::at([0.1, 0.0, 0.02 - 1e-7]);
    let round = Twist { linear: SPIN * 0.1 * Vector::y(), angular: SPIN * Vector::z() };
    let b = bodies.add(small, material(), at, round, Freedom::FREE).unwrap();
    bodies.advance(0.5).unwrap();
    let x = bodies.pose(b).position;
    let angle = SPIN * 0.5;
    println!("on the disc: {x:?}, {:?}", bodies.twist(b));
    assert!((x - Point::new(0.1 * angle.cos(), 0.1 * angle.sin(), x.z)).norm() < 1e-3);
    assert!((bodies.twist(b).angular.z / SPIN - 1.0).abs() < 0.01);
}

/// A block in a drum that turns quickly slides up its wall and swings about the angle atan μ: a physical pendulum about the axis,
/// driven by the torque μ R N of both corners, N = m (g cos θ + r θ̇²).
#[test]
fn drums_drag_bodies_along() {
    const DRUM: f64 = 0.5;
    let edge = 0.06;
    // A ring with a slit at its top, which does not reach the block.
    let point = |r: f64, k: usize| {
        let turn = std::f64::consts::FRAC_PI_2 + 1e-4 + (std::f64::consts::TAU - 2e-4) * k as f64 / 720.0;
        [r * turn.cos(), r * turn.sin()]
    };
    let outer = (0..=720).map(|k| point(1.2 * DRUM, k));
    let corners: Vec<[f64; 2]> = outer.chain((0..=720).rev().map(|k| point(DRUM, k))).collect();
    let drum = Polygon::new(&corners).unwrap();
    let mut bodies = RigidBodies::with_law(Periods::default(), Potential::default());
    bodies.set_gravity(-G * Vector::y());
    let turning = Twist { angular: 8.0 * Vector::z(), ..Twist::default() };
    bodies.add(drum, material(), Pose::at([0.0; 3]), turning, Freedom::NONE).unwrap();
    let half = 0.5 * edge;
    let block = Polygon::new(&[[-half, -half], [half, -half], [half, half], [-half, half]]).unwrap();
    let arm = (DRUM * DRUM - half * half).sqrt() - half;
    let at = Pose::at([0.0, -arm + 1e-5, 0.0]);
    let b = bodies.add(block, material(), at, Twist::default(), Freedom::PLANAR).unwrap();
    let (mut angle, mut rate, dt) = (0.0_f64, 0.0, 1e-5);
    for step in 1..=4 {
        bodies.advance(0.05).unwrap();
        for _ in 0..5000 {
            let normal = G * angle.cos() + arm * rate * rate;
            let torque = 0.3 * DRUM * normal - G * arm * angle.sin();
            rate += dt * torque / (arm * arm + edge * edge / 6.0);
            angle += dt * rate;
        }
        let x = bodies.pose(b).position;
        let found = x.x.atan2(-x.y);
        println!("{:.2} s: {found:.4} rad for {angle:.4}", 0.05 * f64::from(step));
        assert!((found - angle).abs() < 0.02 * angle);
    }
}

/// A run on an oscillating belt that is stopped and resumed ends as one that is not, to the last bit.
#[test]
fn belts_are_resumed() {
    let scene = || {
        let shape: Arc<dyn Shape> = Arc::new(Cuboid::new([0.06, 0.06, 0.04]).unwrap());
        let mut bodies = on_belt(Potential::default(), Belt::Wall, shape, 0.02, Vector::x());
        bodies.set_wall_motion(0, |_, t| Vector::x() * BELT * (20.0 * t).cos()).unwrap();
        bodies
    };
    let saved = |bodies: &RigidBodies<_>| {
        let mut all = std::collections::BTreeMap::new();
        bodies.save(&mut |name, values| drop(all.insert(name.to_string(), values.to_vec())));
        all
    };
    let mut whole = scene();
    (0..10).for_each(|_| whole.advance(5e-3).unwrap());
    let state = saved(&whole);
    let mut second = scene();
    second.restore(&|name| state.get(name).map(Vec::as_slice)).unwrap();
    for bodies in [&mut whole, &mut second] {
        (0..20).for_each(|_| bodies.advance(5e-3).unwrap());
    }
    assert_eq!(saved(&whole), saved(&second));
}
