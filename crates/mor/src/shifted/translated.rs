//! Frames that only move along periodic axes: all in the space of wave vectors.
use super::fourier::{Als, LONG, Spectrum, offsets};
use super::huber_descent::HuberDescent;
use super::rank_search::{Found, RankSearch, deviation};
use super::residual::{Observer, Problem};
use super::shifted_pod::{Ranks, Watch};
use super::thinning::{MANY, SOME, Thinned, thinned};
use super::waves::Waves;
use super::{
    Decomposition, Frame, FrameOperators, Motions, Noise, Progress, ShiftedError, ShiftedPod, Shifts,
    StopReason,
};
use interfaces::Vector;
use monomorphic::{Mat, MatRef};

/// A decomposition to be found.
pub(super) struct Translated<'a> {
    pub(super) pod: &'a ShiftedPod,
    pub(super) shifts: &'a dyn Shifts,
    pub(super) snapshots: MatRef<'a, f64>,
}

/// Up to this number of entries Huber's function is minimised, too, which takes about 0.3 ms an entry.
pub(super) const SMALL: usize = 50_000;
/// Modes and wrong entries by turns, at most so often.
const ROUNDS: usize = 40;
/// In a round the modes are fitted until so many steps lower the error by less than this part.
pub(super) const BRIEF: (usize, f64) = (3, 0.05);
/// A round that lowers deviation and error to no less than this part of what they were is one of the last.
const SETTLED: f64 = 0.7;
/// Entries that are so many deviations off are wrong.
const WRONG: f64 = 6.0;
/// In a snapshot whose amplitude is off all entries are, alike.
const WRONG_OF_ONE: f64 = 4.0;
/// When there are other modes to be found, only what is off by more than this part of the largest value counts as wrong at first.
const CLEARLY: f64 = 0.1;
/// Beside wrong entries ranks are looked for on so many snapshots, if there are more: fewer do not tell small modes from entries that are a little off.
const TOLD: usize = 200;
/// A level is at least this part of the one before. The modes must follow: what they do not show yet, such as the edges of bodies, would count as wrong and
/// not be fitted any more (0.4 left 1e-4 of two discs).
const SHRINK: f64 = 0.6;
/// Fewer entries do not tell a deviation.
const FEW: usize = 10;
/// Entries that tell the deviation, about.
const TELLING: usize = 1 << 20;

impl Translated<'_> {
    pub(super) fn solve(
        &self,
        start: Option<Vec<Frame>>,
        watch: &mut Watch<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        if let Ranks::Given(ranks) = &self.pod.ranks
            && ranks.len() != self.shifts.n_frames()
        {
            return Err(ShiftedError::Ranks { ranks: ranks.len(), frames: self.shifts.n_frames() });
        }
        match self.pod.noise {
            Noise::Dense => self.dense(start, watch),
            Noise::Sparse => self.sparse(start, watch),
        }
    }

    pub(super) fn als(&self, ranks: &[usize], tolerance: f64) -> Als {
        Als { tolerance, max_steps: 5 * self.pod.max_steps, ..Als::new(ranks) }
    }

    /// Q − E in Fourier space, the frames brought to where they are best, and how far that is.
    pub(super) fn spectrum(&self, noise: Option<&Mat<f64>>) -> Result<(Spectrum, Vec<Vector>), ShiftedError> {
        let (grid, noise) = (&self.pod.grid, noise.map(|e| e.as_ref()));
        let cut = self.als(&[], self.pod.tolerance).cut();
        let spectrum = Spectrum::new(grid, self.shifts, self.snapshots, noise, cut)?;
        let offsets = offsets(grid, self.shifts, &spectrum);
        let spectrum = spectrum.along(grid, &Motions::beside(self.shifts, &offsets))?;
        Ok((spectrum, offsets))
    }

    /// No entry is wrong.
    fn dense(&self, start: Option<Vec<Frame>>, watch: &mut Watch<'_>) -> Result<Decomposition, ShiftedError> {
        let n = self.snapshots.ncols();
        let (spectrum, offsets) = self.spectrum(None)?;
        let (ranks, start) = match &self.pod.ranks {
            Ranks::Given(ranks) => (ranks.clone(), start),
            Ranks::Found => {
                let (some, few) = match &start {
                    None if n > MANY => thinned(self.snapshots, SOME),
                    _ => ((0..n).collect(), self.snapshots.to_owned()),
                };
                let moved = Motions::beside(self.shifts, &offsets);
                let part = Translated {
                    pod: self.pod,
                    shifts: &Thinned { shifts: &moved, snapshots: &some },
                    snapshots: few.as_ref(),
                };
                let (frames, stopped) = part.search(
                    start,
                    &vec![self.pod.max_rank; moved.n_frames()],
                    self.pod.rank_tolerance,
                    watch,
                )?;
                let frames: Vec<_> = frames.iter().map(|f| f.between(&some, n)).collect();
                if stopped == StopReason::Asked {
                    return Ok(Decomposition { offsets, ..Decomposition::of(frames, watch.take(), stopped) });
                }
                (frames.iter().map(Frame::rank).collect(), Some(frames))
            }
        };
        let als = self.als(&ranks, self.pod.tolerance);
        let mut go_on = |p: &Progress| watch.see(p).is_continue();
        let d = match start.map(started) {
            Some(start) => als.fit(&spectrum, Some(&start), LONG, &mut go_on)?,
            None => als.least(&spectrum, &mut go_on)?,
        };
        Ok(Decomposition { history: watch.take(), offsets, ..d })
    }

    /// As many modes as are needed but no more than `most`, roughly fitted, in frames that are where they should be.
    pub(super) fn search(
        &self,
        start: Option<Vec<Frame>>,
        most: &[usize],
        tolerance: f64,
        watch: &mut Watch<'_>,
    ) -> Found {
        let Some(waves) = Waves::new(&self.pod.grid, self.shifts, self.snapshots.nrows()) else {
            let still = start.unwrap_or_default();
            return Ok((still, StopReason::Stagnation));
        };
        let spectrum = {
            let (grid, cut) = (&self.pod.grid, self.als(&[], tolerance).cut());
            Spectrum::new(grid, self.shifts, self.snapshots, None, cut)?
        };
        let fit = |frames: &[Frame], tolerance: f64, observer: Observer<'_>| {
            let ranks: Vec<_> = frames.iter().map(Frame::rank).collect();
            let mut go_on = |p: &Progress| observer(p).is_continue();
            let start = started(frames.to_vec());
            let d = self.als(&ranks, tolerance).fit(&spectrum, Some(&start), LONG, &mut go_on)?;
            Ok((carried(d.frames, &|modes| waves.waves(modes)), d.stopped))
        };
        let transformed = waves.waves(self.snapshots);
        let problem = Problem::new(&waves, transformed.as_ref())?;
        let ranks = problem.ranks(most)?;
        let search = RankSearch {
            operators: &waves,
            snapshots: transformed.as_ref(),
            ignored: &[],
            tolerance,
            ranks: &ranks,
            all: false,
            fit: &fit,
        };
        let start = match start {
            Some(frames) => carried(frames, &|modes| waves.waves(modes)),
            None => problem.start(None)?,
        };
        let (frames, stopped) = search.search(start, &mut |p| watch.see(p))?;
        Ok((carried(frames, &|modes| waves.fields(modes)), stopped))
    }

    /// Some entries are wrong. Ranks are looked for on some of the snapshots first, if there are many.
    fn sparse(
        &self,
        start: Option<Vec<Frame>>,
        watch: &mut Watch<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        let (m, n) = self.snapshots.shape();
        if m * n <= SMALL {
            return self.small(start, watch);
        }
        let robust = match &self.pod.ranks {
            Ranks::Given(ranks) => self.with_ranks(ranks, start, watch)?,
            Ranks::Found if start.is_some() || n <= TOLD => self.with_ranks_found(start, watch)?,
            Ranks::Found => {
                let (some, few) = thinned(self.snapshots, TOLD);
                let thinned = Thinned { shifts: self.shifts, snapshots: &some };
                let part = Translated { pod: self.pod, shifts: &thinned, snapshots: few.as_ref() };
                let found = part.with_ranks_found(None, watch)?;
                if found.stopped == StopReason::Asked {
                    let frames = found.frames.iter().map(|f| f.between(&some, n)).collect();
                    Robust { frames, noise: Some(Mat::zeros(m, n)), ..found }
                } else {
                    let ranks: Vec<_> = found.frames.iter().map(Frame::rank).collect();
                    self.with_ranks(&ranks, None, watch)?
                }
            }
        };
        let Robust { frames, noise, offsets, stopped } = robust;
        Ok(Decomposition { noise, offsets, ..Decomposition::of(frames, watch.take(), stopped) })
    }

    /// The better of Huber's descent and of modes and wrong entries by turns with its ranks.
    fn small(&self, start: Option<Vec<Frame>>, watch: &mut Watch<'_>) -> Result<Decomposition, ShiftedError> {
        let (m, n) = self.snapshots.shape();
        let nothing = || vec![Frame::nothing(m, n); self.shifts.n_frames()];
        let descent = HuberDescent { problem: self };
        let mut best = descent.solve(start.clone().unwrap_or_else(nothing), watch)?;
        if best.stopped != StopReason::Asked {
            let ranks = match &self.pod.ranks {
                Ranks::Given(ranks) => ranks.clone(),
                Ranks::Found => best.ranks(),
            };
            let Robust { frames, noise, offsets, stopped } = self.with_ranks(&ranks, start, watch)?;
            let by_turns = Decomposition { noise, offsets, ..Decomposition::of(frames, vec![], stopped) };
            if stopped == StopReason::Asked {
                best.stopped = stopped;
            } else if convex_size(&by_turns) < convex_size(&best) {
                best = by_turns;
            }
        }
        // The last step has the error of the fit that is returned.
        let mut left = self.residual(&best.frames, &best.offsets);
        if let Some(noise) = &best.noise {
            left -= noise;
        }
        if best.stopped != StopReason::Asked {
            let relative = left.norm_l2() / self.snapshots.norm_l2().max(f64::MIN_POSITIVE);
            let rank = best.frames.iter().map(Frame::rank).sum();
            if watch.see(&Progress { step: 0, error: relative, rank }).is_break() {
                best.stopped = StopReason::Asked;
            }
        }
        Ok(Decomposition { history: watch.take(), ..best })
    }

    /// One mode in each frame first, and more when most wrong entries are known: what is not explained at all would count as wrong. Then again from a
    /// level at which hardly anything does: what was taken for wrong when the modes were would stay as they had it.
    fn with_ranks(
        &self,
        ranks: &[usize],
        start: Option<Vec<Frame>>,
        watch: &mut Watch<'_>,
    ) -> Result<Robust, ShiftedError> {
        let (m, n) = self.snapshots.shape();
        let frames = start.unwrap_or_else(|| vec![Frame::nothing(m, n); ranks.len()]);
        let offsets = vec![Vector::zeros(); ranks.len()];
        let start = Robust { frames, noise: None, offsets, stopped: StopReason::Steps };
        let first: Vec<_> = ranks.iter().map(|&r| r.min(1)).collect();
        let robust = self.rounds(start, &first, watch)?;
        match robust.stopped {
            StopReason::Asked => Ok(robust),
            _ => self.rounds(robust, ranks, watch),
        }
    }

    /// A mode more, or less, at a time, until those needed are there once the wrong entries are left out.
    fn with_ranks_found(
        &self,
        start: Option<Vec<Frame>>,
        watch: &mut Watch<'_>,
    ) -> Result<Robust, ShiftedError> {
        let first = match &start {
            Some(frames) => frames.iter().map(|f| f.rank().max(1)).collect(),
            None => vec![1; self.shifts.n_frames()],
        };
        let mut robust = self.with_ranks(&first, start, watch)?;
        // Each fit begins there: entries that fewer modes took for wrong would stay as those had them.
        let begun = robust.clone();
        for _ in 0..2 * self.pod.max_rank {
            if robust.stopped == StopReason::Asked {
                break;
            }
            let before: Vec<_> = robust.frames.iter().map(Frame::rank).collect();
            let known = match &robust.noise {
                Some(noise) => self.snapshots - noise,
                None => self.snapshots.to_owned(),
            };
            let moved = Motions::beside(self.shifts, &robust.offsets);
            let part = Translated { pod: self.pod, shifts: &moved, snapshots: known.as_ref() };
            let most: Vec<_> = before.iter().map(|r| (r + 1).min(self.pod.max_rank)).collect();
            let start = Some(robust.frames.clone());
            let (frames, stopped) = part.search(start, &most, self.pod.rank_tolerance, watch)?;
            if stopped == StopReason::Asked {
                robust = Robust { frames, stopped, ..robust };
                break;
            }
            let ranks: Vec<_> = frames.iter().map(Frame::rank).collect();
            if ranks == before {
                break;
            }
            robust = self.rounds(begun.clone(), &ranks, watch)?;
        }
        Ok(robust)
    }

    /// Modes of these ranks and wrong entries by turns: what is off by more than six deviations is replaced by what the modes have there.
    fn rounds(
        &self,
        mut robust: Robust,
        ranks: &[usize],
        watch: &mut Watch<'_>,
    ) -> Result<Robust, ShiftedError> {
        let als = self.als(ranks, self.pod.tolerance);
        let mut before = f64::INFINITY;
        let mut patience = BRIEF;
        let mut level = f64::INFINITY;
        if robust.noise.is_some() {
            level = 0.0;
            let mut noise = self.noise(&robust.frames, &robust.offsets, &mut level);
            release(&mut noise);
            robust.noise = Some(noise);
        }
        for _ in 0..ROUNDS {
            let (spectrum, offsets) = self.spectrum(robust.noise.as_ref())?;
            let start = started(robust.frames);
            let mut go_on = |p: &Progress| watch.see(p).is_continue();
            let d = als.fit(&spectrum, Some(&start), patience, &mut go_on)?;
            let error = d.history.last().map_or(0.0, |p| p.error);
            drop(spectrum);
            let known = robust.noise.is_some();
            robust = Robust { frames: d.frames, offsets, stopped: d.stopped, ..robust };
            if robust.stopped == StopReason::Asked {
                break;
            }
            let level_before = level;
            robust.noise = Some(self.noise(&robust.frames, &robust.offsets, &mut level));
            let settled = known && error > SETTLED * before && level > SETTLED * level_before;
            if known && error <= self.pod.tolerance || settled && patience == LONG {
                break;
            }
            if settled {
                patience = LONG;
            }
            before = error;
        }
        Ok(robust)
    }

    /// What the frames leave, where that is much.
    fn noise(&self, frames: &[Frame], offsets: &[Vector], before: &mut f64) -> Mat<f64> {
        let mut residual = self.residual(frames, offsets);
        let (m, n) = residual.shape();
        let explained = |i: usize, j: usize, left: f64| (self.snapshots[(i, j)] - left).abs();
        let mut largest = 0.0_f64;
        for j in 0..n {
            let column = residual.col_as_slice(j);
            largest = (0..m).fold(largest, |most, i| most.max(explained(i, j, column[i])));
        }
        // Where nothing is explained nothing is wrong.
        if largest == 0.0 {
            return Mat::zeros(m, n);
        }
        // Of all entries, and of those where there is something to carry along; of all snapshots, and of each, whose amplitudes may still be off.
        let stride = (m * n / TELLING).max(1);
        let mut all = [vec![], vec![]];
        let mut levels = vec![0.0_f64; n];
        for (j, level) in levels.iter_mut().enumerate() {
            let column = residual.col_as_slice(j);
            let some = || (j % stride..m).step_by(stride);
            let there = some().filter(|&i| explained(i, j, column[i]) > 0.02 * largest);
            let of_snapshot =
                [some().map(|i| column[i].abs()).collect(), there.map(|i| column[i].abs()).collect()];
            for (all, sizes) in all.iter_mut().zip::<[Vec<f64>; 2]>(of_snapshot) {
                all.extend_from_slice(&sizes);
                if sizes.len() >= FEW {
                    *level = level.max(WRONG_OF_ONE * deviation(sizes));
                }
            }
        }
        let all = all.map(deviation).into_iter().fold(0.0, f64::max);
        let floor = match *before {
            f64::INFINITY => 0.0,
            0.0 => CLEARLY * largest,
            before => SHRINK * before,
        };
        let least = (WRONG * all.max(1e-10 * self.snapshots.norm_max())).max(floor);
        *before = least;
        for (j, level) in levels.into_iter().enumerate() {
            let level = level.max(least);
            residual.col_as_slice_mut(j).iter_mut().filter(|x| x.abs() <= level).for_each(|x| *x = 0.0);
        }
        residual
    }

    /// Q − Σ_k T^k Q_k.
    pub(super) fn residual(&self, frames: &[Frame], offsets: &[Vector]) -> Mat<f64> {
        let (m, n) = self.snapshots.shape();
        let mut residual = self.snapshots.to_owned();
        let moved = Motions::beside(self.shifts, offsets);
        let Some(waves) = Waves::new(&self.pod.grid, &moved, m) else { return residual };
        let modes: Vec<_> = frames.iter().map(|f| waves.waves(f.modes.as_ref())).collect();
        let coefficients: Vec<_> = frames.iter().map(Frame::scaled_coefficients).collect();
        for first in (0..n).step_by(BATCH) {
            let count = BATCH.min(n - first);
            let part = waves.thinned(&(first..first + count).collect::<Vec<_>>());
            let mut sum = Mat::zeros(part.n_rows(), count);
            for (k, (modes, a)) in
                modes.iter().zip(&coefficients).enumerate().filter(|(_, m)| m.0.ncols() > 0)
            {
                let mut field = super::dense::product(modes.as_ref(), a.subcols(first, count));
                part.to_lab(k, field.as_mut());
                sum += &field;
            }
            let fields = part.fields(sum.as_ref());
            for j in 0..count {
                let to = residual.col_as_slice_mut(first + j);
                to.iter_mut().zip(fields.col_as_slice(j)).for_each(|(x, f)| *x -= f);
            }
        }
        residual
    }
}

/// Σ_k ‖Q_k‖_* + ‖E‖₁/√max(M, N), which true fields and wrong entries minimise under the conditions of
/// Candès, Li, Ma & Wright (2011). Frames that cancel one another have large singular values.
fn convex_size(d: &Decomposition) -> f64 {
    let nuclear: f64 = d.frames.iter().flat_map(|f| &f.singular_values).sum();
    let sparse = d.noise.as_ref().map_or(0.0, |e| e.norm_l1() / (e.nrows().max(e.ncols()) as f64).sqrt());
    nuclear + sparse
}

/// A snapshot with clearly more wrong entries than others have is one whose amplitudes are: what was taken for wrong there is to be fitted again.
fn release(noise: &mut Mat<f64>) {
    let counts: Vec<usize> = noise.col_iter().map(|c| c.iter().filter(|x| **x != 0.0).count()).collect();
    let mut order = counts.clone();
    order.sort_unstable();
    let usual = order.get(order.len() / 2).map_or(0.0, |&n| n as f64);
    for (j, _) in counts.iter().enumerate().filter(|(_, n)| **n as f64 > usual + 4.0 * usual.sqrt()) {
        noise.col_as_slice_mut(j).fill(0.0);
    }
}

/// Snapshots that are put together at a time.
const BATCH: usize = 32;

/// Modes besides wrong entries.
#[derive(Clone)]
struct Robust {
    frames: Vec<Frame>,
    noise: Option<Mat<f64>>,
    offsets: Vec<Vector>,
    stopped: StopReason,
}

/// To start from.
pub(super) fn started(frames: Vec<Frame>) -> Decomposition {
    Decomposition::of(frames, vec![], StopReason::Asked)
}

/// Frames with other modes.
fn carried(frames: Vec<Frame>, map: &dyn Fn(MatRef<'_, f64>) -> Mat<f64>) -> Vec<Frame> {
    frames.into_iter().map(|frame| Frame { modes: map(frame.modes.as_ref()), ..frame }).collect()
}
