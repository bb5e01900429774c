//! `Simple` and `Piso` beside `Projection`, on one thread, in CPU time: `cargo bench -p siltflow-fv-mesh --bench segregated` (about four
//! CPU minutes; `-- simple` or `-- piso` runs one part).
//!
//! 1. `Simple`: the lid-driven cavity from rest to residuals of 10⁻⁶: iterations, cost, largest deviations from Ghia, Ghia & Shin
//!    (1982) in lid speeds, and from the steady flow of `Projection` on the same grid, marched until its kinetic energy
//!    changes by less than 10⁻⁸ in one unit of time.
//! 2. `Piso`: the order in time (vortices carried along, differences on one grid), the cost of a step beside `Projection`'s,
//!    medians of alternating runs, and the cavity at Re 400, t 4 at growing Courant numbers.
#[path = "support/centrelines.rs"]
mod centrelines;

use centrelines::{centreline, deviation};
use cpu_time::ProcessTime;
use fv_mesh::{
    CartesianGrid, FlowError, Fluid, Integrals, Piso, PisoParams, Projection, Side, Simple, SimpleParams,
    TimeScheme, Velocity,
};
use std::f64::consts::TAU;

/// Iterations after which the steady algorithm gives up.
const MOST: usize = 3000;

fn cavity(n: usize, re: f64) -> Result<(CartesianGrid<2>, [[Side; 2]; 2], Fluid), FlowError> {
    let sides = [Side::WALL.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]];
    Ok((CartesianGrid::new([n, n], [1.0, 1.0])?, sides, Fluid { density: 1.0, viscosity: 1.0 / re }))
}

/// Largest difference of a component.
fn largest(a: &Velocity<2>, b: &Velocity<2>) -> Result<f64, Box<dyn std::error::Error>> {
    let over = Integrals::new(a.field(0).grid());
    let [u, v] = [0, 1].map(|c| over.largest(a.field(c) - b.field(c)));
    Ok(u?.max(v?))
}

/// Root mean square of the difference vector.
fn difference(a: &Velocity<2>, b: &Velocity<2>) -> Result<f64, Box<dyn std::error::Error>> {
    let over = Integrals::new(a.field(0).grid());
    let [u, v] = [0, 1].map(|c| over.norms(a.field(c) - b.field(c)));
    Ok(u?.l2.hypot(v?.l2))
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The steady cavity by marching in time, and its CPU seconds.
fn marched(n: usize, re: f64) -> Result<(Projection<2>, f64), FlowError> {
    let start = ProcessTime::now();
    let (grid, sides, fluid) = cavity(n, re)?;
    let mut flow = Projection::new(grid, sides, fluid)?;
    let mut last = f64::INFINITY;
    loop {
        let until = flow.time() + 1.0;
        while flow.time() < until {
            flow.advance(flow.stable_dt(0.6), [0.0; 2])?;
        }
        let energy = flow.statistics().kinetic_energy;
        if (energy / last - 1.0).abs() < 1e-8 {
            return Ok((flow, start.elapsed().as_secs_f64()));
        }
        last = energy;
    }
}

fn steady() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "Simple, cavity from rest to 1e-6\n{:>20} {:>6} {:>11} {:>8} {:>14} {:>9} {:>9} {:>13} {:>12}",
        "", "Re", "iterations", "CPU s", "µs/cell/iter.", "Ghia u", "Ghia v", "from marched", "CPU, marched"
    );
    let proper = SimpleParams::simple();
    for (n, re, name, params) in [
        (32, 100.0, "SIMPLEC", SimpleParams::default()),
        (64, 100.0, "SIMPLEC", SimpleParams::default()),
        (64, 100.0, "SIMPLE", proper),
        (128, 100.0, "SIMPLEC", SimpleParams::default()),
        (192, 100.0, "SIMPLEC", SimpleParams::default()),
        (64, 400.0, "SIMPLEC", SimpleParams::default()),
        (64, 400.0, "SIMPLE", proper),
        (128, 400.0, "SIMPLEC", SimpleParams::default()),
    ] {
        let start = ProcessTime::now();
        let (grid, sides, fluid) = cavity(n, re)?;
        let mut flow = Simple::new(grid, sides, fluid)?.with_params(params)?;
        let info = flow.solve(MOST, 1e-6)?;
        let cpu = start.elapsed().as_secs_f64();
        let (reference, cpu_marched) = marched(n, re)?;
        let [u, v] = [0, 1].map(|c| {
            let line = centreline(flow.grid(), flow.sides(), flow.velocity(), c);
            deviation(&line, c, re)
        });
        println!(
            "{:>20} {re:>6} {:>11} {cpu:>8.3} {:>14.3} {:>8.2}% {:>8.2}% {:>13.1e} {:>11.1}×",
            format!("{name} {n}²"),
            info.iterations,
            1e6 * cpu / (n * n * info.iterations) as f64,
            100.0 * u,
            100.0 * v,
            largest(flow.velocity(), reference.velocity())?,
            cpu_marched / cpu
        );
    }
    Ok(())
}

/// Taylor–Green vortices carried along by a uniform flow, ν 0.05.
fn vortices(x: [f64; 2]) -> [f64; 2] {
    [0.7 - x[0].cos() * x[1].sin(), 0.4 + x[0].sin() * x[1].cos()]
}

const SLOW: Fluid = Fluid { density: 1.0, viscosity: 0.05 };

fn order_in_time() -> Result<(), Box<dyn std::error::Error>> {
    let run = |time_scheme, correctors, steps: usize| -> Result<Piso<2>, FlowError> {
        let grid = CartesianGrid::new([32, 32], [TAU, TAU])?;
        let params =
            PisoParams { time_scheme, correctors, pressure_tolerance: 1e-10, momentum_tolerance: 1e-10 };
        let mut flow = Piso::new(grid, Side::Periodic.everywhere(), SLOW)?.with_params(params)?;
        flow.set_velocity(vortices);
        for _ in 0..steps {
            flow.advance(1.0 / steps as f64, [0.0; 2], &mut ())?;
        }
        Ok(flow)
    };
    println!("\nPiso, carried vortices on 32², t 1: difference to 1280 steps of BDF2 (rms), order");
    println!("{:>24} {:>10} {:>10} {:>10} {:>7} {:>7}", "steps", 20, 40, 80, "order", "order");
    let finest = run(TimeScheme::Bdf2, 3, 1280)?;
    for (scheme, correctors) in
        [(TimeScheme::Euler, 2), (TimeScheme::Bdf2, 1), (TimeScheme::Bdf2, 2), (TimeScheme::Bdf2, 3)]
    {
        let mut errors = [0.0; 3];
        for (error, steps) in errors.iter_mut().zip([20, 40, 80]) {
            *error = difference(run(scheme, correctors, steps)?.velocity(), finest.velocity())?;
        }
        let [a, b, c] = errors;
        println!(
            "{:>24} {a:>10.2e} {b:>10.2e} {c:>10.2e} {:>7.2} {:>7.2}",
            format!("{scheme:?}, {correctors} corrections"),
            (a / b).log2(),
            (b / c).log2()
        );
    }
    Ok(())
}

/// CPU microseconds per cell and step of `Piso` and `Projection`, and the median of their ratio.
fn cost(what: &str, n: usize, courant: f64, periodic: bool) -> Result<(), FlowError> {
    let (grid, sides, fluid) = if periodic {
        (CartesianGrid::new([n, n], [TAU, TAU])?, Side::Periodic.everywhere(), SLOW)
    } else {
        cavity(n, 400.0)?
    };
    let start = |x: [f64; 2]| if periodic { vortices(x) } else { [0.0; 2] };
    let mut piso = Piso::new(grid.clone(), sides.clone(), fluid)?;
    let mut other = Projection::new(grid, sides, fluid)?;
    piso.set_velocity(start);
    other.set_velocity(start);
    // The lid is no velocity of a cell: the Courant number is by speed 1.
    let dt = courant * if periodic { TAU / (2.6 * n as f64) } else { 1.0 / n as f64 };
    // The projection stays within its own limit.
    let short = dt.min(other.stable_dt(0.4));
    let steps = (400_000 / (n * n)).clamp(4, 100);
    let (mut a, mut b, mut ratio) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..7 {
        let clock = ProcessTime::now();
        (0..steps).try_for_each(|_| piso.advance(dt, [0.0; 2], &mut ()))?;
        let first = clock.elapsed().as_secs_f64();
        let clock = ProcessTime::now();
        (0..10 * steps).try_for_each(|_| other.advance(short, [0.0; 2]))?;
        let second = 0.1 * clock.elapsed().as_secs_f64();
        let per_cell = 1e6 / (steps * n * n) as f64;
        a.push(per_cell * first);
        b.push(per_cell * second);
        ratio.push(first / second);
    }
    let row = format!("{what} {n}², Courant {courant}");
    println!("{row:>34} {:>9.3} {:>11.4} {:>8.1}", median(a), median(b), median(ratio));
    Ok(())
}

/// The cavity at t 4: error against the projection on the same grid, and CPU time over that of the projection.
fn large_steps() -> Result<(), Box<dyn std::error::Error>> {
    const N: usize = 128;
    let projection = |courant: f64| -> Result<(Projection<2>, f64), FlowError> {
        let clock = ProcessTime::now();
        let (grid, sides, fluid) = cavity(N, 400.0)?;
        let mut flow = Projection::new(grid, sides, fluid)?;
        while flow.time() < 4.0 - 1e-12 {
            let left = 4.0 - flow.time();
            flow.advance(left / (left / flow.stable_dt(courant)).ceil(), [0.0; 2])?;
        }
        Ok((flow, clock.elapsed().as_secs_f64()))
    };
    let (reference, _) = projection(0.1)?;
    let (usual, cpu_usual) = projection(0.4)?;
    println!(
        "\nCavity Re 400 on {N}² at t 4: rms difference to Projection at Courant 0.1\n{:>24} {:>7} {:>11} {:>8} {:>8}",
        "", "steps", "difference", "CPU s", "/ usual"
    );
    let tell = |name: String, steps: u64, error: f64, cpu: f64| {
        println!("{name:>24} {steps:>7} {error:>11.2e} {cpu:>8.2} {:>8.2}", cpu / cpu_usual);
    };
    let error = difference(usual.velocity(), reference.velocity())?;
    tell("Projection, Courant 0.4".into(), usual.steps(), error, cpu_usual);
    for courant in [0.4, 1.0, 2.0, 4.0, 8.0] {
        let clock = ProcessTime::now();
        let (grid, sides, fluid) = cavity(N, 400.0)?;
        let mut flow = Piso::new(grid, sides, fluid)?;
        let steps = (4.0 * N as f64 / courant).round() as usize;
        for _ in 0..steps {
            flow.advance(4.0 / steps as f64, [0.0; 2], &mut ())?;
        }
        let error = difference(flow.velocity(), reference.velocity())?;
        tell(format!("Piso, Courant {courant}"), flow.steps(), error, clock.elapsed().as_secs_f64());
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let runs = |part: &str| wanted.is_empty() || wanted.iter().any(|w| w == part);
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    if runs("simple") {
        steady()?;
    }
    if runs("piso") {
        order_in_time()?;
        println!("\nCPU µs per cell and step\n{:>34} {:>9} {:>11} {:>8}", "", "Piso", "Projection", "ratio");
        for n in [64, 128, 256] {
            cost("vortices", n, 0.4, true)?;
            cost("vortices", n, 2.0, true)?;
            cost("cavity", n, 0.4, false)?;
            cost("cavity", n, 2.0, false)?;
        }
        large_steps()?;
    }
    Ok(())
}
