//! Ranks and wrong entries found, modes fitted.
use super::algorithms::{crossing_waves, quiet, synthetic};
use super::proximal::salt_and_pepper;
use super::random;
use crate::shifted::fourier::Als;
use crate::shifted::waves::Waves;
use crate::shifted::{
    Decomposition, FrameOperators, Grid, GridFrames, Interpolation, Motion, Motions, Noise, Ranks,
    ShiftedError, ShiftedPod, StopReason,
};
use interfaces::Vector;
use monomorphic::Mat;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;
use std::ops::ControlFlow;

fn waves_shifts() -> Motions {
    let t = |j: usize| j as f64 * 0.5 / 200.0;
    Motions::along_x(&[(0..200).map(t).collect(), (0..200).map(|j| 0.8 - t(j)).collect()]).unwrap()
}

fn pod() -> ShiftedPod {
    ShiftedPod::new(Grid::new([400], [1.0 / 400.0]).unwrap(), Interpolation::Spectral)
}

#[test]
fn clean_snapshots_need_as_many_modes_as_they_have() {
    let (op, q) = crossing_waves(Interpolation::Spectral);
    let d = pod().solve(&waves_shifts(), q.as_ref(), None, &mut quiet).unwrap();
    let error = d.relative_error(&op, q.as_ref());
    assert!(d.ranks() == [1, 1] && error < 1e-9 && d.attempts == 0, "{:?} {error:.1e}", d.ranks());
    assert!(d.history.iter().enumerate().all(|(i, p)| p.step == i + 1));
    // From there nothing is left to do.
    let again = pod().solve(&waves_shifts(), q.as_ref(), Some(&d.frames), &mut quiet).unwrap();
    assert!(again.relative_error(&op, q.as_ref()) < 1e-9);
    assert!(again.history.len() < d.history.len());
}

#[test]
fn normal_noise_is_averaged_out() {
    // 2 (400 + 200) unknowns from 80 000 entries: √(1200 / 80 000) of the noise is left.
    let (op, clean) = crossing_waves(Interpolation::Spectral);
    let numbers = random(12 * 80_000, 5);
    let normal = Mat::from_fn(400, 200, |i, j| 0.5 * numbers[12 * (i + 400 * j)..][..12].iter().sum::<f64>());
    let amount = 0.05 * clean.norm_l2() / normal.norm_l2();
    let q = Mat::from_fn(400, 200, |i, j| clean[(i, j)] + amount * normal[(i, j)]);
    for ranks in [Ranks::Given(vec![1, 1]), Ranks::Found] {
        for noise in [Noise::Dense, Noise::Sparse] {
            let d = pod()
                .ranks(ranks.clone())
                .noise(noise)
                .solve(&waves_shifts(), q.as_ref(), None, &mut quiet)
                .unwrap();
            let error = d.relative_error(&op, clean.as_ref());
            // What is left is the noise: another fit ends there as well, and is the last.
            let given = ranks != Ranks::Found && noise == Noise::Dense;
            assert_eq!(d.attempts, usize::from(given));
            assert!(error < 6.5e-3 && d.ranks() == [1, 1], "{ranks:?} {noise:?} {error:.2e} {:?}", d.ranks());
        }
    }
}

#[test]
fn wrong_entries_are_found() {
    let (op, clean) = crossing_waves(Interpolation::Spectral);
    for (part, bound) in [(0.05, 1e-8), (0.125, 1e-8)] {
        let q = salt_and_pepper(&clean, part, 11);
        for ranks in [Ranks::Given(vec![1, 1]), Ranks::Found] {
            let d = pod()
                .ranks(ranks.clone())
                .noise(Noise::Sparse)
                .solve(&waves_shifts(), q.as_ref(), None, &mut quiet)
                .unwrap();
            let error = d.relative_error(&op, clean.as_ref());
            assert!(error < bound && d.ranks() == [1, 1], "{part} {ranks:?} {error:.2e} {:?}", d.ranks());
            // What was wrong is the noise.
            let noise = d.noise.unwrap();
            assert!((noise - (&q - &clean)).norm_l2() < 1e-3 * clean.norm_l2());
        }
    }
}

/// Two discs of radius 10.7 whose edges are one cell wide fall side by side; the edges' small modes must not be taken for wrong entries.
#[test]
fn wrong_entries_beside_edges_are_told_from_edges() {
    let (cells, radius, n) = ([96, 182], 10.677, 197);
    let way = |k: usize, j: usize| {
        let t = j as f64 / (n - 1) as f64;
        [-154.1 * (0.546 * t + 0.454 * t * t), -122.8 * (0.148 * t + 0.852 * t * t)][k]
    };
    let starts = [[23.25, 73.31], [71.53, 42.73]];
    let grid = Grid::new(cells, [1.0; 2]).unwrap();
    let off = |x: f64, period: f64| x - period * (x / period).round();
    let clean = Mat::from_fn(cells[0] * cells[1], n, |i, j| {
        let x = grid.centre(i);
        let disc = |k: usize| {
            let r = off(x.x - starts[k][0], 96.0).hypot(off(x.y - starts[k][1] - way(k, j), 182.0));
            0.5 - 0.5 * (r - radius).tanh()
        };
        disc(0) + disc(1)
    });
    let shifts = Motions::by(2, n, |k, j| Motion::translation(Vector::y() * way(k, j)));
    let op = GridFrames::new(grid, Interpolation::Spectral, &shifts, clean.nrows()).unwrap();
    // One of six such noises in which levels that fell faster than the modes followed stopped at 1.4e-4.
    let q = salt_and_pepper(&clean, 0.05, 6);
    let d = ShiftedPod::new(grid, Interpolation::Spectral)
        .noise(Noise::Sparse)
        .ranks(Ranks::Given(vec![3, 3]))
        .solve(&shifts, q.as_ref(), None, &mut quiet)
        .unwrap();
    let error = d.relative_error(&op, clean.as_ref());
    assert!(error < 1e-5, "{error:.2e}");
}

#[test]
fn ranks_of_three_frames_are_found() {
    let n = 60;
    let shift = |v: f64, a: f64| {
        (0..n).map(|j| v * f64::from(j) / 60.0 + a * f64::from(j * j) / 3600.0).collect::<Vec<_>>()
    };
    let shifts = Motions::along_x(&[shift(1.3, 0.4), shift(-0.9, 0.0), shift(0.0, 0.7)]).unwrap();
    let grid = Grid::new([90], [1.0 / 90.0]).unwrap();
    let op = GridFrames::new(grid, Interpolation::Spectral, &shifts, 90).unwrap();
    for (ranks, seed) in [([2, 3, 1], 7), ([1, 1, 1], 8), ([0, 2, 2], 9), ([4, 1, 2], 10), ([1, 5, 1], 60)] {
        let q = synthetic(&op, &ranks, seed);
        let d = ShiftedPod::new(grid, Interpolation::Spectral)
            .solve(&shifts, q.as_ref(), None, &mut quiet)
            .unwrap();
        let error = d.relative_error(&op, q.as_ref());
        assert!(d.ranks() == ranks && error < 1e-9, "{ranks:?}: {:?} {error:.1e}", d.ranks());
    }
}

#[test]
fn many_snapshots_are_thinned_out_first() {
    // A plane with ends across the way; two components.
    let (grid, n) = (Grid::new([40, 9], [1.0, 1.0]).unwrap().bounded([1]), 300);
    let shift = |v: f64| (0..n).map(|j| Vector::new(v * f64::from(j) / 30.0, 0.0, 0.0)).collect::<Vec<_>>();
    let shifts = Motions::translations(&[shift(3.7), shift(-4.9)]).unwrap();
    let op = GridFrames::new(grid, Interpolation::Spectral, &shifts, 720).unwrap();
    let q = synthetic(&op, &[2, 1], 4);
    let d =
        ShiftedPod::new(grid, Interpolation::Spectral).solve(&shifts, q.as_ref(), None, &mut quiet).unwrap();
    let error = d.relative_error(&op, q.as_ref());
    assert!(d.ranks() == [2, 1] && error < 1e-8, "{:?} {error:.1e} {:?}", d.ranks(), d.history);
}

#[test]
fn other_interpolations_find_ranks_too() {
    let (_, q) = crossing_waves(Interpolation::Spectral);
    for (interpolation, bound) in [(Interpolation::Lagrange5, 5e-5), (Interpolation::QuinticSpline, 5e-5)] {
        let (op, _) = crossing_waves(interpolation);
        let d = ShiftedPod::new(Grid::new([400], [1.0 / 400.0]).unwrap(), interpolation)
            .solve(&waves_shifts(), q.as_ref(), None, &mut quiet)
            .unwrap();
        let error = d.relative_error(&op, q.as_ref());
        assert!(d.ranks() == [1, 1] && error < bound, "{interpolation:?} {:?} {error:.1e}", d.ranks());
    }
}

#[test]
fn who_looks_on_may_stop() {
    let (_, q) = crossing_waves(Interpolation::Spectral);
    for noise in [Noise::Dense, Noise::Sparse] {
        let mut steps = 0;
        let mut three = |_: &_| {
            steps += 1;
            if steps == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let d = pod().noise(noise).solve(&waves_shifts(), q.as_ref(), None, &mut three).unwrap();
        assert_eq!((d.stopped, d.history.len(), steps), (StopReason::Asked, 3, 3), "{noise:?}");
    }
}

#[test]
fn odd_snapshots_are_decomposed_or_named() {
    let grid = Grid::new([12], [1.0]).unwrap();
    let shifts = |n: usize| {
        let far = |v: f64| (0..n).map(|j| v * j as f64).collect::<Vec<_>>();
        Motions::along_x(&[far(1e3), far(-5.25)]).unwrap()
    };
    let solve = |q: &Mat<f64>, noise| {
        ShiftedPod::new(grid, Interpolation::Spectral).noise(noise).solve(
            &shifts(q.ncols()),
            q.as_ref(),
            None,
            &mut quiet,
        )
    };
    for noise in [Noise::Dense, Noise::Sparse] {
        for q in [
            Mat::from_fn(12, 5, |_, _| 3.0),
            Mat::zeros(12, 5),
            Mat::from_fn(12, 1, |i, _| (i as f64).sin()),
            Mat::from_fn(12, 200, |i, j| {
                ((i as f64 - 5.25 * j as f64) / 12.0 * 2.0 * std::f64::consts::PI).sin()
            }),
        ] {
            let d = solve(&q, noise).unwrap();
            let op = GridFrames::new(grid, Interpolation::Spectral, &shifts(q.ncols()), 12).unwrap();
            let left = (d.fields(&op) - &q).norm_l2();
            assert!(left <= 1e-4 * q.norm_l2(), "{noise:?} {:?}: {left:.1e} {:?}", q.shape(), d.ranks());
        }
        let mut broken = Mat::from_fn(12, 5, |i, j| (i + j) as f64);
        broken[(3, 2)] = f64::INFINITY;
        assert!(matches!(solve(&broken, noise), Err(ShiftedError::NotFinite { snapshot: 2, row: 3, .. })));
    }
}

proptest! {
    #[test]
    fn waves_are_fields(cells in prop::array::uniform3(1_usize..7), s in prop::array::uniform3(-9.0..9.0), seed in any::<u64>()) {
        let grid = Grid::new(cells, [1.0, 0.5, 2.0]).unwrap();
        let s = Vector::from_fn(|a, _| if cells[a] > 1 { s[a] } else { 0.0 });
        let shifts = Motions::by(1, 3, |_, j| Motion::translation(s * j as f64));
        let n = 2 * grid.n_cells();
        let op = GridFrames::new(grid, Interpolation::Spectral, &shifts, n).unwrap();
        let Some(waves) = Waves::new(&grid, &shifts, n) else { prop_assert_eq!(grid.n_cells(), 1); return Ok(()) };
        let numbers = random(3 * n, seed);
        let q = Mat::from_fn(n, 3, |i, j| numbers[i + n * j]);
        let w = waves.waves(q.as_ref());
        prop_assert!((w.norm_l2() / q.norm_l2() - 1.0).abs() < 1e-12);
        prop_assert!((waves.fields(w.as_ref()) - &q).norm_l2() < 1e-12 * q.norm_l2());
        for task in [0, 1, 2] {
            let (mut a, mut b) = (q.clone(), w.clone());
            let both: [&dyn FrameOperators; 2] = [&op, &waves];
            for (op, x) in both.into_iter().zip([&mut a, &mut b]) {
                match task {
                    0 => op.to_lab(0, x.as_mut()),
                    1 => op.to_frame(0, x.as_mut()),
                    _ => op.to_lab_transposed(0, x.as_mut()),
                }
            }
            prop_assert!((waves.fields(b.as_ref()) - a).norm_l2() < 1e-11 * q.norm_l2());
        }
    }
}

/// Pulses in two frames that move against one another by a few cells.
fn near_frames(seed: u64) -> (Motions, Mat<f64>, Vec<usize>) {
    let mut rng = Pcg64::seed_from_u64(seed);
    let (m, n) = (128, 120);
    let speeds = [(); 2].map(|()| rng.random_range(-6.0..6.0));
    let common: f64 = rng.random_range(-60.0..60.0);
    let ranks = [(); 2].map(|()| rng.random_range(1..4_usize));
    let time = |j: usize| j as f64 / n as f64;
    let way = |k: usize, j: usize| common * time(j).powi(2) + speeds[k] * time(j);
    let mut q = Mat::zeros(m, n);
    for c in 0..ranks[0] + ranks[1] {
        let [place, phase] = [(); 2].map(|()| rng.random_range(0.0..128.0));
        let [width, beat, height] = [3.0..9.0, 0.5..3.0, 0.3..1.0].map(|range| rng.random_range(range));
        let k = usize::from(c >= ranks[0]);
        q += Mat::from_fn(m, n, |i, j| {
            let x = i as f64 - place - way(k, j);
            let x = (x - 128.0 * (x / 128.0).round()) / width;
            height * (1.0 + 0.5 * (beat * PI * time(j) + phase).sin()) * (-x * x).exp()
        });
    }
    let shifts = Motions::by(2, n, |k, j| Motion::translation(Vector::x() * way(k, j)));
    (shifts, q, ranks.to_vec())
}

#[test]
fn a_fit_that_is_stuck_is_tried_in_other_ways() {
    let grid = Grid::new([128], [1.0]).unwrap();
    let (shifts, q, ranks) = near_frames(105);
    let once = Als { tolerance: 1e-10, ..Als::new(ranks.clone()) };
    let once = once.solve(&grid, &shifts, q.as_ref(), None, None, &mut |_| true).unwrap();
    let error = |d: &Decomposition| d.history.last().unwrap().error;
    assert!(
        once.stopped == StopReason::Stagnation && error(&once) > 1e-5,
        "{:?} {:.1e}",
        once.stopped,
        error(&once)
    );
    let pod = ShiftedPod::new(grid, Interpolation::Spectral).ranks(Ranks::Given(ranks));
    let d = pod.solve(&shifts, q.as_ref(), None, &mut quiet).unwrap();
    let op = GridFrames::new(grid, Interpolation::Spectral, &shifts, 128).unwrap();
    let measured = d.relative_error(&op, q.as_ref());
    assert!(measured < 1e-9 && d.attempts == 1, "{measured:.1e} after {}", d.attempts);
    assert!((error(&d) - measured).abs() < 0.1 * measured + 1e-10, "{:.1e}", error(&d));
    // Who looks on may stop what is tried, too.
    let mut steps = 0;
    let more = once.history.len() + 3;
    let stopped = pod.solve(&shifts, q.as_ref(), None, &mut |_| {
        steps += 1;
        if steps < more { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    let stopped = stopped.unwrap();
    assert_eq!((stopped.stopped, stopped.history.len(), steps), (StopReason::Asked, more, more));
}

/// Tolerances that are no numbers, and snapshots whose squares leave double precision, are errors; of others only the
/// size changes with the snapshots'.
#[test]
fn tolerances_and_sizes_that_are_not_usable() {
    let (_, q) = crossing_waves(Interpolation::Spectral);
    for bad in [f64::NAN, -1e-3] {
        for pod in [pod().tolerance(bad), pod().rank_tolerance(bad)] {
            let found = pod.solve(&waves_shifts(), q.as_ref(), None, &mut quiet).err();
            assert!(matches!(found, Some(ShiftedError::Tolerance { .. })), "{bad}: {found:?}");
        }
    }
    let scaled = |scale: f64| Mat::from_fn(q.nrows(), q.ncols(), |i, j| scale * q[(i, j)]);
    for noise in [Noise::Dense, Noise::Sparse] {
        for scale in [1e-300, 1e-160, 1e160] {
            let found =
                pod().noise(noise).solve(&waves_shifts(), scaled(scale).as_ref(), None, &mut quiet).err();
            assert!(matches!(found, Some(ShiftedError::Size { .. })), "{scale:e}: {found:?}");
        }
        for scale in [1e-55, 1e70] {
            let found =
                pod().noise(noise).solve(&waves_shifts(), scaled(scale).as_ref(), None, &mut quiet).unwrap();
            assert_eq!(found.ranks(), [1, 1], "{scale:e} {noise:?}");
        }
    }
}

/// Two boxes whose edges run apart and a pulse at rest: splines alone stop at an error of 1e-2,
/// from spectral modes they reach that of their interpolation.
#[test]
fn splines_start_from_spectral_modes() {
    let (n, n_t, width) = (400, 60, 2.0);
    let nearest = |x: f64| x - n as f64 * (x / n as f64).round();
    let edge = |x: f64| 0.5 - 0.5 * (x / width).tanh();
    let lies = |x: f64| edge(nearest(x - 100.0).abs() - 100.0);
    let moved = |j: usize| 60.0 * j as f64 / (n_t - 1) as f64;
    let q = Mat::from_fn(n, n_t, |i, j| {
        let (x, s) = (i as f64, moved(j));
        let height = 0.3 + 0.2 * (0.03 * s).sin();
        lies(x - s) + lies(-x - s) + height * (-(nearest(x) / 10.0).powi(2)).exp()
    });
    let motions =
        Motions::by(3, n_t, |k, j| Motion::translation(Vector::x() * [1.0, -1.0, 0.0][k] * moved(j)));
    let grid = Grid::new([n], [1.0]).unwrap();
    let op = GridFrames::new(grid, Interpolation::QuinticSpline, &motions, n).unwrap();
    let pod = ShiftedPod::new(grid, Interpolation::QuinticSpline).ranks(Ranks::Given(vec![1, 1, 1]));
    let d = pod.solve(&motions, q.as_ref(), None, &mut quiet).unwrap();
    let error = d.relative_error(&op, q.as_ref());
    assert!(error < 1e-4, "{error:.1e}");
    // Wrong entries are those of the spectral fit; the misfit of sharp edges is among them.
    let mut rng = Pcg64::seed_from_u64(4);
    let wrong: Vec<_> =
        (0..n * n_t / 50).map(|_| (rng.random_range(0..n), rng.random_range(0..n_t))).collect();
    let mut spoilt = q.clone();
    wrong.iter().for_each(|&at| spoilt[at] = q[at] + 1.0);
    let d = pod.noise(Noise::Sparse).solve(&motions, spoilt.as_ref(), None, &mut quiet).unwrap();
    let error = d.relative_error(&op, q.as_ref());
    assert!(error < 1e-3, "{error:.1e}");
    let noise = d.noise.unwrap();
    assert!(wrong.iter().all(|&at| (noise[at] - 1.0).abs() < 1e-2));
}
