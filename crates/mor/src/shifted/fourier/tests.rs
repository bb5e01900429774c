use super::amplitudes::{Amplitudes, add};
use super::objective::Evaluation;
use super::problem::Problem;
use super::spectrum::Spectrum;
use super::{Als, centred};
use crate::Mat;
use crate::shifted::{
    Decomposition, FieldShift, Grid, Interpolation, Motion, Motions, ShiftedError, Shifts, StopReason,
};
use interfaces::{Rotation, Vector};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Σ_k T^k Q_k.
fn sum(grid: &Grid, shifts: &dyn Shifts, fields: &[Mat<f64>]) -> Mat<f64> {
    let operator = FieldShift::new(*grid, Interpolation::Spectral);
    let mut out = Mat::zeros(fields[0].nrows(), shifts.n_snapshots());
    for (k, field) in fields.iter().enumerate() {
        for j in 0..shifts.n_snapshots() {
            let moved = operator.shift(shifts.motion(k, j).displacement, field.col_as_slice(j));
            out.col_as_slice_mut(j).iter_mut().zip(moved).for_each(|(x, y)| *x += y);
        }
    }
    out
}

fn norm(m: &Mat<f64>) -> f64 {
    m.norm_l2()
}

/// The relative error, from the modes in space and the shifts there.
fn error(grid: &Grid, shifts: &dyn Shifts, q: &Mat<f64>, d: &Decomposition) -> f64 {
    let fields: Vec<_> = d.frames.iter().map(|f| f.field()).collect();
    norm(&(q - sum(grid, shifts, &fields))) / norm(q)
}

fn solve(als: &Als, grid: &Grid, shifts: &dyn Shifts, q: &Mat<f64>) -> Decomposition {
    als.solve(grid, shifts, q.as_ref(), None, None, &mut |_| true).unwrap()
}

/// Modes and coefficients are orthonormal, singular values descend.
fn check_frames(d: &Decomposition) {
    for f in &d.frames {
        let identity = Mat::<f64>::identity(f.rank(), f.rank());
        assert!(norm(&(f.modes.transpose() * &f.modes - &identity)) < 1e-12);
        assert!(norm(&(&f.coefficients * f.coefficients.transpose() - &identity)) < 1e-12);
        assert!(f.singular_values.windows(2).all(|w| w[0] >= w[1]));
    }
}

/// Random fields of given ranks in frames that move at random.
fn random(
    grid: &Grid,
    ranks: &[usize],
    components: usize,
    n: usize,
    reach: f64,
    seed: u64,
) -> (Motions, Mat<f64>) {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut value = || rng.random_range(-1.0..1.0);
    let motions: Vec<_> = (0..ranks.len() * n)
        .map(|_| {
            let along = |a: usize| if grid.cells()[a] > 1 { reach * value() } else { 0.0 };
            let mut along = along;
            Motion::translation(Vector::new(along(0), along(1), along(2)))
        })
        .collect();
    let rows = components * grid.n_cells();
    let fields: Vec<_> = ranks
        .iter()
        .map(|&r| {
            let modes = Mat::from_fn(rows, r, |_, _| value());
            let a = Mat::from_fn(r, n, |_, _| 2.0 + value());
            modes * a
        })
        .collect();
    let motions = Motions::by(ranks.len(), n, |k, j| motions[k * n + j]);
    let q = sum(grid, &motions, &fields);
    (motions, q)
}

/// Two discs on parallel ways at different, growing speeds, `drift` cells aside.
fn two_discs(cells: [usize; 2], n: usize, drift: f64) -> (Grid, Motions, Mat<f64>) {
    two_discs_at([0.0; 2], cells, n, drift)
}

/// Their centres so far from those of cells, along both axes.
fn two_discs_at(beside: [f64; 2], cells: [usize; 2], n: usize, drift: f64) -> (Grid, Motions, Mat<f64>) {
    let [nx, ny] = cells.map(|n| n as f64);
    let moved = |k: usize, j: usize| {
        let t = j as f64 / n as f64;
        Vector::new([1.1, 0.6][k] * nx * 0.5 * t * (1.0 + t), [drift, -drift][k] * t, 0.0)
    };
    let grid = Grid::new(cells, [1.0; 2]).unwrap();
    let disc = |k: usize, i: usize, j: usize| {
        let start = Vector::new(0.1 * nx + beside[k], [0.25, 0.75][k] * ny + beside[k], 0.0);
        let mut r = grid.centre(i).coords - start - moved(k, j);
        r.x -= nx * (r.x / nx).round();
        r.y -= ny * (r.y / ny).round();
        0.5 - 0.5 * (r.norm() - 4.5).tanh()
    };
    let motions = Motions::by(2, n, |k, j| Motion::translation(moved(k, j)));
    (grid, motions, Mat::from_fn(cells[0] * cells[1], n, |i, j| disc(0, i, j) + disc(1, i, j)))
}

#[test]
fn crossing_waves_are_two_modes() {
    let (nx, nt) = (400, 200);
    let grid = Grid::new([nx], [1.0 / nx as f64]).unwrap();
    let time = |j: usize| j as f64 * 0.5 / nt as f64;
    let wave = |from: f64| (-(from / 0.015_f64).powi(2)).exp();
    let q = Mat::from_fn(nx, nt, |i, j| {
        let (x, t) = (i as f64 / nx as f64, time(j));
        wave((x - t).rem_euclid(1.0) - 0.1) + wave((x + t).rem_euclid(1.0) - 0.9)
    });
    let motions = Motions::along_x(&[(0..nt).map(time).collect(), (0..nt).map(|j| 0.8 - time(j)).collect()]);
    let motions = motions.unwrap();
    let d = solve(&Als::new([1, 1]), &grid, &motions, &q);
    check_frames(&d);
    let e = error(&grid, &motions, &q, &d);
    assert!(e < 1e-8 && d.stopped == StopReason::Tolerance, "{e:.2e} {:?}", d.stopped);
    assert!((e - d.history.last().unwrap().error).abs() < 1e-9);
}

#[test]
fn the_edges_of_discs_need_three_modes() {
    // Along x the waves that the grid cannot show come back with the factors e^(±2πi s/h).
    let (grid, motions, q) = two_discs([100, 40], 150, 0.0);
    let [one, three] = [1, 3].map(|r| {
        let d = solve(&Als::new([r, r]), &grid, &motions, &q);
        check_frames(&d);
        let e = error(&grid, &motions, &q, &d);
        assert!((e / d.history.last().unwrap().error - 1.0).abs() < 1e-3, "{e} {:?}", d.history.last());
        e
    });
    assert!(one < 3e-3 && three < 1e-6, "{one:.2e} {three:.2e}");
}

#[test]
fn frames_are_best_centred_on_cells() {
    // Along x only, and in the plane, where the waves of two cells along either axis have phases along the other one.
    for (drift, rank, small) in [(0.0, 3, 1e-6), (8.0, 5, 2e-4)] {
        let beside = [0.3, -0.45];
        let (grid, motions, q) = two_discs_at(beside, [80, 40], 150, drift);
        let on_cells = centred(&grid, &motions, q.as_ref()).unwrap();
        for (k, c) in beside.into_iter().enumerate() {
            let by = on_cells.motion(k, 7).displacement - motions.motion(k, 7).displacement;
            let expected = Vector::new(c, if drift > 0.0 { c } else { 0.0 }, 0.0);
            assert!((by - expected).norm() < 0.02, "{by} {expected}");
        }
        let als = Als::new([rank, rank]);
        let [e, without] = [&on_cells, &motions].map(|m| error(&grid, m, &q, &solve(&als, &grid, m, &q)));
        assert!(e < small && without > 3e-4, "{e:.2e} {without:.2e}");
    }
    // Whole cells tell nothing.
    let (grid, _, q) = two_discs([40, 20], 30, 0.0);
    let whole = Motions::by(2, 30, |k, j| Motion::translation(Vector::new((j * (k + 1)) as f64, 0.0, 0.0)));
    assert_eq!(centred(&grid, &whole, q.as_ref()).unwrap(), whole);
}

#[test]
fn discs_may_drift_aside() {
    let (grid, motions, q) = two_discs([40, 40], 100, 8.0);
    let [one, five] =
        [1, 5].map(|r| error(&grid, &motions, &q, &solve(&Als::new([r, r]), &grid, &motions, &q)));
    assert!(one < 5e-3 && five < 0.05 * one, "{one:.2e} {five:.2e}");
}

#[test]
fn it_goes_on_from_a_start_and_without_the_noise() {
    let (grid, motions, mut q) = two_discs([60, 40], 80, 0.0);
    let coarse = solve(&Als::new([1, 1]), &grid, &motions, &q);
    let noise = Mat::from_fn(q.nrows(), q.ncols(), |i, j| if (i + 7 * j) % 13 == 0 { 1.0 } else { 0.0 });
    q += &noise;
    let mut steps = 0;
    let als = Als { max_steps: 60, ..Als::new([3, 3]) };
    let d = als
        .solve(&grid, &motions, q.as_ref(), Some(&coarse), Some(noise.as_ref()), &mut |p| {
            steps += 1;
            p.rank < 4
        })
        .unwrap();
    assert_eq!((d.history.len(), d.stopped, d.ranks()), (steps, StopReason::Asked, vec![2, 2]));
    assert!(norm(&(d.noise.as_ref().unwrap() - &noise)) == 0.0);
    let on = als.solve(&grid, &motions, q.as_ref(), Some(&d), Some(noise.as_ref()), &mut |_| true).unwrap();
    let e = error(&grid, &motions, &(&q - &noise), &on);
    assert!(e < 1e-5 && on.ranks() == [3, 3], "{e:.2e}");
    // A bad start costs time only.
    let mut bad = coarse;
    bad.frames[0].coefficients[(0, 3)] = f64::NAN;
    let good =
        als.solve(&grid, &motions, q.as_ref(), Some(&bad), Some(noise.as_ref()), &mut |_| true).unwrap();
    assert!(error(&grid, &motions, &(&q - &noise), &good) < 1e-5);
}

#[test]
fn a_sample_is_fitted_first_and_all_in_the_end() {
    // Many wave vectors, and many columns that cannot be compressed, at each of few wave vectors.
    for (cells, drift) in [([64, 100], 8.0), ([40, 160], 0.0)] {
        let (grid, motions, mut q) = two_discs(cells, 24, drift);
        let mut rng = Pcg64::seed_from_u64(1);
        q += Mat::from_fn(q.nrows(), q.ncols(), |_, _| 0.05 * rng.random_range(-1.0..1.0));
        let als = Als::new([1, 1]);
        let d = solve(&als, &grid, &motions, &q);
        let [e, told] = [error(&grid, &motions, &q, &d), d.history.last().unwrap().error];
        assert!((e / told - 1.0).abs() < 1e-6, "{e} {told}");
        // From the motions that are meant.
        let one = Decomposition { history: Vec::new(), ..d.clone() };
        let long = Als { stagnation: 1e-7, ..als };
        let more = long.solve(&grid, &motions, q.as_ref(), Some(&one), None, &mut |_| true).unwrap();
        let best = more.history.last().unwrap().error;
        assert!(e < 1.002 * best, "{e} {best}");
    }
}

#[test]
fn units_do_not_matter() {
    let (grid, motions, q) = two_discs([30, 20], 40, 3.0);
    let one = solve(&Als::new([2, 1]), &grid, &motions, &q);
    for factor in [2.0_f64.powi(900), 2.0_f64.powi(-900)] {
        let d = solve(
            &Als::new([2, 1]),
            &grid,
            &motions,
            &Mat::from_fn(q.nrows(), 40, |i, j| factor * q[(i, j)]),
        );
        assert_eq!(d.history, one.history);
        assert!(d.frames[0].modes == one.frames[0].modes);
        assert_eq!(d.frames[1].singular_values[0], factor * one.frames[1].singular_values[0]);
    }
}

#[test]
fn threads_do_not_matter() {
    let (grid, motions, q) = two_discs([30, 20], 40, 3.0);
    let [a, b] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&Als::new([2, 1]), &grid, &motions, &q))
    });
    assert_eq!(a.history, b.history);
    assert!(
        a.frames.iter().zip(&b.frames).all(|(a, b)| a.modes == b.modes && a.coefficients == b.coefficients)
    );
}

#[test]
fn nothing_and_constants_and_one_snapshot() {
    let grid = Grid::new([12, 8], [1.0; 2]).unwrap();
    let motions = Motions::by(2, 5, |k, j| Motion::translation(Vector::new((k * j) as f64, 0.0, 0.0)));
    let d = solve(&Als::new([2, 1]), &grid, &motions, &Mat::zeros(96, 5));
    assert_eq!((d.ranks(), d.stopped, d.history.len()), (vec![0, 0], StopReason::Tolerance, 1));
    let q = Mat::from_fn(96, 5, |_, _| 3.0);
    let d = solve(&Als::new([2, 1]), &grid, &motions, &q);
    assert!(error(&grid, &motions, &q, &d) < 1e-8);
    check_frames(&d);
    let d = solve(&Als::new([0, 0]), &grid, &motions, &q);
    assert!(d.ranks() == [0, 0] && (d.history.last().unwrap().error - 1.0).abs() < 1e-15);
    let one = Motions::by(2, 1, |k, _| Motion::translation(Vector::new(0.3 * k as f64, 0.0, 0.0)));
    let q = Mat::from_fn(96, 1, |i, _| (i as f64).sin());
    let d = solve(&Als::new([3, 3]), &grid, &one, &q);
    assert!(error(&grid, &one, &q, &d) < 1e-6);
    check_frames(&d);
}

#[test]
fn what_does_not_fit_is_told() {
    let grid = Grid::new([6, 4], [1.0; 2]).unwrap();
    let motions = |s: Vector| Motions::by(1, 3, move |_, _| Motion::translation(s));
    let still = motions(Vector::zeros());
    let mut q = Mat::from_fn(24, 3, |i, j| (i * j) as f64);
    let err = |grid: &Grid, m: &Motions, q: &Mat<f64>, ranks: &[usize]| {
        Als::new(ranks).solve(grid, m, q.as_ref(), None, None, &mut |_| true).unwrap_err()
    };
    assert_eq!(err(&grid, &still, &q, &[1, 1]), ShiftedError::Ranks { ranks: 2, frames: 1 });
    let rows = Mat::zeros(25, 3);
    assert_eq!(err(&grid, &still, &rows, &[1]), ShiftedError::Rows { rows: 25, cells: 24 });
    let two = Mat::zeros(24, 2);
    assert_eq!(err(&grid, &still, &two, &[1]), ShiftedError::Snapshots { snapshots: 2, shifts: 3 });
    let side = motions(Vector::new(0.0, 0.5, 0.0));
    let bounded = grid.bounded([1]);
    assert!(matches!(err(&bounded, &side, &q, &[1]), ShiftedError::NotPeriodic { axis: 1, .. }));
    let up = motions(Vector::new(0.0, 0.0, 1.0));
    assert!(matches!(err(&grid, &up, &q, &[1]), ShiftedError::OffGrid { axis: 2, .. }));
    let nan = motions(Vector::new(f64::NAN, 0.0, 0.0));
    assert!(matches!(err(&grid, &nan, &q, &[1]), ShiftedError::Motion { frame: 0, snapshot: 0 }));
    let turn = Motion {
        rotation: Rotation::from_euler_angles(0.0, 0.0, 0.1),
        ..Motion::translation(Vector::zeros())
    };
    let turns = Motions::by(1, 3, |_, _| turn);
    assert!(matches!(err(&grid, &turns, &q, &[1]), ShiftedError::Turns { .. }));
    let noise = Mat::zeros(24, 2);
    let als = Als::new([1]);
    let shape = als.solve(&grid, &still, q.as_ref(), None, Some(noise.as_ref()), &mut |_| true);
    assert!(matches!(shape, Err(ShiftedError::Shape { what: "noise", .. })));
    q[(5, 1)] = f64::INFINITY;
    assert!(matches!(err(&grid, &still, &q, &[1]), ShiftedError::NotFinite { snapshot: 1, row: 5, .. }));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn what_frames_carry_is_found_again(
        which in 0_usize..4, ranks in prop::collection::vec(0_usize..3, 1..4), n in 25_usize..40, far in any::<bool>(), seed in any::<u64>()
    ) {
        // Of random motions and fields; the rows of each wave vector must be more than the modes.
        prop_assume!(ranks.iter().sum::<usize>() > 0);
        let (grid, components) = match which {
            0 => (Grid::new([31], [0.5]).unwrap(), 2),
            1 => (Grid::new([8, 7], [1.0, 2.0]).unwrap(), 1),
            2 => (Grid::new([6, 5], [1.0, 2.0]).unwrap(), 3),
            _ => (Grid::new([4, 5, 3], [1.0, 2.0, 1.0]).unwrap(), 1),
        };
        // Shifts of many periods are those of parts of one.
        let (motions, q) = random(&grid, &ranks, components, n, if far { 100.0 } else { 5.0 }, seed);
        let als = Als { max_steps: 2000, ..Als::new(ranks) };
        let d = solve(&als, &grid, &motions, &q);
        let e = error(&grid, &motions, &q, &d);
        prop_assert!(e < 1e-7, "{e:.2e} {:?} after {}", d.stopped, d.history.len());
        check_frames(&d);
    }

    #[test]
    fn the_order_of_the_frames_does_not_matter(seed in any::<u64>()) {
        let grid = Grid::new([15, 6], [1.0, 1.0]).unwrap();
        let (motions, mut q) = random(&grid, &[2, 1], 1, 20, 10.0, seed);
        // Not of these ranks.
        let mut rng = Pcg64::seed_from_u64(seed);
        q += Mat::from_fn(90, 20, |_, _| 0.01 * rng.random_range(-1.0..1.0));
        let other = Motions::by(2, 20, |k, j| motions.motion(1 - k, j));
        let a = solve(&Als { stagnation: 1e-6, ..Als::new([2, 1]) }, &grid, &motions, &q);
        let b = solve(&Als { stagnation: 1e-6, ..Als::new([1, 2]) }, &grid, &other, &q);
        let [a, b] = [&a, &b].map(|d| d.history.last().unwrap().error);
        prop_assert!((a / b - 1.0).abs() < 1e-4, "{a:.6e} {b:.6e}");
    }

    #[test]
    fn a_still_frame_is_a_proper_orthogonal_decomposition(rows in 2_usize..30, n in 2_usize..30, rank in 1_usize..4, seed in any::<u64>()) {
        // More snapshots than cells, and fewer: Eckart and Young's error.
        let grid = Grid::new([rows], [1.0]).unwrap().bounded([0]);
        let still = Motions::by(1, n, |_, _| Motion::translation(Vector::zeros()));
        let mut rng = Pcg64::seed_from_u64(seed);
        let q = Mat::from_fn(rows, n, |_, _| rng.random_range(-1.0..1.0));
        let d = solve(&Als { stagnation: 1e-9, ..Als::new([rank]) }, &grid, &still, &q);
        let values = q.singular_values().unwrap();
        let best = (values.iter().skip(rank).map(|s| s * s).sum::<f64>()).sqrt() / norm(&q);
        let e = error(&grid, &still, &q, &d);
        prop_assert!(e < best * (1.0 + 1e-5) + 1e-8 && e > best * (1.0 - 1e-9) - 1e-12, "{e:.3e} {best:.3e}");
    }
}

#[test]
fn further_attempts_take_no_more_steps_than_all_before() {
    // Five frames and more than their modes explain.
    let grid = Grid::new([60], [1.0]).unwrap();
    let (motions, mut q) = random(&grid, &[2; 5], 1, 40, 60.0, 5);
    let mut rng = Pcg64::seed_from_u64(6);
    q += Mat::from_fn(60, 40, |_, _| 0.01 * rng.random_range(-1.0..1.0));
    let als = Als::new([2; 5]);
    let spectrum = Spectrum::new(&grid, &motions, q.as_ref(), None, als.cut()).unwrap();
    let first = als.fit(&spectrum, None, super::LONG, &mut |_| true).unwrap().history.len();
    let d = als.least(&spectrum, &mut |_| true).unwrap();
    assert_eq!(d.ranks(), [2; 5]);
    let starts: Vec<_> =
        (1..d.history.len()).filter(|&i| d.history[i].rank < d.history[i - 1].rank).collect();
    assert!(d.attempts > 0 && starts[0] == first, "{} {starts:?} {first}", d.attempts);
    let ends = starts[1..].iter().copied().chain([d.history.len() - 1]);
    let lengths: Vec<_> = starts.iter().zip(ends).map(|(start, end)| (*start, end - start)).collect();
    // Ten steps of each frame tell that nothing gets better; each fit notes the error before its first step.
    assert!(lengths[0].1 <= lengths[0].0 + 10 * 5 + 2, "{lengths:?}");
}

/// Where nothing is left, what is called the curvature is that of the squared error: the gradient's change along any direction.
#[test]
fn second_derivatives_are_those_of_the_gradient() {
    let grid = Grid::new([14, 3], [1.0; 2]).unwrap();
    let (shifts, q) = random(&grid, &[2, 1], 2, 9, 5.0, 11);
    let d = solve(&Als { tolerance: 1e-12, ..Als::new([2, 1]) }, &grid, &shifts, &q);
    let spectrum = Spectrum::new(&grid, &shifts, q.as_ref(), None, 1e-14).unwrap();
    let problem = Problem::all(&spectrum, 1e-13);
    let column = |c: usize| d.frames[c / 2].coefficients.row(c % 2);
    let values = Mat::from_fn(9, 3, |j, c| column(c)[j]);
    let amplitudes = Amplitudes { ranks: vec![2, 1], values };
    let mut rng = Pcg64::seed_from_u64(12);
    let direction = Mat::from_fn(9, 3, |_, _| rng.random_range(-1.0..1.0));
    let at = |h: f64| {
        let mut moved = amplitudes.clone();
        add(&mut moved.values, h, &direction);
        Evaluation::new(&problem, &moved).gradient
    };
    let h = 1e-5;
    let expected = Mat::from_fn(9, 3, {
        let (after, before) = (at(h), at(-h));
        move |j, c| (after[(j, c)] - before[(j, c)]) / (2.0 * h)
    });
    let curved = Evaluation::curvature(&problem, &amplitudes, &direction);
    let off = norm(&(&curved - &expected)) / norm(&expected);
    assert!(off < 1e-6, "{off:.1e}");
}
