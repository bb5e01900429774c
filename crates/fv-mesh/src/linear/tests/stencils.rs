//! The stencil matrix does what its compressed rows do, on boxes of all kinds.
use super::*;

fn check<const D: usize>(cells: [usize; D], periodic: [bool; D]) {
    let a = convection(cells, periodic, 2.0);
    let csr = a.to_matrix().unwrap();
    let n = a.n();
    let (b, x) = (noise(n, 11), noise(n, 12));
    let what = format!("{cells:?} {periodic:?}");
    let close = |a: &[f64], b: &[f64]| largest_difference(a, b) < 1e-13;
    assert!(close(&product(&a, &x), &product(&csr, &x)), "{what}");
    let (mut r, mut s) = (vec![0.0; n], vec![0.0; n]);
    a.residual(&b, &x, &mut r);
    csr.residual(&b, &x, &mut s);
    assert!(close(&r, &s), "{what}");
    a.h(&b, &x, &mut r).unwrap();
    csr.h(&b, &x, &mut s).unwrap();
    assert!(close(&r, &s), "{what}");
    a.write_diagonal(&mut r).unwrap();
    csr.write_diagonal(&mut s).unwrap();
    assert!(close(&r, &s), "{what}");
    let mut work = vec![0.0; n];
    for sweep in [Sweep::Forward, Sweep::Backward] {
        let (mut u, mut v) = (x.clone(), x.clone());
        a.sweep(sweep, &b, &mut u, &mut work);
        csr.sweep(sweep, &b, &mut v, &mut work);
        assert!(close(&u, &v), "{what} {sweep:?}");
    }
    assert!((a.dominance() - csr.dominance()).abs() < 1e-13);
    assert!(a.is_m_matrix() && csr.is_m_matrix());
    // DILU is ILU(0) where no two neighbours are one cell.
    let plain = (0..D).all(|axis| !(periodic[axis] && cells[axis] < 4));
    let wraps = (0..D).any(|axis| periodic[axis]);
    let dilu = Dilu::new(&a).unwrap();
    let mut m = dilu.with(&a).unwrap();
    if plain && !wraps {
        m.apply(&b, &mut r);
        Ilu0::new(&csr).unwrap().solve(&b, &mut s).unwrap();
        assert!(close(&r, &s), "{what}");
    }
    let (rows, columns) = (noise(n, 13), noise(n, 14));
    let mut scaled = a.clone();
    scaled.scale(&rows, &columns).unwrap();
    let inside: Vec<f64> = columns.iter().zip(&x).map(|(c, x)| c * x).collect();
    let outside: Vec<f64> = product(&a, &inside).iter().zip(&rows).map(|(y, r)| r * y).collect();
    assert!(close(&product(&scaled, &x), &outside), "{what}");
    // All solve the same system.
    let b = product(&csr, &x);
    let (u, info) = solve_bicgstab(&a, &mut m, &b).unwrap();
    assert!(largest_difference(&u, &x) < 1e-9 && info.iterations < 80, "{what} {info:?}");
    let u = solve_gauss_seidel(&RedBlack::new(&a), &b, SweepOrder::Symmetric).unwrap();
    assert!(largest_difference(&u, &x) < 1e-9, "{what}");
}

#[test]
fn boxes_of_all_kinds() {
    for periodic in [false, true] {
        for cells in [1, 2, 3, 7, 200] {
            check([cells], [periodic]);
        }
        for other in [false, true] {
            for cells in [[1, 1], [1, 5], [5, 1], [2, 2], [3, 2], [7, 11], [130, 3], [129, 2], [4, 6]] {
                check(cells, [periodic, other]);
            }
            for cells in [[1, 1, 1], [2, 3, 1], [3, 1, 4], [1, 4, 3], [5, 4, 7], [2, 2, 2]] {
                check(cells, [periodic, other, periodic]);
                check(cells, [other, periodic, periodic]);
            }
        }
    }
}

/// The factors are those of elimination within the pattern, wrapped neighbours included.
#[test]
fn dilu_of_a_wrapped_box_solves_its_own_product() {
    let a = convection([6, 5, 4], [true, true, true], 1.0);
    let csr = a.to_matrix().unwrap();
    let n = a.n();
    // Δ by the definition.
    let mut delta = vec![0.0; n];
    for row in 0..n {
        delta[row] = csr.diagonal(row);
        let (columns, values) = csr.row(row);
        for (&col, value) in columns.iter().zip(values) {
            if col < row {
                let back = csr.slot(col, row).unwrap();
                delta[row] -= value * csr.as_sprs().data()[back] / delta[col];
            }
        }
    }
    let z = noise(n, 13);
    // y = z + Δ⁻¹ U z, then r = Δ y + L y.
    let part = |x: &[f64], lower: bool| -> Vec<f64> {
        (0..n)
            .map(|row| {
                let (columns, values) = csr.row(row);
                let kept = columns.iter().zip(values).filter(|(c, _)| **c != row && (**c < row) == lower);
                kept.map(|(&col, v)| v * x[col]).sum()
            })
            .collect()
    };
    let upper = part(&z, false);
    let y: Vec<f64> = (0..n).map(|c| z[c] + upper[c] / delta[c]).collect();
    let lower = part(&y, true);
    let r: Vec<f64> = (0..n).map(|c| delta[c] * y[c] + lower[c]).collect();
    let mut found = vec![0.0; n];
    Dilu::new(&a).unwrap().with(&a).unwrap().apply(&r, &mut found);
    assert!(largest_difference(&found, &z) < 1e-13);
}

#[test]
fn one_red_black_sweep_solves_the_second_colour() {
    let a = convection([8, 7, 3], [true, false, false], 2.0);
    let b = noise(a.n(), 14);
    let (mut x, mut work, mut r) = (noise(a.n(), 15), vec![0.0; a.n()], vec![0.0; a.n()]);
    RedBlack::new(&a).sweep(Sweep::Forward, &b, &mut x, &mut work);
    a.residual(&b, &x, &mut r);
    for c in 0..a.n() {
        let odd = (c % 8 + c / 8 % 7 + c / 56) % 2 == 1;
        assert!((r[c].abs() < 1e-13) == odd, "cell {c}: {}", r[c]);
    }
}
