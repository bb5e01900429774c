//! The least-squares problems of a batch of wave vectors.
use super::amplitudes::Amplitudes;
use super::batch::{Batch, vectorised, view, view_mut, zero};
use super::cholesky::{factorise_hermitian, substitute_hermitian};
use monomorphic::{Mat, add_product};

/// D ≈ B Φ for one batch after the other, with given amplitudes.
///
/// (BᴴB)_rs = Σ_j a_r a_s p̄_k p_l needs the products of the phases of each pair of frames only, and the
/// products a_r a_s, which all wave vectors share: both sums over pairs of modes are matrix products.
pub(super) struct Normal<'a> {
    a: &'a Amplitudes,
    pairs: Vec<Pair>,
    /// BᴴB of each piece and then its factors.
    matrices: Vec<f64>,
    /// Φ.
    pub(super) phi: Vec<f64>,
    /// D − B Φ.
    pub(super) residual: Vec<f64>,
    phases: Vec<f64>,
    sums: Vec<f64>,
}

/// The modes of two frames.
struct Pair {
    frames: [usize; 2],
    modes: Vec<[usize; 2]>,
    /// A column for each two modes.
    products: Mat<f64>,
    /// Their sums over all snapshots.
    sums: Vec<f64>,
}

impl Pair {
    fn new(a: &Amplitudes, frames: [usize; 2], ranges: [[usize; 2]; 2]) -> Self {
        let modes: Vec<_> = modes_of(ranges).collect();
        let product = |j: usize, c: usize| a.values[(j, modes[c][0])] * a.values[(j, modes[c][1])];
        let products = Mat::from_fn(a.values.nrows(), modes.len(), product);
        let sums = (0..modes.len()).map(|c| products.col_as_slice(c).iter().sum()).collect();
        Self { frames, modes, products, sums }
    }
}

impl<'a> Normal<'a> {
    pub(super) fn new(a: &'a Amplitudes) -> Self {
        Self {
            a,
            pairs: pairs(a).map(|(frames, ranges)| Pair::new(a, frames, ranges)).collect(),
            matrices: Vec::new(),
            phi: Vec::new(),
            residual: Vec::new(),
            phases: Vec::new(),
            sums: Vec::new(),
        }
    }

    /// The best Φ for a batch, and what it leaves.
    pub(super) fn solve(&mut self, batch: &mut Batch) {
        self.residual.clone_from(&batch.data);
        self.phi.clear();
        if self.a.values.ncols() == 0 {
            return;
        }
        self.multiply(batch);
        batch.project(self.a, &self.residual, &mut self.phi);
        let rank = self.a.values.ncols();
        let size = 2 * rank * rank;
        vectorised(
            self.matrices.chunks_exact_mut(size),
            #[inline(always)]
            |m| factorise_hermitian(rank, m, batch.ridge),
        );
        substitute_all(rank, &self.matrices, &batch.pieces, &mut self.phi);
        batch.subtract(self.a, &self.phi, &mut self.residual);
    }

    /// The residual becomes what it changes by when A does by that of another one.
    pub(super) fn differentiate(&mut self, batch: &mut Batch, other: &Amplitudes) {
        self.residual.fill(0.0);
        batch.subtract(other, &self.phi, &mut self.residual);
        let mut change = Vec::new();
        batch.project(self.a, &self.residual, &mut change);
        substitute_all(self.a.values.ncols(), &self.matrices, &batch.pieces, &mut change);
        batch.subtract(self.a, &change, &mut self.residual);
    }

    /// BᴴB of each piece, below the diagonal. Phases of length one cancel within a frame.
    fn multiply(&mut self, batch: &Batch) {
        let (n, rank) = self.a.values.shape();
        let (count, size) = (batch.weights.len(), 2 * rank * rank);
        zero(&mut self.matrices, size * count);
        for pair in &self.pairs {
            let [k, l] = pair.frames;
            let n_products = pair.products.ncols();
            if k == l && batch.unit {
                for m in self.matrices.chunks_exact_mut(size) {
                    pair.modes.iter().zip(&pair.sums).for_each(|(&[r, s], &x)| m[r + s * rank] = x);
                }
                continue;
            }
            batch.pair(k, l, &mut self.phases);
            zero(&mut self.sums, 2 * count * n_products);
            let to = view_mut(&mut self.sums, n_products);
            add_product(to, pair.products.transpose(), view(&self.phases, n));
            let of_pieces = self.sums.chunks_exact(2 * n_products);
            for (m, sums) in self.matrices.chunks_exact_mut(size).zip(of_pieces) {
                let (re, im) = sums.split_at(n_products);
                for ((&[r, s], re), im) in pair.modes.iter().zip(re).zip(im) {
                    (m[r + s * rank], m[rank * rank + r + s * rank]) = (*re, *im);
                }
            }
        }
    }

    /// Adds Re Σ w p̄_k p_l φ̄_r φ_s of each snapshot to the columns of `to`, one for each of [`modes`].
    pub(super) fn add_gram(&mut self, batch: &Batch, to: &mut Mat<f64>) {
        let (n, rank) = self.a.values.shape();
        let count = batch.weights.len();
        let mut first = 0;
        for pair in &self.pairs {
            let [k, l] = pair.frames;
            let modes = &pair.modes;
            // φ̄_r φ_s of each piece: its real part and minus its imaginary part.
            zero(&mut self.sums, 2 * count * modes.len());
            for (phi, &p) in self.phi.chunks_exact(2 * rank).zip(&batch.pieces) {
                let (weight, (re, im)) = (batch.weights[p], phi.split_at(rank));
                for (sums, &[r, s]) in self.sums.chunks_exact_mut(2 * count).zip(modes) {
                    sums[2 * p] += weight * (re[r] * re[s] + im[r] * im[s]);
                    sums[2 * p + 1] += weight * (im[r] * re[s] - re[r] * im[s]);
                }
            }
            let mut to = to.as_mut().submatrix_mut(0, first, n, modes.len());
            first += modes.len();
            if k == l && batch.unit {
                for (c, sums) in self.sums.chunks_exact(2 * count).enumerate() {
                    let sum: f64 = sums.iter().step_by(2).sum();
                    (0..n).for_each(|j| to[(j, c)] += sum);
                }
            } else {
                batch.pair(k, l, &mut self.phases);
                add_product(to, view(&self.phases, n), view(&self.sums, 2 * count));
            }
        }
    }
}

/// Each two modes r of a frame and s of the same frame or one before, as [`Normal::add_gram`] counts them.
pub(super) fn modes(a: &Amplitudes) -> Vec<[usize; 2]> {
    pairs(a).flat_map(|(_, ranges)| modes_of(ranges)).collect()
}

/// Each frame with itself and those before, and their ranges of modes.
fn pairs(a: &Amplitudes) -> impl Iterator<Item = ([usize; 2], [[usize; 2]; 2])> {
    let ranges: Vec<_> = a.ranges().filter(|(_, [_, count])| *count > 0).collect();
    (0..ranges.len()).flat_map(move |i| {
        let ((k, first), before) = (ranges[i], ranges[..=i].to_vec());
        before.into_iter().map(move |(l, second)| ([k, l], [first, second]))
    })
}

fn modes_of([[first, count], [other, others]]: [[usize; 2]; 2]) -> impl Iterator<Item = [usize; 2]> {
    (other..other + others).flat_map(move |s| (first..first + count).map(move |r| [r, s]))
}

fn substitute_all(rank: usize, factors: &[f64], pieces: &[usize], x: &mut [f64]) {
    let size = 2 * rank * rank;
    vectorised(
        x.chunks_exact_mut(2 * rank).zip(pieces),
        #[inline(always)]
        |(x, &p)| {
            substitute_hermitian(&factors[p * size..][..size], x);
        },
    );
}
