//! Dense systems, against what they must reproduce.
use monomorphic::{DenseLu, Mat, Qr, solve_positive};

/// Well conditioned, without structure.
fn matrix(rows: usize, columns: usize) -> Mat<f64> {
    Mat::from_fn(rows, columns, |i, j| {
        ((i * 37 + j * 101) % 97) as f64 / 97.0 + if i == j { 3.0 } else { 0.0 }
    })
}

fn largest(a: &Mat<f64>) -> f64 {
    (0..a.ncols()).flat_map(|j| a.col_as_slice(j)).fold(0.0, |m, v| m.max(v.abs()))
}

#[test]
fn lu_solves_and_inverts() {
    for n in [1, 7, 90] {
        // Rows turned round: nothing works without pivoting when the first pivot is zero.
        let mut a = matrix(n, n);
        a[(0, 0)] = if n > 1 { 0.0 } else { 2.0 };
        let x = matrix(n, 3.min(n));
        let lu = DenseLu::new(a.clone());
        let mut b = &a * &x;
        lu.solve(b.as_mut());
        assert!(largest(&(&b - &x)) < 1e-10, "n = {n}");
        let identity = Mat::<f64>::identity(n, n);
        assert!(largest(&(&a * lu.inverse() - &identity)) < 1e-10, "n = {n}");
    }
    let mut b = matrix(2, 1);
    DenseLu::new(Mat::from_fn(2, 2, |_, j| j as f64)).solve(b.as_mut());
    assert!(!b[(1, 0)].is_finite());
}

#[test]
fn qr_finds_the_least_squares() {
    for (m, n) in [(1, 1), (9, 4), (200, 60)] {
        let a = matrix(m, n);
        let b = Mat::from_fn(m, 2, |i, j| ((i * 13 + j * 5) % 11) as f64);
        let qr = Qr::new(a.clone());
        let mut solved = b.clone();
        qr.solve(solved.as_mut());
        let x = solved.subrows(0, n).to_owned();
        let residual = &a * &x - &b;
        assert!(largest(&(a.transpose() * &residual)) < 1e-9 * m as f64, "{m} × {n}");
        let rest = solved.subrows(n, m - n).to_owned();
        assert!((rest.norm_l2() - residual.norm_l2()).abs() < 1e-10 * b.norm_l2(), "{m} × {n}");
        assert!(qr.diagonal().all(|r| r.abs() > 0.1));
    }
    // The third column is the sum of the others.
    let dependent = Mat::from_fn(20, 3, |i, j| [1.0, (i as f64).sin(), 1.0 + (i as f64).sin()][j]);
    let diagonal: Vec<f64> = Qr::new(dependent).diagonal().map(f64::abs).collect();
    assert!(diagonal[1] > 0.1 && diagonal[2] < 1e-14, "{diagonal:?}");
}

#[test]
fn positive_matrices_are_solved_and_others_refused() {
    let root = matrix(50, 50);
    let a = root.transpose() * &root;
    let x = matrix(50, 2);
    let mut b = &a * &x;
    assert!(solve_positive(a.as_ref(), b.as_mut()));
    assert!(largest(&(&b - &x)) < 1e-7);
    let mut indefinite = a.clone();
    indefinite[(30, 30)] = -1.0;
    let before = b.clone();
    assert!(!solve_positive(indefinite.as_ref(), b.as_mut()));
    assert!(b == before);
}
