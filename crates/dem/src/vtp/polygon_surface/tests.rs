//! Surfaces against the shapes that they are surfaces of.
use super::*;
use crate::shapes::icosphere;
use crate::{Capsule, Cuboid, Cylinder, Disc, Ellipsoid, HalfSpace, Implicit, Sphere, Union};
use interfaces::{Aabb, Pose, Rotation, Solid};
use std::collections::HashMap;

struct Torus;
impl Solid for Torus {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        (x.x.hypot(x.y) - 0.7).hypot(x.z) - 0.3
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(1.0, 1.0, 0.3))
    }
}

fn solids() -> Vec<Arc<dyn Shape>> {
    let (vertices, faces) = icosphere(2.0, 1);
    let faces: Vec<Vec<u32>> = faces.iter().map(|f| f.to_vec()).collect();
    let turned = Pose {
        position: Point::new(3.0, 1.0, 0.0),
        orientation: Rotation::from_scaled_axis(Vector::new(0.3, 0.5, -1.0)),
    };
    let parts = vec![
        Part { shape: Arc::new(Cuboid::new([1.0, 2.0, 3.0]).unwrap()), pose: Pose::at([0.0; 3]) },
        Part { shape: Arc::new(Cylinder::new(0.5, 2.0).unwrap()), pose: turned },
    ];
    vec![
        Arc::new(Sphere::new(0.3).unwrap()),
        Arc::new(Ellipsoid::new([1.0, 2.0, 0.5]).unwrap()),
        Arc::new(Capsule::new(0.4, 1.5).unwrap()),
        Arc::new(Cylinder::new(0.4, 0.3).unwrap()),
        Arc::new(Cuboid::new([1.0, 2.0, 3.0]).unwrap()),
        Arc::new(ConvexPolyhedron::new(&vertices, &faces).unwrap()),
        Arc::new(Union::new(parts).unwrap()),
        Arc::new(Implicit::new("torus", Torus, 1e-4).unwrap()),
    ]
}

fn polygons(surface: &PolygonSurface) -> impl Iterator<Item = &[usize]> {
    let starts = std::iter::once(0).chain(surface.ends.iter().copied());
    starts.zip(&surface.ends).map(|(start, &end)| &surface.corners[start..end])
}

fn volume(own: &ScaledSurface) -> f64 {
    let points: Vec<Vector> = own.points().collect();
    let fan = |p: &[usize]| -> f64 {
        let corner = |i: usize| points[p[i]];
        (2..p.len()).map(|i| corner(0).dot(&corner(i - 1).cross(&corner(i))) / 6.0).sum()
    };
    polygons(&own.surface).map(fan).sum()
}

/// Every edge has one polygon on either side, and volumes are those of the shapes, positive, within
/// the chords.
#[test]
fn surfaces_are_closed_and_outward() {
    for shape in solids() {
        let own = ScaledSurface::of(&*shape);
        let mut edges: HashMap<[usize; 2], i32> = HashMap::new();
        for polygon in polygons(&own.surface) {
            assert!(polygon.len() >= 3);
            for i in 0..polygon.len() {
                let (a, b) = (polygon[i], polygon[(i + 1) % polygon.len()]);
                assert_ne!(a, b);
                *edges.entry([a, b]).or_default() += 1;
            }
        }
        let name = shape.name();
        assert!(edges.iter().all(|([a, b], n)| *n == 1 && edges.get(&[*b, *a]) == Some(&1)), "{name}");
        let used: std::collections::HashSet<_> = own.surface.corners.iter().collect();
        assert_eq!(used.len(), own.surface.points.len(), "{name}");
        let ratio = volume(&own) / shape.inertia(1.0).volume;
        let exact = matches!(shape.form(), Form::Hull(_));
        // Chords are 2/3 of 0.5 % within the surface on average, along meridians and along
        // parallels.
        let least = if exact { 1.0 - 1e-12 } else { 0.98 };
        assert!((least..=1.0 + 1e-12).contains(&ratio), "{name} {ratio}");
    }
}

/// Corners are on the shape, and the middles of edges up to 1 − cos(π/32) of the radius within it.
#[test]
fn chords_depart_from_round_shapes_by_half_a_percent() {
    for (shape, radius) in [(solids()[0].clone(), 0.3), (solids()[2].clone(), 0.4)] {
        let own = ScaledSurface::of(&*shape);
        let points: Vec<Vector> = own.points().collect();
        let distance = |x: Vector| shape.signed_distance(Point::from(x), f64::INFINITY);
        assert!(points.iter().all(|p| distance(*p).abs() < 1e-12), "{}", shape.name());
        let sides = |p: &[usize]| {
            (0..p.len()).map(|i| 0.5 * (points[p[i]] + points[p[(i + 1) % p.len()]])).collect::<Vec<_>>()
        };
        let deepest = polygons(&own.surface).flat_map(sides).map(distance).fold(0.0, f64::min);
        assert!((0.004..0.005).contains(&(-deepest / radius)), "{} {}", shape.name(), deepest / radius);
    }
}

/// The torus is within its cells' curvature of the surface, wherever its own cells lie.
#[test]
fn marching_tetrahedra_are_of_second_order() {
    let depth = |cells: usize| {
        let surface = marching_tetrahedra(&Torus, cells);
        surface.points.iter().map(|p| Torus.signed_distance(*p, 1.0).abs()).fold(0.0, f64::max)
    };
    let [coarse, fine] = [depth(16), depth(32)];
    // Edges are up to √3/16 long, and the tube's radius is 0.3.
    assert!(fine < 3.0 / 256.0 / 8.0 / 0.3 && fine > 0.0, "{fine}");
    assert!((3.0..6.0).contains(&(coarse / fine)), "{coarse} {fine}");
}

/// Spheres and ellipsoids share a surface, so do cylinders.
#[test]
fn affine_copies_share_a_surface() {
    let (ball, egg) = (Sphere::new(2.0).unwrap(), Ellipsoid::new([1.0, 2.0, 3.0]).unwrap());
    let [ball, egg] = [ScaledSurface::of(&ball), ScaledSurface::of(&egg)];
    assert!(Arc::ptr_eq(&ball.surface, &egg.surface));
    assert_eq!(egg.scale, Vector::new(1.0, 2.0, 3.0));
    let [rod, plate] =
        [(0.1, 3.0), (2.0, 0.5)].map(|(r, l)| ScaledSurface::of(&Cylinder::new(r, l).unwrap()));
    assert!(Arc::ptr_eq(&rod.surface, &plate.surface));
    assert_eq!(plate.scale, Vector::new(2.0, 2.0, 0.25));
}

/// Discs are polygons with a mark, concave polygons convex pieces; half-spaces have no surface.
#[test]
fn plane_shapes() {
    let disc = ScaledSurface::of(&Disc::new(0.5).unwrap());
    assert_eq!((disc.surface.ends.as_slice(), disc.surface.lines.len()), ([EDGES].as_slice(), 1));
    let [centre, rim] = disc.surface.lines[0].map(|i| disc.points().nth(i).unwrap());
    assert_eq!((centre, rim), (Vector::zeros(), Vector::x() * 0.5));

    let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let angle = ScaledSurface::of(&Polygon::new(&corners).unwrap());
    assert_eq!(angle.surface.points.len(), 6);
    let points: Vec<Vector> = angle.points().collect();
    let mut area = 0.0;
    for polygon in polygons(&angle.surface) {
        for i in 0..polygon.len() {
            let [a, b, c] = [0, 1, 2].map(|k| points[polygon[(i + k) % polygon.len()]]);
            assert!((b - a).cross(&(c - b)).z >= -1e-14, "convex, counter-clockwise");
            area += 0.5 * a.cross(&b).z;
        }
    }
    assert!((area - 3.0).abs() < 1e-14);

    let wall = HalfSpace::new(Point::origin(), Vector::z()).unwrap();
    assert!(ScaledSurface::of(&wall).surface.points.is_empty());
}
