//! The best is found, cheaply, and the same every time.
use super::*;
use crate::Mat;

fn line(m: usize, f: impl Fn(f64) -> f64) -> Samples {
    let x: Vec<f64> = (0..m).map(|i| i as f64 / (m - 1) as f64).collect();
    Samples::of_one_input(&x, Mat::from_fn(1, m, |_, i| f(x[i])).as_ref()).unwrap()
}

#[test]
fn smooth_functions_of_time_get_the_highest_spline() {
    let samples = line(81, |t| (9.0 * t).sin() + (4.0 * t).cos());
    let best = best(&samples).unwrap();
    println!("{}", best.table);
    let error = |i: usize| best.table.rows[i].outcome.as_ref().unwrap().error;
    assert!(best.table.rows.iter().all(|row| row.outcome.is_ok()));
    assert!((0..best.table.rows.len()).all(|i| CLEARLY * error(best.chosen) <= error(i)));
    // What is far behind is not tried to the end.
    assert!(!best.table.rows.iter().all(|row| row.in_full));
    let mut y = [0.0];
    best.interpolator.predict(&[0.513], &mut y).unwrap();
    assert!((y[0] - (9.0_f64 * 0.513).sin() - (4.0_f64 * 0.513).cos()).abs() < 1e-8);
    let again = super::best(&samples).unwrap();
    assert_eq!(again.chosen, best.chosen);
    assert_eq!(again.interpolator.record(), best.interpolator.record());
}

#[test]
fn ties_go_to_the_cheaper() {
    // A straight line: all are exact, and the linear spline comes first.
    let samples = line(20, |t| 2.0 * t - 1.0);
    let best = best(&samples).unwrap();
    assert_eq!(best.chosen, 0, "{}", best.table);
}

#[test]
fn grids_and_scattered_points_get_what_suits_them() {
    let points = Mat::from_fn(2, 25, |i, j| [(j % 5) as f64, (j / 5) as f64][i]);
    let f = |j: usize| (0.5 * points[(0, j)]).sin() * (0.2 * points[(1, j)]).exp();
    let grid = Samples::new(points.as_ref(), Mat::from_fn(1, 25, |_, j| f(j)).as_ref()).unwrap();
    let names = |samples: &Samples| candidates(samples).iter().map(|m| m.name()).collect::<Vec<_>>();
    assert!(names(&grid).contains(&"cubic × cubic spline".to_owned()), "{:?}", names(&grid));
    let scattered = grid.without(&[7]).unwrap();
    assert!(names(&scattered).iter().all(|name| !name.contains("spline")));
    for samples in [&grid, &scattered] {
        let best = best(samples).unwrap();
        let error = best.table.rows[best.chosen].outcome.as_ref().unwrap().error;
        assert!(error < 0.02, "{}", best.table);
        assert!(best.table.to_string().lines().any(|line| line.ends_with(" *")));
    }
}

#[test]
fn one_value_of_an_input_and_few_samples_are_no_trouble() {
    // The second input never changes.
    let points = Mat::from_fn(2, 12, |i, j| if i == 0 { j as f64 } else { 3.0 });
    let values = Mat::from_fn(1, 12, |_, j| (0.3 * j as f64).sin());
    let samples = Samples::new(points.as_ref(), values.as_ref()).unwrap();
    let best_of_constant = best(&samples).unwrap();
    assert!(best_of_constant.table.rows[best_of_constant.chosen].outcome.as_ref().unwrap().error < 1e-2);
    let few = line(4, |t| t * t);
    assert!(best(&few).is_ok());
    for which in [&[0][..], &[0, 1], &[0, 1, 2]] {
        let error = best(&few.subset(which).unwrap()).err().map(|error| error.to_string());
        assert!(error.as_ref().is_some_and(|error| error.contains("needs 2")), "{error:?}");
    }
    let identical = best(&line(30, |_| 4.2)).unwrap();
    assert_eq!(identical.chosen, 0);
}

#[test]
fn methods_that_do_not_work_say_why_and_the_others_are_compared() {
    let samples = line(5, |t| t.sin());
    let methods: Vec<Box<dyn Method>> =
        vec![Box::new(SplineParams::new(Degree::Quintic)), Box::new(SplineParams::new(Degree::Linear))];
    let folds = Folds::leave_one_out_inside(&samples);
    let table = compare(&methods, &samples, &folds);
    assert_eq!(table.best(), Some(1));
    assert!(table.to_string().contains("needs 6"), "{table}");
    assert!(matches!(
        best_of(&methods[..1], &samples, &folds),
        Err(InterpolationError::TooFew { needed: 6, .. })
    ));
    assert!(matches!(best_of(&[], &samples, &folds), Err(InterpolationError::TooFew { found: 0, .. })));
}
