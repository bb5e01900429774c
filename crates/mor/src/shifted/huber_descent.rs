//! Decomposition of snapshots some of whose entries are wrong.
use super::rank_search::{NORMAL, deviation, edge};
use super::shifted_pod::{Ranks, Watch};
use super::translated::Translated;
use super::translated_fit::{Fields, Fit};
use super::{Decomposition, Frame, ShiftedError, ShiftedPod, StopReason};
use interfaces::Vector;
use monomorphic::{Mat, MatRef};

/// Minimisation of Huber's function of the residual, whose level decreases to that of the noise.
///
/// min over M = Σ_k T^k Q_k of Σ ρ_δ(Q − M) + ½ w Σ_k ‖Q_k‖², where ρ_δ(r) = ½ r² if |r| ≤ δ and
/// δ (|r| − ½ δ) otherwise (Huber 1964). It is also min over M and E of ½ ‖Q − E − M‖² + δ ‖E‖₁ + …
/// (Geman & Yang 1995): E = Q − M less what of it is within ±δ, and M is the least-squares fit to Q − E.
/// Where such fits do not reach the minimum, entries are weighted by δ/|r| instead.
///
/// The level δ begins at the largest entry, where nothing is an outlier, and is halved, so that the fields
/// at one level begin near those at the next, down to 1.345 deviations of normal noise. At each
/// level, modes are added that stand out of the limited residual; the level stays above modes that must not be added.
///
/// The weight w keeps frames from cancelling one another where a snapshot hardly tells them apart, so
/// that their difference takes its wrong entries up. It changes the fields by no more than the largest
/// singular value of noise like the limited residual.
pub(super) struct HuberDescent<'a> {
    pub(super) pod: &'a ShiftedPod,
    pub(super) problem: &'a Translated<'a>,
    pub(super) snapshots: MatRef<'a, f64>,
}

/// Level of Huber's function in deviations of normal noise: the estimate of a mean is 95 per cent
/// efficient (Huber 1964).
const EFFICIENT: f64 = 1.345;
/// Fields are stationary if the tangent part of the residual is below this share of what a mode must exceed.
const STATIONARY: f64 = 0.1;
/// Entries that a deviation is estimated from, about.
const SAMPLES: usize = 1 << 20;

/// Fields at a level, and what they leave.
#[derive(Clone)]
struct State {
    fields: Fields,
    /// Q − M.
    residual: Mat<f64>,
    /// δ.
    level: f64,
}

impl State {
    /// The residual's entries limited to ±δ.
    fn limited(&self) -> Mat<f64> {
        let r = &self.residual;
        Mat::from_fn(r.nrows(), r.ncols(), |i, j| r[(i, j)].clamp(-self.level, self.level))
    }

    /// The residual's entries beyond ±`bound`; zeros elsewhere.
    fn beyond(&self, bound: f64) -> Mat<f64> {
        let r = &self.residual;
        let entry = |x: f64| if x.abs() > bound { x } else { 0.0 };
        Mat::from_fn(r.nrows(), r.ncols(), |i, j| entry(r[(i, j)]))
    }

    /// Number of the residual's entries beyond ±`bound`.
    fn count_beyond(&self, bound: f64) -> usize {
        self.residual.col_iter().map(|c| c.iter().filter(|r| r.abs() > bound).count()).sum()
    }

    /// Σ ρ_δ(Q − M).
    fn huber(&self) -> f64 {
        let level = self.level;
        let rho = |r: f64| if r <= level { 0.5 * r * r } else { level * (r - 0.5 * level) };
        self.residual.col_iter().map(|c| c.iter().map(|r| rho(r.abs())).sum::<f64>()).sum()
    }

    fn asked_to_stop(&self) -> bool {
        self.fields.stopped == StopReason::Asked
    }
}

impl HuberDescent<'_> {
    /// From these frames on, which may be empty.
    pub(super) fn solve(
        &self,
        start: Vec<Frame>,
        watch: &mut Watch<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        let offsets = vec![Vector::zeros(); start.len()];
        let fields = Fields { frames: start, offsets, stopped: StopReason::Steps };
        let residual = self.problem.residual(&fields.frames, &fields.offsets);
        let level = residual.norm_max();
        let mut state = State { fields, residual, level };
        let most = match &self.pod.ranks {
            Ranks::Given(ranks) => ranks.clone(),
            Ranks::Found => {
                let most = vec![self.pod.max_rank; state.fields.frames.len()];
                state = self.descend(state, &most, self.pod.rank_tolerance, watch)?;
                if !state.asked_to_stop() {
                    let known = self.snapshots - state.beyond(self.bound(&state));
                    state.fields = self.problem.pruned(known.as_ref(), state.fields, watch)?;
                    state.residual = self.problem.residual(&state.fields.frames, &state.fields.offsets);
                }
                state.fields.ranks()
            }
        };
        if !state.asked_to_stop() {
            state = self.descend(state, &most, self.pod.tolerance, watch)?;
        }
        let bound = self.bound(&state);
        let mut noise = state.beyond(bound);
        if !state.asked_to_stop() {
            state = self.refit(state, &most, bound, watch)?;
            noise = state.beyond(bound);
        }
        let Fields { frames, offsets, stopped } = state.fields;
        Ok(Decomposition { noise: Some(noise), offsets, ..Decomposition::of(frames, vec![], stopped) })
    }

    /// Lowers the level to that of the noise, of modes that must not be added, or of an error that is
    /// small enough; or until the error of the others is, and the entries beyond it are wrong, all of them,
    /// and the same ones at two levels.
    fn descend(
        &self,
        mut state: State,
        most: &[usize],
        sufficient: f64,
        watch: &mut Watch<'_>,
    ) -> Result<State, ShiftedError> {
        let mut separate = None;
        loop {
            state = self.settle(state, watch)?;
            let size = state.limited().norm_l2();
            if state.asked_to_stop() || size == 0.0 {
                return Ok(state);
            }
            let explained = (self.snapshots - &state.residual).norm_l2();
            let good = size <= sufficient * explained;
            if let Some((k, mode)) = self.standing_out(&state, watch)? {
                let frame = &mut state.fields.frames[k];
                if good || frame.rank() >= most[k] {
                    return Ok(state);
                }
                *frame = frame.plus(&mode);
                continue;
            }
            let noise = EFFICIENT * self.deviation(&state.residual);
            let wrong = state.beyond(self.bound(&state));
            let count = wrong.col_iter().map(|c| c.iter().filter(|x| **x != 0.0).count()).sum::<usize>();
            let alone = (count > 0 && count == state.count_beyond(state.level)).then_some(count);
            let others = (&state.residual - wrong).norm_l2();
            let complete = others <= self.pod.rank_tolerance * explained;
            if good || noise >= state.level || complete && alone.is_some() && alone == separate {
                return Ok(state);
            }
            separate = alone;
            state.level = noise.max(0.5 * state.level);
        }
    }

    /// The minimum at the level.
    fn settle(&self, mut state: State, watch: &mut Watch<'_>) -> Result<State, ShiftedError> {
        let (m, n) = state.residual.shape();
        let ranks = state.fields.ranks();
        if ranks.iter().all(|&rank| rank == 0) {
            return Ok(state);
        }
        for _ in 0..self.pod.max_steps {
            let within = state.limited();
            let resolved = edge(within.norm_l2(), [m, n]);
            let data = self.snapshots - &state.residual + within;
            let fit = Fit { full: false, ridge: resolved / data.norm_l2() };
            state.fields = self.problem.fit(data.as_ref(), state.fields, &ranks, fit, watch)?;
            let before = std::mem::replace(
                &mut state.residual,
                self.problem.residual(&state.fields.frames, &state.fields.offsets),
            );
            if state.asked_to_stop() || (&state.residual - before).norm_l2() <= resolved {
                break;
            }
        }
        let within = state.limited();
        let parts = self.problem.parts(&within, &state.fields);
        if !state.asked_to_stop() && parts.iter().any(|p| p.tangent > STATIONARY * p.noise) {
            let fields = (self.snapshots - &state.residual).norm_l2();
            let ridge = edge(within.norm_l2(), [m, n]) / fields.max(f64::MIN_POSITIVE);
            state = self.reweighted(state, ridge, watch)?;
        }
        Ok(state)
    }

    fn reweighted(&self, mut state: State, ridge: f64, watch: &mut Watch<'_>) -> Result<State, ShiftedError> {
        state.fields = self.problem.reweighted(state.fields, state.level, ridge, watch)?;
        state.residual = self.problem.residual(&state.fields.frames, &state.fields.offsets);
        Ok(state)
    }

    /// The largest mode of the limited residual that is not noise, and its frame, also if the fields change by no more
    /// than one entry of the limited residual by regularisation: the bias of settled ones can look like a mode.
    fn standing_out(
        &self,
        state: &State,
        watch: &mut Watch<'_>,
    ) -> Result<Option<(usize, Frame)>, ShiftedError> {
        let largest = |state: &State| {
            let parts = self.problem.parts(&state.limited(), &state.fields).into_iter().enumerate();
            let sigma = |mode: &Frame| mode.singular_values.first().copied().unwrap_or_default();
            let clear = parts.filter(|(_, p)| sigma(&p.mode) > p.noise).map(|(k, p)| (k, p.mode));
            clear.max_by(|(_, a), (_, b)| sigma(a).total_cmp(&sigma(b)))
        };
        let mode = largest(state);
        if mode.is_none() || state.fields.frames.iter().all(|f| f.rank() == 0) {
            return Ok(mode);
        }
        let (m, n) = state.residual.shape();
        let entry = state.limited().norm_l2() / ((m * n) as f64).sqrt();
        let ridge = entry / (self.snapshots - &state.residual).norm_l2().max(f64::MIN_POSITIVE);
        let state = self.reweighted(state.clone(), ridge, watch)?;
        Ok(largest(&state))
    }

    /// Least-squares fits without the entries beyond a bound, until the fields do not change.
    fn refit(
        &self,
        mut state: State,
        ranks: &[usize],
        bound: f64,
        watch: &mut Watch<'_>,
    ) -> Result<State, ShiftedError> {
        let settled = state.clone();
        let wrong = state.beyond(bound);
        let is_wrong = |i, j| wrong[(i, j)] != 0.0;
        for _ in 0..self.pod.max_steps {
            let r = &state.residual;
            let left_out = |i, j| if is_wrong(i, j) { r[(i, j)] } else { 0.0 };
            let data = self.snapshots - Mat::from_fn(r.nrows(), r.ncols(), left_out);
            let fit = Fit { full: true, ridge: 0.0 };
            state.fields = self.problem.fit(data.as_ref(), state.fields, ranks, fit, watch)?;
            let before = std::mem::replace(
                &mut state.residual,
                self.problem.residual(&state.fields.frames, &state.fields.offsets),
            );
            let change = (&state.residual - before).norm_l2();
            if state.asked_to_stop() || change <= self.pod.tolerance * data.norm_l2() {
                break;
            }
        }
        // Too few entries are left of some snapshots.
        Ok(if state.huber() <= settled.huber() { state } else { settled })
    }

    /// Residual that only wrong entries exceed: that of the largest of as many normal numbers (Donoho & Johnstone
    /// 1994), of the deviation of the noise or of that at which the level is efficient.
    fn bound(&self, state: &State) -> f64 {
        let entries = (state.residual.nrows() * state.residual.ncols()) as f64;
        (2.0 * entries.ln()).sqrt() * self.deviation(&state.residual).max(state.level / EFFICIENT)
    }

    /// Deviation of the noise from the median of the residual's entries; or, if that is larger, from
    /// their median weighted by the fields, which most entries may be zero of.
    fn deviation(&self, residual: &Mat<f64>) -> f64 {
        let fields = |i: usize, j: usize| (self.snapshots[(i, j)] - residual[(i, j)]).abs();
        let (m, n) = residual.shape();
        let stride = (m * n / SAMPLES).max(1);
        let entries: Vec<_> = (0..n)
            .flat_map(|j| (j % stride..m).step_by(stride).map(move |i| (i, j)))
            .map(|(i, j)| (residual[(i, j)].abs(), fields(i, j)))
            .collect();
        deviation(entries.iter().map(|e| e.0).collect()).max(NORMAL * weighted_median(entries))
    }
}

/// Value that half of the weight is below.
fn weighted_median(mut entries: Vec<(f64, f64)>) -> f64 {
    entries.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * entries.iter().map(|e| e.1).sum::<f64>();
    let mut sum = 0.0;
    let above = |e: &&(f64, f64)| {
        sum += e.1;
        sum >= half
    };
    entries.iter().find(above).map_or(0.0, |e| e.0)
}
