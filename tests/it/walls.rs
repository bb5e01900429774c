//! Immersed walls at rest: exact and published values. `benches/immersed` has the orders and the costs.
use crate::with_threads;
use example_support::still_bodies::{Banks, Bore, StillBodies};
use siltflow::coupling::{Particles, Simulation, WeightBalance};
use siltflow::dem::{Disc, Material, RigidBodies, Sphere};
use siltflow::flow::{CartesianGrid, Fluid, Projection, Side};
use siltflow::ibm::{SmoothForcing, cut_walls};
use siltflow::interfaces::{BodyId, Freedom, Kinematics, Periods, Pose, Twist, Vector, VelocityField};
use std::f64::consts::PI;

/// Steps until `value` of the flow and its step changes by less than 10⁻⁵ of itself over `interval` \[s\].
fn settle<const D: usize>(
    flow: &mut Projection<D>,
    force: [f64; D],
    interval: f64,
    value: impl Fn(&mut Projection<D>) -> f64,
) -> f64 {
    let mut last = f64::INFINITY;
    for _ in 0..1000 {
        let end = flow.time() + interval;
        while flow.time() < end {
            let dt = flow.stable_dt(0.4);
            flow.advance(dt, force).unwrap();
        }
        let now = value(flow);
        if (now - last).abs() < 1e-5 * now.abs() {
            return now;
        }
        last = now;
    }
    panic!("not steady: {last}");
}

/// Taylor–Couette: u_θ = −r/3 + 1/(12 r) between R 0.25, which turns at 1, and R 0.5; torque 4πμ/12 on both.
#[test]
fn flow_between_cylinders() {
    let (cells, viscosity) = (32, 0.1);
    let half = 0.5 + 2.0 / cells as f64;
    let grid = CartesianGrid::new([cells + 4; 2], [2.0 * half; 2]).unwrap();
    let grid = grid.with_origin([-half + 0.01, -half + 0.007]).unwrap();
    let mut flow = Projection::new(grid, Side::WALL.everywhere(), Fluid { density: 1.0, viscosity }).unwrap();
    let bodies = StillBodies::default().with(Disc::new(0.25).unwrap(), [0.0; 3], 1.0).with(
        Bore { radius: 0.5, half: [2.0 * half; 2] },
        [0.0; 3],
        0.0,
    );
    let walls = cut_walls(flow.velocity(), &bodies).unwrap();
    flow.set_walls(Some(walls)).unwrap();
    let torque = |flow: &mut Projection<2>| flow.wall_impulses()[0].torque.z / flow.last_dt();
    let inner = settle(&mut flow, [0.0; 2], 0.2, torque);
    let outer = flow.wall_impulses()[1].torque.z / flow.last_dt();
    let exact = 4.0 * PI * viscosity / 12.0;
    assert!(
        (inner / exact + 1.0).abs() < 1e-3 && (outer / exact - 1.0).abs() < 1e-3,
        "{inner} {outer} {exact}"
    );
    let lattice = flow.velocity().lattice(0);
    let mut worst = 0.0_f64;
    for at in (0..lattice.shape()[0] * lattice.shape()[1])
        .map(|i| [i % lattice.shape()[0], i / lattice.shape()[0], 0])
    {
        let at = at.map(|i| i as isize);
        let [x, y, _] = lattice.position(at);
        let r = x.hypot(y);
        if (0.25..0.5).contains(&r) {
            let wanted = -y * (-1.0 / 3.0 + 1.0 / (12.0 * r * r));
            worst = worst.max((flow.velocity().component(0)[lattice.index(at).unwrap()] - wanted).abs());
        }
    }
    // The cut-cell code of the reference has 4.5e-3 at this resolution.
    assert!(worst < 1e-3, "{worst}");
}

/// Plane Poiseuille flow at 20° to the grid, ten cells across.
#[test]
fn flow_in_a_turned_channel() {
    let (width, viscosity, h) = (1.0, 0.1, 0.1);
    let slope = 20.0_f64.to_radians();
    let count = [(2.0 / slope.sin() / h).round(), (2.0 / slope.cos() / h).round()];
    let lengths = count.map(|n| n * h);
    let grid = CartesianGrid::new(count.map(|n| n as usize), lengths).unwrap();
    let grid = grid.with_origin(lengths.map(|l| -0.5 * l)).unwrap();
    let fluid = Fluid { density: 1.0, viscosity };
    let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid).unwrap();
    let banks = Banks { lengths, width };
    let [along, _] = banks.axes();
    let length = lengths[0].hypot(lengths[1]);
    let bodies = StillBodies::default().with(banks, [0.012, 0.037, 0.0], 0.0);
    let walls = cut_walls(flow.velocity(), &bodies).unwrap();
    flow.set_walls(Some(walls)).unwrap();
    let rate = |flow: &mut Projection<2>| {
        let total = flow.statistics().volume_flow;
        (total.x * along[0] + total.y * along[1]) / (width * length)
    };
    let force = along.map(|a| a * 12.0 * viscosity / (width * width));
    let mean = settle(&mut flow, force, 0.5, rate);
    assert!((mean - 1.0).abs() < 1e-3, "{mean}");
}

/// A simple-cubic array of spheres: K = F/(6πμaU) is 15.4 at φ 0.343 (Zick & Homsy 1982).
#[test]
fn flow_through_an_array_of_spheres() {
    let radius = (0.343 * 3.0 / (4.0 * PI)).cbrt();
    let grid = CartesianGrid::new([14; 3], [1.0; 3]).unwrap();
    let fluid = Fluid { density: 1.0, viscosity: 1.0 };
    let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid).unwrap();
    let bodies = StillBodies::default().with(Sphere::new(radius).unwrap(), [0.513, 0.487, 0.505], 0.0);
    let walls = cut_walls(flow.velocity(), &bodies).unwrap();
    flow.set_walls(Some(walls)).unwrap();
    let force = 1e-3;
    let speed = settle(&mut flow, [force, 0.0, 0.0], 0.01, |flow| flow.statistics().volume_flow.x);
    let k = force / (6.0 * PI * radius * speed);
    assert!((k / 15.4 - 1.0).abs() < 0.015, "{k}");
    // The sphere bears the force on the box.
    let impulse = flow.wall_impulses()[0].force / flow.last_dt();
    assert!((impulse.x / force - 1.0).abs() < 1e-3 && impulse.yz().norm() < 1e-3 * force, "{impulse}");
}

/// Two channels' worth of cut faces, one solved by a dense product and one by conjugate gradients: neither allocates, and the
/// number of threads changes no bit.
#[test]
fn steps_beside_walls_allocate_nothing() {
    for radius in [0.1, 0.45] {
        let run = |threads: usize| {
            with_threads(threads, || {
                let grid = CartesianGrid::new([40, 40], [1.0, 1.0]).unwrap();
                let fluid = Fluid { density: 1.0, viscosity: 0.01 };
                let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid).unwrap();
                let bodies = StillBodies::default().with(Disc::new(radius).unwrap(), [0.5, 0.5, 0.0], 0.3);
                let walls = cut_walls(flow.velocity(), &bodies).unwrap();
                flow.set_walls(Some(walls)).unwrap();
                let mut steps = |n| (0..n).for_each(|_| flow.advance(5e-3, [0.1, 0.02]).unwrap());
                steps(10);
                let count = allocation_counter::measure(|| steps(10)).count_total;
                assert_eq!(flow.pressure_info().iterations > 0, radius > 0.3);
                let bits: Vec<u64> = flow.velocity().component(0).iter().map(|u| u.to_bits()).collect();
                (count, bits)
            })
        };
        let [(one, first), (two, second)] = [run(1), run(2)];
        assert_eq!((one, two), (0, 0), "radius {radius}");
        assert!(first == second, "radius {radius}");
    }
}

/// A wall at rest and a body that moves in one scene: the body falls, the wall stands and feels it.
#[test]
fn walls_and_moving_bodies_meet_in_one_flow() {
    let fluid = Fluid { density: 1000.0, viscosity: 1e-5 };
    let grid = CartesianGrid::new([60, 60], [6e-3, 6e-3]).unwrap();
    let mut flow = Projection::new(grid, Side::WALL.everywhere(), fluid).unwrap();
    let post = StillBodies::default().with(Disc::new(0.7e-3).unwrap(), [2.2e-3, 1.8e-3, 0.0], 0.0);
    let walls = cut_walls(flow.velocity(), &post).unwrap();
    flow.set_walls(Some(walls)).unwrap();
    let mut bodies = RigidBodies::new(Periods::new([None; 3]));
    let material =
        Material { density: 2000.0, youngs_modulus: 1e6, poisson_ratio: 0.3, damping: 1.0, friction: 0.0 };
    let start = Pose::at([2.9e-3, 4.5e-3, 0.0]);
    bodies.add(Disc::new(0.5e-3).unwrap(), material, start, Twist::default(), Freedom::PLANAR).unwrap();
    let gravity = Vector::new(0.0, -9.81, 0.0);
    let particles = Particles::new(bodies, SmoothForcing::new(1000.0), 1000.0, gravity);
    let mut simulation = Simulation::new(flow, particles, WeightBalance::None).unwrap();
    for _ in 0..300 {
        simulation.step(1e-4).unwrap();
    }
    let twist = simulation.particles.bodies.twist(BodyId(0));
    assert!(twist.linear.y < -0.01, "{twist:?}");
    // The fluid between them pushes the post down.
    let push = simulation.flow.wall_impulses()[0].force;
    assert!(push.y < 0.0, "{push}");
    let lattice = simulation.flow.velocity().lattice(1);
    let (inside, _) = lattice.locate([2.2e-3, 1.8e-3, 0.0].into());
    assert_eq!(simulation.flow.velocity().component(1)[lattice.index(inside).unwrap()], 0.0);
}
