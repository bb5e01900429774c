use super::{Multigrid, MultigridCg, MultigridParams};
use crate::poisson::AxisBounds::{self, Dirichlet, DirichletNeumann, Neumann, NeumannDirichlet, Periodic};
use crate::poisson::PoissonAxis;
use crate::poisson::{DirectPoisson, PoissonError, PoissonSolver};
use crate::{Axis, Cluster};
use std::f64::consts::PI;

fn axis(a: &Axis, ends: AxisBounds) -> PoissonAxis {
    PoissonAxis { widths: (0..a.cells()).map(|i| a.width(i)).collect(), ends }
}

fn uniform(n: usize, ends: AxisBounds) -> PoissonAxis {
    PoissonAxis { widths: vec![1.0 / n as f64; n], ends }
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

fn volumes<const D: usize>(axes: &[PoissonAxis; D]) -> Vec<f64> {
    let mut volumes = vec![1.0];
    for axis in axes {
        volumes = axis.widths.iter().flat_map(|w| volumes.iter().map(move |v| v * w)).collect();
    }
    volumes
}

/// Iterations to 1e-6 for noise.
fn iterations<const D: usize>(axes: [PoissonAxis; D], shift: f64) -> usize {
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
    let mut multigrid =
        Multigrid::new(axes, 0.0, MultigridParams { sweeps: 2, ..Default::default() }).unwrap();
    let product =
        |a: &[f64], b: &[f64]| v.iter().zip(a.iter().zip(b)).map(|(v, (a, b))| v * a * b).sum::<f64>();
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
    let product =
        |a: &[f64], b: &[f64]| v.iter().zip(a.iter().zip(b)).map(|(v, (a, b))| v * a * b).sum::<f64>();
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
            assert!(iterations([uniform(n, ends), uniform(n, ends)], 0.0) <= 6);
            assert!(iterations([axis(&tanh(n, 2.0), ends), axis(&tanh(n, 2.0), ends)], 0.0) <= 6);
        }
        for n in [16, 32, 64] {
            let a = axis(&tanh(n, 2.0), ends);
            assert!(iterations([a.clone(), a.clone(), a], 0.0) <= 6);
        }
    }
}

fn cg<const D: usize>(axes: [PoissonAxis; D], params: MultigridParams) -> MultigridCg<D> {
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

/// L φ − f in the plainest way. `zero` tells where the value is zero at an end: axis, high end, cell.
fn residual<const D: usize>(
    axes: &[PoissonAxis; D],
    beta: &[Option<&[f64]>; D],
    zero: impl Fn(usize, bool, usize) -> bool,
    shift: f64,
    phi: &[f64],
    f: &[f64],
) -> f64 {
    let n: [usize; D] = std::array::from_fn(|a| axes[a].widths.len());
    let (mut left, mut whole) = (0.0, 0.0);
    for c in 0..phi.len() {
        let mut rest = c;
        let at: [usize; D] = std::array::from_fn(|a| {
            let i = rest % n[a];
            rest /= n[a];
            i
        });
        let mut sum = -shift * phi[c];
        for a in 0..D {
            let (w, i, stride) = (&axes[a].widths, at[a], n[..a].iter().product::<usize>());
            for high in [false, true] {
                let face = (0..D).rev().fold(0, |face, b| {
                    face * (n[b] + usize::from(a == b)) + at[b] + usize::from(a == b && high)
                });
                let beta = beta[a].map_or(1.0, |beta| beta[face]);
                let at_end = if high { i + 1 == n[a] } else { i == 0 };
                sum += match (at_end, axes[a].ends == Periodic, high) {
                    (true, false, _) if zero(a, high, c) => -2.0 * beta * phi[c] / (w[i] * w[i]),
                    (true, false, _) => 0.0,
                    _ => {
                        let other = if high { (i + 1) % n[a] } else { (i + n[a] - 1) % n[a] };
                        let neighbour = c - i * stride + other * stride;
                        2.0 * beta * (phi[neighbour] - phi[c]) / (w[i] * (w[i] + w[other]))
                    }
                };
            }
        }
        let volume: f64 = (0..D).map(|a| axes[a].widths[at[a]]).product();
        left += volume * (sum - f[c]).powi(2);
        whole += volume * f[c] * f[c];
    }
    (left / whole).sqrt()
}

fn has_zero_value(ends: AxisBounds, high: bool) -> bool {
    ends == Dirichlet || ends == if high { NeumannDirichlet } else { DirichletNeumann }
}

/// Solves for noise (of zero mean if need be), compares the residual with what the solver tells; returns iterations.
fn solves<const D: usize>(axes: [PoissonAxis; D], shift: f64) -> usize {
    let v = volumes(&axes);
    let mut f = noise(v.len(), 7);
    let mut solver = MultigridCg::new(axes.clone(), shift, MultigridParams::default()).unwrap();
    let mut phi = vec![0.0; v.len()];
    let info = solver.solve_from(&f, &mut phi).unwrap();
    f.iter_mut().for_each(|f| *f -= info.removed_mean);
    let zero = |a: usize, high, _| has_zero_value(axes[a].ends, high);
    let left = residual(&axes, &[None; D], zero, shift, &phi, &f);
    assert!(left < 1.01e-6 && (left - info.residual).abs() < 1e-8, "{left} {info:?}");
    info.iterations
}

#[test]
fn thin_cells_and_steep_ratios() {
    let steep = |n, ends| axis(&Axis::geometric(n, 0.0, 1.0, 1.2).unwrap(), ends);
    let flat = |w: f64, n| PoissonAxis { widths: vec![w; n], ends: Neumann };
    // 1.2³⁸ = 1000.
    assert!(solves([steep(39, Neumann), uniform(32, Periodic)], 0.0) <= 12);
    assert!(solves([steep(39, Neumann), steep(39, Dirichlet)], 0.0) <= 12);
    assert!(solves([steep(39, Neumann), steep(39, Neumann), steep(39, DirichletNeumann)], 0.0) <= 12);
    assert!(solves([uniform(24, Neumann), steep(39, Neumann), steep(39, Neumann)], 0.0) <= 12);
    assert!(solves([flat(1e-3, 48), flat(1.0, 48)], 0.0) <= 8);
    assert!(solves([flat(1.0, 24), flat(1e-3, 48), flat(1.0, 24)], 0.0) <= 8);
    assert!(solves([flat(1e-3, 24), flat(1.0, 24), flat(1e-3, 24)], 0.0) <= 9);
}

#[test]
fn prime_sizes_and_single_cells() {
    for ends in [Neumann, Periodic, Dirichlet, NeumannDirichlet] {
        assert!(solves([uniform(127, ends), uniform(61, Neumann)], 0.0) <= 9);
        assert!(solves([uniform(31, Neumann), uniform(17, ends), uniform(23, ends)], 2.0) <= 9);
        for cells in [[1, 37, 13], [37, 1, 11], [5, 31, 1], [2, 2, 67], [1, 97, 1], [3, 1, 1]] {
            solves(std::array::from_fn::<_, 3, _>(|a| uniform(cells[a], ends)), 0.0);
        }
        solves([uniform(1, ends), uniform(101, ends)], 0.0);
        solves([uniform(101, ends), uniform(1, ends)], 1.5);
    }
    // One cell: −2 φ/w² per face of zero value.
    let mut phi = [6.0];
    cg([uniform(1, Dirichlet), uniform(1, NeumannDirichlet)], MultigridParams::default())
        .solve(&mut phi)
        .unwrap();
    assert!((phi[0] + 1.0).abs() < 1e-6);
}

#[test]
fn coefficients_that_jump() {
    let cells = [28, 24, 20];
    let axes: [_; 3] = std::array::from_fn(|a| uniform(cells[a], [Neumann, Periodic, NeumannDirichlet][a]));
    let mut beta = [0, 1, 2].map(|a| jumps(cells, a));
    // Periodic: the last face is the first.
    for k in 0..20 {
        let layer = k * 28 * 25;
        let (first, last) = beta[1][layer..layer + 28 * 25].split_at_mut(28 * 24);
        last.copy_from_slice(&first[..28]);
    }
    let given = [Some(&beta[0][..]), Some(&beta[1][..]), Some(&beta[2][..])];
    let params = MultigridParams { variable: true, sweeps: 2, ..Default::default() };
    let mut solver = cg(axes.clone(), params);
    let f = noise(28 * 24 * 20, 5);
    let mut phi = vec![0.0; f.len()];
    let plain = solver.solve_from(&f, &mut phi).unwrap();
    assert!(plain.iterations <= 8, "{plain:?}");
    solver.multigrid().set_coefficients(given).unwrap();
    phi.fill(0.0);
    let info = solver.solve_from(&f, &mut phi).unwrap();
    let zero = |a: usize, high, _| has_zero_value(axes[a].ends, high);
    let left = residual(&axes, &given, zero, 0.0, &phi, &f);
    assert!(left < 1.01e-6 && info.iterations <= 25, "{left} {info:?}");
    // And back to β = 1.
    solver.multigrid().set_coefficients([None; 3]).unwrap();
    phi.fill(0.0);
    assert_eq!(solver.solve_from(&f, &mut phi).unwrap(), plain);
}

#[test]
fn cells_that_are_cut_off() {
    // β = 0 around and in a block of cells.
    let (n, solid) = (32, |i: usize, j: usize| (9..20).contains(&i) && (5..17).contains(&j));
    let mut beta = [vec![1.0; 33 * 32], vec![1.0; 32 * 33]];
    for j in 0..n {
        for i in 0..n {
            if solid(i, j) {
                (beta[0][j * 33 + i], beta[0][j * 33 + i + 1]) = (0.0, 0.0);
                (beta[1][j * 32 + i], beta[1][j * 32 + 32 + i]) = (0.0, 0.0);
            }
        }
    }
    let axes = [uniform(n, NeumannDirichlet), uniform(n, Neumann)];
    let given = [Some(&beta[0][..]), Some(&beta[1][..])];
    let mut solver = cg(axes.clone(), MultigridParams { variable: true, ..Default::default() });
    solver.multigrid().set_coefficients(given).unwrap();
    let f: Vec<f64> =
        noise(n * n, 2).iter().enumerate().map(|(c, f)| if solid(c % n, c / n) { 0.0 } else { *f }).collect();
    let mut phi = vec![0.0; n * n];
    let info = solver.solve_from(&f, &mut phi).unwrap();
    let left = residual(&axes, &given, |a, high, _| a == 0 && high, 0.0, &phi, &f);
    assert!(left < 1.01e-6 && info.iterations <= 20, "{left} {info:?}");
}

#[test]
fn an_outlet_on_a_part_of_a_side() {
    let (n, params) = (48, MultigridParams { variable: true, ..Default::default() });
    let axes = [axis(&tanh(n, 1.5), Neumann), uniform(n, Neumann), uniform(6, Periodic)];
    let outlet: Vec<bool> = (0..n * 6).map(|c| c % n > 12 && c % n < 30).collect();
    let mut solver = cg(axes.clone(), params);
    let mut f = noise(n * n * 6, 2);
    let mut phi = vec![0.0; f.len()];
    assert!(solver.solve_from(&f, &mut phi).unwrap().removed_mean != 0.0);
    // Cells of the high end of x: y, then z.
    solver.multigrid().set_ends(0, true, &outlet).unwrap();
    phi.fill(0.0);
    let info = solver.solve_from(&f, &mut phi).unwrap();
    let zero = |a: usize, high: bool, c: usize| a == 0 && high && outlet[c / n];
    let left = residual(&axes, &[None; 3], zero, 0.0, &phi, &f);
    assert!(left < 1.01e-6 && info.removed_mean == 0.0 && info.iterations <= 12, "{left} {info:?}");
    // The whole side, and none of it.
    solver.multigrid().set_ends(0, true, &vec![true; n * 6]).unwrap();
    solver.solve_from(&f, &mut phi).unwrap();
    let whole = |a: usize, high: bool, _| a == 0 && high;
    assert!(residual(&axes, &[None; 3], whole, 0.0, &phi, &f) < 1.01e-6);
    solver.multigrid().set_ends(0, true, &vec![false; n * 6]).unwrap();
    let info = solver.solve_from(&f, &mut phi).unwrap();
    f.iter_mut().for_each(|f| *f -= info.removed_mean);
    assert!(residual(&axes, &[None; 3], |_, _, _| false, 0.0, &phi, &f) < 1.01e-6);
}

#[test]
fn singular_boxes() {
    let axes = [axis(&tanh(40, 1.5), Neumann), uniform(30, Periodic)];
    let v = volumes(&axes);
    let mean = |f: &[f64]| v.iter().zip(f).map(|(v, f)| v * f).sum::<f64>() / v.iter().sum::<f64>();
    let mut solver = cg(axes, MultigridParams::default());
    let f: Vec<f64> = noise(1200, 4).iter().map(|f| f + 5.0).collect();
    let mut phi = f.clone();
    let info = solver.solve(&mut phi).unwrap();
    assert!((info.removed_mean - mean(&f)).abs() < 1e-12 && info.removed_mean > 4.0);
    assert!(mean(&phi).abs() < 1e-12);
    // The rest has a solution: the same.
    let mut same: Vec<f64> = f.iter().map(|f| f - info.removed_mean).collect();
    let info = solver.solve(&mut same).unwrap();
    assert!(info.removed_mean.abs() < 1e-12);
    let largest = phi.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
    assert!(phi.iter().zip(&same).all(|(a, b)| (a - b).abs() < 1e-8 * largest));
    // Nothing is left of a constant, nor of zero.
    let mut phi = vec![3.0; 1200];
    let info = solver.solve(&mut phi).unwrap();
    assert!((info.removed_mean - 3.0).abs() < 1e-13 && info.iterations == 0 && phi.iter().all(|&p| p == 0.0));
    assert_eq!(solver.solve_from(&[0.0; 1200], &mut phi).unwrap().iterations, 0);
}

#[test]
fn a_good_guess_saves_iterations() {
    let axes = [axis(&tanh(64, 2.0), Neumann), axis(&tanh(64, 2.0), Dirichlet)];
    let mut solver = cg(axes.clone(), MultigridParams { tolerance: 1e-7, ..Default::default() });
    let f = noise(4096, 1);
    let mut phi = vec![0.0; 4096];
    let cold = solver.solve_from(&f, &mut phi).unwrap().iterations;
    let solved = phi.clone();
    assert_eq!(solver.solve_from(&f, &mut phi).unwrap().iterations, 0);
    assert_eq!(phi, solved);
    phi.iter_mut().zip(noise(4096, 9)).for_each(|(p, e)| *p += 1e-4 * e * p.abs());
    let warm = solver.solve_rows(|r, row| row.copy_from_slice(&f[r * 64..][..64]), &mut phi, true).unwrap();
    assert!(warm.iterations < cold);
    solver.solve_rows(|r, row| row.copy_from_slice(&f[r * 64..][..64]), &mut phi, false).unwrap();
    assert_eq!(phi, solved);
    // Multigrid alone comes to the same φ.
    let mut alone = f.clone();
    let params = MultigridParams { tolerance: 1e-7, ..Default::default() };
    let info = Multigrid::new(axes, 0.0, params).unwrap().solve(&mut alone).unwrap();
    assert!(info.iterations >= cold && info.iterations <= 40, "{info:?}");
    let largest = phi.iter().fold(0.0_f64, |m, p| m.max(p.abs()));
    assert!(phi.iter().zip(&alone).all(|(a, b)| (a - b).abs() < 1e-5 * largest));
}

#[test]
fn threads_do_not_change_the_result() {
    let solve = |threads: usize, variable: bool| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let a = axis(&tanh(64, 1.5), Neumann);
            let params = MultigridParams { variable, ..Default::default() };
            let mut phi = noise(64 * 64 * 80, 1);
            cg([a.clone(), a, uniform(80, Periodic)], params).solve(&mut phi).unwrap();
            phi
        })
    };
    for variable in [false, true] {
        let one = solve(1, variable);
        assert!(one == solve(2, variable) && one == solve(3, variable));
    }
}

#[test]
fn mistakes_are_errors() {
    let params = MultigridParams::default();
    let good = || [uniform(8, Neumann), uniform(9, Periodic)];
    let none = PoissonAxis { widths: vec![], ends: Neumann };
    let error = |axes, shift, params| Multigrid::<2>::new(axes, shift, params).err().unwrap();
    assert_eq!(error([none, uniform(3, Neumann)], 0.0, params), PoissonError::NoCells { axis: 0 });
    for w in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e200, 1e-200] {
        let bad = PoissonAxis { widths: vec![1.0, w], ends: Neumann };
        assert!(matches!(
            error([uniform(3, Neumann), bad], 0.0, params),
            PoissonError::Spacing { axis: 1, .. }
        ));
    }
    for shift in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(error(good(), shift, params), PoissonError::Shift { .. }));
    }
    for bad in [
        MultigridParams { tolerance: 0.0, ..params },
        MultigridParams { tolerance: f64::NAN, ..params },
        MultigridParams { max_iterations: 0, ..params },
        MultigridParams { sweeps: 0, ..params },
        MultigridParams { widest_merged: 0.5, ..params },
    ] {
        assert!(matches!(error(good(), 0.0, bad), PoissonError::Parameter { .. }));
    }
    let mut solver = cg(good(), params);
    assert_eq!(solver.solve(&mut [0.0; 7]), Err(PoissonError::Length { length: 7, cells: 72 }));
    assert_eq!(
        solver.solve_from(&[0.0; 72], &mut [0.0; 7]),
        Err(PoissonError::Length { length: 7, cells: 72 })
    );
    let mut f = noise(72, 1);
    f[43] = f64::INFINITY;
    let kept = f.clone();
    assert!(matches!(solver.solve(&mut f), Err(PoissonError::NonFinite { low: 5, .. })));
    assert_eq!(f, kept);
    let (f, mut guess) = (noise(72, 1), vec![0.0; 72]);
    guess[12] = f64::NAN;
    assert!(matches!(solver.solve_from(&f, &mut guess), Err(PoissonError::NonFinite { low: 1, .. })));
    assert!(guess[12].is_nan() && guess[13] == 0.0);
    assert!(matches!(solver.multigrid().set_coefficients([None; 2]), Err(PoissonError::Parameter { .. })));
    assert!(matches!(solver.multigrid().set_ends(0, true, &[true; 9]), Err(PoissonError::Parameter { .. })));

    let mut solver = cg(good(), MultigridParams { variable: true, ..params });
    let m = solver.multigrid();
    let short = [1.0; 80];
    assert_eq!(
        m.set_coefficients([Some(&short), None]),
        Err(PoissonError::Faces { axis: 0, length: 80, faces: 81 })
    );
    for value in [-1.0, f64::INFINITY, f64::NAN] {
        let mut beta = [1.0; 80];
        beta[3] = value;
        assert!(matches!(
            m.set_coefficients([None, Some(&beta)]),
            Err(PoissonError::Coefficient { axis: 1, face: 3, .. })
        ));
    }
    assert!(matches!(m.set_ends(0, true, &[true; 8]), Err(PoissonError::Faces { axis: 0, faces: 9, .. })));
    assert!(matches!(m.set_ends(1, true, &[true; 8]), Err(PoissonError::Faces { axis: 1, faces: 0, .. })));
    assert!(matches!(m.set_ends(2, true, &[true; 8]), Err(PoissonError::Faces { axis: 2, .. })));

    // Out of iterations: φ is better than nothing.
    let axes = [uniform(64, Dirichlet), uniform(64, Dirichlet)];
    let mut solver = cg(axes.clone(), MultigridParams { max_iterations: 2, ..params });
    let f = noise(4096, 2);
    let mut phi = f.clone();
    let Err(PoissonError::NotConverged { iterations: 2, residual: told, .. }) = solver.solve(&mut phi) else {
        panic!()
    };
    let left = residual(&axes, &[None; 2], |_, _, _| true, 0.0, &phi, &f);
    assert!((left - told).abs() < 1e-10 && left < 0.1);
    assert!(solver.describe().contains("64×64"));
}
