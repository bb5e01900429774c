mod algorithms;
mod estimate;
mod huber_descent;
mod operators;
mod proximal;
mod shifted_pod;

use super::Interpolation::{self, *};
use super::{FieldShift, Grid, ShiftedError};
use interfaces::Vector;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;

const ALL: [Interpolation; 6] = [Lagrange1, Lagrange3, Lagrange5, CubicSpline, QuinticSpline, Spectral];

fn random(n: usize, seed: u64) -> Vec<f64> {
    let mut rng = Pcg64::seed_from_u64(seed);
    (0..n).map(|_| rng.random_range(-1.0..1.0)).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// A disc of diameter `d` cells in the middle, its edge a tanh one cell wide.
fn disc(cells: [usize; 2], d: f64) -> Vec<f64> {
    let n = cells[0] * cells[1];
    let grid = Grid::new(cells, [1.0; 2]).unwrap();
    let middle = Vector::new(cells[0] as f64 / 2.0, cells[1] as f64 / 2.0, 0.0);
    (0..n).map(|i| 0.5 - 0.5 * ((grid.centre(i).coords - middle).norm() - d / 2.0).tanh()).collect()
}

#[test]
fn a_shift_by_whole_cells_renumbers_them() {
    for interpolation in ALL {
        let op = FieldShift::new(Grid::new([5, 4, 3], [0.5, 1.0, 2.0]).unwrap(), interpolation);
        let q = random(60, 1);
        let shifted = op.shift(Vector::new(1.0, -3.0, 2.0), &q);
        for i in 0..60 {
            let [x, y, z] = [i % 5, i / 5 % 4, i / 20];
            let from = (x + 3) % 5 + 5 * ((y + 3) % 4) + 20 * ((z + 2) % 3);
            assert!((shifted[i] - q[from]).abs() < 1e-13, "{interpolation:?}");
        }
    }
}

#[test]
fn a_shift_of_waves_is_as_accurate_as_its_order() {
    // The bounds of the interpolation errors, for sin 2πx of one period.
    let error = |interpolation, n: usize| {
        let h = 1.0 / n as f64;
        let op = FieldShift::new(Grid::new([n], [h]).unwrap(), interpolation);
        let wave = |s: f64| (0..n).map(|i| (2.0 * PI * (i as f64 * h - s)).sin()).collect::<Vec<_>>();
        let out = op.shift(Vector::new(10.5 * h, 0.0, 0.0), &wave(0.0));
        out.iter().zip(wave(10.5 * h)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let k = 2.0 * PI / 64.0;
    for (interpolation, bound) in [
        (Lagrange1, 0.25 * k.powi(2) / 2.0),
        (Lagrange3, 9.0 / 16.0 * k.powi(4) / 24.0),
        (Lagrange5, 225.0 / 64.0 * k.powi(6) / 720.0),
    ] {
        let e = error(interpolation, 64);
        assert!(e <= bound && e > 0.98 * bound, "{interpolation:?}: {e} against {bound}");
    }
    for (interpolation, order) in [(CubicSpline, 4.0), (QuinticSpline, 6.0)] {
        let measured = (error(interpolation, 32) / error(interpolation, 64)).log2();
        assert!((measured - order).abs() < 0.1, "{interpolation:?} has order {measured}");
    }
    assert!(error(Spectral, 64) < 1e-13);
}

#[test]
fn there_and_back_leaves_as_much_of_a_sharp_disc_as_is_known() {
    // Root mean square over 20 parts of a cell. The reference page's figures are of one such disc on a way that is not told.
    let grid = Grid::new([40, 60], [1.0; 2]).unwrap();
    let q = disc([40, 60], 15.0);
    for (interpolation, known) in [
        (Lagrange1, 2.7e-2),
        (Lagrange3, 9.2e-3),
        (Lagrange5, 5.7e-3),
        (CubicSpline, 3.8e-3),
        (QuinticSpline, 2.1e-3),
    ] {
        let op = FieldShift::new(grid, interpolation);
        let error = |l: u32| {
            let s = Vector::new(0.0, f64::from(l) * 3.05, 0.0);
            distance(&op.shift(-s, &op.shift(s, &q)), &q) / norm(&q)
        };
        let error = ((0..20).map(|l| error(l).powi(2)).sum::<f64>() / 20.0).sqrt();
        assert!((error / known - 1.0).abs() < 0.25, "{interpolation:?}: {error:.2e} against {known:.1e}");
    }
    // What is left of the wave of two cells is its only error.
    let [even, odd] = [60, 61].map(|n| {
        let op = FieldShift::new(Grid::new([40, n], [1.0; 2]).unwrap(), Spectral);
        let (q, s) = (disc([40, n], 15.0), Vector::new(0.0, 7.1, 0.0));
        distance(&op.shift(-s, &op.shift(s, &q)), &q) / norm(&q)
    });
    assert!(even < 3.0e-4 && odd < 1e-14, "{even:.2e} {odd:.2e}");
}

#[test]
fn bounded_axes_continue_with_the_value_at_the_end() {
    for interpolation in ALL {
        let grid = Grid::new([40], [1.0]).unwrap().bounded([0]);
        let op = FieldShift::new(grid, interpolation);
        let q: Vec<f64> = (0..40).map(|i| 3.0 + ((f64::from(i) - 20.0) / 4.0).tanh()).collect();
        let right = op.shift(Vector::new(10.3, 0.0, 0.0), &q);
        assert!(right[..8].iter().all(|x| (x - 2.0).abs() < 2e-4), "{interpolation:?}: {right:?}");
        let exact = 3.0 + ((30.0 - 10.3 - 20.0_f64) / 4.0).tanh();
        assert!((right[30] - exact).abs() < 2e-3, "{interpolation:?}");
        let gone = op.shift(Vector::new(-1e9, 0.0, 0.0), &q);
        assert!(gone.iter().all(|x| (x - q[39]).abs() < 1e-12), "{interpolation:?}");
    }
}

/// Errors of a front that moves along a bounded axis of 96 cells: spectral shifts are as accurate
/// there as on a periodic axis, splines by their order.
#[test]
fn a_front_on_a_bounded_axis_is_shifted_spectrally() {
    let front = |x: f64| 0.5 - 0.5 * ((x - 40.3) / 4.0).tanh();
    let grid = Grid::new([96], [1.0]).unwrap().bounded([0]);
    let q: Vec<f64> = (0..96).map(|i| front(f64::from(i))).collect();
    for (interpolation, bound) in [(QuinticSpline, 1e-6), (Spectral, 1e-8)] {
        let op = FieldShift::new(grid, interpolation);
        for cells in [12.37, -9.81, 0.5] {
            let moved = op.shift(Vector::x() * cells, &q);
            let off = |(i, x): (usize, &f64)| (x - front(i as f64 - cells)).abs();
            let off = moved.iter().enumerate().map(off).fold(0.0, f64::max);
            assert!(off < bound, "{interpolation:?} by {cells}: {off:.1e}");
        }
    }
}

#[test]
fn an_axis_needs_cells() {
    assert_eq!(Grid::new([3, 0], [1.0, 1.0]), Err(ShiftedError::Axis { axis: 1, cells: 0, spacing: 1.0 }));
    assert!(matches!(Grid::new([3], [f64::NAN]), Err(ShiftedError::Axis { axis: 0, .. })));
}

proptest! {
    #[test]
    fn shifts_are_linear_and_have_their_transpose(
        cells in prop::array::uniform3(1_usize..9), s in prop::array::uniform3(-20.0..20.0), which in 0_usize..6, bounded in prop::array::uniform3(any::<bool>()), seed in any::<u64>()
    ) {
        let interpolation = ALL[which];
        let grid = Grid::new(cells, [1.0, 0.5, 2.0]).unwrap().bounded((0..3).filter(|&a| bounded[a]));
        let op = FieldShift::new(grid, interpolation);
        // Two components.
        let n = 2 * grid.n_cells();
        let (p, q, s) = (random(n, seed), random(n, seed ^ 1), Vector::from(s));
        let (tp, tq) = (op.shift(s, &p), op.shift(s, &q));
        let mixed: Vec<f64> = p.iter().zip(&q).map(|(p, q)| 2.0 * p - 3.0 * q).collect();
        let expected: Vec<f64> = tp.iter().zip(&tq).map(|(p, q)| 2.0 * p - 3.0 * q).collect();
        prop_assert!(distance(&op.shift(s, &mixed), &expected) < 1e-12 * (n as f64));
        let transposed = op.shift_transposed(s, &q);
        prop_assert!((dot(&tp, &q) - dot(&p, &transposed)).abs() < 1e-12 * (n as f64));
    }

    #[test]
    fn whole_periods_are_nothing(n in 2_usize..20, s in -3.0..3.0_f64, times in -5_i32..5, which in 0_usize..6) {
        let op = FieldShift::new(Grid::new([n], [1.0]).unwrap(), ALL[which]);
        let q = random(n, 5);
        let far = op.shift(Vector::new(s + f64::from(times) * n as f64, 0.0, 0.0), &q);
        prop_assert!(distance(&far, &op.shift(Vector::new(s, 0.0, 0.0), &q)) < 1e-11);
    }

    #[test]
    fn a_spectral_shift_has_an_inverse(n in 1_usize..20, s in -30.0..30.0_f64) {
        // Of an odd number of cells: there is no wave of two cells.
        let n = 2 * n + 1;
        let op = FieldShift::new(Grid::new([2, n], [1.0, 1.0]).unwrap(), Spectral);
        let q = random(2 * n, 6);
        let s = Vector::new(0.0, s, 0.0);
        prop_assert!(distance(&op.shift(-s, &op.shift(s, &q)), &q) < 1e-12);
        prop_assert!((norm(&op.shift(s, &q)) - norm(&q)).abs() < 1e-12);
    }
}
