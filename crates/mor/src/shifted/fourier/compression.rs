//! Few columns instead of many.
use crate::Mat;
use monomorphic::{MatMut, add_product};

/// Directions that are found at a time.
const BLOCK: usize = 4;
/// Fewer columns are left as they are.
const FEW: usize = 4;
/// More than this part of all rows is not worth it.
const WORTH: f64 = 0.25;

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
/// residuals become V, one after the other; if that would take too many of them the columns stay as they are.
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
    let mut before = f64::INFINITY;
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
        // At this rate so many blocks are still to come.
        let blocks = (left / (0.5 * allowed)).ln() / (before / left).ln().max(f64::MIN_POSITIVE);
        if rows.len() >= 2 * BLOCK && rows.len() as f64 + blocks * BLOCK as f64 > WORTH * most as f64 {
            add_product(rest, turned(n, 1.0, &data).as_ref(), stacked(&rows, g).as_ref());
            return (Compressed { data: full, basis: None, columns }, dropped.max(0.0));
        }
        before = left;
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
        let (mut out, mut other) = (Mat::zeros(2 * n, b), Mat::zeros(2 * n, b));
        add_product(out.as_mut(), rest.as_ref(), real.as_ref());
        add_product(other.as_mut(), rest.as_ref(), imaginary.as_ref());
        let mut of_block = Vec::with_capacity(2 * n * b);
        for r in 0..b {
            let (o_r, o_i) = out.col_as_slice(r).split_at(n);
            let (t_r, t_i) = other.col_as_slice(r).split_at(n);
            of_block.extend(o_r.iter().zip(t_i).map(|(o, t)| o + t));
            of_block.extend(o_i.iter().zip(t_r).map(|(o, t)| o - t));
        }
        add_product(rest.as_mut(), turned(n, -1.0, &of_block).as_ref(), stacked(new, g).as_ref());
        data.extend(of_block);
    };
    let basis = stacked(&rows, g);
    (Compressed { data, basis: Some(basis), columns }, dropped.max(0.0) + left)
}

/// `sign` X, then `sign` i X, of complex columns X.
fn turned(n: usize, sign: f64, x: &[f64]) -> Mat<f64> {
    let b = x.len() / (2 * n);
    Mat::from_fn(2 * n, 2 * b, |i, r| match (r < b, i < n) {
        (true, _) => sign * x[i + 2 * n * r],
        (false, true) => -sign * x[n + i + 2 * n * (r - b)],
        (false, false) => sign * x[i - n + 2 * n * (r - b)],
    })
}

/// The real parts of rows above their imaginary parts.
fn stacked(rows: &[Vec<f64>], g: usize) -> Mat<f64> {
    let b = rows.len();
    Mat::from_fn(2 * b, g, |r, c| if r < b { rows[r][c] } else { rows[r - b][g + c] })
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
