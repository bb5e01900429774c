//! Every error: which value, why, what to do.
use super::*;
use dem::{Chen, Cuboid, DemError, HalfSpace};
use interfaces::{Dynamics, Point};

const NAN: f64 = f64::NAN;

/// The message names all of `words`, and one of the remedies.
fn says(error: &DemError, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "`{word}` is not in: {message}");
    }
    let remedies = ["give", "take", "move", "use"];
    assert!(remedies.iter().any(|r| message.contains(r)), "no remedy in: {message}");
}
fn add(material: Material, pose: Pose, twist: Twist, periods: Periods) -> DemError {
    RigidBodies::new(periods).add(disc().shape(), material, pose, twist, Freedom::PLANAR).unwrap_err()
}

#[test]
fn lengths_and_directions() {
    for radius in [0.0, -2.5, NAN, f64::INFINITY] {
        let words = [&radius.to_string(), "radius of a disc", "positive"];
        says(&Disc::new(radius).unwrap_err(), &words.map(|w| w as &str));
        says(&Sphere::new(radius).unwrap_err(), &[&radius.to_string(), "radius of a sphere"]);
    }
    for normal in [Vector::zeros(), Vector::new(NAN, 1.0, 0.0), Vector::new(f64::INFINITY, 1.0, 0.0)] {
        let error = HalfSpace::new(Point::origin(), normal).unwrap_err();
        assert!(matches!(error, DemError::Direction { .. }));
        says(&error, &[&format!("{:?}", <[f64; 3]>::from(normal)), "not zero"]);
    }
    assert!(HalfSpace::new(Point::new(NAN, 0.0, 0.0), Vector::x()).is_err());
    assert_eq!(HalfSpace::new(Point::origin(), Vector::x() * 5.0).unwrap().normal(), Vector::x());

    let mut stretched = RigidBodies::with_law(Periods::default(), Chen::default().with_length_factor(-1.0));
    let error = stretched.add(disc().shape(), elastic(), Pose::at([0.0; 3]), Twist::default(), Freedom::FREE);
    says(&error.unwrap_err(), &["-1", "factor", "positive"]);
}

#[test]
fn materials() {
    let good = Material::default();
    let cases = [
        (Material { density: -1000.0, ..good }, "density", "-1000"),
        (Material { density: 0.0, ..good }, "density", "0"),
        (Material { youngs_modulus: -3.0, ..good }, "Young's modulus", "-3"),
        (Material { poisson_ratio: 0.7, ..good }, "Poisson's ratio", "0.7"),
        (Material { poisson_ratio: NAN, ..good }, "Poisson's ratio", "NaN"),
        (Material { damping: -0.5, ..good }, "damping", "-0.5"),
        (Material { friction: f64::INFINITY, ..good }, "friction", "inf"),
        (Material { restitution: 1.1, ..good }, "restitution", "1.1"),
        (Material { rolling_friction: -0.1, ..good }, "rolling friction", "-0.1"),
    ];
    for (material, property, value) in cases {
        let error = add(material, Pose::at([0.0; 3]), Twist::default(), Periods::default());
        says(&error, &[property, value]);
        let wall = HalfSpace::new(Point::origin(), Vector::y()).unwrap();
        assert!(RigidBodies::new(Periods::default()).add_wall(wall, material).is_err());
    }
}

/// A wall from a file in single precision that is as long as the period is longer than it by 1e-8
/// m, and is taken.
#[test]
fn bodies_may_be_as_long_as_the_period() {
    let with = |length: f64| {
        let mut bodies = RigidBodies::new(Periods::new([Some(0.3), None, None]));
        let wall = Cuboid::new([length, 0.1, 0.1]).unwrap();
        bodies.add(wall, elastic(), Pose::at([0.0; 3]), Twist::default(), Freedom::FREE)
    };
    assert!(f64::from(0.3_f32) > 0.3 + 1e-8 && with(f64::from(0.3_f32)).is_ok());
    assert!(matches!(with(0.3 * (1.0 + 7e-7)), Err(DemError::Period { axis: 0, .. })));
}

#[test]
fn starts() {
    let (still, free) = (Twist::default(), Periods::default());
    says(&add(elastic(), Pose::at([0.0, NAN, 0.0]), still, free), &["body 0", "NaN", "finite"]);
    let fast = moving([0.0, f64::INFINITY, 0.0], [0.0; 3]);
    says(&add(elastic(), Pose::at([0.0; 3]), fast, free), &["body 0", "inf", "m/s"]);
    let spinning = moving([0.0; 3], [0.0, 0.0, NAN]);
    says(&add(elastic(), Pose::at([0.0; 3]), spinning, free), &["body 0", "NaN", "rad/s"]);
    let narrow = Periods::new([None, Some(1.9 * R), None]);
    let error = add(elastic(), Pose::at([0.0; 3]), still, narrow);
    assert!(matches!(error, DemError::Period { axis: 1, .. }));
    says(&error, &["body 0", "2.000e-2", "1.900e-2", "axis 1"]);

    let mut bodies = scene(disc(), elastic(), &[([0.0; 3], still)]);
    let error =
        bodies.add(sphere().shape(), elastic(), Pose::at([1.0, 0.0, 0.0]), still, Freedom::FREE).unwrap_err();
    says(&error, &["disc", "sphere", "dimension"]);
    let at = Pose::at([0.0; 3]);
    assert_eq!(dem::overlap(&disc().shape(), &at, &sphere().shape(), &at), Err(error));
}

#[test]
fn overlapping_starts() {
    // Across the periodic side.
    let mut bodies = RigidBodies::new(Periods::new([Some(10.0 * R), None, None]));
    for x in [0.5, 4.0, 9.0] {
        bodies
            .add(disc().shape(), elastic(), Pose::at([x * R, 0.0, 0.0]), Twist::default(), Freedom::PLANAR)
            .unwrap();
    }
    let error = bodies.check_overlaps().unwrap_err();
    assert!(matches!(error, DemError::OverlappingStart { a: BodyId(0), b: BodyId(2), .. }));
    says(&error, &["bodies 0 and 2", "5.000e-3"]);
    assert!((bodies.smallest_gap().unwrap() + 0.5 * R).abs() < 1e-15);

    let mut bodies = scene(disc(), elastic(), &[([0.0, 0.75 * R, 0.0], Twist::default())]);
    assert_eq!((bodies.check_overlaps(), bodies.smallest_gap()), (Ok(()), None));
    let wall = |y: f64| HalfSpace::new(Point::new(0.0, y, 0.0), Vector::y()).unwrap();
    bodies.add_wall(wall(-1.0), elastic()).unwrap();
    bodies.add_wall(wall(0.0), elastic()).unwrap();
    let error = bodies.check_overlaps().unwrap_err();
    assert!(matches!(error, DemError::InWall { body: BodyId(0), wall: 1, .. }));
    says(&error, &["body 0", "wall 1", "2.500e-3"]);
}

#[test]
fn steps() {
    let mut bodies = head_on(sphere(), elastic(), R, 1.0);
    for dt in [0.0, -1.0, NAN, f64::INFINITY] {
        let error = bodies.advance(dt).unwrap_err();
        assert!(matches!(error, DemError::TimeStep { .. }));
        says(&error, &[&dt.to_string(), "positive"]);
    }
    assert_eq!(distance(&bodies), 3.0 * R, "nothing has moved");
}

/// A load that is not finite ends the step with an error, near others or not, and never panics.
#[test]
fn diverged() {
    for gap in [10.0 * R, -0.1 * R] {
        for (force, torque) in
            [(Vector::new(0.0, NAN, 0.0), 0.0), (Vector::zeros(), NAN), (Vector::x() * f64::INFINITY, 0.0)]
        {
            let mut bodies = head_on(disc(), Material::default(), gap, 0.1);
            bodies
                .add_wall(HalfSpace::new(Point::new(0.0, -R, 0.0), Vector::y()).unwrap(), elastic())
                .unwrap();
            let torque = Vector::z() * torque;
            bodies.apply(BodyId(1), Load { wrench: Wrench { force, torque }, ..Load::default() });
            let error = (0..3).find_map(|_| bodies.advance(1e-3).err()).unwrap();
            assert!(matches!(error, DemError::Diverged { .. }));
            says(&error, &["body", "finite", "m/s"]);
        }
    }
}

/// Bodies that touch may overlap by round-off at the start: up to 10⁻⁹ of the radius around the smaller one.
#[test]
fn bodies_that_touch_are_no_overlap() {
    let start = |depth: f64, ball: bool| {
        let mut bodies = RigidBodies::new(Periods::default());
        let shape: Arc<dyn Shape> = if ball {
            Arc::new(Sphere::new(R).unwrap())
        } else {
            Arc::new(Cuboid::new([2.0 * R; 3]).unwrap())
        };
        let radius = shape.bounding_radius();
        let place = |z: f64| Pose::at([0.0, 0.0, z]);
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), Material::default()).unwrap();
        for z in [R - depth * radius, 3.0 * R - 2.0 * depth * radius] {
            bodies
                .add(shape.clone(), Material::default(), place(z), Twist::default(), Freedom::FREE)
                .unwrap();
        }
        bodies.check_overlaps()
    };
    for ball in [true, false] {
        for depth in [0.0, 1e-15, 1e-12] {
            assert!(start(depth, ball).is_ok(), "{depth} {ball}: {:?}", start(depth, ball));
        }
    }
    assert!(start(0.7e-9, true).is_ok() && start(1.4e-9, true).is_err());
    assert!(start(3e-9, false).is_err());
}
