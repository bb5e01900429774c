//! Ranks and noise by convex optimisation.
use super::algorithms::{crossing_waves, quiet};
use super::random;
use crate::shifted::{Interpolation, JointDescent, Proximal, ShiftedError, StopReason};
use monomorphic::Mat;

/// Zeros and ones in a part of the entries.
pub(super) fn salt_and_pepper(clean: &Mat<f64>, part: f64, seed: u64) -> Mat<f64> {
    let numbers = random(clean.nrows() * clean.ncols(), seed);
    Mat::from_fn(clean.nrows(), clean.ncols(), |i, j| {
        let u = 0.5 + 0.5 * numbers[i + clean.nrows() * j];
        if u < 0.5 * part {
            0.0
        } else if u < part {
            1.0
        } else {
            clean[(i, j)]
        }
    })
}

#[test]
fn the_augmented_lagrangian_finds_ranks() {
    let (op, q) = crossing_waves(Interpolation::Spectral);
    let d =
        Proximal::augmented_lagrangian().tolerance(1e-5).solve(&op, q.as_ref(), None, &mut quiet).unwrap();
    assert_eq!((d.ranks(), d.stopped), (vec![1, 1], StopReason::Tolerance));
    let error = d.relative_error(&op, q.as_ref());
    assert!(error <= 1e-5 && (error / d.history.last().unwrap().error - 1.0).abs() < 1e-6, "{error:.2e}");
}

#[test]
fn the_augmented_lagrangian_takes_noise_out() {
    let (op, clean) = crossing_waves(Interpolation::Spectral);
    let q = salt_and_pepper(&clean, 0.05, 3);
    let d = Proximal::augmented_lagrangian()
        .with_noise()
        .tolerance(1e-5)
        .solve(&op, q.as_ref(), None, &mut quiet)
        .unwrap();
    let error = d.relative_error(&op, clean.as_ref());
    // The noise is 0.8 of the waves.
    assert!((&q - &clean).norm_l2() > 0.7 * clean.norm_l2());
    assert!(error < 1.5e-3 && d.ranks() == [1, 1], "{error:.2e} {:?}", d.ranks());
    let sum = d.fields(&op) + d.noise.as_ref().unwrap();
    assert!((sum - &q).norm_l2() < 1e-5 * q.norm_l2());
}

#[test]
fn forward_and_backward_steps_find_ranks() {
    let (op, q) = crossing_waves(Interpolation::Spectral);
    let norm = q.norm_l2();
    let [joint, block] = [Proximal::joint(), Proximal::block()].map(|p| {
        let d = p.solve(&op, q.as_ref(), None, &mut quiet).unwrap();
        assert_eq!(d.ranks(), [1, 1], "{:?} {:?}", d.stopped, d.history.len());
        // Where it is at rest, each singular value is too small by λ_s = 0.02 ‖Q‖.
        let error = d.relative_error(&op, q.as_ref());
        assert!((error / (0.02 * 2_f64.sqrt()) - 1.0).abs() < 0.02, "{error:.2e}");
        let refined = JointDescent::new([1, 1]).solve(&op, q.as_ref(), Some(&d.frames), &mut quiet).unwrap();
        assert!(refined.relative_error(&op, q.as_ref()) < 1e-9);
        d
    });
    assert!(block.history.len() < joint.history.len());
    let difference = (joint.fields(&op) - block.fields(&op)).norm_l2() / norm;
    assert!(difference < 2e-3, "{difference:.2e}");
}

#[test]
fn steps_that_are_too_long_are_told() {
    let (op, q) = crossing_waves(Interpolation::Spectral);
    let solve = |p: Proximal| p.solve(&op, q.as_ref(), None, &mut quiet).err();
    let told = |e: Option<ShiftedError>, expected: &str, at: f64| matches!(e, Some(ShiftedError::Parameter { name, limit, .. }) if name == expected && limit == at);
    assert!(told(solve(Proximal::joint().with_noise().step(0.7)), "the step", 2.0 / 3.0));
    assert!(told(solve(Proximal::block().step(2.0)), "the step", 2.0));
    assert!(told(solve(Proximal::block().step(f64::NAN)), "the step", 2.0));
    assert!(told(solve(Proximal::augmented_lagrangian().multiplier(-1.0)), "the multiplier", f64::INFINITY));
    assert!(told(solve(Proximal::joint().low_rank(0.0)), "the weight of the nuclear norm", f64::INFINITY));
    assert!(told(solve(Proximal::joint().sparse(0.0)), "the weight of the noise", f64::INFINITY));
}

#[test]
fn nothing_is_decomposed_into_nothing() {
    let (op, _) = crossing_waves(Interpolation::Spectral);
    let q = Mat::zeros(400, 200);
    for p in [Proximal::augmented_lagrangian(), Proximal::joint(), Proximal::block()] {
        let d = p.with_noise().solve(&op, q.as_ref(), None, &mut quiet).unwrap();
        assert_eq!((d.ranks(), d.stopped), (vec![0, 0], StopReason::Tolerance));
    }
}
