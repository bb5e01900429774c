//! Frames of few and of many bodies.
use super::super::tests::{attribute, read};
use super::*;
use crate::shapes::icosphere;
use crate::{ConvexPolyhedron, Cuboid, Ellipsoid, Material, Sphere};
use interfaces::{Freedom, Kinematics, Periods, Pose, Rotation, Twist, Vector};

/// A body of 1280 triangles.
fn rock(size: f64) -> Arc<dyn Shape> {
    let (vertices, faces) = icosphere(size, 3);
    let faces: Vec<Vec<u32>> = faces.iter().map(|f| f.to_vec()).collect();
    Arc::new(ConvexPolyhedron::new(&vertices, &faces).unwrap())
}

fn add(bodies: &mut RigidBodies, shape: &Arc<dyn Shape>, x: f64) {
    let orientation = Rotation::from_scaled_axis(Vector::new(0.1 * x, 0.2, 0.3));
    let pose = Pose { position: Point::new(3.0 * x, 0.0, 0.0), orientation };
    let twist = Twist { linear: Vector::new(x, 2.0, 3.0), angular: Vector::new(4.0, 5.0, x) };
    bodies.add(shape.clone(), Material::default(), pose, twist, Freedom::FREE).unwrap();
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("siltflow-frames-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

fn polygons(path: &Path) -> usize {
    attribute(&read(&std::fs::read(path).unwrap()).0, "NumberOfPolys").parse().unwrap()
}

/// Frames are surfaces up to the number of polygons that is stated, and then not larger than
/// stated.
#[test]
fn frames_of_few_bodies_are_surfaces() {
    let (out, shape) = (folder("few"), rock(1.0));
    let mut bodies = RigidBodies::new(Periods::default());
    (0..25).for_each(|i| add(&mut bodies, &shape, f64::from(i)));
    let mut frames = BodyFrames::new(&out, "rocks").unwrap();
    let path = frames.write(&bodies, Point::origin(), bodies.ids(), 7).unwrap();
    assert_eq!(path, "rocks/00007.vtp");
    assert_eq!(polygons(&out.join(&path)), 25 * 1280);
    assert!(std::fs::metadata(out.join(&path)).unwrap().len() < 1_700_000);
    assert!(!out.join("rocks/shapes").exists() && !out.join("rocks.py").exists());

    // Another one is one too many. The frame is written over that of the same number.
    add(&mut bodies, &shape, 25.0);
    frames.write(&bodies, Point::origin(), bodies.ids(), 7).unwrap();
    let (piece, arrays) = read(&std::fs::read(out.join(&path)).unwrap());
    assert_eq!((attribute(&piece, "NumberOfPoints"), attribute(&piece, "NumberOfPolys")), ("26", "0"));
    assert_eq!(arrays["shape"].ints(), [0; 26]);
    assert_eq!(polygons(&out.join("rocks/shapes/00000.vtp")), 1280);
    assert!(out.join("rocks.py").exists());
    std::fs::remove_dir_all(&out).unwrap();
}

/// A frame of 500 rocks of 1280 triangles takes 100 bytes per rock, and their surface is written
/// once.
#[test]
fn frames_of_many_bodies_are_small() {
    let (out, shapes) = (folder("many"), [rock(1.0), rock(0.7)]);
    let mut bodies = RigidBodies::new(Periods::default());
    (0..500).for_each(|i| add(&mut bodies, &shapes[i % 2], i as f64));
    // Surfaces are made once per shape, since bodies share it.
    assert!((0..500).all(|i| Arc::ptr_eq(bodies.shared_shape(BodyId(i)), &shapes[i % 2])));
    let mut frames = BodyFrames::new(&out, "rocks").unwrap();
    let path = frames.write(&bodies, Point::origin(), bodies.ids(), 0).unwrap();
    let size = std::fs::metadata(out.join(&path)).unwrap().len();
    assert!(size < 500 * 100 + 2000, "{size}");
    assert_eq!(std::fs::read_dir(out.join("rocks/shapes")).unwrap().count(), 1);
    std::fs::remove_dir_all(&out).unwrap();
}

/// A frame of points and the surfaces of its shapes make up the surfaces of all bodies.
#[test]
fn points_and_shapes_are_the_surfaces() {
    let out = folder("both");
    let shapes: [Arc<dyn Shape>; 4] = [
        rock(0.8),
        Arc::new(Sphere::new(1.2).unwrap()),
        Arc::new(Ellipsoid::new([0.3, 0.5, 1.1]).unwrap()),
        Arc::new(Cuboid::new([0.5, 1.0, 1.5]).unwrap()),
    ];
    let mut bodies = RigidBodies::new(Periods::new([None, Some(9.0), None]));
    (0..100).for_each(|i| add(&mut bodies, &shapes[i % 4], i as f64));
    let corner = Point::new(0.0, -7.0, 0.0);
    let mut frames = BodyFrames::new(&out, "bodies").unwrap();
    let path = frames.write(&bodies, corner, bodies.ids(), 0).unwrap();
    let rows = read(&std::fs::read(out.join(path)).unwrap()).1;
    // Spheres and ellipsoids share one.
    assert_eq!(rows["shape"].ints()[..6], [0, 1, 1, 2, 0, 1]);
    assert_eq!(rows["velocity"].floats()[3..6], [1.0, 2.0, 3.0]);
    assert_eq!(rows["body"].ints(), (0..100).collect::<Vec<_>>());

    let mut whole = Vec::new();
    bodies.write_vtp(&mut whole, corner).unwrap();
    let whole = read(&whole).1["points"].floats();
    let vectors = |name: &str| -> Vec<Vector> {
        rows[name].floats().chunks_exact(3).map(Vector::from_column_slice).collect()
    };
    let (centres, scales, turns) = (vectors("points"), vectors("scale"), rows["orientation"].floats());
    let mut points = Vec::new();
    for (b, number) in rows["shape"].ints().into_iter().enumerate() {
        let surface = std::fs::read(out.join(format!("bodies/shapes/{number:05}.vtp"))).unwrap();
        let q = nalgebra::Quaternion::new(turns[4 * b], turns[4 * b + 1], turns[4 * b + 2], turns[4 * b + 3]);
        let q = Rotation::from_quaternion(q);
        for p in read(&surface).1["points"].floats().chunks_exact(3) {
            points.extend(<[f64; 3]>::from(
                centres[b] + q * Vector::from_column_slice(p).component_mul(&scales[b]),
            ));
        }
    }
    assert_eq!(points.len(), whole.len());
    let error = points.iter().zip(&whole).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(error < 1e-4, "{error}");
    std::fs::remove_dir_all(&out).unwrap();
}

/// Shapes of bodies that come later have files of their own; a resumed run has the numbers of the
/// first, and a new one removes its files.
#[test]
fn resumed_frames_keep_the_numbers_of_shapes() {
    let out = folder("resumed");
    let mut bodies = RigidBodies::new(Periods::default());
    let shape = rock(1.0);
    (0..30).for_each(|i| add(&mut bodies, &shape, f64::from(i)));
    let mut frames = BodyFrames::new(&out, "bodies").unwrap();
    frames.write(&bodies, Point::origin(), bodies.ids(), 0).unwrap();
    let cube: Arc<dyn Shape> = Arc::new(Cuboid::new([1.0, 1.0, 2.0]).unwrap());
    add(&mut bodies, &cube, 30.0);
    let path = out.join(frames.write(&bodies, Point::origin(), bodies.ids(), 1).unwrap());
    let numbers = |path: &Path| read(&std::fs::read(path).unwrap()).1["shape"].ints();
    assert_eq!(numbers(&path)[29..], [0, 1]);

    // Only cubes and others, whose order alone would make them shape 0.
    let mut rest = RigidBodies::new(Periods::default());
    let plate: Arc<dyn Shape> = Arc::new(Cuboid::new([1.0, 1.0, 0.1]).unwrap());
    for i in 0..6000 {
        add(&mut rest, if i % 2 == 0 { &cube } else { &plate }, f64::from(i));
    }
    let mut frames = BodyFrames::resume(&out, "bodies").unwrap();
    frames.write(&rest, Point::origin(), rest.ids(), 2).unwrap();
    assert_eq!(numbers(&out.join("bodies/00002.vtp"))[..3], [1, 2, 1]);
    BodyFrames::new(&out, "bodies").unwrap();
    assert_eq!(std::fs::read_dir(out.join("bodies/shapes")).unwrap().count(), 0);
    std::fs::remove_dir_all(&out).unwrap();
}
