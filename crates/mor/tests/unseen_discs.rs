//! λ of discs at unseen times and parameters: predictions are not much farther off than the projection, by every method.
mod discs;

use discs::{Discs, each, runs, times};
use mor::MatRef;
use mor::interpolation::{Degree, Kernel, Method, NetworkParams, RbfParams, Record, SplineParams};
use mor::models::{Extrapolation, Spodiann, SpodiannParams};
use mor::shifted::Interpolation;
use mor::shifted::fourier::Als;

fn network() -> NetworkParams {
    NetworkParams { iterations: 60, ..NetworkParams::new(&[16]) }
}

fn fit(
    discs: &Discs,
    points: &[Vec<f64>],
    rank: usize,
    coefficients: &[Option<&dyn Method>],
) -> Vec<Spodiann> {
    let known = discs.part(points);
    let modes = Als { stagnation: 1e-2, ..Als::new(vec![rank; discs.count()]) }
        .solve(&discs.grid, &known.motions, known.snapshots.as_ref(), None, None, &mut |_| true)
        .unwrap();
    let model = |coefficients: &Option<&dyn Method>| {
        let params = SpodiannParams { coefficients: *coefficients, paths: None };
        let how = (discs.grid, Interpolation::Spectral);
        Spodiann::new(known.points.as_ref(), &modes, how, &known.motions, params).unwrap()
    };
    coefficients.iter().map(model).collect()
}

fn columns(times: Vec<f64>) -> Vec<Vec<f64>> {
    times.into_iter().map(|t| vec![t]).collect()
}

/// Every snapshot between those of the fit, up to both ends: at most 1.5 times the projection error (cubic splines, which interpolate what harmonics leave, too).
#[test]
fn two_discs_at_unseen_times() {
    let [spline, rbf, network] =
        [&SplineParams::new(Degree::Cubic) as &dyn Method, &RbfParams::new(Kernel::Cubic), &network()];
    let methods = [None, Some(spline), Some(rbf), Some(network)];
    for seed in [1, 2] {
        let discs = Discs::random(seed, [48, 64], [2, 1], 6.0);
        let held = discs.part(&columns(times(101, true)));
        for model in fit(&discs, &columns(times(101, false)), 5, &methods) {
            let fits = model.coefficient_fits();
            let method = &fits[0].as_ref().unwrap().method;
            for (j, error) in each(&model, &held).unwrap().iter().enumerate() {
                assert!(
                    error.total < 1.5 * error.projection,
                    "seed {seed}, {method}, snapshot {j}: {error:?}"
                );
            }
        }
    }
}

/// Four runs between five: at most 1.3 times the projection error.
#[test]
fn two_discs_at_unseen_parameters() {
    let [rbf, network] = [&RbfParams::new(Kernel::Cubic) as &dyn Method, &network()];
    for seed in [1, 2] {
        let discs = Discs::random(seed, [48, 64], [2, 1], 6.0);
        let known = runs(&times(31, false), &[-1.0, -0.5, 0.0, 0.5, 1.0]);
        let held = discs.part(&runs(&times(9, true), &[-0.8, -0.3, 0.25, 0.7]));
        for model in fit(&discs, &known, 5, &[None, Some(rbf), Some(network)]) {
            let found = model.assess(held.points.as_ref(), held.snapshots.as_ref(), &held.motions).unwrap();
            assert!(
                found.total < 1.3 * found.projection,
                "seed {seed}: {found:?} {:?}",
                model.coefficient_fits()
            );
        }
    }
}

/// The method given is the one that is used and recorded: a network's predictions follow its weights.
#[test]
fn a_network_is_a_network() {
    let discs = Discs::random(3, [36, 48], [1, 1], 6.0);
    let known = columns(times(61, false));
    let [network, spline] = [&network() as &dyn Method, &SplineParams::new(Degree::Quintic)];
    let models = fit(&discs, &known, 3, &[Some(network), Some(spline)]);
    let field = |model: &Spodiann, t: f64| {
        let mut field = vec![0.0; model.rows()];
        model.predict(&[t], &mut field).unwrap();
        field
    };
    let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    for (model, given) in models.iter().zip([network, spline]) {
        let fits = model.coefficient_fits();
        let fit = fits[0].as_ref().unwrap();
        assert!(fit.method.starts_with(&given.name()), "{fit:?}");
        assert!(!fit.phases.is_empty() && fit.left_out < fit.left_out_other.unwrap(), "{fit:?}");
        let again = Spodiann::from_record(&Record::from_bytes(&model.record().to_bytes()).unwrap()).unwrap();
        assert_eq!(again.coefficient_fits(), fits);
        assert_eq!(again.path_method(), model.path_method());
    }
    let record = models[0].record();
    let name = "frame 0/coefficients/function/amplitudes/weights";
    let weights: Vec<f64> = record.numbers(name).unwrap().iter().map(|w| 1.1 * w).collect();
    let other = Spodiann::from_record(&record.with(name, weights)).unwrap();
    let [one, two] = [&models[0], &other].map(|model| field(model, 0.503));
    assert!(distance(&one, &two) > 0.01 * distance(&one, &vec![0.0; one.len()]));
    assert!(distance(&one, &field(&models[1], 0.503)) > 1e-6);
}

/// Beyond the last snapshot paths go on linearly and coefficients stay of the size they have, unless the function itself is set.
#[test]
fn extrapolation_is_linear() {
    let discs = Discs::random(4, [36, 48], [1, 1], 6.0);
    let model = fit(&discs, &columns(times(61, false)), 3, &[None]).remove(0);
    assert!(model.covers(&[1.0]) && !model.covers(&[1.001]) && !model.covers(&[-0.001]));
    let at = |t: f64| model.places(&[t]).unwrap()[0];
    let slope = (at(1.0) - at(1.0 - 1e-6)) / 1e-6;
    assert!((at(1.5) - at(1.0) - 0.5 * slope).norm() < 1e-2 * slope.norm());
    let size = |model: &Spodiann, t: f64| {
        let mut field = vec![0.0; model.rows()];
        model.predict(&[t], &mut field).unwrap();
        MatRef::from_column_major_slice(&field, field.len(), 1).norm_l2()
    };
    assert!(size(&model, 2.0) < 1.5 * size(&model, 1.0));
    let end = model.places(&[1.0]).unwrap();
    let constant = model.extrapolated(Extrapolation::Constant);
    assert_eq!(constant.places(&[1.5]).unwrap(), end);
    let again = Spodiann::from_record(&constant.record()).unwrap();
    assert_eq!(again.places(&[1.5]).unwrap(), end);
}
