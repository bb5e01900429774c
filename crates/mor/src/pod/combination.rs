//! Sums of modes.
use monomorphic::MatRef;
use std::ops::{Add, Mul};

/// Rows that are put together at a time: a block stays in the cache while all modes are added to it, and the modes' own rows while all fields are.
const BLOCK: usize = 1024;

/// What modes are kept as.
pub(crate) trait Number: Copy + Default + Add<Output = Self> + Mul<Output = Self> + Into<f64> {
    /// The nearest one.
    fn nearest(x: f64) -> Self;
}
impl Number for f64 {
    fn nearest(x: f64) -> Self {
        x
    }
}
impl Number for f32 {
    fn nearest(x: f64) -> Self {
        x as f32
    }
}

/// x̄ + Φ c_j into the j-th field, for fields one after the other and coefficients as columns. A field is the same bit for bit whichever others there are.
///
/// All of it in the modes' own precision ε but for x̄: off by no more than (r + 2) ε Σ_k |c_k φ_k|.
pub(crate) fn combine<T: Number>(
    modes: &[&[T]],
    mean: Option<&[f64]>,
    coefficients: MatRef<'_, f64>,
    fields: &mut [f64],
) {
    let rank = coefficients.nrows();
    let rows = fields.len() / coefficients.ncols().max(1);
    let columns: Vec<T> =
        coefficients.col_iter().flat_map(|c| c.iter().map(|c| T::nearest(*c)).collect::<Vec<_>>()).collect();
    let mut sum = [T::default(); BLOCK];
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            for first in (0..rows).step_by(BLOCK) {
                let size = BLOCK.min(rows - first);
                let sum = &mut sum[..size];
                let mode = |k: usize| &modes[k][first..][..size];
                for (j, field) in fields.chunks_exact_mut(rows).enumerate() {
                    add_modes(&columns[j * rank..][..rank], &mode, sum);
                    let field = &mut field[first..][..size];
                    match mean {
                        None => field.iter_mut().zip(&*sum).for_each(|(f, s)| *f = (*s).into()),
                        Some(mean) => {
                            let mean = &mean[first..][..size];
                            let terms = mean.iter().zip(&*sum);
                            field.iter_mut().zip(terms).for_each(|(f, (m, s))| *f = m + (*s).into());
                        }
                    }
                }
            }
        },
    );
}

/// Four modes at a time: the sum is read and written a quarter as often.
#[inline(always)]
fn add_modes<'a, T: Number + 'a>(c: &[T], mode: &impl Fn(usize) -> &'a [T], sum: &mut [T]) {
    sum.fill(T::default());
    let n = sum.len();
    let (fours, rest) = c.as_chunks::<4>();
    for (four, [c0, c1, c2, c3]) in fours.iter().enumerate() {
        let [m0, m1, m2, m3] = [0, 1, 2, 3].map(|i| &mode(4 * four + i)[..n]);
        for i in 0..n {
            sum[i] = (((sum[i] + *c0 * m0[i]) + *c1 * m1[i]) + *c2 * m2[i]) + *c3 * m3[i];
        }
    }
    for (k, c) in rest.iter().enumerate() {
        let m = &mode(4 * fours.len() + k)[..n];
        for i in 0..n {
            sum[i] = sum[i] + *c * m[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use monomorphic::Mat;

    /// Any number of modes, rows and fields; alone and together to the bit; single precision to its bound.
    #[test]
    fn sums() {
        for (rank, rows) in [(0, 5), (1, 1), (3, 2050), (4, 1024), (11, 1500)] {
            let value = |i: usize| (0.37 * i as f64).sin();
            let modes: Vec<Vec<f64>> =
                (0..rank).map(|k| (0..rows).map(|i| value(k * rows + i)).collect()).collect();
            let short: Vec<Vec<f32>> = modes.iter().map(|m| m.iter().map(|m| *m as f32).collect()).collect();
            let columns: Vec<&[f64]> = modes.iter().map(|m| &m[..]).collect();
            let shorts: Vec<&[f32]> = short.iter().map(|m| &m[..]).collect();
            let mean: Vec<f64> = (0..rows).map(|i| value(7 * i)).collect();
            let c = Mat::from_fn(rank, 3, |k, j| value(5 * k + j + 1));
            let mut fields = vec![0.0; 3 * rows];
            combine(&columns, Some(&mean), c.as_ref(), &mut fields);
            for (j, field) in fields.chunks_exact(rows).enumerate() {
                let (mut alone, mut coarse) = (vec![0.0; rows], vec![0.0; rows]);
                combine(&columns, Some(&mean), c.get(.., j..j + 1), &mut alone);
                combine(&shorts, Some(&mean), c.get(.., j..j + 1), &mut coarse);
                assert_eq!(field, &alone);
                for i in 0..rows {
                    let terms = (0..rank).map(|k| c[(k, j)] * modes[k][i]);
                    let (exact, size) = terms.fold((mean[i], 0.0), |(s, a), t| (s + t, a + t.abs()));
                    assert!((field[i] - exact).abs() < 1e-14, "{rank} {rows} {i}");
                    let bound = (rank + 2) as f64 * 0.5 * f64::from(f32::EPSILON) * size + 1e-15;
                    assert!((coarse[i] - exact).abs() <= bound, "{rank} {rows} {i}");
                }
            }
        }
    }
}
