//! Amplitudes by several methods.
use super::*;
use crate::interpolation::{Kernel, NetworkParams, ProductParams, RbfParams, SplineParams};
use std::f64::consts::TAU;

/// (u, cos θ, sin θ) with a phase that turns by 0.2 to 1.1 cycles from sample to sample.
fn point(t: f64, mu: f64) -> [f64; 4] {
    let theta = TAU * (8.0 + mu) * t * (1.0 + 2.0 * t);
    [t, mu, theta.cos(), theta.sin()]
}

fn exact([t, mu, c, s]: [f64; 4]) -> [f64; 2] {
    [(t + mu).sin() + 0.3 * (1.0 + t * mu) * c, mu * t - 0.2 * s]
}

/// 41 times of five runs.
fn samples() -> Samples {
    let at = |j: usize| point((j % 41) as f64 / 40.0, [0.0, 0.3, 0.6, 0.8, 1.0][j / 41]);
    let points = Mat::from_fn(4, 205, |i, j| at(j)[i]);
    let values = Mat::from_fn(2, 205, |i, j| exact(at(j))[i]);
    Samples::new(points.as_ref(), values.as_ref()).unwrap()
}

#[test]
fn every_method_takes_phases() {
    let network = NetworkParams { iterations: 300, bandwidth: 1.0, ..NetworkParams::new(&[16]) };
    let product = ProductParams {
        first: SplineParams::new(Degree::Quintic),
        others: Box::new(RbfParams::new(Kernel::Cubic)),
    };
    let rbf = RbfParams::new(Kernel::Quintic);
    let spline = SplineParams::new(Degree::Cubic);
    let methods: [(&dyn Method, f64); 4] =
        [(&spline, 1e-3), (&rbf, 1e-2), (&product, 1e-2), (&network, 1e-2)];
    for (amplitudes, tolerance) in methods {
        let params = HarmonicsParams { amplitudes: Box::new(amplitudes), slow: 2 };
        let found = params.fit(&samples()).unwrap();
        let mut y = [0.0; 2];
        let mut worst = 0.0_f64;
        for [t, mu] in (0..200).map(|j| [f64::from(j) / 199.0, (f64::from(j) * 0.618).fract()]) {
            found.predict(&point(t, mu), &mut y).unwrap();
            worst = (0..2).map(|i| (y[i] - exact(point(t, mu))[i]).abs()).fold(worst, f64::max);
        }
        assert!(worst < tolerance, "{}: {worst:e}", params.name());
        let (x, mut slope) = (point(0.37, 0.45), [0.0; 2]);
        for i in 0..4 {
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
        assert!(load(&found.record().with("waves", [2.0, 1.0])).is_err());
    }
}
