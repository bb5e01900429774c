//! Bodies pushed apart before they touch.
use crate::R;
use dem::{
    Chen, ContactLaw, Cuboid, DemError, Disc, Ellipsoid, HalfSpace, Lubricated, Material, Polygon, Repulsive,
    RigidBodies, Shape, Sphere, WholeFilm,
};
use interfaces::{Bodies, BodyId, Dynamics, Freedom, Kinematics, Periods, Point, Pose, Twist, Vector};
use std::sync::Arc;

const RANGE: f64 = 0.1 * R;
const SPEED: f64 = 0.05;

fn stone() -> Material {
    Material { density: 2000.0, ..Material::default() }
}

/// Two bodies that come towards one another at 2 [`SPEED`], or one that comes towards a wall.
fn approach<L: ContactLaw>(law: L, shape: &Arc<dyn Shape>, freedom: Freedom, wall: bool) -> RigidBodies<L> {
    let mut bodies = RigidBodies::with_law(Periods::default(), law);
    let extent = shape.aabb().extent().x;
    for side in if wall { &[1.0][..] } else { &[1.0, -1.0] } {
        let motion = Twist { linear: Vector::new(-side * SPEED, 0.0, 0.0), ..Twist::default() };
        let start = Pose::at([side * (0.5 * extent + RANGE), 0.0, 0.0]);
        bodies.add(shape.clone(), stone(), start, motion, freedom).unwrap();
    }
    if wall {
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::x()).unwrap(), stone()).unwrap();
    }
    bodies
}

/// ½ m* v² = ⅓ F₀ ζ (1 − δ/ζ)³ where they turn back, and they leave as fast as they came; balls, what is as round but no ball, discs, faces.
#[test]
fn bodies_turn_back_where_energy_tells() {
    let solid = Freedom::FREE;
    let shapes: [(Arc<dyn Shape>, Freedom); 5] = [
        (Arc::new(Sphere::new(R).unwrap()), solid),
        (Arc::new(Ellipsoid::new([R; 3]).unwrap()), solid),
        (Arc::new(Cuboid::new([R; 3]).unwrap()), solid),
        (Arc::new(Disc::new(R).unwrap()), Freedom::PLANAR),
        (Arc::new(Polygon::rectangle([R, 0.7 * R]).unwrap()), Freedom::PLANAR),
    ];
    for (shape, freedom) in &shapes {
        for wall in [true, false] {
            let mass = approach((), shape, *freedom, wall).inertia(BodyId(0)).mass;
            let energy = 0.5 * mass * SPEED * SPEED * if wall { 1.0 } else { 2.0 };
            // Two that meet in the middle have the range twice between them.
            let range = if wall { RANGE } else { 2.0 * RANGE };
            let law = Repulsive::new(Chen::default(), 6.0 * energy / range, range).unwrap();
            let mut bodies = approach(law, shape, *freedom, wall);
            let (mut nearest, half) = (f64::INFINITY, 0.5 * shape.aabb().extent().x);
            for _ in 0..400 {
                bodies.advance(0.01 * RANGE / SPEED).unwrap();
                nearest = nearest.min(bodies.pose(BodyId(0)).position.x - half);
                assert_eq!(bodies.n_contacts(), 0);
            }
            let expected = (1.0 - 0.5_f64.cbrt()) * RANGE;
            let off = nearest / expected - 1.0;
            assert!(off.abs() < 2e-3, "{} wall {wall}: {nearest:e} {expected:e} {off:e}", shape.name());
            let back = bodies.twist(BodyId(0)).linear.x / SPEED;
            assert!((back - 1.0).abs() < 2e-3, "{} wall {wall}: {back}", shape.name());
            if !wall {
                let momentum = bodies.twist(BodyId(0)).linear + bodies.twist(BodyId(1)).linear;
                assert!(momentum.norm() < 1e-12 * SPEED, "{momentum:?}");
            }
        }
    }
}

/// What lies on a wall and is heavier than the repulsion bears sinks in by what is left.
#[test]
fn contact_bears_what_is_left() {
    let depth = |law: Option<f64>| {
        let sphere: Arc<dyn Shape> = Arc::new(Sphere::new(R).unwrap());
        let weight = approach((), &sphere, Freedom::FREE, true).inertia(BodyId(0)).mass * 9.81;
        let strength = law.unwrap_or(1e-9) * weight;
        let law = Repulsive::new(Chen::default(), strength, RANGE).unwrap();
        let mut bodies = approach(law, &sphere, Freedom::FREE, true);
        let left = if strength > 1e-3 * weight { 1.0 } else { 0.75 };
        bodies.set_gravity(Vector::new(-9.81 * left, 0.0, 0.0));
        for _ in 0..20000 {
            bodies.advance(1e-3).unwrap();
        }
        let speed = bodies.twist(BodyId(0)).linear.norm();
        assert!(speed < 1e-6, "{speed:e}");
        R - bodies.pose(BodyId(0)).position.x
    };
    // A quarter of the weight on the repulsion, or three quarters of it on the contact alone.
    let (shared, alone) = (depth(Some(0.25)), depth(None));
    assert!(alone > 0.0 && (shared / alone - 1.0).abs() < 1e-6, "{shared:e} {alone:e}");
}

/// Films act as well where the law has them.
#[test]
fn films_stay() {
    let sphere: Arc<dyn Shape> = Arc::new(Sphere::new(R).unwrap());
    let film = Lubricated::new(Chen::default(), 0.1, WholeFilm { reach: RANGE }).unwrap();
    let speed = |law: Repulsive<Lubricated<Chen>>| {
        let mut bodies = approach(law, &sphere, Freedom::FREE, true);
        bodies.advance(0.5 * RANGE / SPEED).unwrap();
        -bodies.twist(BodyId(0)).linear.x / SPEED
    };
    let weak = speed(Repulsive::new(film.clone(), 1e-12, RANGE).unwrap());
    assert!(weak < 0.99, "{weak}");
    let film_in_plane = RigidBodies::with_law(Periods::default(), Repulsive::new(film, 1.0, RANGE).unwrap())
        .add(Disc::new(R).unwrap(), stone(), Pose::at([0.0; 3]), Twist::default(), Freedom::PLANAR);
    assert!(matches!(film_in_plane, Err(DemError::Unsupported { a: "disc", .. })), "{film_in_plane:?}");
}

#[test]
fn senseless_repulsion_is_refused() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(
            matches!(Repulsive::new(Chen::default(), bad, RANGE), Err(DemError::Repulsion { .. })),
            "{bad}"
        );
        assert!(
            matches!(Repulsive::new(Chen::default(), 1.0, bad), Err(DemError::Repulsion { .. })),
            "{bad}"
        );
    }
}
