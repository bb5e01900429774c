//! Systems and arguments that must be refused.
use super::*;

#[test]
fn singular_matrices_are_told() {
    // Rows that are multiples of each other.
    let a = Matrix::from_triplets(2, &[(0, 0, 1.0), (0, 1, 2.0), (1, 0, 2.0), (1, 1, 4.0)]).unwrap();
    assert!(matches!(
        solve_lu(&a, &[1.0, 0.0]),
        Err(LinearError::NotConverged { .. } | LinearError::NonFinite { .. })
    ));
    assert!(matches!(Ilu0::new(&a), Err(LinearError::ZeroPivot { row: 1, value: 0.0 })));
    assert!(matches!(SparseCholesky::new(&a).err(), Some(LinearError::NotPositiveDefinite { .. })));
    assert!(solve_bicgstab(&a, &mut Identity::new(2), &[1.0, 0.0]).is_err());
    // All sides periodic and a right-hand side that does not sum up to zero.
    let a = laplacian([12, 12], [true, true]);
    let error = solve_cg(&a, &mut Identity::new(144), &[1.0; 144]);
    assert!(
        matches!(error, Err(LinearError::Indefinite { .. } | LinearError::NotConverged { .. })),
        "{error:?}"
    );
    let error = solve_lu(&a.to_matrix().unwrap(), &[1.0; 144]);
    assert!(
        matches!(error, Err(LinearError::NotConverged { .. } | LinearError::NonFinite { .. })),
        "{error:?}"
    );
}

#[test]
fn an_empty_matrix_is_singular() {
    let a = Matrix::from_pattern(3, []).unwrap();
    assert!(matches!(
        solve_lu(&a, &[1.0; 3]),
        Err(LinearError::NonFinite { .. } | LinearError::Singular { .. })
    ));
    let zero = LinearError::ZeroPivot { row: 0, value: 0.0 };
    assert_eq!(a.check_diagonal(), Err(zero.clone()));
    assert_eq!(solve_gauss_seidel(&a, &[1.0; 3], SweepOrder::Forward), Err(zero.clone()));
    assert_eq!(Jacobi::new(&[0.0]), Err(zero.clone()));
    assert_eq!(Dilu::new(&StencilMatrix::new([3, 2], [true; 2]).unwrap()), Err(zero));
}

#[test]
fn indefinite_matrices_are_told() {
    let a = Matrix::from_triplets(2, &[(0, 0, 1.0), (1, 1, -1.0)]).unwrap();
    assert!(matches!(
        solve_cg(&a, &mut Identity::new(2), &[1.0, 2.0]),
        Err(LinearError::Indefinite { iteration: 0, value: -3.0, .. })
    ));
    assert_eq!(SparseCholesky::new(&a).err(), Some(LinearError::NotPositiveDefinite { row: 1 }));
    assert_eq!(solve_lu(&a, &[1.0, 2.0]).unwrap(), [1.0, -2.0]);
    assert!(
        largest_difference(&solve_bicgstab(&a, &mut Identity::new(2), &[1.0, 2.0]).unwrap().0, &[1.0, -2.0])
            < 1e-12
    );
}

#[test]
fn skew_matrices_break_down() {
    let a = Matrix::from_triplets(2, &[(0, 1, 1.0), (1, 0, -1.0)]).unwrap();
    assert!(matches!(
        solve_bicgstab(&a, &mut Identity::new(2), &[1.0, 2.0]),
        Err(LinearError::Breakdown { iteration: 0, value: 0.0, .. })
    ));
}

#[test]
fn too_few_iterations_are_told() {
    let a = laplacian([30, 30], [false, false]);
    let b = vec![1.0; 900];
    let mut x = vec![0.0; 900];
    let params = CgParams { max_iterations: 3, ..CgParams::default() };
    let result =
        conjugate_gradient(&a, &mut Identity::new(900), &b, &mut x, &mut CgScratch::new(900), &params);
    let Err(LinearError::NotConverged { iterations: 3, residual, tolerance: 1e-8 }) = result else {
        panic!("{result:?}");
    };
    let r: Vec<f64> = product(&a, &x).iter().map(|ax| 1.0 - ax).collect();
    assert!((vector::norm(&r) / 30.0 - residual).abs() < 1e-14);
    let params = BiCgStabParams { max_iterations: 3, ..BiCgStabParams::default() };
    let result = bicgstab(&a, &mut Identity::new(900), &b, &mut x, &mut BiCgStabScratch::new(900), &params);
    assert!(matches!(result, Err(LinearError::NotConverged { iterations: 3, .. })));
    let params = GaussSeidelParams { max_iterations: 3, ..GaussSeidelParams::default() };
    let result = gauss_seidel(&a, &b, &mut x, &mut GaussSeidelScratch::new(900), &params);
    assert!(matches!(result, Err(LinearError::NotConverged { iterations: 3, .. })));
    // Nothing is below round-off.
    let params = BiCgStabParams { relative: 1e-18, ..BiCgStabParams::default() };
    let result = bicgstab(&a, &mut Identity::new(900), &b, &mut x, &mut BiCgStabScratch::new(900), &params);
    assert!(
        matches!(result, Err(LinearError::NotConverged { residual, .. }) if residual < 1e-12),
        "{result:?}"
    );
}

#[test]
fn arguments_are_checked() {
    let a = laplacian([3], [false]);
    let mut scratch = BiCgStabScratch::new(3);
    let params = BiCgStabParams::default();
    let mut m = Identity::new(3);
    let mut solve =
        |b: &[f64], x: &mut [f64], p: &BiCgStabParams| bicgstab(&a, &mut m, b, x, &mut scratch, p);
    assert_eq!(
        solve(&[1.0; 2], &mut [0.0; 3], &params),
        Err(LinearError::Shape { what: "b", expected: 3, found: 2 })
    );
    assert_eq!(
        solve(&[1.0; 3], &mut [0.0; 4], &params),
        Err(LinearError::Shape { what: "x", expected: 3, found: 4 })
    );
    let infinite = [0.0, f64::INFINITY, 0.0];
    assert!(matches!(
        solve(&infinite, &mut [0.0; 3], &params),
        Err(LinearError::NonFinite { what: "b", row: 1, .. })
    ));
    assert!(matches!(
        solve(&[1.0; 3], &mut infinite.clone(), &params),
        Err(LinearError::NonFinite { what: "x", row: 1, .. })
    ));
    let wrong = BiCgStabParams { relative: f64::NAN, ..params };
    assert!(matches!(solve(&[1.0; 3], &mut [0.0; 3], &wrong), Err(LinearError::Parameter { .. })));
    let mut matrix = a.to_matrix().unwrap();
    assert_eq!(matrix.add(0, 2, 1.0), Err(LinearError::Pattern { row: 0, col: 2, n: 3 }));
    assert_eq!(Matrix::from_triplets(2, &[(2, 0, 1.0)]), Err(LinearError::Pattern { row: 2, col: 0, n: 2 }));
    let mut b = [0.0; 3];
    for alpha in [0.0, -0.5, 1.5, f64::NAN] {
        assert!(matches!(matrix.under_relax(alpha, &[0.0; 3], &mut b), Err(LinearError::Parameter { .. })));
    }
    assert!(matches!(matrix.blend(0, 1.5, 0.0, &mut b), Err(LinearError::Parameter { .. })));
    assert!(matches!(matrix.pin(3, 0.0, &mut b), Err(LinearError::Pattern { .. })));
    assert!(matches!(matrix.pin(0, f64::NAN, &mut b), Err(LinearError::NonFinite { row: 0, .. })));
    let mut other = Matrix::from_pattern(3, [(0, 2)]).unwrap();
    other.values_mut().fill(1.0);
    assert!(matches!(Ilu0::new(&matrix).unwrap().refactor(&other), Err(LinearError::PatternChanged { .. })));
    matrix.values_mut()[0] = f64::NAN;
    assert!(matches!(SparseLu::new(&matrix).err(), Some(LinearError::NonFinite { row: 0, .. })));
    let skewed = Matrix::from_triplets(2, &[(0, 0, 2.0), (1, 1, 2.0), (0, 1, 1.0)]).unwrap();
    let refusal = LinearError::NotSymmetric { row: 0, col: 1, value: 1.0, mirrored: 0.0 };
    assert_eq!(SparseCholesky::new(&skewed).err(), Some(refusal));
    assert!(matches!(StencilMatrix::new([4, 0], [true; 2]), Err(LinearError::Cells { .. })));
    assert!(matches!(StencilMatrix::new([usize::MAX, 2], [true; 2]), Err(LinearError::Cells { .. })));
}
