use super::super::AxisBounds::{self, Dirichlet, DirichletNeumann, Neumann, NeumannDirichlet, Periodic};
use super::super::DirectPoisson;
use super::*;

const ALL: [AxisBounds; 5] = [Periodic, Neumann, Dirichlet, NeumannDirichlet, DirichletNeumann];

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

/// Cells that grow by `ratio` up to the middle and shrink again.
fn stretched(n: usize, first: f64, ratio: f64, ends: AxisBounds) -> PoissonAxis {
    PoissonAxis { widths: (0..n).map(|i| first * ratio.powi(i.min(n - 1 - i) as i32)).collect(), ends }
}

/// Cells that grow by `ratio` all the way.
fn growing(n: usize, first: f64, ratio: f64, ends: AxisBounds) -> PoissonAxis {
    PoissonAxis { widths: (0..n).map(|i| first * ratio.powi(i as i32)).collect(), ends }
}

/// Cells with no order in their widths.
fn rough(n: usize, ends: AxisBounds) -> PoissonAxis {
    PoissonAxis { widths: (0..n).map(|i| 0.3 + 0.2 * (1.7 * i as f64).sin()).collect(), ends }
}

/// The discrete operator, cell by cell, and the sum of the magnitudes of its coefficients there.
fn apply<const D: usize>(axes: &[PoissonAxis; D], shift: f64, phi: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut out: Vec<f64> = phi.iter().map(|u| -shift * u).collect();
    let mut size = vec![shift; phi.len()];
    let mut stride = 1;
    for axis in axes {
        let (n, w) = (axis.cells(), &axis.widths);
        for c in 0..phi.len() {
            let i = c / stride % n;
            let mut flux = |high: bool| {
                let end = if high { n - 1 } else { 0 };
                let (other, d) = if i != end {
                    let o = if high { i + 1 } else { i - 1 };
                    (phi[c + o * stride - i * stride], 0.5 * (w[i] + w[o]))
                } else {
                    match axis.ends {
                        Periodic => {
                            let o = n - 1 - end;
                            (phi[c + o * stride - i * stride], 0.5 * (w[i] + w[o]))
                        }
                        Dirichlet => (0.0, 0.5 * w[i]),
                        NeumannDirichlet if high => (0.0, 0.5 * w[i]),
                        DirichletNeumann if !high => (0.0, 0.5 * w[i]),
                        _ => return 0.0,
                    }
                };
                size[c] += 2.0 / (d * w[i]);
                (other - phi[c]) / d
            };
            out[c] += (flux(true) + flux(false)) / w[i];
        }
        stride *= n;
    }
    (out, size)
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |a, v| a.max(v.abs()))
}

/// Volume of every cell.
fn volumes<const D: usize>(axes: &[PoissonAxis; D]) -> Vec<f64> {
    let mut volumes = vec![1.0];
    for axis in axes {
        volumes = axis.widths.iter().flat_map(|w| volumes.iter().map(move |v| v * w)).collect();
    }
    volumes
}

fn singular<const D: usize>(axes: &[PoissonAxis; D], shift: f64) -> bool {
    shift == 0.0 && axes.iter().all(|a| matches!(a.ends, Periodic | Neumann))
}

/// Solves for noise; the residual in every cell has to be a few roundings of φ. Returns its 2-norm,
/// weighted with volumes, over that of f.
fn check<const D: usize>(axes: [PoissonAxis; D], shift: f64) -> f64 {
    let what = format!("{:?} {shift}", axes.each_ref().map(|a| (a.cells(), a.ends, a.is_uniform())));
    let volumes = volumes(&axes);
    let total: f64 = volumes.iter().sum();
    let mean = |field: &[f64]| field.iter().zip(&volumes).map(|(f, v)| f * v).sum::<f64>() / total;
    let rhs = noise(volumes.len());
    let mut phi = rhs.clone();
    let mut solver = SeparablePoisson::new_helmholtz(axes.clone(), shift).unwrap();
    let info = solver.solve(&mut phi).unwrap();
    let top = largest(&phi);
    if singular(&axes, shift) {
        assert!((info.removed_mean - mean(&rhs)).abs() < 1e-13, "{what} {info:?} {}", mean(&rhs));
        assert!(mean(&phi).abs() <= 1e-13 * top, "{what}: mean {:e} of {top:e}", mean(&phi));
    } else {
        assert_eq!(info.removed_mean, 0.0, "{what}");
    }
    let (image, size) = apply(&axes, shift, &phi);
    let (mut squares, mut scale) = (0.0, 0.0);
    for c in 0..rhs.len() {
        let residual = image[c] - (rhs[c] - info.removed_mean);
        let limit = 8.0 * f64::EPSILON * size[c] * top + 1e-14;
        assert!(residual.abs() < limit, "{what}: residual {residual:e} above {limit:e} in cell {c}");
        squares += volumes[c] * residual * residual;
        scale += volumes[c] * rhs[c] * rhs[c];
    }
    (squares / scale).sqrt()
}

#[test]
fn the_residual_is_round_off_with_all_ends_in_the_plane() {
    for (nx, ny) in [(1, 1), (1, 4), (2, 1), (2, 2), (3, 2), (5, 8), (17, 12), (33, 37), (50, 20)] {
        for bx in ALL {
            for by in ALL {
                check([rough(nx, bx), rough(ny, by)], 0.0);
                check([rough(nx, bx), PoissonAxis::uniform(ny, 0.2, by)], 0.0);
                check([PoissonAxis::uniform(nx, 0.2, bx), rough(ny, by)], 0.3);
                check([PoissonAxis::uniform(nx, 0.2, bx), PoissonAxis::uniform(ny, 0.3, by)], 0.0);
            }
        }
    }
}

#[test]
fn the_residual_is_round_off_with_all_ends_in_space() {
    for cells in [[1, 1, 1], [2, 1, 3], [1, 2, 1], [5, 4, 2], [7, 6, 9], [34, 3, 5], [3, 35, 4]] {
        for bx in ALL {
            for by in ALL {
                for bz in ALL {
                    let rough = [rough(cells[0], bx), rough(cells[1], by), rough(cells[2], bz)];
                    let plain = [(bx, 0), (by, 1), (bz, 2)]
                        .map(|(b, a)| PoissonAxis::uniform(cells[a], 0.2 + 0.1 * a as f64, b));
                    // Every choice of stretched axes.
                    for which in 0..8 {
                        let axes = std::array::from_fn(|a| {
                            if which >> a & 1 == 1 { rough[a].clone() } else { plain[a].clone() }
                        });
                        check::<3>(axes, 0.0);
                    }
                }
            }
        }
    }
}

#[test]
fn strongly_stretched_axes_are_solved_as_well() {
    for (bx, by) in [
        (Neumann, Neumann),
        (Periodic, Neumann),
        (Dirichlet, Dirichlet),
        (Periodic, Periodic),
        (DirichletNeumann, Neumann),
        (NeumannDirichlet, Dirichlet),
    ] {
        // Widths grow by 1.2 to a thousand times the first, with pairs of close eigenvalues if they
        // shrink again.
        let one = check([growing(39, 1e-3, 1.2, bx), growing(39, 1e-3, 1.2, by)], 0.0);
        let both = check([stretched(76, 1e-3, 1.2, bx), stretched(78, 1e-3, 1.2, by)], 0.0);
        assert!(one.max(both) < 1e-10, "{bx:?} {by:?}: {one:e} {both:e}");
        check([growing(60, 1e-4, 1.2, bx), PoissonAxis::uniform(48, 0.01, by)], 0.0);
        check([PoissonAxis::uniform(48, 0.01, bx), growing(60, 1e-4, 1.2, by)], 1e-3);
        check([stretched(100, 1e-4, 1.1, bx), growing(61, 1e-4, 1.2, by)], 0.0);
    }
}

#[test]
fn large_boxes_are_solved_as_well() {
    // More than one block of terms in the products, and odd sizes.
    check([rough(301, Neumann), rough(530, Periodic)], 0.0);
    check([rough(530, NeumannDirichlet), rough(301, Dirichlet)], 0.0);
    check([rough(37, Neumann), rough(45, Periodic), rough(50, Neumann)], 0.0);
    check([rough(50, Neumann), rough(37, Periodic), rough(45, Neumann)], 0.0);
    check([rough(37, DirichletNeumann), rough(50, Periodic), rough(45, Neumann)], 2.0);
}

/// Gaussian elimination with the operator's matrix, made column by column; a singular one is bordered
/// with the mean.
fn dense<const D: usize>(axes: &[PoissonAxis; D], shift: f64, rhs: &[f64]) -> Vec<f64> {
    let (n, volumes, singular) = (rhs.len(), volumes(axes), singular(axes, shift));
    let size = n + usize::from(singular);
    let mut matrix = nalgebra::DMatrix::zeros(size, size);
    for c in 0..n {
        let unit: Vec<f64> = (0..n).map(|i| f64::from(u8::from(i == c))).collect();
        for (i, a) in apply(axes, shift, &unit).0.into_iter().enumerate() {
            matrix[(i, c)] = a;
        }
        if singular {
            (matrix[(n, c)], matrix[(c, n)]) = (volumes[c], 1.0);
        }
    }
    let mut b = nalgebra::DVector::zeros(size);
    b.as_mut_slice()[..n].copy_from_slice(rhs);
    matrix.lu().solve(&b).unwrap().as_slice()[..n].to_vec()
}

#[test]
fn tiny_boxes_agree_with_gaussian_elimination() {
    fn compare<const D: usize>(axes: [PoissonAxis; D], shift: f64) {
        let rhs = noise(axes.iter().map(PoissonAxis::cells).product());
        let expected = dense(&axes, shift, &rhs);
        let mut phi = rhs;
        SeparablePoisson::new_helmholtz(axes.clone(), shift).unwrap().solve(&mut phi).unwrap();
        let error = phi.iter().zip(&expected).fold(0.0_f64, |a, (x, y)| a.max((x - y).abs()));
        assert!(error < 1e-12 * largest(&expected).max(1.0), "{axes:?} {shift}: {error:e}");
    }
    for bx in ALL {
        for by in ALL {
            for (nx, ny) in [(1, 1), (1, 3), (2, 1), (2, 2), (5, 4), (3, 6)] {
                compare([rough(nx, bx), rough(ny, by)], 0.0);
                compare([rough(nx, bx), rough(ny, by)], 0.7);
                compare([PoissonAxis::uniform(nx, 0.4, bx), rough(ny, by)], 0.0);
            }
            for bz in ALL {
                compare([rough(3, bx), rough(2, by), rough(4, bz)], 0.0);
                compare([rough(2, bx), rough(5, by), PoissonAxis::uniform(3, 0.4, bz)], 0.0);
                compare([PoissonAxis::uniform(4, 0.4, bx), rough(1, by), rough(2, bz)], 0.0);
            }
        }
    }
}

#[test]
fn uniform_boxes_agree_with_the_solver_for_them() {
    fn compare<const D: usize>(cells: [usize; D], h: [f64; D], ends: [AxisBounds; D], shift: f64) {
        let rhs = noise(cells.iter().product());
        let (mut a, mut b) = (rhs.clone(), rhs);
        let axes: [_; D] = std::array::from_fn(|i| PoissonAxis::uniform(cells[i], h[i], ends[i]));
        let one = DirectPoisson::new_helmholtz(cells, h, ends, shift).unwrap().solve(&mut a).unwrap();
        let other = SeparablePoisson::new_helmholtz(axes, shift).unwrap().solve(&mut b).unwrap();
        assert!((one.removed_mean - other.removed_mean).abs() < 1e-14);
        let error = a.iter().zip(&b).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        assert!(error < 1e-12 * largest(&a), "{cells:?} {ends:?}: {error:e}");
    }
    for bx in [Periodic, Neumann, Dirichlet] {
        for by in ALL {
            compare([40, 33], [0.1, 0.2], [bx, by], 0.0);
            compare([31, 64], [0.1, 0.2], [bx, by], 0.5);
            compare([16, 9, 21], [0.1, 0.2, 0.15], [bx, bx, by], 0.0);
        }
    }
}

/// Largest error against φ = cos πx cos 2πy (Neumann) on [0, 1]², cells gathered at the walls.
fn error(n: usize) -> f64 {
    use std::f64::consts::PI;
    let axes = [n, 3 * n / 2].map(|n| crate::Axis::tanh(n, 0.0, 1.0, 1.8, crate::Cluster::Both).unwrap());
    let exact = |c: usize| {
        let (x, y) = (axes[0].centre(c % n), axes[1].centre(c / n));
        (PI * x).cos() * (2.0 * PI * y).cos()
    };
    let mut phi: Vec<f64> = (0..n * (3 * n / 2)).map(|c| -5.0 * PI * PI * exact(c)).collect();
    let boxed = axes.each_ref().map(|a| PoissonAxis::from_axis(a, Neumann));
    let volumes = volumes(&boxed);
    SeparablePoisson::new(boxed).unwrap().solve(&mut phi).unwrap();
    let mean: f64 = volumes.iter().enumerate().map(|(c, v)| v * exact(c)).sum();
    (0..phi.len()).fold(0.0, |m, c| m.max((phi[c] - (exact(c) - mean)).abs()))
}

#[test]
fn the_error_is_of_second_order_on_stretched_cells() {
    let errors = [20, 40, 80].map(error);
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.8..2.3).contains(&order), "{errors:?}");
    }
    assert!(errors[2] < 2e-3, "{errors:?}");
}

#[test]
fn one_and_two_threads_agree_to_the_last_bit() {
    fn solve<const D: usize>(axes: &[PoissonAxis; D], threads: usize) -> Vec<u64> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let nx = axes[0].cells();
        let rhs = noise(axes.iter().map(PoissonAxis::cells).product());
        let mut phi = vec![f64::NAN; rhs.len()];
        pool.install(|| {
            let mut solver = SeparablePoisson::new(axes.clone()).unwrap();
            solver.solve_rows(|r, row| row.copy_from_slice(&rhs[r * nx..(r + 1) * nx]), &mut phi).unwrap();
        });
        phi.into_iter().map(f64::to_bits).collect()
    }
    for axes in [
        [rough(75, Neumann), rough(101, Neumann)],
        [rough(101, Dirichlet), rough(75, Periodic)],
        [rough(75, Periodic), PoissonAxis::uniform(101, 0.1, Periodic)],
    ] {
        assert_eq!(solve(&axes, 1), solve(&axes, 2));
    }
    let axes = [rough(20, Periodic), rough(38, Dirichlet), PoissonAxis::uniform(37, 0.1, Neumann)];
    assert_eq!(solve(&axes, 1), solve(&axes, 2));
}

#[test]
fn a_solve_allocates_nothing() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    for axes in [
        [rough(30, Neumann), rough(41, Periodic)],
        [rough(41, Neumann), PoissonAxis::uniform(30, 0.1, Dirichlet)],
    ] {
        let mut solver = SeparablePoisson::new(axes).unwrap();
        let mut phi = noise(30 * 41);
        let count = pool.install(|| {
            solver.solve(&mut phi).unwrap();
            allocation_counter::measure(|| drop(solver.solve(&mut phi))).count_total
        });
        assert_eq!(count, 0);
    }
}

#[test]
fn eigenvalues_keep_their_digits() {
    // A uniform axis whose ends differ: λ_k = (2/h sin(π (2k + 1) / 4n))².
    let n = 200;
    let mut values = eigen::Eigen::new(&PoissonAxis::uniform(n, 1e-3, NeumannDirichlet)).unwrap().values;
    values.sort_by(f64::total_cmp);
    for (k, value) in values.iter().enumerate() {
        let angle = std::f64::consts::PI * (2 * k + 1) as f64 / (4 * n) as f64;
        let expected = (2e3 * angle.sin()).powi(2);
        assert!((value / expected - 1.0).abs() < 1e-12, "{k}: {value} {expected}");
    }
}

#[test]
fn nonsense_is_refused() {
    let axis = |widths: &[f64]| PoissonAxis { widths: widths.to_vec(), ends: Neumann };
    let new = |x, y| SeparablePoisson::<2>::new([x, y]).map(|_| ());
    assert_eq!(new(axis(&[1.0]), axis(&[])), Err(PoissonError::NoCells { axis: 1 }));
    let error = PoissonError::Spacing { axis: 0, spacing: -1.0 };
    assert_eq!(new(axis(&[1.0, -1.0]), axis(&[1.0])), Err(error));
    assert!(matches!(new(axis(&[1.0]), axis(&[f64::NAN])), Err(PoissonError::Spacing { axis: 1, .. })));
    let shifted = SeparablePoisson::new_helmholtz([axis(&[1.0]), axis(&[1.0])], f64::NAN);
    assert!(matches!(shifted, Err(PoissonError::Shift { .. })));

    for swept in 0..2 {
        let mut axes = [PoissonAxis::uniform(6, 1.0, Neumann), PoissonAxis::uniform(7, 1.0, Dirichlet)];
        axes[swept].widths[2] = 2.0;
        let mut solver = SeparablePoisson::new(axes).unwrap();
        assert_eq!(solver.solve(&mut [0.0; 41]), Err(PoissonError::Length { length: 41, cells: 42 }));
        for bad in [f64::NAN, f64::INFINITY] {
            let mut field = noise(42);
            field[6 * 5 + 2] = bad;
            let before = field.clone();
            let error = solver.solve(&mut field).unwrap_err();
            assert!(matches!(error, PoissonError::NonFinite { low: 5, high: 5, .. }), "{error}");
            assert!(error.to_string().contains("in layer 5 (of"), "{error}");
            assert!(field.iter().zip(&before).all(|(a, b)| a.to_bits() == b.to_bits()));
        }
        // The solver is as good as new.
        let (mut again, mut phi) = (noise(42), vec![f64::NAN; 42]);
        let rhs = again.clone();
        solver.solve(&mut again).unwrap();
        solver.solve_rows(|r, row| row.copy_from_slice(&rhs[6 * r..6 * r + 6]), &mut phi).unwrap();
        assert_eq!(again, phi);
    }
}
