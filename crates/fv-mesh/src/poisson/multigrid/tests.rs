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
fn the_cycle_is_symmetric_with_coefficients() {
    let axes = [axis(&tanh(12, 1.5), Periodic), uniform(9, Neumann), axis(&tanh(11, 2.0), NeumannDirichlet)];
    let v = volumes(&axes);
    let n = v.len();
    let params = MultigridParams { variable: true, ..Default::default() };
    let mut multigrid = Multigrid::new(axes, 0.0, params).unwrap();
    let beta = [0, 1, 2].map(|a| jumps([12, 9, 11], a));
    multigrid.set_coefficients([Some(&beta[0]), None, Some(&beta[2])]).unwrap();
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

fn cg<const D: usize>(axes: [MultigridAxis; D], params: MultigridParams) -> MultigridCg<D> {
    MultigridCg::new(axes, 0.0, params).unwrap()
}

/// β at the faces of an axis, 1000 in half of the chequers of 4³ cells.
fn jumps(cells: [usize; 3], axis: usize) -> Vec<f64> {
    let high = |at: [usize; 3]| at.iter().map(|i| i / 4).sum::<usize>() % 2 == 0;
    let mut beta = Vec::new();
    let mut faces = cells;
    faces[axis] += 1;
    for k in 0..faces[2] {
        for j in 0..faces[1] {
            for i in 0..faces[0] {
                let (mut low, mut up) = ([i, j, k], [i, j, k]);
                low[axis] = low[axis].saturating_sub(1);
                up[axis] = up[axis].min(cells[axis] - 1);
                let [a, b] = [low, up].map(|at| if high(at) { 1000.0 } else { 1.0 });
                beta.push(2.0 / (1.0 / a + 1.0 / b));
            }
        }
    }
    beta
}

#[test]
fn explore() {
    let stretched = |n: usize, ratio: f64, ends| axis(&Axis::geometric(n, 0.0, 1.0, ratio).unwrap(), ends);
    for w in [1.5, 2.0] {
        for sweeps in [1, 2] {
            let p = MultigridParams { widest_merged: w, sweeps, ..Default::default() };
            let mut line = format!("w {w} sweeps {sweeps}:");
            let mut two = |name: &str, a: MultigridAxis, b: MultigridAxis| {
                let n = a.widths.len() * b.widths.len();
                let mut s = cg([a, b], p);
                let mut phi = vec![0.0; n];
                let r = s.solve_from(&noise(n, 3), &mut phi);
                let work = s.multigrid().describe().split("; ").nth(1).unwrap_or("")[..4].to_string();
                line += &format!(" {name} {}({work})", r.map_or_else(|e| e.to_string(), |r| r.iterations.to_string()));
            };
            two("t256", axis(&tanh(256, 2.0), Neumann), axis(&tanh(256, 2.0), Neumann));
            two("g128", stretched(128, 1.05, Neumann), stretched(128, 1.05, Neumann));
            two("r1.2", stretched(40, 1.2, Neumann), stretched(40, 1.2, Neumann));
            two("r1.2,1", stretched(40, 1.2, Neumann), uniform(128, Neumann));
            two("1000", MultigridAxis { widths: vec![1e-3; 64], ends: Neumann }, MultigridAxis { widths: vec![1.0; 64], ends: Neumann });
            two("per", MultigridAxis { widths: vec![1e-3; 67], ends: Periodic }, MultigridAxis { widths: vec![0.7; 61], ends: Periodic });
            two("prime", uniform(127, Neumann), uniform(131, Dirichlet));
            println!("{line}");
            let mut line = format!("w {w} sweeps {sweeps}:");
            let mut three = |name: &str, a: [MultigridAxis; 3], jump: bool| {
                let n = a.iter().map(|a| a.widths.len()).product();
                let cells = [0, 1, 2].map(|i| a[i].widths.len());
                let mut s = cg(a, MultigridParams { variable: jump, ..p });
                if jump {
                    let b = [0, 1, 2].map(|a| jumps(cells, a));
                    s.multigrid().set_coefficients([Some(&b[0]), Some(&b[1]), Some(&b[2])]).unwrap();
                }
                let mut phi = vec![0.0; n];
                let r = s.solve_from(&noise(n, 3), &mut phi);
                line += &format!(" {name} {}", r.map_or_else(|e| e.to_string(), |r| r.iterations.to_string()));
            };
            let t = axis(&tanh(48, 2.0), Neumann);
            let g = stretched(40, 1.2, Dirichlet);
            three("t48", [t.clone(), t.clone(), t.clone()], false);
            three("g40", [g.clone(), g.clone(), g.clone()], false);
            three("g40,u,u", [g.clone(), uniform(40, Neumann), uniform(32, Periodic)], false);
            three("jump u", [uniform(40, Neumann), uniform(40, Neumann), uniform(32, Periodic)], true);
            three("jump t", [t.clone(), t.clone(), t.clone()], true);
            println!("{line}");
        }
    }
}
