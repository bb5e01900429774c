//! Manufactured solutions, pins, signs and relaxation.
use super::*;
use crate::metrics::Metrics;
use crate::operators::tests::{Family, assert_order, exact, exact_velocity, families, norms};
use crate::{Patch, Profile, Side};
use interfaces::{Closure, Transport};

/// φ = 3 + sin(1.1x + 0.2) cos(0.8y − 0.9) (1 + 0.2z) and ∇φ, ∇²φ.
fn wave(x: [f64; 3]) -> (f64, [f64; 3], f64) {
    let ((sa, ca), (sb, cb)) = ((1.1 * x[0] + 0.2).sin_cos(), (0.8 * x[1] - 0.9).sin_cos());
    let z = 1.0 + 0.2 * x[2];
    let slope = [1.1 * ca * cb * z, -0.8 * sa * sb * z, 0.2 * sa * cb];
    (3.0 + sa * cb * z, slope, -(1.1 * 1.1 + 0.8 * 0.8) * sa * cb * z)
}

fn place<const D: usize>(x: [f64; D]) -> [f64; 3] {
    std::array::from_fn(|a| if a < D { x[a] } else { 0.0 })
}

/// Free of divergence.
fn stream(x: [f64; 3]) -> [f64; 3] {
    [1.0 + 0.3 * x[1], 0.5 + 0.2 * x[0], 0.0]
}

/// Sources and sinks of −∇·(Γ∇φ) + u·∇φ + sink φ with Γ = 0.3 + 0.2x.
fn source(x: [f64; 3]) -> f64 {
    let (phi, slope, laplacian) = wave(x);
    let (u, gamma) = (stream(x), 0.3 + 0.2 * x[0]);
    let convection: f64 = (0..3).map(|a| u[a] * slope[a]).sum();
    convection - gamma * laplacian - 0.2 * slope[0] + (1.0 + x[1]) * phi
}

fn dense<const D: usize>(grid: &CartesianGrid<D>, f: impl Fn([f64; 3]) -> f64) -> Vec<f64> {
    (0..grid.n_cells()).map(|i| f(place(grid.centre(grid.cell(i))))).collect()
}

/// Error of the steady solution; the outer eighths of each axis are pinned to the exact values.
fn steady_error<const D: usize>(family: Family, n: usize, scheme: Convection) -> [f64; 2] {
    let grid: CartesianGrid<D> = family.grid(n);
    let sides = Sides::new(Side::FreeSlip.everywhere()).unwrap();
    let velocity = exact_velocity(&grid, &Metrics::new(&grid, [false; D]), |x| {
        let u = stream(place(x));
        std::array::from_fn(|a| u[a])
    });
    let params = TransportParams { scheme, tolerance: 1e-12, ..TransportParams::default() };
    let mut cells = CellTransport::new(&grid, &sides, params).unwrap();
    let mut flow = cells.on(&velocity).unwrap();
    let (gamma, sink) = (dense(&grid, |x| 0.3 + 0.2 * x[0]), dense(&grid, |x| 1.0 + x[1]));
    let source = dense(&grid, source);
    let solution = dense(&grid, |x| wave(x).0);
    let pinned: Vec<(usize, f64)> = (0..grid.n_cells())
        .filter(|&i| grid.cell(i).iter().any(|&k| k < n / 8 || k >= n - n / 8))
        .map(|i| (i, solution[i]))
        .collect();
    let e = Equation { pinned: &pinned, ..Equation::new(&gamma, &source, &sink) };
    let mut phi = vec![3.0; grid.n_cells()];
    let mut last = f64::INFINITY;
    for _ in 0..60 {
        last = flow.solve(&e, &mut phi).unwrap().initial_residual;
        if last < 1e-10 {
            break;
        }
    }
    assert!(last < 1e-10, "deferred correction does not converge: {last:e}");
    for &(cell, value) in &pinned {
        assert_eq!(phi[cell], value);
    }
    let mut values = phi.iter();
    let mut found = Field::zeros(&grid);
    found.set(|_| *values.next().unwrap());
    norms(&found, &Field::from_fn(&grid, |x| wave(place(x)).0), |_| 1.0)
}

#[test]
fn steady_solutions_have_the_order_of_the_scheme() {
    for family in [Family::Uniform, Family::Tanh] {
        for scheme in Convection::ALL {
            let order = if scheme == Convection::Upwind { 1.0 } else { 2.0 };
            let errors = [48, 96].map(|n| steady_error::<2>(family, n, scheme));
            assert_order(&format!("{family:?} {scheme:?}"), errors[0], errors[1], order);
        }
    }
}

/// Error in a vortex between walls where φ = 3, φ = 3 + Π sin πx.
fn walled_error<const D: usize>(family: Family, n: usize) -> [f64; 2] {
    let pi = std::f64::consts::PI;
    let bump = |x: [f64; 3]| (0..D).map(|a| (pi * x[a]).sin()).product::<f64>();
    let grid: CartesianGrid<D> = family.grid(n);
    let sides = Sides::new(Side::WALL.everywhere()).unwrap();
    let vortex = |x: [f64; 3]| {
        let ((sx, cx), (sy, cy)) = ((pi * x[0]).sin_cos(), (pi * x[1]).sin_cos());
        [sx * cy, -cx * sy, 0.0]
    };
    let velocity = exact_velocity(&grid, &Metrics::new(&grid, [false; D]), |x| {
        let u = vortex(place(x));
        std::array::from_fn(|a| u[a])
    });
    let params = TransportParams { scheme: Convection::Central, tolerance: 1e-11, ..Default::default() };
    let mut cells = CellTransport::new(&grid, &sides, params).unwrap();
    let source = dense(&grid, |x| {
        let slope = |a: usize| pi * (pi * x[a]).cos() * bump(x) / (pi * x[a]).sin();
        let u = vortex(x);
        u[0] * slope(0) + u[1] * slope(1) + (0.3 * D as f64 * pi * pi + 1.0) * bump(x) + 3.0
    });
    let (gamma, sink) = (vec![0.3; grid.n_cells()], vec![1.0; grid.n_cells()]);
    let e = Equation { wall: Some(3.0), ..Equation::new(&gamma, &source, &sink) };
    let mut phi = vec![3.0; grid.n_cells()];
    let mut last = f64::INFINITY;
    for _ in 0..60 {
        last = cells.on(&velocity).unwrap().solve(&e, &mut phi).unwrap().initial_residual;
        if last < 1e-9 {
            break;
        }
    }
    assert!(last < 1e-9, "deferred correction does not converge: {last:e}");
    let mut values = phi.iter();
    let mut found = Field::zeros(&grid);
    found.set(|_| *values.next().unwrap());
    norms(&found, &Field::from_fn(&grid, |x| 3.0 + bump(place(x))), |_| 1.0)
}

#[test]
fn solutions_between_walls_are_of_second_order() {
    for &family in families(2) {
        let errors = [24, 48].map(|n| walled_error::<2>(family, n));
        assert_order(&format!("{family:?} 2-D"), errors[0], errors[1], 2.0);
    }
    for &family in families(3) {
        let errors = [12, 24].map(|n| walled_error::<3>(family, n));
        assert_order(&format!("{family:?} 3-D"), errors[0], errors[1], 2.0);
    }
}

/// A developing layer: inlet, outlet and walls, against the exact φ(y) of Γφ'' = sink φ, φ = cosh.
#[test]
fn inlets_walls_and_outlets_hold_what_they_should() {
    let error = |n: usize| {
        let grid: CartesianGrid<2> = CartesianGrid::new([2, n], [1.0; 2]).unwrap();
        let sides = [[Side::FreeSlip, Side::PressureOutlet(0.0)], Side::WALL.both()];
        let sides = Sides::new(sides).unwrap();
        let velocity = Velocity::zeros(&grid, &sides);
        let mut cells = CellTransport::new(&grid, &sides, TransportParams::default()).unwrap();
        let m = grid.n_cells();
        let (gamma, source, sink) = (vec![0.5; m], vec![0.0; m], vec![2.0; m]);
        let e = Equation { wall: Some(1.0), ..Equation::new(&gamma, &source, &sink) };
        let mut phi = vec![0.0; m];
        cells.on(&velocity).unwrap().solve(&e, &mut phi).unwrap();
        let exact = dense(&grid, |x| (2.0 * (x[1] - 0.5)).cosh() / 1.0_f64.cosh());
        let worst = phi.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        [worst, worst]
    };
    assert_order("walls", error(20), error(40), 2.0);

    // What enters is carried through to the outlet; walls without a value take none of it.
    let grid = CartesianGrid::new([12, 5], [2.0, 1.0]).unwrap();
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let sides = Sides::new([[inlet, Side::ConvectiveOutlet], Side::WALL.both()]).unwrap();
    let velocity = exact_velocity(&grid, &Metrics::new(&grid, [false; 2]), |_| [1.0, 0.0]);
    let mut cells = CellTransport::new(&grid, &sides, TransportParams::default()).unwrap();
    let (zero, gamma) = (vec![0.0; 60], vec![1e-3; 60]);
    let mut phi = zero.clone();
    let e = Equation { inlet: 7.0, ..Equation::new(&gamma, &zero, &zero) };
    cells.on(&velocity).unwrap().solve(&e, &mut phi).unwrap();
    assert!(phi.iter().all(|p| (p - 7.0).abs() < 1e-6), "{phi:?}");
}

#[test]
fn implicit_steps_are_of_first_order_in_time() {
    let grid = CartesianGrid::new([6, 4], [1.0; 2]).unwrap();
    let sides = Sides::new(Side::FreeSlip.everywhere()).unwrap();
    let velocity = Velocity::zeros(&grid, &sides);
    let mut cells = CellTransport::new(&grid, &sides, TransportParams::default()).unwrap();
    let (gamma, source, sink) = (vec![0.1; 24], vec![1.0; 24], vec![2.0; 24]);
    let mut error = |steps: usize| {
        let mut phi = vec![3.0; 24];
        for _ in 0..steps {
            let e = Equation { dt: Some(1.0 / steps as f64), ..Equation::new(&gamma, &source, &sink) };
            cells.on(&velocity).unwrap().solve(&e, &mut phi).unwrap();
        }
        let error = (phi[7] - (0.5 + 2.5 * (-2.0_f64).exp())).abs();
        [error, error]
    };
    assert_order("implicit Euler", error(100), error(200), 1.0);
}

/// A flow between walls with sharp sources: a model of k with production and destruction.
fn reacting(
    method: TransportMethod,
    relax: f64,
    blend: &[(usize, f64, f64)],
) -> (CellTransport<2>, Vec<f64>, SolveInfo) {
    let grid: CartesianGrid<2> = Family::Tanh.grid(24);
    let sides = Sides::new(Side::WALL.everywhere()).unwrap();
    let velocity = exact_velocity(&grid, &Metrics::new(&grid, [false; 2]), |[x, y]| {
        let pi = std::f64::consts::PI;
        [(pi * x).sin() * (pi * y).cos(), -(pi * x).cos() * (pi * y).sin()]
    });
    let params = TransportParams { method, tolerance: 1e-12, max_iterations: 20_000, ..Default::default() };
    let mut cells = CellTransport::new(&grid, &sides, params).unwrap();
    let n = grid.n_cells();
    let gamma = vec![1e-4; n];
    let source = dense(&grid, |x| if (x[0] - 0.5).hypot(x[1] - 0.5) < 0.1 { 1.0 } else { 0.0 });
    let sink = dense(&grid, |x| 50.0 * (1.0 + x[0]));
    let pinned = [(5, 0.0), (40, 50.0), (300, 2.5)];
    let e =
        Equation { wall: Some(0.0), relax, pinned: &pinned, blend, ..Equation::new(&gamma, &source, &sink) };
    let mut phi = vec![0.3; n];
    let mut info = SolveInfo::default();
    for _ in 0..if relax < 1.0 { 80 } else { 1 } {
        info = cells.on(&velocity).unwrap().solve(&e, &mut phi).unwrap();
    }
    assert_eq!([phi[5], phi[40], phi[300]], [0.0, 50.0, 2.5]);
    cells.assemble(&velocity, &e, &phi).unwrap();
    assert!(cells.matrix.is_m_matrix());
    (cells, phi, info)
}

#[test]
fn nothing_negative_from_nothing_negative() {
    for method in [TransportMethod::BiCgStab, TransportMethod::GaussSeidel] {
        let (_, phi, info) = reacting(method, 1.0, &[]);
        let low = phi.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(low >= 0.0 && info.residual <= 1e-12, "{method:?} {low:e} {info:?}");
    }
}

#[test]
fn relaxation_does_not_move_the_fix_point() {
    let (_, plain, _) = reacting(TransportMethod::BiCgStab, 1.0, &[]);
    let (_, relaxed, info) = reacting(TransportMethod::BiCgStab, 0.6, &[]);
    // Cells that nothing reaches go on towards zero.
    assert!(info.residual < 1e-9, "{info:?}");
    for (a, b) in plain.iter().zip(&relaxed) {
        assert!((a - b).abs() < 1e-8 * (1.0 + a.abs()), "{a} {b}");
    }
}

#[test]
fn blends_go_from_the_equation_to_the_value() {
    let (_, plain, _) = reacting(TransportMethod::BiCgStab, 1.0, &[(200, 0.0, 4.0)]);
    let (_, half, _) = reacting(TransportMethod::BiCgStab, 1.0, &[(200, 0.5, 4.0)]);
    let (_, full, _) = reacting(TransportMethod::BiCgStab, 1.0, &[(200, 1.0, 4.0)]);
    let (_, free, _) = reacting(TransportMethod::BiCgStab, 1.0, &[]);
    assert!((plain[200] - free[200]).abs() < 1e-9 && (full[200] - 4.0).abs() < 1e-9);
    assert!(plain[200] < half[200] && half[200] < full[200]);
}

#[test]
fn wall_distances_are_exact() {
    let check = |sides: [[Side; 2]; 3], exact: fn([f64; 3]) -> f64| {
        let grid: CartesianGrid<3> = Family::Mixed.grid(7);
        let sides = Sides::new(sides).unwrap();
        let cells = CellTransport::new(&grid, &sides, TransportParams::default()).unwrap();
        for (i, d) in cells.wall_distance.iter().enumerate() {
            let expected = exact(grid.centre(grid.cell(i)));
            assert!(*d == expected || (d - expected).abs() < 1e-14, "{d} {expected}");
        }
    };
    let (open, wall) = (Side::FreeSlip.both(), Side::WALL.both());
    check([open.clone(), open.clone(), open.clone()], |_| f64::INFINITY);
    check([open.clone(), wall, open.clone()], |x| x[1].min(1.0 - x[1]));
    // A wall with a round trip across the periodic end, and a hole that an earlier patch makes.
    let patches = Side::Patches(vec![
        Patch { lower: [0.2, 0.3, 0.0], upper: [0.8, 0.7, 0.0], side: Side::FreeSlip },
        Patch { lower: [0.0; 3], upper: [0.9, 1.0, 0.0], side: Side::WALL },
        Patch { lower: [0.0; 3], upper: [1.0; 3], side: Side::FreeSlip },
    ]);
    check([Side::Periodic.both(), open.clone(), [patches, Side::FreeSlip]], |x| {
        let in_hole = (x[0] - 0.2).min(0.8 - x[0]).min(x[1] - 0.3).min(0.7 - x[1]).max(0.0);
        let beyond = (x[0] - 0.9).min(1.0 - x[0]).max(0.0);
        in_hole.max(beyond).hypot(x[2])
    });
}

#[test]
fn gradients_and_strain_of_smooth_fields() {
    let error = |n: usize| {
        let grid: CartesianGrid<3> = Family::Mixed.grid(n);
        let sides = Sides::new(Side::FreeSlip.everywhere()).unwrap();
        let metrics = Metrics::new(&grid, [false; 3]);
        let velocity = exact_velocity(&grid, &metrics, |x| [x[1] * x[1], x[0].sin(), x[0] * x[2]]);
        let mut cells = CellTransport::new(&grid, &sides, TransportParams::default()).unwrap();
        let mut flow = cells.on(&velocity).unwrap();
        let a = dense(&grid, |x| wave(x).0);
        let b = dense(&grid, |x| (0.7 * x[0]).exp() + x[2] * x[2] * x[1]);
        let mut out = vec![0.0; grid.n_cells()];
        flow.dot_gradients(&a, &b, &mut out).unwrap();
        let mut values = out.iter();
        let mut found = Field::zeros(&grid);
        found.set(|_| *values.next().unwrap());
        let reference = exact(&grid, &metrics, None, |x| {
            let g = wave(x).1;
            g[0] * 0.7 * (0.7 * x[0]).exp() + g[1] * x[2] * x[2] + g[2] * 2.0 * x[2] * x[1]
        });
        let gradients = norms(&found, &reference, |_| 1.0);
        flow.strain_rate(&mut out).unwrap();
        let mut values = out.iter();
        let mut found = Field::zeros(&grid);
        found.set(|_| *values.next().unwrap());
        let reference = exact(&grid, &metrics, None, |x: [f64; 3]| {
            let (xy, xz, z) = (2.0 * x[1] + x[0].cos(), x[2], x[0]);
            (xy * xy + xz * xz + 2.0 * z * z).sqrt()
        });
        let inside = |x: [f64; 3]| x.iter().map(|x| (16.0 * x * (1.0 - x) - 2.0).clamp(0.0, 1.0)).product();
        [gradients, norms(&found, &reference, inside)]
    };
    let [coarse, fine] = [24, 48].map(error);
    let [coarse_tensor, fine_tensor] = [24, 48].map(gradient_error);
    assert_order("∇u", coarse_tensor, fine_tensor, 2.0);
    // Up to the sides.
    assert_order("∇a·∇b", coarse[0], fine[0], 2.0);
    assert_order("|S|", coarse[1], fine[1], 2.0);
}

/// Of ∂u/∂y, ∂v/∂x and ∂w/∂z, away from the sides.
fn gradient_error(n: usize) -> [f64; 2] {
    let grid: CartesianGrid<3> = Family::Mixed.grid(n);
    let sides = Sides::new(Side::FreeSlip.everywhere()).unwrap();
    let metrics = Metrics::new(&grid, [false; 3]);
    let velocity = exact_velocity(&grid, &metrics, |x| [x[1].powi(3), x[0].sin(), (x[0] * x[2]).exp()]);
    let mut cells = CellTransport::new(&grid, &sides, TransportParams::default()).unwrap();
    let mut out = vec![[[0.0; 3]; 3]; grid.n_cells()];
    cells.on(&velocity).unwrap().velocity_gradient(&mut out).unwrap();
    let mut worst = 0.0_f64;
    for (i, g) in out.iter().enumerate() {
        let x = grid.centre(grid.cell(i));
        if x.iter().all(|x| (0.2..0.8).contains(x)) {
            let exact = [3.0 * x[1] * x[1], x[0].cos(), x[0] * (x[0] * x[2]).exp()];
            for (found, exact) in [g[0][1], g[1][0], g[2][2]].into_iter().zip(exact) {
                worst = worst.max((found - exact).abs());
            }
        }
    }
    [worst, worst]
}

#[test]
fn bad_equations_are_errors() {
    let grid = CartesianGrid::new([3, 2], [1.0; 2]).unwrap();
    let sides = Sides::new(Side::WALL.everywhere()).unwrap();
    let velocity = Velocity::zeros(&grid, &sides);
    let mut cells = CellTransport::new(&grid, &sides, TransportParams::default()).unwrap();
    let mut flow = cells.on(&velocity).unwrap();
    let (one, bad, nan) = ([1.0; 6], [-1.0; 6], [f64::NAN; 6]);
    let good = Equation::new(&one, &one, &one);
    let mut check = |e: Equation<'_>| {
        let error = flow.solve(&e, &mut [1.0; 6]).unwrap_err();
        assert!(matches!(error, SolveError::Value { .. }), "{error}");
    };
    check(Equation { diffusivity: &bad, ..good });
    check(Equation { source: &nan, ..good });
    check(Equation { sink: &bad, ..good });
    check(Equation { pinned: &[(6, 0.0)], ..good });
    check(Equation { pinned: &[(5, f64::NAN)], ..good });
    check(Equation { blend: &[(0, 1.1, 0.0)], ..good });
    check(Equation { steep: &[(0, 1.1)], ..good });
    check(Equation { steep: &[(1, f64::NAN)], ..good });
    check(Equation { steep: &[(6, 0.5)], ..good });
    check(Equation { inlet: f64::NAN, ..good });
    check(Equation { wall: Some(f64::INFINITY), ..good });
    check(Equation { dt: Some(0.0), ..good });
    check(Equation { relax: 0.0, ..good });
    let short = flow.solve(&good, &mut [1.0; 5]);
    assert_eq!(short, Err(SolveError::Length { what: "φ", expected: 6, found: 5 }));
    // Nothing determines the level of φ.
    let zero = [0.0; 6];
    assert!(flow.solve(&Equation::new(&one, &one, &zero), &mut [1.0; 6]).is_err());
    assert!(flow.strain_rate(&mut [0.0; 2]).is_err());
    assert!(flow.dot_gradients(&one, &one, &mut [0.0; 2]).is_err());
    assert_eq!((flow.n_cells(), flow.cell_volume(4)), (6, grid.cell_volume([1, 1])));
    assert!(().eddy_viscosity().is_none());
    ().correct(&mut flow, &[], 1.0, None).unwrap();
    let other = CartesianGrid::new([2, 3], [1.0; 2]).unwrap();
    assert!(cells.on(&Velocity::zeros(&other, &sides)).is_err());
}

/// A front that is carried askew: where a second-order scheme would undershoot, what is positive stays so, and the fix point is the
/// scheme's where it is positive.
#[test]
fn second_order_schemes_keep_signs() {
    let grid = CartesianGrid::new([24, 24], [1.0; 2]).unwrap();
    let inlet = Side::Inlet(Profile::Uniform([1.0, 1.0, 0.0]));
    let sides =
        Sides::new([[inlet.clone(), Side::ConvectiveOutlet], [inlet, Side::ConvectiveOutlet]]).unwrap();
    let velocity = exact_velocity(&grid, &Metrics::new(&grid, [false; 2]), |_| [1.0, 1.0]);
    for scheme in [Convection::LinearUpwind, Convection::Limited, Convection::Quick] {
        let params = TransportParams { scheme, ..TransportParams::steady() };
        let mut cells = CellTransport::new(&grid, &sides, params).unwrap();
        let n = grid.n_cells();
        let (gamma, sink) = (vec![1e-6; n], vec![0.0; n]);
        let source = dense(&grid, |x| if x[0] < 0.5 && x[1] > 0.5 { 1.0 } else { 0.0 });
        let mut phi = vec![1e-6; n];
        let e = Equation { inlet: 1e-6, relax: 0.9, ..Equation::new(&gamma, &source, &sink) };
        let mut info = SolveInfo::default();
        for _ in 0..100 {
            info = cells.on(&velocity).unwrap().solve(&e, &mut phi).unwrap();
            assert!(phi.iter().all(|p| *p > 0.0), "{scheme:?}");
        }
        assert!(scheme != Convection::Limited || info.initial_residual < 1e-3, "{info:?}");
    }
}

/// What spans twelve orders of magnitude is found to the same relative accuracy everywhere.
#[test]
fn small_values_beside_large_ones_are_right() {
    let grid = CartesianGrid::new([2, 40], [0.05, 1.0]).unwrap();
    let sides = Sides::new([Side::Periodic.both(), Side::FreeSlip.both()]).unwrap();
    let velocity = Velocity::zeros(&grid, &sides);
    let mut cells = CellTransport::new(&grid, &sides, TransportParams::default()).unwrap();
    let n = grid.n_cells();
    // Γφ'' = sink φ: φ falls by e^(−√900 h) from cell to cell, 13 orders of magnitude in all.
    let (gamma, source, sink) = (vec![1.0; n], vec![0.0; n], vec![900.0; n]);
    let pinned = [(0, 1e6), (1, 1e6)];
    let e = Equation { pinned: &pinned, ..Equation::new(&gamma, &source, &sink) };
    let mut phi = vec![1e-3; n];
    for _ in 0..3 {
        cells.on(&velocity).unwrap().solve(&e, &mut phi).unwrap();
    }
    // The discrete decay: r + 1/r = 2 + 900 h².
    let m = 1.0 + 450.0 / 1600.0;
    let r: f64 = m - (m * m - 1.0_f64).sqrt();
    for j in 0..30 {
        let ratio = phi[2 * j + 2] / phi[2 * j];
        assert!((ratio / r - 1.0).abs() < 1e-6, "{j} {ratio} {r}");
    }
    assert!(phi[58] < 1e-2);
}

/// Nothing is carried through faces of cells without fluid, by the difference between the schemes neither: what is 1 where it enters
/// stays 1, whatever the values and velocities are in there.
#[test]
fn nothing_passes_faces_of_cells_without_fluid() {
    let grid = CartesianGrid::<2>::new([12, 8], [1.2, 0.8]).unwrap();
    let sides = Sides::new([
        [Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0])), Side::ConvectiveOutlet],
        Side::FreeSlip.both(),
    ])
    .unwrap();
    let velocity = exact_velocity(&grid, &Metrics::new(&grid, [false; 2]), |_| [1.0, -0.5]);
    let mut cells = CellTransport::new(&grid, &sides, TransportParams::steady()).unwrap();
    let n = grid.n_cells();
    let solid = |i: usize| grid.cell(i)[1] >= 4;
    cells.set_walls((0..n).filter(|&i| solid(i)).map(|i| (i, Vec::new())).collect(), false);
    let mut flow = cells.on(&velocity).unwrap();
    let (gamma, none) = (vec![1e-3; n], vec![0.0; n]);
    let e = Equation { inlet: 1.0, ..Equation::new(&gamma, &none, &none) };
    // In the solid it rises towards the fluid, so that no limiter takes the difference away.
    let in_solid = |i: usize| 0.5 * 5_usize.saturating_sub(grid.cell(i)[1]) as f64;
    let mut phi: Vec<f64> = (0..n).map(|i| if solid(i) { in_solid(i) } else { 1.0 }).collect();
    for _ in 0..30 {
        flow.solve(&e, &mut phi).unwrap();
    }
    for i in (0..n).filter(|&i| !solid(i)) {
        assert!((phi[i] - 1.0).abs() < 1e-9, "{} at {:?}", phi[i], grid.cell(i));
    }
}

/// A flow along a plane wall, however that lies on the grid, does not change what changes with the distance from it only: not at all what is linear,
/// a fifth at most of what it else would, what goes like 1/distance, and what goes like its cube not at all either: extrapolated from the
/// upwind side alone that would change by up to U h² φ‴/40.
#[test]
fn a_flow_along_a_wall_leaves_what_changes_across_it() {
    let n = 40;
    let h = 1.0 / n as f64;
    let grid = CartesianGrid::<2>::new([n, n], [1.0, 1.0]).unwrap();
    let sides = Sides::new(Side::FreeSlip.everywhere()).unwrap();
    let none = vec![0.0; n * n];
    for degrees in [0, 10, 30, 45, 75, 105, 150, 200, 260, 340] {
        let (s, c) = f64::from(degrees).to_radians().sin_cos();
        let velocity = exact_velocity(&grid, &Metrics::new(&grid, [false; 2]), |_| [c, s]);
        let distance = |i: usize| {
            let x = grid.centre(grid.cell(i));
            c * (x[1] - 0.503) - s * (x[0] - 0.497)
        };
        let mut cells = CellTransport::new(&grid, &sides, TransportParams::steady()).unwrap();
        let least = 0.3 * h * (s.abs() + c.abs());
        for (i, y) in cells.wall_distance_mut().iter_mut().enumerate() {
            *y = distance(i).max(0.0);
        }
        let dry = (0..n * n).filter(|&i| distance(i) <= 0.0);
        cells.set_walls(dry.map(|i| (i, Vec::new())).collect(), false);
        let mut left = |phi: &dyn Fn(f64) -> f64, inverse: bool, [from, to]: [f64; 2]| {
            let phi: Vec<f64> = (0..n * n).map(|i| phi(distance(i))).collect();
            let e = Equation { inverse, ..Equation::new(&none, &none, &none) };
            cells.assemble(&velocity, &e, &phi).unwrap();
            let mut residual = vec![0.0; n * n];
            cells.matrix.residual(&cells.b, &phi, &mut residual);
            let inner = |i: usize| grid.cell(i).iter().all(|&k| (5..n - 5).contains(&k));
            let checked = (0..n * n).filter(|&i| inner(i) && distance(i) > from && distance(i) < to);
            checked.map(|i| residual[i].abs() / (h * phi[i])).fold(0.0, f64::max)
        };
        let linear = left(&|y| 2.0 + y / h, false, [0.0, 2.5 * h]);
        let inverse = left(&|y| h / y.max(least), true, [1.5 * h, 2.5 * h]);
        let plain = left(&|y| h / y.max(least), false, [1.5 * h, 2.5 * h]);
        // On top of so much that it is what residuals are divided by.
        let cubic = left(&|y| 1e6 + (y / h).powi(3), false, [3.0 * h, 5.0 * h]) * 1e6 / 6.0;
        assert!(linear < 1e-9, "{degrees}: {linear:e}");
        assert!(cubic < 1e-6, "{degrees}: {cubic:e}");
        assert!(
            inverse < 0.02 && inverse <= 0.2 * plain,
            "{degrees}: {inverse:e}, not for its own {plain:e}"
        );
    }
}

/// Distances that nobody gave, or that are none, do no harm.
#[test]
fn without_distances_scalars_are_numbers() {
    let grid = CartesianGrid::<2>::new([12, 8], [1.2, 0.8]).unwrap();
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let sides = Sides::new([[inlet, Side::ConvectiveOutlet], Side::FreeSlip.both()]).unwrap();
    let velocity = exact_velocity(&grid, &Metrics::new(&grid, [false; 2]), |_| [1.0, -0.5]);
    let n = grid.n_cells();
    for distance in [f64::INFINITY, 0.0] {
        let mut cells = CellTransport::new(&grid, &sides, TransportParams::steady()).unwrap();
        cells.wall_distance_mut().fill(distance);
        cells.set_walls((0..n).filter(|&i| grid.cell(i)[1] < 2).map(|i| (i, Vec::new())).collect(), false);
        let (gamma, none) = (vec![1e-3; n], vec![0.0; n]);
        let e = Equation { inlet: 1.0, inverse: true, ..Equation::new(&gamma, &none, &none) };
        let mut phi = vec![1.0; n];
        for _ in 0..5 {
            cells.on(&velocity).unwrap().solve(&e, &mut phi).unwrap();
        }
        assert!(phi.iter().all(|v| (v - 1.0).abs() < 1e-6), "{distance}: {phi:?}");
    }
}
