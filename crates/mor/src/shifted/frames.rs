//! The operators that carry fields along with frames of reference, on whole matrices of snapshots.
use interfaces::Vector;
use monomorphic::{Mat, MatMut, MatRef};

/// T^{Δ_k(t_j)} for every frame k and snapshot j. Whoever implements it may carry fields along in any way.
pub trait FrameOperators: Sync {
    /// Unknowns of a snapshot.
    fn n_rows(&self) -> usize;
    /// Snapshots.
    fn n_snapshots(&self) -> usize;
    /// Frames of reference.
    fn n_frames(&self) -> usize;
    /// Column j becomes T^{Δ_k(t_j)} of it: from frame k, where what it carries is at rest, to where it was seen.
    fn to_lab(&self, frame: usize, fields: MatMut<'_, f64>);
    /// The inverse of [`to_lab`](Self::to_lab), as well as the interpolation allows.
    fn to_frame(&self, frame: usize, fields: MatMut<'_, f64>);
    /// The transpose of [`to_lab`](Self::to_lab). Shifts of periodic grids by whole cells and by phases are orthogonal: there it is the inverse.
    fn to_lab_transposed(&self, frame: usize, fields: MatMut<'_, f64>);
    /// T^{Δ + c} for a frame that is c beside where it should be: what [`Decomposition::offsets`] asks for. Only [`GridFrames`](super::GridFrames) are asked for
    /// any c but zero, for which it is [`to_lab`](Self::to_lab).
    fn to_lab_beside(&self, frame: usize, _offset: Vector, fields: MatMut<'_, f64>) {
        self.to_lab(frame, fields);
    }
}

/// What one frame carries: Q_k = Φ Σ A, in the frame.
#[derive(Clone, Debug)]
pub struct Frame {
    /// φ_i, orthonormal columns.
    pub modes: Mat<f64>,
    /// σ_i, descending.
    pub singular_values: Vec<f64>,
    /// a_i(t_j), orthonormal rows.
    pub coefficients: Mat<f64>,
}

impl Frame {
    /// How many modes it has.
    #[must_use]
    pub fn rank(&self) -> usize {
        self.singular_values.len()
    }

    /// σ_i a_i(t_j): what interpolation in time is asked for.
    #[must_use]
    pub fn scaled_coefficients(&self) -> Mat<f64> {
        let a = &self.coefficients;
        Mat::from_fn(a.nrows(), a.ncols(), |i, j| self.singular_values[i] * a[(i, j)])
    }

    /// Φ Σ A.
    #[must_use]
    pub fn field(&self) -> Mat<f64> {
        &self.modes * self.scaled_coefficients()
    }
}

/// Why an iteration stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// The error is as small as was asked for.
    Tolerance,
    /// The error does not get smaller any more.
    Stagnation,
    /// All steps that were allowed are done.
    Steps,
    /// Who looks on asked for it.
    Asked,
}

/// Where an iteration is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Steps done.
    pub step: usize,
    /// ‖Q − Σ_k T^k Q_k − E‖ / ‖Q‖, in Frobenius' norm.
    pub error: f64,
    /// Modes in all frames together.
    pub rank: usize,
}

/// Snapshots as a sum over frames.
#[derive(Clone, Debug)]
pub struct Decomposition {
    /// One by one.
    pub frames: Vec<Frame>,
    /// c of each frame: it moves by Δ_k + c_k, so that what it carries is at rest at the centres of cells ([`centred`](super::fourier::centred)); zero but for
    /// frames that [`ShiftedPod`](super::ShiftedPod) found to be better so.
    pub offsets: Vec<Vector>,
    /// E, what no frame carries, if it was asked for.
    pub noise: Option<Mat<f64>>,
    /// After every step.
    pub history: Vec<Progress>,
    /// Why there are no more.
    pub stopped: StopReason,
    /// Fits that were tried besides the first, as that was stuck; the best of all is told.
    pub attempts: usize,
}

impl Decomposition {
    /// Where frames are, without a noise.
    pub(super) fn of(frames: Vec<Frame>, history: Vec<Progress>, stopped: StopReason) -> Self {
        let offsets = vec![Vector::zeros(); frames.len()];
        Self { frames, offsets, noise: None, history, stopped, attempts: 0 }
    }

    /// Modes of each frame.
    #[must_use]
    pub fn ranks(&self) -> Vec<usize> {
        self.frames.iter().map(Frame::rank).collect()
    }

    /// Σ_k T^k Q_k, without the noise.
    #[must_use]
    pub fn fields(&self, operators: &dyn FrameOperators) -> Mat<f64> {
        let mut sum = Mat::zeros(operators.n_rows(), operators.n_snapshots());
        for (k, frame) in self.frames.iter().enumerate().filter(|(_, f)| f.rank() > 0) {
            let mut field = frame.field();
            operators.to_lab_beside(k, self.offsets[k], field.as_mut());
            sum += field;
        }
        sum
    }

    /// ‖Q − Σ_k T^k Q_k‖ / ‖Q‖, in Frobenius' norm.
    #[must_use]
    pub fn relative_error(&self, operators: &dyn FrameOperators, snapshots: MatRef<'_, f64>) -> f64 {
        (snapshots - self.fields(operators)).norm_l2() / snapshots.norm_l2()
    }
}
