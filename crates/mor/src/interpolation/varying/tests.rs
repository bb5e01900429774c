//! Functions of slow inputs and phases that are known.
use super::super::load;
use super::*;
use std::f64::consts::TAU;

/// Displacement in cells for a parameter.
fn displacement(t: f64, mu: f64) -> f64 {
    3.0 * t + (40.0 + 7.0 * mu) * t * t
}

/// (t + μ t² cos θ, sin 3t − eᵗ sin 2θ).
fn exact(t: f64, mu: f64) -> [f64; 2] {
    let theta = TAU * displacement(t, mu);
    [t + mu * t * t * theta.cos(), (3.0 * t).sin() - t.exp() * (2.0 * theta).sin()]
}

fn phase(t: f64, mu: f64) -> [f64; 2] {
    let theta = TAU * displacement(t, mu);
    [theta.cos(), theta.sin()]
}

/// At m times of μ = 1.
fn samples(m: usize) -> Samples {
    let t = |j: usize| j as f64 / (m - 1) as f64;
    let point = |j: usize| [t(j), phase(t(j), 1.0)[0], phase(t(j), 1.0)[1]];
    let points = Mat::from_fn(3, m, |i, j| point(j)[i]);
    let values = Mat::from_fn(2, m, |i, j| exact(t(j), 1.0)[i]);
    Samples::new(points.as_ref(), values.as_ref()).unwrap()
}

fn quintic(slow: usize) -> VaryingParams {
    VaryingParams { degree: Degree::Quintic, slow }
}

/// s grows by up to 0.69 cells from sample to sample: functions of t alone cannot follow.
#[test]
fn fast_phases_are_followed() {
    let found = quintic(1).varying(&samples(121)).unwrap();
    let mut y = [0.0; 2];
    let point = |t: f64| [t, phase(t, 1.0)[0], phase(t, 1.0)[1]];
    let mut worst = 0.0_f64;
    for t in (0..2000).map(|j| f64::from(j) / 1999.0) {
        found.predict(&point(t), &mut y).unwrap();
        worst = worst.max((y[0] - exact(t, 1.0)[0]).abs()).max((y[1] - exact(t, 1.0)[1]).abs());
    }
    assert!(worst < 1e-6, "{worst:e} with {} terms", found.terms());
    let (x, mut slope) = (point(0.37), [0.0; 2]);
    for i in 0..3 {
        let mut at = |by: f64| {
            let mut x = x;
            x[i] += by;
            found.predict(&x, &mut y).unwrap();
            y
        };
        let [up, down] = [at(1e-5), at(-1e-5)];
        found.derivative(&x, i, &mut slope).unwrap();
        assert!((0..2).all(|k| (slope[k] - (up[k] - down[k]) / 2e-5).abs() < 1e-6), "input {i}");
    }
    let again = load(&Record::from_bytes(&found.record().to_bytes()).unwrap()).unwrap();
    let mut same = [0.0; 2];
    again.predict(&x, &mut same).unwrap();
    found.predict(&x, &mut y).unwrap();
    assert_eq!(same, y);
    assert!(Varying::from_record(&found.record().with("slow", [2.0])).is_err());
}

/// Five runs of 41 times: phases at a parameter between them are those of no sample.
#[test]
fn phases_at_unseen_parameters() {
    let mus = [0.0, 0.4, 1.0, 1.5, 2.0];
    let at = |j: usize| [(j % 41) as f64 / 40.0, mus[j / 41]];
    let point = |[t, mu]: [f64; 2]| [t, mu, phase(t, mu)[0], phase(t, mu)[1]];
    let points = Mat::from_fn(4, 205, |i, j| point(at(j))[i]);
    let values = Mat::from_fn(2, 205, |i, j| exact(at(j)[0], at(j)[1])[i]);
    let found = quintic(2).varying(&Samples::new(points.as_ref(), values.as_ref()).unwrap()).unwrap();
    let mut worst = 0.0_f64;
    let mut y = [0.0; 2];
    for [t, mu] in (0..300).map(|j| [f64::from(j) / 299.0, (f64::from(j) * 0.618).fract() * 2.0]) {
        found.predict(&point([t, mu]), &mut y).unwrap();
        worst = worst.max((y[0] - exact(t, mu)[0]).abs()).max((y[1] - exact(t, mu)[1]).abs());
    }
    assert!(worst < 5e-3, "{worst:e} with {} terms", found.terms());
}

/// A constant phase is no reason for large coefficients; too few samples and unpaired inputs are errors.
#[test]
fn poor_samples() {
    let times: Vec<f64> = (0..40).map(|j| f64::from(j) / 39.0).collect();
    let points = Mat::from_fn(3, 40, |i, j| [times[j], 1.0, 0.0][i]);
    let values = Mat::from_fn(1, 40, |_, j| times[j].powi(3));
    let still = Samples::new(points.as_ref(), values.as_ref()).unwrap();
    let found = quintic(1).fit(&still).unwrap();
    let mut y = [0.0];
    found.predict(&[0.3, 1.0, 0.0], &mut y).unwrap();
    assert!((y[0] - 0.027).abs() < 1e-6, "{}", y[0]);
    found.predict(&[0.3, 0.0, 1.0], &mut y).unwrap();
    assert!(y[0].abs() < 0.1, "{}", y[0]);
    assert!(matches!(
        quintic(1).fit(&samples(8)),
        Err(InterpolationError::TooFew { needed: 9, found: 8, .. })
    ));
    assert!(matches!(quintic(2).fit(&samples(30)), Err(InterpolationError::Parameter { .. })));
}

/// Predictions stay near the values up to both ends where the phase hardly changes, and noise is not amplified.
#[test]
fn noise_at_the_ends() {
    let noise = |j: usize| ((j * 7919) % 101) as f64 / 50.0 - 1.0;
    // Starts from rest and comes to rest.
    let theta = |t: f64| TAU * 2.0 * t * t * (3.0 - 2.0 * t);
    let point = |t: f64| [t, theta(t).cos(), theta(t).sin()];
    let t = |j: f64| j / 60.0;
    let points = Mat::from_fn(3, 61, |i, j| point(t(j as f64))[i]);
    let values = Mat::from_fn(1, 61, |_, j| 1.0 + 0.3 * theta(t(j as f64)).cos() + 0.05 * noise(j));
    let samples = Samples::new(points.as_ref(), values.as_ref()).unwrap();
    for degree in Degree::ALL {
        let found = VaryingParams { degree, slow: 1 }.varying(&samples).unwrap();
        for j in 0..600 {
            let at = t(f64::from(j) / 10.0);
            let mut y = [0.0];
            found.predict(&point(at), &mut y).unwrap();
            let off = (y[0] - 1.0 - 0.3 * theta(at).cos()).abs();
            assert!(off < 0.05, "{degree:?} at {at}: {off:e} with {} terms", found.terms());
        }
    }
}

/// A body that moves by nearly a whole cell from sample to sample towards the end: samples there see few phases, and those between them others.
#[test]
fn phases_of_no_sample() {
    for speed in [0.95, 1.0, 1.02, 1.05] {
        let noise = |j: usize| ((j * 7919) % 101) as f64 / 50.0 - 1.0;
        let theta = |t: f64| TAU * 80.0 * speed * t * (1.0 - (-t / 0.15).exp());
        let point = |t: f64| [t, theta(t).cos(), theta(t).sin()];
        let clean = |t: f64| 1.0 + 0.3 * theta(t).cos() + 0.1 * t;
        let t = |j: f64| j / 80.0;
        let points = Mat::from_fn(3, 81, |i, j| point(t(j as f64))[i]);
        let values = Mat::from_fn(1, 81, |_, j| clean(t(j as f64)) + 0.01 * noise(j));
        let samples = Samples::new(points.as_ref(), values.as_ref()).unwrap();
        for degree in Degree::ALL {
            let found = VaryingParams { degree, slow: 1 }.varying(&samples).unwrap();
            let (mut y, mut worst) = ([0.0], 0.0_f64);
            for at in (0..80).map(|j| t(f64::from(j) + 0.5)) {
                found.predict(&point(at), &mut y).unwrap();
                worst = worst.max((y[0] - clean(at)).abs());
            }
            assert!(worst < 0.01, "{speed}, {degree:?}: {worst:e} with {} terms", found.terms());
        }
    }
}
