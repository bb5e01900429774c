//! Bodies made of triangles (`dem`) on grids (`ibm`).
use siltflow::dem::{Shape, TriangleMesh};
use siltflow::ibm::{SolidFraction, SolidNode, WallDistance};
use siltflow::interfaces::{BodyId, Kinematics, Lattice, Nodes, Point, Pose, Rotation, Twist, Vector};
use validation::prescribed_bodies::PrescribedBodies;

/// A brick with these edges.
fn brick(size: [f64; 3]) -> TriangleMesh {
    let corner = |i: usize| [0, 1, 2].map(|a| if i >> a & 1 == 1 { size[a] } else { 0.0 });
    let vertices: Vec<[f64; 3]> = (0..8).map(corner).collect();
    let quads: [[u32; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces: Vec<[u32; 3]> = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleMesh::new(&vertices, &faces).unwrap()
}

/// Places and turns as scattered as a few numbers can make them.
fn pose(i: usize) -> Pose {
    let share = |k: f64| (k * (i as f64 + 1.0)).fract();
    let orientation = Rotation::from_euler_angles(6.0 * share(0.618), 6.0 * share(0.414), 6.0 * share(0.732));
    Pose { position: Point::new(3.0 * share(0.303), 3.0 * share(0.571), 3.0 * share(0.839)), orientation }
}

/// Σ λ V of meshes is their volume in any pose, over periodic sides.
#[test]
fn meshes_sum_to_their_volume() {
    let axis = || Nodes::uniform(0.05, 0.1, 30, true);
    let lattice = Lattice::new([axis(), axis(), axis()], 0, [1, 30, 900]);
    let meshes = || {
        [
            TriangleMesh::sphere(0.5, 3).unwrap(),
            TriangleMesh::sphere(0.55, 1).unwrap(),
            brick([1.0, 1.1, 1.2]),
        ]
    };
    let mut fraction = SolidFraction::new();
    for i in 0..12 {
        for mesh in meshes() {
            let volume = mesh.inertia(1.0).volume;
            let mut bodies = PrescribedBodies::default().with(mesh, [0.0; 3], 0.0);
            bodies.put(BodyId(0), pose(i), Twist::default());
            fraction.update(&lattice, &bodies).unwrap();
            let share = |n: &SolidNode| n.fraction * n.volume;
            let sum: f64 = fraction.nodes(BodyId(0)).iter().map(share).sum();
            assert!((sum / volume - 1.0).abs() < 1e-8, "{}", sum / volume - 1.0);
        }
    }
}

/// A mesh is asked for distances in batches and with a band: just as far as it takes to be exact.
#[test]
fn distances_from_meshes_are_exact() {
    let lattice = {
        let faces: Vec<f64> = (0..=17).map(|i| f64::from(i) - 0.8 * (0.4 * f64::from(i)).sin()).collect();
        let end = faces[17];
        let axis = |periodic| {
            Nodes::centres(&faces.iter().map(|x| 3.0 * x / end - 1.0).collect::<Vec<_>>(), periodic)
        };
        Lattice::new([axis(true), axis(false), axis(true)], 0, [1, 17, 289])
    };
    let mesh = TriangleMesh::sphere(0.3, 2).unwrap();
    let mut bodies =
        PrescribedBodies::default().with(mesh.clone(), [-0.8, 0.3, 1.7], 0.0).with(mesh, [0.0; 3], 0.0);
    let orientation = Rotation::from_euler_angles(0.3, 0.4, 0.5);
    bodies.put(BodyId(1), Pose { position: Point::new(1.3, 1.5, 0.2), orientation }, Twist::default());
    let mut distance = WallDistance::new();
    distance.update(&lattice, &bodies).unwrap();
    let mut inside = 0;
    for (c, found) in distance.values().iter().enumerate() {
        let x = Point::from(lattice.position([c % 17, c / 17 % 17, c / 289].map(|i| i as isize)));
        let mut least = f64::INFINITY;
        for image in 0..9 {
            let shift = Vector::new(f64::from(image % 3 - 1), 0.0, f64::from(image / 3 - 1)) * 3.0;
            for b in [BodyId(0), BodyId(1)] {
                let solid = siltflow::interfaces::Bodies::solid(&bodies, b);
                least = least.min(solid.signed_distance(bodies.pose(b).to_body(x - shift), f64::INFINITY));
            }
        }
        inside += usize::from(least < 0.0);
        assert!((found - least.max(0.0)).abs() < 1e-13, "{c}: {found} {least}");
    }
    assert!(inside > 5, "{inside}");
}
