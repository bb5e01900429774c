//! Factors of matrices with few columns, and the leading ones of larger matrices.
use super::Frame;
use monomorphic::{Mat, MatMut, MatRef, add_product, self_adjoint_eigenvectors};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The columns as slices.
pub(super) fn columns(a: &mut Mat<f64>) -> Vec<&mut [f64]> {
    let columns: Option<Vec<_>> =
        a.col_iter_mut().map(|c| c.try_as_col_major_mut().map(|c| c.as_slice_mut())).collect();
    columns.expect("columns of a matrix are contiguous")
}

/// `to` += factor `x`.
pub(super) fn add(to: &mut Mat<f64>, factor: f64, x: &Mat<f64>) {
    for c in 0..to.ncols() {
        to.col_as_slice_mut(c).iter_mut().zip(x.col_as_slice(c)).for_each(|(t, x)| *t += factor * x);
    }
}

/// A B of stored matrices and views.
pub(super) fn product(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> Mat<f64> {
    let mut c = Mat::zeros(a.nrows(), b.ncols());
    add_product(c.as_mut(), a, b);
    c
}

/// Σ a_ij b_ij, column by column.
pub(super) fn inner(a: MatRef<'_, f64>, b: MatRef<'_, f64>) -> f64 {
    let column = |(a, b): (monomorphic::ColRef<'_, f64>, monomorphic::ColRef<'_, f64>)| match (
        a.try_as_col_major(),
        b.try_as_col_major(),
    ) {
        (Some(a), Some(b)) => dot(a.as_slice(), b.as_slice()),
        _ => a.iter().zip(b.iter()).map(|(a, b)| a * b).sum(),
    };
    a.col_iter().zip(b.col_iter()).map(column).sum()
}

/// Replaces the columns by orthonormal ones and tells R of A = Q R. A column that depends on those before it, to round-off, becomes zero.
pub(super) fn orthonormalise(a: &mut Mat<f64>) -> Mat<f64> {
    let n = a.ncols();
    let mut r = Mat::zeros(n, n);
    let mut columns = columns(a);
    for j in 0..n {
        let (done, rest) = columns.split_at_mut(j);
        let column = &mut *rest[0];
        let before = dot(column, column).sqrt();
        // Twice is enough (Giraud, Langou, Rozložník & van den Eshof 2005).
        for _ in 0..2 {
            for (i, other) in done.iter().enumerate() {
                let c = dot(other, column);
                r[(i, j)] += c;
                column.iter_mut().zip(&**other).for_each(|(x, q)| *x -= c * q);
            }
        }
        let norm = dot(column, column).sqrt();
        if norm > 1e-14 * before {
            r[(j, j)] = norm;
            column.iter_mut().for_each(|x| *x /= norm);
        } else {
            column.fill(0.0);
        }
    }
    r
}

/// A = U S Vᵀ by Jacobi's rotations of pairs of columns (Hestenes 1958), accurate to round-off even of small singular values; for few
/// columns. U S and V; columns by descending norm.
pub(super) fn jacobi(mut a: Mat<f64>) -> (Mat<f64>, Vec<f64>, Mat<f64>) {
    let n = a.ncols();
    let mut v = Mat::identity(n, n);
    {
        let mut a = columns(&mut a);
        let mut v = columns(&mut v);
        for _ in 0..40 {
            let mut turned = false;
            for i in 0..n {
                for j in i + 1..n {
                    let [p, q] = [dot(a[i], a[i]), dot(a[j], a[j])];
                    let c = dot(a[i], a[j]);
                    // A column below the least of the numbers that can be squared is nothing.
                    if c.abs() <= 1e-15 * (p * q).sqrt() || c.abs() < 1e-290 {
                        continue;
                    }
                    turned = true;
                    let zeta = (q - p) / (2.0 * c);
                    let tan = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                    let cos = 1.0 / tan.hypot(1.0);
                    let sin = cos * tan;
                    for m in [&mut a, &mut v] {
                        let (left, right) = m.split_at_mut(j);
                        for (x, y) in left[i].iter_mut().zip(right[0].iter_mut()) {
                            (*x, *y) = (cos * *x - sin * *y, sin * *x + cos * *y);
                        }
                    }
                }
            }
            if !turned {
                break;
            }
        }
    }
    let norms: Vec<f64> = (0..n).map(|i| a.col(i).norm_l2()).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| norms[j].total_cmp(&norms[i]));
    let sorted = |m: &Mat<f64>| Mat::from_fn(m.nrows(), n, |i, j| m[(i, order[j])]);
    (sorted(&a), order.iter().map(|&i| norms[i]).collect(), sorted(&v))
}

/// U S Vᵀ of A with few columns, of which `rank` are kept, and none that is nothing to round-off.
pub(super) fn thin(a: Mat<f64>, rank: usize) -> (Mat<f64>, Vec<f64>, Mat<f64>) {
    let (mut u, mut s, v) = jacobi(a);
    let floor = s.first().map_or(0.0, |s| s * 1e-15);
    s.truncate(rank);
    s.retain(|&s| s > floor);
    let r = s.len();
    u = u.subcols(0, r).to_owned();
    columns(&mut u).into_iter().zip(&s).for_each(|(u, s)| u.iter_mut().for_each(|x| *x /= s));
    (u, s, v.subcols(0, r).to_owned())
}

/// The eigenvectors of AᵀA or, if that is smaller, of A Aᵀ, by descending eigenvalue; as columns.
fn gram_vectors(a: MatRef<'_, f64>) -> Option<Mat<f64>> {
    let short = if a.nrows() < a.ncols() { a.transpose() } else { a };
    let n = short.ncols();
    let mut gram = Mat::zeros(n, n);
    add_product(gram.as_mut(), short.transpose(), short);
    let ascending = self_adjoint_eigenvectors(gram.as_ref())?;
    Some(Mat::from_fn(n, n, |i, j| ascending[(i, n - 1 - j)]))
}

impl Frame {
    /// Nothing.
    pub(super) fn nothing(n_rows: usize, n_snapshots: usize) -> Self {
        Self {
            modes: Mat::zeros(n_rows, 0),
            singular_values: vec![],
            coefficients: Mat::zeros(0, n_snapshots),
        }
    }

    /// The best approximation of `field` of this rank, by way of the smaller Gram matrix: vectors to singular values below 1e-7 of the
    /// first one are inaccurate, though orthonormal.
    pub(super) fn truncated(field: MatRef<'_, f64>, rank: usize) -> Self {
        let rank = rank.min(field.nrows()).min(field.ncols());
        let Some(vectors) = gram_vectors(field).filter(|_| rank > 0) else {
            return Self::nothing(field.nrows(), field.ncols());
        };
        Self::within(field, vectors.subcols(0, rank), rank)
    }

    /// Nearly the best approximation of this rank, by four steps of a block iteration from numbers drawn at random (Halko, Martinsson &
    /// Tropp 2011), or exactly if the snapshots are few.
    pub(super) fn leading(field: MatRef<'_, f64>, rank: usize) -> Self {
        const OVERSAMPLING: usize = 6;
        let n = field.ncols();
        if n.min(field.nrows()) <= 64 {
            return Self::truncated(field, rank);
        }
        let mut rng = Pcg64::seed_from_u64(n as u64);
        let mut vectors = Mat::from_fn(n, rank + OVERSAMPLING, |_, _| rng.random_range(-1.0..1.0));
        for _ in 0..4 {
            orthonormalise(&mut vectors);
            let images = product(field, vectors.as_ref());
            vectors = product(field.transpose(), images.as_ref());
        }
        orthonormalise(&mut vectors);
        let (modes, singular_values, v) = thin(product(field, vectors.as_ref()), rank);
        Self {
            modes,
            singular_values,
            coefficients: product(vectors.as_ref(), v.as_ref()).transpose().to_owned(),
        }
    }

    /// The best approximation of this rank with rows, or columns if they are shorter, in the span of these orthonormal vectors.
    fn within(field: MatRef<'_, f64>, vectors: MatRef<'_, f64>, rank: usize) -> Self {
        let wide = field.nrows() < field.ncols();
        let short = if wide { field.transpose() } else { field };
        let (u, singular_values, v) = thin(product(short, vectors), rank);
        let v = product(vectors, v.as_ref());
        let (modes, coefficients) =
            if wide { (v, u.transpose().to_owned()) } else { (u, v.transpose().to_owned()) };
        Self { modes, singular_values, coefficients }
    }

    /// Singular values less `threshold` of those that are greater: the minimum of ½‖X − field‖² + threshold ‖X‖_*.
    pub(super) fn thresholded(field: MatRef<'_, f64>, threshold: f64) -> Self {
        let Some(vectors) = gram_vectors(field) else {
            return Self::nothing(field.nrows(), field.ncols());
        };
        let wide = field.nrows() < field.ncols();
        let short = if wide { field.transpose() } else { field };
        let images = product(short, vectors.as_ref());
        let norms: Vec<f64> = images.col_iter().map(|c| c.norm_l2()).collect();
        let mut kept: Vec<usize> = (0..norms.len()).filter(|&i| norms[i] > threshold).collect();
        kept.sort_by(|&i, &j| norms[j].total_cmp(&norms[i]));
        let r = kept.len();
        let u = Mat::from_fn(images.nrows(), r, |i, j| images[(i, kept[j])] / norms[kept[j]]);
        let v = Mat::from_fn(vectors.nrows(), r, |i, j| vectors[(i, kept[j])]);
        let singular_values = kept.iter().map(|&i| norms[i] - threshold).collect();
        let (modes, coefficients) =
            if wide { (v, u.transpose().to_owned()) } else { (u, v.transpose().to_owned()) };
        Self { modes, singular_values, coefficients }
    }

    /// `to` += factor Φ Σ A.
    pub(super) fn add_to(&self, to: MatMut<'_, f64>, factor: f64) {
        let mut scaled = self.scaled_coefficients();
        columns(&mut scaled).into_iter().flatten().for_each(|x| *x *= factor);
        add_product(to, self.modes.as_ref(), scaled.as_ref());
    }
}
