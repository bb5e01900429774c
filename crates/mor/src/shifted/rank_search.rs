//! How many modes each frame needs.
use super::dense::{orthonormalise, product, thin};
use super::residual::{Observer, Problem};
use super::{Frame, FrameOperators, ShiftedError, StopReason};
use monomorphic::{Mat, MatRef};

/// Adds modes where the residual has them and takes those away that are not needed.
///
/// What is left of the snapshots is brought into every frame; its leading mode joins the frame where it is largest, and all frames are
/// fitted anew. A mode must stand out of what noise of the residual's own level has: the largest singular value
/// of M × N numbers of deviation s is s (√M + √N). s is told from the median of the entries, which a few large ones do not move.
/// In the end each frame must do without its last mode, if the error stays below the tolerance or grows by noise only.
pub(super) struct RankSearch<'a> {
    pub(super) operators: &'a dyn FrameOperators,
    pub(super) snapshots: MatRef<'a, f64>,
    pub(super) ignored: &'a [(usize, usize)],
    /// The relative error that is good enough.
    pub(super) tolerance: f64,
    /// No frame gets more modes than this.
    pub(super) ranks: &'a [usize],
    /// As many as that are wanted, whether they stand out of the noise or not, and needed.
    pub(super) all: bool,
    /// Fits frames of these ranks to a relative error, beginning with them.
    pub(super) fit: Fit<'a>,
}

/// Frames and why there are no better ones.
pub(super) type Found = Result<(Vec<Frame>, StopReason), ShiftedError>;
/// What fits frames.
pub(super) type Fit<'a> = &'a dyn Fn(&[Frame], f64, Observer<'_>) -> Found;

/// So much more than the largest singular value of noise.
const CLEARLY: f64 = 1.05;
impl RankSearch<'_> {
    /// From these frames, which may be nothing.
    pub(super) fn search(&self, start: Vec<Frame>, observer: Observer<'_>) -> Found {
        let mut frames = start;
        if frames.iter().any(|f| f.rank() > 0) {
            match (self.fit)(&frames, self.tolerance, observer)? {
                (_, StopReason::Asked) => return Ok((frames, StopReason::Asked)),
                (fitted, _) => frames = fitted,
            }
        }
        let problem = self.problem()?;
        let mut stopped = StopReason::Stagnation;
        let (mut error, mut edge);
        loop {
            let residual = problem.residual(&frames);
            error = problem.relative(residual.norm_l2());
            edge = noise_edge(&residual);
            if error <= self.tolerance {
                stopped = StopReason::Tolerance;
                break;
            }
            let Some(grown) = self.grown(&frames, &residual, edge) else { break };
            match (self.fit)(&grown, self.tolerance, observer)? {
                (_, StopReason::Asked) => return Ok((frames, StopReason::Asked)),
                (fitted, _) => frames = fitted,
            }
        }
        if self.all {
            return Ok((frames, stopped));
        }
        // A mode less.
        let noise = problem.relative(CLEARLY * edge);
        'again: loop {
            let mut order: Vec<usize> = (0..frames.len()).filter(|&k| frames[k].rank() > 0).collect();
            let last = |k: usize| frames[k].singular_values[frames[k].rank() - 1];
            order.sort_by(|&a, &b| last(a).total_cmp(&last(b)));
            for k in order {
                let bound = self.tolerance.max(error.hypot(noise));
                let mut fewer = frames.clone();
                fewer[k] = fewer[k].cut(fewer[k].rank() - 1);
                let (fitted, reason) = (self.fit)(&fewer, bound, observer)?;
                if reason == StopReason::Asked {
                    return Ok((frames, reason));
                }
                let left = problem.relative(problem.residual(&fitted).norm_l2());
                if left <= bound {
                    (frames, error) = (fitted, left);
                    continue 'again;
                }
            }
            return Ok((frames, stopped));
        }
    }

    fn problem(&self) -> Result<Problem<'_>, ShiftedError> {
        Problem::new(self.operators, self.snapshots)?.ignoring(self.ignored)
    }

    /// The frames with the largest mode of the residual, or None if it does not stand out.
    fn grown(&self, frames: &[Frame], residual: &Mat<f64>, noise: f64) -> Option<Vec<Frame>> {
        let leading = |k: usize| {
            let mut field = residual.clone();
            self.operators.to_lab_transposed(k, field.as_mut());
            Frame::leading(field.as_ref(), 1)
        };
        let open = (0..frames.len()).filter(|&k| frames[k].rank() < self.ranks[k]);
        let modes = open.map(|k| (k, leading(k))).filter(|(_, mode)| mode.rank() > 0);
        let (k, mode) =
            modes.max_by(|(_, a), (_, b)| a.singular_values[0].total_cmp(&b.singular_values[0]))?;
        // If it is much of all there is, the rest tells the noise.
        let (m, n) = residual.shape();
        let rest = (residual.squared_norm_l2() - mode.singular_values[0].powi(2)).max(0.0).sqrt();
        let bound = noise.min(edge(rest, [m, n]));
        (self.all || mode.singular_values[0] > CLEARLY * bound).then(|| {
            let mut grown = frames.to_vec();
            grown[k] = grown[k].plus(&mode);
            grown
        })
    }
}

/// Deviation of normal noise over the median of its absolute values.
pub(super) const NORMAL: f64 = 1.4826;

/// Largest singular value of M × N independent numbers with a norm.
pub(super) fn edge(norm: f64, [m, n]: [usize; 2]) -> f64 {
    norm * ((m as f64).sqrt().recip() + (n as f64).sqrt().recip())
}

/// 1.4826 median |x|: the deviation of normal noise.
pub(super) fn deviation(mut sizes: Vec<f64>) -> f64 {
    let middle = sizes.len() / 2;
    if sizes.is_empty() { 0.0 } else { NORMAL * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// What the largest singular value of noise like that is. Entries that are zero do not count: they are not known.
fn noise_edge(residual: &Mat<f64>) -> f64 {
    let (m, n) = residual.shape();
    let sizes =
        residual.col_iter().flat_map(|c| c.iter().map(|x| x.abs()).filter(|&x| x > 0.0).collect::<Vec<_>>());
    deviation(sizes.collect()) * ((m as f64).sqrt() + (n as f64).sqrt())
}

impl Frame {
    /// Its leading modes.
    pub(super) fn cut(&self, rank: usize) -> Self {
        Self {
            modes: self.modes.subcols(0, rank).to_owned(),
            singular_values: self.singular_values[..rank].to_vec(),
            coefficients: self.coefficients.subrows(0, rank).to_owned(),
        }
    }

    /// The sum of two fields, with all their modes.
    pub(super) fn plus(&self, other: &Self) -> Self {
        if other.rank() == 0 {
            return self.clone();
        }
        let (a, b) = (self.rank(), self.rank() + other.rank());
        let beside = |x: &Mat<f64>, y: &Mat<f64>| {
            Mat::from_fn(x.nrows(), b, |i, j| if j < a { x[(i, j)] } else { y[(i, j - a)] })
        };
        let mut u = beside(&self.modes, &other.modes);
        let mut v =
            beside(&self.coefficients.transpose().to_owned(), &other.coefficients.transpose().to_owned());
        let (r_u, r_v) = (orthonormalise(&mut u), orthonormalise(&mut v));
        let sigma = |i: usize| if i < a { self.singular_values[i] } else { other.singular_values[i - a] };
        let scaled = Mat::from_fn(b, b, |i, j| r_u[(i, j)] * sigma(j));
        let (left, singular_values, right) = thin(product(scaled.as_ref(), r_v.transpose()), b);
        Self {
            modes: product(u.as_ref(), left.as_ref()),
            singular_values,
            coefficients: product(v.as_ref(), right.as_ref()).transpose().to_owned(),
        }
    }
}
