//! Decompositions by way of any operators.
use super::random;
use crate::shifted::{
    Decomposition, FrameOperators, Grid, GridFrames, Interpolation, JointDescent, Motion, Motions,
    MultiFrame, Progress, ShiftedError, StopReason,
};
use interfaces::{Point, Rotation, Vector};
use monomorphic::Mat;
use std::ops::ControlFlow;

/// Looks on and lets it go on.
pub(super) fn quiet(_: &Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// The crossing waves of the reference page.
pub(super) fn crossing_waves(interpolation: Interpolation) -> (GridFrames, Mat<f64>) {
    let (m, n) = (400, 200);
    let [x, t] = [|i: usize| i as f64 / 400.0, |j: usize| j as f64 * 0.5 / 200.0];
    let wave = |x: f64, at: f64| (-((x.rem_euclid(1.0) - at) / 0.015).powi(2)).exp();
    let q = Mat::from_fn(m, n, |i, j| wave(x(i) - t(j), 0.1) + wave(x(i) + t(j), 0.9));
    let shifts = Motions::along_x(&[(0..n).map(t).collect(), (0..n).map(|j| 0.8 - t(j)).collect()]).unwrap();
    let grid = Grid::new([m], [1.0 / 400.0]).unwrap();
    (GridFrames::new(grid, interpolation, &shifts, m).unwrap(), q)
}

/// Fields of these ranks in frames that move along x, with random modes of some waves and smooth coefficients.
pub(super) fn synthetic(op: &dyn FrameOperators, ranks: &[usize], seed: u64) -> Mat<f64> {
    let (m, n) = (op.n_rows(), op.n_snapshots());
    let mut sum = Mat::zeros(m, n);
    for (k, &r) in ranks.iter().enumerate() {
        let numbers = random(r * 20, seed + k as u64);
        let mode = |x: usize, i: usize| -> f64 {
            let x = x as f64 / m as f64 * 2.0 * std::f64::consts::PI;
            (1..10)
                .map(|w| {
                    numbers[20 * i + w] * (w as f64 * x).cos()
                        + numbers[20 * i + 10 + w] * (w as f64 * x).sin()
                })
                .sum()
        };
        let rise = |j: usize, i: usize| (1.0 + i as f64 * 2.3 * j as f64 / n as f64 + k as f64).cos();
        let mut field = Mat::from_fn(m, n, |x, j| (0..r).map(|i| mode(x, i) * rise(j, i)).sum());
        op.to_lab(k, field.as_mut());
        sum += field;
    }
    sum
}

#[test]
fn crossing_waves_are_two_modes() {
    let (op, q) = crossing_waves(Interpolation::Spectral);
    let iterated = MultiFrame::new([1, 1]).solve(&op, q.as_ref(), None, &mut quiet).unwrap();
    let descended = JointDescent::new([1, 1]).solve(&op, q.as_ref(), None, &mut quiet).unwrap();
    for d in [&iterated, &descended] {
        let error = d.relative_error(&op, q.as_ref());
        assert!(error < 1e-9, "{error:.1e} {:?} {}", d.stopped, d.history.len());
        assert!((error - d.history.last().unwrap().error).abs() < 1e-12);
        assert_eq!(d.stopped, StopReason::Tolerance);
    }
}

#[test]
fn fields_of_these_ranks_are_recovered() {
    // Lagrange's polynomials have no inverse, but fields that they carried along are still recovered exactly.
    let n = 40;
    let shift = |v: f64, a: f64| {
        (0..n).map(|j| v * f64::from(j) / 40.0 + a * f64::from(j * j) / 1600.0).collect::<Vec<_>>()
    };
    let shifts = Motions::along_x(&[shift(1.3, 0.4), shift(-0.9, 0.0), shift(0.0, 0.7)]).unwrap();
    let grid = Grid::new([90], [1.0 / 90.0]).unwrap();
    for (interpolation, ranks) in
        [(Interpolation::Spectral, [2, 3, 1]), (Interpolation::Lagrange5, [1, 2, 1])]
    {
        let op = GridFrames::new(grid, interpolation, &shifts, 90).unwrap();
        let q = synthetic(&op, &ranks, 7);
        let d = JointDescent::new(ranks).solve(&op, q.as_ref(), None, &mut quiet).unwrap();
        let error = d.relative_error(&op, q.as_ref());
        assert!(error < 1e-9, "{interpolation:?} {error:.1e} {:?} {:?}", d.stopped, d.history);
        assert_eq!(d.ranks(), ranks);
        for frame in &d.frames {
            let r = frame.rank();
            let identity = Mat::<f64>::identity(r, r);
            assert!((frame.modes.transpose() * &frame.modes - &identity).norm_max() < 1e-12);
            assert!((&frame.coefficients * frame.coefficients.transpose() - &identity).norm_max() < 1e-12);
        }
    }
}

#[test]
fn a_body_that_turns_on_its_way_is_one_mode() {
    let grid = Grid::new([45, 40], [1.0; 2]).unwrap();
    let n = 30;
    let motions = Motions::by(2, n, |k, j| {
        let t = j as f64 / 29.0;
        match k {
            0 => Motion {
                displacement: Vector::new(40.0 * t, 10.0 * t * t, 0.0),
                rotation: Rotation::new(Vector::z() * (5.0 * t)),
                centre: Point::new(12.0, 14.0, 0.0),
            },
            _ => Motion::translation(Vector::new(0.0, -35.0 * t, 0.0)),
        }
    });
    let op = GridFrames::new(grid, Interpolation::Spectral, &motions, 1800).unwrap();
    let bump = |i: usize, c: [f64; 2], w: [f64; 2]| {
        let x = grid.centre(i);
        (-((x.x - c[0]) / w[0]).powi(2) - ((x.y - c[1]) / w[1]).powi(2)).exp()
    };
    let mut q = Mat::from_fn(1800, n, |i, _| bump(i, [12.0, 14.0], [2.5, 4.5]));
    op.to_lab(0, q.as_mut());
    let mut other = Mat::from_fn(1800, n, |i, j| bump(i, [30.0, 25.0], [3.5, 3.0]) * (1.0 + 0.02 * j as f64));
    op.to_lab(1, other.as_mut());
    q += other;
    let d = JointDescent::new([1, 1]).solve(&op, q.as_ref(), None, &mut quiet).unwrap();
    let error = d.relative_error(&op, q.as_ref());
    assert!(error < 1e-8, "{error:.1e} {:?}", d.history);
}

#[test]
fn entries_that_are_not_known_do_not_matter() {
    let (op, clean) = crossing_waves(Interpolation::Spectral);
    let mut q = clean.clone();
    let numbers = random(400 * 200, 9);
    let entries: Vec<_> = (0..400)
        .flat_map(|i| (0..200).map(move |j| (i, j)))
        .filter(|&(i, j)| numbers[i + 400 * j] < -0.75)
        .collect();
    entries.iter().for_each(|&at| q[at] = 17.0);
    let d = JointDescent::new([1, 1]).ignoring(entries).solve(&op, q.as_ref(), None, &mut quiet).unwrap();
    assert!(d.relative_error(&op, clean.as_ref()) < 1e-7, "{:?}", d.history);
}

#[test]
fn the_order_of_frames_does_not_matter() {
    let n = 30;
    let shift = |v: f64| (0..n).map(|j| v * f64::from(j)).collect::<Vec<_>>();
    let grid = Grid::new([64], [1.0]).unwrap();
    let frames = |speeds: [f64; 2]| {
        let shifts = Motions::along_x(&speeds.map(shift)).unwrap();
        GridFrames::new(grid, Interpolation::Spectral, &shifts, 64).unwrap()
    };
    let (a, b) = (frames([1.5, -1.0]), frames([-1.0, 1.5]));
    let q = synthetic(&a, &[1, 2], 3);
    let solve = |op: &GridFrames, ranks: [usize; 2]| -> Decomposition {
        JointDescent::new(ranks).tolerance(1e-12).solve(op, q.as_ref(), None, &mut quiet).unwrap()
    };
    let (one, two) = (solve(&a, [1, 2]), solve(&b, [2, 1]));
    // Up to what is at rest in both frames, the mean, which is in neither here.
    let difference = (one.fields(&a) - two.fields(&b)).norm_l2() / q.norm_l2();
    assert!(difference < 1e-10, "{difference:.1e} {:?} {:?}", one.history, two.history);
}

#[test]
fn odd_snapshots_are_decomposed_or_named() {
    let grid = Grid::new([12], [1.0]).unwrap();
    let frames = |n: usize| {
        let far = |v: f64| (0..n).map(|j| v * j as f64).collect::<Vec<_>>();
        let shifts = Motions::along_x(&[far(1e3), far(-5.25)]).unwrap();
        GridFrames::new(grid, Interpolation::Spectral, &shifts, 12).unwrap()
    };
    let solve = |q: &Mat<f64>, ranks: [usize; 2]| {
        JointDescent::new(ranks).solve(&frames(q.ncols()), q.as_ref(), None, &mut quiet)
    };
    // Constant, zero, one snapshot, more snapshots than cells.
    for (q, bound) in [
        (Mat::from_fn(12, 5, |_, _| 3.0), 1e-9),
        (Mat::zeros(12, 5), 1e-300),
        (Mat::from_fn(12, 1, |i, _| (i as f64).sin()), 1e-9),
        (synthetic(&frames(40), &[1, 1], 5), 1e-8),
    ] {
        let d = solve(&q, [1, 1]).unwrap();
        let error = d.history.last().unwrap().error;
        assert!(error <= bound, "{error:.1e} of {:?}, {:?}", q.shape(), d.history);
    }
    // More ranks than there are.
    let q = synthetic(&frames(40), &[1, 1], 5);
    let d = solve(&q, [5, 99]).unwrap();
    assert!(d.history.last().unwrap().error < 1e-6, "{:?}", d.history);
    let mut broken = q.clone();
    broken[(3, 17)] = f64::NAN;
    assert!(matches!(solve(&broken, [1, 1]), Err(ShiftedError::NotFinite { snapshot: 17, row: 3, .. })));
    let op = frames(39);
    let other = JointDescent::new([1, 1]).solve(&op, q.as_ref(), None, &mut quiet);
    assert_eq!(other.err(), Some(ShiftedError::Snapshots { snapshots: 40, shifts: 39 }));
    let ranks = JointDescent::new([1]).solve(&frames(40), q.as_ref(), None, &mut quiet);
    assert_eq!(ranks.err(), Some(ShiftedError::Ranks { ranks: 1, frames: 2 }));
}
