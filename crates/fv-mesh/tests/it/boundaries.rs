//! Inlets, outlets, patches and their balance.
use crate::norms;
use fv_mesh::{
    Axis, CartesianGrid, Diffusion, Field, FlowError, Fluid, Patch, Profile, Projection, Side, Simple,
};

const OIL: Fluid = Fluid { density: 2.0, viscosity: 0.05 };

fn channel(outlet: Side, cells: [usize; 2]) -> Projection<2> {
    let grid = CartesianGrid::new(cells, [3.0, 1.0]).unwrap();
    let inlet = Side::Inlet(Profile::Parabolic { peak: 1.5 });
    Projection::new(grid, [[inlet, outlet], Side::WALL.both()], OIL).unwrap()
}

/// Discrete profile of a developed channel flow with the same discrete flow rate, so that nothing changes along it.
fn developed(flow: &Projection<2>) -> f64 {
    norms::velocity(flow, |x| [6.0 * x[1] * (1.0 - x[1]), 0.0]).linf
}

#[test]
fn a_developed_flow_passes_both_outlets() {
    for outlet in [Side::ConvectiveOutlet, Side::PressureOutlet(7.0)] {
        let mut flow = channel(outlet.clone(), [24, 16]);
        flow.set_velocity(|x| [6.0 * x[1] * (1.0 - x[1]), 0.0]);
        while flow.time() < 20.0 {
            flow.advance(flow.stable_dt(0.4), [0.0; 2]).unwrap();
        }
        // Only the profile's discretisation error is left, which the wider grid halves twice.
        assert!(developed(&flow) < 0.02, "{outlet:?}: {}", developed(&flow));
        assert!(flow.statistics().divergence < 1e-11, "{}", flow.statistics().divergence);
        // The pressure falls by 12 ρνū/H² per length.
        let p = |i: usize| flow.pressure().row(8)[i];
        let gradient = (p(20) - p(4)) / (16.0 * 3.0 / 24.0);
        assert!((gradient / (-12.0 * OIL.density * OIL.viscosity) - 1.0).abs() < 0.01, "{gradient}");
        if let Side::PressureOutlet(given) = outlet {
            let end = p(23) + 0.5 * 3.0 / 24.0 * gradient;
            assert!((end - given).abs() < 2e-3, "{end}");
        }
    }
}

/// In steady flow what the sides do is what viscosity takes: the pressure, and the profile that enters otherwise than it leaves.
#[test]
fn the_work_of_inlets_and_outlets_is_what_viscosity_takes() {
    for outlet in [Side::ConvectiveOutlet, Side::PressureOutlet(7.0)] {
        let grid = CartesianGrid::new([24, 16], [3.0, 1.0]).unwrap();
        let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
        let mut flow = Projection::new(grid, [[inlet, outlet.clone()], Side::WALL.both()], OIL).unwrap();
        while flow.time() < 40.0 {
            flow.advance(flow.stable_dt(0.4), [0.0; 2]).unwrap();
        }
        let (sides, taken) = (flow.side_power(), flow.statistics().dissipation);
        let left = sides.carried + sides.pressure - taken;
        assert!(left.abs() < 1e-9 * taken, "{outlet:?}: {left:e} of {taken} {sides:?}");
        assert!(sides.carried.abs() > 0.05 * taken && sides.pressure > 0.5 * taken, "{taken} {sides:?}");
    }
}

#[test]
fn two_given_pressures_drive_a_channel() {
    let grid = CartesianGrid::new([24, 16], [3.0, 1.0]).unwrap();
    let sides = [[Side::PressureOutlet(5.0), Side::PressureOutlet(2.0)], Side::WALL.both()];
    let mut flow = Projection::new(grid, sides, Fluid { density: 2.0, viscosity: 0.5 }).unwrap();
    while flow.time() < 4.0 {
        flow.advance(flow.stable_dt(0.4).min(5e-3), [0.0; 2]).unwrap();
    }
    // u = (Δp/L) y(1 − y)/2ρν, to round-off.
    let off = norms::velocity(&flow, |x| [0.5 * x[1] * (1.0 - x[1]), 0.0]).linf;
    assert!(off < 1e-6, "{off}");
}

/// A steady side opposite one that changes in time is not taken to change.
#[test]
fn couette_flow_between_a_wall_and_a_function_of_time_is_linear() {
    let grid = CartesianGrid::new([2, 16], [0.1, 1.0]).unwrap();
    let upper = Side::Inlet(Profile::function(|_, t| [2.0 * t.min(1.0), 0.0, 0.0]));
    let sides = [Side::Periodic.both(), [Side::Wall([1.0, 0.0, 0.0]), upper]];
    let fluid = Fluid { density: 1.0, viscosity: 1.0 };
    let mut flow = Projection::new(grid, sides, fluid).unwrap().with_diffusion(Diffusion::Implicit);
    while flow.time() < 4.0 {
        flow.advance(0.01, [0.0; 2]).unwrap();
    }
    let off = norms::velocity(&flow, |x| [1.0 + x[1], 0.0]).linf;
    assert!(off < 1e-8, "{off}");
}

#[test]
fn inlets_that_cease_to_balance_are_told() {
    let grid = CartesianGrid::new([8, 8], [1.0, 1.0]).unwrap();
    let sides = |rate: f64| {
        let right = Profile::function(move |_, t| [1.0 + rate * t, 0.0, 0.0]);
        [[Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0])), Side::Inlet(right)], Side::FreeSlip.both()]
    };
    let mut flow = Projection::new(grid.clone(), sides(0.1), OIL).unwrap();
    let error = (0..100).find_map(|_| flow.advance(0.01, [0.0; 2]).err());
    assert!(matches!(error, Some(FlowError::MassBalance { .. })), "{error:?}");
    assert!((0.18..0.23).contains(&flow.time()), "{}", flow.time());
    // A lid whose normal component is round-off.
    let lid = Profile::function(|x, _| [1.0, 1e-16 * (1.0 + x[0]), 0.0]);
    let sides = [Side::WALL.both(), [Side::WALL, Side::Inlet(lid)]];
    assert!(Projection::new(grid, sides, OIL).is_ok());
}

#[test]
fn explicit_diffusion_is_stable_between_close_walls() {
    for n in 1..12 {
        let grid = CartesianGrid::new([1, n], [50.0, 1.0]).unwrap();
        let sides = [Side::Periodic.both(), Side::WALL.both()];
        let flow = Projection::new(grid, sides, OIL).unwrap().with_diffusion(Diffusion::Explicit);
        let mut flow = flow;
        flow.set_velocity(|x| [(37.0 * x[1]).sin(), 0.0]);
        let dt = 0.99 * flow.viscous_limit();
        let start = flow.statistics().kinetic_energy;
        for _ in 0..300 {
            flow.advance(dt, [0.0; 2]).unwrap();
        }
        assert!(flow.statistics().kinetic_energy < start, "{n} cells");
    }
}

#[test]
fn a_vortex_leaves_through_a_convective_outlet() {
    let grid = CartesianGrid::new([64, 32], [4.0, 2.0]).unwrap();
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let sides = [[inlet, Side::ConvectiveOutlet], Side::FreeSlip.both()];
    let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 1e-3 }).unwrap();
    flow.set_velocity(|x| {
        let (a, b) = (x[0] - 2.0, x[1] - 1.0);
        let swirl = 2.0 * (-(a * a + b * b) / 0.06).exp();
        [1.0 - swirl * b, swirl * a]
    });
    let uniform = |flow: &Projection<2>| norms::velocity(flow, |_| [1.0, 0.0]).linf;
    let start = uniform(&flow);
    while flow.time() < 6.0 {
        flow.advance(flow.stable_dt(0.4), [0.0; 2]).unwrap();
    }
    assert!(uniform(&flow) < 0.02 * start, "{} of {start}", uniform(&flow));
}

#[test]
fn an_inlet_that_stops_leaves_fluid_at_rest() {
    let grid = CartesianGrid::new([32, 16], [2.0, 1.0]).unwrap();
    let gust = Profile::function(|_, t| [if t < 1.0 { 1.0 } else { 0.0 }, 0.0, 0.0]);
    for outlet in [Side::ConvectiveOutlet, Side::PressureOutlet(0.0)] {
        let sides = [[Side::Inlet(gust.clone()), outlet], Side::WALL.both()];
        let mut flow = Projection::new(grid.clone(), sides, OIL).unwrap();
        while flow.time() < 12.0 {
            flow.advance(flow.stable_dt(0.4).min(0.01), [0.0; 2]).unwrap();
        }
        let left = norms::velocity(&flow, |_| [0.0; 2]).linf;
        assert!(left < 1e-2, "{left}");
    }
}

#[test]
fn patches_let_fluid_in_and_out_of_one_side() {
    let grid = CartesianGrid::new([20, 20], [1.0, 1.0]).unwrap();
    let patch =
        |low: f64, high: f64, side: Side| Patch { lower: [0.0, low, 0.0], upper: [1.0, high, 0.0], side };
    let inlet = || Side::Inlet(Profile::Parabolic { peak: 1.0 });
    let left = vec![patch(0.6, 0.9, inlet()), patch(0.0, 1.0, Side::WALL)];
    let right = vec![patch(0.1, 0.4, Side::ConvectiveOutlet), patch(0.0, 1.0, Side::WALL)];
    let sides = [[Side::Patches(left), Side::Patches(right)], Side::WALL.both()];
    let mut flow = Projection::new(grid.clone(), sides, OIL).unwrap();
    for _ in 0..200 {
        flow.advance(2e-3, [0.0; 2]).unwrap();
    }
    assert!(flow.statistics().divergence < 1e-11);
    // Two thirds of the peak over 0.3 m, summed at face centres.
    let through: f64 = (0..20).map(|j| flow.velocity().field(0).row(j)[10] * 0.05).sum();
    assert!((through - 0.2).abs() < 0.005, "{through}");

    let gap = vec![patch(0.5, 1.0, Side::WALL)];
    let sides = [[Side::Patches(gap), Side::WALL], Side::WALL.both()];
    let error = Projection::new(grid, sides, OIL).err();
    assert!(
        matches!(&error, Some(FlowError::Boundary { what }) if what.contains("lower side of axis 0")),
        "{error:?}"
    );
}

#[test]
fn what_enters_must_be_able_to_leave() {
    let grid = CartesianGrid::new([8, 8], [1.0, 1.0]).unwrap();
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let error = Projection::new(grid.clone(), [[inlet.clone(), Side::WALL], Side::WALL.both()], OIL).err();
    assert_eq!(error, Some(FlowError::MassBalance { net: -1.0, inflow: 1.0 }));
    // Later, in a function of time.
    let later = Side::Inlet(Profile::function(|_, t| [if t > 0.1 { 1.0 } else { 0.0 }, 0.0, 0.0]));
    let mut flow = Projection::new(grid.clone(), [[later, Side::WALL], Side::WALL.both()], OIL).unwrap();
    let error = (0..20).find_map(|_| flow.advance(0.01, [0.0; 2]).err());
    assert!(matches!(error, Some(FlowError::MassBalance { .. })), "{error:?}");
    // In and out by inlets alone.
    let flow = Projection::new(grid, [[inlet.clone(), inlet], Side::FreeSlip.both()], OIL);
    assert!(flow.is_ok());
}

#[test]
fn an_axis_of_one_cell_and_stretched_walls_work() {
    let axes = [Axis::geometric(24, 0.0, 2.0, 1.1).unwrap(), Axis::uniform(1, 0.0, 0.1).unwrap()];
    let grid = CartesianGrid::from_axes(axes).unwrap();
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let sides = [[inlet, Side::PressureOutlet(0.0)], Side::FreeSlip.both()];
    let mut flow = Projection::new(grid, sides, OIL).unwrap();
    for _ in 0..50 {
        flow.advance(5e-3, [0.0; 2]).unwrap();
    }
    assert!(norms::velocity(&flow, |_| [1.0, 0.0]).linf < 1e-10);
}

/// Only the gradient to the given pressure tells an outlet on a part of a side the level of the pressure inside.
#[test]
fn the_pressure_behind_a_part_of_a_side_settles_whatever_the_step() {
    let patch =
        |low: f64, high: f64, side: Side| Patch { lower: [0.0, low, 0.0], upper: [1.0, high, 0.0], side };
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let left = Side::Patches(vec![patch(0.5, 1.0, inlet), patch(0.0, 1.0, Side::WALL)]);
    let right = Side::Patches(vec![patch(0.0, 0.5, Side::PressureOutlet(1.0)), patch(0.0, 1.0, Side::WALL)]);
    let sides = || [[left.clone(), right.clone()], [Side::WALL, Side::FreeSlip]];
    let grid = CartesianGrid::new([24, 20], [1.0, 1.0]).unwrap();
    let fluid = Fluid { density: 1.3, viscosity: 0.02 };
    let mean = |p: &Field<2>| p.values().sum::<f64>() / 480.0;
    let [(fine, fine_energy), (coarse, coarse_energy)] = [2e-3, 4e-3].map(|dt| {
        let mut flow = Projection::new(grid.clone(), sides(), fluid).unwrap();
        while flow.time() < 6.0 {
            flow.advance(dt, [0.0; 2]).unwrap();
        }
        (mean(flow.pressure()), flow.statistics().kinetic_energy)
    });
    assert!((fine - coarse).abs() < 1e-3 && (fine_energy / coarse_energy - 1.0).abs() < 1e-4);
    let mut steady = Simple::new(grid, sides(), fluid).unwrap();
    steady.solve(500, 1e-6).unwrap();
    let (level, energy) = (mean(steady.pressure()), steady.statistics().kinetic_energy);
    assert!((fine - level).abs() < 1e-3 * (level - 1.0), "{fine} {level}");
    assert!((fine_energy / energy - 1.0).abs() < 1e-4, "{fine_energy} {energy}");
}
