//! The multi-frame iteration.
use super::residual::{Course, Limits, Observer, Problem};
use super::{Decomposition, Frame, FrameOperators, ShiftedError, StopReason};
use monomorphic::{Mat, MatRef};

/// The iteration over frames of Reiss, Schulze, Sesterhenn & Mehrmann (2018): what is left of the snapshots is brought into one frame after
/// the other, added to what is there, and the sum cut to its leading modes,
///
/// Q_k ← [Q_k + (T^k)ᵀ (Q − Σ_l T^l Q_l)]_{r_k},
///
/// the residual anew for each frame. The error never grows where no operator lengthens a field. It converges linearly, the more
/// slowly the less the frames move against one another; [`JointDescent`](super::JointDescent) is faster from there on.
#[derive(Clone, Debug, PartialEq)]
pub struct MultiFrame {
    ranks: Vec<usize>,
    limits: Limits,
}

impl MultiFrame {
    /// With so many modes in each frame; to a relative error of 1e-10, as long as a step makes the error smaller by 1e-4 of it, 200 steps
    /// at most.
    #[must_use]
    pub fn new(ranks: impl Into<Vec<usize>>) -> Self {
        Self {
            ranks: ranks.into(),
            limits: Limits { tolerance: 1e-10, stagnation: 1e-4, max_steps: 200, settled: f64::INFINITY },
        }
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

    /// Decomposes snapshots, from nothing or from frames that are known already.
    ///
    /// # Errors
    /// [`ShiftedError::Empty`], [`ShiftedError::Snapshots`], [`ShiftedError::Unknowns`], [`ShiftedError::Ranks`],
    /// [`ShiftedError::NotFinite`].
    pub fn solve(
        &self,
        operators: &dyn FrameOperators,
        snapshots: MatRef<'_, f64>,
        start: Option<&[Frame]>,
        observer: Observer<'_>,
    ) -> Result<Decomposition, ShiftedError> {
        let problem = Problem::new(operators, snapshots)?;
        let ranks = problem.ranks(&self.ranks)?;
        let mut frames = problem.start(start)?;
        let mut course = Course::new(self.limits, observer)?;
        let stopped = iterate(&problem, &ranks, &mut frames, &mut course);
        Ok(Decomposition::of(frames, course.history, stopped))
    }
}

/// Until the course is at its end. Entries that are not known are taken from the frames.
pub(super) fn iterate(
    problem: &Problem<'_>,
    ranks: &[usize],
    frames: &mut [Frame],
    course: &mut Course<'_>,
) -> StopReason {
    let mut residual = problem.residual(frames);
    loop {
        for (k, frame) in frames.iter_mut().enumerate() {
            let mut field = residual.clone();
            problem.operators.to_lab_transposed(k, field.as_mut());
            frame.add_to(field.as_mut(), 1.0);
            let new = Frame::truncated(field.as_ref(), ranks[k]);
            // What changes, in the frame.
            let mut change = Mat::zeros(residual.nrows(), residual.ncols());
            frame.add_to(change.as_mut(), 1.0);
            new.add_to(change.as_mut(), -1.0);
            problem.operators.to_lab(k, change.as_mut());
            residual += change;
            problem.forget(&mut residual);
            *frame = new;
        }
        if let Some(stopped) = course.note(problem.relative(residual.norm_l2()), frames) {
            return stopped;
        }
    }
}
