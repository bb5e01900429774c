//! The usual way to decompose snapshots.
use super::dense::thin;
use super::fourier::Als;
use super::rank_search::{Fit, Found, RankSearch, deviation};
use super::residual::{Observer, Problem};
use super::waves::Waves;
use super::{
    Decomposition, Frame, FrameOperators, Grid, GridFrames, Interpolation, JointDescent, Motion, Progress,
    Proximal, ShiftedError, Shifts, StopReason,
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
/// 1. If entries may be wrong, the augmented Lagrangian of [`Proximal`] tells the modes to start from. They are fitted so that wrong entries
///    do little harm, by [`JointDescent::huber`], and those that are off by more than six deviations of the others are wrong.
/// 2. Ranks that are not given are found by adding modes that stand out of the noise, and leaving out those that are not needed; first
///    on some of the snapshots if there are many.
/// 3. [`JointDescent`] fits all modes to the entries that are not wrong: nothing is left of the bias of the nuclear norm.
///
/// Frames that only move, with [`Interpolation::Spectral`], are decomposed in the space of wave vectors and fitted by [`Als`].
#[derive(Clone, Debug, PartialEq)]
pub struct ShiftedPod {
    grid: Grid,
    interpolation: Interpolation,
    ranks: Ranks,
    noise: Noise,
    rank_tolerance: f64,
    tolerance: f64,
    max_rank: usize,
    max_steps: usize,
}

/// More snapshots than this are thinned out to find the ranks.
const MANY: usize = 150;
const SOME: usize = 75;

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
        let operators = GridFrames::new(self.grid, self.interpolation, shifts, snapshots.nrows())?;
        let problem = Problem::new(&operators, snapshots)?;
        let start = start.map(|s| problem.start(Some(s))).transpose()?;
        let mut watch = Watch { observer, history: vec![] };
        if self.noise == Noise::Sparse {
            return self.robust(&operators, snapshots, start, &mut watch);
        }
        let waves = Waves::new(&self.grid, shifts, snapshots.nrows());
        match waves.filter(|_| self.interpolation == Interpolation::Spectral) {
            Some(waves) => self.translated(&waves, shifts, snapshots, start, &mut watch),
            None => self.dense(&operators, shifts, snapshots, start, &mut watch),
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
        let problem = Problem::new(operators, snapshots)?;
        let start = start.map(|s| problem.start(Some(s))).transpose()?;
        let mut watch = Watch { observer, history: vec![] };
        match self.noise {
            Noise::Sparse => self.robust(operators, snapshots, start, &mut watch),
            Noise::Dense => {
                let start = start.unwrap_or(problem.start(None)?);
                let (frames, stopped) = self.fit(operators, snapshots, &[], start, &mut watch)?;
                Ok(Decomposition { frames, noise: None, history: watch.history, stopped })
            }
        }
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
                let (some, few) = thinned(snapshots);
                let shifts = Thinned { shifts, snapshots: &some };
                let operators = GridFrames::new(self.grid, self.interpolation, &shifts, m)?;
                let fit = self.descent(&operators, few.as_ref(), &[]);
                let (frames, stopped) = self.search(&operators, few.as_ref(), &[], None, &fit, watch)?;
                let frames = frames.iter().map(|f| f.between(&some, n)).collect();
                if stopped == StopReason::Asked {
                    return Ok(Decomposition { frames, noise: None, history: watch.take(), stopped });
                }
                frames
            }
            None => vec![Frame::nothing(m, n); operators.n_frames()],
        };
        let (frames, stopped) = self.fit(operators, snapshots, &[], frames, watch)?;
        Ok(Decomposition { frames, noise: None, history: watch.take(), stopped })
    }

    /// The same of frames that only move, by their waves: [`Als`] fits them.
    fn translated(
        &self,
        waves: &Waves,
        shifts: &dyn Shifts,
        snapshots: MatRef<'_, f64>,
        start: Option<Vec<Frame>>,
        watch: &mut Watch<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        let n = snapshots.ncols();
        let decomposition =
            |frames| Decomposition { frames, noise: None, history: vec![], stopped: StopReason::Asked };
        let als =
            |ranks: &[usize], tolerance| Als { tolerance, max_steps: 5 * self.max_steps, ..Als::new(ranks) };
        let (ranks, start) = match &self.ranks {
            Ranks::Given(ranks) => (ranks.clone(), start),
            Ranks::Found => {
                let (some, few) = match &start {
                    None if n > MANY => thinned(snapshots),
                    _ => ((0..n).collect(), snapshots.to_owned()),
                };
                let thinned = Thinned { shifts, snapshots: &some };
                let fit = |frames: &[Frame], tolerance: f64, observer: Observer<'_>| {
                    let ranks: Vec<_> = frames.iter().map(Frame::rank).collect();
                    let start = decomposition(frames.to_vec());
                    let mut go_on = |p: &Progress| observer(p).is_continue();
                    let als = als(&ranks, tolerance);
                    let d = als.solve(&self.grid, &thinned, few.as_ref(), Some(&start), None, &mut go_on)?;
                    Ok((carried(d.frames, &|modes| waves.waves(modes)), d.stopped))
                };
                let start = start.map(|frames| carried(frames, &|modes| waves.waves(modes)));
                let transformed = waves.waves(few.as_ref());
                let waves_of_some = waves.thinned(&some);
                let (frames, stopped) =
                    self.search(&waves_of_some, transformed.as_ref(), &[], start, &fit, watch)?;
                let frames = carried(frames, &|modes| waves.fields(modes));
                let frames: Vec<_> = frames.iter().map(|f| f.between(&some, n)).collect();
                if stopped == StopReason::Asked {
                    return Ok(Decomposition { history: watch.take(), ..decomposition(frames) });
                }
                (frames.iter().map(Frame::rank).collect(), Some(frames))
            }
        };
        let start = start.map(decomposition);
        let mut go_on = |p: &Progress| watch.see(p).is_continue();
        let als = als(&ranks, self.tolerance);
        let d = als.solve(&self.grid, shifts, snapshots, start.as_ref(), None, &mut go_on)?;
        Ok(Decomposition { history: watch.take(), ..d })
    }

    /// Some entries are wrong.
    fn robust(
        &self,
        operators: &dyn FrameOperators,
        snapshots: MatRef<'_, f64>,
        start: Option<Vec<Frame>>,
        watch: &mut Watch<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        let mut proximal = Proximal::augmented_lagrangian().with_noise().tolerance(1e-3);
        proximal = proximal.max_steps(2 * self.max_steps);
        let convex = proximal.solve(operators, snapshots, start.as_deref(), &mut |p| watch.see(p))?;
        if convex.stopped == StopReason::Asked {
            return Ok(Decomposition { history: watch.take(), ..convex });
        }
        // Small singular values are noise or will be found again.
        let largest = convex.frames.iter().flat_map(|f| &f.singular_values).fold(0.0, |a: f64, &s| a.max(s));
        let leading = |(k, frame): (usize, &Frame)| match &self.ranks {
            Ranks::Given(ranks) => frame.cut(ranks.get(k).map_or(0, |&r| r.min(frame.rank()))),
            Ranks::Found => {
                frame.cut(frame.singular_values.iter().filter(|&&s| s > LEADING * largest).count())
            }
        };
        let mut frames: Vec<Frame> = convex.frames.iter().enumerate().map(leading).collect();
        let problem = Problem::new(operators, snapshots)?;
        for round in 1.. {
            let ranks: Vec<_> = frames.iter().map(Frame::rank).collect();
            frames = self.robust_fit(&problem, frames, watch)?;
            // Where nothing is explained nothing is wrong.
            let known = ranks.iter().any(|&rank| rank > 0);
            let wrong = match known {
                true => entries(&problem.residual(&frames), 6.0 * deviation_there(&problem, &frames)),
                false => vec![],
            };
            let stopped;
            (frames, stopped) = self.fit(operators, snapshots, &wrong, frames, watch)?;
            let same = frames.iter().map(Frame::rank).eq(ranks);
            if same || round == ROUNDS || stopped == StopReason::Asked {
                let residual = problem.residual(&frames);
                let mut noise = Mat::zeros(residual.nrows(), residual.ncols());
                wrong.iter().for_each(|&at| noise[at] = residual[at]);
                return Ok(Decomposition { frames, noise: Some(noise), history: watch.take(), stopped });
            }
        }
        unreachable!("the last round returns")
    }

    /// Modes fitted so that wrong entries do little harm, with Huber's level from the deviation of the others, until that is as small as it gets.
    fn robust_fit(
        &self,
        problem: &Problem<'_>,
        mut frames: Vec<Frame>,
        watch: &mut Watch<'_>,
    ) -> Result<Vec<Frame>, ShiftedError> {
        let mut level = deviation_there(problem, &frames);
        for _ in 0..self.max_steps {
            if level <= 0.0 {
                break;
            }
            let ranks: Vec<_> = frames.iter().map(Frame::rank).collect();
            let descent = JointDescent::new(ranks).huber(level).stagnation(0.05).max_steps(self.max_steps);
            let d =
                descent.solve(problem.operators, problem.snapshots, Some(&frames), &mut |p| watch.see(p))?;
            frames = d.frames;
            let before = level;
            level = deviation_there(problem, &frames);
            if d.stopped == StopReason::Asked || level > 0.9 * before {
                break;
            }
        }
        Ok(frames)
    }

    /// The modes that are asked for, fitted to all entries but the wrong ones.
    fn fit(
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

/// Frames with other modes.
fn carried(frames: Vec<Frame>, map: &dyn Fn(MatRef<'_, f64>) -> Mat<f64>) -> Vec<Frame> {
    frames.into_iter().map(|frame| Frame { modes: map(frame.modes.as_ref()), ..frame }).collect()
}

/// Some of the snapshots, the first and the last among them.
fn thinned(snapshots: MatRef<'_, f64>) -> (Vec<usize>, Mat<f64>) {
    let some: Vec<usize> = (0..SOME).map(|i| i * (snapshots.ncols() - 1) / (SOME - 1)).collect();
    let few = Mat::from_fn(snapshots.nrows(), SOME, |i, j| snapshots[(i, some[j])]);
    (some, few)
}

/// Modes of the augmented Lagrangian below this part of the largest one are not started from.
const LEADING: f64 = 0.02;

/// How often ranks are looked for.
const ROUNDS: usize = 3;

/// The deviation of what is left, where there is something to carry along, from nothing; no less than round-off.
fn deviation_there(problem: &Problem<'_>, frames: &[Frame]) -> f64 {
    let residual = problem.residual(frames);
    let explained = problem.snapshots - &residual;
    let something = 0.02 * explained.norm_max();
    let there = explained.col_iter().zip(residual.col_iter()).flat_map(|(f, r)| {
        f.iter().zip(r.iter()).filter(|(f, _)| f.abs() > something).map(|(_, r)| r.abs()).collect::<Vec<_>>()
    });
    deviation(there.collect()).max(1e-10 * problem.snapshots.norm_max())
}

/// Row and column of entries larger than that.
fn entries(field: &Mat<f64>, size: f64) -> Vec<(usize, usize)> {
    let column =
        |j: usize| (0..field.nrows()).filter(move |&i| field[(i, j)].abs() > size).map(move |i| (i, j));
    (0..field.ncols()).flat_map(column).collect()
}

/// Some of the snapshots.
struct Thinned<'a> {
    shifts: &'a dyn Shifts,
    snapshots: &'a [usize],
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

/// Numbers the steps of several iterations through.
struct Watch<'a> {
    observer: Observer<'a>,
    history: Vec<Progress>,
}

impl Watch<'_> {
    fn see(&mut self, progress: &Progress) -> ControlFlow<()> {
        let progress = Progress { step: self.history.len() + 1, ..*progress };
        self.history.push(progress);
        (self.observer)(&progress)
    }

    fn take(&mut self) -> Vec<Progress> {
        std::mem::take(&mut self.history)
    }
}

impl Frame {
    /// From some of `n` snapshots to all of them, σ a linear in between.
    fn between(&self, some: &[usize], n: usize) -> Self {
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
