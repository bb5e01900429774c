//! Cross-validation of whole models.
use super::assessment::Sums;
use super::{Assessment, ModelError, Podiann, Spodiann, SpodiannParams};
use crate::interpolation::{
    FitObserver, FitProgress, FitStage, Folds, InterpolationError, Method, unobserved,
};
use crate::pod::{Pod, PodParams};
use crate::shifted::{
    Decomposition, Grid, Interpolation, Motions, Observer, Progress, ShiftedError, Shifts, StopReason,
};
use crate::{Mat, MatRef};
use std::ops::ControlFlow;

/// Errors of models at snapshots that are left out of their modes and their coefficients.
///
/// For each set S of the folds a model is made of the snapshots not in S, and assessed at those of
/// S: e_S = (Σ_{j ∈ S} ‖q_j − q̂_j‖² / Σ_{j ∈ S} ‖q_j‖²)^½ in the Euclidean norm, whatever the
/// weights of the modes. With one snapshot in each set (leave-one-out) it is ‖q_j − q̂_j‖/‖q_j‖.
/// EZyRB (Demo, Tezzele & Rozza 2018) states the mean of these ratios over a set (`kfold_cv_error`,
/// `loo_error`), in which small snapshots count as much as large ones.
///
/// Runs and times at an end are predicted by extrapolation, which is linear
/// ([`Extrapolation`](super::Extrapolation)).
#[derive(Clone, Debug, PartialEq)]
pub struct ModelValidation {
    /// Errors of each set.
    pub folds: Vec<Assessment>,
    /// Errors of all sets together: both sums are over all of them.
    pub total: Assessment,
}

/// Decomposes snapshots (rows × m) that are carried along by shifts, such as by
/// [`ShiftedPod::solve`](crate::shifted::ShiftedPod::solve).
pub type Decompose<'a> =
    &'a mut dyn FnMut(&dyn Shifts, MatRef<'_, f64>, Observer<'_>) -> Result<Decomposition, ShiftedError>;

/// Cross-validates a [`Podiann`] of snapshots (rows × m) at points (inputs × m), with a POD and
/// coefficients of its own for each set of the folds.
///
/// # Errors
/// [`ModelError::Shape`]; [`ModelError::Interpolation`] if a set is empty, has all snapshots or one
/// that is not there; those of [`Pod::new`] and [`Podiann::new`] with the snapshots not left out.
pub fn validate_podiann(
    data: (MatRef<'_, f64>, MatRef<'_, f64>),
    pod: &PodParams,
    method: Option<&dyn Method>,
    folds: &Folds,
) -> Result<ModelValidation, ModelError> {
    validate_podiann_observed(data, pod, method, folds, &mut unobserved)
}

/// The same with an observer: [`FitStage::Fold`] for each set, in it [`FitStage::Modes`] and the
/// stages of [`Podiann::new_observed`].
///
/// # Errors
/// As [`validate_podiann`]; [`InterpolationError::Stopped`] by the observer.
pub fn validate_podiann_observed(
    (points, snapshots): (MatRef<'_, f64>, MatRef<'_, f64>),
    pod: &PodParams,
    method: Option<&dyn Method>,
    folds: &Folds,
    observer: FitObserver<'_>,
) -> Result<ModelValidation, ModelError> {
    ModelError::same("snapshots, one for each point", points.ncols(), snapshots.ncols())?;
    validate(points.ncols(), folds, observer, &mut |others, set, observer| {
        let [known, left_out] = [others, set].map(|which| (part(points, which), part(snapshots, which)));
        FitProgress::new(FitStage::Modes, 1, 1).report(&mut *observer)?;
        let pod = Pod::new(known.1.as_ref(), pod)?;
        let model = Podiann::new_observed(known.0.as_ref(), &pod, method, observer)?;
        model.sums(left_out.0.as_ref(), left_out.1.as_ref())
    })
}

/// Cross-validates a [`Spodiann`] of snapshots (rows × m) at points (inputs × m) that were carried
/// along by `shifts` on a grid, with a decomposition, coefficients and paths of its own for each
/// set of the folds. The projection is that in frames at the motions given; the prediction moves
/// them along the interpolated paths.
///
/// # Errors
/// As [`validate_podiann`], and those of `decompose` and [`Spodiann::new`].
pub fn validate_spodiann(
    data: (MatRef<'_, f64>, MatRef<'_, f64>),
    how: (Grid, Interpolation),
    shifts: &dyn Shifts,
    decompose: Decompose<'_>,
    params: SpodiannParams<'_>,
    folds: &Folds,
) -> Result<ModelValidation, ModelError> {
    validate_spodiann_observed(data, how, shifts, decompose, params, folds, &mut unobserved)
}

/// The same with an observer: [`FitStage::Fold`] for each set, in it [`FitStage::Modes`] after
/// every step of the decomposition, with its error as the loss, and the stages of
/// [`Spodiann::new_observed`].
///
/// # Errors
/// As [`validate_spodiann`]; [`InterpolationError::Stopped`] by the observer.
pub fn validate_spodiann_observed(
    (points, snapshots): (MatRef<'_, f64>, MatRef<'_, f64>),
    how: (Grid, Interpolation),
    shifts: &dyn Shifts,
    decompose: Decompose<'_>,
    params: SpodiannParams<'_>,
    folds: &Folds,
    observer: FitObserver<'_>,
) -> Result<ModelValidation, ModelError> {
    ModelError::same("snapshots, one for each point", points.ncols(), snapshots.ncols())?;
    ModelError::same("motions of every frame, one for each point", points.ncols(), shifts.n_snapshots())?;
    validate(points.ncols(), folds, observer, &mut |others, set, observer| {
        let [known, left_out] = [others, set].map(|which| (part(points, which), part(snapshots, which)));
        let [motions, motions_left_out] = [others, set].map(|which| {
            Motions::by(shifts.n_frames(), which.len(), |frame, j| shifts.motion(frame, which[j]))
        });
        let mut is_stopped = false;
        let found = decompose(&motions, known.1.as_ref(), &mut |progress: &Progress| {
            let stage = FitProgress::new(FitStage::Modes, progress.step, None).with_loss(progress.error);
            is_stopped = stage.report(&mut *observer).is_err();
            if is_stopped { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        if is_stopped || found.stopped == StopReason::Asked {
            return Err(InterpolationError::Stopped.into());
        }
        let model = Spodiann::new_observed(known.0.as_ref(), &found, how, &motions, params, observer)?;
        model.sums(left_out.0.as_ref(), left_out.1.as_ref(), &motions_left_out)
    })
}

/// Errors at a set of snapshots of the model of the others.
type Fold<'a> = &'a mut dyn FnMut(&[usize], &[usize], FitObserver<'_>) -> Result<Sums, ModelError>;

fn validate(
    m: usize,
    folds: &Folds,
    observer: FitObserver<'_>,
    fold: Fold<'_>,
) -> Result<ModelValidation, ModelError> {
    folds.check(m)?;
    let (mut sums, mut all) = (Sums::default(), Vec::new());
    for (k, set) in folds.sets().iter().enumerate() {
        let mut is_left_out = vec![false; m];
        set.iter().for_each(|&j| is_left_out[j] = true);
        let others: Vec<usize> = (0..m).filter(|&j| !is_left_out[j]).collect();
        let stage = FitProgress::new(FitStage::Fold, k + 1, folds.sets().len());
        let of_set = stage.run(&mut *observer, |observer| fold(&others, set, observer))?;
        sums += of_set;
        all.push(of_set.assessment());
    }
    Ok(ModelValidation { folds: all, total: sums.assessment() })
}

/// Some of the columns.
fn part(all: MatRef<'_, f64>, which: &[usize]) -> Mat<f64> {
    Mat::from_fn(all.nrows(), which.len(), |i, j| all[(i, which[j])])
}

#[cfg(test)]
mod tests;
