//! Snapshots in blocks of rows, less their mean and times the roots of the weights: no copy of the whole is made.
use crate::{Mat, MatRef};
use monomorphic::{add_gram, add_product};

/// Rows of a block: with 600 snapshots it is 5 MB.
const ROWS: usize = 1024;

/// Y = W^½ (X − x̄).
pub(super) struct Blocks<'a> {
    pub(super) snapshots: MatRef<'a, f64>,
    pub(super) mean: Option<&'a [f64]>,
    pub(super) weights: Option<&'a [f64]>,
}

impl Blocks<'_> {
    /// Calls `each` with the first row of every block and the block, times the roots of the weights if `weighted`.
    fn each(&self, weighted: bool, mut each: impl FnMut(usize, MatRef<'_, f64>)) {
        let (n, m) = (self.snapshots.nrows(), self.snapshots.ncols());
        let mut copy = Mat::zeros(ROWS.min(n), m);
        for first in (0..n).step_by(ROWS) {
            let rows = ROWS.min(n - first);
            let part = self.snapshots.subrows(first, rows);
            if self.mean.is_none() && (self.weights.is_none() || !weighted) {
                each(first, part);
                continue;
            }
            for j in 0..m {
                for (i, (to, from)) in copy.col_as_slice_mut(j).iter_mut().zip(part.col(j).iter()).enumerate()
                {
                    let root = self.weights.filter(|_| weighted).map_or(1.0, |w| w[first + i].sqrt());
                    *to = root * (from - self.mean.map_or(0.0, |mean| mean[first + i]));
                }
            }
            each(first, copy.as_ref().subrows(0, rows));
        }
    }
    /// The whole of Y.
    pub(super) fn whole(&self) -> Mat<f64> {
        let mut whole = Mat::zeros(self.snapshots.nrows(), self.snapshots.ncols());
        self.each(true, |first, block| {
            whole.as_mut().subrows_mut(first, block.nrows()).copy_from(block);
        });
        whole
    }
    /// The lower triangle of YᵀY.
    pub(super) fn gram(&self) -> Mat<f64> {
        let m = self.snapshots.ncols();
        let mut gram = Mat::zeros(m, m);
        self.each(true, |_, block| add_gram(gram.as_mut(), block));
        gram
    }
    /// Y B, or (X − x̄) B if it is not `weighted`.
    pub(super) fn times(&self, weighted: bool, b: MatRef<'_, f64>) -> Mat<f64> {
        let mut product = Mat::zeros(self.snapshots.nrows(), b.ncols());
        self.each(weighted, |first, block| {
            add_product(product.as_mut().subrows_mut(first, block.nrows()), block, b);
        });
        product
    }
    /// Bᵀ Y.
    pub(super) fn transposed_times(&self, b: MatRef<'_, f64>) -> Mat<f64> {
        let mut product = Mat::zeros(b.ncols(), self.snapshots.ncols());
        self.each(true, |first, block| {
            add_product(product.as_mut(), b.subrows(first, block.nrows()).transpose(), block);
        });
        product
    }
    /// Σ y².
    pub(super) fn energy(&self) -> f64 {
        let mut energy = 0.0;
        self.each(true, |_, block| energy += block.squared_norm_l2());
        energy
    }
}
