//! Two bodies that hit each other.
use super::*;
use approx::{assert_relative_eq, assert_ulps_eq};
use dem::HalfSpace;
use interfaces::{Bodies, Dynamics, Point};
use std::f64::consts::PI;

/// The reference page's two-body motion m*δ̈ = −kδ² − cδδ̇ of spheres with default stiffness (ν 0.3).
struct Motion {
    mass: f64,
    k: f64,
    /// c per unit of the materials' γ.
    c: f64,
}

impl Motion {
    /// `radius` is R*, `length` L_c, `mass` m*.
    fn new(mass: f64, radius: f64, length: f64) -> Self {
        let stiffness = Material::default().youngs_modulus / (2.0 * (1.0 - 0.09));
        let c = 2.0 * PI * radius * 0.5 * (stiffness * mass / length.powi(3)).sqrt();
        Self { mass, k: PI * stiffness * radius / length, c }
    }
    fn spheres() -> Self {
        Self::new(0.5 * mass(), 0.5 * R, 2.0 * R)
    }
    /// Impact speed that drives elastic bodies into each other by `depth`: δ_max = (3m*v₀²/2k)^⅓.
    fn speed(&self, depth: f64) -> f64 {
        (2.0 * self.k * depth.powi(3) / (3.0 * self.mass)).sqrt()
    }
    /// Of the elastic contact: 3.210196 a/v₀.
    fn duration(&self, speed: f64) -> f64 {
        3.210196 * (self.mass * speed * speed / self.k).cbrt() / speed
    }
    /// The γ that makes β = c v₀^⅓ m*^(−⅓) k^(−⅔) what is asked.
    fn damping(&self, beta: f64, speed: f64) -> Material {
        let unit = self.c * speed.cbrt() * self.mass.powf(-1.0 / 3.0) * self.k.powf(-2.0 / 3.0);
        Material { damping: beta / unit, ..elastic() }
    }
}
fn mass() -> f64 {
    sphere().mass(&Material::default())
}

/// Steps of `dt` until the first two bodies have touched and are apart again; answers the greatest depth.
fn collide(bodies: &mut RigidBodies, dt: f64) -> f64 {
    let (mut touched, mut deepest) = (false, 0.0_f64);
    for _ in 0..1_000_000 {
        bodies.advance(dt).unwrap();
        let depth = 2.0 * R - distance(bodies);
        deepest = deepest.max(depth);
        if touched && depth < 0.0 {
            return deepest;
        }
        touched |= depth > 0.0;
    }
    panic!("they did not part");
}

/// Largest |ΔE|/E of collisions at `n` to `n` + 1 steps per `unit` of time, over 40 phases of the first touch
/// within a step; whole numbers of steps alone would profit from symmetry in time.
fn energy_error(shape: Ball, speed: f64, unit: f64, n: f64) -> f64 {
    let mut worst = 0.0_f64;
    for share in 0..16 {
        let dt = unit / (n + f64::from(share) / 16.0);
        for phase in 0..40 {
            let gap = 1e-3 * R + speed * dt * f64::from(phase) / 40.0;
            let mut bodies = head_on(shape, elastic(), gap, speed);
            let before = bodies.kinetic_energy();
            collide(&mut bodies, dt);
            worst = worst.max((bodies.kinetic_energy() / before - 1.0).abs());
        }
    }
    worst
}

/// The force starts as δ², so the leapfrog's energy error, which only entry and exit leave behind, falls with
/// dt³; for discs, where it starts as δ^1.5, with dt^2.5.
#[test]
fn elastic_collisions_keep_energy() {
    let spheres = Motion::spheres();
    let speed = spheres.speed(0.05 * R);
    let t_c = spheres.duration(speed);
    let automatic = head_on(sphere(), elastic(), R, speed).stable_dt();
    println!("automatic step: t_c/{:.1}", t_c / automatic);
    assert!(t_c / automatic > 50.0);

    let sphere_errors = [50.0, 100.0, 200.0, 400.0].map(|n| energy_error(sphere(), speed, t_c, n));
    println!("spheres, |dE|/E at t_c/50, 100, 200, 400: {sphere_errors:?}");
    assert!(sphere_errors[0] < 2e-5);
    assert!(sphere_errors[1] / sphere_errors[3] > 2.0_f64.powf(2.0 * 2.8), "third order");

    let automatic = head_on(disc(), elastic(), R, speed).stable_dt();
    let disc_errors = [50.0, 100.0, 200.0].map(|n| energy_error(disc(), speed, 50.0 * automatic, n));
    println!("discs, |dE|/E at the automatic step, its half and quarter: {disc_errors:?}");
    assert!(disc_errors[0] < 1.5e-4);
    assert!(disc_errors[0] / disc_errors[2] > 2.0_f64.powf(2.0 * 2.3), "order 2.5");
}

#[test]
fn depth_and_duration_of_gentle_collisions() {
    let spheres = Motion::spheres();
    // Relative deviation of the volume from πR*δ², and of L_c from 2R, are of the order of the depth.
    let depth = 1e-4 * R;
    let speed = spheres.speed(depth);
    let mut bodies = head_on(sphere(), elastic(), 1e-5 * R, speed);
    let dt = bodies.stable_dt();
    let (mut time, mut deepest) = (0.0, 0.0_f64);
    while bodies.twist(BodyId(1)).linear.x < 0.0 || distance(&bodies) < 2.0 * R {
        bodies.advance(dt).unwrap();
        deepest = deepest.max(2.0 * R - distance(&bodies));
        time += dt;
    }
    // Free flight before and after, taken off exactly.
    let rebound = 2.0 * bodies.twist(BodyId(1)).linear.x;
    let contact = time - 1e-5 * R / speed - (distance(&bodies) - 2.0 * R) / rebound;
    assert_relative_eq!(deepest, depth, max_relative = 1e-4);
    assert_relative_eq!(contact, spheres.duration(speed), max_relative = 1e-4);
    assert_relative_eq!(bodies.contact_time(), contact, epsilon = 1.01 * dt);
}

/// e(β) of the reference page, where the model's powers of δ hold: shallow.
#[test]
fn restitution_of_the_dashpot() {
    for (beta, e, depth) in
        [(0.1, 0.90916, 1.1095), (0.5, 0.64319, 0.9958), (1.0, 0.44884, 0.8934), (2.0, 0.25949, 0.7580)]
    {
        let spheres = Motion::spheres();
        let speed = spheres.speed(1e-3 * R);
        let mut bodies = head_on(sphere(), spheres.damping(beta, speed), 1e-4 * R, speed);
        let dt = bodies.stable_dt();
        let deepest = collide(&mut bodies, dt);
        let delivered = 2.0 * bodies.twist(BodyId(1)).linear.x / speed;
        println!("beta {beta}: e {delivered:.5}, exact {e}");
        assert_relative_eq!(delivered, e, max_relative = 1e-3);
        let a = (spheres.mass * speed * speed / spheres.k).cbrt();
        assert_relative_eq!(deepest / a, depth, max_relative = 1e-3);
    }
}

/// Against what cannot move, M is the other's mass, not half of it: the same e(β).
#[test]
fn restitution_at_immovable_partners() {
    let (beta, e) = (0.5, 0.64319);
    // A fixed sphere, with the lower or the higher number.
    let motion = Motion::new(mass(), 0.5 * R, 2.0 * R);
    let speed = motion.speed(1e-3 * R);
    let material = motion.damping(beta, speed);
    for fixed in [BodyId(0), BodyId(1)] {
        let mut bodies = RigidBodies::new(Periods::default());
        for b in [BodyId(0), BodyId(1)] {
            let (x, u, freedom) =
                if b == fixed { (0.0, 0.0, Freedom::NONE) } else { (-2.001 * R, speed, Freedom::FREE) };
            let twist = moving([u, 0.0, 0.0], [0.0; 3]);
            bodies.add(sphere().shape(), material, Pose::at([x, 0.0, 0.0]), twist, freedom).unwrap();
        }
        let dt = bodies.stable_dt();
        collide(&mut bodies, dt);
        assert_relative_eq!(bodies.twist(BodyId(1 - fixed.0)).linear.x, -e * speed, max_relative = 1e-3);
        assert_eq!(bodies.pose(fixed), Pose::at([0.0; 3]));
        assert_eq!(bodies.twist(fixed), Twist::default());
    }

    // A wall.
    let motion = Motion::new(mass(), R, 4.0 * R);
    let speed = motion.speed(1e-3 * R);
    let material = motion.damping(beta, speed);
    let mut bodies =
        scene(sphere(), material, &[([1.0001 * R, 0.0, 0.0], moving([-speed, 0.0, 0.0], [0.0; 3]))]);
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::x()).unwrap(), material).unwrap();
    let dt = bodies.stable_dt();
    while bodies.pose(BodyId(0)).position.x < 1.00011 * R {
        bodies.advance(dt).unwrap();
    }
    assert_relative_eq!(bodies.twist(BodyId(0)).linear.x, e * speed, max_relative = 1e-3);
}

/// A disc's rebound depends on its shape, not on its size: no depth of 1 m hides in the dashpot.
#[test]
fn discs_of_all_sizes_rebound_alike() {
    let rebound = |r: f64| {
        let disc = Disc::new(r).unwrap();
        let mut bodies = RigidBodies::new(Periods::default());
        for (x, u) in [(-1.001 * r, 0.5), (1.001 * r, -0.5)] {
            let (pose, twist) = (Pose::at([x, 0.0, 0.0]), moving([u, 0.0, 0.0], [0.0; 3]));
            bodies.add(disc, Material::default(), pose, twist, Freedom::PLANAR).unwrap();
        }
        let dt = bodies.stable_dt();
        for _ in 0..1000 {
            bodies.advance(dt).unwrap();
        }
        2.0 * bodies.twist(BodyId(1)).linear.x
    };
    let e = rebound(1e-3);
    assert!(0.8 < e && e < 0.99, "{e}");
    assert_relative_eq!(rebound(1e-6), e, max_relative = 1e-6);
    assert_relative_eq!(rebound(1.0), e, max_relative = 1e-6);
}

/// In a direction that is no axis, with damping and friction.
#[test]
fn head_on_leaves_nothing_tangential() {
    for shape in [disc(), sphere()] {
        let z = if shape.is_plane() { 0.0 } else { 0.7 };
        let along = Vector::new(1.0, 0.3, z).normalize();
        let (x, u) = (1.01 * R * along, 0.5 * along);
        let bodies = [(-x, moving(u.into(), [0.0; 3])), (x, moving((-u).into(), [0.0; 3]))];
        let bodies = bodies.map(|(x, twist)| (<[f64; 3]>::from(x), twist));
        let mut bodies = scene(shape, Material::default(), &bodies);
        let dt = bodies.stable_dt();
        collide(&mut bodies, dt);
        for b in bodies.ids() {
            let Twist { linear, angular } = bodies.twist(b);
            assert!(linear.dot(&along).abs() > 0.2);
            assert!((linear - along * along.dot(&linear)).norm() < 1e-10, "{linear}");
            assert!(angular.norm() < 1e-10, "{angular}");
        }
    }
}

#[test]
fn oblique_collisions_keep_both_momenta() {
    for shape in [disc(), sphere()] {
        let (z, tilt) = if shape.is_plane() { (0.0, 0.0) } else { (0.4 * R, 30.0) };
        let one = ([-1.1 * R, 0.6 * R, z], moving([0.8, 0.1, 0.3 * tilt / 30.0], [tilt, -tilt, 40.0]));
        let two = ([1.1 * R, -0.5 * R, 0.0], moving([-0.6, 0.2, 0.0], [0.0, tilt, 90.0]));
        let mut bodies = scene(shape, Material::default(), &[one, two]);
        let spin = bodies.twist(BodyId(0)).angular;
        let (p, l) = momenta(&bodies);
        let dt = bodies.stable_dt();
        collide(&mut bodies, dt);
        assert!((bodies.twist(BodyId(0)).angular - spin).norm() > 5.0, "they rubbed");
        let (p1, l1) = momenta(&bodies);
        let mass = bodies.inertia(BodyId(0)).mass;
        assert!((p1 - p).norm() < 1e-13 * mass, "{} of {}", (p1 - p).norm(), mass);
        assert!((l1 - l).norm() < 1e-13 * mass * R, "{} of {}", (l1 - l).norm(), mass * R);
        // What each got is what the other lost, about its own centre of mass.
        let impulse = |b| bodies.contact_impulse(BodyId(b)).force;
        assert_ulps_eq!(impulse(0), -impulse(1));
    }
}

/// Gross sliding: e_t = 1 − μ(1 + e_n)/tan θ, θ from the surface normal.
#[test]
fn oblique_impact_in_gross_sliding() {
    let material = Material { friction: 0.1, damping: 0.0, ..Material::default() };
    for degrees in [60.0_f64, 75.0] {
        let (speed, (sin, cos)) = (0.05, degrees.to_radians().sin_cos());
        let start = moving([speed * sin, -speed * cos, 0.0], [0.0; 3]);
        let mut bodies = scene(sphere(), material, &[([0.0, 1.001 * R, 0.0], start)]);
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::y()).unwrap(), material).unwrap();
        let dt = bodies.stable_dt();
        while bodies.pose(BodyId(0)).position.y < 1.0011 * R {
            bodies.advance(dt).unwrap();
        }
        let tangential = bodies.twist(BodyId(0)).linear.x / (speed * sin);
        assert_relative_eq!(tangential, 1.0 - 0.1 * 2.0 / (sin / cos), max_relative = 1e-3);
    }
}

#[test]
fn through_a_periodic_corner_as_in_the_middle() {
    for shape in [disc(), sphere()] {
        let length = 5.0 * R;
        let along_z = !shape.is_plane();
        let run = |shift: f64, images: [f64; 3]| {
            let mut bodies =
                RigidBodies::new(Periods::new([Some(length), Some(length), along_z.then_some(length)]));
            let z = |z: f64| if along_z { z } else { 0.0 };
            let one = [shift - 0.9 * R, shift - 0.8 * R, z(shift - 0.5 * R)];
            let two: [f64; 3] =
                std::array::from_fn(|a| [0.8 * R, 0.7 * R, z(0.5 * R)][a] + z_shift(a, along_z, shift));
            let two = std::array::from_fn(|a| two[a] + images[a] * length);
            let motions = [moving([0.3, 0.4, z(0.2)], [0.0, 0.0, 20.0]), moving([-0.2, -0.1, 0.0], [0.0; 3])];
            for (place, motion) in [one, two].into_iter().zip(motions) {
                bodies
                    .add(shape.shape(), Material::default(), Pose::at(place), motion, freedom(shape))
                    .unwrap();
            }
            assert!(bodies.check_overlaps().is_ok());
            for _ in 0..60 {
                bodies.advance(5e-4).unwrap();
            }
            bodies.ids().map(|b| bodies.twist(b)).collect::<Vec<_>>()
        };
        let z_image = if along_z { 1.0 } else { 0.0 };
        let middle = run(0.5 * length, [0.0; 3]);
        assert!(middle[1].angular.norm() > 1.0, "they rubbed");
        let corner = run(0.0, [0.0; 3]);
        let wrapped = run(0.0, [-1.0, -1.0, -z_image]);
        let far = run(0.0, [3.0, -2.0, z_image]);
        for other in [corner, wrapped, far] {
            for (m, o) in middle.iter().zip(&other) {
                assert_relative_eq!(m.linear, o.linear, epsilon = 1e-9);
                assert_relative_eq!(m.angular, o.angular, epsilon = 1e-9 / R);
            }
        }
    }
}
fn z_shift(axis: usize, along_z: bool, shift: f64) -> f64 {
    if axis < 2 || along_z { shift } else { 0.0 }
}
