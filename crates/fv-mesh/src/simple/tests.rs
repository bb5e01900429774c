//! The steady algorithm against exact solutions and a benchmark.
use super::*;
use crate::{Axis, Cluster, Patch, Piso, Profile, Velocity};
use std::f64::consts::{PI, TAU};

fn fluid(viscosity: f64) -> Fluid {
    Fluid { density: 1.0, viscosity }
}

fn cavity(n: usize, reynolds: f64) -> Simple<2> {
    let grid = CartesianGrid::new([n, n], [1.0, 1.0]).unwrap();
    let sides = [Side::WALL.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]];
    Simple::new(grid, sides, fluid(1.0 / reynolds)).unwrap()
}

/// Value of component `c` at its node (i, j) on the lower face of that cell.
fn at(velocity: &Velocity<2>, grid: &CartesianGrid<2>, c: usize, [i, j]: [usize; 2]) -> f64 {
    let s = grid.stride();
    velocity.field(c).data()[grid.base() + i * s[0] + j * s[1]]
}

fn difference(a: &Velocity<2>, b: &Velocity<2>) -> f64 {
    let worst = |c: usize| {
        a.field(c).values().zip(b.field(c).values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    worst(0).max(worst(1))
}

#[test]
fn poiseuille_is_exact() {
    let (n, nu, force) = (16, 0.1, 1.2);
    let grid = CartesianGrid::new([3, n], [0.3, 1.0]).unwrap();
    let mut flow = Simple::new(grid, [Side::Periodic.both(), Side::WALL.both()], fluid(nu)).unwrap();
    flow.set_force([force, 0.0]);
    flow.solve(500, 1e-12).unwrap();
    let h = 1.0 / n as f64;
    for j in 0..n {
        let y = (j as f64 + 0.5) * h;
        let exact = force / (2.0 * nu) * y * (1.0 - y);
        assert!((at(flow.velocity(), flow.grid(), 0, [1, j]) - exact).abs() < 1e-9);
    }
}

#[test]
fn channel_from_parabolic_inlet_to_pressure_outlet() {
    let (n, nu, peak, rho) = (16, 0.05, 1.5, 2.0);
    let grid = CartesianGrid::new([96, n], [6.0, 1.0]).unwrap();
    let sides = [[Side::Inlet(Profile::Parabolic { peak }), Side::PressureOutlet(3.0)], Side::WALL.both()];
    let mut flow = Simple::new(grid, sides, Fluid { density: rho, viscosity: nu }).unwrap();
    flow.solve(400, 1e-9).unwrap();
    let slope = rho * 8.0 * nu * peak;
    let p: Vec<f64> = flow.pressure().row(n / 2).to_vec();
    // Over one unit of length.
    let middle = p[40] - p[56];
    assert!((middle / slope - 1.0).abs() < 1e-5, "{middle} {slope}");
    // Down to the given pressure.
    assert!((p[80] - 3.0 - slope * 15.5 / 16.0).abs() < 1e-5 * slope, "{} {slope}", p[80]);
    assert!(flow.statistics().divergence < 1e-7);
}

/// Ghia, Ghia & Shin (1982), J. Comput. Phys. 48, 387, Tables I and II, Re = 100: (y, u) on the vertical and (x, v) on the
/// horizontal line through the centre.
const GHIA_U: [[f64; 2]; 15] = [
    [0.9766, 0.84123],
    [0.9688, 0.78871],
    [0.9609, 0.73722],
    [0.9531, 0.68717],
    [0.8516, 0.23151],
    [0.7344, 0.00332],
    [0.6172, -0.13641],
    [0.5000, -0.20581],
    [0.4531, -0.21090],
    [0.2813, -0.15662],
    [0.1719, -0.10150],
    [0.1016, -0.06434],
    [0.0703, -0.04775],
    [0.0625, -0.04192],
    [0.0547, -0.03717],
];
const GHIA_V: [[f64; 2]; 15] = [
    [0.9688, -0.05906],
    [0.9609, -0.07391],
    [0.9531, -0.08864],
    [0.9453, -0.10313],
    [0.9063, -0.16914],
    [0.8594, -0.22445],
    [0.8047, -0.24533],
    [0.5000, 0.05454],
    [0.2344, 0.17527],
    [0.2266, 0.17507],
    [0.1563, 0.16077],
    [0.0938, 0.12317],
    [0.0781, 0.10890],
    [0.0703, 0.10091],
    [0.0625, 0.09233],
];

/// Linear interpolation among values at the cell centres of [0, 1].
fn between(values: &[f64], x: f64) -> f64 {
    let s = x * values.len() as f64 - 0.5;
    let i = (s.floor().max(0.0) as usize).min(values.len() - 2);
    values[i] + (s - i as f64) * (values[i + 1] - values[i])
}

#[test]
fn cavity_has_the_velocities_of_ghia() {
    let mut flow = cavity(64, 100.0);
    let info = flow.solve(200, 1e-6).unwrap();
    let (u, v): (Vec<f64>, Vec<f64>) = (0..64)
        .map(|k| {
            let [u, v] = [[32, k], [k, 32]];
            (at(flow.velocity(), flow.grid(), 0, u), at(flow.velocity(), flow.grid(), 1, v))
        })
        .unzip();
    for [y, exact] in GHIA_U {
        assert!((between(&u, y) - exact).abs() < 0.01, "u({y}) = {} not {exact}", between(&u, y));
    }
    for [x, exact] in GHIA_V {
        assert!((between(&v, x) - exact).abs() < 0.01, "v({x}) = {} not {exact}", between(&v, x));
    }
    assert!(info.iterations <= 200 && info.largest() <= 1e-6);
    // Higher Reynolds numbers converge as fast.
    cavity(64, 400.0).solve(200, 1e-6).unwrap();
}

/// Largest error of u behind a grid of n × n cells (Kovasznay 1948, Re = 40).
fn kovasznay(n: usize, scheme: Convection) -> f64 {
    let lambda = 20.0 - (400.0 + 4.0 * PI * PI).sqrt();
    let h = 1.0 / n as f64;
    let u = move |x: f64, y: f64| 1.0 - (lambda * x).exp() * (TAU * y).cos();
    let v = move |x: f64, y: f64| lambda / TAU * (lambda * x).exp() * (TAU * y).sin();
    // Means over the faces, so that what enters leaves.
    let sinc = (0.5 * TAU * h).sin() / (0.5 * TAU * h);
    let inlet = Side::Inlet(Profile::function(move |x, _| {
        [1.0 - (lambda * x[0]).exp() * (TAU * x[1]).cos() * sinc, v(x[0], x[1]), 0.0]
    }));
    let grid = CartesianGrid::new([n, n], [1.0, 1.0]).unwrap().with_origin([-0.5, -0.5]).unwrap();
    let sides = [inlet.both(), Side::FreeSlip.both()];
    let mut flow = Simple::new(grid, sides, fluid(1.0 / 40.0)).unwrap().with_convection(scheme);
    flow.set_velocity(|_| [1.0, 0.0]);
    flow.solve(1000, 1e-8).unwrap();
    let mut worst = 0.0_f64;
    for (j, i) in (0..n).flat_map(|j| (1..n).map(move |i| (j, i))) {
        let (x, y) = (-0.5 + i as f64 * h, -0.5 + (j as f64 + 0.5) * h);
        worst = worst.max((at(flow.velocity(), flow.grid(), 0, [i, j]) - u(x, y)).abs());
        worst = worst.max((at(flow.velocity(), flow.grid(), 1, [j, i]) - v(y, x)).abs());
    }
    worst
}

#[test]
fn kovasznay_flow_has_the_order_of_the_scheme() {
    for (scheme, least) in [
        (Convection::Central, 1.9),
        (Convection::Quick, 1.9),
        (Convection::LinearUpwind, 1.7),
        (Convection::Upwind, 0.8),
    ] {
        let errors = [24, 48].map(|n| kovasznay(n, scheme));
        let order = (errors[0] / errors[1]).log2();
        assert!(order > least, "{scheme:?}: errors {errors:?}, order {order}");
    }
}

/// A box with every kind of side: an inlet and a wall on the left, both kinds of outlets (one at a time) on the
/// right, free slip above and a sliding wall below.
fn box_of_sides(outlet: Side) -> [[Side; 2]; 2] {
    let patch =
        |from: f64, to: f64, side: Side| Patch { lower: [0.0, from, 0.0], upper: [0.0, to, 0.0], side };
    let left = Side::Patches(vec![
        patch(0.5, 1.0, Side::Inlet(Profile::Uniform([1.0, 0.2, 0.0]))),
        patch(0.0, 1.0, Side::WALL),
    ]);
    let right = Side::Patches(vec![patch(0.0, 0.75, outlet), patch(0.0, 1.0, Side::WALL)]);
    [[left, right], [Side::Wall([0.3, 0.0, 0.0]), Side::FreeSlip]]
}

#[test]
fn every_kind_of_side_conserves_mass() {
    for outlet in [Side::ConvectiveOutlet, Side::PressureOutlet(1.0)] {
        let grid = CartesianGrid::new([32, 16], [2.0, 1.0]).unwrap();
        let mut flow = Simple::new(grid, box_of_sides(outlet.clone()), fluid(0.02)).unwrap();
        let info = flow.solve(600, 1e-8).unwrap_or_else(|e| panic!("{outlet:?}: {e}"));
        assert!(flow.statistics().divergence < 1e-6, "{outlet:?} {info:?}");
        let h = 1.0 / 16.0;
        for i in 0..=32 {
            let through: f64 = (0..16).map(|j| h * at(flow.velocity(), flow.grid(), 0, [i, j])).sum();
            assert!((through - 0.5).abs() < 1e-6, "{outlet:?}: {through} through section {i}");
        }
    }
}

#[test]
fn agrees_with_piso() {
    for outlet in [Side::ConvectiveOutlet, Side::PressureOutlet(1.0)] {
        let grid = CartesianGrid::new([32, 16], [2.0, 1.0]).unwrap();
        let sides = box_of_sides(outlet.clone());
        let mut steady = Simple::new(grid.clone(), sides.clone(), fluid(0.02)).unwrap();
        steady.solve(600, 1e-9).unwrap();
        let mut flow = Piso::new(grid, sides, fluid(0.02)).unwrap();
        for _ in 0..600 {
            flow.advance(0.1, [0.0; 2], &mut ()).unwrap();
        }
        let error = difference(steady.velocity(), flow.velocity());
        assert!(error < 1e-6, "{outlet:?}: {error:e}");
        let p = |f: &Field<2>| f.row(5)[7] - f.row(8)[20];
        assert!((p(steady.pressure()) - p(flow.pressure())).abs() < 1e-5);
    }
}

#[test]
fn constant_eddy_viscosity_is_viscosity() {
    let mut plain = cavity(20, 50.0);
    plain.solve(400, 1e-10).unwrap();
    let mut eddy = cavity(20, 200.0);
    let mut field = Field::zeros(eddy.grid());
    field.data_mut().fill(1.0 / 50.0 - 1.0 / 200.0);
    eddy.set_eddy_viscosity(Some(&field));
    eddy.solve(400, 1e-10).unwrap();
    let error = difference(plain.velocity(), eddy.velocity());
    assert!(error < 1e-8, "{error:e}");
}

#[test]
fn eddy_viscosity_that_varies_balances_the_stress() {
    // (ν + ν_t) u' = f (½ − y) holds on every edge between cells, for ν_t = y.
    let (n, nu, force) = (20, 0.05, 1.0);
    let h = 1.0 / n as f64;
    let grid = CartesianGrid::new([4, n], [0.2, 1.0]).unwrap();
    let mut flow = Simple::new(grid, [Side::Periodic.both(), Side::WALL.both()], fluid(nu)).unwrap();
    let mut eddy = Field::zeros(flow.grid());
    let stride = flow.grid().stride()[1];
    for (row, values) in eddy.data_mut().chunks_exact_mut(stride).enumerate() {
        values.fill((row as f64 - 1.5) * h);
    }
    flow.set_eddy_viscosity(Some(&eddy));
    flow.set_force([force, 0.0]);
    flow.solve(2000, 1e-12).unwrap();
    let u = |j: usize| at(flow.velocity(), flow.grid(), 0, [2, j]);
    // The flux through the lower wall follows from the no-slip there; fluxes change by f h from edge to edge.
    // (by the parabola through the wall and two nodes).
    let wall = nu * (3.0 * u(0) - u(1) / 3.0) / h;
    for j in 1..n {
        let flux = (nu + j as f64 * h) * (u(j) - u(j - 1)) / h;
        assert!((flux - (wall - force * j as f64 * h)).abs() < 1e-9, "{flux} on edge {j}");
    }
}

#[test]
fn pinned_nodes_are_a_wall() {
    // A channel whose upper half is solid: the parabola of half the width, the wall on the first pinned node.
    let (n, nu, force) = (32, 0.1, 1.0);
    let grid = CartesianGrid::new([4, n], [0.125, 1.0]).unwrap();
    let mut flow = Simple::new(grid, [Side::Periodic.both(), Side::WALL.both()], fluid(nu)).unwrap();
    flow.set_force([force, 0.0]);
    let (base, s) = (flow.grid().base(), flow.grid().stride());
    let solid = (16..n).flat_map(|j| (0..4).map(move |i| base + i * s[0] + j * s[1]));
    let nodes: Vec<_> = solid.flat_map(|o| [(0, o, 0.0), (1, o, 0.0)]).collect();
    flow.pin(nodes).unwrap();
    flow.solve(600, 1e-12).unwrap();
    let h = 1.0 / n as f64;
    let width = 16.5 * h;
    let u = |j: usize| at(flow.velocity(), flow.grid(), 0, [1, j]);
    for j in 0..16 {
        let y = (j as f64 + 0.5) * h;
        // Zero half a cell below the first node in the mean, zero on the node at `width`.
        let exact = force / (2.0 * nu) * y * (width - y);
        assert!((u(j) - exact).abs() < 1e-9, "{} {exact}", u(j));
    }
    assert!((16..n).all(|j| u(j) == 0.0));
}

#[test]
fn duct_in_three_dimensions_on_a_stretched_grid() {
    // Mean velocity of square-duct flow: 0.0351442539 f a²/ν (series of Boussinesq 1868, width a).
    let axis = |n| Axis::tanh(n, 0.0, 1.0, 1.2, Cluster::Both).unwrap();
    let mean = |n: usize| {
        let axes = [axis(n), axis(n), Axis::uniform(2, 0.0, 0.2).unwrap()];
        let grid = CartesianGrid::from_axes(axes).unwrap();
        let sides = [Side::WALL.both(), Side::WALL.both(), Side::Periodic.both()];
        let mut flow = Simple::new(grid, sides, fluid(0.1)).unwrap();
        flow.set_force([0.0, 0.0, 0.1]);
        flow.solve(500, 1e-9).unwrap();
        flow.statistics().volume_flow.z / 0.2
    };
    let errors = [8, 16].map(|n| (mean(n) - 0.035_144_253_9).abs());
    let order = (errors[0] / errors[1]).log2();
    assert!(errors[1] < 5e-4 && order > 1.8, "{errors:?} {order}");
}

#[test]
fn results_do_not_depend_on_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut flow = cavity(48, 100.0);
            (0..5).for_each(|_| assert!(flow.iterate().is_ok()));
            flow.velocity().field(0).data().to_vec()
        })
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn bad_input_is_an_error() {
    let new = |sides, viscosity| {
        Simple::<2>::new(CartesianGrid::new([4, 4], [1.0, 1.0]).unwrap(), sides, fluid(viscosity))
    };
    assert!(matches!(new(Side::WALL.everywhere(), -1.0), Err(FlowError::Fluid { .. })));
    let half = [[Side::Periodic, Side::WALL], Side::WALL.both()];
    assert!(matches!(new(half, 1.0), Err(FlowError::Boundary { .. })));
    let filling = [[Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0])), Side::WALL], Side::WALL.both()];
    let filled = new(filling, 1.0).map(|_| ());
    assert!(matches!(filled, Err(FlowError::MassBalance { .. })), "{filled:?}");
    for params in [
        SimpleParams { velocity_relaxation: 1.0, ..Default::default() },
        SimpleParams { pressure_relaxation: f64::NAN, ..Default::default() },
        SimpleParams { viscous_share: 0.0, ..Default::default() },
        SimpleParams { momentum_tolerance: 0.0, ..Default::default() },
        SimpleParams { pressure_tolerance: 2.0, ..Default::default() },
    ] {
        let made = new(Side::WALL.everywhere(), 1.0).unwrap().with_params(params);
        assert!(matches!(made.err(), Some(FlowError::Parameter { .. })), "{params:?}");
    }
    let mut flow = cavity(8, 10.0);
    for node in [(2, 40, 0.0), (0, 0, 0.0), (0, 1 << 40, 0.0), (0, 2 * 12 + 3, f64::NAN)] {
        assert!(matches!(flow.pin([node]), Err(FlowError::Parameter { .. })), "{node:?}");
    }
    assert!(matches!(flow.solve(3, 1e-12), Err(FlowError::NotSteady { iterations: 3, .. })));
    flow.set_force([f64::NAN, 0.0]);
    assert!(matches!(flow.iterate(), Err(FlowError::Diverged { .. })));
}

#[test]
fn simple_proper_converges_too() {
    let mut flow = cavity(16, 100.0).with_params(SimpleParams::simple()).unwrap();
    flow.solve(1000, 1e-8).unwrap();
    let mut consistent = cavity(16, 100.0);
    consistent.solve(1000, 1e-8).unwrap();
    assert!(difference(flow.velocity(), consistent.velocity()) < 1e-6);
}

/// The potential flow between sides without friction is the stream that enters.
#[test]
fn the_first_guess_is_freed_of_divergence() {
    let grid = CartesianGrid::new([24, 8], [3.0, 1.0]).unwrap();
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let sides = [[inlet, Side::PressureOutlet(0.0)], Side::FreeSlip.both()];
    let mut flow = Simple::new(grid, sides, fluid(1e-3)).unwrap();
    flow.free_first_guess().unwrap();
    // The outlet, too.
    for (i, j) in (0..=24).flat_map(|i| (0..8).map(move |j| (i, j))) {
        assert!((at(flow.velocity(), flow.grid(), 0, [i, j]) - 1.0).abs() < 1e-2, "{i} {j}");
    }
    // What is free of it stays to the bit.
    let before = flow.velocity().clone();
    flow.set_velocity(|_| [1.0, 0.0]);
    let stream = flow.velocity().clone();
    flow.free_first_guess().unwrap();
    assert_eq!(difference(flow.velocity(), &stream), 0.0);
    assert!(difference(&before, &stream) > 0.0);
}

/// A cavity that starts from the one on half as many cells takes fewer iterations than from rest, to the same flow; from itself one.
#[test]
fn a_flow_on_another_grid_is_a_good_first_guess() {
    let mut coarse = cavity(16, 400.0);
    coarse.solve(1000, 1e-3).unwrap();
    let mut from_rest = cavity(32, 400.0);
    let all = from_rest.solve(1000, 1e-6).unwrap().iterations;
    let mut from_coarse = cavity(32, 400.0);
    from_coarse.start_from(&coarse);
    let some = from_coarse.solve(1000, 1e-6).unwrap().iterations;
    assert!(some < all, "{some} {all}");
    assert!(difference(from_coarse.velocity(), from_rest.velocity()) < 1e-4);
    let mut again = cavity(32, 400.0);
    again.start_from(&from_coarse);
    assert_eq!(again.solve(1000, 1e-6).unwrap().iterations, 1);
}

/// What is linear stays so on any grid in a smaller box; in a larger one it goes on as at the outermost nodes, nothing is extrapolated.
#[test]
fn linear_flows_and_pressures_start_as_they_are() {
    let sides = || Side::FreeSlip.everywhere();
    let axis = |n: usize, from: f64, to: f64| Axis::tanh(n, from, to, 1.2, Cluster::Both).unwrap();
    let linear = |x: [f64; 2]| [1.0 + 0.3 * x[0] - 0.2 * x[1], 0.5 - 0.3 * x[1] + 0.1 * x[0]];
    let grid = CartesianGrid::from_axes([axis(12, 0.0, 2.0), axis(9, 0.0, 1.0)]).unwrap();
    let mut known = Simple::new(grid.clone(), sides(), fluid(0.1)).unwrap();
    known.set_velocity(linear);
    let p = |x: [f64; 2]| 3.0 + 2.0 * x[0] - x[1];
    let values: Vec<f64> = (0..grid.n_cells()).map(|cell| p(grid.centre(grid.cell(cell)))).collect();
    kernels::copy_dense(&grid, &values, &mut known.state.pressure);
    let grid = CartesianGrid::from_axes([axis(7, 0.3, 1.6), axis(11, 0.2, 0.8)]).unwrap();
    let mut flow = Simple::new(grid.clone(), sides(), fluid(0.1)).unwrap();
    flow.start_from(&known);
    for [i, j] in [[1, 0], [4, 3], [6, 9]] {
        let (x, y) = (grid.axis(0).faces()[i], grid.axis(1).centre(j));
        assert!((at(flow.velocity(), &grid, 0, [i, j]) - linear([x, y])[0]).abs() < 1e-12);
        let centre = grid.centre([i, j]);
        assert!((flow.pressure().row(j)[i] - p(centre)).abs() < 1e-12);
    }
    let grid = CartesianGrid::new([8, 4], [4.0, 1.0]).unwrap();
    let mut beyond = Simple::new(grid, sides(), fluid(0.1)).unwrap();
    beyond.start_from(&known);
    let row = beyond.pressure().row(1).to_vec();
    let outermost = p([known.grid().axis(0).centre(11), 0.375]);
    assert!(row[4..].iter().all(|p| (p - outermost).abs() < 1e-12), "{row:?} {outermost}");
}
