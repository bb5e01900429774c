//! Surfaces that slide: friction takes bodies along with them.
use super::*;
use dem::{Chen, ContactLaw, Cuboid, DemError, HalfSpace, Polygon, Potential, Sleep};
use interfaces::{Dynamics, Point, Rotation};

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
            _ => bodies.set_wall_motion(0, move |_| velocity).unwrap(),
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
        bodies.set_surface_motion(b, move |_| velocity + 0.3 * up).unwrap();
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
            _ => bodies.set_surface_motion(BodyId(1), |_| BELT * Vector::x()).unwrap(),
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
    assert!(matches!(bodies.set_wall_motion(3, |_| Vector::x()), Err(DemError::NoSuchWall { wall: 3, .. })));
    for bad in [Vector::z(), Vector::new(1.0, 0.0, -1e-3), Vector::new(f64::NAN, 0.0, 0.0)] {
        let error = bodies.set_wall_velocity(0, bad).unwrap_err();
        assert!(
            matches!(error, DemError::WallVelocity { wall: 0, .. })
                && error.to_string().contains("along the plane")
        );
    }
    assert!(matches!(
        bodies.set_surface_motion(BodyId(0), |_| Vector::x()),
        Err(DemError::NoSuchBody { .. })
    ));
}
