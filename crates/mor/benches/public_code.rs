//! Cases of other programs, read from `.npy` files (snapshots along the first axis), for the scripts
//! in `benches/peers`, which call it: `cargo bench -p siltflow-mor --bench public_code -- KIND …`.
//!
//! * `pod FILE METHOD RANK`: singular values; METHOD is `auto`, `snapshots`, `qr` or `randomised`.
//! * `shifted FOLDER RANKS TOLERANCE`: `data.npy`, `clean.npy`, `shifts.npy` (cells per frame) on a periodic line;
//!   RANKS is `found` or as `3,2`.
//! * `model FOLDER RANK METHOD`: `snapshots.npy` at `points.npy`, errors at `held_points.npy` against
//!   `held.npy`; METHOD is a kernel, `spline`, `network ITERATIONS WIDTH …` or `best`.
//!
//! One line of `name value` pairs; CPU and wall seconds are without reading.
use cpu_time::ProcessTime;
use interfaces::Vector;
use mor::Mat;
use mor::interpolation::{Degree, Kernel, Method, NetworkParams, RbfParams, SplineParams};
use mor::models::Podiann;
use mor::pod::{Pod, PodParams, Rank, SvdMethod};
use mor::shifted::{Grid, GridFrames, Interpolation, Motion, Motions, Ranks, ShiftedPod};
use mor::snapshots::{NpyArray, SnapshotAxis, SnapshotSource};
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

type Outcome = Result<(), Box<dyn Error>>;

fn read(path: impl AsRef<Path>) -> Result<Mat<f64>, Box<dyn Error>> {
    Ok(NpyArray::open(path, SnapshotAxis::First)?.to_mat()?)
}

/// Result, CPU and wall seconds.
fn timed<T>(run: impl FnOnce() -> T) -> (T, [f64; 2]) {
    let (cpu, wall) = (ProcessTime::now(), Instant::now());
    let result = run();
    (result, [cpu.elapsed().as_secs_f64(), wall.elapsed().as_secs_f64()])
}

fn pod([file, method, rank]: [&str; 3]) -> Outcome {
    let snapshots = read(file)?;
    let method = match method {
        "auto" => SvdMethod::Auto,
        "snapshots" => SvdMethod::Snapshots,
        "qr" => SvdMethod::Qr,
        "randomised" => SvdMethod::Randomised { oversampling: 10, power_iterations: 2, seed: 1 },
        other => return Err(format!("no method {other}").into()),
    };
    let params = PodParams { method, rank: Rank::Fixed(rank.parse()?), ..PodParams::default() };
    let (pod, [cpu, wall]) = timed(|| Pod::new(snapshots.as_ref(), &params));
    let pod = pod?;
    let gram = pod.modes.transpose() * &pod.modes;
    let skew = (gram - Mat::<f64>::identity(pod.rank(), pod.rank())).norm_max();
    print!("cpu {cpu} wall {wall} skew {skew:e} values");
    pod.singular_values[..pod.rank()].iter().for_each(|s| print!(" {s:e}"));
    println!();
    Ok(())
}

fn shifted([folder, ranks, tolerance]: [&str; 3]) -> Outcome {
    let [data, clean, shifts] =
        ["data", "clean", "shifts"].map(|n| read(Path::new(folder).join(n).with_extension("npy")));
    let (data, clean, shifts) = (data?, clean?, shifts?);
    let grid = Grid::new([data.nrows()], [1.0])?;
    let to = |k: usize, j: usize| Motion::translation(Vector::x() * shifts[(j, k)]);
    let motions = Motions::by(shifts.ncols(), data.ncols(), to);
    let ranks = match ranks {
        "found" => Ranks::Found,
        given => Ranks::Given(given.split(',').map(str::parse).collect::<Result<_, _>>()?),
    };
    let pod = ShiftedPod::new(grid, Interpolation::Spectral).ranks(ranks).tolerance(tolerance.parse()?);
    let (d, [cpu, wall]) =
        timed(|| pod.solve(&motions, data.as_ref(), None, &mut |_| ControlFlow::Continue(())));
    let d = d?;
    let frames = GridFrames::new(grid, Interpolation::Spectral, &motions, data.nrows())?;
    let error = d.relative_error(&frames, clean.as_ref());
    println!("cpu {cpu} wall {wall} error {error:e} ranks {:?} steps {}", d.ranks(), d.history.len());
    Ok(())
}

fn model(arguments: &[&str]) -> Outcome {
    let [folder, rank, method, numbers @ ..] = arguments else { return Err("FOLDER RANK METHOD".into()) };
    let file = |name: &str| read(Path::new(folder).join(name).with_extension("npy"));
    let [snapshots, points, held, held_points] = ["snapshots", "points", "held", "held_points"].map(file);
    let (snapshots, points, held, held_points) = (snapshots?, points?, held?, held_points?);
    let numbers: Vec<usize> = numbers.iter().map(|w| w.parse()).collect::<Result<_, _>>()?;
    let method: Option<Box<dyn Method>> = match *method {
        "best" => None,
        "spline" => Some(Box::new(SplineParams::new(Degree::Cubic))),
        "network" => {
            let [iterations, hidden @ ..] = numbers.as_slice() else { return Err("ITERATIONS".into()) };
            Some(Box::new(NetworkParams { iterations: *iterations, ..NetworkParams::new(hidden) }))
        }
        name => {
            let kernel = Kernel::ALL.into_iter().find(|k| k.name() == name);
            let kernel = kernel.ok_or_else(|| format!("no method {name}"))?;
            Some(Box::new(RbfParams::new(kernel)))
        }
    };
    let params = PodParams::of_rank(rank.parse()?);
    let (fit, [cpu, wall]) = timed(|| -> Result<_, Box<dyn Error>> {
        let pod = Pod::new(snapshots.as_ref(), &params)?;
        let model = Podiann::new(points.as_ref(), &pod, method.as_deref())?;
        Ok((pod, model))
    });
    let (pod, model) = fit?;
    let mut fields = vec![0.0; held.nrows() * held.ncols()];
    let (done, [predict, _]) = timed(|| model.predict_many(held_points.as_ref(), &mut fields));
    done?;
    let fields = mor::MatRef::from_column_major_slice(&fields, held.nrows(), held.ncols());
    let error = (fields - &held).norm_l2() / held.norm_l2();
    let projection = pod.relative_projection_error(held.as_ref())?;
    let name = model.method().unwrap_or("none").replace(' ', "_");
    println!(
        "cpu {cpu} wall {wall} predict {predict} error {error:e} projection {projection:e} method {name}"
    );
    Ok(())
}

fn main() -> Outcome {
    let all: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    match *all.as_slice() {
        ["pod", file, method, rank] => pod([file, method, rank]),
        ["shifted", folder, ranks, tolerance] => shifted([folder, ranks, tolerance]),
        ["model", ref arguments @ ..] => model(arguments),
        _ => {
            println!("called by the scripts in benches/peers");
            Ok(())
        }
    }
}
