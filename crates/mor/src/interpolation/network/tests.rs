//! Gradients, minimisation, what is learnt, files.
use super::lbfgs::{Limits, Objective};
use super::misfit::Misfit;
use super::*;
use crate::interpolation::load;
use proptest::prelude::*;

fn random(rows: usize, columns: usize, seed: u64) -> Mat<f64> {
    let mut random = Pcg64::seed_from_u64(seed);
    Mat::from_fn(rows, columns, |_, _| random.random_range(-1.0..1.0))
}

fn on_line(m: usize, [low, high]: [f64; 2], f: impl Fn(f64) -> f64) -> Samples {
    let x: Vec<f64> = (0..m).map(|i| low + (high - low) * i as f64 / (m - 1) as f64).collect();
    let values = Mat::from_fn(1, m, |_, i| f(x[i]));
    Samples::of_one_input(&x, values.as_ref()).unwrap()
}

/// Root mean square of the error between the samples.
fn error(network: &Network, f: impl Fn(f64) -> f64) -> f64 {
    let [[low, high]] = network.domain() else { panic!("one input") };
    let at = |i: i32| {
        let x = low + (high - low) * (f64::from(i) + 0.5) / 1000.0;
        let mut y = [0.0];
        network.predict(&[x], &mut y).unwrap();
        (y[0] - f(x)).powi(2)
    };
    ((0..1000).map(at).sum::<f64>() / 1000.0).sqrt()
}

fn layers(hidden: &[usize], activation: Activation) -> Layers {
    Layers { sizes: [&[2], hidden, &[4]].concat(), activation }
}

#[test]
fn the_gradient_is_that_of_the_loss() {
    let (x, y) = (random(2, 9, 1), random(4, 9, 2));
    for activation in Activation::ALL {
        for (hidden, eliminate) in
            [(vec![], false), (vec![5], false), (vec![6, 3], false), (vec![4], true), (vec![6, 3], true)]
        {
            let layers = layers(&hidden, activation);
            let mut misfit = Misfit::new(&layers, [x.as_ref(), y.as_ref()], 1e-2, eliminate);
            let theta: Vec<f64> = random(misfit.len(), 1, 3).col_as_slice(0).to_vec();
            let mut gradient = vec![f64::NAN; theta.len()];
            misfit.evaluate(&theta, &mut gradient);
            let mut unused = gradient.clone();
            let mut along = |direction: &dyn Fn(usize) -> f64| {
                let step = 1e-3;
                let mut at = |s: f64| {
                    let moved: Vec<f64> =
                        (0..theta.len()).map(|i| theta[i] + s * step * direction(i)).collect();
                    misfit.evaluate(&moved, &mut unused)
                };
                // Sixth order.
                (45.0 * (at(1.0) - at(-1.0)) - 9.0 * (at(2.0) - at(-2.0)) + at(3.0) - at(-3.0))
                    / (60.0 * step)
            };
            let scale = gradient.iter().fold(0.0, |a: f64, g| a.max(g.abs()));
            for i in 0..theta.len() {
                let difference = along(&|j| if i == j { 1.0 } else { 0.0 });
                let off = (difference - gradient[i]).abs() / scale;
                assert!(off < 1e-10, "{activation:?} {hidden:?} {eliminate}: {off:e} in {i}");
            }
            let direction = random(theta.len(), 1, 4);
            let difference = along(&|j| direction[(j, 0)]);
            let slope = lbfgs::dot(&gradient, direction.col_as_slice(0));
            let off = (difference - slope).abs() / slope.abs();
            assert!(off < 1e-9, "{activation:?} {hidden:?} {eliminate}: {off:e} in a random direction");
        }
    }
}

/// Σ 100 (θ₂ᵢ − θ²₂ᵢ₋₁)² + (1 − θ₂ᵢ₋₁)².
struct Rosenbrock;

impl Objective for Rosenbrock {
    fn evaluate(&mut self, theta: &[f64], gradient: &mut [f64]) -> f64 {
        let mut value = 0.0;
        for (i, [a, b]) in theta.as_chunks::<2>().0.iter().enumerate() {
            let (steep, flat) = (b - a * a, 1.0 - a);
            value += 100.0 * steep * steep + flat * flat;
            gradient[2 * i] = -400.0 * a * steep - 2.0 * flat;
            gradient[2 * i + 1] = 200.0 * steep;
        }
        value
    }
}

#[test]
fn lbfgs_follows_a_curved_valley_to_its_end() {
    let mut theta: Vec<f64> = (0..20).map(|i| if i % 2 == 0 { -1.2 } else { 1.0 }).collect();
    let limits = Limits { iterations: 200, memory: 20, gradient: 1e-11, decrease: 0.0 };
    let mut values = vec![];
    let stop = lbfgs::minimise(&mut Rosenbrock, &mut theta, &limits, &mut |_, value| {
        values.push(value);
        None
    });
    assert_eq!(stop, Stop::Gradient, "{values:?}");
    assert!(values.len() < 60 && values.windows(2).all(|w| w[1] < w[0]), "{values:?}");
    assert!(theta.iter().all(|t| (t - 1.0).abs() < 1e-10), "{theta:?}");
}

#[test]
fn a_sine_is_learnt_to_five_digits() {
    let f = |x: f64| (std::f64::consts::TAU * x).sin();
    let samples = on_line(60, [0.0, 1.0], f);
    let off = |activation, eliminate| {
        let params = NetworkParams { activation, eliminate, iterations: 4000, ..NetworkParams::new(&[20]) };
        error(&params.network(&samples).unwrap(), f)
    };
    for activation in Activation::ALL {
        let eliminated = off(activation, true);
        assert!(eliminated < 1e-6, "{activation:?}: {eliminated:e}");
        // With all weights free it is slower by orders of magnitude.
        let free = off(activation, false);
        assert!(free < if activation == Activation::Silu { 1e-4 } else { 1e-5 }, "{activation:?}: {free:e}");
        assert!(eliminated < 0.1 * free, "{activation:?}: {eliminated:e} and {free:e}");
    }
}

#[test]
fn derivatives_are_those_of_predictions() {
    let points = random(2, 40, 5);
    let values = Mat::from_fn(2, 40, |i, j| (3.0 * points[(i, j)]).sin() + points[(1 - i, j)]);
    let samples = Samples::new(points.as_ref(), values.as_ref()).unwrap();
    let periodic = Fourier::Multiples { periods: vec![2.5, f64::INFINITY], up_to: 2 };
    for fourier in [Fourier::None, periodic, Fourier::Found { most: 2 }] {
        for activation in Activation::ALL {
            let params = NetworkParams {
                activation,
                fourier: fourier.clone(),
                iterations: 20,
                ..NetworkParams::new(&[7, 5])
            };
            let network = params.network(&samples).unwrap();
            for input in 0..2 {
                let at = |s: f64| {
                    let mut x = [0.3, -0.2];
                    x[input] += s * 1e-3;
                    let mut y = [0.0; 2];
                    network.predict(&x, &mut y).unwrap();
                    y
                };
                let mut slopes = [0.0; 2];
                network.derivative(&[0.3, -0.2], input, &mut slopes).unwrap();
                for row in 0..2 {
                    let d = |s: f64| at(s)[row] - at(-s)[row];
                    let difference = (45.0 * d(1.0) - 9.0 * d(2.0) + d(3.0)) / 0.06;
                    let off = (difference - slopes[row]).abs();
                    assert!(off < 1e-7 * (1.0 + difference.abs()), "{fourier:?} {activation:?}: {off:e}");
                }
            }
        }
    }
}

#[test]
fn loaded_is_what_was_saved_bit_for_bit() {
    let samples = on_line(30, [-3.0, 5.0], |x| (2.0 * x).cos() + x);
    for fourier in [Fourier::None, Fourier::Found { most: 3 }] {
        let params = NetworkParams { fourier, iterations: 30, ..NetworkParams::new(&[6, 4]) };
        let network = params.network(&samples).unwrap();
        assert_eq!(params.network(&samples).unwrap().record(), network.record(), "the same twice");
        let bytes = network.record().to_bytes();
        let loaded = load(&Record::from_bytes(&bytes).unwrap()).unwrap();
        assert_eq!(loaded.record().to_bytes(), bytes);
        assert_eq!(loaded.domain(), network.domain());
        let (mut a, mut b) = ([0.0], [0.0]);
        network.predict(&[0.37], &mut a).unwrap();
        loaded.predict(&[0.37], &mut b).unwrap();
        assert_eq!(a[0].to_bits(), b[0].to_bits());
        for wrong in [
            network.record().with_word("activation", "relu"),
            network.record().with("sizes", [1.0]),
            network.record().with("sizes", [1.0, 0.0, 1.0]),
            network.record().with("weights", [1.0]),
        ] {
            assert!(matches!(Network::from_record(&wrong), Err(RecordError::Entry { .. })));
        }
    }
}

#[test]
fn what_cannot_be_is_said_with_numbers() {
    let samples = on_line(12, [0.0, 1.0], |x| x);
    let good = NetworkParams::new(&[4]);
    for wrong in [
        NetworkParams::new(&[4, 0]),
        NetworkParams { starts: 0, ..good.clone() },
        NetworkParams { bandwidth: f64::NAN, ..good.clone() },
        NetworkParams { decay: -1.0, ..good.clone() },
        NetworkParams { validation: 1.0, ..good.clone() },
        NetworkParams { adam: Adam { first: 0.0, ..Adam::default() }, ..good.clone() },
        NetworkParams { fourier: Fourier::Multiples { periods: vec![-1.0], up_to: 3 }, ..good.clone() },
        NetworkParams { fourier: Fourier::Multiples { periods: vec![1.0], up_to: 0 }, ..good.clone() },
    ] {
        let error = wrong.network(&samples).unwrap_err();
        assert!(matches!(error, InterpolationError::Parameter { .. }), "{error}");
    }
    let two = Fourier::Multiples { periods: vec![1.0, 1.0], up_to: 1 };
    let error = NetworkParams { fourier: two, ..good.clone() }.network(&samples).unwrap_err();
    assert!(matches!(error, InterpolationError::Shape { expected: 1, found: 2, .. }), "{error}");
    let one = samples.subset(&[3]).unwrap();
    let error = good.network(&one).unwrap_err();
    assert!(matches!(error, InterpolationError::TooFew { needed: 2, found: 1, .. }), "{error}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn constants_are_learnt_as_they_are(value in -1e6..1e6f64, m in 2..9usize, activation in 0..3usize) {
        let samples = on_line(m, [0.0, 1.0], |_| value);
        let params = NetworkParams { activation: Activation::ALL[activation], ..NetworkParams::new(&[3]) };
        let off = error(&params.network(&samples).unwrap(), |_| value);
        prop_assert!(off <= 1e-12 * value.abs(), "{off:e}");
    }
}
