//! Few columns instead of many.
use crate::Mat;
use monomorphic::{MatMut, add_product};

/// Directions that are found at a time.
const BLOCK: usize = 4;
/// Fewer columns are left as they are.
const FEW: usize = 4;

/// D ≈ `data` · V.
pub(super) struct Compressed {
    /// Complex columns: real parts, then imaginary parts.
    pub(super) data: Vec<f64>,
    /// V: orthonormal rows; the real parts of all above the imaginary parts of all. None if it is the identity.
    pub(super) basis: Option<Mat<f64>>,
    /// The columns of D that V is about.
    pub(super) columns: Vec<usize>,
}

/// Approximates complex columns of length `n`, to ‖D − D Vᴴ V‖² ≤ `allowed`, and says what that is. The rows with the largest
/// residuals become V, one after the other.
pub(super) fn compress(n: usize, mut full: Vec<f64>, allowed: f64) -> (Compressed, f64) {
    let energies: Vec<f64> = full.chunks_exact(2 * n).map(|c| c.iter().map(|x| x * x).sum()).collect();
    let total = energies.len();
    // Half of what is allowed goes to columns with nearly nothing.
    let columns: Vec<_> = (0..total).filter(|&j| energies[j] > 0.5 * allowed / total as f64).collect();
    let dropped = energies.iter().sum::<f64>() - columns.iter().map(|&j| energies[j]).sum::<f64>();
    let g = columns.len();
    for (to, &from) in columns.iter().enumerate().filter(|(to, from)| to != *from) {
        full.copy_within(2 * n * from..2 * n * (from + 1), 2 * n * to);
    }
    full.truncate(2 * n * g);
    if g < FEW {
        return (Compressed { data: full, basis: None, columns }, dropped.max(0.0));
    }
    let mut rest = MatMut::from_column_major_slice_mut(&mut full, 2 * n, g);
    let most = n.min(g);
    let (mut data, mut rows) = (Vec::<f64>::new(), Vec::<Vec<f64>>::new());
    let left = loop {
        let mut of_row = vec![0.0; 2 * n];
        for j in 0..g {
            let column = &rest.as_ref().col(j);
            (0..2 * n).for_each(|i| of_row[i] += column[i].powi(2));
        }
        let mut norms: Vec<_> = (0..n).map(|i| (of_row[i] + of_row[n + i], i)).collect();
        let left = norms.iter().map(|x| x.0).sum::<f64>();
        if left <= 0.5 * allowed || rows.len() >= most {
            break left;
        }
        norms.sort_by(|a, b| b.0.total_cmp(&a.0));
        let first = rows.len();
        for &(_, i) in norms.iter().take(BLOCK.min(most - first)) {
            let row = (0..g).map(|j| rest[(i, j)]).chain((0..g).map(|j| rest[(n + i, j)])).collect();
            rows.extend(orthonormalised(row, &rows));
        }
        let new = &rows[first..];
        let b = new.len();
        if b == 0 {
            break left;
        }
        // D Vᴴ: [D_r; D_i] times V_rᵀ and V_iᵀ.
        let real = Mat::from_fn(g, b, |c, r| new[r][c]);
        let imaginary = Mat::from_fn(g, b, |c, r| new[r][g + c]);
        let (mut out, mut turned) = (Mat::zeros(2 * n, b), Mat::zeros(2 * n, b));
        add_product(out.as_mut(), rest.as_ref(), real.as_ref());
        add_product(turned.as_mut(), rest.as_ref(), imaginary.as_ref());
        for r in 0..b {
            let (t_r, t_i) = turned.col_as_slice(r).split_at(n);
            let (o_r, o_i) = out.col_as_slice_mut(r).split_at_mut(n);
            o_r.iter_mut().zip(t_i).for_each(|(o, t)| *o += t);
            o_i.iter_mut().zip(t_r).for_each(|(o, t)| *o -= t);
        }
        // D − (D Vᴴ) V, the imaginary parts with the coefficients times i.
        let negative = Mat::from_fn(2 * n, 2 * b, |i, r| match (r < b, i < n) {
            (true, _) => -out[(i, r)],
            (false, true) => out[(n + i, r - b)],
            (false, false) => -out[(i - n, r - b)],
        });
        let v = Mat::from_fn(2 * b, g, |r, c| if r < b { new[r][c] } else { new[r - b][g + c] });
        add_product(rest.as_mut(), negative.as_ref(), v.as_ref());
        (0..b).for_each(|r| data.extend_from_slice(out.col_as_slice(r)));
    };
    let rho = rows.len();
    let basis = Mat::from_fn(2 * rho, g, |r, c| if r < rho { rows[r][c] } else { rows[r - rho][g + c] });
    (Compressed { data, basis: Some(basis), columns }, dropped.max(0.0) + left)
}

/// A complex row, real parts before imaginary parts, made orthonormal to others by going through them twice; nothing if it is one
/// of their combinations to round-off.
fn orthonormalised(mut row: Vec<f64>, others: &[Vec<f64>]) -> Option<Vec<f64>> {
    let g = row.len() / 2;
    let norm = |row: &[f64]| row.iter().map(|x| x * x).sum::<f64>().sqrt();
    let before = norm(&row);
    for _ in 0..2 {
        for v in others {
            let ((xr, xi), (vr, vi)) = (row.split_at_mut(g), v.split_at(g));
            let (mut re, mut im) = (0.0, 0.0);
            for c in 0..g {
                re += xr[c] * vr[c] + xi[c] * vi[c];
                im += xi[c] * vr[c] - xr[c] * vi[c];
            }
            for c in 0..g {
                xr[c] -= re * vr[c] - im * vi[c];
                xi[c] -= re * vi[c] + im * vr[c];
            }
        }
    }
    let after = norm(&row);
    (after > 1e-12 * before && after > 0.0).then(|| {
        row.iter_mut().for_each(|x| *x /= after);
        row
    })
}
