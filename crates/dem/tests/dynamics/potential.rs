//! The law with a potential: energy, restitution, rest.
use super::*;
use dem::{ConvexPolyhedron, Cuboid, Cylinder, HalfSpace, Part, Potential, TriangleMesh, Union};
use interfaces::{Dynamics, Point, Rotation};

type Conservative = RigidBodies<Potential>;

fn material(restitution: f64) -> Material {
    Material { restitution, friction: 0.0, youngs_modulus: 1e7, ..Material::default() }
}
fn cube() -> Arc<dyn Shape> {
    Arc::new(Cuboid::new([2.0 * R; 3]).unwrap())
}
fn octahedron() -> Arc<dyn Shape> {
    let points = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let points: Vec<_> = points.iter().flat_map(|p| [p.map(|x| x * R), p.map(|x| -x * R)]).collect();
    Arc::new(ConvexPolyhedron::from_points(&points).unwrap())
}
/// The turn that brings the body's direction `d` to −x.
fn facing(d: [f64; 3]) -> Rotation {
    Rotation::rotation_between(&Vector::from(d), &-Vector::x())
        .unwrap_or(Rotation::from_axis_angle(&Vector::z_axis(), std::f64::consts::PI))
}
fn run_until_apart(bodies: &mut Conservative, dt: f64, gap: impl Fn(&Conservative) -> f64) {
    let mut touched = false;
    for _ in 0..2_000_000 {
        bodies.advance(dt).unwrap();
        touched |= bodies.n_contacts() > 0;
        if touched && bodies.n_contacts() == 0 && gap(bodies) > 0.0 {
            return;
        }
    }
    panic!("they did not part");
}

/// What is asked for is delivered, whatever the shape, the speed and the partner, at the automatic step: free, immovable, a wall.
#[test]
fn restitution_is_what_was_asked_for() {
    let ball: Arc<dyn Shape> = sphere().shape();
    // A shape, and the direction in which it meets its partner: face, edge, corner first.
    let cases = [
        ("sphere", ball, [1.0, 0.0, 0.0]),
        ("cube's face", cube(), [1.0, 0.0, 0.0]),
        ("cube's edge", cube(), [1.0, 1.0, 0.0]),
        ("cube's corner", cube(), [1.0, 1.0, 1.0]),
        ("octahedron's face", octahedron(), [1.0, 1.0, 1.0]),
        ("octahedron's corner", octahedron(), [0.0, 0.0, 1.0]),
    ];
    let mut worst = 0.0_f64;
    for (name, shape, direction) in &cases {
        for e in [0.06, 0.2, 0.37, 0.5, 0.8, 0.95] {
            for speed in [0.01, 0.1] {
                for partner in ["free", "immovable", "wall"] {
                    let reach = shape.bounding_radius();
                    let mut bodies = Conservative::with_law(Periods::default(), Potential::default());
                    let at =
                        |x: f64| Pose { position: Point::new(x, 0.0, 0.0), orientation: facing(*direction) };
                    let towards = moving([-speed, 0.0, 0.0], [0.0; 3]);
                    let m = material(e);
                    let b = bodies.add(shape.clone(), m, at(2.001 * reach), towards, Freedom::FREE).unwrap();
                    match partner {
                        "wall" => {
                            bodies
                                .add_wall(HalfSpace::new(Point::origin(), Vector::x()).unwrap(), m)
                                .unwrap();
                        }
                        _ => {
                            let freedom = if partner == "free" { Freedom::FREE } else { Freedom::NONE };
                            // All these shapes are the same seen from the other side.
                            let other = Pose { position: Point::origin(), ..at(0.0) };
                            bodies.add(shape.clone(), m, other, Twist::default(), freedom).unwrap();
                        }
                    }
                    let dt = bodies.stable_dt();
                    run_until_apart(&mut bodies, dt, |_| 1.0);
                    // Energetic: the centre of mass keeps its quarter of the energy of two equal bodies, twice; corners may begin to turn.
                    let mass = bodies.inertia(b).mass;
                    let kept = if partner == "free" { 0.25 * mass * speed * speed } else { 0.0 };
                    let before = 0.5 * mass * speed * speed - kept;
                    let delivered = ((bodies.kinetic_energy() - kept) / before).sqrt();
                    let off = delivered - e;
                    worst = worst.max(off.abs());
                    if off.abs() >= 2e-4 {
                        println!("{name} at {speed} m/s, {partner}: e {delivered:.5} for {e}");
                    }
                }
            }
        }
    }
    println!("largest error of restitution: {worst:.2e}");
    assert!(worst < 4e-4);
}

/// A ball that meets the tip of a rod, which turns away: the places that touched part with e times the speed at which they met.
#[test]
fn restitution_off_centre() {
    for e in [0.2, 0.5, 0.8, 1.0] {
        let mut bodies = Conservative::with_law(Periods::default(), Potential::default());
        let m = material(e);
        let rod = Cuboid::new([0.5 * R, 20.0 * R, 0.5 * R]).unwrap();
        let rod = bodies.add(rod, m, Pose::at([0.0; 3]), Twist::default(), Freedom::FREE).unwrap();
        let arm = Vector::new(0.25 * R, 9.0 * R, 0.0);
        let start = Pose::at([1.255 * R, 9.0 * R, 0.0]);
        let thrown = moving([-0.1, 0.0, 0.0], [0.0; 3]);
        let b = bodies.add(sphere().shape(), m, start, thrown, Freedom::FREE).unwrap();
        let dt = bodies.stable_dt();
        run_until_apart(&mut bodies, dt, |_| 1.0);
        let apart = bodies.twist(b).linear.x - bodies.twist(rod).at(arm).x;
        let off = apart / (0.1 * e) - 1.0;
        println!("e {e}: off by {off:.1e}");
        assert!(off.abs() < 2e-3, "{off}");
        assert!(bodies.twist(rod).angular.z.abs() * 9.0 * R > 0.02);
    }
}

/// Cubes that meet anyhow keep their energy; so little is lost that it is the time step's error, of high order.
#[test]
fn cubes_keep_energy() {
    let rebound = |seed: u32, parts: f64| {
        let number = |k: u32| f64::from((seed * 7919 + k * 104_729) % 1000) / 1000.0 - 0.5;
        let mut bodies = Conservative::with_law(Periods::default(), Potential::default());
        let m = material(1.0);
        for (k, side) in [(0, -1.0), (10, 1.0)] {
            let turned = Vector::new(number(k), number(k + 1), number(k + 2)) * 6.0;
            let pose = Pose {
                position: Point::new(side * 1.75 * R, side * 0.3 * R * number(k + 3), 0.0),
                orientation: Rotation::from_scaled_axis(turned),
            };
            let spin = [number(k + 4) * 20.0, number(k + 5) * 20.0, number(k + 6) * 20.0];
            bodies.add(cube(), m, pose, moving([-0.5 * side, 0.0, 0.0], spin), Freedom::FREE).unwrap();
        }
        let before = bodies.kinetic_energy();
        let (p0, l0) = momenta(&bodies);
        let dt = bodies.stable_dt() / parts;
        run_until_apart(&mut bodies, dt, |b| {
            (b.pose(BodyId(1)).position - b.pose(BodyId(0)).position).norm() - 3.0 * R
        });
        let (p1, l1) = momenta(&bodies);
        let mass = bodies.inertia(BodyId(0)).mass;
        assert!(
            (p1 - p0).norm() < 1e-11 * mass && (l1 - l0).norm() < 1e-10 * mass * R,
            "{}",
            (l1 - l0).norm() / (mass * R)
        );
        (bodies.kinetic_energy() / before - 1.0).abs()
    };
    let [automatic, finer] = [1.0, 4.0].map(|parts| {
        let mut all: Vec<_> = (0..100).map(|seed| rebound(seed, parts)).collect();
        all.sort_by(f64::total_cmp);
        let (median, worst) = (all[50], all[99]);
        println!("automatic step / {parts}: |dE|/E median {median:.1e}, largest {worst:.1e}");
        worst
    });
    assert!(automatic < 1e-8 && finer < 0.1 * automatic);
}

/// Cubes lie on one another: contact k carries k of them, however little they give back when they fall, and the forces do not flicker.
#[test]
fn a_stack_of_cubes_rests() {
    for e in [0.1, 0.5, 0.9] {
        let m = Material { restitution: e, friction: 0.5, ..material(e) };
        let mut bodies = Conservative::with_law(Periods::default(), Potential::default());
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), m).unwrap();
        bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
        for k in 0..10 {
            let at = [0.02 * R * f64::from(k).sin(), 0.0, R * (1.0 + 2.0 * f64::from(k))];
            bodies.add(cube(), m, Pose::at(at), Twist::default(), Freedom::FREE).unwrap();
        }
        bodies.advance(0.15).unwrap();
        let weight = 9.81 * bodies.inertia(BodyId(0)).mass;
        let mut off = 0.0_f64;
        for _ in 0..10 {
            bodies.advance(1e-4).unwrap();
            let mut carried: Vec<_> = bodies.contacts().map(|c| c.force.z.abs() / weight).collect();
            carried.sort_by(f64::total_cmp);
            assert_eq!(carried.len(), 10);
            off = carried.iter().zip(1..).map(|(c, k)| (c - f64::from(k)).abs()).fold(off, f64::max);
        }
        println!("e {e}: largest error of a contact's force {off:.1e} of a cube's weight");
        assert!(off < 0.05);
    }
}

/// A cube of triangles, one of two halves, and an upright cylinder: their faces are flat, too, and lie on a hard floor without ever smaller
/// steps.
#[test]
fn whatever_is_flat_rests() {
    let vertices =
        [0, 1, 2, 3, 4, 5, 6, 7].map(|i| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -R } else { R }));
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let faces: Vec<[u32; 3]> =
        sides.iter().flat_map(|s: &[u32; 4]| [[s[0], s[2], s[1]], [s[0], s[3], s[2]]]).collect();
    let half: Arc<dyn Shape> = Arc::new(Cuboid::new([R, 2.0 * R, 2.0 * R]).unwrap());
    let half_at = |x: f64| Part { shape: half.clone(), pose: Pose::at([x, 0.0, 0.0]) };
    let shapes: [Arc<dyn Shape>; 3] = [
        Arc::new(TriangleMesh::new(&vertices, &faces).unwrap()),
        Arc::new(Union::new(vec![half_at(-0.5 * R), half_at(0.5 * R)]).unwrap()),
        Arc::new(Cylinder::new(R, 2.0 * R).unwrap()),
    ];
    for shape in shapes {
        let m = Material { restitution: 0.5, friction: 0.5, youngs_modulus: 1e8, ..material(0.5) };
        let mut bodies = Conservative::with_law(Periods::default(), Potential::default());
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z()).unwrap(), m).unwrap();
        bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
        let upright = Pose::at([0.0, 0.0, R]);
        let b = bodies.add(shape.clone(), m, upright, Twist::default(), Freedom::FREE).unwrap();
        bodies.advance(0.05).unwrap();
        let sub_steps = bodies.overlap_calls() as f64 * bodies.stable_dt() / 0.05;
        let carried: f64 = bodies.contacts().map(|c| c.force.z).sum();
        let off = (carried / (9.81 * bodies.inertia(b).mass) - 1.0).abs();
        println!(
            "{}: {sub_steps:.1} times as many sub-steps as by stable_dt, force off by {off:.1e}",
            shape.name()
        );
        assert!(sub_steps < 50.0 && off < 1e-2);
    }
}

/// A gas of a thousand elastic spheres in a periodic box keeps its energy and momentum.
#[test]
fn a_gas_keeps_energy() {
    let n = 6;
    let spacing = 3.0 * R;
    let mut bodies =
        Conservative::with_law(Periods::new([Some(f64::from(n) * spacing); 3]), Potential::default());
    let mut seed = 12345_u64;
    let mut number = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    for i in 0..n * n * n {
        let place = [i % n, i / n % n, i / (n * n)].map(|k| f64::from(k) * spacing);
        let twist = moving([number(), number(), number()], [0.0; 3]);
        bodies.add(sphere().shape(), material(1.0), Pose::at(place), twist, Freedom::FREE).unwrap();
    }
    let start = bodies.kinetic_energy();
    let (p0, _) = momenta(&bodies);
    let dt = bodies.stable_dt();
    // Means over some time: at every instant it is off by what the leapfrog's energy is off within contacts.
    let mut worst = 0.0_f64;
    for _ in 0..10 {
        let mut mean = 0.0;
        for _ in 0..300 {
            bodies.advance(dt).unwrap();
            mean += (bodies.kinetic_energy() + bodies.elastic_energy().unwrap()) / 300.0;
        }
        worst = worst.max((mean / start - 1.0).abs());
    }
    let (p1, _) = momenta(&bodies);
    let total: f64 = bodies.ids().map(|b| bodies.inertia(b).mass * bodies.twist(b).linear.norm()).sum();
    println!("largest |dE|/E {worst:.2e}, momentum {:.1e} of all", (p1 - p0).norm() / total);
    assert!(worst < 1e-4 && (p1 - p0).norm() < 1e-13 * total);
}
