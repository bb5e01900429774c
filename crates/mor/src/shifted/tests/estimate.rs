//! Shifts from the snapshots themselves.
use super::algorithms::{crossing_waves, quiet};
use super::random;
use crate::shifted::{Grid, Interpolation, Motions, ShiftEstimate, ShiftedError, Shifts};
use interfaces::Vector;
use monomorphic::Mat;

/// The largest distance between two paths, once both begin at the same place.
fn off(motions: &Motions, k: usize, path: impl Fn(usize) -> Vector) -> f64 {
    (0..motions.n_snapshots())
        .map(|j| (motions.motion(k, j).displacement - path(j) + path(0)).norm())
        .fold(0.0, f64::max)
}

#[test]
fn crossing_waves_tell_their_speeds() {
    let (_, q) = crossing_waves(Interpolation::Spectral);
    let grid = Grid::new([400], [1.0 / 400.0]).unwrap();
    let (motions, error) = ShiftEstimate::new(grid, 2).estimate(q.as_ref(), &mut quiet).unwrap();
    let t = |j: usize| j as f64 * 0.5 / 200.0;
    // Equally fast: either may be the first.
    let sign = motions.motion(0, 199).displacement.x.signum();
    let worst = off(&motions, 0, |j| Vector::x() * (sign * t(j)))
        .max(off(&motions, 1, |j| Vector::x() * (-sign * t(j))));
    assert!(error < 1e-7 && worst < 1e-8, "{error:.1e} {worst:.1e}");
}

#[test]
fn noise_does_not_hide_speeds() {
    let (_, mut q) = crossing_waves(Interpolation::Spectral);
    let numbers = random(400 * 200, 3);
    let amount = 0.1 * q.norm_l2() / 80_000_f64.sqrt();
    (0..400 * 200).for_each(|i| q[(i % 400, i / 400)] += amount * 3_f64.sqrt() * numbers[i]);
    let grid = Grid::new([400], [1.0 / 400.0]).unwrap();
    let (motions, error) = ShiftEstimate::new(grid, 2).estimate(q.as_ref(), &mut quiet).unwrap();
    let t = |j: usize| j as f64 * 0.5 / 200.0;
    let sign = motions.motion(0, 199).displacement.x.signum();
    let worst = off(&motions, 0, |j| Vector::x() * (sign * t(j)))
        .max(off(&motions, 1, |j| Vector::x() * (-sign * t(j))));
    // A tenth of noise, paths to a tenth of a cell.
    assert!((error - 0.1).abs() < 0.02 && worst < 0.1 / 400.0, "{error:.1e} {worst:.1e}");
}

#[test]
fn accelerating_bumps_in_a_plane_tell_their_paths() {
    let grid = Grid::new([48, 64], [1.0, 0.5]).unwrap();
    let n = 90;
    let path = |k: usize, j: usize| {
        let t = j as f64 / 89.0;
        [Vector::new(6.0 * t, -26.0 * t - 30.0 * t * t, 0.0), Vector::new(-10.0 * t * t, 14.0 * t, 0.0)][k]
    };
    let bump = |i: usize, j: usize, k: usize| {
        let d = grid.centre(i) - [Vector::new(12.0, 20.0, 0.0), Vector::new(34.0, 8.0, 0.0)][k] - path(k, j);
        let d = [d.x - 48.0 * (d.x / 48.0).round(), d.y - 32.0 * (d.y / 32.0).round()];
        let width = [2.5, 3.0][k];
        (-(d[0] * d[0] + d[1] * d[1]) / (width * width)).exp()
    };
    let q = Mat::from_fn(48 * 64, n, |i, j| bump(i, j, 0) + bump(i, j, 1));
    let (motions, error) = ShiftEstimate::new(grid, 2).estimate(q.as_ref(), &mut quiet).unwrap();
    let worst = off(&motions, 0, |j| path(0, j)).max(off(&motions, 1, |j| path(1, j)));
    assert!(error < 1e-6 && worst < 1e-5, "{error:.1e} {worst:.1e}");
}

#[test]
fn what_cannot_be_estimated_is_told() {
    let grid = Grid::new([16], [1.0]).unwrap();
    let q = Mat::from_fn(16, 20, |i, j| ((i + j) as f64).sin());
    let told = |grid, n, q: &Mat<f64>| ShiftEstimate::new(grid, n).estimate(q.as_ref(), &mut quiet).err();
    assert_eq!(told(grid, 0, &q), Some(ShiftedError::Empty { snapshots: 20, frames: 0 }));
    assert_eq!(told(grid, 1, &Mat::zeros(16, 5)), Some(ShiftedError::Empty { snapshots: 5, frames: 1 }));
    assert_eq!(told(grid, 1, &Mat::zeros(17, 20)), Some(ShiftedError::Rows { rows: 17, cells: 16 }));
    assert!(matches!(told(grid.bounded([0]), 1, &q), Some(ShiftedError::NotPeriodic { .. })));
    let mut broken = q.clone();
    broken[(3, 7)] = f64::NAN;
    assert!(matches!(told(grid, 1, &broken), Some(ShiftedError::NotFinite { snapshot: 7, .. })));
    // Nothing moves: nothing is estimated to move.
    let (motions, error) =
        ShiftEstimate::new(grid, 1).estimate(Mat::zeros(16, 20).as_ref(), &mut quiet).unwrap();
    assert_eq!((error, off(&motions, 0, |_| Vector::zeros())), (0.0, 0.0));
}
