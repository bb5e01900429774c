//! The usual way to decompose snapshots.
use super::dense::thin;
use super::rank_search::{RankSearch, deviation};
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
/// Frames that only move, with [`Interpolation::Spectral`], are decomposed in the space of wave vectors.
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

/// The operators of some of the snapshots.
type OperatorsOf<'a> = dyn Fn(&[usize]) -> Result<Box<dyn FrameOperators>, ShiftedError> + 'a;

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
        let Some(waves) = waves.filter(|_| self.interpolation == Interpolation::Spectral) else {
            let thinned = |snapshots: &[usize]| -> Result<Box<dyn FrameOperators>, ShiftedError> {
                let some = Thinned { shifts, snapshots };
                Ok(Box::new(GridFrames::new(self.grid, self.interpolation, &some, operators.n_rows())?))
            };
            return self.dense(&operators, snapshots, start, &thinned, &mut watch);
        };
        let thinned = |snapshots: &[usize]| -> Result<Box<dyn FrameOperators>, ShiftedError> {
            Ok(Box::new(waves.thinned(snapshots)))
        };
        let carried = |frames: Vec<Frame>, map: &dyn Fn(MatRef<'_, f64>) -> Mat<f64>| -> Vec<Frame> {
            frames.into_iter().map(|frame| Frame { modes: map(frame.modes.as_ref()), ..frame }).collect()
        };
        let start = start.map(|frames| carried(frames, &|modes| waves.waves(modes)));
        let transformed = waves.waves(snapshots);
        let mut d = self.dense(&waves, transformed.as_ref(), start, &thinned, &mut watch)?;
        d.frames = carried(d.frames, &|modes| waves.fields(modes));
        Ok(d)
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

    /// No entry is wrong. Ranks are looked for on some of the snapshots if there are many.
    fn dense(
        &self,
        operators: &dyn FrameOperators,
        snapshots: MatRef<'_, f64>,
        start: Option<Vec<Frame>>,
        thinned: &OperatorsOf<'_>,
        watch: &mut Watch<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        let (m, n) = snapshots.shape();
        let mut frames = start.unwrap_or_else(|| vec![Frame::nothing(m, n); operators.n_frames()]);
        let fresh = frames.iter().all(|f| f.rank() == 0);
        if fresh && n > MANY {
            let some: Vec<usize> = (0..SOME).map(|i| i * (n - 1) / (SOME - 1)).collect();
            let few = Mat::from_fn(m, SOME, |i, j| snapshots[(i, some[j])]);
            let ranks = match &self.ranks {
                Ranks::Given(ranks) => ranks.clone(),
                Ranks::Found => vec![self.max_rank; frames.len()],
            };
            let some_operators = thinned(&some)?;
            let ranks = Problem::new(&*some_operators, few.as_ref())?.ranks(&ranks)?;
            let start = vec![Frame::nothing(m, SOME); frames.len()];
            let search = self.rank_search(&*some_operators, few.as_ref(), &[], &ranks);
            let search = search.search(start, &mut |p| watch.see(p))?;
            frames = search.0.iter().map(|f| f.between(&some, n)).collect();
            if search.1 == StopReason::Asked {
                return Ok(Decomposition { frames, noise: None, history: watch.take(), stopped: search.1 });
            }
        }
        let (frames, stopped) = self.fit(operators, snapshots, &[], frames, watch)?;
        Ok(Decomposition { frames, noise: None, history: watch.take(), stopped })
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
    ) -> Result<(Vec<Frame>, StopReason), ShiftedError> {
        let problem = Problem::new(operators, snapshots)?;
        let (ranks, all) = match &self.ranks {
            Ranks::Given(ranks) => (problem.ranks(ranks)?, true),
            Ranks::Found => (problem.ranks(&vec![self.max_rank; operators.n_frames()])?, false),
        };
        let mut frames = start;
        if !all || frames.iter().zip(&ranks).any(|(frame, &rank)| frame.rank() < rank) {
            let search = self.rank_search(operators, snapshots, wrong, &ranks);
            let stopped;
            (frames, stopped) = search.search(frames, &mut |p| watch.see(p))?;
            if stopped == StopReason::Asked {
                return Ok((frames, stopped));
            }
        }
        let ranks: Vec<_> = frames.iter().zip(&ranks).map(|(frame, &rank)| frame.rank().min(rank)).collect();
        frames = frames.iter().zip(&ranks).map(|(frame, &rank)| frame.cut(rank)).collect();
        let descent =
            JointDescent::new(ranks).tolerance(self.tolerance).max_steps(self.max_steps).ignoring(wrong);
        let d = descent.solve(operators, snapshots, Some(&frames), &mut |p| watch.see(p))?;
        Ok((d.frames, d.stopped))
    }

    fn rank_search<'a>(
        &self,
        operators: &'a dyn FrameOperators,
        snapshots: MatRef<'a, f64>,
        ignored: &'a [(usize, usize)],
        ranks: &'a [usize],
    ) -> RankSearch<'a> {
        let all = self.ranks != Ranks::Found;
        let tolerance = if all { self.tolerance } else { self.rank_tolerance };
        RankSearch { operators, snapshots, ignored, tolerance, ranks, all, max_steps: self.max_steps }
    }
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
