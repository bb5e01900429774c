//! Exactness, orders, grids, files.
use super::*;
use crate::MatRef;
use crate::interpolation::load;
use proptest::prelude::*;

fn on_line(n: usize, f: impl Fn(f64) -> f64, place: impl Fn(f64) -> f64) -> Samples {
    let x: Vec<f64> = (0..n).map(|i| place(i as f64 / (n - 1) as f64)).collect();
    let values = Mat::from_fn(1, n, |_, i| f(x[i]));
    Samples::of_one_input(&x, values.as_ref()).unwrap()
}

fn largest_error(spline: &Spline, f: impl Fn(f64) -> f64) -> f64 {
    let [[low, high]] = spline.domain() else { panic!("one input") };
    let at = |i: i32| {
        let x = low + (high - low) * f64::from(i) / 1000.0;
        let mut y = [0.0];
        spline.predict(&[x], &mut y).unwrap();
        (y[0] - f(x)).abs()
    };
    (0..=1000).map(at).fold(0.0, f64::max)
}

#[test]
fn the_order_of_accuracy_is_one_more_than_the_degree() {
    // Uneven points, and a function with all derivatives at the ends.
    let place = |s: f64| s + 0.05 * (5.0 * s).sin();
    let f = |x: f64| (4.0 * x + 0.3).sin() * x.exp();
    for degree in Degree::ALL {
        let error = |n| largest_error(&SplineParams::new(degree).spline(&on_line(n, f, place)).unwrap(), f);
        let [coarse, fine] = [error(41), error(81)];
        let order = (coarse / fine).log2();
        let expected = degree.get() as f64 + 1.0;
        assert!((order - expected).abs() < 0.3, "degree {degree:?}: {order} from {coarse:e} and {fine:e}");
    }
}

#[test]
fn the_derivative_is_one_order_lower() {
    let f = |x: f64| (4.0 * x + 0.3).sin();
    for degree in Degree::ALL {
        let error = |n: usize| {
            let spline = SplineParams::new(degree).spline(&on_line(n, f, |s| s)).unwrap();
            let at = |i: i32| {
                let x = f64::from(i) / 997.0;
                let mut slope = [0.0];
                spline.derivative(&[x], 0, &mut slope).unwrap();
                (slope[0] - 4.0 * (4.0 * x + 0.3).cos()).abs()
            };
            (0..=997).map(at).fold(0.0, f64::max)
        };
        let order = (error(31) / error(61)).log2();
        assert!((order - degree.get() as f64).abs() < 0.3, "degree {degree:?}: {order}");
    }
}

#[test]
fn a_smooth_coefficient_in_time_comes_out_to_ten_digits() {
    let f = |t: f64| (6.0 * t + 1.0).cos() + 0.3 * (9.0 * t).sin();
    let spline = SplineParams::new(Degree::Quintic).spline(&on_line(301, f, |s| s)).unwrap();
    let error = largest_error(&spline, f);
    assert!(error < 1e-10, "{error:e}");
}

proptest! {
    #[test]
    fn polynomials_of_the_degree_are_reproduced(
        coefficients in prop::array::uniform6(-1.0..1.0f64),
        steps in prop::collection::vec(0.2..1.0f64, 6..20),
        outside in 0.0..0.1f64,
    ) {
        let mut x = vec![-1.0];
        for step in &steps { x.push(x[x.len() - 1] + step / steps.len() as f64); }
        for degree in Degree::ALL {
            let f = |x: f64| coefficients[..=degree.get()].iter().rev().fold(0.0, |sum, c| sum * x + c);
            let values = Mat::from_fn(1, x.len(), |_, i| f(x[i]));
            let samples = Samples::of_one_input(&x, values.as_ref()).unwrap();
            let spline = SplineParams::new(degree).spline(&samples).unwrap();
            prop_assert!(largest_error(&spline, f) < 1e-11);
            let mut y = [0.0];
            spline.predict(&[-1.0 - outside], &mut y).unwrap();
            prop_assert!((y[0] - f(-1.0 - outside)).abs() < 1e-10);
        }
    }

    #[test]
    fn samples_are_reproduced_in_any_order(values in prop::collection::vec(-1.0..1.0f64, 7..40), turn in 1usize..6) {
        let n = values.len();
        // Neighbours in time are not neighbours among the samples.
        let x: Vec<f64> = (0..n).map(|i| ((i * (turn + 1) + 3) % n) as f64 + 0.01 * i as f64).collect();
        let unique = (0..n).all(|i| (0..i).all(|j| (x[i] - x[j]).abs() > 1e-9));
        prop_assume!(unique);
        let samples = Samples::of_one_input(&x, MatRef::from_row_major_slice(&values, 1, n)).unwrap();
        for degree in [Degree::Linear, Degree::Cubic] {
            let spline = SplineParams::new(degree).spline(&samples).unwrap();
            for i in 0..n {
                let mut y = [0.0];
                spline.predict(&[x[i]], &mut y).unwrap();
                prop_assert!((y[0] - values[i]).abs() < 1e-10, "{} {}", y[0], values[i]);
            }
        }
    }
}

/// Two outputs of three inputs on a grid of 7 × 5 × 9 points in a scrambled order.
fn on_grid() -> (Samples, impl Fn(&[f64]) -> [f64; 2]) {
    let f =
        |x: &[f64]| [x[0].powi(5) * x[1].powi(3) * (1.0 - x[2].powi(5)), 2.0 - x[0] * x[1] + x[2].powi(4)];
    let n = [7, 5, 9];
    let scrambled = |j: usize| (j * 52) % 315;
    let coordinate = |i: usize, j: usize| {
        let node = scrambled(j);
        let index = [node % n[0], node / n[0] % n[1], node / n[0] / n[1]][i];
        (index as f64 / (n[i] - 1) as f64).powf(1.0 + 0.1 * i as f64)
    };
    let points = Mat::from_fn(3, 315, coordinate);
    let values = Mat::from_fn(2, 315, |row, j| f(points.col_as_slice(j))[row]);
    (Samples::new(points.as_ref(), values.as_ref()).unwrap(), f)
}

#[test]
fn a_product_of_splines_reproduces_products_of_polynomials() {
    let (samples, f) = on_grid();
    let spline = SplineParams::highest(&samples).unwrap().spline(&samples).unwrap();
    assert_eq!(spline.degrees(), [5, 3, 5]);
    let x = [0.37, 0.61, 0.83];
    let mut y = [0.0; 2];
    spline.predict(&x, &mut y).unwrap();
    assert!((0..2).all(|i| (y[i] - f(&x)[i]).abs() < 1e-13), "{y:?} {:?}", f(&x));
    spline.derivative(&x, 1, &mut y).unwrap();
    let exact = [3.0 * x[0].powi(5) * x[1].powi(2) * (1.0 - x[2].powi(5)), -x[0]];
    assert!((0..2).all(|i| (y[i] - exact[i]).abs() < 1e-12), "{y:?} {exact:?}");
    assert!(spline.covers(&x) && !spline.covers(&[0.5, 1.1, 0.5]));
}

#[test]
fn loaded_is_what_was_saved_bit_for_bit() {
    let (samples, _) = on_grid();
    let spline = SplineParams::per_input(&Degree::ALL).spline(&samples).unwrap();
    let bytes = spline.record().to_bytes();
    let loaded = load(&Record::from_bytes(&bytes).unwrap()).unwrap();
    assert_eq!(loaded.record().to_bytes(), bytes);
    assert_eq!(loaded.domain(), spline.domain());
    let (mut a, mut b) = ([0.0; 2], [0.0; 2]);
    spline.predict(&[0.123, 0.9, 1.2], &mut a).unwrap();
    loaded.predict(&[0.123, 0.9, 1.2], &mut b).unwrap();
    assert_eq!(a, b);
}

#[test]
fn a_changed_record_is_refused() {
    let (samples, _) = on_grid();
    let record = SplineParams::new(Degree::Cubic).spline(&samples).unwrap().record();
    for wrong in [
        record.clone().with("degrees", [2.0, 3.0, 3.0]),
        record.clone().with("degrees", [3.0, 3.0]),
        record.clone().with("outputs", [3.0]),
        record.clone().with("knots 1", [1.0, 0.0]),
        record.with("coefficients", []),
    ] {
        assert!(matches!(Spline::from_record(&wrong), Err(RecordError::Entry { .. })));
    }
}

#[test]
fn what_cannot_be_is_said_with_numbers() {
    let samples = on_line(5, |x| x, |s| s);
    let error = SplineParams::new(Degree::Quintic).spline(&samples).unwrap_err();
    assert!(matches!(error, InterpolationError::TooFew { needed: 6, found: 5, .. }), "{error}");
    let one = Samples::of_one_input(&[2.0], Mat::from_fn(1, 1, |_, _| 3.0).as_ref()).unwrap();
    let error = SplineParams::highest(&one).unwrap_err();
    assert!(matches!(error, InterpolationError::TooFew { needed: 2, found: 1, .. }), "{error}");
    let (grid, _) = on_grid();
    let error = SplineParams::per_input(&[Degree::Cubic; 2]).spline(&grid).unwrap_err();
    assert!(matches!(error, InterpolationError::Shape { expected: 3, found: 2, .. }), "{error}");
    let some = grid.subset(&(1..315).collect::<Vec<_>>()).unwrap();
    let error = SplineParams::new(Degree::Cubic).spline(&some).unwrap_err();
    assert!(matches!(error, InterpolationError::NotAGrid { samples: 314, nodes: 315, .. }), "{error}");

    let spline = SplineParams::new(Degree::Cubic).spline(&samples).unwrap();
    let mut y = [0.0];
    let error = spline.predict(&[f64::NAN], &mut y).unwrap_err();
    assert!(matches!(error, InterpolationError::Point { input: 0, .. }), "{error}");
    assert!(matches!(
        spline.predict(&[0.0; 2], &mut y),
        Err(InterpolationError::Shape { expected: 1, found: 2, .. })
    ));
    assert!(matches!(spline.derivative(&[0.0], 1, &mut y), Err(InterpolationError::Shape { .. })));
}
