//! Fits of frames that only move, as [`HuberDescent`](super::huber_descent::HuberDescent) needs them.
use super::fourier::{Als, LONG};
use super::residual_parts::Parts;
use super::shifted_pod::Watch;
use super::translated::{BRIEF, Translated, started};
use super::waves::Waves;
use super::{Frame, FrameOperators, GridFrames, JointDescent, Motions, Progress, ShiftedError, StopReason};
use interfaces::Vector;
use monomorphic::{Mat, MatRef};

/// Fields M = Σ_k T^k Φ_k Σ_k A_k of frames.
#[derive(Clone)]
pub(super) struct Fields {
    pub(super) frames: Vec<Frame>,
    pub(super) offsets: Vec<Vector>,
    pub(super) stopped: StopReason,
}

impl Fields {
    pub(super) fn ranks(&self) -> Vec<usize> {
        self.frames.iter().map(Frame::rank).collect()
    }
}

/// Duration and regularisation of a least-squares fit.
#[derive(Clone, Copy)]
pub(super) struct Fit {
    /// To the tolerance of the decomposition; otherwise while steps lower the error by per cents.
    pub(super) full: bool,
    /// Weight of Σ_k ‖Q_k‖² against the squared error; no less than the default of [`Als`].
    pub(super) ridge: f64,
}

/// Share of the error by which three steps of a weighted fit must lower it.
const STAGNATION: f64 = 1e-3;

impl Translated<'_> {
    /// Fields of these ranks fitted to `data`, from `start` on.
    pub(super) fn fit(
        &self,
        data: MatRef<'_, f64>,
        start: Fields,
        ranks: &[usize],
        fit: Fit,
        watch: &mut Watch<'_>,
    ) -> Result<Fields, ShiftedError> {
        let part = Translated { snapshots: data, ..*self };
        let (spectrum, offsets) = part.spectrum(None)?;
        let patience = if fit.full { LONG } else { BRIEF };
        let als = self.als(ranks, self.pod.tolerance);
        let als = Als { ridge: fit.ridge.max(als.ridge), ..als };
        let mut go_on = |p: &Progress| watch.see(p).is_continue();
        let d = als.fit(&spectrum, Some(&started(start.frames)), patience, &mut go_on)?;
        Ok(Fields { frames: d.frames, offsets, stopped: d.stopped })
    }

    /// Fields at the minimum of Huber's function with a level, by weights of the entries.
    pub(super) fn reweighted(
        &self,
        fields: Fields,
        level: f64,
        ridge: f64,
        watch: &mut Watch<'_>,
    ) -> Result<Fields, ShiftedError> {
        let moved = Motions::beside(self.shifts, &fields.offsets);
        let rows = self.snapshots.nrows();
        let operators = GridFrames::new(self.pod.grid, self.pod.interpolation, &moved, rows)?;
        let descent = JointDescent::new(fields.ranks()).huber(level).ridge(ridge).tolerance(0.0);
        let descent = descent.stagnation(STAGNATION).max_steps(self.pod.max_steps);
        let start = Some(&fields.frames[..]);
        let d = descent.solve(&operators, self.snapshots, start, &mut |p| watch.see(p))?;
        Ok(Fields { frames: d.frames, stopped: d.stopped, ..fields })
    }

    /// Parts of a residual in each frame.
    pub(super) fn parts(&self, residual: &Mat<f64>, fields: &Fields) -> Vec<Parts> {
        let moved = Motions::beside(self.shifts, &fields.offsets);
        let waves = Waves::new(&self.pod.grid, &moved, residual.nrows()).expect("frames that move");
        let residual = waves.waves(residual.as_ref());
        let in_frame = |k: usize| {
            let mut field = residual.clone();
            waves.to_lab_transposed(k, field.as_mut());
            Parts::new(waves.fields(field.as_ref()), &fields.frames[k])
        };
        (0..self.shifts.n_frames()).map(in_frame).collect()
    }

    /// Fields without the modes that `data` does not need.
    pub(super) fn pruned(
        &self,
        data: MatRef<'_, f64>,
        fields: Fields,
        watch: &mut Watch<'_>,
    ) -> Result<Fields, ShiftedError> {
        let moved = Motions::beside(self.shifts, &fields.offsets);
        let part = Translated { pod: self.pod, shifts: &moved, snapshots: data };
        let most = fields.ranks();
        let (frames, stopped) = part.search(Some(fields.frames), &most, self.pod.rank_tolerance, watch)?;
        Ok(Fields { frames, stopped, ..fields })
    }
}
