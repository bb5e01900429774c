//! Samples and polynomials reproduced, leave-one-out by brute force, files.
use super::*;
use crate::interpolation::load;
use proptest::prelude::*;

/// Points of Halton's sequence in [0, 2] × [−1, 0] and two smooth functions of them.
fn scattered(m: usize) -> Samples {
    let halton = |mut i: usize, base: usize| {
        let (mut value, mut digit) = (0.0, 1.0);
        while i > 0 {
            digit /= base as f64;
            value += digit * (i % base) as f64;
            i /= base;
        }
        value
    };
    let points = Mat::from_fn(2, m, |i, j| [2.0 * halton(j + 1, 2), halton(j + 1, 3) - 1.0][i]);
    let values = Mat::from_fn(2, m, |row, j| smooth(points.col_as_slice(j))[row]);
    Samples::new(points.as_ref(), values.as_ref()).unwrap()
}

fn smooth(x: &[f64]) -> [f64; 2] {
    [(1.5 * x[0]).sin() * (x[1]).exp(), 1.0 / (1.0 + x[0] * x[0] + 2.0 * x[1] * x[1])]
}

/// Fixed shapes at which all kernels are well conditioned.
fn all() -> impl Iterator<Item = RbfParams> {
    let shape = |kernel| if kernel == Kernel::Wendland { 0.4 } else { 3.0 };
    Kernel::ALL.into_iter().map(move |kernel| RbfParams::new(kernel).with_shape(Shape::Fixed(shape(kernel))))
}

#[test]
fn samples_are_reproduced() {
    let samples = scattered(60);
    for params in all() {
        let rbf = params.rbf(&samples).unwrap();
        for i in 0..60 {
            let mut y = [0.0; 2];
            rbf.predict(samples.point(i), &mut y).unwrap();
            let error = (0..2).map(|row| (y[row] - samples.value(i)[row]).abs()).fold(0.0, f64::max);
            assert!(error < 1e-10, "{params:?}: {error:e}");
        }
    }
}

#[test]
fn polynomials_of_the_tail_are_reproduced() {
    let samples = scattered(40);
    let f = |x: &[f64]| 1.0 - 2.0 * x[0] + 0.5 * x[1] + x[0] * x[1] - 3.0 * x[1] * x[1];
    let values = Mat::from_fn(1, 40, |_, j| f(samples.point(j)));
    let samples = Samples::new(samples.points(), values.as_ref()).unwrap();
    for params in all() {
        let rbf = params.with_tail(2).rbf(&samples).unwrap();
        let (x, mut y) = ([1.3, -0.2], [0.0]);
        rbf.predict(&x, &mut y).unwrap();
        assert!((y[0] - f(&x)).abs() < 1e-11, "{params:?}: {}", y[0] - f(&x));
        rbf.derivative(&x, 1, &mut y).unwrap();
        assert!((y[0] - (0.5 + 1.3 + 1.2)).abs() < 1e-10, "{params:?}");
    }
}

#[test]
fn derivatives_are_those_of_predictions() {
    let samples = scattered(30);
    for params in all() {
        let rbf = params.rbf(&samples).unwrap();
        for x in [vec![0.7, -0.4], samples.point(5).to_vec()] {
            for input in 0..2 {
                let step = 1e-5;
                let at = |sign: f64| {
                    let mut shifted = x.clone();
                    shifted[input] += sign * step;
                    let mut y = [0.0; 2];
                    rbf.predict(&shifted, &mut y).unwrap();
                    y
                };
                let mut slope = [0.0; 2];
                rbf.derivative(&x, input, &mut slope).unwrap();
                for row in 0..2 {
                    let difference = (at(1.0)[row] - at(-1.0)[row]) / (2.0 * step);
                    let error = (difference - slope[row]).abs();
                    assert!(error < 1e-6 * (1.0 + difference.abs()), "{params:?}, {error:e}");
                }
            }
        }
    }
}

#[test]
fn the_closed_form_is_what_leaving_out_gives() {
    let samples = scattered(25);
    for params in all() {
        let closed = params.leave_one_out(&samples).unwrap();
        let scaling = Scaling::by_range(samples.points());
        for left_out in 0..25 {
            let others: Vec<usize> = (0..25).filter(|&i| i != left_out).collect();
            // In the coordinates of all samples: the extent changes when an outermost one is left out.
            let rest = samples.subset(&others).unwrap();
            let degree = params.tail.or(params.kernel.lowest_tail());
            let system = System::new(params.kernel, degree, &rest, &scaling).unwrap();
            let Shape::Fixed(shape) = params.shape else { panic!("a fixed one") };
            let weights = system.solve(shape).0.transpose().to_owned();
            let System { kernel, tail, centres, .. } = system;
            let domain = rest.domain().to_vec();
            let rbf = Rbf { kernel, shape, degree, tail, scaling: scaling.clone(), centres, weights, domain };
            let mut y = [0.0; 2];
            rbf.predict(samples.point(left_out), &mut y).unwrap();
            for row in 0..2 {
                let error = samples.value(left_out)[row] - y[row];
                assert!((error - closed[(row, left_out)]).abs() < 1e-9, "{params:?}, sample {left_out}");
            }
        }
    }
}

#[test]
fn the_chosen_shape_is_as_good_as_the_best_of_many() {
    let samples = scattered(64);
    for kernel in [Kernel::Gaussian, Kernel::Multiquadric, Kernel::Wendland] {
        let chosen = RbfParams::new(kernel).rbf(&samples).unwrap();
        let error = |rbf: &Rbf| {
            let at = |i: i32| {
                let x = [0.1 + 1.8 * f64::from(i % 20) / 19.0, -0.95 + 0.9 * f64::from(i / 20) / 19.0];
                let mut y = [0.0; 2];
                rbf.predict(&x, &mut y).unwrap();
                (0..2).map(|row| (y[row] - smooth(&x)[row]).powi(2)).sum::<f64>()
            };
            (0..400).map(at).sum::<f64>().sqrt()
        };
        let fixed = |i: i32| {
            let params = RbfParams::new(kernel).with_shape(Shape::Fixed(0.1 * 1.3_f64.powi(i)));
            params.rbf(&samples).map_or(f64::INFINITY, |rbf| error(&rbf))
        };
        let best = (0..14).map(fixed).fold(f64::INFINITY, f64::min);
        let found = error(&chosen);
        assert!(found < 4.0 * best, "{kernel:?}: {found:e} at {} against {best:e}", chosen.shape());
    }
}

proptest! {
    #[test]
    fn it_is_linear_in_the_values(factor in -3.0..3.0f64, kernel in 0..6usize) {
        let samples = scattered(20);
        let params = all().nth(kernel).unwrap();
        let scaled = Mat::from_fn(2, 20, |i, j| factor * samples.values()[(i, j)]);
        let other = params.rbf(&Samples::new(samples.points(), scaled.as_ref()).unwrap()).unwrap();
        let (mut a, mut b) = ([0.0; 2], [0.0; 2]);
        params.rbf(&samples).unwrap().predict(&[0.9, -0.3], &mut a).unwrap();
        other.predict(&[0.9, -0.3], &mut b).unwrap();
        prop_assert!((0..2).all(|i| (b[i] - factor * a[i]).abs() < 1e-10));
    }
}

#[test]
fn loaded_is_what_was_saved_bit_for_bit() {
    for params in all() {
        let rbf = params.rbf(&scattered(30)).unwrap();
        let bytes = rbf.record().to_bytes();
        let loaded = load(&Record::from_bytes(&bytes).unwrap()).unwrap();
        assert_eq!(loaded.record().to_bytes(), bytes);
        let (mut a, mut b) = ([0.0; 2], [0.0; 2]);
        rbf.predict(&[0.9, -0.3], &mut a).unwrap();
        loaded.predict(&[0.9, -0.3], &mut b).unwrap();
        assert_eq!(a, b);
        for wrong in [
            rbf.record().with_word("kernel", "cosine"),
            rbf.record().with("sizes", [2.0, 2.0]),
            rbf.record().with("sizes", [2.0, 3.0, 30.0]),
            rbf.record().with("degree", [9.0]),
        ] {
            assert!(matches!(Rbf::from_record(&wrong), Err(RecordError::Entry { .. })));
        }
    }
}

#[test]
fn what_cannot_be_is_said_with_numbers() {
    let two = scattered(2);
    let error = RbfParams::new(Kernel::Cubic).rbf(&two).unwrap_err();
    assert!(matches!(error, InterpolationError::TooFew { needed: 3, found: 2, .. }), "{error}");
    let on_a_line = Mat::from_fn(2, 9, |i, j| (i + 1) as f64 * j as f64);
    let values = Mat::from_fn(1, 9, |_, j| j as f64);
    let samples = Samples::new(on_a_line.as_ref(), values.as_ref()).unwrap();
    let error = RbfParams::new(Kernel::ThinPlate).rbf(&samples).unwrap_err();
    assert!(matches!(error, InterpolationError::Singular { .. }), "{error}");
    for wrong in [
        RbfParams::new(Kernel::Gaussian).with_shape(Shape::Fixed(f64::NAN)),
        RbfParams::new(Kernel::Gaussian).with_shape(Shape::Fixed(0.0)),
        RbfParams::new(Kernel::Quintic).with_tail(1),
        RbfParams::new(Kernel::Cubic).with_tail(9),
    ] {
        let error = wrong.rbf(&samples).unwrap_err();
        assert!(matches!(error, InterpolationError::Parameter { .. }), "{error}");
    }
    let many = Mat::from_fn(1, 6001, |_, j| j as f64);
    let samples = Samples::new(many.as_ref(), many.as_ref()).unwrap();
    let error = RbfParams::new(Kernel::Cubic).rbf(&samples).unwrap_err();
    assert!(matches!(error, InterpolationError::TooMany { found: 6001, most: 6000, .. }), "{error}");
}

#[test]
fn one_sample_is_a_constant() {
    let samples = scattered(1);
    let rbf = RbfParams::new(Kernel::Multiquadric).rbf(&samples).unwrap();
    let mut y = [0.0; 2];
    rbf.predict(&[5.0, 5.0], &mut y).unwrap();
    assert!((0..2).all(|row| (y[row] - samples.value(0)[row]).abs() < 1e-15));
}
