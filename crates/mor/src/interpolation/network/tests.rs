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
fn waves_make_fast_periodic_functions_learnable() {
    let turn = |x: f64| std::f64::consts::TAU * x;
    let f = |x: f64| turn(21.0 * x).sin() * (1.0 + 0.5 * turn(2.0 * x).cos()) + 0.3 * turn(34.3 * x).cos();
    let samples = on_line(301, [0.0, 1.0], f);
    let plain = NetworkParams { iterations: 500, ..NetworkParams::new(&[32]) };
    let with = |fourier| NetworkParams { fourier, ..plain.clone() }.network(&samples).unwrap();
    let [blind, found] = [Fourier::None, Fourier::Found { most: 8 }].map(with);
    let off = [&blind, &found].map(|network| error(network, f));
    assert!(off[0] > 0.1 && off[1] < 1e-4, "{off:?}");
    // The waves are the ones it is made of.
    let frequencies = found.frequencies();
    for wanted in [19.0, 21.0, 23.0, 34.3] {
        let nearest = (0..frequencies.ncols()).map(|j| (frequencies[(0, j)] - wanted).abs());
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!(nearest < 0.2, "{wanted} by {nearest}");
    }
    // A known period, in one of two inputs, from a part of it.
    let points = Mat::from_fn(2, 400, |i, j| [(j % 40) as f64 * 0.11, (j / 40) as f64 / 9.0][i]);
    let g = |x: &[f64]| (turn(x[0] / 2.5).sin() + x[1]).powi(3);
    let values = Mat::from_fn(1, 400, |_, j| g(points.col_as_slice(j)));
    let samples = Samples::new(points.as_ref(), values.as_ref()).unwrap();
    let fourier = Fourier::Multiples { periods: vec![2.5, f64::INFINITY], up_to: 2 };
    let network = NetworkParams { fourier, ..plain }.network(&samples).unwrap();
    for x in [[0.3, 0.4], [2.4, 0.9]] {
        let mut y = [[0.0]; 2];
        network.predict(&x, &mut y[0]).unwrap();
        network.predict(&[x[0] + 250.0, x[1]], &mut y[1]).unwrap();
        assert!((y[0][0] - g(&x)).abs() < 1e-3 && (y[0][0] - y[1][0]).abs() < 1e-9, "{y:?} {}", g(&x));
    }
}

#[test]
fn stopping_early_keeps_noise_out() {
    let f = |x: f64| (std::f64::consts::TAU * x).sin();
    for eliminate in [false, true] {
        let mut sums = [0.0; 2];
        for seed in 0..5 {
            let noise = random(80, 1, 100 + seed);
            let exact = on_line(80, [0.0, 1.0], f);
            let values = Mat::from_fn(1, 80, |_, j| exact.values()[(0, j)] + 0.3 * noise[(j, 0)]);
            let noisy = Samples::new(exact.points(), values.as_ref()).unwrap();
            for (sum, validation) in sums.iter_mut().zip([0.0, 0.25]) {
                let params =
                    NetworkParams { eliminate, validation, seed, patience: 100, ..NetworkParams::new(&[40]) };
                let network = params.network(&noisy).unwrap();
                *sum += error(&network, f).powi(2);
                let report = network.report().unwrap();
                assert_eq!(report.held_out.len(), (80.0 * validation) as usize);
                assert!(!report.held_out.contains(&0) && !report.held_out.contains(&79));
                if validation > 0.0 {
                    assert_eq!(report.lbfgs_stop, Stop::Validation);
                    let least =
                        report.history.iter().filter_map(|e| e.validation).fold(f64::INFINITY, f64::min);
                    assert_eq!(report.history[report.kept].validation, Some(least));
                }
            }
        }
        assert!(sums[1] < 0.5 * sums[0], "eliminate {eliminate}: {sums:?}");
    }
}

#[test]
fn the_best_of_several_starts_is_kept() {
    let samples = on_line(40, [0.0, 1.0], |x| (9.0 * x).sin());
    let params = NetworkParams { iterations: 60, ..NetworkParams::new(&[5]) };
    let score = |params: &NetworkParams| params.network(&samples).unwrap().report().unwrap().score();
    let each: Vec<f64> =
        (0..4).map(|start| score(&NetworkParams { seed: 1 + start, ..params.clone() })).collect();
    let network = NetworkParams { starts: 4, ..params }.network(&samples).unwrap();
    let report = network.report().unwrap();
    let least = each.iter().copied().fold(f64::INFINITY, f64::min);
    assert_eq!(report.score(), least);
    assert_eq!(each[report.start], least);
    assert!(report.cpu_seconds > 0.0 && report.history.len() > report.adam_steps);
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
    // Steps of Adam that leave no number standing, and no second descent.
    let adam = Adam { first: 1e300, last: 1e300, steps: 3 };
    let far = NetworkParams { adam, iterations: 0, eliminate: false, ..good.clone() }.network(&samples);
    assert!(far.is_ok_and(|kept| kept.report().unwrap().adam_stop == Stop::NotFinite));
    let steep =
        NetworkParams { bandwidth: 1e200, activation: Activation::Silu, eliminate: false, ..good.clone() };
    let error = steep.network(&samples).unwrap_err();
    assert!(matches!(error, InterpolationError::Diverged { .. }), "{error}");
    let network = good.network(&samples).unwrap();
    let error = network.predict(&[f64::NAN], &mut [0.0]).unwrap_err();
    assert!(matches!(error, InterpolationError::Point { input: 0, .. }), "{error}");
    let error = network.derivative(&[0.0], 1, &mut [0.0]).unwrap_err();
    assert!(matches!(error, InterpolationError::Shape { expected: 2, found: 1, .. }), "{error}");
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
