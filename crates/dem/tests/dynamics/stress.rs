//! Scenes at the edge of what a contact model bears: energy stays bounded, numbers finite, and nobody gets through anything unnoticed.
use super::*;
use dem::{Chen, ContactLaw, ConvexPolyhedron, Cuboid, DemError, HalfSpace, Partner, Potential};
use interfaces::{Dynamics, Point, Rotation};

const G: f64 = 9.81;

/// With corners at (1, 1, 1) … times `size`: the corners √3 `size`, the faces a third of that from its centre.
fn tetrahedron(size: f64) -> Arc<dyn Shape> {
    let points = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
    Arc::new(ConvexPolyhedron::from_points(&points.map(|p| p.map(|x| size * x))).unwrap())
}
fn cube(edge: f64) -> Arc<dyn Shape> {
    Arc::new(Cuboid::new([edge; 3]).unwrap())
}
fn ball(radius: f64) -> Arc<dyn Shape> {
    Arc::new(Sphere::new(radius).unwrap())
}
fn material(youngs_modulus: f64) -> Material {
    Material { youngs_modulus, friction: 0.5, restitution: 0.6, density: 2000.0, ..Material::default() }
}
fn wall(at: f64, normal: f64) -> HalfSpace {
    HalfSpace::new(Point::new(0.0, 0.0, at), normal * Vector::z()).unwrap()
}
/// Weight downwards over a floor.
fn over_floor<L: ContactLaw>(law: L, material: Material) -> RigidBodies<L> {
    let mut bodies = RigidBodies::with_law(Periods::default(), law);
    bodies.add_wall(wall(0.0, 1.0), material).unwrap();
    bodies.set_gravity(Vector::new(0.0, 0.0, -G));
    bodies
}
fn add<L: ContactLaw>(to: &mut RigidBodies<L>, shape: &Arc<dyn Shape>, m: Material, pose: Pose) -> BodyId {
    to.add(shape.clone(), m, pose, Twist::default(), Freedom::FREE).unwrap()
}
/// Kinetic energy and that of height \[J\].
fn energy<L: ContactLaw>(bodies: &RigidBodies<L>) -> f64 {
    let height = |b| bodies.inertia(b).mass * G * bodies.pose(b).position.z;
    bodies.kinetic_energy() + bodies.ids().map(height).sum::<f64>()
}
/// Runs for `seconds` by the automatic step; answers the largest energy there was (without that of contacts) and the lowest place of a centre.
fn run<L: ContactLaw>(bodies: &mut RigidBodies<L>, seconds: f64) -> Result<(f64, f64), DemError> {
    let (mut most, mut lowest) = (energy(bodies), f64::INFINITY);
    let step = (seconds / 2000.0).max(bodies.stable_dt());
    for _ in 0..(seconds / step).ceil() as usize {
        bodies.advance(step)?;
        let now = energy(bodies);
        assert!(now.is_finite());
        most = most.max(now);
        lowest = bodies.ids().map(|b| bodies.pose(b).position.z).fold(lowest, f64::min);
    }
    Ok((most, lowest))
}

/// A body rests on one a million times lighter, side by side in density and at once in time scales.
#[test]
fn mass_ratio_of_a_million() {
    fn scene<L: ContactLaw>(law: L, shape: &Arc<dyn Shape>) {
        let m = material(1e7);
        let mut bodies = over_floor(law, m);
        add(&mut bodies, shape, Material { density: 1.0, ..m }, Pose::at([0.0, 0.0, R]));
        add(&mut bodies, shape, Material { density: 1e6, ..m }, Pose::at([1e-3 * R, 0.0, 3.0 * R]));
        let start = energy(&bodies);
        let (most, lowest) = run(&mut bodies, 0.2).unwrap();
        println!("mass ratio 1e6, {}: energy at most {:.6} of the first", shape.name(), most / start);
        assert!(most < 1.0001 * start && lowest > 0.3 * R);
        assert!(bodies.pose(BodyId(1)).position.z > bodies.pose(BodyId(0)).position.z);
    }
    for shape in [ball(R), cube(2.0 * R)] {
        scene(Chen::default(), &shape);
        scene(Potential::default(), &shape);
    }
}

/// Grains on a boulder a thousand times as large: they bounce on it and roll off, none gets in.
#[test]
fn size_ratio_of_a_thousand() {
    fn scene<L: ContactLaw>(law: L) {
        let (m, r) = (material(1e9), 1e-3);
        let mut bodies = over_floor(law, m);
        let boulder = add(&mut bodies, &ball(1.0), m, Pose::at([0.0, 0.0, 1.0]));
        for i in 0..12 {
            let (sin, cos) = (0.1 * f64::from(i)).sin_cos();
            let (shape, reach) = if i % 2 == 0 { (ball(r), r) } else { (cube(r), 0.87 * r) };
            let away = 1.0 + 1.5 * reach;
            add(&mut bodies, &shape, m, Pose::at([away * sin, 0.0, 1.0 + away * cos]));
        }
        let start = energy(&bodies);
        let (most, _) = run(&mut bodies, 0.02).unwrap();
        assert!(most < (1.0 + 1e-9) * start);
        assert!(bodies.overlap_calls() > 1000);
        let centre = bodies.pose(boulder).position;
        for b in bodies.ids().skip(1) {
            assert!((bodies.pose(b).position - centre).norm() > 1.0 + 0.3 * r, "{b:?}");
        }
    }
    scene(Chen::default());
    scene(Potential::default());
}

/// From a jelly that cannot bear its own weight to what is stiffer than rock, all by the automatic step: energy does not grow, and who sinks
/// through the floor is told of.
#[test]
fn any_stiffness() {
    fn scene<L: ContactLaw>(law: L, y: f64, shape: &Arc<dyn Shape>) {
        let m = material(y);
        let mut bodies = over_floor(law, m);
        for k in 0..3 {
            let orientation = Rotation::from_scaled_axis(Vector::new(0.1, 0.2, 0.3) * f64::from(k));
            let z = shape.bounding_radius() * (1.0 + 2.0 * f64::from(k)) + 1e-4 * R;
            add(
                &mut bodies,
                shape,
                m,
                Pose { position: Point::new(0.1 * R * f64::from(k), 0.0, z), orientation },
            );
        }
        let start = energy(&bodies);
        let seconds = (1e4 * bodies.stable_dt()).min(0.3);
        let told = match run(&mut bodies, seconds) {
            Ok((most, lowest)) => {
                assert!(y <= 1e3 || lowest > 0.0, "{y:e} {}: {lowest}", shape.name());
                format!("energy at most {:.6} of the first, lowest centre {:.3} R", most / start, lowest / R)
            }
            Err(error @ DemError::PassedThrough { .. }) if y <= 1e3 => error.to_string(),
            Err(error) => panic!("{error}"),
        };
        println!("Y {y:e}, {}: {told}", shape.name());
        assert!(energy(&bodies) < (1.0 + 1e-3) * start);
    }
    for y in [1e3, 1e5, 1e7, 1e9, 1e11] {
        for shape in [ball(R), cube(2.0 * R), tetrahedron(R)] {
            scene(Chen::default(), y, &shape);
            scene(Potential::default(), y, &shape);
        }
    }
}

/// Two that start half within one another part with no more energy than was in their overlap, and the automatic step tells how much that is.
#[test]
fn half_within_one_another() {
    fn parted<L: ContactLaw>(law: L, shape: &Arc<dyn Shape>, parts: f64) -> RigidBodies<L> {
        let m = Material { damping: 0.0, restitution: 1.0, friction: 0.0, ..material(1e7) };
        let mut bodies = RigidBodies::with_law(Periods::default(), law);
        add(&mut bodies, shape, m, Pose::at([0.0; 3]));
        add(&mut bodies, shape, m, Pose::at([0.3 * R, 0.1 * R, R]));
        let step = bodies.stable_dt() / parts;
        for _ in 0..100_000 {
            bodies.advance(step).unwrap();
            if bodies.n_contacts() == 0 {
                return bodies;
            }
        }
        panic!("they did not part");
    }
    for shape in [ball(R), cube(2.0 * R), tetrahedron(R)] {
        let [automatic, finer] = [1.0, 8.0].map(|n| parted(Chen::default(), &shape, n).kinetic_energy());
        println!("{}: {automatic:.5e} J by Chen's law, {finer:.5e} by finer steps", shape.name());
        assert!((automatic / finer - 1.0).abs() < 0.02);
        let bodies = parted(Potential::default(), &shape, 1.0);
        let (p, _) = momenta(&bodies);
        let mut start = RigidBodies::with_law(Periods::default(), Potential::default());
        let m = Material { restitution: 1.0, friction: 0.0, ..material(1e7) };
        add(&mut start, &shape, m, Pose::at([0.0; 3]));
        add(&mut start, &shape, m, Pose::at([0.3 * R, 0.1 * R, R]));
        let (stored, kinetic) = (start.elastic_energy().unwrap(), bodies.kinetic_energy());
        println!("{}: {stored:.6e} J were in the overlap, {kinetic:.6e} J came out", shape.name());
        assert!((kinetic / stored - 1.0).abs() < 2e-3 && p.norm() < 1e-12);
    }
}

/// A tetrahedron balanced on a corner falls over and ends on a face: its centre as high as a third of where the corners are.
#[test]
fn a_tetrahedron_on_its_corner() {
    fn scene<L: ContactLaw>(law: L) {
        let m = Material { damping: 5.0, restitution: 0.3, ..material(1e7) };
        let mut bodies = over_floor(law, m);
        let down = Rotation::rotation_between(&Vector::new(1.0, 1.0, 1.0), &-Vector::z()).unwrap();
        let tilted = Rotation::from_scaled_axis(Vector::new(1e-3, 0.0, 0.0)) * down;
        let reach = 3.0_f64.sqrt() * R;
        add(
            &mut bodies,
            &tetrahedron(R),
            m,
            Pose { position: Point::new(0.0, 0.0, 1.02 * reach), orientation: tilted },
        );
        let start = energy(&bodies);
        let (most, _) = run(&mut bodies, 1.5).unwrap();
        let height = bodies.pose(BodyId(0)).position.z / reach;
        println!(
            "it lies at {height:.4} of its corners' distance, {:.1e} J of motion left",
            bodies.kinetic_energy()
        );
        assert!(most < (1.0 + 1e-6) * start && (height - 1.0 / 3.0).abs() < 3e-3);
    }
    scene(Chen::default());
    scene(Potential::default());
}

/// Between walls a tenth too close a body stays, with no more energy than was put in; between plates that go on closing it slips out or is
/// given up with a clear error.
#[test]
fn squeezed_between_walls() {
    for shape in [ball(R), cube(2.0 * R), tetrahedron(R)] {
        let m = Material { damping: 5.0, restitution: 0.3, ..material(1e7) };
        let thick = 2.0 * shape.aabb().max.z;
        let mut bodies = RigidBodies::with_law(Periods::default(), Potential::default());
        bodies.add_wall(wall(-0.45 * thick, 1.0), m).unwrap();
        bodies.add_wall(wall(0.45 * thick, -1.0), m).unwrap();
        add(&mut bodies, &shape, m, Pose::at([0.0, 0.0, 0.02 * thick]));
        let stored = bodies.elastic_energy().unwrap();
        for _ in 0..1000 {
            bodies.advance(1e-4).unwrap();
            assert!(bodies.kinetic_energy() < 1.0001 * stored);
        }
        let off = bodies.pose(BodyId(0)).position.z / thick;
        println!("{}: {off:.1e} thicknesses from the middle", shape.name());
        assert!(off.abs() < 0.021 && bodies.kinetic_energy() < 1e-3 * stored);

        let mut bodies = RigidBodies::new(Periods::default());
        let plate = Arc::new(Cuboid::new([6.0 * R, 6.0 * R, R]).unwrap());
        for side in [-1.0, 1.0] {
            let at = Pose::at([0.0, 0.0, side * (0.5 * thick + 0.51 * R)]);
            let closing = moving([0.0, 0.0, -0.1 * side], [0.0; 3]);
            bodies.add(plate.clone(), m, at, closing, Freedom::NONE).unwrap();
        }
        let b = add(&mut bodies, &shape, m, Pose::at([0.0, 0.0, 1e-3 * R]));
        let result = (0..2000).try_for_each(|_| bodies.advance(1e-4));
        println!("{} between closing plates: {result:?}", shape.name());
        let away = bodies.pose(b).position;
        match result {
            Ok(()) => assert!(away.x.abs().max(away.y.abs()) > 2.5 * R, "neither out nor given up: {away}"),
            Err(error) => assert!(matches!(error, DemError::PassedThrough { .. }), "{error}"),
        }
        assert!(away.iter().all(|x| x.is_finite()) && bodies.kinetic_energy().is_finite());
    }
}

/// A wall stops what is slower than √(2E(V_b)/m), E(V_b) the potential of the whole ball; what is faster is told of. For a wall E = ⅓ (Y/4R) √(V³/πR).
#[test]
fn walls_stop_what_their_potential_can() {
    let m = Material { restitution: 1.0, friction: 0.0, ..material(1e5) };
    let y = 0.5 * m.youngs_modulus / (1.0 - m.poisson_ratio * m.poisson_ratio);
    let volume = 4.0 / 3.0 * std::f64::consts::PI * R.powi(3);
    let barrier = y / (12.0 * R) * (volume.powi(3) / (std::f64::consts::PI * R)).sqrt();
    let limit = (2.0 * barrier / (m.density * volume)).sqrt();
    for part in [0.5, 0.99, 1.01, 2.0, 10.0] {
        let mut bodies = RigidBodies::with_law(Periods::default(), Potential::default());
        bodies.add_wall(wall(0.0, 1.0), m).unwrap();
        let b = add(&mut bodies, &ball(R), m, Pose::at([0.0, 0.0, 1.1 * R]));
        bodies.set_twist(b, moving([0.0, 0.0, -part * limit], [0.0; 3]));
        let result = (0..20_000).try_for_each(|_| bodies.advance(0.01 * R / limit));
        if part < 1.0 {
            result.unwrap();
            let back = bodies.twist(b).linear.z / (part * limit);
            assert!((back - 1.0).abs() < 1e-4, "{part}: {back}");
        } else {
            let error = result.unwrap_err();
            println!("at {part} of {limit:.2} m/s: {error}");
            let DemError::PassedThrough { body, partner, share } = error else { panic!("{error}") };
            assert!(body == b && partner == Partner::Wall(0) && share > 0.999);
        }
    }
}

/// Balls that go through one another nearly along their line of centres, without ever being one within the other: told of, with the pair.
#[test]
fn who_goes_through_another_is_told() {
    let m = Material { restitution: 1.0, friction: 0.0, ..material(1e4) };
    let mut bodies = RigidBodies::with_law(Periods::default(), Potential::default());
    for side in [-1.0, 1.0] {
        let b = add(&mut bodies, &ball(R), m, Pose::at([side * 1.1 * R, side * 0.01 * R, 0.0]));
        bodies.set_twist(b, moving([-side * 20.0, 0.0, 0.0], [0.0; 3]));
    }
    let error = bodies.advance(0.1).unwrap_err();
    println!("{error}");
    assert!(matches!(
        error,
        DemError::PassedThrough { body: BodyId(0), partner: Partner::Body(BodyId(1), _), .. }
    ));
    // They go on to be asked, saved and so on.
    assert!(bodies.kinetic_energy().is_finite() && bodies.n_contacts() == 1);
}

/// A sheet a twentieth of the ball's radius thick shares little with it, and turns the ball back or tells that it could not.
#[test]
fn thin_sheets_are_not_passed_unseen() {
    let sheet: Arc<dyn Shape> = Arc::new(Cuboid::new([6.0 * R, 6.0 * R, 0.05 * R]).unwrap());
    let m = Material { friction: 0.0, ..material(1e6) };
    let (mut stopped, mut told) = (0, 0);
    for speed in [0.003, 0.03, 0.3, 3.0, 30.0] {
        let mut bodies = RigidBodies::with_law(Periods::default(), Potential::default());
        bodies.add(sheet.clone(), m, Pose::at([0.0; 3]), Twist::default(), Freedom::NONE).unwrap();
        let b = add(&mut bodies, &ball(R), m, Pose::at([0.1 * R, 0.2 * R, 1.1 * R]));
        bodies.set_twist(b, moving([0.0, 0.0, -speed], [0.0; 3]));
        let result = (0..200).try_for_each(|_| bodies.advance(0.05 * R / speed));
        let height = bodies.pose(b).position.z;
        println!("{speed} m/s: {result:?}, at {:.2} R", height / R);
        match result {
            Ok(()) => {
                assert!(height > R);
                stopped += 1;
            }
            Err(DemError::PassedThrough { .. }) => told += 1,
            Err(error) => panic!("{error}"),
        }
    }
    assert!(stopped > 0 && told > 0);
}
