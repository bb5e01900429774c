//! Some of many snapshots.
use super::dense::thin;
use super::{Frame, Motion, Shifts};
use monomorphic::{Mat, MatRef};

/// More snapshots than this are thinned out to find the ranks.
pub(super) const MANY: usize = 150;
/// To so many.
pub(super) const SOME: usize = 75;

/// So many of the snapshots, two at least, the first and the last among them.
pub(super) fn thinned(snapshots: MatRef<'_, f64>, count: usize) -> (Vec<usize>, Mat<f64>) {
    let some: Vec<usize> = (0..count).map(|i| i * (snapshots.ncols() - 1) / (count - 1)).collect();
    let few = Mat::from_fn(snapshots.nrows(), count, |i, j| snapshots[(i, some[j])]);
    (some, few)
}

/// Some of the snapshots.
pub(super) struct Thinned<'a> {
    pub(super) shifts: &'a dyn Shifts,
    pub(super) snapshots: &'a [usize],
}

impl Shifts for Thinned<'_> {
    fn n_frames(&self) -> usize {
        self.shifts.n_frames()
    }
    fn n_snapshots(&self) -> usize {
        self.snapshots.len()
    }
    fn motion(&self, frame: usize, snapshot: usize) -> Motion {
        self.shifts.motion(frame, self.snapshots[snapshot])
    }
}

impl Frame {
    /// At some of the snapshots.
    pub(super) fn at(&self, some: &[usize]) -> Self {
        let coefficients = Mat::from_fn(self.rank(), some.len(), |i, j| self.coefficients[(i, some[j])]);
        Self { coefficients, ..self.clone() }
    }

    /// From some of `n` snapshots to all of them, σ a linear in between.
    pub(super) fn between(&self, some: &[usize], n: usize) -> Self {
        let scaled = self.scaled_coefficients();
        let coefficient = |j: usize, i: usize| {
            let after = some.partition_point(|&at| at < j).clamp(1, some.len() - 1);
            let [a, b] = [some[after - 1], some[after]];
            let part = (j - a) as f64 / (b - a) as f64;
            (1.0 - part) * scaled[(i, after - 1)] + part * scaled[(i, after)]
        };
        let (v, singular_values, u) = thin(Mat::from_fn(n, self.rank(), coefficient), self.rank());
        Self { modes: &self.modes * u, singular_values, coefficients: v.transpose().to_owned() }
    }
}
