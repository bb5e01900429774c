//! Descent on the residual over fields of given ranks.
use super::dense::columns;
use super::residual::{Course, Limits, Observer, Problem};
use super::tangent::{Base, Tangent};
use super::{Decomposition, Frame, FrameOperators, ShiftedError, StopReason};
use monomorphic::{Mat, MatRef};

/// Descent on J₂ = ½ ‖Q − Σ_k T^k Q_k‖² over all fields Q_k of given ranks at once (the functional of Reiss 2021).
///
/// Each step minimises it over the directions tangent to the fields of these ranks, all frames together, by conjugate gradients with
/// Levenberg's and Marquardt's damping, and goes to the nearest fields of these ranks. Modes and coefficients change together;
/// how unequal singular values are does not matter, how much the frames move against one another only by the root of it.
/// Nothing depends on the order of the frames.
#[derive(Clone, Debug, PartialEq)]
pub struct JointDescent {
    ranks: Vec<usize>,
    limits: Limits,
    ignored: Vec<(usize, usize)>,
    level: Option<f64>,
}

impl JointDescent {
    /// With so many modes in each frame; to a relative error of 1e-10, as long as a step makes the error smaller by 1e-4 of it, 100 steps
    /// at most.
    #[must_use]
    pub fn new(ranks: impl Into<Vec<usize>>) -> Self {
        let limits = Limits { tolerance: 1e-10, stagnation: 1e-4, max_steps: 100, settled: f64::INFINITY };
        Self { ranks: ranks.into(), limits, ignored: vec![], level: None }
    }

    /// Stops at this relative error.
    #[must_use]
    pub fn tolerance(mut self, error: f64) -> Self {
        self.limits.tolerance = error;
        self
    }

    /// Stops when a step makes the error smaller by less than this part of it.
    #[must_use]
    pub fn stagnation(mut self, part: f64) -> Self {
        self.limits.stagnation = part;
        self
    }

    /// Steps, at most.
    #[must_use]
    pub fn max_steps(mut self, steps: usize) -> Self {
        self.limits.max_steps = steps;
        self
    }

    /// These entries of the snapshots, row and column, are not known: the residual there does not count.
    #[must_use]
    pub fn ignoring(mut self, entries: impl Into<Vec<(usize, usize)>>) -> Self {
        self.ignored = entries.into();
        self
    }

    /// Huber's function (1964) of the residual's entries in place of ½ R²: level (|R| − ½ level) beyond
    /// ±level, by iteratively reweighted least squares.
    #[must_use]
    pub fn huber(mut self, level: f64) -> Self {
        self.level = Some(level);
        self
    }

    /// Decomposes snapshots, from nothing or from frames that are known already.
    ///
    /// # Errors
    /// [`ShiftedError::Empty`], [`ShiftedError::Snapshots`], [`ShiftedError::Unknowns`], [`ShiftedError::Ranks`],
    /// [`ShiftedError::NotFinite`]; [`ShiftedError::Entry`] if an ignored entry is none; [`ShiftedError::Parameter`] if Huber's level is
    /// not positive.
    pub fn solve(
        &self,
        operators: &dyn FrameOperators,
        snapshots: MatRef<'_, f64>,
        start: Option<&[Frame]>,
        observer: Observer<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        let problem = Problem::new(operators, snapshots)?.ignoring(&self.ignored)?;
        if let Some(value) = self.level.filter(|&level| !(level > 0.0 && level.is_finite())) {
            return Err(ShiftedError::Parameter { name: "Huber's level", value, limit: f64::INFINITY });
        }
        let ranks = problem.ranks(&self.ranks)?;
        let mut frames = problem.start(start)?;
        if frames.iter().zip(&ranks).any(|(frame, &rank)| frame.rank() != rank) {
            for _ in 0..2 {
                joint_step(&problem, &ranks, &mut frames);
            }
        }
        let least_squares = LeastSquares { problem, level: self.level };
        let mut course = Course::new(self.limits, observer)?;
        let (frames, stopped) = least_squares.descend(frames, &mut course);
        Ok(Decomposition::of(frames, course.history, stopped))
    }
}

/// Q_k ← [Q_k + (T^k)ᵀ (Q − Σ_l T^l Q_l) / K]_{r_k} for all K frames at once.
fn joint_step(problem: &Problem<'_>, ranks: &[usize], frames: &mut [Frame]) {
    let residual = problem.residual(frames);
    let n_frames = frames.len() as f64;
    for (k, (frame, &rank)) in frames.iter_mut().zip(ranks).enumerate() {
        let mut field = residual.clone();
        problem.operators.to_lab_transposed(k, field.as_mut());
        columns(&mut field).into_iter().flatten().for_each(|x| *x /= n_frames);
        frame.add_to(field.as_mut(), 1.0);
        *frame = Frame::truncated(field.as_ref(), rank);
    }
}

/// Entry by entry.
fn weigh(weights: Option<&Mat<f64>>, field: &mut Mat<f64>) {
    let Some(weights) = weights else { return };
    for (column, weights) in columns(field).into_iter().zip(weights.col_iter()) {
        column.iter_mut().zip(weights.iter()).for_each(|(x, w)| *x *= w);
    }
}

/// Conjugate gradients end at this part of the gradient, or after so many steps: with fewer, frames
/// that share a constant take up to four times as many outer steps.
const FORCING: f64 = 0.03;
const MAX_INNER: usize = 200;

/// ρ_δ(r) of a level δ (Huber 1964): ½ r² up to the level, δ (|r| − ½ δ) beyond.
pub(super) fn huber(r: f64, level: f64) -> f64 {
    let r = r.abs();
    if r <= level { 0.5 * r * r } else { level * (r - 0.5 * level) }
}

struct LeastSquares<'a> {
    problem: Problem<'a>,
    level: Option<f64>,
}

/// One direction per frame.
type Directions = Vec<Tangent>;

fn dot(a: &Directions, b: &Directions) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn combine(a: &mut Directions, keep: f64, factor: f64, b: &Directions) {
    a.iter_mut().zip(b).for_each(|(a, b)| a.combine(keep, factor, b));
}

impl LeastSquares<'_> {
    fn descend(&self, mut frames: Vec<Frame>, course: &mut Course<'_>) -> (Vec<Frame>, StopReason) {
        let mut residual = self.problem.residual(&frames);
        let mut size = self.size(&residual);
        let mut damping = 1e-3;
        loop {
            let weights = self.weights(&residual);
            weigh(weights.as_ref(), &mut residual);
            let bases: Vec<_> = frames.iter().map(Base::new).collect();
            let gradient = self.project(&bases, &residual);
            let better = loop {
                let (step, predicted) = self.minimise(&bases, weights.as_ref(), &gradient, damping);
                let trial: Vec<_> = bases.iter().zip(&step).map(|(b, s)| b.moved(s)).collect();
                let trial_residual = self.problem.residual(&trial);
                let trial_size = self.size(&trial_residual);
                let gain = (size - trial_size) * (size + trial_size) / (2.0 * predicted);
                if trial_size < size {
                    if gain > 0.75 {
                        damping = (damping / 5.0).max(1e-12);
                    } else if gain < 0.25 {
                        damping *= 4.0;
                    }
                    break Some((trial, trial_residual, trial_size));
                }
                damping *= 10.0;
                // What is left of an exact decomposition is round-off.
                if damping > 1e8 || predicted <= 1e-32 * self.problem.norm.powi(2) {
                    break None;
                }
            };
            let stagnant = better.is_none();
            if let Some(better) = better {
                (frames, residual, size) = better;
            } else {
                residual = self.problem.residual(&frames);
            }
            let [error, merit] = [residual.norm_l2(), size].map(|x| self.problem.relative(x));
            match course.note_merit(error, merit, &frames) {
                Some(stopped) => return (frames, stopped),
                None if stagnant => return (frames, StopReason::Stagnation),
                None => {}
            }
        }
    }

    /// ‖R‖, or the root of twice Huber's function.
    fn size(&self, residual: &Mat<f64>) -> f64 {
        let Some(level) = self.level else { return residual.norm_l2() };
        let twice = residual.col_iter().map(|c| c.iter().map(|&r| 2.0 * huber(r, level)).sum::<f64>());
        twice.sum::<f64>().sqrt()
    }

    /// Derivative of Huber's function over the residual.
    fn weights(&self, residual: &Mat<f64>) -> Option<Mat<f64>> {
        let level = self.level?;
        let weight = |i, j| level / level.max(f64::abs(residual[(i, j)]));
        Some(Mat::from_fn(residual.nrows(), residual.ncols(), weight))
    }

    /// Σ_k T^k ξ_k where entries are known.
    fn image(&self, bases: &[Base<'_>], weights: Option<&Mat<f64>>, directions: &Directions) -> Mat<f64> {
        let (m, n) = self.problem.snapshots.shape();
        let (mut sum, mut field) = (Mat::zeros(m, n), Mat::zeros(m, n));
        for (k, (base, direction)) in bases.iter().zip(directions).enumerate() {
            columns(&mut field).into_iter().for_each(|c| c.fill(0.0));
            base.add_to(direction, &mut field);
            self.problem.operators.to_lab(k, field.as_mut());
            sum += &field;
        }
        self.problem.forget(&mut sum);
        weigh(weights, &mut sum);
        sum
    }

    /// The tangent part of (T^k)ᵀ of a field for every k.
    fn project(&self, bases: &[Base<'_>], field: &Mat<f64>) -> Directions {
        let project = |(k, base): (usize, &Base<'_>)| {
            let mut field = field.clone();
            self.problem.operators.to_lab_transposed(k, field.as_mut());
            base.project(field.as_ref())
        };
        bases.iter().enumerate().map(project).collect()
    }

    /// The directions that minimise J₂ + ½ damping ‖ξ‖² nearly, and how much less that is than before.
    fn minimise(
        &self,
        bases: &[Base<'_>],
        weights: Option<&Mat<f64>>,
        gradient: &Directions,
        damping: f64,
    ) -> (Directions, f64) {
        let mut left = gradient.clone();
        let mut search = gradient.clone();
        let mut step = gradient.clone();
        combine(&mut step, 0.0, 0.0, gradient);
        let first = dot(&left, &left);
        let mut square = first;
        for _ in 0..MAX_INNER {
            if square <= FORCING * FORCING * first {
                break;
            }
            let image = self.image(bases, weights, &search);
            let mut curved = self.project(bases, &image);
            combine(&mut curved, 1.0, damping, &search);
            let curvature = dot(&search, &curved);
            if curvature <= 0.0 {
                break;
            }
            let length = square / curvature;
            combine(&mut step, 1.0, length, &search);
            combine(&mut left, 1.0, -length, &curved);
            let next = dot(&left, &left);
            combine(&mut search, next / square, 1.0, &left);
            square = next;
        }
        let predicted = 0.5 * (dot(&step, gradient) + dot(&step, &left));
        (step, predicted)
    }
}
