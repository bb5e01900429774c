//! The decomposition against what must hold.
use super::*;
use crate::Mat;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};

fn random(n: usize, m: usize, seed: u64) -> Mat<f64> {
    let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
    Mat::from_fn(n, m, |_, _| random.random_range(-1.0..1.0))
}

const METHODS: [SvdMethod; 4] = [
    SvdMethod::Auto,
    SvdMethod::Qr,
    SvdMethod::Snapshots,
    SvdMethod::Randomised { oversampling: 8, power_iterations: 3, seed: 3 },
];

/// Largest deviation of ΦᵀWΦ from the identity.
fn skew(pod: &Pod) -> f64 {
    let w = |i: usize| pod.weights.as_ref().map_or(1.0, |w| w[i]);
    let product = |a: usize, b: usize| -> f64 {
        (0..pod.rows()).map(|i| w(i) * pod.modes[(i, a)] * pod.modes[(i, b)]).sum()
    };
    let pairs = (0..pod.rank()).flat_map(|a| (0..=a).map(move |b| (a, b)));
    pairs.map(|(a, b)| (product(a, b) - f64::from(u8::from(a == b))).abs()).fold(0.0, f64::max)
}

/// ‖X − x̄ − Φ Σ A‖ in the weighted norm.
fn left(pod: &Pod, x: &Mat<f64>) -> f64 {
    let back = &pod.modes * pod.scaled_coefficients();
    let mut sum = 0.0;
    for j in 0..x.ncols() {
        for i in 0..x.nrows() {
            let d = x[(i, j)] - back[(i, j)] - pod.mean.as_ref().map_or(0.0, |mean| mean[i]);
            sum += pod.weights.as_ref().map_or(1.0, |w| w[i]) * d * d;
        }
    }
    sum.sqrt()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Modes are orthonormal, the error is that of the singular values left out, and no other subspace of that size is nearer.
    #[test]
    fn best_approximation(
        n in 1..40usize, m in 1..30usize, rank in 1..8usize, seed in 0..10_000u64,
        method in 0..4usize, mean in any::<bool>(), weighted in any::<bool>(),
    ) {
        let x = random(n, m, seed);
        let weights = weighted.then(|| random(n, 1, seed + 1).col_as_slice(0).iter().map(|w| w.abs() + 0.1).collect::<Vec<_>>());
        let params = PodParams { method: METHODS[method], rank: Rank::Fixed(rank), subtract_mean: mean, weights, ..PodParams::default() };
        let pod = Pod::new(x.as_ref(), &params).unwrap();
        let all = Pod::new(x.as_ref(), &PodParams { method: SvdMethod::Qr, rank: Rank::All, ..params.clone() }).unwrap();
        prop_assert!(skew(&pod) < 1e-12, "skew {:e}", skew(&pod));
        let full = rank.min(all.rank());
        prop_assert_eq!(pod.rank(), full);
        let tail = all.singular_values[full..].iter().map(|s| s * s).sum::<f64>().sqrt();
        let scale = all.energy.sqrt().max(1e-300);
        // A random subspace that is not the whole is a little farther away.
        let slack = if method == 3 && full + 8 < n.min(m) { 2e-2 } else { 1e-12 };
        prop_assert!((left(&pod, &x) - tail).abs() < slack * scale + 1e-12, "{} {}", left(&pod, &x), tail);
        prop_assert!((pod.relative_error(full) - tail / scale).abs() < slack + 1e-8);
        if method != 3 {
            for k in 0..full {
                prop_assert!((pod.singular_values[k] - all.singular_values[k]).abs() < 1e-9 * scale);
            }
        }
        // Fields of another subspace.
        let other = Pod::new(random(n, rank, seed + 2).as_ref(), &PodParams { rank: Rank::All, weights: params.weights.clone(), ..PodParams::default() }).unwrap();
        let other = Pod { mean: pod.mean.clone(), ..other };
        let worse = other.relative_projection_error(x.as_ref()).unwrap();
        prop_assert!(pod.relative_projection_error(x.as_ref()).unwrap() <= worse + slack + 1e-12);
    }

    /// What has rank r is found to have it, and comes back.
    #[test]
    fn exact_ranks(n in 5..40usize, m in 5..40usize, rank in 0..5usize, seed in 0..10_000u64, rule in 0..4usize) {
        let x = if rank == 0 { Mat::zeros(n, m) } else { random(n, rank, seed) * random(rank, m, seed + 1) };
        let rank_rule = [Rank::All, Rank::Energy(1.0), Rank::Tolerance(1e-12), Rank::Gap][rule];
        let pod = Pod::new(x.as_ref(), &PodParams { rank: rank_rule, ..PodParams::default() }).unwrap();
        prop_assert!(left(&pod, &x) <= 1e-11 * (1.0 + x.norm_l2()), "{}", left(&pod, &x));
        if rule < 3 {
            prop_assert_eq!(pod.rank(), rank);
        }
    }
}

#[test]
fn rows_of_weight_zero_follow() {
    let x = random(30, 12, 1);
    let mut weights = vec![1.0; 30];
    weights[7] = 0.0;
    for method in METHODS {
        let params = PodParams {
            method,
            rank: Rank::Fixed(12),
            weights: Some(weights.clone()),
            subtract_mean: true,
            ..PodParams::default()
        };
        let pod = Pod::new(x.as_ref(), &params).unwrap();
        assert_eq!(pod.rank(), 11);
        let mut back = vec![0.0; 30];
        pod.reconstruct(&pod.project(x.col_as_slice(4)).unwrap(), &mut back).unwrap();
        assert!((back[7] - x[(7, 4)]).abs() < 1e-10, "{method:?}: {} {}", back[7], x[(7, 4)]);
    }
}

#[test]
fn small_singular_values_are_not_lost() {
    // σ = 1, 1e-3, …, 1e-12.
    let (u, v) = (
        Pod::new(random(60, 5, 1).as_ref(), &PodParams::default()),
        Pod::new(random(40, 5, 2).as_ref(), &PodParams::default()),
    );
    let (u, v) = (u.unwrap().modes, v.unwrap().modes);
    let sigma = |k: usize| 1e-3_f64.powi(k as i32);
    let x = Mat::from_fn(60, 40, |i, j| (0..5).map(|k| sigma(k) * u[(i, k)] * v[(j, k)]).sum());
    let pod = Pod::new(x.as_ref(), &PodParams::of_rank(5)).unwrap();
    assert!(skew(&pod) < 1e-12);
    for k in 0..5 {
        assert!(
            (pod.singular_values[k] / sigma(k) - 1.0).abs() < 1e-2
                && (pod.singular_values[k] - sigma(k)).abs() < 1e-14
        );
    }
    // The method of snapshots leaves out what it cannot find, and what it keeps is orthonormal.
    let fast =
        Pod::new(x.as_ref(), &PodParams { method: SvdMethod::Snapshots, ..PodParams::of_rank(5) }).unwrap();
    assert_eq!(fast.rank(), 2);
    assert!(skew(&fast) < 1e-13);
}

#[test]
fn poor_snapshots() {
    let params = PodParams { subtract_mean: true, ..PodParams::default() };
    // One snapshot, and equal ones, are their own mean.
    let one = random(20, 1, 3);
    assert_eq!(Pod::new(one.as_ref(), &params).unwrap().rank(), 0);
    let same = Mat::from_fn(20, 9, |i, _| one[(i, 0)]);
    let pod = Pod::new(same.as_ref(), &params).unwrap();
    assert_eq!((pod.rank(), pod.relative_error(0)), (0, pod.relative_error(5)));
    assert!(pod.relative_projection_error(same.as_ref()).unwrap() < 1e-14);
    let plain = Pod::new(same.as_ref(), &PodParams::default()).unwrap();
    assert_eq!(plain.rank(), 1);
    let mut bad = same.clone();
    bad[(4, 6)] = f64::NAN;
    match Pod::new(bad.as_ref(), &params) {
        Err(PodError::NotFinite { snapshot: 6, row: 4, value }) => assert!(value.is_nan()),
        other => panic!("{other:?}"),
    }
    assert!(matches!(Pod::new(Mat::zeros(0, 3).as_ref(), &params), Err(PodError::Empty { .. })));
    for (weights, row) in [(vec![1.0; 3], None), (vec![0.0; 20], Some(0)), (vec![-1.0; 20], Some(0))] {
        let found = Pod::new(same.as_ref(), &PodParams { weights: Some(weights), ..PodParams::default() });
        match (found, row) {
            (Err(PodError::Shape { expected: 20, found: 3, .. }), None) => {}
            (Err(PodError::Weight { row, .. }), Some(expected)) => assert_eq!(row, expected),
            other => panic!("{other:?}"),
        }
    }
    let unbounded = PodParams { method: METHODS[3], ..PodParams::default() };
    assert!(matches!(Pod::new(same.as_ref(), &unbounded), Err(PodError::Parameter { .. })));
    let senseless = PodParams { rank: Rank::Energy(1.5), ..PodParams::default() };
    assert!(matches!(Pod::new(same.as_ref(), &senseless), Err(PodError::Parameter { .. })));
    let fewer =
        Pod::new(random(8, 30, 4).as_ref(), &PodParams { subtract_mean: true, ..PodParams::default() })
            .unwrap();
    assert_eq!(fewer.rank(), 8);
    assert_eq!(fewer.truncated(3).rank(), 3);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// One snapshot at a time, the same modes as of all at once, or others within the bound.
    #[test]
    fn streaming(
        n in 1..60usize, m in 1..50usize, rank in 1..12usize, own in 1..9usize, seed in 0..10_000u64,
        mean in any::<bool>(), weighted in any::<bool>(),
    ) {
        let x = random(n, own, seed) * random(own, m, seed + 2) + Mat::from_fn(n, m, |i, _| i as f64 / n as f64);
        let weights = weighted.then(|| random(n, 1, seed + 1).col_as_slice(0).iter().map(|w| w.abs() + 0.1).collect::<Vec<_>>());
        let mut stream = StreamingPod::new(rank);
        if mean {
            stream = stream.subtracting_mean();
        }
        if let Some(weights) = &weights {
            stream = stream.weighted(weights.clone()).unwrap();
        }
        for j in 0..m {
            stream.add(x.col_as_slice(j)).unwrap();
        }
        prop_assert_eq!(stream.seen(), m);
        let mut whole = stream.clone();
        whole.absorb().unwrap();
        let bound = whole.error_bound();
        let pod = stream.finish().unwrap();
        let params = PodParams { method: SvdMethod::Qr, subtract_mean: mean, weights, ..PodParams::default() };
        let all = Pod::new(x.as_ref(), &params).unwrap();
        let norm = |m: &Mat<f64>| Pod::new(m.as_ref(), &PodParams { subtract_mean: false, ..params.clone() }).unwrap().energy.sqrt();
        prop_assert!(skew(&pod) < 1e-11, "skew {:e}", skew(&pod));
        prop_assert!((pod.energy - all.energy).abs() < 1e-10 * norm(&x).powi(2));
        let off = left(&pod, &x);
        // Taking the mean away may push one more mode out.
        let pushed_out = if mean { all.singular_values.get(rank - 1).copied().unwrap_or(0.0) } else { 0.0 };
        prop_assert!(off <= bound * norm(&x) + pushed_out + 1e-10 * norm(&x), "{off:e} {bound:e}");
        if rank > own {
            prop_assert!(off < 1e-10 * norm(&x), "{off:e}");
        }
        let best = all.singular_values.iter().skip(pod.rank()).map(|s| s * s).sum::<f64>().sqrt();
        prop_assert!(off >= best - 1e-9 * norm(&x));
    }
}

#[test]
fn streams_that_are_not_usable() {
    let mut stream = StreamingPod::new(3);
    stream.add(&[1.0, 2.0]).unwrap();
    assert!(matches!(stream.add(&[1.0]), Err(PodError::Shape { expected: 2, found: 1, .. })));
    assert!(matches!(stream.add(&[1.0, f64::NAN]), Err(PodError::NotFinite { snapshot: 1, row: 1, .. })));
    assert_eq!(stream.finish().unwrap().rank(), 1);
    assert!(matches!(StreamingPod::new(3).finish(), Err(PodError::Empty { .. })));
    assert!(matches!(StreamingPod::new(3).weighted(vec![1.0, 0.0]), Err(PodError::Weight { row: 1, .. })));
    let mut nothing = StreamingPod::new(3).subtracting_mean();
    (0..20).for_each(|_| nothing.add(&[2.0; 7]).unwrap());
    let pod = nothing.finish().unwrap();
    assert!(pod.singular_values.iter().all(|s| *s < 1e-12) && pod.mean.unwrap()[3] == 2.0);
}

/// Snapshots of any size have the same modes, or are refused: squares of 1e±160 leave double precision.
#[test]
fn sizes_of_entries() {
    let of = |scale: f64| Mat::from_fn(30, 8, |i, j| scale * ((i * j) as f64 * 0.1).sin());
    let of_one = Pod::new(of(1.0).as_ref(), &PodParams::default()).unwrap();
    let stream = |scale: f64| {
        let mut stream = StreamingPod::new(8);
        (0..8).try_for_each(|j| stream.add(of(scale).col_as_slice(j)))?;
        stream.finish()
    };
    for scale in [1e-130, 1e-60, 1e60, 1e140] {
        for method in [SvdMethod::Qr, SvdMethod::Snapshots] {
            let params = PodParams { method, rank: Rank::Fixed(3), ..PodParams::default() };
            let pod = Pod::new(of(scale).as_ref(), &params).unwrap();
            assert_eq!(pod.rank(), 3, "{scale:e}");
            for (s, t) in pod.singular_values.iter().zip(&of_one.singular_values).take(3) {
                assert!((s / scale - t).abs() < 1e-9 * t, "{scale:e}: {s:e} {t:e}");
            }
        }
        assert_eq!(stream(scale).unwrap().rank(), stream(1.0).unwrap().rank());
    }
    for scale in [1e-300, 1e-160, 1e160] {
        for method in [SvdMethod::Auto, SvdMethod::Qr, SvdMethod::Snapshots] {
            let found = Pod::new(of(scale).as_ref(), &PodParams { method, ..PodParams::default() });
            assert!(matches!(found, Err(PodError::Size { .. })), "{scale:e}: {found:?}");
        }
        assert!(matches!(stream(scale), Err(PodError::Size { .. })), "{scale:e}");
    }
    assert_eq!(Pod::new(of(0.0).as_ref(), &PodParams::default()).unwrap().rank(), 0);
}

/// Singular values of data of rank 8 beyond the eighth are rounding errors of σ₁, or not given.
#[test]
fn singular_values_beyond_the_rank() {
    let x = Mat::from_fn(400, 40, |i, j| {
        (1..9).map(|k| ((k * i) as f64 * 0.02).sin() * ((k * j) as f64 * 0.1).cos() * 300.0 / k as f64).sum()
    });
    for rank in [Rank::Fixed(8), Rank::Tolerance(1e-10), Rank::Fixed(12), Rank::All] {
        for method in [SvdMethod::Auto, SvdMethod::Snapshots, SvdMethod::Qr] {
            let pod = Pod::new(x.as_ref(), &PodParams { rank, method, ..PodParams::default() }).unwrap();
            let first = pod.singular_values[0];
            assert_eq!(pod.rank(), 8, "{rank:?} {method:?}");
            let beyond = pod.singular_values.get(8).copied().unwrap_or(0.0);
            assert!(beyond < 1e-13 * first, "{rank:?} {method:?}: {beyond:e} of {first:e}");
        }
    }
}

/// Singular values down to 1e-10 σ₁ of many rows, by QR of blocks of rows.
#[test]
fn small_singular_values_of_tall_snapshots() {
    let (n, m) = (20_000, 48);
    // Cosines of type IV are orthonormal.
    let cosine = |k: usize, i: usize, n: usize| {
        (2.0 / n as f64).sqrt()
            * (std::f64::consts::PI * (k as f64 + 0.5) * (i as f64 + 0.5) / n as f64).cos()
    };
    let sigma = |k: usize| 10f64.powf(-0.25 * k as f64);
    let u = Mat::from_fn(n, m, |i, k| sigma(k) * cosine(k, i, n));
    let v = Mat::from_fn(m, m, |k, j| cosine(k, j, m));
    let x = &u * &v;
    for method in [SvdMethod::Auto, SvdMethod::Qr] {
        let pod = Pod::new(x.as_ref(), &PodParams { method, ..PodParams::of_rank(41) }).unwrap();
        assert!(skew(&pod) < 1e-13);
        for (k, s) in pod.singular_values.iter().enumerate().take(41) {
            assert!((s / sigma(k) - 1.0).abs() < 1e-6, "{method:?} {k}: {s:e}");
        }
    }
}
