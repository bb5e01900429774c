//! What samples must be.
use super::*;

fn values(m: usize) -> Mat<f64> {
    Mat::from_fn(2, m, |i, j| (i + j) as f64)
}

#[test]
fn bad_samples_are_refused_by_number() {
    let empty: Mat<f64> = Mat::zeros(1, 0);
    let error = Samples::new(empty.as_ref(), values(0).as_ref()).unwrap_err();
    assert!(matches!(error, InterpolationError::Empty { samples: 0, inputs: 1, outputs: 2 }), "{error}");
    let error = Samples::of_one_input(&[0.0, 1.0], values(3).as_ref()).unwrap_err();
    assert!(matches!(error, InterpolationError::Shape { expected: 2, found: 3, .. }), "{error}");
    let error = Samples::of_one_input(&[0.0, f64::INFINITY], values(2).as_ref()).unwrap_err();
    assert!(
        matches!(error, InterpolationError::NotFinite { what: "input", row: 0, sample: 1, .. }),
        "{error}"
    );
    let mut bad = values(3);
    bad[(1, 2)] = f64::NAN;
    let error = Samples::of_one_input(&[0.0, 1.0, 2.0], bad.as_ref()).unwrap_err();
    assert!(
        matches!(error, InterpolationError::NotFinite { what: "output", row: 1, sample: 2, .. }),
        "{error}"
    );
}

#[test]
fn two_samples_at_one_point_are_found_wherever_they_are() {
    let error = Samples::of_one_input(&[0.0, 4.0, 2.0, 4.0], values(4).as_ref()).unwrap_err();
    assert!(matches!(error, InterpolationError::Doubled { first: 1, second: 3, .. }), "{error}");
    let points = Mat::from_fn(2, 50, |i, j| if i == 0 { (j % 5) as f64 } else { (j / 5) as f64 });
    assert!(Samples::new(points.as_ref(), values(50).as_ref()).is_ok());
    let mut doubled = points.clone();
    for i in 0..2 {
        doubled[(i, 41)] = points[(i, 7)] + 1e-14;
    }
    let error = Samples::new(doubled.as_ref(), values(50).as_ref()).unwrap_err();
    assert!(matches!(error, InterpolationError::Doubled { first: 7, second: 41, .. }), "{error}");
    // One input that never changes.
    let points = Mat::from_fn(2, 3, |i, j| if i == 0 { 1.0 } else { j as f64 });
    assert!(Samples::new(points.as_ref(), values(3).as_ref()).is_ok());
}

#[test]
fn a_grid_is_found_in_any_order_and_only_if_full() {
    let points = Mat::from_fn(2, 6, |i, j| {
        let node = (j * 5) % 6;
        if i == 0 { [0.0, 1.0, 4.0][node % 3] } else { [2.0, -1.0][node / 3] }
    });
    let samples = Samples::new(points.as_ref(), values(6).as_ref()).unwrap();
    let grid = samples.grid().unwrap();
    assert_eq!(grid.axes, [vec![0.0, 1.0, 4.0], vec![-1.0, 2.0]]);
    for (node, &sample) in grid.samples.iter().enumerate() {
        assert_eq!(samples.point(sample), [grid.axes[0][node % 3], grid.axes[1][node / 3]]);
    }
    assert_eq!(samples.domain(), [[0.0, 4.0], [-1.0, 2.0]]);
    let five = samples.subset(&[0, 1, 2, 3, 5]).unwrap();
    assert!(matches!(five.grid(), Err(InterpolationError::NotAGrid { samples: 5, nodes: 6, .. })));
    assert!(samples.subset(&[]).is_none());
}
