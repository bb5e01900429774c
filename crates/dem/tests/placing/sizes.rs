//! Distributions against their exact moments and cumulative fractions.
//!
//! Seeds are fixed, so a test either always passes or always fails. Bounds are those that a right sampler breaks with a probability
//! below 1e-6 (five standard errors) or, for Kolmogorov and Smirnov's largest distance, of 2 exp(−2·2.5²) = 7e-6.
use dem::placing::{Basis, PlacingError, SizeDistribution};
use std::f64::consts::{FRAC_1_SQRT_2, PI};

const N: usize = 200_000;

/// Mean of size^k, with its standard error from the sample, against the exact one.
fn moment(sizes: &[f64], k: i32, exact: f64) {
    let n = sizes.len() as f64;
    let mean = sizes.iter().map(|d| d.powi(k)).sum::<f64>() / n;
    let variance = sizes.iter().map(|d| (d.powi(k) - mean).powi(2)).sum::<f64>() / (n - 1.0);
    let error = (mean - exact) / (variance / n).sqrt();
    assert!(error.abs() < 5.0, "moment {k}: {mean} for {exact}, {error} standard errors");
}
/// Largest distance of the cumulative fractions, in units of 1/√n.
fn cumulative(sizes: &[f64], exact: impl Fn(f64) -> f64) {
    let mut sorted = sizes.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let far = |(i, d): (usize, &f64)| {
        let f = exact(*d);
        (f - i as f64 / n).abs().max((f - (i + 1) as f64 / n).abs())
    };
    let largest = sorted.iter().enumerate().map(far).fold(0.0, f64::max);
    assert!(largest * n.sqrt() < 2.5, "{}", largest * n.sqrt());
}
fn within(sizes: &[f64], low: f64, high: f64) {
    assert!(sizes.iter().all(|d| (low..=high).contains(d)));
}
fn normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z * FRAC_1_SQRT_2)
}

#[test]
fn uniform_and_constant() {
    let d = SizeDistribution::uniform(1.0, 3.0).unwrap().sample(N, 1);
    within(&d, 1.0, 3.0);
    moment(&d, 1, 2.0);
    moment(&d, 2, 13.0 / 3.0);
    cumulative(&d, |x| 0.5 * (x - 1.0));
    assert_eq!(SizeDistribution::constant(0.3).unwrap().sample(3, 1), [0.3; 3]);
}

#[test]
fn normal_is_cut_off_and_drawn_again() {
    let (mean, deviation, low, high) = (2.0, 0.5, 1.2, 2.6);
    let d = SizeDistribution::normal(mean, deviation, [low, high]).unwrap().sample(N, 2);
    within(&d, low, high);
    let (a, b) = ((low - mean) / deviation, (high - mean) / deviation);
    let density = |z: f64| (-0.5 * z * z).exp() / (2.0 * PI).sqrt();
    let held = normal_cdf(b) - normal_cdf(a);
    let shift = (density(a) - density(b)) / held;
    moment(&d, 1, mean + deviation * shift);
    let second = 1.0 + (a * density(a) - b * density(b)) / held;
    moment(&d, 2, mean * mean + 2.0 * mean * deviation * shift + deviation * deviation * second);
    cumulative(&d, |x| (normal_cdf((x - mean) / deviation) - normal_cdf(a)) / held);
}

#[test]
fn log_normal_has_its_moments() {
    let d = SizeDistribution::log_normal(2.0, 1.3, [0.0, f64::INFINITY]).unwrap().sample(N, 3);
    let s = 1.3_f64.ln();
    for k in [-1, 1, 2] {
        let k2 = f64::from(k * k);
        moment(&d, k, 2_f64.powi(k) * (0.5 * k2 * s * s).exp());
    }
    cumulative(&d, |x| normal_cdf((x / 2.0).ln() / s));
}

#[test]
fn log_normal_by_mass_has_the_median_of_hatch_and_choate() {
    let mut d = SizeDistribution::log_normal(1.0, 1.3, [0.0, f64::INFINITY]).unwrap().sample(N, 4);
    d.sort_by(f64::total_cmp);
    let total: f64 = d.iter().map(|d| d.powi(3)).sum();
    let mut sum = 0.0;
    let median = d
        .iter()
        .find(|d| {
            sum += d.powi(3);
            sum > 0.5 * total
        })
        .unwrap();
    assert!((median / (3.0 * 1.3_f64.ln().powi(2)).exp() - 1.0).abs() < 0.01);
}

#[test]
fn weibull_by_number() {
    let d = SizeDistribution::weibull(2.0, 1.7, [0.0, f64::INFINITY], Basis::Number).unwrap().sample(N, 5);
    for k in [1, 2, 3] {
        moment(&d, k, 2_f64.powi(k) * libm::tgamma(1.0 + f64::from(k) / 1.7));
    }
    let [low, high] = [1.0, 3.0];
    let d = SizeDistribution::weibull(2.0, 1.7, [low, high], Basis::Number).unwrap().sample(N, 6);
    within(&d, low, high);
    let left = |x: f64| (-(x / 2.0_f64).powf(1.7)).exp();
    cumulative(&d, |x| (left(low) - left(x)) / (left(low) - left(high)));
}

#[test]
fn rosin_rammler_has_its_mass() {
    let (scale, shape, low, high) = (1.0_f64, 1.4, 0.3_f64, 3.0_f64);
    let left = |x: f64| (-(x / scale).powf(shape)).exp();
    for (basis, k) in [(Basis::Mass, 3), (Basis::PlaneMass, 2)] {
        let d = SizeDistribution::weibull(scale, shape, [low, high], basis).unwrap().sample(4 * N, 7);
        within(&d, low, high);
        let total: f64 = d.iter().map(|d| d.powi(k)).sum();
        for x in [0.4, 0.7, 1.0, 1.5, 2.5] {
            let exact = (left(low) - left(x)) / (left(low) - left(high));
            let weighed = |d: &f64| d.powi(k) * (f64::from(*d < x) - exact);
            let off: f64 = d.iter().map(weighed).sum::<f64>() / total;
            let error = d.iter().map(|d| weighed(d).powi(2)).sum::<f64>().sqrt() / total;
            assert!(off.abs() < 5.0 * error && error < 3e-3, "{basis:?} {x}: {off} ± {error}");
        }
    }
    // Without upper bound the moments of numbers are incomplete gamma functions: a mean mass of 1/∫ s⁻³ dM.
    let d = SizeDistribution::weibull(1.0, 5.0, [1e-3, f64::INFINITY], Basis::Mass).unwrap().sample(N, 8);
    moment(&d, 3, 1.0 / libm::tgamma(1.0 - 3.0 / 5.0));
}

#[test]
fn power_laws() {
    for (i, exponent) in [-6.0, -3.5, -1.0, -1.0 + 1e-13, 0.0, 2.5, 200.0, -900.0].into_iter().enumerate() {
        let (low, high) = (0.5_f64, 8.0_f64);
        let d = SizeDistribution::power_law(exponent, [low, high]).unwrap().sample(N, 10 + i as u64);
        within(&d, low, high);
        // Both ends from logarithms, since powers are beyond what numbers hold.
        let p = exponent + 1.0;
        let part = |x: f64| {
            if p.abs() < 1e-9 {
                (x / low).ln() / (high / low).ln()
            } else {
                (p * (x / low).ln()).exp_m1() / (p * (high / low).ln()).exp_m1()
            }
        };
        cumulative(&d, part);
    }
}

#[test]
fn tables_by_number_and_by_mass() {
    let rows = [(1.0, 0.0), (2.0, 0.3), (2.5, 0.3), (4.0, 1.0)];
    let d = SizeDistribution::table(&rows, Basis::Number).unwrap().sample(N, 30);
    let fraction = |x: f64| match x {
        x if x < 2.0 => 0.3 * (x - 1.0),
        x if x < 2.5 => 0.3,
        x => 0.3 + 0.7 * (x - 2.5) / 1.5,
    };
    cumulative(&d, fraction);
    assert!(!d.iter().any(|d| (2.0 + 1e-12..2.5).contains(d)));
    moment(&d, 1, 0.3 * 1.5 + 0.7 * 3.25);

    // Mass evenly over sizes: n(s) ∝ s⁻³, its integral ½(1/a² − 1/b²); s⁻² and 1/a − 1/b in the plane.
    let number = |a: f64, b: f64, m: f64| 0.5 * m * (1.0 / (a * a) - 1.0 / (b * b)) / (b - a);
    let total = number(1.0, 2.0, 0.3) + number(2.5, 4.0, 0.7);
    let d = SizeDistribution::table(&rows, Basis::Mass).unwrap().sample(N, 31);
    cumulative(&d, |x| match x {
        x if x < 2.0 => number(1.0, 2.0, 0.3) * (1.0 - 1.0 / (x * x)) / 0.75 / total,
        x if x <= 2.5 => number(1.0, 2.0, 0.3) / total,
        x => (number(1.0, 2.0, 0.3) + 0.7 / 1.5 * 0.5 * (1.0 / 6.25 - 1.0 / (x * x))) / total,
    });
    moment(&d, 3, 1.0 / total);
    let total = 0.3 * (1.0 - 0.5) / 1.0 + 0.7 * (1.0 / 2.5 - 0.25) / 1.5;
    let d = SizeDistribution::table(&rows, Basis::PlaneMass).unwrap().sample(N, 32);
    moment(&d, 2, 1.0 / total);
    moment(&d, 1, (0.3 * 2_f64.ln() + 0.7 / 1.5 * (4.0_f64 / 2.5).ln()) / total);
}

#[test]
fn tables_of_any_ratio_of_sizes_are_finite() {
    let rows = [(1e-300, 0.0), (1e-200, 0.0), (1e-150, 0.1), (1.0, 0.5), (1e200, 1.0)];
    for basis in [Basis::Number, Basis::Mass, Basis::PlaneMass] {
        let d = SizeDistribution::table(&rows, basis).unwrap().sample(1000, 1);
        within(&d, 1e-200, 1e200);
    }
}

#[test]
fn until_a_volume_is_reached() {
    let law = SizeDistribution::uniform(1e-3, 2e-3).unwrap();
    let volume = |d: f64| PI / 6.0 * d.powi(3);
    let d = law.until(1e-6, volume, 1).unwrap();
    let sum: f64 = d.iter().map(|d| volume(*d)).sum();
    assert!(sum <= 1e-6 && sum > 1e-6 - volume(2e-3));
    assert_eq!(d, law.sample(d.len(), 1));
    assert!(matches!(law.until(f64::NAN, volume, 1), Err(PlacingError::Parameter { .. })));
    assert!(matches!(law.until(1.0, |_| 0.0, 1), Err(PlacingError::Parameter { .. })));
}

/// Far too many are told about without drawing them (before: 10⁸ sizes, 800 MB).
#[test]
fn far_too_many_are_told_at_once() {
    let law = SizeDistribution::constant(1e-3).unwrap();
    let drawn = std::cell::Cell::new(0);
    let count = |d: f64| {
        drawn.set(drawn.get() + 1);
        d.powi(3)
    };
    let error = law.until(1e9, count, 1).unwrap_err();
    assert!(
        matches!(error, PlacingError::TooMany { number, .. } if (number / 1e18 - 1.0).abs() < 1e-3),
        "{error}"
    );
    assert!(drawn.get() < 20_000, "{}", drawn.get());
}

/// Written down once: other machines, and other versions of the crates below, must draw the same bits.
#[test]
fn the_same_bits_everywhere() {
    let table = [(1.0, 0.0), (2.0, 0.3), (4.0, 1.0)];
    let laws = [
        SizeDistribution::uniform(1.0, 3.0),
        SizeDistribution::power_law(-3.5, [1.0, 10.0]),
        SizeDistribution::normal(2.0, 0.5, [1.0, 3.0]),
        SizeDistribution::log_normal(2.0, 1.5, [0.5, 9.0]),
        SizeDistribution::weibull(2.0, 1.7, [0.1, 9.0], Basis::Number),
        SizeDistribution::weibull(2.0, 1.7, [0.1, 9.0], Basis::Mass),
        SizeDistribution::table(&table, Basis::PlaneMass),
    ];
    let drawn: Vec<u64> =
        laws.into_iter().map(|law| law.unwrap().sizes(42).nth(5).unwrap().to_bits()).collect();
    assert_eq!(drawn, BITS);
}
const BITS: [u64; 7] = [
    0x3ffc_03ca_5031_670a,
    0x3ff3_4ce8_1866_3ab7,
    0x3ff4_2320_ab26_6005,
    0x3ff1_8a47_9e0c_e84e,
    0x3ff4_b354_33db_cec2,
    0x3fc1_f678_b8e0_c9bf,
    0x3ff6_c475_6220_8972,
];

#[test]
fn senseless_parameters_are_told() {
    use PlacingError::{Parameter, Sizes, Table, Tail};
    let nan = f64::NAN;
    for size in [0.0, -1.0, nan, f64::INFINITY] {
        assert!(matches!(SizeDistribution::constant(size), Err(Parameter { .. })));
        assert!(matches!(SizeDistribution::normal(1.0, size, [0.5, 2.0]), Err(Parameter { .. })));
        assert!(matches!(SizeDistribution::log_normal(size, 2.0, [0.5, 2.0]), Err(Parameter { .. })));
        assert!(matches!(
            SizeDistribution::weibull(size, 2.0, [0.5, 2.0], Basis::Number),
            Err(Parameter { .. })
        ));
        assert!(matches!(
            SizeDistribution::weibull(2.0, size, [0.5, 2.0], Basis::Number),
            Err(Parameter { .. })
        ));
    }
    assert!(matches!(SizeDistribution::log_normal(1.0, 1.0, [0.5, 2.0]), Err(Parameter { .. })));
    assert!(matches!(SizeDistribution::power_law(nan, [0.5, 2.0]), Err(Parameter { .. })));
    for bounds in [[2.0, 1.0], [1.0, 1.0], [-1.0, 1.0], [nan, 1.0], [1.0, nan]] {
        assert!(matches!(SizeDistribution::uniform(bounds[0], bounds[1]), Err(Sizes { .. })));
        assert!(matches!(SizeDistribution::normal(1.0, 1.0, bounds), Err(Sizes { .. })));
        assert!(matches!(SizeDistribution::log_normal(1.0, 2.0, bounds), Err(Sizes { .. })));
        assert!(matches!(SizeDistribution::weibull(1.0, 2.0, bounds, Basis::Mass), Err(Sizes { .. })));
    }
    assert!(matches!(SizeDistribution::uniform(1.0, f64::INFINITY), Err(Sizes { .. })));
    assert!(matches!(SizeDistribution::weibull(1.0, 2.0, [0.0, 1.0], Basis::Mass), Err(Sizes { .. })));
    assert!(matches!(SizeDistribution::weibull(1.0, 9.0, [9.0, 10.0], Basis::Number), Err(Sizes { .. })));
    let Err(Tail { share, .. }) = SizeDistribution::normal(1.0, 0.1, [1.5, 2.0]) else { panic!() };
    assert!((share / 2.866_515_7e-7 - 1.0).abs() < 1e-6);
    for (row, rows) in [
        (0, vec![]),
        (1, vec![(1.0, 0.0)]),
        (0, vec![(1.0, 0.1), (2.0, 1.0)]),
        (1, vec![(1.0, 0.0), (2.0, 0.9)]),
        (1, vec![(2.0, 0.0), (1.0, 1.0)]),
        (2, vec![(1.0, 0.0), (2.0, 0.5), (3.0, 0.4), (4.0, 1.0)]),
        (0, vec![(0.0, 0.0), (1.0, 1.0)]),
        (1, vec![(1.0, 0.0), (2.0, nan)]),
    ] {
        let Err(Table { row: found, .. }) = SizeDistribution::table(&rows, Basis::Number) else {
            panic!("{rows:?}")
        };
        assert_eq!(found, row, "{rows:?}");
    }
}
