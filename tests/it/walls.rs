//! Immersed walls at rest: exact and published values. `benches/immersed` has the orders and the costs.
use crate::with_threads;
use siltflow::coupling::{Particles, Simulation, WeightBalance};
use siltflow::dem::{Disc, Material, Polygon, RigidBodies, Sphere};
use siltflow::flow::{CartesianGrid, Fluid, Profile, Projection, Side};
use siltflow::ibm::{SmoothForcing, StaticBodies, cut_walls};
use siltflow::interfaces::{
    BodyId, Freedom, Kinematics, Periods, Pose, Rotation, Solid, Twist, Vector, VelocityField,
};
use validation::eccentric_cylinders::EccentricCylinders;
use validation::prescribed_bodies::PrescribedBodies;
use validation::unfolded::Unfolded;
use validation::walled_flows::{
    COUETTE_TORQUE, ForcedChannel, SphereArray, TurnedChannel, couette, couette_velocity, put_walls, settle,
    surface_loads, velocity_errors,
};

/// Flows are steady when they change by less than this part.
const STEADY: f64 = 1e-5;

/// Taylor–Couette flow at 32 cells per unit of length. Measured: 0.02 % and 5e-4; the cut-cell code of the reference has 4.5e-3.
#[test]
fn flow_between_cylinders() {
    let (mut flow, bodies) = couette(32, [0.083, 0.131]).unwrap();
    let torque = |flow: &mut Projection<2>| flow.wall_impulses()[0].torque.z / flow.last_dt();
    let inner = settle(&mut flow, [0.0; 2], [0.2, STEADY], torque).unwrap();
    let outer = flow.wall_impulses()[1].torque.z / flow.last_dt();
    for error in [inner / COUETTE_TORQUE + 1.0, outer / COUETTE_TORQUE - 1.0] {
        assert!(error.abs() < 5e-4, "{inner} {outer}");
    }
    // The stress on the surfaces, eight cells from wall to wall, tells the same. Measured: −1.8 and 0.2 %.
    for (b, torque, tolerance) in [(0, -COUETTE_TORQUE, 0.02), (1, COUETTE_TORQUE, 0.004)] {
        let found = surface_loads(&flow, &bodies, b, 0.0).unwrap().total().torque.z;
        assert!((found / torque - 1.0).abs() < tolerance, "{found} {torque}");
    }
    let [worst, rms] = velocity_errors(&flow, couette_velocity);
    assert!(worst < 7e-4 && rms < 2e-4, "{worst} {rms}");
    // dp/dr = ρ u_θ²/r, a rise by 0.0136 Pa. Measured: 0.003 Pa where the centre of a cell is in the fluid. In slivers, where
    // almost nothing flows, the pressure means little, but has to stay bounded (1.6 Pa if it is left to itself).
    let grid = flow.grid();
    let half = 0.5 * grid.spacing()[0];
    let mut errors = Vec::new();
    for (cell, p) in flow.pressure().values().enumerate() {
        let [x, y] = grid.centre(grid.cell(cell));
        let r = x.hypot(y);
        let exact = r * r / 18.0 - r.ln() / 18.0 - 1.0 / (288.0 * r * r);
        let corners = [[-half, -half], [half, -half], [-half, half], [half, half]];
        if corners.iter().any(|c| in_the_gap((x + c[0]).hypot(y + c[1]))) {
            errors.push((in_the_gap(r), p - exact));
        }
    }
    let mean = errors.iter().map(|e| e.1).sum::<f64>() / errors.len() as f64;
    let most =
        |of: bool| errors.iter().filter(|e| e.0 == of).fold(0.0, |most: f64, e| most.max((e.1 - mean).abs()));
    let [inside, slivers] = [most(true), most(false)];
    assert!(inside < 5e-3 && slivers < 0.2, "{inside} {slivers}");
}

fn in_the_gap(r: f64) -> bool {
    (0.25..0.5).contains(&r)
}

/// Plane Poiseuille flow at 20° to the grid, ten cells across, over periodic sides. Measured: 0.005 % and 0.64 %.
#[test]
fn flow_in_a_turned_channel() {
    let mut channel = TurnedChannel::new(20.0, 10).unwrap();
    let mean = channel.mean(STEADY).unwrap();
    assert!((mean - 1.0).abs() < 2e-4, "{mean}");
    let [worst, _] = velocity_errors(&channel.flow, |x| channel.exact(x));
    assert!(worst / 1.5 < 0.01, "{worst}");
}

/// The same by smooth forcing, 20 cells across. Measured: −0.12 %.
#[test]
fn forced_flow_in_a_turned_channel() {
    let [rate, _] = ForcedChannel::new(20.0, 20, SmoothForcing::new(1.0)).unwrap().rates(STEADY).unwrap();
    assert!((rate - 1.0).abs() < 2e-3, "{rate}");
}

/// Creeping flow between eccentric cylinders (Wannier 1950), 4 cells in the narrowest gap. Measured: 2.8e-3 and 1.4e-3 of the
/// turning cylinder's speed; −0.12 % of the torque and −1.0 % of the force on it.
#[test]
fn creeping_flow_between_eccentric_cylinders() {
    let mut case = EccentricCylinders::new(32, [0.3, 0.21]).unwrap();
    let torque = |flow: &mut Projection<2>| flow.wall_impulses()[0].torque.z / flow.last_dt();
    let torque = settle(&mut case.flow, [0.0; 2], [5e-3, STEADY], torque).unwrap();
    let force = case.flow.wall_impulses()[0].force * (1.0 / case.flow.last_dt());
    let [across, along] = case.parts([force.x, force.y]);
    let [exact_force, exact_torque] = case.exact_load();
    assert!((torque / exact_torque - 1.0).abs() < 2e-3, "{torque} {exact_torque}");
    assert!((across / exact_force - 1.0).abs() < 0.015, "{across} {exact_force}");
    assert!((along / exact_force).abs() < 3e-3, "{along} {exact_force}");
    let [worst, rms] =
        velocity_errors(&case.flow, |x| case.exact(x)).map(|error| error * EccentricCylinders::SCALE);
    assert!(worst < 3.5e-3 && rms < 1.7e-3, "{worst} {rms}");
}

/// A quarter of a sphere between two planes of symmetry bears a quarter of the force, in cells that its walls and the sides of the
/// box cut both, and all its surface can be told from it.
#[test]
fn a_quarter_of_a_sphere_bears_a_quarter() {
    let run = |cells: [usize; 3], lengths: [f64; 3], origin: [f64; 3]| {
        let grid = CartesianGrid::new(cells, lengths).unwrap().with_origin(origin).unwrap();
        let sides = [Side::Periodic.both(), Side::FreeSlip.both(), Side::FreeSlip.both()];
        let fluid = Fluid { density: 1.0, viscosity: 0.05 };
        let mut flow = Projection::new(grid, sides, fluid).unwrap();
        let sphere = PrescribedBodies::default().with(Sphere::new(0.5).unwrap(), [0.013, 0.0, 0.0], 0.0);
        put_walls(&mut flow, &sphere).unwrap();
        (0..30).for_each(|_| flow.advance(0.01, [1.0, 0.0, 0.0]).unwrap());
        let force = flow.wall_impulses()[0].force * (1.0 / flow.last_dt());
        (flow, sphere, force)
    };
    let (whole, sphere, force) = run([24; 3], [2.0; 3], [-1.0; 3]);
    let (quarter, _, part) = run([24, 12, 12], [2.0, 1.0, 1.0], [-1.0, 0.0, 0.0]);
    assert!(force.x > 0.1 && (4.0 * part.x / force.x - 1.0).abs() < 1e-6, "{force} {part}");
    let loads = surface_loads(&whole, &sphere, 0, 0.0).unwrap().total().force;
    let spacing = 2.0 / 24.0;
    let unfolded = Unfolded::new(&quarter, [false, true, true])
        .unwrap()
        .surface_loads(&sphere, spacing)
        .unwrap()
        .total()
        .force;
    assert!((unfolded - loads).norm() < 1e-4 * loads.norm(), "{unfolded} {loads}");
}

/// Drag factors K of simple-cubic arrays of spheres (Zick & Homsy 1982, Table 2) at solid fractions from
/// 0.064 to 0.343; second order in the cell. Measured: −0.85 % at 8 cells per diameter, −0.96 % at
/// 12, and −1.69 and −0.79 % at 12 and 17 of the densest, whose gap is two cells wide at 12.
///
/// Residuals of the flow on cells a third as large, weighted with velocity and pressure (the Stokes
/// operator is self-adjoint), split the excess of the densest: second differences and pressure
/// gradients away from the wall 0.98 %, the divergence of whole cells 0.25 %, cut links 0.14 %, cut
/// faces 0.2 % (0.29 % with exact fluxes).
#[test]
fn flow_through_an_array_of_spheres() {
    for (fraction, theirs, cells, most) in
        [(0.064, 2.810, 16, 0.0095), (0.216, 7.442, 16, 0.0105), (0.343, 15.4, 20, 0.0085)]
    {
        let k = SphereArray::new(fraction, cells).unwrap().drag_factor(STEADY).unwrap();
        assert!((k / theirs - 1.0).abs() < most, "{fraction} {cells}: {k}");
    }
    let mut array = SphereArray::new(0.343, 14).unwrap();
    let k = array.drag_factor(STEADY).unwrap();
    assert!((k / 15.4 - 1.0).abs() < 0.0175, "{k}");
    // The sphere bears the force on the box.
    let impulse = array.flow.wall_impulses()[0].force / (SphereArray::FORCE * array.flow.last_dt());
    assert!((impulse.x - 1.0).abs() < 1e-3 && impulse.yz().norm() < 1e-3, "{impulse}");
    // All of it but the share that acts inside the sphere passes its surface. Measured: −2.8 %, with two cells between
    // the spheres; −1.1 % at 17 cells per diameter, −0.3 % at 23.
    let force = surface_loads(&array.flow, &array.bodies, 0, 0.0).unwrap().total().force / SphereArray::FORCE;
    assert!((force.x + 0.343 - 1.0).abs() < 0.03 && force.yz().norm() < 0.01, "{force}");
}

/// Few cut cells, solved by a dense product, and many, by iterations: neither allocates, and the number of threads changes
/// no bit.
#[test]
fn steps_beside_walls_allocate_nothing() {
    for across in [1, 3] {
        let run = |threads: usize| {
            with_threads(threads, || {
                let grid = CartesianGrid::new([40, 40], [1.0, 1.0]).unwrap();
                let fluid = Fluid { density: 1.0, viscosity: 0.01 };
                let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid).unwrap();
                let mut bodies = PrescribedBodies::default();
                for at in
                    (0..across * across).map(|k| [k % across, k / across].map(|i| (f64::from(i) + 0.5) / 3.0))
                {
                    bodies = bodies.with(Disc::new(0.13).unwrap(), [at[0], at[1], 0.0], 0.3);
                }
                put_walls(&mut flow, &bodies).unwrap();
                let mut steps = |n| (0..n).for_each(|_| flow.advance(5e-3, [0.1, 0.02]).unwrap());
                steps(10);
                let count = allocation_counter::measure(|| steps(10)).count_total;
                assert_eq!(flow.pressure_info().iterations > 0, across > 1);
                let bits: Vec<u64> = flow.velocity().component(0).iter().map(|u| u.to_bits()).collect();
                (count, bits)
            })
        };
        let [(one, first), (two, second)] = [run(1), run(2)];
        assert_eq!((one, two), (0, 0), "{across} discs across");
        assert!(first == second, "{across} discs across");
    }
}

/// A wall at rest and a body that moves in one scene: the body falls, the wall stands and feels it.
#[test]
fn walls_and_moving_bodies_meet_in_one_flow() {
    let fluid = Fluid { density: 1000.0, viscosity: 1e-5 };
    let grid = CartesianGrid::new([60, 60], [6e-3, 6e-3]).unwrap();
    let mut flow = Projection::new(grid, Side::WALL.everywhere(), fluid).unwrap();
    let post = PrescribedBodies::default().with(Disc::new(0.7e-3).unwrap(), [2.2e-3, 1.8e-3, 0.0], 0.0);
    put_walls(&mut flow, &post).unwrap();
    let mut bodies = RigidBodies::new(Periods::new([None; 3]));
    let material = Material { density: 2000.0, damping: 1.0, friction: 0.0, ..Material::default() };
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

/// Mean load over the last of `steps` steps from rest on a body at (1.2, 1, 1) m in a stream along x, ten cells per metre, and ∇·u.
fn load_in_a_stream<const D: usize>(solid: impl Solid + 'static, angle: f64, steps: usize) -> (Vector, f64) {
    let cells = std::array::from_fn(|a| [24, 20, 20][a]);
    let grid = CartesianGrid::new(cells, cells.map(|n| 0.1 * n as f64)).unwrap();
    let mut sides = Side::FreeSlip.everywhere();
    sides[0] = [Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0])), Side::ConvectiveOutlet];
    let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 0.05 }).unwrap();
    let mut pose = Pose::at([1.2, 1.0, if D == 2 { 0.0 } else { 1.0 }]);
    pose.orientation = Rotation::from_scaled_axis(Vector::z() * angle.to_radians());
    let walls = cut_walls(flow.velocity(), &StaticBodies::new().with(solid, pose)).unwrap();
    flow.set_walls(Some(walls)).unwrap();
    for _ in 0..steps {
        flow.advance(0.01, [0.0; D]).unwrap();
    }
    (flow.wall_impulses()[0].force / flow.last_dt(), flow.statistics().divergence)
}

/// Surfaces through nodes, edges and corners of the grid: loads of symmetric bodies are symmetric to 10⁻⁹ of the drag, which does not
/// jump with the size of the body once the flow has developed (3 s).
#[test]
fn loads_of_symmetric_bodies_are_symmetric() {
    let check = |name: &str, most: f64, load: &dyn Fn(f64) -> (Vector, f64)| {
        let loads = [1.0 - 1e-5, 1.0, 1.0 + 1e-5].map(load);
        for (load, divergence) in loads {
            let lateral = load.y.abs().max(load.z.abs());
            assert!(load.x > 0.1 && lateral < 1e-9 * load.x, "{name}: {load}");
            assert!(divergence < 1e-9, "{name}: {divergence}");
        }
        let [below, at, above] = loads.map(|load| load.0.x);
        let change = (below / at - 1.0).abs().max((above / at - 1.0).abs());
        assert!(change < most, "{name}: {below} {at} {above}");
    };
    for radius in [0.5, 0.45, 0.25 * 5.0_f64.sqrt()] {
        check("disc", 1e-3, &|s| load_in_a_stream::<2>(Disc::new(radius * s).unwrap(), 0.0, 300));
    }
    let diagonal = 0.5_f64.sqrt();
    for (edge, angle) in [(1.0, 0.0), (0.9, 0.0), (diagonal, 45.0), (0.8 * diagonal, 45.0)] {
        check(&format!("square {edge} {angle}"), 3e-4, &|s| {
            load_in_a_stream::<2>(Polygon::rectangle([edge * s; 2]).unwrap(), angle, 300)
        });
    }
    check("sphere", 1e-3, &|s| load_in_a_stream::<3>(Sphere::new(0.5 * s).unwrap(), 0.0, 8));
}
