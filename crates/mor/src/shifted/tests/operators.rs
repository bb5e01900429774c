//! The operators of frames on a grid.
use super::{ALL, distance, dot, norm, random};
use crate::shifted::{
    FieldShift, FrameOperators, Grid, GridFrames, Interpolation, Motion, Motions, ShiftedError,
};
use interfaces::{Point, Rotation, Vector};
use monomorphic::Mat;
use proptest::prelude::*;
use std::f64::consts::PI;

fn matrix(n_rows: usize, n: usize, seed: u64) -> Mat<f64> {
    let values = random(n_rows * n, seed);
    Mat::from_fn(n_rows, n, |i, j| values[i + n_rows * j])
}

fn flat(a: &Mat<f64>) -> Vec<f64> {
    a.col_iter().flat_map(|c| c.iter().copied().collect::<Vec<_>>()).collect()
}

fn turning(angle: f64, axis: Vector, s: Vector, centre: Point) -> Motion {
    Motion { displacement: s, rotation: Rotation::new(axis.normalize() * angle), centre }
}

/// A bump that is no circle, on the way from its centre of rotation.
fn bump(way: Vector) -> f64 {
    let way = way - Vector::new(-1.0, 0.5, 0.0);
    (-(way.x / 3.5).powi(2) - ((way.y - 1.0) / 5.0).powi(2)).exp() * (1.0 + 0.2 * way.x)
}

/// The shortest way in a box of 60 × 48.
fn shortest(way: Vector) -> Vector {
    Vector::new(way.x - 60.0 * (way.x / 60.0).round(), way.y - 48.0 * (way.y / 48.0).round(), 0.0)
}

#[test]
fn a_turning_body_crosses_the_ends_of_a_periodic_box() {
    // It moves around the box and turns by more than one full turn about its moving centre.
    let grid = Grid::new([60, 48], [1.0; 2]).unwrap();
    let n = 25;
    let centre = Point::new(21.0, 29.5, 0.0);
    let motion = |j: usize| {
        let t = j as f64 / 24.0;
        turning(7.0 * t, Vector::z(), Vector::new(90.0 * t, -60.0 * t * t, 0.0), centre)
    };
    let motions = Motions::by(1, n, |_, j| motion(j));
    let rest = Mat::from_fn(60 * 48, n, |i, _| bump(shortest(grid.centre(i) - centre)));
    let seen = Mat::from_fn(60 * 48, n, |i, j| {
        let motion = motion(j);
        bump(motion.rotation.inverse() * shortest(grid.centre(i) - centre - motion.displacement))
    });
    for (interpolation, bound) in [
        (Interpolation::Lagrange1, 4e-2),
        (Interpolation::Lagrange3, 6e-3),
        (Interpolation::Lagrange5, 5e-4),
        (Interpolation::CubicSpline, 3e-3),
        (Interpolation::QuinticSpline, 2e-4),
        (Interpolation::Spectral, 1e-6),
    ] {
        let op = GridFrames::new(grid, interpolation, &motions, 60 * 48).unwrap();
        let mut field = rest.clone();
        op.to_lab(0, field.as_mut());
        let there = (&field - &seen).norm_l2() / seen.norm_l2();
        op.to_frame(0, field.as_mut());
        let back = (&field - &rest).norm_l2() / rest.norm_l2();
        assert!(there < bound && back < 2.0 * bound, "{interpolation:?}: {there:.1e} {back:.1e}");
    }
}

#[test]
fn frames_turn_about_any_axis_in_space() {
    let n = 24;
    let grid = Grid::new([n; 3], [0.5; 3]).unwrap();
    let centre = Point::new(5.7, 6.1, 5.9);
    let motion = turning(2.3, Vector::new(1.0, -2.0, 0.5), Vector::new(0.0, 0.4, -0.3), centre);
    let blob = |x: Point| {
        let way = x - centre;
        (-(way.x / 1.2).powi(2) - (way.y / 1.6).powi(2) - (way.z / 1.4).powi(2)).exp() * (1.0 + 0.5 * way.y)
    };
    let motions = Motions::by(1, 1, |_, _| motion);
    for (interpolation, bound) in [(Interpolation::Spectral, 2e-3), (Interpolation::QuinticSpline, 2e-3)] {
        let op = GridFrames::new(grid, interpolation, &motions, n * n * n).unwrap();
        let rest = Mat::from_fn(n * n * n, 1, |i, _| blob(grid.centre(i)));
        let inverse = motion.inverse();
        let seen = Mat::from_fn(n * n * n, 1, |i, _| {
            let x = grid.centre(i);
            blob(inverse.centre + inverse.displacement + inverse.rotation * (x - inverse.centre))
        });
        let mut field = rest.clone();
        op.to_lab(0, field.as_mut());
        let error = (&field - &seen).norm_l2() / seen.norm_l2();
        assert!(error < bound, "{interpolation:?}: {error:.1e}");
    }
}

#[test]
fn maps_do_what_motions_do() {
    let grid = Grid::new([20, 16], [0.5, 1.0]).unwrap().bounded([0, 1]);
    let motion = |j: usize| {
        turning(0.3 * j as f64, Vector::z(), Vector::new(0.5 * j as f64, 0.2, 0.0), Point::new(5.0, 8.0, 0.0))
    };
    let motions = Motions::by(1, 4, |_, j| motion(j));
    let forward = |m: Motion, x: Point| m.centre + m.displacement + m.rotation * (x - m.centre);
    let q = matrix(2 * 320, 4, 3);
    for interpolation in [Interpolation::Lagrange3, Interpolation::QuinticSpline] {
        let a = GridFrames::new(grid, interpolation, &motions, 640).unwrap();
        let b = GridFrames::mapped(
            grid,
            interpolation,
            1,
            4,
            640,
            move |_, j, x| forward(motion(j).inverse(), x),
            move |_, j, x| forward(motion(j), x),
        )
        .unwrap();
        for task in [GridFrames::to_lab, GridFrames::to_frame, GridFrames::to_lab_transposed] {
            let (mut p, mut r) = (q.clone(), q.clone());
            task(&a, 0, p.as_mut());
            task(&b, 0, r.as_mut());
            // A frame at rest is no gather.
            assert!((&p - &r).norm_l2() < 1e-11 * q.norm_l2(), "{interpolation:?}");
        }
    }
}

#[test]
fn impossible_frames_are_named() {
    let grid = Grid::new([8, 6], [1.0; 2]).unwrap();
    let moved = |s: Vector| Motions::translations(&[vec![Vector::zeros(), s]]).unwrap();
    let new = |grid, i, m: &Motions, rows| GridFrames::new(grid, i, m, rows).err();
    let spectral = Interpolation::Spectral;
    let x = moved(Vector::x());
    assert_eq!(new(grid, spectral, &x, 47), Some(ShiftedError::Rows { rows: 47, cells: 48 }));
    assert_eq!(
        new(grid, spectral, &moved(Vector::z()), 48),
        Some(ShiftedError::OffGrid { frame: 0, snapshot: 1, axis: 2 })
    );
    assert_eq!(new(grid.bounded([0]), spectral, &x, 48), None);
    let turned = Motions::by(1, 1, |_, _| turning(0.5, Vector::z(), Vector::zeros(), Point::origin()));
    assert_eq!(
        new(grid.bounded([1]), spectral, &turned, 48),
        Some(ShiftedError::NotPeriodic { frame: 0, snapshot: 0, axis: 1, distance: 1.5 })
    );
    let nan = moved(Vector::new(f64::NAN, 0.0, 0.0));
    assert_eq!(new(grid, spectral, &nan, 48), Some(ShiftedError::Motion { frame: 0, snapshot: 1 }));
    let none = Motions::translations(&[]).unwrap();
    assert_eq!(new(grid, spectral, &none, 48), Some(ShiftedError::Empty { snapshots: 0, frames: 0 }));
    let tilted = Motions::by(1, 1, |_, _| turning(0.1, Vector::x(), Vector::zeros(), Point::origin()));
    assert!(matches!(new(grid, spectral, &tilted, 48), Some(ShiftedError::OffGrid { axis: 2, .. })));
    let lost = GridFrames::mapped(grid, spectral, 1, 1, 48, |_, _, x| x / 0.0, |_, _, x| x);
    assert_eq!(lost.err(), Some(ShiftedError::Motion { frame: 0, snapshot: 0 }));
}

proptest! {
    #[test]
    fn operators_are_linear_and_have_their_transpose(
        cells in prop::array::uniform3(2_usize..7), s in prop::array::uniform3(-9.0..9.0), turn in prop::array::uniform3(-3.0..3.0),
        which in 0_usize..6, bounded in any::<bool>(), seed in any::<u64>()
    ) {
        let interpolation = ALL[which];
        let mut grid = Grid::new(cells, [1.0, 0.5, 2.0]).unwrap();
        if bounded && interpolation != Interpolation::Spectral {
            grid = grid.bounded([0, 2]);
        }
        let motion = Motion { displacement: Vector::from(s), rotation: Rotation::new(Vector::from(turn)), centre: Point::new(1.3, 0.7, 2.0) };
        let n = grid.n_cells();
        let op = GridFrames::new(grid, interpolation, &Motions::by(1, 2, |_, _| motion), n).unwrap();
        let (p, q) = (matrix(n, 2, seed), matrix(n, 2, seed ^ 1));
        let apply = |x: &Mat<f64>, transposed: bool| {
            let mut x = x.clone();
            if transposed { op.to_lab_transposed(0, x.as_mut()) } else { op.to_lab(0, x.as_mut()) }
            flat(&x)
        };
        let mixed = Mat::from_fn(n, 2, |i, j| 2.0 * p[(i, j)] - 3.0 * q[(i, j)]);
        let (tp, tq) = (apply(&p, false), apply(&q, false));
        let expected: Vec<f64> = tp.iter().zip(&tq).map(|(p, q)| 2.0 * p - 3.0 * q).collect();
        let scale = 1e-12 * (n as f64) * (1.0 + norm(&tp) + norm(&tq));
        prop_assert!(distance(&apply(&mixed, false), &expected) < scale);
        prop_assert!((dot(&tp, &flat(&q)) - dot(&flat(&p), &apply(&q, true))).abs() < scale);
    }

    #[test]
    fn shears_have_an_inverse(cells in prop::array::uniform2(1_usize..9), angle in -PI..PI, s in prop::array::uniform2(-30.0..30.0), seed in any::<u64>()) {
        // Of odd numbers of cells: there is no wave of two cells.
        let grid = Grid::new(cells.map(|n| 2 * n + 1), [1.0, 0.7]).unwrap();
        let motion = turning(angle, Vector::z(), Vector::new(s[0], s[1], 0.0), Point::new(2.2, 1.4, 0.0));
        let n = grid.n_cells();
        let op = GridFrames::new(grid, Interpolation::Spectral, &Motions::by(1, 1, |_, _| motion), n).unwrap();
        let q = matrix(n, 1, seed);
        let mut there = q.clone();
        op.to_lab(0, there.as_mut());
        prop_assert!((there.norm_l2() - q.norm_l2()).abs() < 1e-12 * n as f64);
        op.to_frame(0, there.as_mut());
        prop_assert!((there - q).norm_l2() < 1e-12 * n as f64);
    }
}

/// A displacement of which double precision does not know the place within a cell is an error, by all interpolations.
#[test]
fn displacements_beyond_double_precision() {
    let grid = Grid::new([16], [0.5]).unwrap();
    for interpolation in ALL {
        let with = |distance: f64| {
            let shifts = Motions::by(1, 2, |_, j| Motion {
                displacement: Vector::x() * if j == 1 { distance } else { 0.0 },
                rotation: Rotation::identity(),
                centre: Point::origin(),
            });
            GridFrames::new(grid, interpolation, &shifts, 16).err()
        };
        assert_eq!(with(2e9), None);
        for distance in [-3e9, 1e300, f64::MAX] {
            let found = with(distance);
            let expected = matches!(found, Some(ShiftedError::TooFar { frame: 0, snapshot: 1, axis: 0, .. }));
            assert!(expected, "{interpolation:?}, {distance:e}: {found:?}");
        }
    }
}

#[test]
fn beyond_an_end_a_field_continues_with_the_value_there() {
    let grid = Grid::new([80], [1.0]).unwrap().bounded([0]);
    for interpolation in ALL {
        let operator = FieldShift::new(grid, interpolation);
        // Past the margin of splines and past the other end.
        for cells in [0.4, 46.7, 50.96, 75.2, 120.7, -50.96, -300.1] {
            let moved = operator.shift(Vector::x() * cells, &[1.0; 80]);
            let off = moved.iter().map(|x| (x - 1.0).abs()).fold(0.0, f64::max);
            assert!(off < 1e-13, "{} by {cells}: {off:.1e}", interpolation.name());
        }
    }
}
