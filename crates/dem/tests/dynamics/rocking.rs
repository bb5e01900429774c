//! Bodies that land off-centre come to rest: drops of tilted bodies against rigid-body dynamics with impacts.
//!
//! References: time stepping of Moreau's kind without friction, e = 0.2, converged in the step; energy per mass with the floor as
//! height 0. All end at the height of a body that lies flat.
use super::*;
use dem::{
    Chen, ContactLaw, ConvexPolyhedron, Cuboid, Cylinder, Ellipsoid, HalfSpace, Part, Polygon, Potential,
    TriangleMesh, Union,
};
use interfaces::{Dynamics, Point, Rotation};

const G: f64 = 9.81;

fn material(restitution: f64) -> Material {
    Material { youngs_modulus: 1e7, restitution, friction: 0.0, ..Material::default() }
}
fn tilted() -> Rotation {
    Rotation::from_scaled_axis(Vector::new(1.0, 0.3, 0.0).normalize() * 20.0_f64.to_radians())
}
fn cuboid(edges: [f64; 3]) -> Arc<dyn Shape> {
    Arc::new(Cuboid::new(edges).unwrap())
}

/// The floor, its top at height 0.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Floor {
    Wall,
    /// An immovable box.
    Box,
}

/// A tilted body, dropped from `height` over a floor.
fn drop<L: ContactLaw>(
    law: L,
    shape: Arc<dyn Shape>,
    m: Material,
    height: f64,
    floor: Floor,
) -> RigidBodies<L> {
    let mut bodies = RigidBodies::with_law(Periods::default(), law);
    bodies.set_gravity(Vector::new(0.0, 0.0, -G));
    let pose = Pose { position: Point::new(0.0, 0.0, height), orientation: tilted() };
    bodies.add(shape, m, pose, Twist::default(), Freedom::FREE).unwrap();
    match floor {
        Floor::Wall => bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), m).unwrap(),
        Floor::Box => {
            let below = Pose::at([0.0, 0.0, -0.5]);
            bodies.add(cuboid([20.0, 20.0, 1.0]), m, below, Twist::default(), Freedom::NONE).unwrap();
        }
    }
    bodies
}

/// Kinetic energy and that of height of the first body, per mass \[J/kg\].
fn energy<L: ContactLaw>(bodies: &RigidBodies<L>) -> f64 {
    bodies.kinetic_energy() / bodies.inertia(BodyId(0)).mass + G * bodies.pose(BodyId(0)).position.z
}

/// Boxes lie still, at the energy of rigid ones, on a wall and on an immovable body.
#[test]
fn boxes_come_to_rest() {
    let wall = [
        ([2.0, 2.0, 0.1], 0.49, 1.5),
        ([1.0, 1.0, 0.3], 1.47, 1.5),
        ([1.0, 0.3, 0.3], 1.47, 1.5),
        ([1.0, 1.0, 1.0], 4.90, 2.75),
    ];
    let on_wall = wall.map(|case| (Floor::Wall, case));
    for (floor, (edges, rest, at)) in on_wall.into_iter().chain([(Floor::Box, wall[3])]) {
        let mut bodies = drop(Potential::default(), cuboid(edges), material(0.2), 1.2, floor);
        bodies.advance(at).unwrap();
        let end = energy(&bodies);
        println!("{edges:?} on a {floor:?}: {end:.4} J/kg for {rest}");
        assert!((end - rest).abs() < 0.01 * rest);
    }
}

/// The same by Chen's law, with a coefficient for which corners, where its dashpot is weakest, give back little.
#[test]
fn boxes_come_to_rest_by_chens_law() {
    for (edges, rest) in [([1.0, 0.3, 0.3], 1.47), ([1.0, 1.0, 1.0], 4.90)] {
        let m = Material { damping: 8.0, ..material(0.2) };
        let mut bodies = drop(Chen::default(), cuboid(edges), m, 1.2, Floor::Wall);
        bodies.advance(2.75).unwrap();
        let end = energy(&bodies);
        println!("{edges:?}: {end:.4} J/kg for {rest}");
        assert!((end - rest).abs() < 0.01 * rest);
    }
}

/// Friction stops a box that spins about the normal of a floor as Coulomb's law tells: the torque is μ m g times the mean distance
/// from the axis, of a square 0.3826 of its edge (of a disc of the same radius of gyration 0.3849).
#[test]
fn friction_stops_spin() {
    fn stop<L: ContactLaw>(law: L) -> f64 {
        let m = Material { friction: 0.3, ..material(0.2) };
        let mut bodies = RigidBodies::with_law(Periods::default(), law);
        bodies.set_gravity(Vector::new(0.0, 0.0, -G));
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), m).unwrap();
        let at = Pose::at([0.0, 0.0, 0.1 - 1e-6]);
        let b =
            bodies.add(cuboid([0.2; 3]), m, at, moving([0.0; 3], [0.0, 0.0, 20.0]), Freedom::FREE).unwrap();
        let mut t = 0.0;
        while bodies.twist(b).angular.z > 1e-3 && t < 2.0 {
            bodies.advance(1e-3).unwrap();
            t += 1e-3;
        }
        bodies.advance(0.2).unwrap();
        assert!(bodies.twist(b).angular.norm() < 0.02, "{:?}", bodies.twist(b));
        t
    }
    // I = m a²/6.
    let expected = 20.0 * 0.2 / 6.0 / (0.3 * G * 0.3826);
    for (name, t) in [("Potential", stop(Potential::default())), ("Chen", stop(Chen::default()))] {
        println!("{name}: {t:.3} s for {expected:.3}");
        assert!((t / expected - 1.0).abs() < 0.02);
    }
}

/// Blocks in the plane, perfectly plastic ones, too.
#[test]
fn blocks_come_to_rest() {
    for (e, end) in [(0.0, 1.0), (0.2, 1.5), (0.5, 4.0)] {
        let m = Material { friction: 0.5, ..material(e) };
        let mut bodies = RigidBodies::with_law(Periods::default(), Potential::default());
        bodies.set_gravity(Vector::new(0.0, -G, 0.0));
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::y()).unwrap(), m).unwrap();
        let block = Polygon::new(&[[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]]).unwrap();
        let orientation = Rotation::from_scaled_axis(Vector::z() * 20.0_f64.to_radians());
        let pose = Pose { position: Point::new(0.0, 0.2, 0.0), orientation };
        let b = bodies.add(block, m, pose, Twist::default(), Freedom::PLANAR).unwrap();
        bodies.advance(end).unwrap();
        let (kinetic, height) = (bodies.kinetic_energy() / bodies.inertia(b).mass, bodies.pose(b).position.y);
        println!(
            "e {e}: kinetic energy {kinetic:.1e} J/kg, {:.1e} of its half width deep",
            1.0 - height / 0.05
        );
        assert!(kinetic < 1e-9 && (height / 0.05 - 1.0).abs() < 1e-3);
    }
}

/// Whatever lies still is as deep as its stiffness says, not deeper the less it gives back.
#[test]
fn bodies_rest_where_their_stiffness_carries_them() {
    let depth = |e: f64, shape: &Arc<dyn Shape>| {
        let m = material(e);
        let mut bodies = RigidBodies::with_law(Periods::default(), Potential::default());
        bodies.set_gravity(Vector::new(0.0, 0.0, -G));
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), m).unwrap();
        let bottom = -shape.aabb().min.z;
        let b = bodies
            .add(shape.clone(), m, Pose::at([0.0, 0.0, bottom]), Twist::default(), Freedom::FREE)
            .unwrap();
        bodies.advance(3.0).unwrap();
        bottom - bodies.pose(b).position.z
    };
    let shapes: [Arc<dyn Shape>; 3] = [
        Arc::new(Sphere::new(0.1).unwrap()),
        cuboid([0.2; 3]),
        Arc::new(Ellipsoid::new([0.1, 0.15, 0.08]).unwrap()),
    ];
    for shape in &shapes {
        let all: Vec<_> = [0.0, 0.2, 0.5, 0.8].map(|e| depth(e, shape)).into();
        println!("{}: {all:?} m deep", shape.name());
        assert!(all.iter().all(|d| (d / all[0] - 1.0).abs() < 1e-3));
    }
}

/// Other shapes and other ways to find overlaps: meshes, unions, cylinders, ellipsoids.
#[test]
fn other_shapes_come_to_rest() {
    let half: Arc<dyn Shape> = cuboid([0.1, 0.2, 0.1]);
    let at = |x: f64| Part { shape: half.clone(), pose: Pose::at([x, 0.0, 0.0]) };
    let (low, high) = (-0.1, 0.1);
    let vertices = [0, 1, 2, 3, 4, 5, 6, 7]
        .map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { low } else { high }))
        .map(|[x, y, z]| [x, y, 0.5 * z]);
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces: Vec<[u32; 3]> =
        sides.iter().flat_map(|s: &[u32; 4]| [[s[0], s[2], s[1]], [s[0], s[3], s[2]]]).collect();
    let shapes: [(Arc<dyn Shape>, f64); 4] = [
        (Arc::new(TriangleMesh::new(&vertices, &faces).unwrap()), 0.05),
        (Arc::new(Union::new(vec![at(-0.05), at(0.05)]).unwrap()), 0.05),
        (Arc::new(Cylinder::new(0.1, 0.1).unwrap()), 0.05),
        (Arc::new(Ellipsoid::new([0.1, 0.12, 0.05]).unwrap()), 0.05),
    ];
    for (shape, height) in shapes {
        for floor in [Floor::Wall, Floor::Box] {
            let mut bodies = drop(Potential::default(), shape.clone(), material(0.2), 0.2, floor);
            bodies.advance(1.5).unwrap();
            let (end, rest) = (energy(&bodies), G * height);
            println!("{} on a {floor:?}: {end:.5} J/kg for {rest:.5}", shape.name());
            // Ellipsoids lie on a point, as deep as that.
            assert!((end - rest).abs() < 0.03 * rest);
            let kinetic = bodies.kinetic_energy() / bodies.inertia(BodyId(0)).mass;
            assert!(kinetic < 1e-4, "{kinetic:e}");
        }
    }
}

/// Hulls of few and of many points lie still.
#[test]
fn hulls_come_to_rest() {
    for n in [10, 1000] {
        let points: Vec<[f64; 3]> = (0..n)
            .map(|i| {
                let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(n);
                let (r, turn) = ((1.0 - z * z).sqrt(), 2.399_963 * f64::from(i));
                [0.1 * r * turn.cos(), 0.09 * r * turn.sin(), 0.08 * z]
            })
            .collect();
        let shape: Arc<dyn Shape> = Arc::new(ConvexPolyhedron::from_points(&points).unwrap());
        let m = Material { friction: 0.5, ..material(0.2) };
        let mut bodies = drop(Potential::default(), shape.clone(), m, 0.15, Floor::Wall);
        bodies.advance(4.0).unwrap();
        let kinetic = bodies.kinetic_energy() / bodies.inertia(BodyId(0)).mass;
        println!("{n} points: {kinetic:.1e} J/kg, {:?}", bodies.twist(BodyId(0)));
        assert!(kinetic < 1e-4);
    }
}
