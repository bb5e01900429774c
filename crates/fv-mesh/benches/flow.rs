//! Cost of a flow step against the machine's memory bandwidth: `cargo bench -p siltflow-fv-mesh --bench flow`.
//!
//! Prints the bandwidth of a STREAM triad, then per grid the CPU time per cell and step on one thread, the bytes that the
//! sweeps of a step move per cell, how many times longer the step takes than moving them, what two threads gain in
//! wall time, and the peak memory in doubles per cell; then the wall time of steps of small grids that a thread outside the pool asks for.
//! `-- small` prints only these; `-- step 128 200` runs only steps (of a 128³ box), for instruction counts.
use cpu_time::ProcessTime;
use fv_mesh::{Axis, CartesianGrid, Cluster, Diffusion, Fluid, Projection, Side};
use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Instant;

/// Bytes per second of a[i] = b[i] + s·c[i] with arrays far beyond the caches, written lines counted once (as STREAM does) …
fn triad(threads: usize) -> f64 {
    const N: usize = 16_000_000;
    let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() else { return f64::NAN };
    let (mut a, b, c) = (vec![0.0; N], vec![1.0; N], vec![2.0; N]);
    let mut best = f64::INFINITY;
    pool.install(|| {
        use rayon::prelude::*;
        for _ in 0..8 {
            let start = Instant::now();
            let parts = a.par_chunks_mut(N / 16).zip(b.par_chunks(N / 16)).zip(c.par_chunks(N / 16));
            parts.for_each(|((a, b), c)| {
                for (a, (b, c)) in a.iter_mut().zip(b.iter().zip(c)) {
                    *a = b + 3.0 * c;
                }
            });
            black_box(&a);
            best = best.min(start.elapsed().as_secs_f64());
        }
    });
    24.0 * N as f64 / best
}

/// Bytes per cell that a step's sweeps read and write if every array of a sweep passes memory once:
/// predictor (per component: D velocities, pressure, tendency in; velocity, tendency out), right-hand side and
/// transforms (velocities in; spectra out, in; solutions out, in; φ out), correction (φ in; velocities in and out), pressure
/// (φ, p in; p out).
fn bytes_per_cell(d: usize) -> f64 {
    let predictor = d * (d + 2 + 2);
    let poisson = d + 6;
    let correction = 3 * d;
    (8 * (predictor + poisson + correction + 3)) as f64
}

fn flow<const D: usize>(n: usize, sides: [[Side; 2]; D], stretched: bool) -> Option<Projection<D>> {
    let uniform = || Axis::uniform(n, 0.0, TAU);
    let tanh = || Axis::tanh(n, 0.0, TAU, 2.0, Cluster::Both);
    let axes: Result<Vec<Axis>, _> = (0..D).map(|_| if stretched { tanh() } else { uniform() }).collect();
    let grid = CartesianGrid::from_axes(axes.ok()?.try_into().ok()?).ok()?;
    let flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 1e-3 }).ok()?;
    let mut flow = flow.with_diffusion(Diffusion::Auto);
    flow.set_velocity(|x| std::array::from_fn(|c| (x[(c + 1) % D]).sin() * (2.0 * x[c]).cos()));
    flow.project(1.0).ok()?;
    Some(flow)
}

/// CPU and wall time of a step, medians.
fn time<const D: usize>(flow: &mut Projection<D>, threads: usize) -> Option<(f64, f64)> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok()?;
    let dt = 0.2 / flow.courant(1.0).max(1e-3);
    let batch = (3_000_000 / flow.grid().n_cells()).clamp(1, 200);
    let mut samples = Vec::new();
    pool.install(|| {
        for _ in 0..9 {
            let (cpu, wall) = (ProcessTime::now(), Instant::now());
            for _ in 0..batch {
                flow.advance(dt, [0.0; D]).ok()?;
            }
            samples.push((cpu.elapsed().as_secs_f64(), wall.elapsed().as_secs_f64()));
        }
        Some(())
    })?;
    let mut median = |f: fn(&(f64, f64)) -> f64| {
        samples.sort_by(|a, b| f(a).total_cmp(&f(b)));
        f(&samples[samples.len() / 2]) / batch as f64
    };
    Some((median(|s| s.0), median(|s| s.1)))
}

fn row<const D: usize>(what: &str, n: usize, sides: [[Side; 2]; D], stretched: bool, bandwidth: f64) {
    let mut made = None;
    let memory = allocation_counter::measure(|| made = flow(n, sides, stretched)).bytes_max as f64;
    let Some(mut flow) = made else { return };
    let cells = flow.grid().n_cells() as f64;
    let Some((cpu, wall)) = time(&mut flow, 1) else { return };
    let two = time(&mut flow, 2).map_or(f64::NAN, |t| t.1);
    let floor = bytes_per_cell(D) / bandwidth;
    println!(
        "{what:<34} {:>8.2} ns {:>7.0} B {:>7.2} x {:>9.2} x {:>8.1}",
        1e9 * cpu / cells,
        bytes_per_cell(D),
        cpu / cells / floor,
        wall / two,
        memory / 8.0 / cells
    );
}

/// Wall time of steps by the thread that asks for them, medians: what threads of the pool have to gain is what it costs to wake them.
fn small() {
    println!("\n{:<34} {:>11}", "asked for from outside the pool", "per step");
    for n in [16, 32, 64, 100, 128, 181, 256] {
        let Some(mut flow) = flow(n, [Side::WALL.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]], false)
        else {
            return;
        };
        let (dt, steps) = (0.2 / flow.courant(1.0).max(1e-3), (3_000_000 / (n * n)).clamp(20, 2000));
        let mut samples: Vec<f64> = Vec::new();
        for _ in 0..9 {
            let start = Instant::now();
            for _ in 0..steps {
                if flow.advance(dt, [0.0; 2]).is_err() {
                    return;
                }
            }
            samples.push(start.elapsed().as_secs_f64() / steps as f64);
        }
        samples.sort_by(f64::total_cmp);
        println!("{:<34} {:>8.1} µs", format!("{n}² cavity"), 1e6 * samples[samples.len() / 2]);
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(at) = arguments.iter().position(|a| a == "step") {
        let number = |i: usize| arguments.get(at + i).and_then(|a| a.parse().ok()).unwrap_or(64);
        let Some(mut flow) = flow::<3>(number(1), Side::Periodic.everywhere(), false) else { return };
        for _ in 0..number(2) {
            let _ = flow.advance(1e-3, [0.0; 3]);
        }
        return;
    }
    if arguments.iter().any(|a| a == "small") {
        return small();
    }
    let bandwidth = triad(1);
    println!(
        "STREAM triad: {:.1} GB/s on one thread, {:.1} GB/s on two\n",
        bandwidth * 1e-9,
        triad(2) * 1e-9
    );
    println!(
        "{:<34} {:>11} {:>9} {:>9} {:>11} {:>8}",
        "grid", "per cell", "moved", "/ floor", "2 threads", "doubles"
    );
    let periodic2 = || Side::Periodic.everywhere::<2>();
    let cavity = || [Side::WALL.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]];
    for n in [256, 512, 1024] {
        row(&format!("{n}² periodic"), n, periodic2(), false, bandwidth);
        row(&format!("{n}² cavity"), n, cavity(), false, bandwidth);
    }
    for n in [256, 512] {
        row(&format!("{n}² cavity, stretched both ways"), n, cavity(), true, bandwidth);
    }
    for n in [64, 128, 256] {
        row(&format!("{n}³ periodic"), n, Side::Periodic.everywhere::<3>(), false, bandwidth);
    }
    row("128³ walls", 128, Side::WALL.everywhere::<3>(), false, bandwidth);
    row("128³ walls, stretched everywhere", 128, Side::WALL.everywhere::<3>(), true, bandwidth);
    small();
}
