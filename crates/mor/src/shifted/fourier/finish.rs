//! From amplitudes and fields to modes, singular values and coefficients.
use super::amplitudes::Amplitudes;
use crate::Mat;
use crate::shifted::Frame;
use monomorphic::add_product;

/// Singular values below this part of the largest are nothing.
const NOTHING: f64 = 1e-13;
/// Sweeps of rotations, at most; ten are many.
const SWEEPS: usize = 60;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The singular value decomposition of `scale` X Aᵀ, with fields X and orthonormal amplitudes A as columns.
pub(super) fn frame(fields: Mat<f64>, amplitudes: &Mat<f64>, scale: f64) -> Frame {
    // X = Q R; the columns of R are turned in pairs until they are orthogonal (one-sided Jacobi), and those of A with them.
    let r = fields.ncols();
    let mut fields = Amplitudes { ranks: vec![r], values: fields };
    let triangle = fields.orthonormalise().swap_remove(0);
    let columns = |m: &Mat<f64>| (0..r).map(|c| m.col_as_slice(c).to_vec()).collect::<Vec<_>>();
    let (mut left, mut right) = (columns(&triangle), columns(amplitudes));
    for _ in 0..SWEEPS {
        let pairs = (0..r).flat_map(|p| (p + 1..r).map(move |q| (p, q)));
        let turned = pairs.filter(|&(p, q)| orthogonalise(&mut left, &mut right, p, q)).count();
        if turned == 0 {
            break;
        }
    }
    let mut order: Vec<_> = left.iter().map(|x| dot(x, x).sqrt()).zip(0..r).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let largest = order.first().map_or(0.0, |o| o.0);
    order.retain(|o| o.0 > NOTHING * largest);
    let kept = order.len();
    let turns = Mat::from_fn(r, kept, |i, c| left[order[c].1][i] / order[c].0);
    let mut modes = Mat::zeros(fields.values.nrows(), kept);
    add_product(modes.as_mut(), fields.values.as_ref(), turns.as_ref());
    Frame {
        modes,
        singular_values: order.iter().map(|o| scale * o.0).collect(),
        coefficients: Mat::from_fn(kept, amplitudes.nrows(), |c, j| right[order[c].1][j]),
    }
}

/// Turns two columns until they are orthogonal; false if they are.
fn orthogonalise(left: &mut [Vec<f64>], right: &mut [Vec<f64>], p: usize, q: usize) -> bool {
    let (xx, yy, xy) = (dot(&left[p], &left[p]), dot(&left[q], &left[q]), dot(&left[p], &left[q]));
    if xy.abs() <= 1e-15 * (xx * yy).sqrt() {
        return false;
    }
    let zeta = (yy - xx) / (2.0 * xy);
    let t = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let c = t.hypot(1.0).recip();
    let s = c * t;
    for columns in [left, right] {
        let (before, after) = columns.split_at_mut(q);
        for (x, y) in before[p].iter_mut().zip(&mut after[0]) {
            (*x, *y) = (c * *x - s * *y, s * *x + c * *y);
        }
    }
    true
}
