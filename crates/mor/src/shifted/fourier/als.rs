//! Alternating least squares, accelerated.
use super::amplitudes::Amplitudes;
use super::descent::Descent;
use super::finish::frame;
use super::newton::Newton;
use super::objective::{Evaluation, dominant};
use super::problem::Problem;
use super::spectrum::Spectrum;
use crate::shifted::{Decomposition, Frame, Grid, Progress, ShiftedError, Shifts, StopReason};
use crate::{Mat, MatRef};

/// Weight of the fields of frames that changes them by no more than rounding errors.
pub(in crate::shifted) const RIDGE: f64 = 1e-13;

/// With as many modes as asked for: by [`Als::stagnation`].
pub(in crate::shifted) const LONG: Patience = (10, 0.0);
/// With fewer.
const SHORT: Patience = (3, 0.1);
/// On all data after a sample; less than the sample's patience asks for per step is not polished.
const POLISH: Patience = (1, 3e-4);
/// Of Newton's steps.
const FLAT: Patience = (10, 1e-3);

/// The best approximation Q ≈ Σ_k T^k Φ_k A_k with given ranks, for translations on periodic axes.
///
/// min over A of Σ_κ min over Φ(κ) of ‖Q(κ, t_j) − Σ_(k,i) e^(−iκ·s_k(t_j)) a_i^k(t_j) φ_i^k(κ)‖²
///
/// With given amplitudes a each wave vector κ has its own small least-squares problem for the modes φ, so that the modes are
/// eliminated (variable projection, Golub & Pereyra 1973). With given modes each snapshot has one for the amplitudes: that step
/// preconditions a limited-memory BFGS method over the amplitudes. Shifts are [`Spectral`](crate::shifted::Interpolation::Spectral).
#[derive(Clone, Debug, PartialEq)]
pub struct Als {
    /// Modes of each frame; 0 if it carries nothing.
    pub ranks: Vec<usize>,
    /// Relative error that is good enough.
    pub tolerance: f64,
    /// Most steps; each costs one pass or a few over the data.
    pub max_steps: usize,
    /// Weight w of Σ_k ‖Φ_k A_k‖² against the squared error (Tikhonov): of frames that a snapshot does not
    /// tell apart, the smallest modes are taken. Positive.
    pub ridge: f64,
    /// It stops when the last ten steps lowered the error by less than this part of it.
    pub stagnation: f64,
}

impl Als {
    /// With these ranks, until the error is 1e-9 or ten steps lower it by less than 1e-4 of it, but at most 500 steps.
    #[must_use]
    pub fn new(ranks: impl Into<Vec<usize>>) -> Self {
        Self { ranks: ranks.into(), tolerance: 1e-9, max_steps: 500, ridge: RIDGE, stagnation: 1e-4 }
    }

    /// Decomposes Q − E. It begins with the coefficients of `start`, and with the residual's largest ones in each frame where that
    /// has fewer modes; `progress` hears of each step and answers whether to go on. If there are many wave vectors the first steps
    /// are on a sample of them, and their errors are estimates (to a few per cent); the last ones are on all.
    ///
    /// Rows of the snapshots: a whole number of fields of the grid. A frame gets fewer modes than asked for if the others are zero to
    /// round-off.
    ///
    /// # Errors
    /// If shapes do not fit together, a value is not finite, or a frame does anything but move along periodic axes.
    pub fn solve(
        &self,
        grid: &Grid,
        shifts: &dyn Shifts,
        snapshots: MatRef<'_, f64>,
        start: Option<&Decomposition>,
        noise: Option<MatRef<'_, f64>>,
        progress: &mut dyn FnMut(&Progress) -> bool,
    ) -> Result<Decomposition, ShiftedError> {
        let frames = shifts.n_frames();
        if self.ranks.len() != frames {
            return Err(ShiftedError::Ranks { ranks: self.ranks.len(), frames });
        }
        ShiftedError::check_tolerance("tolerance", self.tolerance)?;
        if !(self.ridge > 0.0 && self.ridge.is_finite()) {
            let (name, value, limit) = ("the weight of the fields", self.ridge, f64::INFINITY);
            return Err(ShiftedError::Parameter { name, value, limit });
        }
        let spectrum = Spectrum::new(grid, shifts, snapshots, noise, self.cut())?;
        let d = self.fit(&spectrum, start, LONG, progress)?;
        Ok(Decomposition { noise: noise.map(|e| e.to_owned()), ..d })
    }

    /// What part of the snapshots need not be looked at.
    pub(in crate::shifted) fn cut(&self) -> f64 {
        0.1 * self.tolerance.max(1e-13)
    }

    /// Decomposes what is in Fourier space already.
    pub(in crate::shifted) fn fit(
        &self,
        spectrum: &Spectrum,
        start: Option<&Decomposition>,
        patience: Patience,
        progress: &mut dyn FnMut(&Progress) -> bool,
    ) -> Result<Decomposition, ShiftedError> {
        let n = spectrum.n_snapshots();
        let ranks: Vec<_> = self.ranks.iter().map(|&r| r.min(n).min(spectrum.n_rows())).collect();
        let mut amplitudes = begin(start, &ranks, n)?;
        let mut run = Run { als: self, spectrum, history: Vec::new(), progress };
        if spectrum.energy == 0.0 {
            let nothing = || frame(Mat::zeros(spectrum.n_rows(), 0), &Mat::zeros(n, 0), 1.0);
            let frames = ranks.iter().map(|_| nothing()).collect();
            run.note(0.0, 0);
            return Ok(Decomposition::of(frames, run.history, StopReason::Tolerance));
        }
        let all = Problem::all(spectrum, self.ridge);
        let sample = Problem::sample(spectrum, ranks.iter().sum(), self.ridge);
        let mut problem = sample.as_ref().unwrap_or(&all);
        let mut sampled = sample.is_some();
        let (descent, stopped) = loop {
            amplitudes = grow(problem, amplitudes, &ranks);
            let last = amplitudes.ranks == ranks;
            let mut descent = Descent::new(problem, amplitudes);
            let mut step = Descent::step;
            let mut reason = run.descend(&mut descent, if last { patience } else { SHORT }, &mut step);
            if sampled && (last || reason == StopReason::Tolerance) && reason != StopReason::Asked {
                (problem, sampled) = (&all, false);
                descent = descent.with(problem);
                let part = POLISH.1.max(patience.1 / patience.0 as f64);
                reason = run.descend(&mut descent, (POLISH.0, part), &mut step);
            }
            if reason != StopReason::Stagnation || last {
                break (descent, reason);
            }
            amplitudes = descent.amplitudes;
        };
        let Descent { amplitudes, mut evaluation, .. } = descent;
        if sampled {
            evaluation = Evaluation::new(&all, &amplitudes);
        }
        let frames = frames_of(spectrum, &amplitudes, &evaluation);
        Ok(Decomposition::of(frames, run.history, stopped))
    }

    /// Goes on by Newton's steps, on a sample first as [`Als::fit`] does.
    pub(super) fn refine(
        &self,
        spectrum: &Spectrum,
        start: &Decomposition,
        newton: &mut Newton,
        progress: &mut dyn FnMut(&Progress) -> bool,
    ) -> Result<Decomposition, ShiftedError> {
        let all = Problem::all(spectrum, self.ridge);
        let sample = Problem::sample(spectrum, start.ranks().iter().sum(), self.ridge);
        let amplitudes = begin(Some(start), &start.ranks(), spectrum.n_snapshots())?;
        let mut descent = Descent::new(sample.as_ref().unwrap_or(&all), amplitudes);
        let mut run = Run { als: self, spectrum, history: Vec::new(), progress };
        let mut stopped = run.descend(&mut descent, FLAT, &mut |descent| newton.step(descent));
        if sample.is_some() && stopped != StopReason::Asked {
            descent = descent.with(&all);
            stopped = run.descend(&mut descent, POLISH, &mut Descent::step);
        }
        if stopped == StopReason::Stagnation && newton.products == 0 {
            stopped = StopReason::Steps;
        }
        let evaluation = match (&sample, stopped) {
            (Some(_), StopReason::Asked) => Evaluation::new(&all, &descent.amplitudes),
            _ => descent.evaluation,
        };
        let frames = frames_of(spectrum, &descent.amplitudes, &evaluation);
        Ok(Decomposition::of(frames, run.history, stopped))
    }
}

/// An iteration with its history.
struct Run<'a> {
    als: &'a Als,
    spectrum: &'a Spectrum,
    history: Vec<Progress>,
    progress: &'a mut dyn FnMut(&Progress) -> bool,
}

/// When to stop: steps, and the part by which they must lower the error.
pub(in crate::shifted) type Patience = (usize, f64);

impl Run<'_> {
    /// Another step; false if it shall be the last.
    fn note(&mut self, error: f64, rank: usize) -> bool {
        let now = Progress { step: self.history.len(), error, rank };
        self.history.push(now);
        (self.progress)(&now)
    }

    /// Goes down until it is good enough or does not get better.
    fn descend<'p>(
        &mut self,
        descent: &mut Descent<'p>,
        (window, part): Patience,
        step: &mut dyn FnMut(&mut Descent<'p>) -> bool,
    ) -> StopReason {
        let rank = descent.amplitudes.ranks.iter().sum();
        let part = if part > 0.0 { part } else { self.als.stagnation };
        let mut errors = Vec::new();
        loop {
            let left = descent.evaluation.residual + self.spectrum.dropped;
            let error = (left / self.spectrum.energy).sqrt();
            errors.push(error);
            if !self.note(error, rank) {
                return StopReason::Asked;
            } else if error <= self.als.tolerance {
                return StopReason::Tolerance;
            } else if errors.len() > window && error > (1.0 - part) * errors[errors.len() - 1 - window] {
                return StopReason::Stagnation;
            } else if self.history.len() > self.als.max_steps {
                return StopReason::Steps;
            } else if !step(descent) {
                return StopReason::Stagnation;
            }
        }
    }
}

/// The first coefficients of a start.
fn begin(start: Option<&Decomposition>, ranks: &[usize], n: usize) -> Result<Amplitudes, ShiftedError> {
    let Some(start) = start else {
        return Ok(Amplitudes { ranks: vec![0; ranks.len()], values: Mat::zeros(n, 0) });
    };
    let expected = [ranks.len(), n];
    let columns = start.frames.iter().map(|f| f.coefficients.ncols()).find(|&c| c != n).unwrap_or(n);
    if start.frames.len() != ranks.len() || columns != n {
        let found = [start.frames.len(), columns];
        return Err(ShiftedError::Shape { what: "coefficients of the start", expected, found });
    }
    let taken = start.frames.iter().zip(ranks).map(|(f, &r)| f.rank().min(r)).collect::<Vec<_>>();
    let places: Vec<_> = taken.iter().enumerate().flat_map(|(k, &r)| (0..r).map(move |i| (k, i))).collect();
    let values =
        Mat::from_fn(n, places.len(), |j, c| start.frames[places[c].0].coefficients[(places[c].1, j)]);
    let mut amplitudes = Amplitudes { ranks: taken, values };
    amplitudes.orthonormalise();
    amplitudes.drop_zeros();
    Ok(amplitudes)
}

/// One more mode in each frame that is to have more: the residual's largest in it.
fn grow(problem: &Problem<'_>, old: Amplitudes, ranks: &[usize]) -> Amplitudes {
    let more: Vec<_> = old.ranks.iter().zip(ranks).map(|(&a, &b)| usize::from(a < b)).collect();
    if more.iter().all(|&m| m == 0) {
        return old;
    }
    let new = dominant(problem, &old, &more);
    let sum: Vec<_> = old.ranks.iter().zip(&more).map(|(a, b)| a + b).collect();
    let (mut i, mut m) = (0, 0);
    let mut columns = Vec::new();
    for (&a, &b) in old.ranks.iter().zip(&more) {
        columns.extend((i..i + a).map(|c| old.values.col_as_slice(c)));
        columns.extend((m..m + b).map(|c| new.col_as_slice(c)));
        (i, m) = (i + a, m + b);
    }
    let values = Mat::from_fn(old.values.nrows(), columns.len(), |j, c| columns[c][j]);
    Amplitudes { ranks: sum, values }
}

fn frames_of(spectrum: &Spectrum, amplitudes: &Amplitudes, evaluation: &Evaluation) -> Vec<Frame> {
    let (n, rank) = amplitudes.values.shape();
    let fields = spectrum.fields(rank, &evaluation.modes);
    let mut first = 0;
    let mut frames = Vec::new();
    for &r in &amplitudes.ranks {
        let fields = Mat::from_fn(spectrum.n_rows(), r, |i, c| fields[(i, first + c)]);
        let amplitudes = Mat::from_fn(n, r, |j, c| amplitudes.values[(j, first + c)]);
        frames.push(frame(fields, &amplitudes, spectrum.scale));
        first += r;
    }
    frames
}
