use super::AxisBounds::{Dirichlet, DirichletNeumann, Neumann, NeumannDirichlet, Periodic};
use super::*;

/// Numbers in [−1, 1) that look random.
fn noise(n: usize) -> Vec<f64> {
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..n).map(|_| next()).collect()
}

/// The discrete operator, cell by cell.
fn apply<const D: usize>(
    cells: [usize; D],
    spacing: [f64; D],
    bounds: [AxisBounds; D],
    shift: f64,
    phi: &[f64],
) -> Vec<f64> {
    let mut out: Vec<f64> = phi.iter().map(|u| -shift * u).collect();
    let mut stride = 1;
    for axis in 0..D {
        let (n, h2) = (cells[axis], spacing[axis].powi(2));
        let (low, high) = match bounds[axis] {
            Periodic => (0.0, 0.0),
            Neumann => (1.0, 1.0),
            Dirichlet => (-1.0, -1.0),
            NeumannDirichlet => (1.0, -1.0),
            DirichletNeumann => (-1.0, 1.0),
        };
        for c in 0..phi.len() {
            let i = c / stride % n;
            let wrap = (n - 1) * stride;
            let ghost = |sign: f64, other: usize| if sign == 0.0 { phi[other] } else { sign * phi[c] };
            let before = if i > 0 { phi[c - stride] } else { ghost(low, c + wrap) };
            let after = if i < n - 1 { phi[c + stride] } else { ghost(high, c.wrapping_sub(wrap)) };
            out[c] += ((before - phi[c]) + (after - phi[c])) / h2;
        }
        stride *= n;
    }
    out
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, v| a.max(v.abs()))
}

/// Solves for noise and compares the operator of the solution with it.
fn check<const D: usize>(cells: [usize; D], spacing: [f64; D], bounds: [AxisBounds; D], shift: f64) {
    let what = format!("{cells:?} {spacing:?} {bounds:?} {shift}");
    let n: usize = cells.iter().product();
    let rhs = noise(n);
    let mut phi = rhs.clone();
    let mut solver = DirectPoisson::new_helmholtz(cells, spacing, bounds, shift).unwrap();
    let info = solver.solve(&mut phi).unwrap();
    let singular = shift == 0.0 && bounds.iter().all(|b| matches!(b, Periodic | Neumann));
    let mean = rhs.iter().sum::<f64>() / n as f64;
    let mean_phi = phi.iter().sum::<f64>() / n as f64;
    if singular {
        assert!((info.removed_mean - mean).abs() < 1e-14, "{what}");
        assert!(mean_phi.abs() < 1e-14 * largest(&phi).max(1e-300), "{what}: mean {mean_phi:e}");
    } else {
        assert_eq!(info.removed_mean, 0.0, "{what}");
    }
    let residual: Vec<f64> = apply(cells, spacing, bounds, shift, &phi)
        .iter()
        .zip(&rhs)
        .map(|(a, f)| a - (f - info.removed_mean))
        .collect();
    // Nothing can be better than the rounding of φ allows.
    let rounding = spacing.iter().map(|h| 16.0 * f64::EPSILON * largest(&phi) / (h * h)).sum::<f64>();
    let limit = rounding.max(1e-13 * largest(&rhs));
    assert!(largest(&residual) < limit, "{what}: residual {:e}", largest(&residual));
}

const TRANSFORMED: [AxisBounds; 3] = [Periodic, Neumann, Dirichlet];
const ALL: [AxisBounds; 5] = [Periodic, Neumann, Dirichlet, NeumannDirichlet, DirichletNeumann];

#[test]
fn the_residual_is_round_off_in_the_plane() {
    let sizes = [1, 2, 3, 4, 5, 7, 8, 13, 16, 31, 50];
    for nx in sizes {
        for ny in sizes {
            for bx in TRANSFORMED {
                for by in ALL {
                    check([nx, ny], [0.3, 0.25], [bx, by], 0.0);
                }
            }
        }
    }
}

#[test]
fn the_residual_is_round_off_in_space() {
    let sizes =
        [[1, 1, 1], [1, 5, 2], [6, 1, 4], [4, 3, 1], [8, 12, 10], [5, 7, 11], [13, 2, 3], [16, 9, 17]];
    for cells in sizes {
        for bx in TRANSFORMED {
            for by in TRANSFORMED {
                for bz in ALL {
                    check(cells, [0.5, 0.4, 0.7], [bx, by, bz], 0.0);
                }
            }
        }
    }
}

#[test]
fn large_stretched_and_shifted_boxes_are_solved_as_well() {
    for (bx, by) in
        [(Periodic, Periodic), (Neumann, Neumann), (Periodic, Dirichlet), (Dirichlet, DirichletNeumann)]
    {
        check([150, 300], [1.0, 1.0], [bx, by], 0.0);
        check([256, 97], [1.0, 10.0], [bx, by], 0.0);
        check([97, 256], [10.0, 1.0], [bx, by], 0.0);
        check([60, 41], [0.01, 0.02], [bx, by], 3.0);
    }
    check([32, 24, 40], [0.1, 0.2, 0.1], [Periodic, Neumann, Periodic], 10.0);
}

/// Gaussian elimination with the operator's matrix, made column by column.
fn dense<const D: usize>(
    cells: [usize; D],
    spacing: [f64; D],
    bounds: [AxisBounds; D],
    rhs: &[f64],
) -> Vec<f64> {
    let n = rhs.len();
    let columns: Vec<_> = (0..n)
        .map(|c| {
            let unit: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == c))).collect();
            apply(cells, spacing, bounds, 0.0, &unit)
        })
        .collect();
    let matrix = nalgebra::DMatrix::from_fn(n, n, |i, j| columns[j][i]);
    matrix.lu().solve(&nalgebra::DVector::from_column_slice(rhs)).unwrap().as_slice().to_vec()
}

#[test]
fn tiny_boxes_agree_with_gaussian_elimination() {
    fn compare<const D: usize>(cells: [usize; D], spacing: [f64; D], bounds: [AxisBounds; D]) {
        let rhs = noise(cells.iter().product());
        let expected = dense(cells, spacing, bounds, &rhs);
        let mut phi = rhs;
        DirectPoisson::new(cells, spacing, bounds).unwrap().solve(&mut phi).unwrap();
        let error = phi.iter().zip(&expected).fold(0.0_f64, |a, (x, y)| a.max((x - y).abs()));
        assert!(error < 1e-13 * largest(&expected), "{cells:?} {bounds:?}: {error:e}");
    }
    for bx in TRANSFORMED {
        for by in [Dirichlet, NeumannDirichlet, DirichletNeumann] {
            compare([4, 5], [0.5, 0.3], [bx, by]);
            compare([3, 4], [0.5, 0.3], [bx, by]);
            compare([3, 2, 3], [0.5, 0.3, 0.4], [bx, Periodic, by]);
            compare([4, 3, 2], [0.5, 0.3, 0.4], [bx, Neumann, by]);
        }
    }
    compare([6, 5], [0.5, 0.3], [Dirichlet, Periodic]);
    compare([3, 3, 3], [0.5, 0.3, 0.4], [Periodic, Dirichlet, Periodic]);
}

#[test]
fn a_periodic_wave_is_recovered() {
    use std::f64::consts::TAU;
    let (n, h) = ([32, 24], [TAU / 32.0, TAU / 24.0]);
    let wave = |c: usize| (2.0 * h[0] * (c % 32) as f64 + 3.0 * h[1] * (c / 32) as f64).cos();
    let factor = [2.0, 3.0].iter().zip(h).map(|(k, h)| -(2.0 * (0.5 * k * h).sin() / h).powi(2)).sum::<f64>();
    let mut phi: Vec<f64> = (0..32 * 24).map(|c| factor * wave(c) + 5.0).collect();
    let info = DirectPoisson::new(n, h, [Periodic; 2]).unwrap().solve(&mut phi).unwrap();
    assert!((info.removed_mean - 5.0).abs() < 1e-13);
    assert!((0..32 * 24).all(|c| (phi[c] - wave(c)).abs() < 1e-13));
}

#[test]
fn one_and_two_threads_agree_to_the_last_bit() {
    fn solve<const D: usize>(cells: [usize; D], bounds: [AxisBounds; D], threads: usize) -> Vec<f64> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let rhs = noise(cells.iter().product());
        let mut phi = vec![f64::NAN; rhs.len()];
        let mut solver = DirectPoisson::new(cells, [0.1; D], bounds).unwrap();
        let fill = |r: usize, row: &mut [f64]| row.copy_from_slice(&rhs[r * cells[0]..(r + 1) * cells[0]]);
        pool.install(|| solver.solve_rows(fill, &mut phi)).unwrap();
        phi
    }
    let bits = |phi: Vec<f64>| phi.into_iter().map(f64::to_bits).collect::<Vec<_>>();
    for bounds in [[Periodic; 2], [Neumann, DirichletNeumann]] {
        assert_eq!(bits(solve([75, 101], bounds, 1)), bits(solve([75, 101], bounds, 2)));
    }
    let bounds = [Periodic, Dirichlet, Neumann];
    assert_eq!(bits(solve([20, 18, 37], bounds, 1)), bits(solve([20, 18, 37], bounds, 2)));
}

#[test]
fn solving_again_and_row_by_row_gives_the_same() {
    let rhs = noise(30 * 21);
    let mut solver = DirectPoisson::new([30, 21], [0.1, 0.2], [Periodic, Neumann]).unwrap();
    let mut first = rhs.clone();
    solver.solve(&mut first).unwrap();
    let mut second = vec![f64::NAN; rhs.len()];
    solver.solve_rows(|r, row| row.copy_from_slice(&rhs[30 * r..30 * r + 30]), &mut second).unwrap();
    assert_eq!(first, second);
}

#[test]
fn nonsense_is_refused() {
    let new = |cells, spacing, bounds| DirectPoisson::<2>::new(cells, spacing, bounds).map(|_| ());
    assert_eq!(new([4, 0], [1.0; 2], [Periodic; 2]), Err(PoissonError::NoCells { axis: 1 }));
    assert_eq!(
        new([4, 4], [-1.0, 1.0], [Periodic; 2]),
        Err(PoissonError::Spacing { axis: 0, spacing: -1.0 })
    );
    assert!(matches!(
        new([4, 4], [1.0, f64::NAN], [Periodic; 2]),
        Err(PoissonError::Spacing { axis: 1, .. })
    ));
    assert!(matches!(new([4, 4], [1e200, 1.0], [Periodic; 2]), Err(PoissonError::Spacing { axis: 0, .. })));
    let bounds = NeumannDirichlet;
    assert_eq!(new([4, 4], [1.0; 2], [bounds, Periodic]), Err(PoissonError::MixedEnds { axis: 0, bounds }));
    let shifted = DirectPoisson::new_helmholtz([4, 4], [1.0; 2], [Periodic; 2], -1.0);
    assert_eq!(shifted.map(|_| ()), Err(PoissonError::Shift { shift: -1.0 }));

    for bounds in [[Periodic; 2], [Dirichlet, Neumann], [Neumann, Dirichlet]] {
        let mut solver = DirectPoisson::new([6, 7], [1.0; 2], bounds).unwrap();
        assert_eq!(solver.solve(&mut [0.0; 41]), Err(PoissonError::Length { length: 41, cells: 42 }));
        for bad in [f64::NAN, f64::INFINITY] {
            let mut field = noise(42);
            field[6 * 5 + 2] = bad;
            let before = field.clone();
            let error = solver.solve(&mut field).unwrap_err();
            assert!(matches!(error, PoissonError::NonFinite { low: 1, high: 5, .. }), "{error}");
            assert!(field.iter().zip(&before).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
        // The solver is as good as new.
        assert!(solver.solve(&mut noise(42)).is_ok());
    }
}
