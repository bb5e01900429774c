//! The unsteady algorithm against exact solutions, conservation laws and the projection.
use super::*;
use crate::{Patch, Profile, Projection, Velocity};
use interfaces::{Checkpoint, VelocityField};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

const PERIODIC: [[Side; 2]; 2] = [[Side::Periodic, Side::Periodic], [Side::Periodic, Side::Periodic]];

/// Taylor–Green vortices carried along by a uniform flow: exact for the Navier–Stokes equations.
fn vortices(x: [f64; 2], t: f64, nu: f64) -> [f64; 2] {
    let drift = [0.7, 0.4];
    let (a, b) = (x[0] - drift[0] * t, x[1] - drift[1] * t);
    let decay = (-2.0 * nu * t).exp();
    [drift[0] - a.cos() * b.sin() * decay, drift[1] + a.sin() * b.cos() * decay]
}

fn start(cells: [usize; 2], params: PisoParams) -> Piso<2> {
    let grid = CartesianGrid::new(cells, [TAU, TAU]).unwrap();
    let fluid = Fluid { density: 3.0, viscosity: 0.05 };
    let mut flow = Piso::new(grid, PERIODIC, fluid).unwrap().with_params(params).unwrap();
    flow.set_velocity(|x| vortices(x, 0.0, 0.05));
    flow
}

/// Largest velocity error.
fn error_at(velocity: &Velocity<2>, time: f64) -> f64 {
    let mut worst = 0.0_f64;
    for c in 0..2 {
        let lattice = velocity.lattice(c);
        for (j, i) in (0..lattice.axes[1].len()).flat_map(|j| (0..lattice.axes[0].len()).map(move |i| (j, i)))
        {
            let at = [i as isize, j as isize, 0];
            let x = lattice.position(at);
            let u = velocity.component(c)[lattice.index(at).unwrap()];
            worst = worst.max((u - vortices([x[0], x[1]], time, 0.05)[c]).abs());
        }
    }
    worst
}

#[test]
fn second_order_in_space_and_as_good_as_the_projection() {
    let error = |n: usize| {
        let mut flow = start([n, n + 6], PisoParams::default());
        let mut other = Projection::new(flow.grid().clone(), PERIODIC, flow.fluid()).unwrap();
        other.set_velocity(|x| vortices(x, 0.0, 0.05));
        for _ in 0..100 {
            flow.advance(0.005, [0.0; 2], &mut ()).unwrap();
            other.advance(0.005, [0.0; 2]).unwrap();
        }
        [error_at(flow.velocity(), flow.time()), error_at(other.velocity(), other.time())]
    };
    let errors = [24, 48].map(error);
    let order = (errors[0][0] / errors[1][0]).log2();
    assert!(order > 1.95, "errors {errors:?}, order {order}");
    assert!((errors[1][0] / errors[1][1] - 1.0).abs() < 0.02, "{errors:?}");
}

#[test]
fn order_in_time() {
    // Differences of runs on one grid leave the time error alone.
    let run = |time_scheme, steps: usize| {
        let params = PisoParams { time_scheme, pressure_tolerance: 1e-9, ..PisoParams::default() };
        let mut flow = start([16, 16], params);
        for _ in 0..steps {
            flow.advance(1.0 / steps as f64, [0.0; 2], &mut ()).unwrap();
        }
        flow.velocity().field(0).values().collect::<Vec<_>>()
    };
    let finest = run(TimeScheme::Bdf2, 640);
    let error = |scheme, steps| {
        run(scheme, steps).iter().zip(&finest).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    for (scheme, least, most) in [(TimeScheme::Euler, 0.85, 1.15), (TimeScheme::Bdf2, 1.85, 2.5)] {
        let (coarse, fine) = (error(scheme, 20), error(scheme, 40));
        let order = (coarse / fine).log2();
        assert!(order > least && order < most, "{scheme:?}: errors {coarse:e} {fine:e}, order {order}");
    }
}

#[test]
fn steps_of_any_lengths_keep_the_second_order() {
    let run = |steps: usize| {
        let mut flow = start([16, 16], PisoParams { pressure_tolerance: 1e-9, ..PisoParams::default() });
        let dt = 1.0 / steps as f64;
        for k in 0..steps {
            flow.advance(dt * [0.6, 1.4][k % 2], [0.0; 2], &mut ()).unwrap();
        }
        flow.velocity().field(0).values().collect::<Vec<_>>()
    };
    let finest = run(640);
    let error = |steps| run(steps).iter().zip(&finest).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let order = (error(20) / error(40)).log2();
    assert!(order > 1.7, "{order}");
}

#[test]
fn courant_numbers_above_one_are_stable() {
    // A cavity at Courant number 5: it settles.
    let grid = CartesianGrid::new([32, 32], [1.0, 1.0]).unwrap();
    let sides = [Side::WALL.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]];
    let fluid = Fluid { density: 1.0, viscosity: 0.0025 };
    let mut flow = Piso::new(grid, sides, fluid).unwrap();
    let mut energy = [0.0; 2];
    for step in 0..400 {
        flow.advance(flow.stable_dt(5.0).min(0.2), [0.0; 2], &mut ()).unwrap();
        energy = [energy[1], flow.statistics().kinetic_energy];
        assert!(energy[1] < 0.1 && flow.statistics().divergence < 1e-4, "{energy:?} in step {step}");
    }
    assert!(flow.courant(flow.last_dt()) > 2.0 && (energy[0] / energy[1] - 1.0).abs() < 1e-5, "{energy:?}");
}

#[test]
fn sides_that_change_in_time_and_outlets_conserve_mass() {
    let patch =
        |from: f64, to: f64, side: Side| Patch { lower: [0.0, from, 0.0], upper: [0.0, to, 0.0], side };
    let inlet = Side::Inlet(Profile::function(|_, t| [1.0 + 0.5 * (3.0 * t).sin(), 0.0, 0.0]));
    let left = Side::Patches(vec![patch(0.0, 0.5, inlet), patch(0.0, 1.0, Side::FreeSlip)]);
    for outlet in [Side::ConvectiveOutlet, Side::PressureOutlet(0.0)] {
        let right = Side::Patches(vec![patch(0.5, 1.0, outlet), patch(0.0, 1.0, Side::WALL)]);
        let grid = CartesianGrid::new([40, 20], [2.0, 1.0]).unwrap();
        let sides = [[left.clone(), right], [Side::WALL, Side::FreeSlip]];
        let mut flow = Piso::new(grid, sides, Fluid { density: 1.0, viscosity: 0.01 }).unwrap();
        for _ in 0..60 {
            flow.advance(0.05, [0.0; 2], &mut ()).unwrap();
            let (statistics, t) = (flow.statistics(), flow.time());
            assert!(statistics.divergence < 1e-4);
            let (base, s) = (flow.grid().base(), flow.grid().stride());
            let u = flow.velocity().field(0).data();
            for i in [0, 10, 39, 40] {
                let through: f64 = (0..20).map(|j| 0.05 * u[base + i * s[0] + j * s[1]]).sum();
                let exact = 0.5 * (1.0 + 0.5 * (3.0 * t).sin());
                assert!((through - exact).abs() < 1e-6, "{through} {exact} at {i}, t = {t}");
            }
        }
    }
}

#[test]
fn forcing_acts_between_the_parts() {
    // The upper half of a channel is held at rest.
    let grid = CartesianGrid::new([4, 16], [0.25, 1.0]).unwrap();
    let sides = [Side::Periodic.both(), Side::WALL.both()];
    let mut flow = Piso::new(grid, sides, Fluid { density: 1.0, viscosity: 0.1 }).unwrap();
    let mut calls = 0;
    let mut hold = |velocity: &mut Velocity<2>, _: f64, _: f64| {
        calls += 1;
        for c in 0..2 {
            let lattice = velocity.lattice(c).clone();
            for (j, i) in
                (0..lattice.axes[1].len()).flat_map(|j| (0..lattice.axes[0].len()).map(move |i| (j, i)))
            {
                let at = [i as isize, j as isize, 0];
                if lattice.position(at)[1] > 0.5 {
                    let index = lattice.index(at).unwrap();
                    velocity.component_mut(c)[index] = 0.0;
                }
            }
        }
        Ok(())
    };
    for _ in 0..1500 {
        flow.advance(0.001, [1.0, 0.0], &mut hold).unwrap();
    }
    assert_eq!(calls, 3000);
    // The parabola between the wall and the first node held (see SIMPLE's test), on top ∝ the slip in a step.
    let h = 1.0 / 16.0;
    let width = 8.5 * h;
    for (r, y) in (0..8).map(|j| (j, (j as f64 + 0.5) * h)) {
        let exact = 5.0 * y * (width - y);
        let u = flow.velocity().field(0).row(r)[2];
        assert!((u - exact).abs() < 0.05 * 5.0 * 0.0625, "{u} {exact}");
    }
}

#[test]
fn imposed_velocities_act_at_once() {
    // The same channel, long steps.
    let grid = CartesianGrid::new([4, 32], [0.125, 1.0]).unwrap();
    let sides = [Side::Periodic.both(), Side::WALL.both()];
    let mut flow = Piso::new(grid, sides, Fluid { density: 1.0, viscosity: 0.1 }).unwrap();
    let (base, s) = (flow.grid().base(), flow.grid().stride());
    let solid = (16..32).flat_map(|j| (0..4).map(move |i| base + i * s[0] + j * s[1]));
    flow.impose(solid.flat_map(|o| [(0, o, 0.0), (1, o, 0.0)])).unwrap();
    for _ in 0..60 {
        flow.advance(0.5, [1.0, 0.0], &mut ()).unwrap();
    }
    let h = 1.0 / 32.0;
    let width = 16.5 * h;
    for (r, y) in (0..16).map(|j| (j, (j as f64 + 0.5) * h)) {
        let exact = 5.0 * y * (width - y);
        let u = flow.velocity().field(0).row(r)[2];
        assert!((u - exact).abs() < 1e-6, "{u} {exact}");
    }
    assert!(matches!(flow.impose([(3, 40, 0.0)]), Err(FlowError::Parameter { .. })));
}

#[test]
fn eddy_viscosity_slows_the_vortices() {
    let mut flow = start([32, 32], PisoParams::default());
    let mut eddy = Field::zeros(flow.grid());
    eddy.data_mut().fill(0.15);
    flow.set_eddy_viscosity(Some(&eddy));
    let before = flow.statistics();
    let drift = 0.5 * 3.0 * TAU * TAU * (0.7 * 0.7 + 0.4 * 0.4);
    for _ in 0..20 {
        flow.advance(0.025, [0.0; 2], &mut ()).unwrap();
    }
    let decay = (flow.statistics().kinetic_energy - drift) / (before.kinetic_energy - drift);
    let exact = (-4.0 * 0.2 * 0.5_f64).exp();
    assert!((decay / exact - 1.0).abs() < 5e-3, "{decay} {exact}");
}

/// Largest part of a step's impulses by which sides, force and a push between the parts of the step miss the momentum that the fluid gains.
fn unaccounted<const D: usize>(cells: [usize; D], sides: [[Side; 2]; D], correctors: usize) -> f64 {
    let grid = CartesianGrid::new(cells, [1.0; D]).unwrap();
    let params = PisoParams {
        correctors,
        time_scheme: TimeScheme::Euler,
        momentum_tolerance: 1e-12,
        pressure_tolerance: 1e-12,
    };
    let density = 2.0;
    let fluid = Fluid { density, viscosity: 0.01 };
    let mut flow = Piso::new(grid, sides.clone(), fluid).unwrap().with_params(params).unwrap();
    let force: [f64; D] = std::array::from_fn(|c| 0.1 * (c as f64 + 1.0));
    let cell = flow.grid().volume() / cells.iter().product::<usize>() as f64;
    let (dt, mut worst) = (0.02, 0.0_f64);
    for _ in 0..30 {
        let before = flow.statistics().volume_flow;
        let mut pushed = 0.0;
        flow.predict(dt, force).unwrap();
        for _ in 0..correctors {
            // A body that holds some cells in the middle.
            let lattice = flow.velocity().lattice(0);
            let middle: [isize; 3] = std::array::from_fn(|a| if a < D { cells[a] as isize / 2 } else { 0 });
            let middle = lattice.index(middle).unwrap();
            for u in &mut flow.velocity_mut().component_mut(0)[middle..middle + 2] {
                pushed += density * cell * (0.4 - *u);
                *u = 0.4;
            }
            flow.correct(dt).unwrap();
        }
        flow.finish(dt).unwrap();
        let gained = density * (flow.statistics().volume_flow - before);
        let mut sum = pushed.abs();
        let mut given = flow.wall_impulse();
        sum += given.norm();
        given.x += pushed;
        for c in 0..D {
            // Faces on a wall carry no momentum and feel no force.
            let unknown =
                if matches!(sides[c][0], Side::Periodic) { 1.0 } else { 1.0 - 1.0 / cells[c] as f64 };
            given[c] += dt * density * force[c] * unknown;
            sum += dt * density * force[c];
        }
        worst = worst.max((gained - given).norm() / sum);
    }
    worst
}

#[test]
fn sides_force_and_bodies_account_for_all_momentum() {
    // Nothing is lost between periodic sides.
    let periodic = unaccounted([12, 10], PERIODIC, 2);
    assert!(periodic < 1e-10, "{periodic:e}");
    // Between walls the neighbours of the last correction do not answer: less with each one.
    let lid = Side::Wall([1.0, 0.0, 0.0]);
    let walls = [Side::WALL.both(), [Side::WALL, lid.clone()]];
    let slippery = [Side::Periodic.both(), [Side::FreeSlip, lid.clone()]];
    let space = [Side::WALL.both(), [Side::FreeSlip, lid], Side::Periodic.both()];
    for found in [
        [2, 8].map(|n| unaccounted([12, 10], walls.clone(), n)),
        [2, 8].map(|n| unaccounted([12, 10], slippery.clone(), n)),
        [2, 8].map(|n| unaccounted([8, 8, 7], space.clone(), n)),
    ] {
        assert!(found[0] < 0.02 && found[1] < 0.02 * found[0], "{found:?}");
    }
}

#[test]
fn a_stopped_run_goes_on_the_same() {
    let sides = [[Side::Inlet(Profile::Parabolic { peak: 1.0 }), Side::ConvectiveOutlet], Side::WALL.both()];
    let grid = CartesianGrid::new([24, 12], [2.0, 1.0]).unwrap();
    let fluid = Fluid { density: 1.0, viscosity: 0.02 };
    let new = || Piso::new(grid.clone(), sides.clone(), fluid).unwrap();
    let mut flow = new();
    (0..5).for_each(|_| flow.advance(0.05, [0.0; 2], &mut ()).unwrap());
    let mut saved: HashMap<String, Vec<f64>> = HashMap::new();
    flow.save(&mut |name, values| {
        saved.insert(name.into(), values.to_vec());
    });
    let mut other = new();
    other.restore(&|name| saved.get(name).map(Vec::as_slice)).unwrap();
    for flow in [&mut flow, &mut other] {
        (0..3).for_each(|_| flow.advance(0.05, [0.0; 2], &mut ()).unwrap());
    }
    assert_eq!(flow.velocity().field(0).data(), other.velocity().field(0).data());
    assert_eq!(flow.pressure().data(), other.pressure().data());
    assert_eq!((flow.time(), flow.steps()), (other.time(), other.steps()));
}

#[test]
fn results_do_not_depend_on_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut flow = start([40, 72], PisoParams::default());
            (0..3).for_each(|_| flow.advance(0.1, [0.0; 2], &mut ()).unwrap());
            flow.velocity().field(0).data().to_vec()
        })
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn three_dimensions_and_schemes() {
    // A plane flow in a box that is periodic along z: as in the plane, whatever the scheme.
    for scheme in Convection::ALL {
        let fluid = Fluid { density: 1.0, viscosity: 0.01 };
        let lid = [Side::WALL, Side::Wall([1.0, 0.0, 0.0])];
        let grid = CartesianGrid::new([12, 10, 4], [1.0, 1.0, 0.4]).unwrap();
        let sides = [Side::WALL.both(), lid.clone(), Side::Periodic.both()];
        let mut space = Piso::new(grid, sides, fluid).unwrap().with_convection(scheme);
        let grid = CartesianGrid::new([12, 10], [1.0, 1.0]).unwrap();
        let mut plane = Piso::new(grid, [Side::WALL.both(), lid], fluid).unwrap().with_convection(scheme);
        for _ in 0..20 {
            space.advance(0.05, [0.0; 3], &mut ()).unwrap();
            plane.advance(0.05, [0.0; 2], &mut ()).unwrap();
        }
        for (j, k) in (0..10).flat_map(|j| (0..4).map(move |k| (j, k))) {
            for (a, b) in
                space.velocity().field(0).row(j + 10 * k).iter().zip(plane.velocity().field(0).row(j))
            {
                assert!((a - b).abs() < 1e-4, "{scheme:?}: {a} {b}");
            }
        }
        assert!(space.statistics().volume_flow.z.abs() < 1e-6);
        let top = plane.velocity().field(0).row(9)[6];
        assert!(top > 0.5 && top < 1.0, "{scheme:?}: {top}");
    }
}

#[test]
fn bad_input_is_an_error() {
    let mut flow = start([8, 8], PisoParams::default());
    for dt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(flow.advance(dt, [0.0; 2], &mut ()), Err(FlowError::TimeStep { .. })));
    }
    let diverged = flow.advance(0.1, [f64::NAN, 0.0], &mut ());
    assert!(matches!(diverged, Err(FlowError::Diverged { .. })), "{diverged:?}");
    let mut flow = start([8, 8], PisoParams::default());
    let mut poison = |velocity: &mut Velocity<2>, _: f64, _: f64| {
        velocity.component_mut(0).fill(PI / 0.0);
        Ok(())
    };
    let diverged = flow.advance(0.1, [0.0; 2], &mut poison);
    assert!(matches!(diverged, Err(FlowError::Diverged { .. })), "{diverged:?}");
    let grid = CartesianGrid::new([8, 8], [1.0, 1.0]).unwrap();
    let new = || Piso::new(grid.clone(), PERIODIC, Fluid { density: 1.0, viscosity: 0.0 }).unwrap();
    for params in [
        PisoParams { correctors: 0, ..Default::default() },
        PisoParams { momentum_tolerance: 1.0, ..Default::default() },
        PisoParams { pressure_tolerance: f64::NAN, ..Default::default() },
    ] {
        assert!(matches!(new().with_params(params).err(), Some(FlowError::Parameter { .. })), "{params:?}");
    }
    let fluid = Fluid { density: 0.0, viscosity: 1.0 };
    assert!(matches!(Piso::new(grid.clone(), PERIODIC, fluid).err(), Some(FlowError::Fluid { .. })));
}
