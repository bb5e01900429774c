//! Films of fluid between bodies that are close.
use crate::R;
use dem::{
    Chen, ContactLaw, Cuboid, DemError, Disc, Ellipsoid, HalfSpace, Lubricated, Material, Potential,
    RigidBodies, Shape, Sphere, WholeFilm,
};
use interfaces::{
    Bodies, BodyId, Checkpoint, Dynamics, Freedom, Kinematics, Periods, Point, Pose, Rotation, Twist, Vector,
};
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::sync::Arc;

const VISCOSITY: f64 = 0.1;
const REACH: f64 = 0.2 * R;
const A: BodyId = BodyId(0);
const B: BodyId = BodyId(1);

type Films = RigidBodies<Lubricated<Chen>>;

fn films() -> Films {
    let law = Lubricated::new(Chen::default(), VISCOSITY, WholeFilm { reach: REACH }).unwrap();
    RigidBodies::with_law(Periods::default(), law)
}

fn stone() -> Material {
    Material { density: 2000.0, ..Material::default() }
}

fn linear(v: [f64; 3]) -> Twist {
    Twist { linear: v.into(), ..Twist::default() }
}

fn add<L: ContactLaw>(bodies: &mut RigidBodies<L>, shape: impl Shape + 'static, pose: Pose, twist: Twist) {
    bodies.add(shape, stone(), pose, twist, Freedom::FREE).unwrap();
}

/// A ball that comes towards a wall loses (6πμR²/m) [ln(δ₀/δ) − (δ₀ − δ)/δ_c] of its speed.
#[test]
fn a_ball_is_slowed_down_before_a_wall() {
    let m = 2000.0 * 4.0 / 3.0 * PI * R.powi(3);
    for shape in
        [Arc::new(Sphere::new(R).unwrap()) as Arc<dyn Shape>, Arc::new(Ellipsoid::new([R; 3]).unwrap())]
    {
        let mut bodies = films();
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), stone()).unwrap();
        add(&mut bodies, shape.clone(), Pose::at([0.0, 0.0, 1.3 * R]), linear([0.0, 0.0, -0.06]));
        while bodies.twist(A).linear.z < -0.02 {
            bodies.advance(1e-4).unwrap();
            let (v, gap) = (-bodies.twist(A).linear.z, bodies.pose(A).position.z - R);
            if gap < 0.5 * REACH {
                assert_eq!(bodies.n_films(), 1);
                let taken = 6.0 * PI * VISCOSITY * R * R / m * ((REACH / gap).ln() - (REACH - gap) / REACH);
                let off = (0.06 - v) / taken - 1.0;
                assert!(off.abs() < 0.03, "{}: {gap:e} {v} {off}", shape.name());
            }
        }
        assert!(bodies.pose(A).position.z - R < 0.1 * REACH, "{}", bodies.pose(A).position.z);
    }
}

/// Thin films stop what would bounce: below a Stokes number mv/(6πμR²) of about ln(δ_c/δ_min) nothing touches hard.
#[test]
fn a_film_takes_the_bounce() {
    let m = 2000.0 * 4.0 / 3.0 * PI * R.powi(3);
    let rebound = |stokes: f64| {
        let mut bodies = films();
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), stone()).unwrap();
        let v = stokes * 6.0 * PI * VISCOSITY * R * R / m;
        add(&mut bodies, Sphere::new(R).unwrap(), Pose::at([0.0, 0.0, 1.1 * R]), linear([0.0, 0.0, -v]));
        for _ in 0..400 {
            bodies.advance(0.02 * R / v).unwrap();
        }
        bodies.twist(A).linear.z / v
    };
    assert!(rebound(2.0).abs() < 1e-2, "{}", rebound(2.0));
    assert!(rebound(100.0) > 0.3, "{}", rebound(100.0));
}

/// Momentum and angular momentum stay, energy only falls, for balls and for what is not round; a ball that is told to be any smooth shape is
/// held as a ball.
#[test]
fn films_keep_momentum_and_take_energy() {
    let tilt = Rotation::from_scaled_axis(Vector::new(0.3, -0.5, 0.2));
    let ball = || Arc::new(Sphere::new(R).unwrap()) as Arc<dyn Shape>;
    let egg =
        |a: f64, b: f64, c: f64| Arc::new(Ellipsoid::new([a * R, b * R, c * R]).unwrap()) as Arc<dyn Shape>;
    let cube = || Arc::new(Cuboid::new([1.2 * R; 3]).unwrap()) as Arc<dyn Shape>;
    let mut ends = Vec::new();
    for (x, [first, second]) in
        [(2.1, [ball(), ball()]), (2.1, [egg(1.0, 1.0, 1.0), ball()]), (1.8, [egg(1.0, 0.8, 0.6), cube()])]
    {
        let mut bodies = films();
        let own = Twist { linear: Vector::new(5e-3, 2e-3, 0.0), angular: Vector::new(0.1, -0.3, 0.5) };
        add(&mut bodies, first, Pose { orientation: tilt, ..Pose::at([0.0; 3]) }, own);
        let other = Twist { linear: Vector::new(-5e-3, 3e-3, 1e-3), angular: Vector::new(-0.2, 0.1, 0.4) };
        add(&mut bodies, second, Pose { orientation: tilt, ..Pose::at([x * R, 0.3 * R, 0.0]) }, other);
        let books = |bodies: &Films| {
            let mut sums = [Vector::zeros(); 2];
            for b in [A, B] {
                let (pose, twist, inertia) = (bodies.pose(b), bodies.twist(b), bodies.inertia(b));
                let q = pose.orientation;
                sums[0] += inertia.mass * twist.linear;
                sums[1] += inertia.mass * pose.position.coords.cross(&twist.linear)
                    + q * (inertia.tensor * (q.inverse() * twist.angular));
            }
            sums
        };
        let start = books(&bodies);
        let (mut energy, mut most) = (bodies.kinetic_energy(), 0);
        for _ in 0..200 {
            bodies.advance(1e-3).unwrap();
            most = most.max(bodies.n_films());
            if bodies.n_contacts() > 0 {
                // The edge of the cube cuts through; balls never touch.
                assert_eq!(ends.len(), 2);
                break;
            }
            assert!(bodies.kinetic_energy() <= energy * (1.0 + 1e-12));
            energy = bodies.kinetic_energy();
        }
        let end = books(&bodies);
        assert_eq!(most, 1);
        let scale = [5e-3 * bodies.inertia(A).mass, 5e-3 * R * bodies.inertia(A).mass];
        for i in 0..2 {
            assert!(
                (end[i] - start[i]).norm() < [1e-12, 1e-4][i] * scale[i],
                "{i}: {:?} {:?}",
                start[i],
                end[i]
            );
        }
        ends.push([bodies.twist(A).linear, bodies.twist(A).angular * R]);
    }
    for i in 0..2 {
        assert!((ends[0][i] - ends[1][i]).norm() < 1e-4, "{:?}", ends);
    }
}

/// A run that is stopped and resumed ends as one that is not, to the last bit.
#[test]
fn films_are_resumed() {
    let scene = || {
        let law = Lubricated::new(Potential::default(), VISCOSITY, WholeFilm { reach: REACH }).unwrap();
        let mut bodies = RigidBodies::with_law(Periods::default(), law);
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), stone()).unwrap();
        bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
        add(&mut bodies, Sphere::new(R).unwrap(), Pose::at([0.0, 0.0, 1.1 * R]), Twist::default());
        add(&mut bodies, Sphere::new(R).unwrap(), Pose::at([0.3 * R, 0.0, 3.2 * R]), Twist::default());
        add(
            &mut bodies,
            Cuboid::new([1.6 * R; 3]).unwrap(),
            Pose::at([0.2 * R, 0.1 * R, 5.1 * R]),
            Twist::default(),
        );
        bodies
    };
    let run = |bodies: &mut RigidBodies<_>, steps: usize| {
        for _ in 0..steps {
            bodies.advance(5e-4).unwrap();
        }
    };
    let saved = |bodies: &RigidBodies<_>| {
        let mut all = BTreeMap::new();
        bodies.save(&mut |name, values| {
            all.insert(name.to_string(), values.to_vec());
        });
        all
    };
    let mut whole = scene();
    run(&mut whole, 40);
    let state = saved(&whole);
    assert!(whole.n_films() > 0);
    run(&mut whole, 60);
    let mut second = scene();
    second.restore(&|name| state.get(name).map(Vec::as_slice)).unwrap();
    run(&mut second, 60);
    assert_eq!(saved(&whole), saved(&second));
}

#[test]
fn discs_have_no_films() {
    let material = stone();
    let added =
        films().add(Disc::new(R).unwrap(), material, Pose::at([0.0; 3]), Twist::default(), Freedom::PLANAR);
    assert!(matches!(added, Err(DemError::Unsupported { a: "disc", .. })), "{added:?}");
}

/// A roller whose surface turns does through a film what one that turns as a whole does: sliding and rolling terms alike.
#[test]
fn surfaces_that_turn_drive_films() {
    let spin = Vector::new(3.0, 20.0, 1.0);
    let run = |surface: bool| {
        let mut bodies = films();
        add(&mut bodies, Sphere::new(R).unwrap(), Pose::at([0.0, 0.0, 2.01 * R]), Twist::default());
        let angular = if surface { Vector::zeros() } else { spin };
        let (roller, twist) = (Sphere::new(R).unwrap(), Twist { angular, ..Twist::default() });
        let b = bodies.add(roller, stone(), Pose::at([0.0; 3]), twist, Freedom::NONE).unwrap();
        if surface {
            bodies.set_surface_motion(b, move |x, _| spin.cross(&x.coords)).unwrap();
        }
        bodies.advance(1e-3).unwrap();
        bodies.twist(A)
    };
    let [body, surface] = [false, true].map(run);
    println!("{body:?} {surface:?}");
    assert!(body.linear.norm() > 1e-5 && body.angular.norm() > 1e-3);
    // The middle of the film is 0.005 R away from the surface.
    let off = |a: Vector, b: Vector| (a - b).norm() / b.norm();
    assert!(off(surface.linear, body.linear) < 0.03 && off(surface.angular, body.angular) < 0.03);
}
