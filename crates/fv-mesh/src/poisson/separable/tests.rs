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
                    let zero = match axis.ends {
                        Periodic => {
                            let o = n - 1 - end;
                            (phi[c + o * stride - i * stride], 0.5 * (w[i] + w[o]))
                        }
                        Dirichlet => (0.0, 0.5 * w[i]),
                        NeumannDirichlet if high => (0.0, 0.5 * w[i]),
                        DirichletNeumann if !high => (0.0, 0.5 * w[i]),
                        _ => return 0.0,
                    };
                    zero
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
        let limit = 16.0 * f64::EPSILON * size[c] * top + 1e-13;
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
    // Widths grow by 1.2 to a thousand times the first, and more.
    let mut worst = 0.0_f64;
    for (bx, by) in [
        (Neumann, Neumann),
        (Periodic, Neumann),
        (Dirichlet, Dirichlet),
        (Periodic, Periodic),
        (DirichletNeumann, Neumann),
        (NeumannDirichlet, Dirichlet),
    ] {
        for axes in [
            [growing(39, 1e-3, 1.2, bx), growing(39, 1e-3, 1.2, by)],
            [stretched(76, 1e-3, 1.2, bx), stretched(78, 1e-3, 1.2, by)],
            [growing(60, 1e-4, 1.2, bx), PoissonAxis::uniform(48, 0.01, by)],
            [PoissonAxis::uniform(48, 0.01, bx), growing(60, 1e-4, 1.2, by)],
            [stretched(100, 1e-4, 1.1, bx), growing(61, 1e-4, 1.2, by)],
        ] {
            let r = check(axes.clone(), 0.0);
            println!("{bx:?} {by:?} {} {}: {r:e}", axes[0].cells(), axes[1].cells());
            worst = worst.max(r);
        }
    }
    println!("{worst:e}");
}
