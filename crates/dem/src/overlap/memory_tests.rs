//! What a solver needs memory for.
use crate::{
    Capsule, ConvexPolyhedron, Cuboid, Cylinder, Disc, Ellipsoid, HalfSpace, OverlapSolver, Polygon, Shape,
    Sphere, TriangleMesh,
};
use interfaces::{Point, Pose, Rotation, Vector};

/// Once it has met a pair, it allocates nothing for it, near or apart, whatever pairs come between.
#[test]
fn a_warmed_up_solver_allocates_nothing() {
    let sphere = Sphere::new(1.0).unwrap();
    let cube = Cuboid::new([1.6, 1.8, 2.0]).unwrap();
    let mesh = TriangleMesh::sphere(1.0, 2).unwrap();
    let vertices: Vec<[f64; 3]> = mesh.vertices().iter().map(|v| v.coords.into()).collect();
    let faces: Vec<Vec<u32>> = mesh.faces().iter().map(|f| f.to_vec()).collect();
    let hull = ConvexPolyhedron::new(&vertices, &faces).unwrap();
    let ellipsoid = Ellipsoid::new([0.9, 1.0, 1.2]).unwrap();
    let wall = HalfSpace::new(Point::origin(), Vector::z()).unwrap();
    let exact: [&dyn Shape; 5] = [&sphere, &cube, &mesh, &hull, &wall];
    let mut pairs: Vec<[&dyn Shape; 2]> = exact.iter().flat_map(|a| exact.iter().map(|b| [*a, *b])).collect();
    pairs.retain(|[a, b]| !(a.name() == "half-space" && b.name() == "half-space"));
    pairs.extend([[&ellipsoid as &dyn Shape, &ellipsoid as _], [&ellipsoid, &mesh], [&ellipsoid, &wall]]);
    let (capsule, cylinder) = (Capsule::new(0.7, 0.9).unwrap(), Cylinder::new(0.8, 1.1).unwrap());
    let tubes: [&dyn Shape; 2] = [&capsule, &cylinder];
    let others: [&dyn Shape; 6] = [&sphere, &cube, &hull, &wall, &capsule, &cylinder];
    pairs.extend(tubes.iter().flat_map(|a| others.iter().map(|b| [*a, *b])));
    let side = HalfSpace::new(Point::origin(), Vector::y()).unwrap();
    let angle = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let (disc, angle) = (Disc::new(0.8).unwrap(), Polygon::new(&angle).unwrap());
    pairs.extend([[&angle as &dyn Shape, &angle as _], [&disc, &angle], [&angle, &disc], [&angle, &side]]);
    let poses = |distance: f64| {
        let orientation = Rotation::from_scaled_axis(Vector::new(0.3, 0.4, 0.5));
        [Pose::at([0.0; 3]), Pose { position: Point::new(0.3, 0.4, distance), orientation }]
    };
    let mut solver = OverlapSolver::new();
    let mut meet_all = |expected: bool| {
        for [a, b] in &pairs {
            for distance in [0.6, 1.4, 2.1, 9.0] {
                let [at_a, at_b] = poses(distance);
                let counted = allocation_counter::measure(|| {
                    solver.solve(*a, &at_a, *b, &at_b).unwrap();
                });
                let nothing = counted.count_total == 0;
                assert!(nothing || !expected, "{} and {} at {distance}: {counted:?}", a.name(), b.name());
            }
        }
    };
    meet_all(false);
    meet_all(true);
}
