//! Extreme input: bounded, or a typed error that names the step; never a silent NaN.
use fv_mesh::{Axis, CartesianGrid, Cluster, Convection, FlowError, Fluid, Projection, Side};

/// Runs `steps` steps; the kinetic energy at the end over that at the start (or over that of unit speed), or the error.
fn run<const D: usize>(mut flow: Projection<D>, steps: usize, courant: f64) -> Result<f64, FlowError> {
    let start = flow.statistics().kinetic_energy;
    for _ in 0..steps {
        flow.advance(flow.stable_dt(courant).min(1.0), [0.0; D])?;
    }
    let end = flow.statistics().kinetic_energy;
    assert!(end.is_finite());
    let unit = 0.5 * flow.fluid().density * flow.grid().volume();
    Ok(end / start.max(unit))
}

fn cavity(axes: [Axis; 2], viscosity: f64) -> Projection<2> {
    let grid = CartesianGrid::from_axes(axes).unwrap();
    let sides = [Side::WALL.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]];
    let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity }).unwrap();
    flow.set_velocity(|x| [x[1], 0.0]);
    flow
}

#[test]
fn aspect_ratios_and_stretching() {
    let uniform = |n: usize, to: f64| Axis::uniform(n, 0.0, to).unwrap();
    let tanh = |n: usize, to: f64| Axis::tanh(n, 0.0, to, 3.5, Cluster::Both).unwrap();
    let cases = [
        [uniform(16, 16.0), uniform(16, 0.016)],
        [uniform(17, 0.01), uniform(13, 10.0)],
        [tanh(31, 1.0), tanh(29, 1.0)],
        [Axis::geometric(24, 0.0, 1.0, 1.5).unwrap(), Axis::geometric(24, 0.0, 1.0, 1.0 / 1.5).unwrap()],
        [uniform(1, 1.0), uniform(16, 1.0)],
        [uniform(7, 1.0), uniform(1, 1.0)],
        [uniform(1, 1.0), uniform(1, 1.0)],
    ];
    for (i, axes) in cases.into_iter().enumerate() {
        let energy = run(cavity(axes, 0.01), 60, 0.4).unwrap_or_else(|e| panic!("case {i}: {e}"));
        assert!(energy < 4.0, "case {i}: {energy}");
    }
}

#[test]
fn reynolds_numbers_from_a_thousandth_to_ten_million() {
    for exponent in -3..=7 {
        let axis = || Axis::uniform(24, 0.0, 1.0).unwrap();
        let flow = cavity([axis(), axis()], 10.0_f64.powi(-exponent));
        let energy = run(flow, 200, 0.3).unwrap_or_else(|e| panic!("Re 1e{exponent}: {e}"));
        assert!(energy < 2.0, "Re 1e{exponent}: {energy}");
    }
}

#[test]
fn discontinuous_start_with_bounded_schemes() {
    for scheme in Convection::ALL {
        let grid = CartesianGrid::new([32, 31], [1.0, 1.0]).unwrap();
        let fluid = Fluid { density: 1.0, viscosity: 1e-5 };
        let flow = Projection::new(grid, Side::Periodic.everywhere(), fluid).unwrap();
        let mut flow = flow.with_convection(scheme);
        flow.set_velocity(|x| [if x[1] > 0.5 { 1.0 } else { -1.0 }, if x[0] > 0.3 { 0.5 } else { 0.0 }]);
        flow.project(1.0).unwrap();
        let energy = run(flow, 300, 0.3).unwrap();
        assert!(energy < 1.05, "{scheme:?}: {energy}");
    }
}

#[test]
fn a_courant_number_of_0_99_is_bounded_or_told() {
    for scheme in Convection::ALL {
        let axis = || Axis::uniform(32, 0.0, 1.0).unwrap();
        let flow = cavity([axis(), axis()], 1e-3).with_convection(scheme);
        match run(flow, 400, 0.99) {
            Ok(energy) => assert!(energy < 2.0, "{scheme:?}: {energy}"),
            Err(error) => assert!(matches!(error, FlowError::Diverged { .. }), "{error}"),
        }
    }
}

#[test]
fn primes_and_thin_boxes_in_space() {
    for cells in [[13, 7, 11], [1, 8, 8], [8, 1, 8], [8, 8, 1], [2, 2, 2], [1, 1, 5]] {
        for sides in [Side::Periodic.everywhere::<3>(), Side::WALL.everywhere()] {
            let grid = CartesianGrid::new(cells, [1.0, 0.7, 1.3]).unwrap();
            let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 1e-3 }).unwrap();
            flow.set_velocity(|x| [x[1].sin(), (3.0 * x[2]).cos(), x[0]]);
            flow.project(1.0).unwrap();
            let energy = run(flow, 60, 0.3).unwrap_or_else(|e| panic!("{cells:?}: {e}"));
            assert!(energy < 1.1, "{cells:?}: {energy}");
        }
    }
}
