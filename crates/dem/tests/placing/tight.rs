//! Tight placing: bodies that are not round come as near as their surfaces allow, and no nearer.
use dem::placing::{Orientations, PlacingError, RandomAddition, Region};
use dem::{Capsule, ConvexPolyhedron, Cuboid, Cylinder, Ellipsoid, Implicit, OverlapSolver, Shape, Sphere};
use interfaces::{Aabb, Point, Pose, Rotation, Solid, Vector};

/// A ring, known by its distance only.
#[derive(Clone, Copy)]
struct Ring;
impl Solid for Ring {
    fn signed_distance(&self, x: Point, _band: f64) -> f64 {
        (x.x.hypot(x.y) - 0.12).hypot(x.z) - 0.03
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(0.15, 0.15, 0.03))
    }
}

/// Points all over a body's surface.
fn points(shape: &dyn Shape) -> Vec<Point> {
    let r = shape.bounding_radius();
    if let Some(surface) = shape.polyhedron() {
        // Corners, and points along all edges of the triangles.
        let v = |i: u32| surface.vertices[i as usize];
        let along = |f: &[u32; 3]| {
            let pairs = [(f[0], f[1]), (f[1], f[2]), (f[2], f[0])];
            pairs.map(|(a, b)| (0..=10).map(move |k| v(a) + (v(b) - v(a)) * (f64::from(k) / 10.0)))
        };
        return surface.faces.iter().flat_map(along).flatten().collect();
    }
    let surface = shape.surface(0.06 * r, 0.0).unwrap();
    surface.into_iter().map(|e| e.point).collect()
}
/// Smallest distance of the points of one body's surface to another body, over all images, and to the box's walls; and how many pairs
/// stand nearer than the spheres around them would let them.
fn least_gap(bodies: &[&dyn Shape], poses: &[Pose], space: &Aabb, periodic: [bool; 3]) -> (f64, usize) {
    let extent = space.extent();
    let surfaces: Vec<Vec<Point>> = bodies.iter().map(|b| points(*b)).collect();
    let range = |a: usize| if periodic[a] { -1..=1 } else { 0..=0 };
    let (mut least, mut tight) = (f64::INFINITY, 0);
    for (i, p) in poses.iter().enumerate() {
        for x in &surfaces[i] {
            let x = p.to_world(*x);
            for a in (0..3).filter(|&a| !periodic[a]) {
                least = least.min(x[a] - space.min[a]).min(space.max[a] - x[a]);
            }
        }
        for (j, q) in poses.iter().enumerate() {
            for k in range(2) {
                for m in range(1) {
                    for n in range(0) {
                        let shift =
                            Vector::new(f64::from(n), f64::from(m), f64::from(k)).component_mul(&extent);
                        let reach = bodies[i].bounding_radius() + bodies[j].bounding_radius();
                        let moved = Pose { position: p.position + shift, ..*p };
                        if (i == j && shift == Vector::zeros())
                            || (moved.position - q.position).norm() > reach + 0.02
                        {
                            continue;
                        }
                        tight += usize::from((moved.position - q.position).norm() < reach);
                        for x in &surfaces[i] {
                            least = least.min(bodies[j].signed_distance(q.to_body(moved.to_world(*x)), 1.0));
                        }
                    }
                }
            }
        }
    }
    (least, tight)
}
/// Whether any two bodies share volume, over all images.
fn overlapping(bodies: &[&dyn Shape], poses: &[Pose], extent: Vector, periodic: [bool; 3]) -> bool {
    let mut solver = OverlapSolver::new();
    let range = |a: usize| if periodic[a] { -1..=1 } else { 0..=0 };
    for (i, p) in poses.iter().enumerate() {
        for (j, q) in poses.iter().enumerate().take(i) {
            for k in range(2) {
                for m in range(1) {
                    for n in range(0) {
                        let shift =
                            Vector::new(f64::from(n), f64::from(m), f64::from(k)).component_mul(&extent);
                        let moved = Pose { position: p.position + shift, ..*p };
                        if !solver.solve(bodies[i], &moved, bodies[j], q).unwrap().is_empty() {
                            return true;
                        }
                    }
                }
            }
        }
    }
    false
}

#[test]
fn bodies_of_all_kinds_interlock_without_overlap() {
    let rod = Capsule::new(0.03, 0.25).unwrap();
    let brick = Cuboid::new([0.24, 0.12, 0.06]).unwrap();
    let egg = Ellipsoid::new([0.15, 0.05, 0.08]).unwrap();
    let can = Cylinder::new(0.05, 0.22).unwrap();
    let wedge = ConvexPolyhedron::from_points(&[
        [0.0; 3],
        [0.2, 0.0, 0.0],
        [0.0, 0.2, 0.0],
        [0.0, 0.0, 0.2],
        [0.2, 0.0, 0.1],
    ])
    .unwrap();
    let ball = Sphere::new(0.07).unwrap();
    let kinds: [&dyn Shape; 6] = [&rod, &brick, &egg, &can, &wedge, &ball];
    let bodies: Vec<&dyn Shape> = kinds.iter().cycle().take(66).copied().collect();
    let space = Aabb { min: [0.0; 3].into(), max: [0.75, 0.8, 0.85].into() };
    for (periodic, gap) in
        [([true; 3], 0.0), ([true; 3], 0.008), ([false, true, false], 0.0), ([false; 3], 0.008)]
    {
        let place = || {
            let region = Region::cuboid(space, periodic).unwrap();
            RandomAddition::new(region).with_gap(gap).unwrap().tight().place(&bodies, 11)
        };
        let poses = place().unwrap();
        assert_eq!(poses, place().unwrap());
        assert!(!overlapping(&bodies, &poses, space.extent(), periodic));
        let (least, tight) = least_gap(&bodies, &poses, &space, periodic);
        assert!(least > gap - 1e-6 && least < gap + 0.01, "{periodic:?} {gap}: {least}");
        assert!(tight > 100, "{tight}");
    }
}

#[test]
fn rings_by_their_distance_only() {
    let ring = Implicit::new("ring", Ring, 1e-3).unwrap();
    let ball = Sphere::new(0.05).unwrap();
    let mut bodies = vec![&ring as &dyn Shape; 20];
    bodies.extend(vec![&ball as &dyn Shape; 20]);
    let space = Aabb { min: [0.0; 3].into(), max: [0.62; 3].into() };
    for gap in [0.0, 0.004] {
        let region = Region::cuboid(space, [true; 3]).unwrap();
        let poses = RandomAddition::new(region).with_gap(gap).unwrap().tight().place(&bodies, 5).unwrap();
        // Points on circles of the ring, against distances.
        let on_ring: Vec<Point> = (0..120)
            .flat_map(|i| {
                (0..24).map(move |j| {
                    let (s, c) = (std::f64::consts::TAU * f64::from(i) / 120.0).sin_cos();
                    let (t, u) = (std::f64::consts::TAU * f64::from(j) / 24.0).sin_cos();
                    let r = 0.12 + 0.03 * u;
                    Point::new(r * c, r * s, 0.03 * t)
                })
            })
            .collect();
        let (mut least, mut within) = (f64::INFINITY, 0);
        for p in &poses[..20] {
            for (j, q) in poses.iter().enumerate() {
                for x in &on_ring {
                    let mut d = p.to_world(*x) - q.position;
                    d.apply(|c| *c -= 0.62 * (*c / 0.62).round());
                    if std::ptr::eq(p, q) {
                        continue;
                    }
                    let x = q.orientation.inverse_transform_vector(&d);
                    least = least.min(bodies[j].signed_distance(Point::from(x), 1.0));
                }
                let mut d = p.position - q.position;
                d.apply(|c| *c -= 0.62 * (*c / 0.62).round());
                within += usize::from(d.norm() < bodies[j].bounding_radius() && !std::ptr::eq(p, q));
            }
        }
        assert!(least > gap - 1e-9 && within > 0, "{gap} {least} {within}");
    }
}

#[test]
fn tight_bodies_are_wholly_within_their_container() {
    let rod = Capsule::new(0.05, 0.5).unwrap();
    let brick = Cuboid::new([0.5, 0.2, 0.15]).unwrap();
    let mut bodies = vec![&rod as &dyn Shape; 7];
    bodies.extend(vec![&brick as &dyn Shape; 6]);
    let at =
        Pose { position: Point::new(1.0, 2.0, 3.0), orientation: Rotation::from_euler_angles(0.5, 0.6, 0.7) };
    let drum = Cylinder::new(0.7, 1.2).unwrap();
    let post = Cuboid::new([0.1, 0.1, 3.0]).unwrap();
    for gap in [0.0, 0.02] {
        let region = Region::cylinder(0.7, 1.2, at).unwrap();
        let adding = RandomAddition::new(region).with_gap(gap).unwrap().tight().with_obstacle(&post, at);
        let poses = adding.place(&bodies, 3).unwrap();
        let (mut wall, mut pole, mut outside) = (f64::INFINITY, f64::INFINITY, 0);
        for (body, pose) in bodies.iter().zip(&poses) {
            for x in points(*body) {
                let x = at.to_body(pose.to_world(x));
                wall = wall.min(-drum.signed_distance(x, 1.0));
                pole = pole.min(post.signed_distance(x, 1.0));
            }
            let d = drum.signed_distance(at.to_body(pose.position), 2.0);
            outside += usize::from(d > -body.bounding_radius());
        }
        assert!(wall > gap - 1e-9 && pole > gap - 1e-9, "{gap}: {wall} {pole}");
        assert!(outside > 3, "{outside}");
    }
}

/// Rods longer than the box is wide fit if they lie along it.
#[test]
fn a_slender_body_finds_the_way_in_which_it_fits() {
    let rod = Capsule::new(0.02, 0.8).unwrap();
    let space = Aabb { min: [0.0; 3].into(), max: [0.3, 0.3, 1.0].into() };
    let region = || Region::cuboid(space, [false; 3]).unwrap();
    let loose = RandomAddition::new(region()).place(&[&rod], 1);
    assert!(matches!(loose, Err(PlacingError::TooLarge { axis: 0, .. })));
    let poses = RandomAddition::new(region()).tight().place(&[&rod; 6].map(|r| r as &dyn Shape), 1).unwrap();
    let upright = Orientations::Fixed(Rotation::identity());
    let fixed = RandomAddition::new(region())
        .tight()
        .with_orientations(upright)
        .place(&[&rod; 30].map(|r| r as &dyn Shape), 1)
        .unwrap();
    for pose in poses.iter().chain(&fixed) {
        for end in [-0.4, 0.4] {
            let x = pose.to_world(Point::new(0.0, 0.0, end));
            assert!((0..3).all(|a| x[a] >= 0.02 - 1e-12 && x[a] <= space.max[a] - 0.02 + 1e-12));
        }
    }
}
