//! From amplitudes and fields to modes, singular values and coefficients.
use crate::Mat;
use crate::shifted::Frame;

/// Singular values below this part of the largest are nothing.
const NOTHING: f64 = 1e-14;

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// X Aᵀ of fields X and orthonormal columns A: the columns of X are turned in pairs until they are orthogonal (one-sided Jacobi),
/// and those of A with them.
pub(super) fn frame(
    mut fields: Vec<Vec<f64>>,
    mut amplitudes: Vec<Vec<f64>>,
    n_rows: usize,
    n: usize,
) -> Frame {
    let r = fields.len();
    for _ in 0..60 {
        let mut turned = false;
        for p in 0..r {
            for q in p + 1..r {
                let (left, right) = fields.split_at_mut(q);
                let (x, y) = (&mut left[p], &mut right[0]);
                let (xx, yy, xy) = (dot(x, x), dot(y, y), dot(x, y));
                if xy.abs() <= 1e-15 * (xx * yy).sqrt() {
                    continue;
                }
                turned = true;
                let zeta = (yy - xx) / (2.0 * xy);
                let t = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
                let c = t.hypot(1.0).recip();
                let s = c * t;
                let turn = |x: &mut [f64], y: &mut [f64]| {
                    x.iter_mut().zip(y).for_each(|(x, y)| (*x, *y) = (c * *x - s * *y, s * *x + c * *y));
                };
                turn(x, y);
                let (left, right) = amplitudes.split_at_mut(q);
                turn(&mut left[p], &mut right[0]);
            }
        }
        if !turned {
            break;
        }
    }
    let mut order: Vec<_> = fields.iter().map(|x| dot(x, x).sqrt()).zip(0..r).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let largest = order.first().map_or(0.0, |o| o.0);
    order.retain(|o| o.0 > NOTHING * largest);
    Frame {
        modes: Mat::from_fn(n_rows, order.len(), |i, c| fields[order[c].1][i] / order[c].0),
        singular_values: order.iter().map(|o| o.0).collect(),
        coefficients: Mat::from_fn(order.len(), n, |c, j| amplitudes[order[c].1][j]),
    }
}
