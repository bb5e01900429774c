//! Error against CPU time of all methods of interpolation. `cargo bench -p siltflow-mor --bench interpolation`, or with `time`, `parameters`,
//! `runs`, `widths` after `--`; on one thread.
use cpu_time::ProcessTime;
use monomorphic::self_adjoint_eigenvectors;
use mor::Mat;
use mor::interpolation::{
    Activation, Degree, Folds, Fourier, InterpolationError, Kernel, Method, NetworkParams, RbfParams,
    Samples, SplineParams, best, candidates, cross_validate,
};

type Outcome = Result<(), InterpolationError>;

type Case = (&'static str, fn() -> Outcome);

fn main() -> Outcome {
    let cases: [Case; 4] = [("time", time), ("parameters", parameters), ("runs", runs), ("widths", widths)];
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    for (name, case) in cases {
        if asked.is_empty() || asked.iter().any(|a| a == name) {
            case()?;
        }
    }
    Ok(())
}

/// A pulse e^{−s²/0.05²} at 400 points of [0, 1), periodic, around these places.
fn pulses(places: &[f64]) -> Mat<f64> {
    Mat::from_fn(400, places.len(), |i, j| {
        let away = (i as f64 + 0.5) / 400.0 - places[j];
        (-((away - away.round()) / 0.05).powi(2)).exp()
    })
}

/// The first 20 modes of snapshots.
fn modes(snapshots: &Mat<f64>) -> Result<Mat<f64>, InterpolationError> {
    let gram = snapshots * snapshots.transpose();
    let vectors = self_adjoint_eigenvectors(gram.as_ref())
        .ok_or(InterpolationError::Singular { what: "the modes".into(), remedy: "look at the snapshots" })?;
    let last = vectors.ncols() - 1;
    Ok(Mat::from_fn(vectors.nrows(), 20, |i, j| vectors[(i, last - j)]))
}

/// Coefficients of the first 20 modes of a travelling pulse at 601 times.
fn travelling(path: impl Fn(f64) -> f64) -> Result<Samples, InterpolationError> {
    let times: Vec<f64> = (0..601).map(|j| f64::from(j) / 600.0).collect();
    let snapshots = pulses(&times.iter().map(|&t| path(t)).collect::<Vec<_>>());
    let coefficients = modes(&snapshots)?.transpose() * &snapshots;
    Samples::of_one_input(&times, coefficients.as_ref())
}

/// Every second time, and the others.
fn halves(samples: &Samples) -> Option<[Samples; 2]> {
    let from = |first: usize| samples.subset(&(first..samples.len()).step_by(2).collect::<Vec<_>>());
    Some([from(0)?, from(1)?])
}

fn paths() -> Result<[(&'static str, Samples); 2], InterpolationError> {
    Ok([
        ("at constant speed, one period", travelling(|t| 0.1 + t)?),
        ("accelerating", travelling(|t| 0.1 + 0.3 * t + 0.5 * t * t)?),
    ])
}

fn time() -> Outcome {
    for (name, samples) in paths()? {
        println!(
            "\nA pulse {name}: 20 coefficients at 301 of 601 times, relative error at the other 300 and at the 301"
        );
        heading();
        let Some([known, held]) = halves(&samples) else { return Ok(()) };
        let mut methods: Vec<Box<dyn Method>> = Vec::new();
        methods.extend(Degree::ALL.map(|degree| Box::new(SplineParams::new(degree)) as Box<dyn Method>));
        methods.extend(Kernel::ALL.map(|kernel| Box::new(RbfParams::new(kernel)) as Box<dyn Method>));
        let multiples = Fourier::Multiples { periods: vec![1.0], up_to: 10 };
        for activation in Activation::ALL {
            for (hidden, fourier, eliminate) in [
                (vec![32, 32, 32], Fourier::None, false),
                (vec![32, 32, 32], Fourier::None, true),
                (vec![64], Fourier::None, true),
                (vec![64], Fourier::Found { most: 8 }, true),
                (vec![64], multiples.clone(), true),
            ] {
                methods.push(Box::new(NetworkParams {
                    activation,
                    fourier,
                    eliminate,
                    ..NetworkParams::new(&hidden)
                }));
            }
        }
        for method in &methods {
            row(&method.name(), method.as_ref(), &known, &held)?;
        }
        chosen(&known)?;
    }
    Ok(())
}

fn heading() {
    println!("{:44} {:>9} {:>9} {:>8} {:>10}", "method", "between", "at", "CPU s", "µs a point");
}

fn row(name: &str, method: &dyn Method, known: &Samples, held: &Samples) -> Outcome {
    let begin = ProcessTime::now();
    let function = match method.fit(known) {
        Ok(function) => function,
        Err(why) => {
            println!("{name:44} {why}");
            return Ok(());
        }
    };
    let fit = begin.elapsed().as_secs_f64();
    let begin = ProcessTime::now();
    let between = function.predict_all(held.points())?;
    let micros = begin.elapsed().as_secs_f64() * 1e6 / held.len() as f64;
    let at = function.predict_all(known.points())?;
    let error = |found: Mat<f64>, of: &Samples| (found - of.values()).norm_l2() / of.values().norm_l2();
    println!("{name:44} {:9.2e} {:9.2e} {fit:8.3} {micros:10.2}", error(between, held), error(at, known));
    Ok(())
}

fn chosen(samples: &Samples) -> Outcome {
    let begin = ProcessTime::now();
    let best = best(samples)?;
    print!("\nThe default choice by cross-validation:\n{}", best.table);
    println!("{:.1} CPU s in all", begin.elapsed().as_secs_f64());
    Ok(())
}

/// Smooth functions of two parameters.
type Surface = (&'static str, fn(f64, f64) -> [f64; 3]);

const SURFACES: [Surface; 3] = [
    ("gentle", |a, b| [(1.5 * a).sin() * b.exp(), 1.0 / (1.0 + a * a + 2.0 * b * b), (a + b).cos()]),
    ("waves", |a, b| [(4.0 * a + b).sin(), (3.0 * b - a).cos(), (3.0 * a * b).sin()]),
    ("front and ridge", |a, b| {
        [(4.0 * (a + 0.5 * b - 0.7)).tanh(), (-(4.0 * (a - b)).powi(2)).exp(), (a - 0.3 * b).exp()]
    }),
];

fn parameters() -> Outcome {
    let points = Mat::from_fn(2, 25, |i, j| [j % 5, j / 5][i] as f64 / 4.0);
    let fine = Mat::from_fn(2, 1681, |i, j| [j % 41, j / 41][i] as f64 / 40.0);
    for (name, f) in SURFACES {
        println!(
            "\nThree functions of two parameters, 5 × 5 samples: {name}. Relative errors: each sample left out, those inside only, planes \
             left out, and on 41 × 41 points by all samples"
        );
        println!(
            "{:34} {:>9} {:>9} {:>9} {:>9} {:>8}",
            "method", "each", "inside", "planes", "41 × 41", "CPU s"
        );
        let of = |points: &Mat<f64>| {
            let values = Mat::from_fn(3, points.ncols(), |i, j| f(points[(0, j)], points[(1, j)])[i]);
            Samples::new(points.as_ref(), values.as_ref())
        };
        let [samples, truth] = [of(&points)?, of(&fine)?];
        let folds = [
            Folds::leave_one_out(&samples),
            Folds::leave_one_out_inside(&samples),
            Folds::planes(&samples, 5)?,
        ];
        for method in candidates(&samples) {
            print!("{:34}", method.name());
            for folds in &folds {
                // A grid without one node is no grid for splines.
                match cross_validate(method.as_ref(), &samples, folds) {
                    Ok(found) => print!(" {:9.2e}", found.error),
                    Err(_) => print!(" {:>9}", "-"),
                }
            }
            let begin = ProcessTime::now();
            let function = method.fit(&samples)?;
            let seconds = begin.elapsed().as_secs_f64();
            let off = function.predict_all(truth.points())? - truth.values();
            println!(" {:9.2e} {seconds:8.4}", off.norm_l2() / truth.values().norm_l2());
        }
        chosen(&samples)?;
    }
    Ok(())
}

/// Coefficients of the same 20 modes in 5 × 5 runs of 121 times, and in 4 × 4 runs at points between.
fn runs() -> Outcome {
    println!(
        "\nPulses that start at 0.1…0.15 and travel by 0.3…0.4 or so: 20 coefficients at 121 times in 5 × 5 runs. Relative error of \
         cross-validation (runs and times left out), in 4 × 4 runs between, and in these runs"
    );
    let times = 121;
    let inputs = |n: usize, first: f64, step: f64| {
        let parameter = move |i: usize| first + step * i as f64;
        let at = move |j: usize| [parameter((j / times) % n), parameter(j / times / n)];
        Mat::from_fn(3, times * n * n, |i, j| {
            if i == 0 { (j % times) as f64 / (times - 1) as f64 } else { at(j)[i - 1] }
        })
    };
    let snapshots = |inputs: &Mat<f64>| {
        let place = |j: usize| {
            let (t, speed, offset) = (inputs[(0, j)], inputs[(1, j)], inputs[(2, j)]);
            0.1 + 0.05 * offset + (0.3 + 0.1 * speed) * t + 0.1 * t * t
        };
        pulses(&(0..inputs.ncols()).map(place).collect::<Vec<_>>())
    };
    let [known, held] = [inputs(5, 0.0, 0.25), inputs(4, 0.125, 0.25)];
    let [q, r] = [snapshots(&known), snapshots(&held)];
    let modes = modes(&q)?;
    let [known, held] = [(known, q), (held, r)]
        .map(|(inputs, snapshots)| Samples::new(inputs.as_ref(), (modes.transpose() * snapshots).as_ref()));
    let [known, held] = [known?, held?];
    let folds = Folds::suited(&known, 1)?;
    heading();
    for method in candidates(&known) {
        let error = cross_validate(method.as_ref(), &known, &folds)?.error;
        row(&format!("{}: {error:.2e}", method.name()), method.as_ref(), &known, &held)?;
    }
    chosen(&known)
}

/// How the error of a network falls with its size and its iterations.
fn widths() -> Outcome {
    for (name, samples) in paths()? {
        println!("\nA pulse {name}, as above");
        heading();
        let Some([known, held]) = halves(&samples) else { return Ok(()) };
        for width in [16, 32, 64, 96] {
            for iterations in [500, 2500, 10_000] {
                let fourier = Fourier::Found { most: 8 };
                let params = NetworkParams { iterations, fourier, ..NetworkParams::new(&[width]) };
                row(&format!("{}, {iterations} iterations", params.name()), &params, &known, &held)?;
            }
        }
    }
    Ok(())
}
