//! The recurrence along x that sweeps and factor solves have in common.

/// Cells whose terms are prepared ahead of the recurrence.
pub(super) const BLOCK: usize = 128;

/// Terms of a run of cells: x_i = t_i − w_i x_{i∓1}.
pub(super) struct Terms {
    pub(super) t: [f64; BLOCK],
    pub(super) w: [f64; BLOCK],
}

impl Terms {
    pub(super) fn new() -> Self {
        Self { t: [0.0; BLOCK], w: [0.0; BLOCK] }
    }

    /// x_i = t_i − w_i x_{i−1} with the x before the first one given; gives the last one.
    #[inline(always)]
    pub(super) fn ascend(&self, mut last: f64, x: &mut [f64]) -> f64 {
        for ((x, t), w) in x.iter_mut().zip(&self.t).zip(&self.w) {
            last = t - w * last;
            *x = last;
        }
        last
    }

    /// x_i = t_i − w_i x_{i+1} with the x behind the last one given; gives the first one.
    #[inline(always)]
    pub(super) fn descend(&self, mut last: f64, x: &mut [f64]) -> f64 {
        let n = x.len();
        for ((x, t), w) in x.iter_mut().zip(&self.t[..n]).zip(&self.w[..n]).rev() {
            last = t - w * last;
            *x = last;
        }
        last
    }
}
