//! Shifted POD beside wrong entries: `cargo bench -p siltflow-mor --bench shifted_outliers [-- SEEDS [PART …]]`.
//!
//! Two structures of ranks 3 and 2 cross on a periodic line of 512 cells in 60 snapshots: pulses at
//! random places of their frame whose amplitudes vary by random laws. A share of the entries (PART,
//! in per cent) is wrong: ±1.5 or ±0.75 are added to half of them, and replace the other half. One
//! line per run: ranks, relative error against the field without wrong entries in Frobenius' norm,
//! wrong entries that are missed and right ones that are rejected, why it stopped, steps, CPU
//! seconds. With `EXPORT=FOLDER` in the environment it writes `.npy` files for
//! `benches/peers/shifted.py` instead.
use cpu_time::ProcessTime;
use interfaces::{SnapshotSink, Vector};
use mor::Mat;
use mor::shifted::{
    Grid, GridFrames, Interpolation, Motion, Motions, Noise, Proximal, Ranks, ShiftedPod, Shifts,
};
use mor::snapshots::NpyWriter;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::path::Path;

const CELLS: usize = 512;
const SNAPSHOTS: usize = 60;
const RANKS: [usize; 2] = [3, 2];

struct Case {
    grid: Grid,
    shifts: Motions,
    clean: Mat<f64>,
}

fn crossing(rng: &mut Pcg64) -> Case {
    let time = |j: usize| j as f64 / (SNAPSHOTS - 1) as f64;
    let speeds = [1.0, -1.0].map(|sign| sign * rng.random_range(0.3..0.8) * CELLS as f64);
    let path = |k: usize, j: usize| speeds[k] * time(j);
    let centres = [0.2, 0.8].map(|x| x * CELLS as f64);
    // Place, width, and the amplitude b + c sin(ω t + φ) of every pulse.
    let pulse = |k: usize, i: usize, rng: &mut Pcg64| {
        let place = centres[k] + rng.random_range(-30.0..30.0);
        let size = 0.6_f64.powi(i as i32);
        let numbers = [rng.random_range(0.3..1.0), rng.random_range(0.3..0.7)].map(|x| x * size);
        let phases = [rng.random_range(2.0..9.0), rng.random_range(0.0..2.0 * PI)];
        (k, place, rng.random_range(6.0..20.0), numbers, phases)
    };
    let numbers = [0, 1].into_iter().flat_map(|k| (0..RANKS[k]).map(move |i| (k, i)));
    let pulses: Vec<_> = numbers.map(|(k, i)| pulse(k, i, rng)).collect();
    let value = |x: usize, j: usize| {
        let of = |&(k, place, width, [b, c], [omega, phi]): &(usize, f64, f64, [f64; 2], [f64; 2])| {
            let d = x as f64 - place - path(k, j);
            let d = d - CELLS as f64 * (d / CELLS as f64).round();
            (b + c * (omega * time(j) + phi).sin()) * (-(d / width).powi(2)).exp()
        };
        pulses.iter().map(of).sum()
    };
    Case {
        grid: Grid::new([CELLS], [1.0]).expect("a grid"),
        shifts: Motions::by(2, SNAPSHOTS, |k, j| Motion::translation(Vector::x() * path(k, j))),
        clean: Mat::from_fn(CELLS, SNAPSHOTS, value),
    }
}

fn spoilt(clean: &Mat<f64>, part: f64, rng: &mut Pcg64) -> Mat<f64> {
    Mat::from_fn(clean.nrows(), clean.ncols(), |i, j| {
        let wrong = [1.5, -1.5, 0.75, -0.75][rng.random_range(0..4_usize)];
        let (hit, added) = (rng.random_bool(part), rng.random_bool(0.5));
        let kept = if hit && !added { 0.0 } else { clean[(i, j)] };
        kept + if hit { wrong } else { 0.0 }
    })
}

/// One file of columns.
fn write(path: &Path, columns: usize, column: impl Fn(usize) -> Vec<f64>) {
    let mut writer = NpyWriter::create(path).expect("a file");
    for j in 0..columns {
        writer.push(j as f64, &column(j)).expect("a column");
    }
    writer.flush().expect("a whole file");
}

/// Data, clean field and shifts (cells, one column per frame).
fn export(folder: &Path, case: &Case, data: &Mat<f64>) {
    std::fs::create_dir_all(folder).expect("a folder");
    for (name, field) in [("data.npy", data), ("clean.npy", &case.clean)] {
        write(&folder.join(name), SNAPSHOTS, |j| field.col_as_slice(j).to_vec());
    }
    let path = |k: usize, j: usize| case.shifts.motion(k, j).displacement.x;
    write(&folder.join("shifts.npy"), 2, |k| (0..SNAPSHOTS).map(|j| path(k, j)).collect());
}

fn main() {
    let numbers: Vec<f64> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let seeds = numbers.first().map_or(4, |&n| n as u64);
    let parts = if numbers.len() > 1 { &numbers[1..] } else { &[0.1, 0.5, 1.0, 3.0, 5.0, 8.0, 12.0] };
    let first = std::env::var("SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(0);
    for seed in first..first + seeds {
        let mut rng = Pcg64::seed_from_u64(seed);
        let case = crossing(&mut rng);
        let Case { grid, shifts, clean } = &case;
        let grid = *grid;
        let op = GridFrames::new(grid, Interpolation::Spectral, shifts, CELLS).expect("frames");
        for &part in parts {
            let mut rng = Pcg64::seed_from_u64(1000 * seed + (10.0 * part) as u64);
            let data = spoilt(clean, 0.01 * part, &mut rng);
            if let Some(folder) = std::env::var_os("EXPORT") {
                export(&Path::new(&folder).join(format!("seed{seed}_part{part}")), &case, &data);
                continue;
            }
            let pod = ShiftedPod::new(grid, Interpolation::Spectral).noise(Noise::Sparse);
            for (name, ranks) in [("given", Ranks::Given(RANKS.to_vec())), ("found", Ranks::Found)] {
                let start = ProcessTime::now();
                let d = pod
                    .clone()
                    .ranks(ranks)
                    .solve(shifts, data.as_ref(), None, &mut |_| ControlFlow::Continue(()));
                let seconds = start.elapsed().as_secs_f64();
                let d = d.expect("a decomposition");
                let noise = d.noise.as_ref().expect("wrong entries");
                let (mut missed, mut rejected) = (0, 0);
                for (i, j) in (0..CELLS).flat_map(|i| (0..SNAPSHOTS).map(move |j| (i, j))) {
                    match (noise[(i, j)] != 0.0, data[(i, j)] != clean[(i, j)]) {
                        (false, true) => missed += 1,
                        (true, false) => rejected += 1,
                        _ => {}
                    }
                }
                println!(
                    "seed {seed} {part:4} % {name} ranks {:8} error {:.1e} missed {missed:4} \
                     rejected {rejected:4} {:?} {:4} steps {seconds:6.2} s",
                    format!("{:?}", d.ranks()),
                    d.relative_error(&op, clean.as_ref()),
                    d.stopped,
                    d.history.len(),
                );
            }
            let start = ProcessTime::now();
            let proximal = Proximal::augmented_lagrangian().with_noise().tolerance(1e-5);
            let d = proximal.solve(&op, data.as_ref(), None, &mut |_| ControlFlow::Continue(()));
            let d = d.expect("a decomposition");
            println!(
                "seed {seed} {part:4} % convex ranks {:8} error {:.1e} {:4} steps {:6.2} s",
                format!("{:?}", d.ranks()),
                d.relative_error(&op, clean.as_ref()),
                d.history.len(),
                start.elapsed().as_secs_f64()
            );
        }
    }
}
