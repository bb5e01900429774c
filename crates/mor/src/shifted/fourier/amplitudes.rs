//! The unknowns.
use crate::Mat;
pub(super) use crate::shifted::dense::add;

/// Amplitudes a_i^k(t_j): a row per snapshot, a column per mode, those of one frame after those of another.
#[derive(Clone)]
pub(super) struct Amplitudes {
    pub(super) ranks: Vec<usize>,
    pub(super) values: Mat<f64>,
}

impl Amplitudes {
    /// Each frame with its first column and how many it has.
    pub(super) fn ranges(&self) -> impl Iterator<Item = (usize, [usize; 2])> {
        let mut first = 0;
        self.ranks.iter().enumerate().map(move |(k, &rank)| {
            first += rank;
            (k, [first - rank, rank])
        })
    }

    /// The frame of each column.
    pub(super) fn frames(&self) -> Vec<usize> {
        self.ranks.iter().enumerate().flat_map(|(k, &r)| vec![k; r]).collect()
    }

    /// Makes the columns of each frame orthonormal: A = A' R. The R of each frame are returned, column by column. A column that
    /// depends on those before it or is not finite becomes zero.
    pub(super) fn orthonormalise(&mut self) -> Vec<Mat<f64>> {
        let mut first = 0;
        let mut triangles = Vec::new();
        for &rank in &self.ranks {
            let mut triangle: Mat<f64> = Mat::zeros(rank, rank);
            for c in 0..rank {
                let mut x = self.values.col_as_slice(first + c).to_vec();
                let norm = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
                let before = norm(&x);
                for _ in 0..2 {
                    for b in 0..c {
                        let q = self.values.col_as_slice(first + b);
                        let part: f64 = q.iter().zip(&x).map(|(q, x)| q * x).sum();
                        triangle[(b, c)] += part;
                        x.iter_mut().zip(q).for_each(|(x, q)| *x -= part * q);
                    }
                }
                let after = norm(&x);
                let factor = if after > 1e-13 * before && after > 0.0 { after.recip() } else { 0.0 };
                triangle[(c, c)] = if factor > 0.0 { after } else { 0.0 };
                let to = self.values.col_as_slice_mut(first + c);
                to.iter_mut().zip(&x).for_each(|(to, x)| *to = if factor > 0.0 { x * factor } else { 0.0 });
            }
            first += rank;
            triangles.push(triangle);
        }
        triangles
    }

    /// Without the columns that are zero.
    pub(super) fn drop_zeros(&mut self) {
        let zero = |c: &usize| self.values.col_as_slice(*c).iter().all(|&x| x == 0.0);
        let (kept, frames) =
            ((0..self.values.ncols()).filter(|c| !zero(c)).collect::<Vec<_>>(), self.frames());
        let rank = |k: usize| kept.iter().filter(|&&c| frames[c] == k).count();
        self.ranks = (0..self.ranks.len()).map(rank).collect();
        self.values = Mat::from_fn(self.values.nrows(), kept.len(), |j, c| self.values[(j, kept[c])]);
    }

    /// S R⁻¹ and Y Rᵀ, frame by frame.
    pub(super) fn carry(&self, triangles: &[Mat<f64>], s: &mut Mat<f64>, y: &mut Mat<f64>) {
        let n = s.nrows();
        let mut first = 0;
        for r in triangles {
            let rank = r.nrows();
            for c in 0..rank {
                let inverse = if r[(c, c)] > 0.0 { r[(c, c)].recip() } else { 0.0 };
                for j in 0..n {
                    let sum: f64 = (0..c).map(|b| s[(j, first + b)] * r[(b, c)]).sum();
                    s[(j, first + c)] = (s[(j, first + c)] - sum) * inverse;
                    // Row c of R has nothing before column c.
                    y[(j, first + c)] = (c..rank).map(|b| y[(j, first + b)] * r[(c, b)]).sum();
                }
            }
            first += rank;
        }
    }
}
