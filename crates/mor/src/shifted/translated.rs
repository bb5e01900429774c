//! Frames that only move along periodic axes: all in the space of wave vectors.
use super::fourier::{Als, LONG, Spectrum, offsets};
use super::huber_descent::HuberDescent;
use super::rank_search::{Found, RankSearch};
use super::residual::{Observer, Problem};
use super::shifted_pod::{Ranks, Watch};
use super::thinning::{MANY, SOME, Thinned, thinned};
use super::translated_fit::Fields;
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

/// Snapshots that tell modes beside wrong entries, if there are more.
const TELLING: usize = 200;
/// In a brief fit so many steps lower the error by at least this part.
pub(super) const BRIEF: (usize, f64) = (3, 0.05);

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

    /// As many modes as are needed but no more than `most`, roughly fitted, in frames that are
    /// where they should be.
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

    /// Decomposition beside wrong entries. If there are many snapshots, some tell the modes.
    fn sparse(
        &self,
        start: Option<Vec<Frame>>,
        watch: &mut Watch<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        let (m, n) = self.snapshots.shape();
        let start = start.unwrap_or_else(|| vec![Frame::nothing(m, n); self.shifts.n_frames()]);
        let mut d = if n <= TELLING {
            HuberDescent::new(self).solve(start, watch)?
        } else {
            let (some, few) = thinned(self.snapshots, TELLING);
            let shifts = Thinned { shifts: self.shifts, snapshots: &some };
            let part = Translated { pod: self.pod, shifts: &shifts, snapshots: few.as_ref() };
            let start = start.iter().map(|frame| frame.at(&some)).collect();
            let (fields, level) = HuberDescent::new(&part).modes(start, watch)?;
            let frames = fields.frames.iter().map(|frame| frame.between(&some, n)).collect();
            let mut d = HuberDescent::new(self).finish(Fields { frames, ..fields }, level, watch)?;
            if d.stopped == StopReason::Tolerance && more_wrong_between(&d, &some) {
                d.stopped = StopReason::Stagnation;
            }
            d
        };
        // The last step has the error of the fit that is returned.
        if d.stopped != StopReason::Asked {
            let mut left = self.residual(&d.frames, &d.offsets);
            if let Some(noise) = &d.noise {
                left -= noise;
            }
            let error = left.norm_l2() / self.snapshots.norm_l2().max(f64::MIN_POSITIVE);
            let rank = d.frames.iter().map(Frame::rank).sum();
            if watch.see(&Progress { step: 0, error, rank }).is_break() {
                d.stopped = StopReason::Asked;
            }
        }
        Ok(Decomposition { history: watch.take(), ..d })
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

/// A snapshot between those that tell the modes has more wrong entries than any of them, by four
/// deviations of such a number: it holds a mode that they do not show.
fn more_wrong_between(d: &Decomposition, some: &[usize]) -> bool {
    let Some(noise) = &d.noise else { return false };
    let wrong = |j: usize| noise.col(j).iter().filter(|x| **x != 0.0).count() as f64;
    let most = some.iter().map(|&j| wrong(j)).fold(0.0, f64::max);
    (0..noise.ncols()).any(|j| wrong(j) > most + 4.0 * most.sqrt())
}

/// Snapshots that are put together at a time.
const BATCH: usize = 32;

/// To start from.
pub(super) fn started(frames: Vec<Frame>) -> Decomposition {
    Decomposition::of(frames, vec![], StopReason::Asked)
}

/// Frames with other modes.
fn carried(frames: Vec<Frame>, map: &dyn Fn(MatRef<'_, f64>) -> Mat<f64>) -> Vec<Frame> {
    frames.into_iter().map(|frame| Frame { modes: map(frame.modes.as_ref()), ..frame }).collect()
}
