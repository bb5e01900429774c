//! Wrong entries of small sets of snapshots.
use super::algorithms::quiet;
use super::random;
use crate::shifted::fourier::Als;
use crate::shifted::{
    Grid, GridFrames, Interpolation, Motions, Noise, Ranks, ShiftedError, ShiftedPod, StopReason,
};
use monomorphic::Mat;
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// Structures of ranks 3 and 2 that cross on a periodic line of 256 cells, with 40 snapshots.
fn crossing() -> (Motions, Mat<f64>) {
    let (m, n) = (256, 40);
    let path = |k: usize, j: usize| [4.1, -3.7][k] * j as f64;
    // Frame, place, width, and the amplitude b + c sin(ω t + φ) of every pulse.
    let pulses = [
        (0, 40.0, 7.0, 0.9, 0.4, 5.0, 0.3),
        (0, 52.0, 5.0, 0.3, 0.3, 3.1, 1.7),
        (0, 31.0, 9.0, 0.2, 0.2, 8.0, 4.0),
        (1, 200.0, 8.0, 0.8, 0.5, 4.0, 2.0),
        (1, 188.0, 5.0, 0.4, 0.3, 7.0, 0.9),
    ];
    let value = |i: usize, j: usize| {
        let of = |&(k, place, width, b, c, omega, phi): &(usize, f64, f64, f64, f64, f64, f64)| {
            let d = i as f64 - place - path(k, j);
            let d = d - m as f64 * (d / m as f64).round();
            let t = j as f64 / n as f64;
            (b + c * (omega * t * PI / 3.0 + phi).sin()) * (-(d / width).powi(2)).exp()
        };
        pulses.iter().map(of).sum()
    };
    let displacements = [0, 1].map(|k| (0..n).map(|j| path(k, j)).collect::<Vec<_>>());
    (Motions::along_x(&displacements).unwrap(), Mat::from_fn(m, n, value))
}

#[test]
fn wrong_entries_of_small_sets_are_found_with_the_ranks() {
    let (shifts, clean) = crossing();
    let (m, n) = clean.shape();
    let grid = Grid::new([m], [1.0]).unwrap();
    let op = GridFrames::new(grid, Interpolation::Spectral, &shifts, m).unwrap();
    for (share, seed) in [(0.005, 1), (0.03, 2), (0.12, 3)] {
        let numbers = random(2 * m * n, seed);
        let wrong = |i: usize, j: usize| {
            let [hit, size] = [0, 1].map(|c| 0.5 + 0.5 * numbers[2 * (i + m * j) + c]);
            if hit < share { [1.5, -1.5, 0.75, -0.75][(4.0 * size) as usize % 4] } else { 0.0 }
        };
        let data = Mat::from_fn(m, n, |i, j| clean[(i, j)] + wrong(i, j));
        for ranks in [Ranks::Given(vec![3, 2]), Ranks::Found] {
            let pod = ShiftedPod::new(grid, Interpolation::Spectral).noise(Noise::Sparse).ranks(ranks);
            let d = pod.solve(&shifts, data.as_ref(), None, &mut quiet).unwrap();
            let error = d.relative_error(&op, clean.as_ref());
            assert!(d.ranks() == [3, 2] && error < 1e-8, "{share}: {:?} {error:.1e}", d.ranks());
            assert_eq!(d.stopped, StopReason::Tolerance, "{share}");
            let noise = d.noise.as_ref().unwrap();
            let left = (&data - d.fields(&op) - noise).norm_l2() / data.norm_l2();
            let last = d.history.last().unwrap();
            assert!((last.error - left).abs() < 1e-12 && last.rank == 5, "{last:?} {left:.1e}");
            let entries = || (0..n).flat_map(|j| (0..m).map(move |i| (i, j)));
            let missed = entries().filter(|&(i, j)| wrong(i, j) != 0.0 && noise[(i, j)] == 0.0);
            assert_eq!(missed.count(), 0, "{share}");
        }
    }
}

/// 200 of 240 snapshots tell the modes. A bump in one of the others is no mode of theirs.
#[test]
fn an_event_between_the_snapshots_that_tell_modes_is_no_success() {
    let (m, n) = (48, 240);
    let way = |j: usize| 0.9 * j as f64;
    let pulse = |i: usize, j: usize, place: f64| {
        let d = i as f64 - place - way(j);
        (-((d - m as f64 * (d / m as f64).round()) / 4.0).powi(2)).exp()
    };
    let numbers = random(m * n, 7);
    let wrong = |i: usize, j: usize| if numbers[i + m * j] > 0.96 { 1.5 } else { 0.0 };
    let clean = Mat::from_fn(m, n, |i, j| pulse(i, j, 10.0));
    let shifts = Motions::along_x(&[(0..n).map(way).collect::<Vec<_>>()]).unwrap();
    let grid = Grid::new([m], [1.0]).unwrap();
    let op = GridFrames::new(grid, Interpolation::Spectral, &shifts, m).unwrap();
    let told: Vec<usize> = (0..200).map(|i| i * (n - 1) / 199).collect();
    let event = (0..n).find(|j| !told.contains(j)).unwrap();
    let pod = ShiftedPod::new(grid, Interpolation::Spectral).noise(Noise::Sparse);
    for (size, stopped) in [(0.0, StopReason::Tolerance), (2.0, StopReason::Stagnation)] {
        let bump = |i: usize, j: usize| {
            if j == event { size * (-0.01 * (i as f64 - 30.0).powi(2)).exp() } else { 0.0 }
        };
        let data = Mat::from_fn(m, n, |i, j| clean[(i, j)] + wrong(i, j) + bump(i, j));
        let d = pod.solve(&shifts, data.as_ref(), None, &mut quiet).unwrap();
        assert_eq!((d.ranks(), d.stopped), (vec![1], stopped));
        let noise = d.noise.as_ref().unwrap();
        if size == 0.0 {
            assert!(d.relative_error(&op, clean.as_ref()) < 1e-8);
            let found = |i: usize, j: usize| noise[(i, j)] != 0.0;
            assert!((0..n).all(|j| (0..m).all(|i| found(i, j) == (wrong(i, j) != 0.0))));
        }
    }
}

/// Two of five entries are wrong: that they are not found shows in the reason and in the last
/// error.
#[test]
fn too_many_wrong_entries_are_no_success() {
    let (shifts, clean) = crossing();
    let (m, n) = clean.shape();
    let numbers = random(2 * m * n, 5);
    let data = Mat::from_fn(m, n, |i, j| {
        let [hit, size] = [0, 1].map(|c| numbers[2 * (i + m * j) + c]);
        clean[(i, j)] + if hit < -0.2 { 1.5 * size } else { 0.0 }
    });
    let pod = ShiftedPod::new(Grid::new([m], [1.0]).unwrap(), Interpolation::Spectral);
    let pod = pod.noise(Noise::Sparse).ranks(Ranks::Given(vec![3, 2]));
    let d = pod.solve(&shifts, data.as_ref(), None, &mut quiet).unwrap();
    let (error, stopped) = (d.history.last().unwrap().error, d.stopped);
    assert!(stopped == StopReason::Stagnation && error > 1e-2, "{stopped:?} {error:.1e}");
}

#[test]
fn a_stop_at_any_step_ends_the_descent() {
    let (m, n) = (64, 20);
    let shifts = Motions::along_x(&[1.7, -2.3].map(|v| (0..n).map(|j| v * j as f64).collect::<Vec<_>>()));
    let numbers = random(m * n, 4);
    let data = Mat::from_fn(m, n, |i, j| {
        let pulse = |place: f64| {
            let d = i as f64 - place;
            (-((d - m as f64 * (d / m as f64).round()) / 4.0).powi(2)).exp()
        };
        let hit = numbers[i + m * j] > 0.96;
        pulse(10.0 + 1.7 * j as f64) + pulse(50.0 - 2.3 * j as f64) + if hit { 1.5 } else { 0.0 }
    });
    let grid = Grid::new([m], [1.0]).unwrap();
    let pod = ShiftedPod::new(grid, Interpolation::Spectral).noise(Noise::Sparse);
    let run = |most: usize| {
        let mut calls = 0;
        let d = pod.solve(shifts.as_ref().unwrap(), data.as_ref(), None, &mut |_| {
            calls += 1;
            if calls < most { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
        (d.unwrap(), calls)
    };
    let (whole, steps) = run(usize::MAX);
    assert!(whole.stopped != StopReason::Asked && whole.ranks() == [1, 1], "{:?}", whole.ranks());
    for most in (1..=steps).step_by(17) {
        let (d, calls) = run(most);
        assert_eq!((d.stopped, calls, d.history.len()), (StopReason::Asked, most, most));
    }
}

/// σ of the minimum of ½ ‖Q − σ φ aᵀ‖² + ½ w σ² is that of Q over 1 + w.
#[test]
fn the_weight_of_the_fields_shrinks_them() {
    let (shifts, _) = crossing();
    let grid = Grid::new([256], [1.0]).unwrap();
    let one = Mat::from_fn(256, 40, |i, j| {
        let d = i as f64 - 40.0 - 4.1 * j as f64;
        (-((d - 256.0 * (d / 256.0).round()) / 7.0).powi(2)).exp()
    });
    let expected = one.norm_l2() / 1.1;
    let als = Als { ridge: 0.1, stagnation: 0.0, max_steps: 60, ..Als::new([1, 0]) };
    let d = als.solve(&grid, &shifts, one.as_ref(), None, None, &mut |_| true).unwrap();
    let found = d.frames[0].singular_values[0];
    assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
    for ridge in [0.0, -1.0, f64::NAN] {
        let als = Als { ridge, ..Als::new([1, 0]) };
        let error = als.solve(&grid, &shifts, one.as_ref(), None, None, &mut |_| true);
        assert!(matches!(error, Err(ShiftedError::Parameter { .. })), "{ridge}");
    }
}
