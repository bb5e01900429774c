//! The flow algorithm against exact solutions and conservation laws.
use crate::{CartesianGrid, Diffusion, FlowError, Fluid, Projection, Side};
use interfaces::{Checkpoint, VelocityField};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

const PERIODIC: [[Side; 2]; 2] = [[Side::Periodic, Side::Periodic], [Side::Periodic, Side::Periodic]];

/// Taylor–Green vortices carried along by a uniform flow (so that convection is no gradient), in a
/// stretched box; exact for the Navier–Stokes equations.
fn vortices(x: [f64; 2], t: f64, nu: f64) -> [f64; 2] {
    let drift = [0.7, 0.4];
    let (a, b) = (x[0] - drift[0] * t, x[1] - drift[1] * t);
    let decay = (-2.0 * nu * t).exp();
    [drift[0] - a.cos() * b.sin() * decay, drift[1] + a.sin() * b.cos() * decay]
}

/// Largest velocity error at time `end` after `steps` steps on n × m cells.
fn vortex_error(cells: [usize; 2], steps: usize, end: f64) -> f64 {
    let nu = 0.05;
    let grid = CartesianGrid::new(cells, [TAU, TAU]).unwrap();
    let mut flow = Projection::new(grid, PERIODIC, Fluid { density: 3.0, viscosity: nu }).unwrap();
    flow.set_velocity(|x| vortices(x, 0.0, nu));
    for _ in 0..steps {
        flow.advance(end / steps as f64, [0.0; 2]).unwrap();
    }
    let mut worst = 0.0_f64;
    for c in 0..2 {
        let lattice = flow.velocity().lattice(c);
        for (j, i) in (0..cells[1]).flat_map(|j| (0..cells[0]).map(move |i| (j, i))) {
            let at = [i as isize, j as isize, 0];
            let x = lattice.position(at);
            let u = flow.velocity().component(c)[lattice.index(at).unwrap()];
            worst = worst.max((u - vortices([x[0], x[1]], end, nu)[c]).abs());
        }
    }
    worst
}

#[test]
fn second_order_in_space() {
    let errors = [24, 48, 96].map(|n| vortex_error([n, n + 6], 800, 0.5));
    let order = (errors[1] / errors[2]).log2();
    assert!(order > 1.95, "errors {errors:?}, order {order}");
}

#[test]
fn second_order_in_time() {
    // Differences of runs on one grid leave the time error alone.
    let run = |steps: usize| {
        let grid = CartesianGrid::new([16, 16], [TAU, TAU]).unwrap();
        let mut flow = Projection::new(grid, PERIODIC, Fluid { density: 1.0, viscosity: 0.05 }).unwrap();
        flow.set_velocity(|x| vortices(x, 0.0, 0.05));
        for _ in 0..steps {
            flow.advance(1.0 / steps as f64, [0.0; 2]).unwrap();
        }
        flow.velocity().field(0).values().collect::<Vec<_>>()
    };
    let finest = run(1600);
    let error = |steps| run(steps).iter().zip(&finest).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // The first step is Euler's: its one error of order dt² does not spoil the order.
    let (coarse, fine) = (error(100), error(200));
    let order = (coarse / fine).log2();
    assert!(order > 1.9, "errors {coarse:e} {fine:e}, order {order}");
}

#[test]
fn momentum_and_divergence_to_round_off() {
    let grid = CartesianGrid::new([20, 14], [1.0, 0.7]).unwrap();
    let mut flow = Projection::new(grid, PERIODIC, Fluid { density: 2.0, viscosity: 1e-3 }).unwrap();
    flow.set_velocity(|x| [(TAU * x[1] / 0.7).sin() + 0.3, (TAU * x[0]).cos() * (TAU * x[0]).sin()]);
    flow.project(1.0).unwrap();
    let start = flow.statistics().volume_flow;
    for _ in 0..50 {
        flow.advance(flow.stable_dt(0.3), [0.1, -0.2]).unwrap();
    }
    let now = flow.statistics();
    let gained = now.volume_flow - start;
    let t = flow.time() * 0.7;
    assert!((gained.x - 0.1 * t).abs() < 1e-14 && (gained.y + 0.2 * t).abs() < 1e-14, "{gained}");
    assert!(now.divergence < 1e-12, "{}", now.divergence);
}

#[test]
fn central_convection_keeps_kinetic_energy() {
    // Without viscosity only the time scheme changes the energy, at its own order.
    let drift = |steps: usize| {
        let grid = CartesianGrid::new([16, 16], [TAU, TAU]).unwrap();
        let mut flow = Projection::new(grid, PERIODIC, Fluid { density: 1.0, viscosity: 0.0 }).unwrap();
        flow.set_velocity(|x| [x[1].sin() + (2.0 * x[1]).cos(), (x[0]).cos() + 0.5 * (3.0 * x[0]).sin()]);
        flow.project(1.0).unwrap();
        let start = flow.statistics().kinetic_energy;
        for _ in 0..steps {
            flow.advance(0.5 / steps as f64, [0.0; 2]).unwrap();
        }
        (flow.statistics().kinetic_energy / start - 1.0).abs()
    };
    let (coarse, fine) = (drift(100), drift(200));
    assert!(fine < 1e-5 && coarse / fine > 3.6, "{coarse:e} {fine:e}");
}

#[test]
fn poiseuille_is_exact_and_walls_bear_what_drives_it() {
    // u = b y (H − y)/2ν, to round-off.
    let (n, height, nu, b) = (16, 0.5, 0.1, 0.3);
    let grid = CartesianGrid::new([8, n], [1.0, height]).unwrap();
    let sides = [Side::Periodic.both(), Side::WALL.both()];
    let mut flow = Projection::new(grid, sides, Fluid { density: 2.0, viscosity: nu }).unwrap();
    let h = height / n as f64;
    let dt = flow.stable_dt(0.3);
    for _ in 0..8000 {
        flow.advance(dt, [b, 0.0]).unwrap();
    }
    for (r, j) in (0..n).enumerate() {
        let y = (j as f64 + 0.5) * h;
        let exact = b / (2.0 * nu) * y * (height - y);
        let found = flow.velocity().field(0).row(r)[3];
        assert!((found - exact).abs() < 1e-12, "row {r}: {found} {exact}");
    }
    let impulse = flow.wall_impulse();
    assert!((impulse.x + dt * 2.0 * b * height).abs() < 1e-12 * dt, "{impulse}");
}

/// Walls all round, one of them moving: what the fluid gains is what walls and force give.
#[test]
fn walls_and_force_account_for_all_momentum() {
    fn check<const D: usize>(cells: [usize; D], sides: [[Side; 2]; D]) {
        let grid = CartesianGrid::new(cells, [1.0; D]).unwrap();
        let mut flow = Projection::new(grid, sides.clone(), Fluid { density: 2.0, viscosity: 0.01 }).unwrap();
        let force = std::array::from_fn(|c| 0.1 * (c as f64 + 1.0));
        for _ in 0..60 {
            let before = flow.statistics().volume_flow * 2.0;
            let dt = flow.stable_dt(0.3).min(0.02);
            flow.advance(dt, force).unwrap();
            let gained = flow.statistics().volume_flow * 2.0 - before;
            for c in 0..D {
                // Faces on a wall carry no momentum and feel no force.
                let unknown =
                    if matches!(sides[c][0], Side::Periodic) { 1.0 } else { 1.0 - 1.0 / cells[c] as f64 };
                let given = flow.wall_impulse()[c] + dt * 2.0 * force[c] * unknown;
                assert!((gained[c] - given).abs() < 1e-14, "{c}: {gained} {given}");
            }
            assert!(flow.statistics().divergence < 1e-11);
        }
    }
    let lid = Side::Wall([1.0, 0.0, 0.0]);
    check([12, 10], [Side::WALL.both(), [Side::WALL, lid.clone()]]);
    check([12, 10], [Side::Periodic.both(), [Side::FreeSlip, lid.clone()]]);
    check([6, 8, 7], [Side::WALL.both(), [Side::FreeSlip, lid], Side::Periodic.both()]);
}

#[test]
fn a_restart_goes_on_bit_for_bit() {
    let make = || {
        let grid = CartesianGrid::new([12, 10], [1.0, 1.0]).unwrap();
        Projection::new(grid, PERIODIC, Fluid { density: 1.0, viscosity: 1e-3 }).unwrap()
    };
    let run = |flow: &mut Projection<2>, n| (0..n).for_each(|_| flow.advance(0.01, [0.1, 0.0]).unwrap());
    let mut whole = make();
    whole.set_velocity(|x| [(TAU * x[1]).sin(), (TAU * x[0]).cos()]);
    run(&mut whole, 7);
    let mut saved = HashMap::new();
    whole.save(&mut |name, values| {
        saved.insert(name.to_owned(), values.to_vec());
    });
    let mut second = make();
    second.restore(&|name| saved.get(name).map(Vec::as_slice)).unwrap();
    run(&mut whole, 9);
    run(&mut second, 9);
    assert_eq!(whole.velocity().field(1).data(), second.velocity().field(1).data());
    assert_eq!(whole.pressure().data(), second.pressure().data());
    assert_eq!(whole.time().to_bits(), second.time().to_bits());
    assert!(make().restore(&|_| None).is_err());
}

#[test]
fn bad_input_is_told() {
    assert!(matches!(CartesianGrid::new([0, 4], [1.0, 1.0]), Err(FlowError::Grid { .. })));
    assert!(matches!(CartesianGrid::new([4, 4], [1.0, -1.0]), Err(FlowError::Grid { .. })));
    assert!(matches!(CartesianGrid::new([4, 4], [1.0, f64::NAN]), Err(FlowError::Grid { .. })));
    assert!(matches!(CartesianGrid::new([usize::MAX, 4], [1.0, 1.0]), Err(FlowError::Grid { .. })));
    assert!(matches!(CartesianGrid::new([4], [1.0]), Err(FlowError::Grid { .. })));
    let grid = CartesianGrid::new([4, 4], [1.0, 1.0]).unwrap();
    let water = Fluid { density: 1000.0, viscosity: 1e-6 };
    let one_sided = [[Side::Periodic, Side::WALL], Side::WALL.both()];
    assert!(matches!(Projection::new(grid.clone(), one_sided, water), Err(FlowError::Boundary { .. })));
    let through = [[Side::Wall([1.0, 0.0, 0.0]), Side::WALL], Side::WALL.both()];
    assert!(matches!(Projection::new(grid.clone(), through, water), Err(FlowError::Boundary { .. })));
    for fluid in [Fluid { density: -1.0, ..water }, Fluid { viscosity: f64::NAN, ..water }] {
        assert!(matches!(Projection::new(grid.clone(), PERIODIC, fluid), Err(FlowError::Fluid { .. })));
    }
    let mut flow = Projection::new(grid, PERIODIC, water).unwrap().with_diffusion(Diffusion::Explicit);
    for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(flow.advance(dt, [0.0; 2]), Err(FlowError::TimeStep { .. })), "{dt}");
    }
    let limit = flow.viscous_limit();
    assert!(matches!(flow.advance(1.01 * limit, [0.0; 2]), Err(FlowError::Unstable { .. })));
    flow.set_velocity(|_| [f64::INFINITY, 0.0]);
    assert!(matches!(flow.advance(0.1, [0.0; 2]), Err(FlowError::Diverged { .. })));
}

#[test]
fn a_blow_up_is_an_error_not_a_nan() {
    let grid = CartesianGrid::new([16, 16], [1.0, 1.0]).unwrap();
    let mut flow = Projection::new(grid, PERIODIC, Fluid { density: 1.0, viscosity: 1e-6 }).unwrap();
    flow.set_velocity(|x| [(TAU * x[1]).sin(), (2.0 * PI * x[0]).cos() + (6.0 * PI * x[0]).sin()]);
    let error = (0..10_000).find_map(|_| flow.advance(0.5, [0.0; 2]).err());
    assert!(matches!(error, Some(FlowError::Diverged { .. })), "{error:?}");
}

/// Implicit factors are made anew in the memory they have when the step changes.
#[test]
fn a_step_of_any_length_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let grid = CartesianGrid::new([12, 10, 8], [1.0; 3]).unwrap();
    let sides = [Side::Periodic.both(), Side::WALL.both(), Side::FreeSlip.both()];
    let fluid = Fluid { density: 1.0, viscosity: 1.0 };
    let mut flow = Projection::new(grid, sides, fluid).unwrap().with_diffusion(Diffusion::Implicit);
    flow.set_velocity(|x| [(3.0 * x[1]).sin(), 0.0, 0.1]);
    let count = pool.install(|| {
        let mut steps = |dts: [f64; 3]| dts.into_iter().try_for_each(|dt| flow.advance(dt, [1.0, 0.0, 0.0]));
        steps([1e-3, 2e-3, 1e-3]).unwrap();
        allocation_counter::measure(|| steps([3e-3, 1e-3, 2e-3]).unwrap()).count_total
    });
    assert_eq!(count, 0);
}
