//! Factors of small matrices, against what they must reproduce.
use monomorphic::{
    Cholesky, FactorError, Lu, Mat, Pattern, add_product, fourier_transforms, inverse,
    self_adjoint_eigenvectors,
};
use rustfft::num_complex::Complex;
use std::f64::consts::PI;

const N: usize = 40;

/// A five-diagonal matrix: starts, columns and values.
fn matrix(lower: f64, upper: f64) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
    let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
    for i in 0..N {
        for j in 0..N {
            let value = match j as isize - i as isize {
                0 => 5.0 + i as f64,
                -1 | -6 => lower,
                1 | 6 => upper,
                _ => continue,
            };
            columns.push(j);
            values.push(value);
        }
        starts.push(columns.len());
    }
    (starts, columns, values)
}

fn product((starts, columns, values): &(Vec<usize>, Vec<usize>, Vec<f64>), x: &[f64]) -> Vec<f64> {
    (0..N).map(|i| (starts[i]..starts[i + 1]).map(|k| values[k] * x[columns[k]]).sum()).collect()
}

#[test]
fn sparse_factors_solve() {
    let x: Vec<f64> = (0..N).map(|i| (i as f64).sin()).collect();
    let near = |found: &[f64]| found.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-13);
    let symmetric = matrix(-1.0, -1.0);
    let pattern = Pattern { starts: &symmetric.0, columns: &symmetric.1 };
    let mut cholesky = Cholesky::new(pattern).unwrap();
    cholesky.factorize(pattern, &symmetric.2).unwrap();
    let mut v = product(&symmetric, &x);
    cholesky.solve(&mut v);
    assert!(near(&v), "{v:?}");
    // Row 7 is made negative.
    let mut values = symmetric.2.clone();
    let diagonal = (symmetric.0[7]..symmetric.0[8]).find(|&k| symmetric.1[k] == 7).unwrap();
    values[diagonal] = -3.0;
    assert_eq!(cholesky.factorize(pattern, &values), Err(FactorError::NotPositive { row: 7 }));

    let skew = matrix(-2.0, 0.7);
    let pattern = Pattern { starts: &skew.0, columns: &skew.1 };
    let mut lu = Lu::new(pattern).unwrap();
    lu.factorize(pattern, &skew.2).unwrap();
    let mut v = product(&skew, &x);
    lu.solve(&mut v);
    assert!(near(&v), "{v:?}");
    // Not with a row of nothing.
    let pattern = Pattern { starts: &[0, 1, 1], columns: &[0] };
    let singular = Lu::new(pattern).and_then(|mut lu| lu.factorize(pattern, &[1.0]));
    assert!(matches!(singular, Err(FactorError::Singular { .. })), "{singular:?}");
}

#[test]
fn dense_matrices() {
    let a = Mat::from_fn(N, N, |i, j| {
        if i == j { 2.0 + i as f64 } else { 0.3 * ((i + j) as f64).cos() + 0.1 * ((i * j) as f64).sin() }
    });
    // A⁻¹ A = 1.
    let mut one = Mat::zeros(N, N);
    add_product(one.as_mut(), inverse(a.as_ref()).as_ref(), a.as_ref());
    let off = |m: &Mat<f64>, at: &dyn Fn(usize, usize) -> f64| {
        let entries = (0..N).flat_map(|i| (0..N).map(move |j| (i, j)));
        entries.map(|(i, j)| (m[(i, j)] - at(i, j)).abs()).fold(0.0, f64::max)
    };
    let unit = |i: usize, j: usize| f64::from(u8::from(i == j));
    assert!(off(&one, &unit) < 1e-12);
    // Vᵀ V = 1 and Vᵀ A V is diagonal and ascending.
    let v = self_adjoint_eigenvectors(a.as_ref()).unwrap();
    let [mut gram, mut image, mut diagonal] = [const { || Mat::zeros(N, N) }; 3].map(|zeros| zeros());
    add_product(gram.as_mut(), v.transpose(), v.as_ref());
    add_product(image.as_mut(), a.as_ref(), v.as_ref());
    add_product(diagonal.as_mut(), v.transpose(), image.as_ref());
    assert!(off(&gram, &unit) < 1e-12);
    assert!(off(&diagonal, &|i, j| if i == j { diagonal[(i, i)] } else { 0.0 }) < 1e-11);
    assert!((1..N).all(|i| diagonal[(i, i)] >= diagonal[(i - 1, i - 1)]));
    // Of a matrix without an inverse.
    assert!(!inverse(Mat::<f64>::zeros(3, 3).as_ref())[(0, 0)].is_finite());
}

#[test]
fn waves_have_one_entry() {
    let n = 21;
    let [forward, back] = fourier_transforms(n);
    let wave = |j: usize| Complex::from_polar(1.0, 2.0 * PI * (4 * j) as f64 / n as f64);
    let mut x: Vec<_> = (0..n).map(wave).collect();
    forward.process(&mut x);
    let wanted = |k: usize| if k == 4 { n as f64 } else { 0.0 };
    assert!(x.iter().enumerate().all(|(k, x)| (x - wanted(k)).norm() < 1e-12));
    back.process(&mut x);
    assert!(x.iter().enumerate().all(|(j, x)| (x / n as f64 - wave(j)).norm() < 1e-13));
}
