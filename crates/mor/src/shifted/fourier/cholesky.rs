//! Factors of small matrices.

/// L of L Lᵀ = M + ε for M, column by column; pivots below ε are taken for ε.
pub(in crate::shifted) fn factorise(n: usize, m: &mut [f64], damping: f64) {
    for k in 0..n {
        let (before, after) = m.split_at_mut((k + 1) * n);
        let column = &mut before[k * n..];
        let pivot = (column[k].max(0.0) + damping).max(f64::MIN_POSITIVE).sqrt();
        column[k] = pivot;
        column[k + 1..].iter_mut().for_each(|x| *x /= pivot);
        for (j, other) in (k + 1..n).zip(after.chunks_exact_mut(n)) {
            let factor = column[j];
            other[j..].iter_mut().zip(&column[j..]).for_each(|(x, l)| *x -= l * factor);
        }
    }
}

/// Replaces x by (L Lᵀ)⁻¹ x.
pub(in crate::shifted) fn substitute(l: &[f64], x: &mut [f64]) {
    let n = x.len();
    for k in 0..n {
        let column = &l[k * n..][..n];
        x[k] /= column[k];
        let y = x[k];
        x[k + 1..].iter_mut().zip(&column[k + 1..]).for_each(|(x, l)| *x -= l * y);
    }
    for k in (0..n).rev() {
        let column = &l[k * n..][..n];
        let sum: f64 = column[k + 1..].iter().zip(&x[k + 1..]).map(|(l, x)| l * x).sum();
        x[k] = (x[k] - sum) / column[k];
    }
}

/// L of L Lᴴ = M + ε for a Hermitian M, real parts of all columns before imaginary parts; pivots below ε
/// are taken for ε.
#[inline(always)]
pub(super) fn factorise_hermitian(n: usize, m: &mut [f64], damping: f64) {
    let (re, im) = m.split_at_mut(n * n);
    for k in 0..n {
        let ((re, re_after), (im, im_after)) = (re.split_at_mut((k + 1) * n), im.split_at_mut((k + 1) * n));
        let (re, im) = (&mut re[k * n..], &mut im[k * n..]);
        let pivot = (re[k].max(0.0) + damping).max(f64::MIN_POSITIVE).sqrt();
        (re[k], im[k]) = (pivot, 0.0);
        re[k + 1..].iter_mut().chain(&mut im[k + 1..]).for_each(|x| *x /= pivot);
        let others = re_after.chunks_exact_mut(n).zip(im_after.chunks_exact_mut(n));
        for (j, (to_re, to_im)) in (k + 1..n).zip(others) {
            // M_ij − L_ik L̄_jk
            let (fr, fi) = (re[j], im[j]);
            let of = re[j..].iter().zip(&im[j..]);
            for ((x, y), (r, i)) in to_re[j..].iter_mut().zip(&mut to_im[j..]).zip(of) {
                *x -= r * fr + i * fi;
                *y -= i * fr - r * fi;
            }
        }
    }
}

/// Replaces x, real parts before imaginary parts, by (L Lᴴ)⁻¹ x.
#[inline(always)]
pub(super) fn substitute_hermitian(l: &[f64], x: &mut [f64]) {
    let n = x.len() / 2;
    let (re, im) = l.split_at(n * n);
    let (xr, xi) = x.split_at_mut(n);
    for k in 0..n {
        let (lr, li) = (&re[k * n..][..n], &im[k * n..][..n]);
        let (yr, yi) = (xr[k] / lr[k], xi[k] / lr[k]);
        (xr[k], xi[k]) = (yr, yi);
        let of = lr[k + 1..].iter().zip(&li[k + 1..]);
        for ((a, b), (r, i)) in xr[k + 1..].iter_mut().zip(&mut xi[k + 1..]).zip(of) {
            *a -= r * yr - i * yi;
            *b -= r * yi + i * yr;
        }
    }
    for k in (0..n).rev() {
        let (lr, li) = (&re[k * n..][..n], &im[k * n..][..n]);
        let (mut a, mut b) = (xr[k], xi[k]);
        for i in k + 1..n {
            a -= lr[i] * xr[i] + li[i] * xi[i];
            b -= lr[i] * xi[i] - li[i] * xr[i];
        }
        (xr[k], xi[k]) = (a / lr[k], b / lr[k]);
    }
}

#[cfg(test)]
mod tests {
    use super::{factorise_hermitian, substitute_hermitian};

    #[test]
    fn complex_factors_solve() {
        // M = G Gᴴ.
        let n = 4;
        let g = |i: usize, j: usize| [((3 * i + 5 * j) % 7) as f64 - 2.5, ((2 * i + j * j) % 5) as f64 - 2.0];
        let entry = |i: usize, j: usize| {
            (0..n + 1).fold([0.0; 2], |[re, im], c| {
                let ([a, b], [x, y]) = (g(i, c), g(j, c));
                [re + a * x + b * y, im + b * x - a * y]
            })
        };
        let part = |p: usize| (0..n * n).map(move |e| entry(e % n, e / n)[p]);
        let mut m: Vec<f64> = part(0).chain(part(1)).collect();
        let expected: Vec<f64> = (0..2 * n).map(|i| i as f64 - 1.7).collect();
        let mut x: Vec<f64> = (0..2 * n)
            .map(|i| {
                (0..n)
                    .map(|j| {
                        let ([a, b], [re, im]) = (entry(i % n, j), [expected[j], expected[n + j]]);
                        if i < n { a * re - b * im } else { a * im + b * re }
                    })
                    .sum()
            })
            .collect();
        factorise_hermitian(n, &mut m, 0.0);
        substitute_hermitian(&m, &mut x);
        assert!(x.iter().zip(&expected).all(|(x, e)| (x - e).abs() < 1e-9), "{x:?}");
    }
}
