//! Decomposition of snapshots some of whose entries are wrong.
use super::anderson::Anderson;
use super::fourier::LONG;
use super::rank_search::{NORMAL, deviation, edge};
use super::shifted_pod::{Ranks, Watch};
use super::translated::{BRIEF, Translated};
use super::translated_fit::Fields;
use super::{Decomposition, Frame, ShiftedError, StopReason};
use interfaces::Vector;
use monomorphic::Mat;

/// Minimisation of Huber's function of the residual, whose level decreases until the entries that
/// are wrong are told from the others.
///
/// min over M = Σ_k T^k Q_k of Σ ρ_δ(Q − M) + ½ w Σ_k ‖Q_k‖², where ρ_δ(r) = ½ r² if |r| ≤ δ and δ
/// (|r| − ½ δ) otherwise (Huber 1964). This is the minimum over M and E of ½ ‖Q − E − M‖² + δ ‖E‖₁ +
/// ½ w Σ_k ‖Q_k‖² (Geman & Yang 1995): E is Q − M less its part within ±δ, and M is the
/// least-squares fit to Q − E.
///
/// The level δ begins at the largest entry, where no entry is an outlier, and is lowered by
/// decades, so that the fields at one level begin near those at the next. At each level a
/// least-squares fit without the entries beyond it follows, which has no bias by them (least
/// trimmed squares, Rousseeuw 1984). If that fit reaches the error that is sufficient, these
/// entries hold all wrong ones. If not, a mode is added that stands out of both residuals limited
/// to ±δ; if none does, the level is lowered, to no less than 1.345 deviations of the noise.
///
/// A snapshot that hardly tells frames apart would lend them its wrong entries: where they cancel
/// one another, it is left out until the modes are known. In the end the amplitudes of all
/// snapshots are fitted to the modes, which has one minimum only.
pub(super) struct HuberDescent<'a> {
    problem: &'a Translated<'a>,
    /// Q, zero in snapshots that are left out.
    known: Mat<f64>,
    left_out: Vec<usize>,
}

/// Level of Huber's function in deviations of normal noise: the estimate of a mean is 95 per cent
/// efficient (Huber 1964).
const EFFICIENT: f64 = 1.345;
/// Fields are settled when a step changes them by no more than this share of what counts.
const SETTLED: f64 = 0.1;
/// Factor from one level to the next.
const LOWERED: f64 = 0.1;
/// Frames cancel one another in a snapshot if the sum of their squares is so many times that of
/// their sum.
const CANCELLING: f64 = 2.0;
/// Share of the snapshots that are left out, at most.
const FEW: f64 = 0.1;

/// Fields at a level, and their residual.
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

    fn asked_to_stop(&self) -> bool {
        self.fields.stopped == StopReason::Asked
    }

    /// Snapshot in which frames cancel one another most, if they do: it hardly tells them apart.
    fn cancelling(&self, known: &Mat<f64>, left_out: &[usize]) -> Option<usize> {
        let ratio = |j: usize| {
            let field = (known.col(j) - self.residual.col(j)).squared_norm_l2();
            let square = |f: &Frame| {
                let terms = f.singular_values.iter().zip(f.coefficients.col(j).iter());
                terms.map(|(sigma, a)| (sigma * a).powi(2)).sum::<f64>()
            };
            let frames: f64 = self.fields.frames.iter().map(square).sum();
            if frames > 0.0 { frames / field } else { 0.0 }
        };
        let told = (0..known.ncols()).filter(|j| !left_out.contains(j));
        let (j, most) = told.map(|j| (j, ratio(j))).max_by(|a, b| a.1.total_cmp(&b.1))?;
        (most > CANCELLING).then_some(j)
    }
}

/// Function of the residual's entries.
enum Loss {
    /// ρ_δ.
    Huber { level: f64 },
    /// ½ r² of all but those entries where `wrong` is not zero; the norm of the others is as small
    /// as need be.
    Trimmed { wrong: Mat<f64>, sufficient: f64 },
}

impl Loss {
    /// Residual without which the loss is that of least squares.
    fn outliers(&self, residual: &Mat<f64>) -> Mat<f64> {
        let outlier = |i, j| {
            let r = residual[(i, j)];
            match self {
                Self::Huber { level } => r - r.clamp(-level, *level),
                Self::Trimmed { wrong, .. } if wrong[(i, j)] == 0.0 => 0.0,
                Self::Trimmed { .. } => r,
            }
        };
        Mat::from_fn(residual.nrows(), residual.ncols(), outlier)
    }

    /// Value for a residual with these outliers and this norm of the others.
    fn value(&self, outliers: &Mat<f64>, right: f64) -> f64 {
        match self {
            Self::Huber { level } => 0.5 * right * right + level * outliers.norm_l1(),
            Self::Trimmed { .. } => 0.5 * right * right,
        }
    }
}

impl<'a> HuberDescent<'a> {
    pub(super) fn new(problem: &'a Translated<'a>) -> Self {
        Self { problem, known: problem.snapshots.to_owned(), left_out: vec![] }
    }

    /// Decomposition from these frames on, which may be empty.
    pub(super) fn solve(
        mut self,
        start: Vec<Frame>,
        watch: &mut Watch<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        let (fields, level) = self.modes(start, watch)?;
        self.finish(fields, level, watch)
    }

    /// Fields, zero in snapshots that are left out, and the level of the entries that are right.
    pub(super) fn modes(
        &mut self,
        start: Vec<Frame>,
        watch: &mut Watch<'_>,
    ) -> Result<(Fields, f64), ShiftedError> {
        let pod = self.problem.pod;
        let offsets = vec![Vector::zeros(); start.len()];
        let fields = Fields { frames: start, offsets, stopped: StopReason::Steps };
        let mut state = self.state(fields, 0.0);
        state.level = state.residual.norm_max();
        let most = match &pod.ranks {
            Ranks::Given(ranks) => ranks.clone(),
            Ranks::Found => {
                let most = vec![pod.max_rank; state.fields.frames.len()];
                state = self.descend(state, &most, pod.rank_tolerance, watch)?;
                if !state.asked_to_stop() {
                    let right = &self.known - state.beyond(self.bound(&state));
                    let fields = self.problem.pruned(right.as_ref(), state.fields, watch)?;
                    state = self.state(fields, state.level);
                }
                state.fields.ranks()
            }
        };
        if !state.asked_to_stop() {
            state = self.descend(state, &most, pod.tolerance, watch)?;
        }
        Ok((state.fields, state.level))
    }

    /// Amplitudes of all snapshots at these modes, then a least-squares fit without the entries
    /// that are off by more than noise of the level.
    pub(super) fn finish(
        mut self,
        fields: Fields,
        level: f64,
        watch: &mut Watch<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        self.known = self.problem.snapshots.to_owned();
        let mut state = self.state(fields, level);
        let mut bound = self.bound(&state);
        if !state.asked_to_stop() {
            let fields = self.problem.with_amplitudes(state.fields, bound);
            state = self.state(fields, level);
            bound = self.bound(&state);
            let tolerance = self.problem.pod.tolerance;
            let (trimmed, kept) = self.trimmed(&state, bound, tolerance, watch)?;
            let reached = kept.norm_l2() <= tolerance * self.explained(&trimmed);
            state = trimmed;
            if !state.asked_to_stop() {
                state.fields.stopped = if reached { StopReason::Tolerance } else { StopReason::Stagnation };
            }
        }
        let noise = Some(state.beyond(bound));
        let Fields { frames, offsets, stopped } = state.fields;
        Ok(Decomposition { noise, offsets, ..Decomposition::of(frames, vec![], stopped) })
    }

    fn state(&self, fields: Fields, level: f64) -> State {
        let part = Translated { snapshots: self.known.as_ref(), ..*self.problem };
        let residual = part.residual(&fields.frames, &fields.offsets);
        State { fields, residual, level }
    }

    /// Lowers the level until the entries beyond it hold all wrong ones, or to that of the noise.
    /// The level returned is that of the entries that are right.
    fn descend(
        &mut self,
        mut state: State,
        most: &[usize],
        sufficient: f64,
        watch: &mut Watch<'_>,
    ) -> Result<State, ShiftedError> {
        loop {
            state = self.settled(state, watch)?;
            if state.asked_to_stop() || state.residual.norm_max() == 0.0 {
                return Ok(state);
            }
            let many = (self.left_out.len() + 1) as f64 > FEW * self.known.ncols() as f64;
            if let Some(j) = state.cancelling(&self.known, &self.left_out).filter(|_| !many) {
                state = self.leave_out(state, j);
                continue;
            }
            let (trimmed, kept) = self.trimmed(&state, state.level, sufficient, watch)?;
            if trimmed.asked_to_stop() || kept.norm_l2() <= sufficient * self.explained(&trimmed) {
                return Ok(State { level: kept.norm_max(), ..trimmed });
            }
            if let Some((k, mode)) = self.standing_out(&state, &trimmed, most) {
                state.fields.frames[k] = state.fields.frames[k].plus(&mode);
                continue;
            }
            let noise = EFFICIENT * self.deviation(&trimmed.residual);
            if noise >= state.level {
                return Ok(state);
            }
            state.level = noise.max(LOWERED * state.level);
        }
    }

    /// Minimum of Huber's function at the level. The weight w changes M by less than a step that
    /// counts, where frames are told apart.
    fn settled(&self, state: State, watch: &mut Watch<'_>) -> Result<State, ShiftedError> {
        let (m, n) = state.residual.shape();
        let change = SETTLED * edge(state.limited().norm_l2(), [m, n]);
        let ridge = change / self.explained(&state).max(state.level).max(f64::MIN_POSITIVE);
        self.minimum(&Loss::Huber { level: state.level }, ridge, state, watch)
    }

    /// Least-squares fit without the entries beyond a bound, and what it leaves of the others.
    fn trimmed(
        &self,
        state: &State,
        bound: f64,
        sufficient: f64,
        watch: &mut Watch<'_>,
    ) -> Result<(State, Mat<f64>), ShiftedError> {
        let sufficient = sufficient * self.explained(state);
        let loss = Loss::Trimmed { wrong: state.beyond(bound), sufficient };
        let state = self.minimum(&loss, 0.0, state.clone(), watch)?;
        let kept = &state.residual - loss.outliers(&state.residual);
        Ok((state, kept))
    }

    /// Minimum of a loss and ½ w Σ_k ‖Q_k‖² by fits M to Q − E, with E the outliers of Q − M.
    fn minimum(
        &self,
        loss: &Loss,
        ridge: f64,
        mut state: State,
        watch: &mut Watch<'_>,
    ) -> Result<State, ShiftedError> {
        let ranks = state.fields.ranks();
        if ranks.iter().all(|&rank| rank == 0) {
            return Ok(state);
        }
        let (m, n) = state.residual.shape();
        let mut wrong = loss.outliers(&state.residual);
        let mut mixing = Anderson::default();
        let mut least = f64::INFINITY;
        let mut patience = BRIEF;
        for _ in 0..self.problem.pod.max_steps {
            let data = &self.known - &wrong;
            let start = state.fields.clone();
            let fields = self.problem.fit(data.as_ref(), start, &ranks, ridge, patience, watch)?;
            drop(data);
            let trial = self.state(fields, state.level);
            if trial.asked_to_stop() {
                return Ok(trial);
            }
            let next = loss.outliers(&trial.residual);
            let right = (&trial.residual - &next).norm_l2();
            let value = loss.value(&next, right) + 0.5 * ridge * trial.fields.square();
            if value > least {
                // A mixture can be worse than the step it is made of.
                if mixing.is_empty() {
                    break;
                }
                mixing = Anderson::default();
                wrong = loss.outliers(&state.residual);
                continue;
            }
            (state, least) = (trial, value);
            let change = &next - &wrong;
            let (counts, last) = match loss {
                Loss::Huber { .. } => (edge(right, [m, n]), BRIEF),
                Loss::Trimmed { sufficient, .. } if right <= *sufficient => break,
                Loss::Trimmed { .. } => (right, LONG),
            };
            if change.norm_l2() <= SETTLED * counts {
                if patience == last {
                    break;
                }
                patience = last;
            }
            wrong = mixing.next(next, change);
        }
        Ok(state)
    }

    /// Zeros in place of a snapshot.
    fn leave_out(&mut self, state: State, j: usize) -> State {
        self.left_out.push(j);
        self.known.col_as_slice_mut(j).fill(0.0);
        let State { mut fields, level, .. } = state;
        for frame in &mut fields.frames {
            (0..frame.rank()).for_each(|i| frame.coefficients[(i, j)] = 0.0);
        }
        self.state(fields, level)
    }

    /// ‖M‖.
    fn explained(&self, state: &State) -> f64 {
        (&self.known - &state.residual).norm_l2()
    }

    /// The largest mode that stands out of the limited residual, and its frame. It must stand out
    /// without the bias of settled fields, too, which can look like a mode.
    fn standing_out(&self, settled: &State, trimmed: &State, most: &[usize]) -> Option<(usize, Frame)> {
        let largest = |state: &State| {
            let parts = self.problem.parts(&state.limited(), &state.fields).into_iter().enumerate();
            let sigma = |mode: &Frame| mode.singular_values.first().copied().unwrap_or_default();
            let open = parts.filter(|(k, _)| state.fields.frames[*k].rank() < most[*k]);
            let clear = open.filter(|(_, p)| sigma(&p.mode) > p.noise).map(|(k, p)| (k, p.mode));
            clear.max_by(|(_, a), (_, b)| sigma(a).total_cmp(&sigma(b)))
        };
        largest(settled).and_then(|_| largest(trimmed))
    }

    /// Residual that only wrong entries exceed: the largest of as many normal numbers (Donoho &
    /// Johnstone 1994), of the deviation of the noise or of that at which the level is efficient.
    fn bound(&self, state: &State) -> f64 {
        let entries = (state.residual.nrows() * state.residual.ncols()) as f64;
        (2.0 * entries.ln()).sqrt() * self.deviation(&state.residual).max(state.level / EFFICIENT)
    }

    /// Deviation of the noise from the median of the residual's entries; or, if that is larger,
    /// from their median weighted by the fields, most of whose entries may be zero.
    fn deviation(&self, residual: &Mat<f64>) -> f64 {
        let entries = || {
            let columns = residual.col_iter().zip(self.known.col_iter());
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
