//! Under-relaxed, pinned and blended rows.
use super::*;

/// Both kinds of matrix of one system.
fn both() -> (StencilMatrix<2>, Matrix, Vec<f64>) {
    let a = convection([9, 6], [true, false], 3.0);
    let csr = a.to_matrix().unwrap();
    let b = noise(a.n(), 21);
    (a, csr, b)
}

#[test]
fn the_under_relaxed_fixpoint_is_the_solution() {
    let (a, csr, b) = both();
    let exact = solve_lu(&csr, &b).unwrap();
    let (mut x, mut y) = (vec![0.0; b.len()], vec![0.0; b.len()]);
    for _ in 0..600 {
        let (mut a, mut csr) = (a.clone(), csr.clone());
        let (mut p, mut q) = (b.clone(), b.clone());
        a.under_relax(0.7, &x, &mut p).unwrap();
        csr.under_relax(0.7, &y, &mut q).unwrap();
        assert!(largest_difference(&product(&a, &exact), &product(&csr, &exact)) < 1e-12);
        x = solve_lu(&a.to_matrix().unwrap(), &p).unwrap();
        y = solve_lu(&csr, &q).unwrap();
    }
    assert!(largest_difference(&x, &exact) < 1e-10);
    assert!(largest_difference(&y, &exact) < 1e-10);
    // One that is already the solution stays it, whatever the factor.
    let (mut relaxed, mut p) = (csr.clone(), b.clone());
    relaxed.under_relax(0.2, &exact, &mut p).unwrap();
    assert!(largest_difference(&solve_lu(&relaxed, &p).unwrap(), &exact) < 1e-12);
}

#[test]
fn pinned_rows_are_exact() {
    let (mut a, mut csr, b) = both();
    let (mut p, mut q) = (b.clone(), b);
    for (row, value) in [(0, 0.3), (20, -7.0), (53, 1e-9)] {
        a.pin(row, value, &mut p).unwrap();
        csr.pin(row, value, &mut q).unwrap();
        assert_eq!(p[row], q[row]);
    }
    assert_eq!(a.to_matrix().unwrap(), csr);
    let dilu = Dilu::new(&a).unwrap();
    let (x, _) = solve_bicgstab(&a, &mut dilu.with(&a).unwrap(), &p).unwrap();
    let y = solve_lu(&csr, &q).unwrap();
    for (row, value) in [(0, 0.3), (20, -7.0), (53, 1e-9)] {
        assert!((x[row] - value).abs() <= 1e-11 && (y[row] - value).abs() <= 1e-15 * value.abs().max(1.0));
    }
    assert!(largest_difference(&x, &y) < 1e-10);
}

#[test]
fn symmetric_pins_give_the_same_answer_and_stay_symmetric() {
    let a = laplacian([7, 8], [true, false]);
    let csr = a.to_matrix().unwrap();
    let b = noise(a.n(), 22);
    let (mut plain, mut p) = (csr.clone(), b.clone());
    let (mut symmetric, mut q) = (csr, b.clone());
    let (mut stencil, mut s) = (a, b);
    for (row, value) in [(3, 2.0), (4, -1.0), (30, 0.5)] {
        plain.pin(row, value, &mut p).unwrap();
        symmetric.pin_symmetric(row, value, &mut q).unwrap();
        stencil.pin_symmetric(row, value, &mut s).unwrap();
    }
    assert_eq!(q, s);
    assert_eq!(stencil.to_matrix().unwrap(), symmetric);
    let x = solve_lu(&plain, &p).unwrap();
    let mut y = vec![0.0; x.len()];
    SparseCholesky::new(&symmetric).unwrap().solve(&symmetric, &q, &mut y, &DirectParams::default()).unwrap();
    assert!(largest_difference(&x, &y) < 1e-12);
    assert!(SparseCholesky::new(&plain).is_err());
}

#[test]
fn blended_rows_lie_between() {
    let (a, csr, b) = both();
    let free = solve_lu(&csr, &b).unwrap();
    let mut before = free[13];
    let target = before + 1.0;
    for weight in [0.25, 0.5, 0.75, 1.0] {
        let (mut stencil, mut p) = (a.clone(), b.clone());
        let (mut rows, mut q) = (csr.clone(), b.clone());
        stencil.blend(13, weight, target, &mut p).unwrap();
        rows.blend(13, weight, target, &mut q).unwrap();
        assert_eq!(p, q);
        assert_eq!(stencil.to_matrix().unwrap(), rows);
        let x = solve_lu(&rows, &q).unwrap();
        // The row says (1 − w)(a_P x_P + Σ a_N x_N − b) + w a_P (x_P − value) = 0.
        let h = |x: &[f64]| {
            let mut h = vec![0.0; x.len()];
            csr.h(&b, x, &mut h).unwrap();
            h[13]
        };
        let expected = (1.0 - weight) * h(&x) / csr.diagonal(13) + weight * target;
        assert!((x[13] - expected).abs() < 1e-13);
        assert!(x[13] > before);
        before = x[13];
    }
    assert!((before - target).abs() < 1e-14);
}

#[test]
fn an_empty_row_can_be_pinned() {
    let mut a = StencilMatrix::new([3, 1], [false, true]).unwrap();
    let mut b = [0.0; 3];
    for cell in 0..3 {
        a.pin(cell, cell as f64, &mut b).unwrap();
    }
    assert_eq!(solve_lu(&a.to_matrix().unwrap(), &b).unwrap(), [0.0, 1.0, 2.0]);
}

#[test]
fn patterns_are_fixed_and_complete() {
    let mut a = Matrix::from_pattern(3, [(0, 2), (0, 2)]).unwrap();
    assert_eq!(a.as_sprs().nnz(), 5);
    let slot = a.slot(2, 0).unwrap();
    a.values_mut()[slot] += 4.0;
    a.add(0, 0, 2.0).unwrap();
    assert_eq!(a.row(2), (&[0, 2][..], &[4.0, 0.0][..]));
    assert_eq!(Matrix::from_sprs(&a.as_sprs().to_csc()).unwrap(), a);
    assert_eq!(a.dominance(), f64::NEG_INFINITY);
    a.clear();
    assert!(a.as_sprs().data().iter().all(|v| *v == 0.0));
    assert!(a.dominance().is_nan() && !a.is_m_matrix());
}
