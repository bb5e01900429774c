//! What no frame carries yet.
use super::dense::columns;
use super::{Frame, FrameOperators, Progress, ShiftedError, StopReason};
use monomorphic::{Mat, MatRef};
use std::ops::ControlFlow;

/// Looks at an iteration after every step and may end it.
pub type Observer<'a> = &'a mut dyn FnMut(&Progress) -> ControlFlow<()>;

/// Snapshots, operators and what fits them.
pub(super) struct Problem<'a> {
    pub(super) operators: &'a dyn FrameOperators,
    pub(super) snapshots: MatRef<'a, f64>,
    pub(super) norm: f64,
    /// Entries that are not known.
    ignored: &'a [(usize, usize)],
}

impl<'a> Problem<'a> {
    /// # Errors
    /// [`ShiftedError::Empty`], [`ShiftedError::Shape`], [`ShiftedError::NotFinite`], [`ShiftedError::Size`].
    pub(super) fn new(
        operators: &'a dyn FrameOperators,
        snapshots: MatRef<'a, f64>,
    ) -> Result<Self, ShiftedError> {
        let (rows, columns) = snapshots.shape();
        if columns == 0 || rows == 0 || operators.n_frames() == 0 {
            return Err(ShiftedError::Empty { snapshots: columns, frames: operators.n_frames() });
        }
        if columns != operators.n_snapshots() {
            return Err(ShiftedError::Snapshots { snapshots: columns, shifts: operators.n_snapshots() });
        }
        if rows != operators.n_rows() {
            return Err(ShiftedError::Unknowns { rows, expected: operators.n_rows() });
        }
        let norm = check_entries(snapshots)?;
        Ok(Self { operators, snapshots, norm, ignored: &[] })
    }

    /// The same without these entries, row and column.
    ///
    /// # Errors
    /// [`ShiftedError::Entry`].
    pub(super) fn ignoring(mut self, entries: &'a [(usize, usize)]) -> Result<Self, ShiftedError> {
        let (rows, snapshots) = self.snapshots.shape();
        if let Some(&(row, snapshot)) = entries.iter().find(|&&(i, j)| i >= rows || j >= snapshots) {
            return Err(ShiftedError::Entry { row, snapshot, rows, snapshots });
        }
        let mut known = self.snapshots.to_owned();
        entries.iter().for_each(|&at| known[at] = 0.0);
        (self.ignored, self.norm) = (entries, known.norm_l2());
        Ok(self)
    }

    /// Zeros where nothing is known.
    pub(super) fn forget(&self, field: &mut Mat<f64>) {
        self.ignored.iter().for_each(|&at| field[at] = 0.0);
    }

    /// One rank per frame, none beyond what a matrix of this shape can have.
    pub(super) fn ranks(&self, ranks: &[usize]) -> Result<Vec<usize>, ShiftedError> {
        if ranks.len() != self.operators.n_frames() {
            return Err(ShiftedError::Ranks { ranks: ranks.len(), frames: self.operators.n_frames() });
        }
        let (m, n) = self.snapshots.shape();
        Ok(ranks.iter().map(|&r| r.min(m).min(n)).collect())
    }

    /// Nothing in all frames, or the frames to start from, as far as they have the shape of this problem.
    pub(super) fn start(&self, frames: Option<&[Frame]>) -> Result<Vec<Frame>, ShiftedError> {
        let (m, n) = self.snapshots.shape();
        let Some(frames) = frames else {
            return Ok(vec![Frame::nothing(m, n); self.operators.n_frames()]);
        };
        if frames.len() != self.operators.n_frames() {
            return Err(ShiftedError::Ranks { ranks: frames.len(), frames: self.operators.n_frames() });
        }
        for frame in frames {
            if frame.modes.nrows() != m {
                return Err(ShiftedError::Unknowns { rows: frame.modes.nrows(), expected: m });
            }
            if frame.coefficients.ncols() != n {
                return Err(ShiftedError::Snapshots { snapshots: n, shifts: frame.coefficients.ncols() });
            }
        }
        Ok(frames.to_vec())
    }

    /// Q − Σ_k T^k Q_k where it is known.
    pub(super) fn residual(&self, frames: &[Frame]) -> Mat<f64> {
        let mut residual = self.snapshots.to_owned();
        let mut field = Mat::zeros(residual.nrows(), residual.ncols());
        for (k, frame) in frames.iter().enumerate().filter(|(_, f)| f.rank() > 0) {
            columns(&mut field).into_iter().for_each(|c| c.fill(0.0));
            frame.add_to(field.as_mut(), -1.0);
            self.operators.to_lab(k, field.as_mut());
            residual += &field;
        }
        self.forget(&mut residual);
        residual
    }

    /// ‖residual‖ / ‖Q‖; of snapshots that are zero 0.
    pub(super) fn relative(&self, norm: f64) -> f64 {
        if self.norm > 0.0 { norm / self.norm } else { 0.0 }
    }
}

/// Norms of snapshots of which fourth powers, and 1e-64 of these, are normal numbers.
const NORMS: std::ops::RangeInclusive<f64> = 1e-60..=1e75;

/// ‖Q‖, whose fourth power and rounding errors of it are normal numbers unless it is 0.
///
/// # Errors
/// [`ShiftedError::NotFinite`], [`ShiftedError::Size`].
pub(super) fn check_entries(snapshots: MatRef<'_, f64>) -> Result<f64, ShiftedError> {
    for (snapshot, column) in snapshots.col_iter().enumerate() {
        if let Some((row, &value)) = column.iter().enumerate().find(|(_, x)| !x.is_finite()) {
            return Err(ShiftedError::NotFinite { snapshot, row, value });
        }
    }
    let (norm, largest) = (snapshots.norm_l2(), snapshots.norm_max());
    if largest == 0.0 || NORMS.contains(&norm) { Ok(norm) } else { Err(ShiftedError::Size { largest, norm }) }
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    /// Of the relative error.
    pub(super) tolerance: f64,
    /// A step that makes what is to be minimised smaller by less than this part is none.
    pub(super) stagnation: f64,
    pub(super) max_steps: usize,
    /// The tolerance does not count while a step changes what is to be minimised by more than this part.
    pub(super) settled: f64,
}

/// The way of an iteration, and whether it is at its end.
pub(super) struct Course<'a> {
    limits: Limits,
    observer: Observer<'a>,
    pub(super) history: Vec<Progress>,
    /// What is to be minimised, after every step.
    merits: Vec<f64>,
}

impl<'a> Course<'a> {
    /// # Errors
    /// [`ShiftedError::Tolerance`].
    pub(super) fn new(limits: Limits, observer: Observer<'a>) -> Result<Self, ShiftedError> {
        ShiftedError::check_tolerance("tolerance", limits.tolerance)?;
        if limits.stagnation.is_nan() {
            return Err(ShiftedError::Tolerance {
                name: "share of a step that is stagnation",
                value: f64::NAN,
            });
        }
        Ok(Self { limits, observer, history: vec![], merits: vec![] })
    }

    /// After a step that makes the error smaller.
    pub(super) fn note(&mut self, error: f64, frames: &[Frame]) -> Option<StopReason> {
        self.note_merit(error, error, frames)
    }

    /// After a step that makes something else smaller.
    pub(super) fn note_merit(&mut self, error: f64, merit: f64, frames: &[Frame]) -> Option<StopReason> {
        self.merits.push(merit);
        let rank = frames.iter().map(Frame::rank).sum();
        let progress = Progress { step: self.history.len() + 1, error, rank };
        self.history.push(progress);
        if (self.observer)(&progress).is_break() {
            return Some(StopReason::Asked);
        }
        let Limits { tolerance, stagnation, max_steps, settled } = self.limits;
        // Over three steps, so that one bad step is not the end.
        let before = self.merits.len().checked_sub(4).map(|i| self.merits[i]);
        let moving = before.map_or(settled.is_finite() && merit > 0.0, |before| {
            (before - merit).abs() > 3.0 * settled * before
        });
        if error <= tolerance && !moving {
            Some(StopReason::Tolerance)
        } else if before.is_some_and(|before| before - merit <= 3.0 * stagnation * before) {
            Some(StopReason::Stagnation)
        } else if self.history.len() >= max_steps {
            Some(StopReason::Steps)
        } else {
            None
        }
    }
}
