//! Closed forms against fits, errors that are known.
use super::*;
use crate::interpolation::{Degree, Kernel, NetworkParams, RbfParams, Shape, SplineParams};
use crate::{Mat, MatRef};
use proptest::prelude::*;

fn line(m: usize, f: impl Fn(f64) -> f64) -> Samples {
    let x: Vec<f64> = (0..m).map(|i| i as f64 / (m - 1) as f64).collect();
    let values = Mat::from_fn(2, m, |row, i| if row == 0 { f(x[i]) } else { 0.0 });
    Samples::of_one_input(&x, values.as_ref()).unwrap()
}

#[test]
fn errors_are_relative_and_their_place_is_known() {
    // Linear splines err by h²|f″|/2 at a sample that is left out, with distances h to both sides.
    let samples = line(11, |x| x * x);
    let linear = SplineParams::new(Degree::Linear);
    let found = cross_validate(&linear, &samples, &Folds::leave_one_out_inside(&samples)).unwrap();
    let norm = (1..10).map(|i| (f64::from(i) / 10.0).powi(4)).sum::<f64>().sqrt();
    assert!((found.error - 0.01 * 3.0 / norm).abs() < 1e-14, "{found:?}");
    assert!((found.per_output[0] - found.error).abs() < 1e-16 && found.per_output[1] == 0.0);
    assert!((found.worst.0 - 0.01).abs() < 1e-15 && found.predictions == 9);
    // At the ends they extrapolate: the last one errs by 2 h².
    let found = cross_validate(&linear, &samples, &Folds::leave_one_out(&samples)).unwrap();
    assert!((found.worst.0 - 0.02).abs() < 1e-14 && [0, 10].contains(&found.worst.1), "{found:?}");
}

/// The trait's own way, whatever a method has instead.
struct ByFitting<'a>(&'a dyn Method);

impl Method for ByFitting<'_> {
    fn name(&self) -> String {
        self.0.name()
    }
    fn fit_observed(
        &self,
        s: &Samples,
        observer: FitObserver<'_>,
    ) -> Result<Box<dyn crate::interpolation::Interpolator>, InterpolationError> {
        self.0.fit_observed(s, observer)
    }
}

#[test]
fn radial_functions_need_no_fits() {
    let points = Mat::from_fn(2, 30, |i, j| [(j % 6) as f64, (j / 6) as f64 + 0.1 * (j as f64).sin()][i]);
    let values = Mat::from_fn(2, 30, |row, j| (0.7 * points[(row, j)] + 0.3 * points[(1 - row, j)]).sin());
    let samples = Samples::new(points.as_ref(), values.as_ref()).unwrap();
    // The extent stays when samples between the ends are left out: the same scaled coordinates.
    let folds = Folds::random(&samples, 4, 2).unwrap();
    for kernel in Kernel::ALL {
        let method = RbfParams::new(kernel).with_shape(Shape::Fixed(0.9));
        let closed = method.left_out(&samples, &folds, &mut unobserved).unwrap();
        let fitted = ByFitting(&method).left_out(&samples, &folds, &mut unobserved).unwrap();
        for (closed, fitted) in closed.iter().zip(&fitted) {
            let off = (closed - fitted).norm_max();
            assert!(
                closed.shape() == fitted.shape() && off < 1e-8 * fitted.norm_max(),
                "{kernel:?}: {off:e}"
            );
        }
    }
}

#[test]
fn what_cannot_be_left_out_is_said() {
    let samples = line(8, |x| x);
    let method = SplineParams::new(Degree::Quintic);
    let folds = Folds::interleaved(&samples, 2).unwrap();
    let error = cross_validate(&method, &samples, &folds).unwrap_err();
    assert!(matches!(error, InterpolationError::TooFew { needed: 6, found: 5, .. }), "{error}");
    let error = cross_validate(&method, &samples, &folds.some(0)).unwrap_err();
    assert!(matches!(error, InterpolationError::TooFew { needed: 1, found: 0, .. }), "{error}");
    let one = samples.subset(&[2]).unwrap();
    let all = Folds::leave_one_out(&one);
    let error = cross_validate(&NetworkParams::new(&[3]), &one, &all).unwrap_err();
    assert!(matches!(error, InterpolationError::Empty { samples: 0, .. }), "{error}");
    // As many monomials as samples: nothing is left to leave out.
    let cubic = RbfParams::new(Kernel::Cubic);
    let two = samples.subset(&[2, 5]).unwrap();
    let error = cross_validate(&cubic, &two, &Folds::leave_one_out(&two)).unwrap_err();
    assert!(matches!(error, InterpolationError::Singular { .. }), "{error}");
}

proptest! {
    #[test]
    fn splines_predict_polynomials_of_their_degree(
        c in prop::collection::vec(-1.0..1.0f64, 6), m in 9..40usize, degree in 0..3usize
    ) {
        let degree = Degree::ALL[degree];
        let f = |x: f64| c[..=degree.get()].iter().rev().fold(0.0, |sum, c| sum * x + c);
        let samples = line(m, f);
        let folds = Folds::leave_one_out(&samples);
        let errors = SplineParams::new(degree).left_out(&samples, &folds, &mut unobserved).unwrap();
        let largest = errors.iter().map(|of: &Mat<f64>| of.norm_max()).fold(0.0, f64::max);
        prop_assert!(largest < 1e-10, "{largest:e}");
    }
    #[test]
    fn errors_do_not_depend_on_units(factor in 1e-6..1e6f64) {
        let samples = line(12, |x| (3.0 * x).sin());
        let scaled = Mat::from_fn(2, 12, |i, j| factor * samples.values()[(i, j)]);
        let points: MatRef<'_, f64> = samples.points();
        let other = Samples::new(points, scaled.as_ref()).unwrap();
        let folds = Folds::interleaved(&samples, 3).unwrap();
        let error = |s: &Samples| cross_validate(&SplineParams::new(Degree::Cubic), s, &folds).unwrap().error;
        prop_assert!((error(&samples) / error(&other) - 1.0).abs() < 1e-9);
    }
}
