//! The usual way to decompose snapshots.
use super::dense::columns;
use super::rank_search::{Fit, Found, RankSearch};
use super::residual::{Observer, Problem};
use super::thinning::{MANY, SOME, Thinned, thinned};
use super::translated::Translated;
use super::waves::Waves;
use super::{
    Decomposition, FieldShift, Frame, FrameOperators, Grid, GridFrames, Interpolation, JointDescent,
    Progress, ShiftedError, Shifts, StopReason,
};
use monomorphic::{Mat, MatRef};
use std::ops::ControlFlow;

/// How many modes each frame has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Ranks {
    /// So many.
    Given(Vec<usize>),
    /// As few as reach the tolerance, or as many as stand out of the noise.
    Found,
}

/// What the snapshots hold besides what the frames carry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// Nothing, or noise of all entries alike, which least squares average out.
    Dense,
    /// Some entries are wrong, by any amount.
    Sparse,
}

/// Shifted proper orthogonal decomposition, by the algorithms that suit the snapshots.
///
/// Frames that only move along periodic axes are fitted with [`Interpolation::Spectral`] in the
/// space of wave vectors by [`Als`](super::fourier::Als), first displaced so that their fields are
/// centred on cells ([`centred`](super::fourier::centred), [`Decomposition::offsets`]). With
/// another interpolation [`JointDescent`] goes on from there with shifts by that. All other frames
/// are fitted by [`JointDescent`] from nothing. A fit of given ranks that ends above 1e-6 is
/// repeated from other starts ([`Decomposition::attempts`]).
///
/// [`Ranks::Found`]: modes are added that stand out of the noise, and those that are not needed are
/// removed; first on some of the snapshots if there are many.
///
/// [`Noise::Sparse`], frames in the space of wave vectors: Huber's function of the residual is minimised
/// with a level that decreases until a least-squares fit without the entries beyond it is exact, or to
/// the level of the noise. Of more than 200 snapshots 200 tell the modes, and the modes the amplitudes of
/// the others. [`Decomposition::stopped`] is [`StopReason::Tolerance`] if all entries that are not
/// wrong are fitted to the tolerance; otherwise the error of the last step tells how far they are
/// off, and modes that do not stand out of that are left out, though they are given.
///
/// [`Noise::Sparse`], other frames: modes by the augmented Lagrangian of [`Proximal`](super::Proximal),
/// then by [`JointDescent::huber`]; entries that are off by more than six deviations are wrong, and
/// [`JointDescent`] fits all others.
#[derive(Clone, Debug, PartialEq)]
pub struct ShiftedPod {
    pub(super) grid: Grid,
    pub(super) interpolation: Interpolation,
    pub(super) ranks: Ranks,
    pub(super) noise: Noise,
    pub(super) rank_tolerance: f64,
    pub(super) tolerance: f64,
    pub(super) max_rank: usize,
    pub(super) max_steps: usize,
}

impl ShiftedPod {
    /// Ranks found for a relative error of 1e-4, up to 20 in a frame; no wrong entries; fitted to a relative error of 1e-10, in 100 steps at most.
    #[must_use]
    pub fn new(grid: Grid, interpolation: Interpolation) -> Self {
        Self {
            grid,
            interpolation,
            ranks: Ranks::Found,
            noise: Noise::Dense,
            rank_tolerance: 1e-4,
            tolerance: 1e-10,
            max_rank: 20,
            max_steps: 100,
        }
    }

    /// With so many modes.
    #[must_use]
    pub fn ranks(mut self, ranks: Ranks) -> Self {
        self.ranks = ranks;
        self
    }

    /// With such noise.
    #[must_use]
    pub fn noise(mut self, noise: Noise) -> Self {
        self.noise = noise;
        self
    }

    /// Ranks that are found reach this relative error, if noise lets them.
    #[must_use]
    pub fn rank_tolerance(mut self, error: f64) -> Self {
        self.rank_tolerance = error;
        self
    }

    /// The fit stops at this relative error.
    #[must_use]
    pub fn tolerance(mut self, error: f64) -> Self {
        self.tolerance = error;
        self
    }

    /// Ranks that are found are no larger than this.
    #[must_use]
    pub fn max_rank(mut self, rank: usize) -> Self {
        self.max_rank = rank;
        self
    }

    /// Steps of any one iteration, at most.
    #[must_use]
    pub fn max_steps(mut self, steps: usize) -> Self {
        self.max_steps = steps;
        self
    }

    /// Decomposes snapshots of these frames, from nothing or from frames that are known already. `observer` sees the steps of all
    /// iterations, numbered through.
    ///
    /// # Errors
    /// Those of [`GridFrames::new`] and [`JointDescent::solve`].
    pub fn solve(
        &self,
        shifts: &dyn Shifts,
        snapshots: MatRef<'_, f64>,
        start: Option<&[Frame]>,
        observer: Observer<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        self.check()?;
        let operators = GridFrames::new(self.grid, self.interpolation, shifts, snapshots.nrows())?;
        let problem = Problem::new(&operators, snapshots)?;
        let start = start.map(|s| problem.start(Some(s))).transpose()?;
        let mut watch = Watch { observer, history: vec![] };
        let waves = Waves::new(&self.grid, shifts, snapshots.nrows());
        match (waves, self.noise) {
            (Some(_), _) => {
                let d = Translated { pod: self, shifts, snapshots }.solve(start, &mut watch)?;
                self.interpolated(&operators, snapshots, d, &mut watch)
            }
            (None, Noise::Sparse) => self.robust(&operators, snapshots, start, &mut watch),
            (None, Noise::Dense) => self.dense(&operators, shifts, snapshots, start, &mut watch),
        }
    }

    /// Decomposes snapshots that any operators carry along, all of them at once.
    ///
    /// # Errors
    /// Those of [`JointDescent::solve`].
    pub fn solve_with(
        &self,
        operators: &dyn FrameOperators,
        snapshots: MatRef<'_, f64>,
        start: Option<&[Frame]>,
        observer: Observer<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        self.check()?;
        let problem = Problem::new(operators, snapshots)?;
        let start = start.map(|s| problem.start(Some(s))).transpose()?;
        let mut watch = Watch { observer, history: vec![] };
        match self.noise {
            Noise::Sparse => self.robust(operators, snapshots, start, &mut watch),
            Noise::Dense => {
                let start = start.unwrap_or(problem.start(None)?);
                let (frames, stopped) = self.fit(operators, snapshots, &[], start, &mut watch)?;
                Ok(Decomposition::of(frames, watch.history, stopped))
            }
        }
    }

    fn check(&self) -> Result<(), ShiftedError> {
        ShiftedError::check_tolerance("tolerance", self.tolerance)?;
        ShiftedError::check_tolerance("relative error for which ranks are found", self.rank_tolerance)
    }

    /// No entry is wrong. If there are many snapshots, modes are looked for on some of them first.
    fn dense(
        &self,
        operators: &GridFrames,
        shifts: &dyn Shifts,
        snapshots: MatRef<'_, f64>,
        start: Option<Vec<Frame>>,
        watch: &mut Watch<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        let (m, n) = snapshots.shape();
        let frames = match start {
            Some(frames) => frames,
            None if n > MANY => {
                let (some, few) = thinned(snapshots, SOME);
                let shifts = Thinned { shifts, snapshots: &some };
                let operators = GridFrames::new(self.grid, self.interpolation, &shifts, m)?;
                let fit = self.descent(&operators, few.as_ref(), &[]);
                let (frames, stopped) = self.search(&operators, few.as_ref(), &[], None, &fit, watch)?;
                let frames = frames.iter().map(|f| f.between(&some, n)).collect();
                if stopped == StopReason::Asked {
                    return Ok(Decomposition::of(frames, watch.take(), stopped));
                }
                frames
            }
            None => vec![Frame::nothing(m, n); operators.n_frames()],
        };
        let (frames, stopped) = self.fit(operators, snapshots, &[], frames, watch)?;
        Ok(Decomposition::of(frames, watch.take(), stopped))
    }

    /// A decomposition by spectral shifts, fitted anew with shifts by the interpolation chosen.
    fn interpolated(
        &self,
        operators: &GridFrames,
        snapshots: MatRef<'_, f64>,
        spectral: Decomposition,
        watch: &mut Watch<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        if self.interpolation == Interpolation::Spectral || spectral.stopped == StopReason::Asked {
            return Ok(spectral);
        }
        watch.history = spectral.history;
        let shift = FieldShift::new(self.grid, Interpolation::Spectral);
        let mut start = spectral.frames;
        for (frame, &offset) in start.iter_mut().zip(&spectral.offsets) {
            for mode in columns(&mut frame.modes) {
                mode.copy_from_slice(&shift.shift(offset, mode));
            }
        }
        let wrong: Vec<_> = spectral.noise.as_ref().map_or_else(Vec::new, nonzero);
        let (frames, stopped) = self.fit(operators, snapshots, &wrong, start, watch)?;
        let residual = Problem::new(operators, snapshots)?.residual(&frames);
        let noise = spectral.noise.map(|_| only(&residual, &wrong));
        let d = Decomposition::of(frames, watch.take(), stopped);
        Ok(Decomposition { noise, attempts: spectral.attempts, ..d })
    }

    /// The modes that are asked for, fitted to all entries but the wrong ones.
    pub(super) fn fit(
        &self,
        operators: &dyn FrameOperators,
        snapshots: MatRef<'_, f64>,
        wrong: &[(usize, usize)],
        start: Vec<Frame>,
        watch: &mut Watch<'_>,
    ) -> Found {
        let given = match &self.ranks {
            Ranks::Given(ranks) => Some(Problem::new(operators, snapshots)?.ranks(ranks)?),
            Ranks::Found => None,
        };
        let full =
            given.as_ref().is_some_and(|r| start.iter().zip(r).all(|(frame, &rank)| frame.rank() >= rank));
        let mut frames = start;
        if !full {
            let stopped;
            let fit = self.descent(operators, snapshots, wrong);
            (frames, stopped) = self.search(operators, snapshots, wrong, Some(frames), &fit, watch)?;
            if stopped == StopReason::Asked {
                return Ok((frames, stopped));
            }
        }
        let ranks = given.unwrap_or_else(|| frames.iter().map(Frame::rank).collect());
        let ranks: Vec<_> = frames.iter().zip(&ranks).map(|(frame, &rank)| frame.rank().min(rank)).collect();
        frames = frames.iter().zip(&ranks).map(|(frame, &rank)| frame.cut(rank)).collect();
        let descent =
            JointDescent::new(ranks).tolerance(self.tolerance).max_steps(self.max_steps).ignoring(wrong);
        let d = descent.solve(operators, snapshots, Some(&frames), &mut |p| watch.see(p))?;
        Ok((d.frames, d.stopped))
    }

    /// A rough fit by [`JointDescent`].
    fn descent<'a>(
        &'a self,
        operators: &'a dyn FrameOperators,
        snapshots: MatRef<'a, f64>,
        ignored: &'a [(usize, usize)],
    ) -> impl Fn(&[Frame], f64, Observer<'_>) -> Found + 'a {
        move |frames, tolerance, observer| {
            let ranks: Vec<_> = frames.iter().map(Frame::rank).collect();
            let descent = JointDescent::new(ranks).tolerance(tolerance).stagnation(5e-3);
            let descent = descent.max_steps(self.max_steps).ignoring(ignored);
            let d = descent.solve(operators, snapshots, Some(frames), observer)?;
            Ok((d.frames, d.stopped))
        }
    }

    /// Modes as many as are given, or needed, roughly fitted.
    fn search(
        &self,
        operators: &dyn FrameOperators,
        snapshots: MatRef<'_, f64>,
        ignored: &[(usize, usize)],
        start: Option<Vec<Frame>>,
        fit: Fit<'_>,
        watch: &mut Watch<'_>,
    ) -> Found {
        let problem = Problem::new(operators, snapshots)?;
        let (ranks, all, tolerance) = match &self.ranks {
            Ranks::Given(ranks) => (ranks.clone(), true, self.tolerance),
            Ranks::Found => (vec![self.max_rank; operators.n_frames()], false, self.rank_tolerance),
        };
        let ranks = problem.ranks(&ranks)?;
        let search = RankSearch { operators, snapshots, ignored, tolerance, ranks: &ranks, all, fit };
        search.search(start.map_or_else(|| problem.start(None), Ok)?, &mut |p| watch.see(p))
    }
}

/// Row and column of entries that are not zero.
fn nonzero(field: &Mat<f64>) -> Vec<(usize, usize)> {
    let rows = 0..field.nrows();
    let column = |j: usize| rows.clone().filter(move |&i| field[(i, j)] != 0.0).map(move |i| (i, j));
    (0..field.ncols()).flat_map(column).collect()
}

/// These entries of a field, zeros elsewhere.
pub(super) fn only(field: &Mat<f64>, entries: &[(usize, usize)]) -> Mat<f64> {
    let mut part = Mat::zeros(field.nrows(), field.ncols());
    entries.iter().for_each(|&at| part[at] = field[at]);
    part
}

/// Numbers the steps of several iterations through.
pub(super) struct Watch<'a> {
    observer: Observer<'a>,
    pub(super) history: Vec<Progress>,
}

impl Watch<'_> {
    pub(super) fn see(&mut self, progress: &Progress) -> ControlFlow<()> {
        let progress = Progress { step: self.history.len() + 1, ..*progress };
        self.history.push(progress);
        (self.observer)(&progress)
    }

    pub(super) fn take(&mut self) -> Vec<Progress> {
        std::mem::take(&mut self.history)
    }
}
