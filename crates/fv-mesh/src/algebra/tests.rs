//! Expressions against loops over cells.
use crate::{Axis, CartesianGrid, Cluster, Field, GridMismatch};
use proptest::prelude::*;

fn values<const D: usize>(field: &Field<D>) -> Vec<f64> {
    field.values().collect()
}

/// A field of irregular values.
fn irregular<const D: usize>(grid: &CartesianGrid<D>, seed: f64) -> Field<D> {
    Field::from_fn(grid, |x| {
        x.iter().enumerate().map(|(a, x)| (seed + (a as f64 + 1.3) * 7.1 * x).sin()).sum()
    })
}

/// Every operator at once, cell by cell and as an expression, bit for bit.
fn compare<const D: usize>(grid: &CartesianGrid<D>, s: f64) {
    let (b, c) = (irregular(grid, s), irregular(grid, 2.0 * s + 1.0));
    let mut a = irregular(grid, 0.3);
    let old = values(&a);
    let expression = 2.0 * &b + &b * &c - s / (&c * &c + 1.5) - (-&b).abs().sqrt() + b.min(&c).max(-0.5)
        - (3.0 - &b).map(|v| v * v * v) * c.square() / 7.0;
    a.assign(expression).unwrap();
    let naive = |b: f64, c: f64| {
        2.0 * b + b * c - s / (c * c + 1.5) - (-b).abs().sqrt() + b.min(c).max(-0.5)
            - ((3.0 - b) * (3.0 - b) * (3.0 - b)) * (c * c) / 7.0
    };
    let (b, c) = (values(&b), values(&c));
    let exact: Vec<f64> = b.iter().zip(&c).map(|(&b, &c)| naive(b, c)).collect();
    assert_eq!(values(&a), exact);

    let mut sum = irregular(grid, 0.3);
    sum.increase(&a * 2.0).unwrap();
    sum.multiply(s).unwrap();
    let exact: Vec<f64> = old.iter().zip(&exact).map(|(o, e)| (o + e * 2.0) * s).collect();
    assert_eq!(values(&sum), exact);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn expressions_are_loops(nx in 1_usize..23, ny in 1_usize..19, nz in 1_usize..17, s in -2.0..2.0_f64) {
        compare(&CartesianGrid::new([nx, ny], [1.0, 2.0]).unwrap(), s);
        let axes = [nx, ny, nz].map(|n| Axis::tanh(n, -1.0, 1.0, 1.2, Cluster::Both).unwrap());
        compare(&CartesianGrid::from_axes(axes).unwrap(), s);
    }
}

#[test]
fn ghosts_stay() {
    let grid = CartesianGrid::new([3, 5], [1.0, 1.0]).unwrap();
    let mut a = Field::zeros(&grid);
    a.data_mut().fill(7.0);
    let b = Field::from_fn(&grid, |_| 1.0);
    a.assign(&b + 1.0).unwrap();
    assert_eq!(a.data().iter().filter(|&&v| v == 2.0).count(), 15);
    assert_eq!(a.data().iter().filter(|&&v| v == 7.0).count(), 7 * 9 - 15);
    a.fill(3.0);
    assert_eq!(a.data().iter().filter(|&&v| v == 3.0).count(), 15);
}

#[test]
fn functions_are_taken_at_the_centres() {
    let axes = [Axis::geometric(7, 0.0, 1.0, 1.3), Axis::uniform(2, 0.0, 1.0), Axis::uniform(3, 1.0, 4.0)];
    let grid = CartesianGrid::from_axes(axes.map(Result::unwrap)).unwrap();
    let a = Field::from_fn(&grid, |x| x[0] + 10.0 * x[1] + 100.0 * x[2]);
    for (i, value) in a.values().enumerate() {
        let x = grid.centre(grid.cell(i));
        assert_eq!(value, x[0] + 10.0 * x[1] + 100.0 * x[2]);
    }
    let twice =
        Field::from_expression(&grid, &a + grid.function(|x| x[0] + 10.0 * x[1] + 100.0 * x[2])).unwrap();
    assert_eq!(twice.max_difference(2.0 * &a), Ok(0.0));
    assert_eq!(twice.max_difference(&a * 2.0 + 0.25), Ok(0.25));
}

#[test]
fn other_grids_are_errors_and_change_nothing() {
    let grid = CartesianGrid::new([4, 4], [1.0, 1.0]).unwrap();
    let (mut a, b) = (Field::from_fn(&grid, |_| 1.0), Field::zeros(&grid));
    let other = CartesianGrid::new([4, 4], [1.0, 1.5]).unwrap();
    let c = Field::zeros(&other);
    let error = a.assign(&b + 2.0 * &c).unwrap_err();
    assert_eq!((error.axis, error.expected.upper, error.found.upper), (1, 1.0, 1.5));
    assert!(error.to_string().contains("4 cells from 0 m to 1.5 m found"), "{error}");
    assert!(matches!(a.increase(other.function(|x| x[0])), Err(GridMismatch { axis: 1, .. })));
    assert!(a.max_difference(&c).is_err() && Field::from_expression(&grid, -&c).is_err());
    assert!(values(&a).iter().all(|&v| v == 1.0));
    // Equal faces are enough.
    let same = CartesianGrid::new([4, 4], [1.0, 1.0]).unwrap();
    a.assign(&Field::from_fn(&same, |_| 5.0)).unwrap();
    assert!(values(&a).iter().all(|&v| v == 5.0));
}

#[test]
fn what_is_not_a_number_is_passed_on() {
    let grid = CartesianGrid::new([9, 2], [1.0, 1.0]).unwrap();
    let mut a = Field::zeros(&grid);
    a.assign(grid.function(|x| x[0] - 0.5).sqrt()).unwrap();
    assert!(a.max_difference(0.0).unwrap().is_nan());
    let zero = Field::zeros(&grid);
    for b in [
        Field::from_expression(&grid, a.min(0.0)),
        Field::from_expression(&grid, a.max(1.0)),
        Field::from_expression(&grid, zero.min(&a)),
        Field::from_expression(&grid, zero.max(&a)),
    ] {
        assert!(b.unwrap().row(0)[0].is_nan());
    }
    let first = a.first_not_finite().unwrap();
    assert_eq!((first.cell, a.row(0)[5].is_nan(), zero.first_not_finite()), ([0, 0], false, None));
}
