//! Snapshots in blocks of rows, less their mean and times the roots of the weights: no copy of the whole is made.
use super::PodError;
use crate::snapshots::SnapshotSource;
use crate::{Mat, MatRef};
use monomorphic::{TriangularFactor, add_gram, add_product};

/// Rows of a block in memory: with 600 snapshots it is 5 MB.
const ROWS: usize = 1024;
/// Numbers of a block that is read: 64 MB.
const READ: usize = 1 << 23;

/// In memory, or to be read.
#[derive(Clone, Copy)]
pub(super) enum Data<'a> {
    Memory(MatRef<'a, f64>),
    Source(&'a dyn SnapshotSource),
}

impl Data<'_> {
    pub(super) fn rows(&self) -> usize {
        match self {
            Self::Memory(matrix) => matrix.nrows(),
            Self::Source(source) => source.n_rows(),
        }
    }
    pub(super) fn snapshots(&self) -> usize {
        match self {
            Self::Memory(matrix) => matrix.ncols(),
            Self::Source(source) => source.n_snapshots(),
        }
    }
    /// Calls `each` with the first row of every block and the block.
    fn each(
        &self,
        mut each: impl FnMut(usize, MatRef<'_, f64>) -> Result<(), PodError>,
    ) -> Result<(), PodError> {
        let (n, m) = (self.rows(), self.snapshots());
        match self {
            Self::Memory(matrix) => (0..n)
                .step_by(ROWS)
                .try_for_each(|first| each(first, matrix.subrows(first, ROWS.min(n - first)))),
            Self::Source(source) => {
                let rows = (READ / m).clamp(1, n);
                let mut block = Mat::zeros(rows, m);
                for first in (0..n).step_by(rows) {
                    let rows = rows.min(n - first);
                    source.read(first, 0, block.as_mut().subrows_mut(0, rows))?;
                    each(first, block.as_ref().subrows(0, rows))?;
                }
                Ok(())
            }
        }
    }
}

/// Y = W^½ (X − x̄).
pub(super) struct Blocks<'a> {
    pub(super) data: Data<'a>,
    pub(super) mean: Option<Vec<f64>>,
    pub(super) weights: Option<&'a [f64]>,
    /// Σ w x².
    pub(super) squares: f64,
    /// The largest |x|.
    pub(super) largest: f64,
    /// The lower triangle of YᵀY, if it was asked for.
    pub(super) gram: Option<Mat<f64>>,
}

impl<'a> Blocks<'a> {
    /// Goes through all snapshots once: are they finite, their mean if it is to be taken away, and the products of all pairs if they are needed.
    pub(super) fn new(
        data: Data<'a>,
        subtract_mean: bool,
        weights: Option<&'a [f64]>,
        gram: bool,
    ) -> Result<Self, PodError> {
        let (n, m) = (data.rows(), data.snapshots());
        let mut new = Self {
            data,
            mean: subtract_mean.then(|| vec![0.0; n]),
            weights,
            squares: 0.0,
            largest: 0.0,
            gram: gram.then(|| Mat::zeros(m, m)),
        };
        let mut copy = Mat::zeros(0, 0);
        data.each(|first, block| {
            let rows = block.nrows();
            let mut mean = vec![0.0; rows];
            for j in 0..m {
                for (i, x) in block.col(j).iter().enumerate() {
                    if !x.is_finite() {
                        return Err(PodError::NotFinite { snapshot: j, row: first + i, value: *x });
                    }
                    mean[i] += x;
                    new.squares += weights.map_or(1.0, |w| w[first + i]) * x * x;
                    new.largest = new.largest.max(x.abs());
                }
            }
            if let Some(all) = &mut new.mean {
                all[first..first + rows].iter_mut().zip(&mean).for_each(|(to, sum)| *to = sum / m as f64);
            }
            if let Some(mut gram) = new.gram.take() {
                add_gram(gram.as_mut(), new.changed(first, block, true, &mut copy));
                new.gram = Some(gram);
            }
            Ok(())
        })?;
        Ok(new)
    }

    /// Rows of X as rows of Y, without the weights if not `weighted`; `copy` is memory.
    fn changed<'b>(
        &self,
        first: usize,
        part: MatRef<'b, f64>,
        weighted: bool,
        copy: &'b mut Mat<f64>,
    ) -> MatRef<'b, f64> {
        if self.mean.is_none() && (self.weights.is_none() || !weighted) {
            return part;
        }
        if copy.shape() != part.shape() {
            *copy = Mat::zeros(part.nrows(), part.ncols());
        }
        for j in 0..part.ncols() {
            for (i, (to, from)) in copy.col_as_slice_mut(j).iter_mut().zip(part.col(j).iter()).enumerate() {
                let root = self.weights.filter(|_| weighted).map_or(1.0, |w| w[first + i].sqrt());
                *to = root * (from - self.mean.as_ref().map_or(0.0, |mean| mean[first + i]));
            }
        }
        copy.as_ref()
    }

    fn each(&self, weighted: bool, mut each: impl FnMut(usize, MatRef<'_, f64>)) -> Result<(), PodError> {
        let mut copy = Mat::zeros(0, 0);
        self.data.each(|first, block| {
            each(first, self.changed(first, block, weighted, &mut copy));
            Ok(())
        })
    }
    /// The whole of Y.
    pub(super) fn whole(&self) -> Result<Mat<f64>, PodError> {
        let mut whole = Mat::zeros(self.data.rows(), self.data.snapshots());
        self.each(true, |first, block| {
            whole.as_mut().subrows_mut(first, block.nrows()).copy_from(block);
        })?;
        Ok(whole)
    }
    /// R of Y = Q R.
    pub(super) fn triangular(&self) -> Result<TriangularFactor, PodError> {
        let mut factor = TriangularFactor::new(self.data.snapshots());
        self.each(true, |_, block| factor.add(block))?;
        Ok(factor)
    }
    /// Y B, or (X − x̄) B if it is not `weighted`.
    pub(super) fn times(&self, weighted: bool, b: MatRef<'_, f64>) -> Result<Mat<f64>, PodError> {
        let mut product = Mat::zeros(self.data.rows(), b.ncols());
        self.each(weighted, |first, block| {
            add_product(product.as_mut().subrows_mut(first, block.nrows()), block, b);
        })?;
        Ok(product)
    }
    /// Bᵀ Y.
    pub(super) fn transposed_times(&self, b: MatRef<'_, f64>) -> Result<Mat<f64>, PodError> {
        let mut product = Mat::zeros(b.ncols(), self.data.snapshots());
        self.each(true, |first, block| {
            add_product(product.as_mut(), b.subrows(first, block.nrows()).transpose(), block);
        })?;
        Ok(product)
    }
    /// Σ y².
    pub(super) fn energy(&self) -> Result<f64, PodError> {
        let mut energy = 0.0;
        self.each(true, |_, block| energy += block.squared_norm_l2())?;
        Ok(energy)
    }
    /// Refuses entries whose squares are too large or too small for double precision: those of singular values down to
    /// 1e-16 σ₁ must be normal numbers.
    pub(super) fn check_size(&self) -> Result<(), PodError> {
        PodError::check_size(self.squares, self.largest)
    }
    /// What a decomposition that does not converge is about.
    pub(super) fn not_converged(&self) -> PodError {
        let [rows, snapshots] = [self.data.rows(), self.data.snapshots()];
        PodError::NotConverged { rows, snapshots, largest: self.largest }
    }
}
