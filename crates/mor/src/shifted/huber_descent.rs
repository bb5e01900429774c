//! Decomposition of snapshots some of whose entries are wrong.
use super::rank_search::{NORMAL, deviation, edge};
use super::shifted_pod::{Ranks, Watch};
use super::translated::Translated;
use super::translated_fit::{Fields, Fit};
use super::{Decomposition, Frame, ShiftedError, StopReason};
use interfaces::Vector;
use monomorphic::Mat;

/// Minimisation of Huber's function of the residual, whose level decreases to that of the noise.
///
/// min over M = Σ_k T^k Q_k of Σ ρ_δ(Q − M) + ½ w Σ_k ‖Q_k‖², where ρ_δ(r) = ½ r² if |r| ≤ δ and
/// δ (|r| − ½ δ) otherwise (Huber 1964). This is the minimum over M and E of
/// ½ ‖Q − E − M‖² + δ ‖E‖₁ + ½ w Σ_k ‖Q_k‖² (Geman & Yang 1995): E is Q − M less its part within ±δ, and
/// M is the least-squares fit to Q − E. Where these fits do not reach a stationary point, entries are
/// weighted by δ/|r| instead.
///
/// The level δ begins at the largest entry, where no entry is an outlier, and is halved, so that the
/// fields at one level begin near those at the next, down to 1.345 deviations of normal noise. At each
/// level, modes are added that stand out of the limited residual; the level stays above modes that must
/// not be added.
///
/// The weight w bounds the amplitudes of frames that cancel one another in a snapshot that hardly tells
/// them apart: their difference could take up its wrong entries. It changes the fields by no more than
/// the largest singular value of noise like the limited residual.
pub(super) struct HuberDescent<'a> {
    pub(super) problem: &'a Translated<'a>,
}

/// Level of Huber's function in deviations of normal noise: the estimate of a mean is 95 per cent
/// efficient (Huber 1964).
const EFFICIENT: f64 = 1.345;
/// Fields are stationary if the tangent part of the residual is below this share of the bound that a
/// mode must exceed.
const STATIONARY: f64 = 0.1;
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
        let pod = self.problem.pod;
        let offsets = vec![Vector::zeros(); start.len()];
        let fields = Fields { frames: start, offsets, stopped: StopReason::Steps };
        let residual = self.problem.residual(&fields.frames, &fields.offsets);
        let level = residual.norm_max();
        let mut state = State { fields, residual, level };
        let most = match &pod.ranks {
            Ranks::Given(ranks) => ranks.clone(),
            Ranks::Found => {
                let most = vec![pod.max_rank; state.fields.frames.len()];
                state = self.descend(state, &most, pod.rank_tolerance, watch)?;
                if !state.asked_to_stop() {
                    let known = self.problem.snapshots - state.beyond(self.bound(&state));
                    let fields = self.problem.pruned(known.as_ref(), state.fields.clone(), watch)?;
                    state = self.with_fields(state, fields);
                }
                state.fields.ranks()
            }
        };
        if !state.asked_to_stop() {
            state = self.descend(state, &most, pod.tolerance, watch)?;
        }
        let bound = self.bound(&state);
        if !state.asked_to_stop() {
            state = self.refit(state, &most, bound, watch)?;
        }
        let noise = Some(state.beyond(bound));
        let Fields { frames, offsets, stopped } = state.fields;
        Ok(Decomposition { noise, offsets, ..Decomposition::of(frames, vec![], stopped) })
    }

    fn with_fields(&self, state: State, fields: Fields) -> State {
        let residual = self.problem.residual(&fields.frames, &fields.offsets);
        State { fields, residual, ..state }
    }

    /// Lowers the level to that of the noise, of modes that must not be added, or of an error that is
    /// small enough; or until, at two levels, the same entries are wrong, none but these is beyond the
    /// level, and the error without them reaches the tolerance for which ranks are found.
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
            let explained = self.explained(&state);
            let good = size <= sufficient * explained;
            let mode = self.standing_out(&mut state, watch)?;
            if state.asked_to_stop() {
                return Ok(state);
            }
            if let Some((k, mode)) = mode {
                let frame = &mut state.fields.frames[k];
                if good || frame.rank() >= most[k] {
                    return Ok(state);
                }
                *frame = frame.plus(&mode);
                continue;
            }
            let noise = EFFICIENT * self.deviation(&state.residual);
            let bound = self.bound(&state);
            let count = state.count_beyond(bound);
            let alone = (count > 0 && count == state.count_beyond(state.level)).then_some(count);
            let others = (&state.residual - state.beyond(bound)).norm_l2();
            let complete = others <= self.problem.pod.rank_tolerance * explained;
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
        for _ in 0..self.problem.pod.max_steps {
            let within = state.limited();
            let resolved = edge(within.norm_l2(), [m, n]);
            let data = self.problem.snapshots - &state.residual + within;
            let fit = Fit { full: false, ridge: self.ridge(&state, resolved) };
            let fields = self.problem.fit(data.as_ref(), state.fields.clone(), &ranks, fit, watch)?;
            let next = self.with_fields(state.clone(), fields);
            let change = (&next.residual - &state.residual).norm_l2();
            state = next;
            if state.asked_to_stop() || change <= resolved {
                break;
            }
        }
        let within = state.limited();
        let parts = self.problem.parts(&within, &state.fields);
        if !state.asked_to_stop() && parts.iter().any(|p| p.tangent > STATIONARY * p.noise) {
            let ridge = self.ridge(&state, edge(within.norm_l2(), [m, n]));
            state = self.reweighted(state, ridge, watch)?;
        }
        Ok(state)
    }

    fn reweighted(&self, state: State, ridge: f64, watch: &mut Watch<'_>) -> Result<State, ShiftedError> {
        let fields = self.problem.reweighted(state.fields.clone(), state.level, ridge, watch)?;
        Ok(self.with_fields(state, fields))
    }

    /// ‖M‖.
    fn explained(&self, state: &State) -> f64 {
        (self.problem.snapshots - &state.residual).norm_l2()
    }

    /// Weight w that changes M by `change` in norm where frames are told apart.
    fn ridge(&self, state: &State, change: f64) -> f64 {
        change / self.explained(state).max(state.level).max(f64::MIN_POSITIVE)
    }

    /// The largest mode of the limited residual that is not noise, and its frame. It stands out of the
    /// settled fields and of those with a weight that changes them by one entry of the limited residual:
    /// the bias of settled fields can look like a mode.
    fn standing_out(
        &self,
        state: &mut State,
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
        let less_biased = self.reweighted(state.clone(), self.ridge(state, entry), watch)?;
        if less_biased.asked_to_stop() {
            state.fields.stopped = StopReason::Asked;
        }
        Ok(largest(&less_biased))
    }

    /// Least-squares fits without the entries beyond a bound, until the fields do not change; the settled
    /// fields if those are nearer to the snapshots in the sense of Huber's function.
    fn refit(
        &self,
        settled: State,
        ranks: &[usize],
        bound: f64,
        watch: &mut Watch<'_>,
    ) -> Result<State, ShiftedError> {
        let wrong = settled.beyond(bound);
        let mut state = settled.clone();
        for _ in 0..self.problem.pod.max_steps {
            let r = &state.residual;
            let left_out = |i, j| if wrong[(i, j)] == 0.0 { 0.0 } else { r[(i, j)] };
            let data = self.problem.snapshots - Mat::from_fn(r.nrows(), r.ncols(), left_out);
            let fit = Fit { full: true, ridge: 0.0 };
            let fields = self.problem.fit(data.as_ref(), state.fields.clone(), ranks, fit, watch)?;
            let next = self.with_fields(state.clone(), fields);
            let change = (&next.residual - &state.residual).norm_l2();
            state = next;
            if state.asked_to_stop() || change <= self.problem.pod.tolerance * data.norm_l2() {
                break;
            }
        }
        let better = state.asked_to_stop() || state.huber() <= settled.huber();
        Ok(if better { state } else { settled })
    }

    /// Residual that only wrong entries exceed: the largest of as many normal numbers (Donoho & Johnstone
    /// 1994), of the deviation of the noise or of that at which the level is efficient.
    fn bound(&self, state: &State) -> f64 {
        let entries = (state.residual.nrows() * state.residual.ncols()) as f64;
        (2.0 * entries.ln()).sqrt() * self.deviation(&state.residual).max(state.level / EFFICIENT)
    }

    /// Deviation of the noise from the median of the residual's entries; or, if that is larger, from
    /// their median weighted by the fields, most of whose entries may be zero.
    fn deviation(&self, residual: &Mat<f64>) -> f64 {
        let entries = || {
            let columns = residual.col_iter().zip(self.problem.snapshots.col_iter());
            columns.flat_map(|(r, q)| {
                r.iter().zip(q.iter()).map(|(r, q)| (r.abs(), (q - r).abs())).collect::<Vec<_>>()
            })
        };
        deviation(entries().map(|e| e.0).collect()).max(NORMAL * weighted_median(entries().collect()))
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
