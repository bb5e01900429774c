use super::{Multigrid, MultigridAxis, MultigridCg, MultigridParams};
use crate::poisson::AxisBounds::{self, Dirichlet, DirichletNeumann, Neumann, NeumannDirichlet, Periodic};
use crate::poisson::{DirectPoisson, PoissonSolver};
use crate::{Axis, Cluster};
use std::f64::consts::PI;

fn axis(a: &Axis, ends: AxisBounds) -> MultigridAxis {
    MultigridAxis { widths: (0..a.cells()).map(|i| a.width(i)).collect(), ends }
}

fn uniform(n: usize, ends: AxisBounds) -> MultigridAxis {
    MultigridAxis { widths: vec![1.0 / n as f64; n], ends }
}

fn tanh(n: usize, beta: f64) -> Axis {
    Axis::tanh(n, 0.0, 1.0, beta, Cluster::Both).unwrap()
}

/// Numbers from −1 to 1.
fn noise(n: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    (0..n)
        .map(|_| {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        })
        .collect()
}

fn volumes<const D: usize>(axes: &[MultigridAxis; D]) -> Vec<f64> {
    let mut volumes = vec![1.0];
    for axis in axes {
        volumes = axis.widths.iter().flat_map(|w| volumes.iter().map(move |v| v * w)).collect();
    }
    volumes
}

/// Iterations to 1e-6 for noise.
fn iterations<const D: usize>(axes: [MultigridAxis; D], shift: f64) -> usize {
    let cells = axes.iter().map(|a| a.widths.len()).product();
    let mut solver = MultigridCg::new(axes, shift, MultigridParams::default()).unwrap();
    let mut phi = vec![0.0; cells];
    solver.solve_from(&noise(cells, 3), &mut phi).unwrap().iterations
}

#[test]
fn agrees_with_the_direct_solver() {
    for (bounds, shift) in [
        ([Periodic, Periodic, Neumann], 0.0),
        ([Neumann, Dirichlet, NeumannDirichlet], 0.0),
        ([Dirichlet, Periodic, DirichletNeumann], 3.0),
        ([Neumann, Neumann, Periodic], 0.5),
    ] {
        let cells = [12, 7, 17];
        let params = MultigridParams { tolerance: 1e-12, ..Default::default() };
        let axes: [_; 3] = std::array::from_fn(|a| uniform(cells[a], bounds[a]));
        let mut solver = MultigridCg::new(axes, shift, params).unwrap();
        let h = cells.map(|n| 1.0 / n as f64);
        let mut direct = DirectPoisson::new_helmholtz(cells, h, bounds, shift).unwrap();
        let (mut a, mut b) = (noise(12 * 7 * 17, 1), noise(12 * 7 * 17, 1));
        let info = solver.solve(&mut a).unwrap();
        let expected = direct.solve(&mut b).unwrap();
        assert!((info.removed_mean - expected.removed_mean).abs() < 1e-14);
        let largest = b.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b).abs() < 1e-10 * largest, "{bounds:?}: {a} {b}");
        }
    }
}

/// Largest error for φ = cos(πx) sin(πy) on a stretched grid of n × 2n cells.
fn error(n: usize) -> f64 {
    let (x, y) = (tanh(n, 1.5), Axis::tanh(2 * n, 0.0, 1.0, 1.2, Cluster::Lower).unwrap());
    let params = MultigridParams { tolerance: 1e-10, ..Default::default() };
    let mut solver = MultigridCg::new([axis(&x, Neumann), axis(&y, Dirichlet)], 0.0, params).unwrap();
    let exact = |c: usize| (PI * x.centre(c % n)).cos() * (PI * y.centre(c / n)).sin();
    let mut phi: Vec<f64> = (0..2 * n * n).map(|c| -2.0 * PI * PI * exact(c)).collect();
    solver.solve(&mut phi).unwrap();
    phi.iter().enumerate().map(|(c, phi)| (phi - exact(c)).abs()).fold(0.0, f64::max)
}

#[test]
fn second_order_on_stretched_grids() {
    let errors = [16, 32, 64].map(error);
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1]).log2() > 1.85, "{errors:?}");
    }
}

#[test]
fn the_cycle_is_symmetric_and_definite() {
    let axes = [axis(&tanh(13, 1.5), Periodic), uniform(6, Neumann), axis(&tanh(21, 2.0), NeumannDirichlet)];
    let v = volumes(&axes);
    let n = v.len();
    let mut multigrid = Multigrid::new(axes, 0.0, MultigridParams { sweeps: 2, ..Default::default() }).unwrap();
    let product = |a: &[f64], b: &[f64]| v.iter().zip(a.iter().zip(b)).map(|(v, (a, b))| v * a * b).sum::<f64>();
    let (x, y) = (noise(n, 1), noise(n, 2));
    let (mut mx, mut my) = (x.clone(), y.clone());
    multigrid.v_cycle(&mut mx).unwrap();
    multigrid.v_cycle(&mut my).unwrap();
    let (a, b, scale) = (product(&mx, &y), product(&x, &my), product(&x, &mx));
    assert!((a - b).abs() < 1e-5 * scale.abs(), "{a} {b} {scale}");
    assert!(scale < 0.0 && product(&y, &my) < 0.0);
}

#[test]
fn iterations_do_not_grow_with_the_grid() {
    for ends in [Neumann, Dirichlet] {
        for n in [64, 128, 256] {
            assert!(iterations([uniform(n, ends), uniform(n, ends)], 0.0) <= 8);
            assert!(iterations([axis(&tanh(n, 2.0), ends), axis(&tanh(n, 2.0), ends)], 0.0) <= 10);
        }
        for n in [16, 32, 64] {
            let a = axis(&tanh(n, 2.0), ends);
            assert!(iterations([a.clone(), a.clone(), a], 0.0) <= 9);
        }
    }
}
