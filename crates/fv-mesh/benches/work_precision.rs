//! Error against run time on one thread: `cargo bench -p fv-mesh --bench work_precision` (about a minute).
//!
//! 1. Taylor–Green vortices on [0, 2π]², ν 0.01, t 1, beside published points of OpenFOAM's icoFoam (GAMG) and of jax-cfd
//!    (direct solver, double precision) measured on such a machine. Their convection is a gradient, which flatters.
//! 2. A doubly periodic shear layer (Minion & Brown 1997: u = tanh 30(¼ − |y − ½|), v = 0.05 sin 2πx, ν 5e-4) at t 0.8 against the finest grid.
//! 3. The cavity at Re 400, t 4, against the finest grid; with the lid gathering the cells too.
//!
//! Errors are root mean squares of the velocity vector, divided by the largest speed in 2 and 3 (which is 1).
use cpu_time::ProcessTime;
use fv_mesh::{Axis, CartesianGrid, Cluster, FlowError, Fluid, Projection, Sampler, Side};
use interfaces::VelocityField;
use std::f64::consts::TAU;

type Run = Result<(Projection<2>, f64), FlowError>;

/// Root mean square of the velocity's difference to `exact` over the unknowns.
fn error(flow: &Projection<2>, exact: impl Fn([f64; 2]) -> [f64; 2]) -> f64 {
    let (grid, mut sum, mut volume) = (flow.grid(), 0.0, 0.0);
    for c in 0..2 {
        let lattice = flow.velocity().lattice(c);
        let first = usize::from(!flow.sides().periodic(c));
        for cell in (0..grid.n_cells()).map(|i| grid.cell(i)).filter(|cell| cell[c] >= first) {
            let at = [0, 1, 2]
                .map(|a| if a < 2 { cell[a] as isize - isize::from(a == c) * first as isize } else { 0 });
            let Some(index) = lattice.index(at) else { continue };
            let x = [0, 1]
                .map(|a| if a == c { grid.axis(a).faces()[cell[a]] } else { grid.axis(a).centre(cell[a]) });
            let weight = grid.cell_volume(cell);
            sum += weight * (flow.velocity().component(c)[index] - exact(x)[c]).powi(2);
            volume += weight;
        }
    }
    (2.0 * sum / volume).sqrt()
}

/// Runs to `end` at the given Courant number; CPU seconds with set-up.
fn timed(make: impl FnOnce() -> Result<Projection<2>, FlowError>, end: f64, courant: f64) -> Run {
    let start = ProcessTime::now();
    let mut flow = make()?;
    while flow.time() < end - 1e-12 {
        let left = end - flow.time();
        let steps = (left / flow.stable_dt(courant)).ceil();
        flow.advance(left / steps, [0.0; 2])?;
    }
    Ok((flow, start.elapsed().as_secs_f64()))
}

fn taylor_green(n: usize, courant: f64) -> Result<(f64, u64, f64), FlowError> {
    let exact = |x: [f64; 2], t: f64| {
        let decay = (-0.02 * t).exp();
        [-x[0].cos() * x[1].sin() * decay, x[0].sin() * x[1].cos() * decay]
    };
    let make = || {
        let grid = CartesianGrid::new([n, n], [TAU, TAU])?;
        let mut flow =
            Projection::new(grid, Side::Periodic.everywhere(), Fluid { density: 1.0, viscosity: 0.01 })?;
        flow.set_velocity(|x| exact(x, 0.0));
        Ok(flow)
    };
    let (flow, cpu) = timed(make, 1.0, courant)?;
    Ok((error(&flow, |x| exact(x, 1.0)), flow.steps(), cpu))
}

fn shear_layer(n: usize) -> Run {
    let make = || {
        let grid = CartesianGrid::new([n, n], [1.0, 1.0])?;
        let mut flow =
            Projection::new(grid, Side::Periodic.everywhere(), Fluid { density: 1.0, viscosity: 5e-4 })?;
        flow.set_velocity(|x| [(30.0 * (0.25 - (x[1] - 0.5).abs())).tanh(), 0.05 * (TAU * x[0]).sin()]);
        Ok(flow)
    };
    timed(make, 0.8, 0.4)
}

fn cavity(n: usize, stretched: bool) -> Run {
    let make = || {
        let axis = || {
            if stretched { Axis::tanh(n, 0.0, 1.0, 1.2, Cluster::Both) } else { Axis::uniform(n, 0.0, 1.0) }
        };
        let grid = CartesianGrid::from_axes([axis()?, axis()?])?;
        let sides = [Side::WALL.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]];
        Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 1.0 / 400.0 })
    };
    timed(make, 4.0, 0.4)
}

/// Table of errors against the last of `runs`.
fn against_finest(what: &str, finest: &Projection<2>, runs: Vec<(usize, Projection<2>, f64)>) {
    let sampler = Sampler::new(finest.grid(), finest.sides());
    let reference = |x: [f64; 2]| sampler.velocity(finest.velocity(), x).unwrap_or([f64::NAN; 2]);
    let mut last: Option<(usize, f64)> = None;
    println!("\n{what}\n{:>24} {:>7} {:>11} {:>9} {:>7}", "grid", "steps", "error", "CPU s", "order");
    for (n, flow, cpu) in runs {
        let found = error(&flow, reference);
        let order = last
            .map_or(String::new(), |(m, e)| format!("{:.2}", (e / found).ln() / (n as f64 / m as f64).ln()));
        println!("{:>24} {:>7} {found:>11.2e} {cpu:>9.3} {order:>7}", format!("{n}²"), flow.steps());
        last = Some((n, found));
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| {
        println!("Taylor–Green\n{:>24} {:>7} {:>11} {:>9}", "code, grid", "steps", "error", "CPU s");
        for (code, error, cpu) in [
            ("icoFoam 128²", 8.3e-5, 1.0),
            ("icoFoam 256²", 4.8e-6, 12.5),
            ("jax-cfd 128²", 6.0e-7, 0.012),
            ("jax-cfd 256²", 1.0e-6, 0.12),
        ] {
            println!("{code:>24} {:>7} {error:>11.2e} {cpu:>9.3}", "");
        }
        for (n, courant) in [(32, 0.6), (64, 0.6), (96, 0.6), (128, 0.6), (256, 0.6), (288, 0.6), (512, 0.6)]
        {
            // The median of five, as these are short.
            let mut runs = Vec::new();
            for _ in 0..5 {
                runs.push(taylor_green(n, courant)?);
            }
            runs.sort_by(|a, b| a.2.total_cmp(&b.2));
            let (error, steps, cpu) = runs[2];
            println!("{:>24} {steps:>7} {error:>11.2e} {cpu:>9.4}", format!("ours {n}²"));
        }

        let runs = |sizes: &[usize], run: &dyn Fn(usize) -> Run| -> Result<Vec<_>, FlowError> {
            sizes.iter().map(|&n| run(n).map(|(flow, cpu)| (n, flow, cpu))).collect()
        };
        let (finest, _) = shear_layer(768)?;
        against_finest("Shear layer against 768²", &finest, runs(&[64, 96, 128, 192, 256], &shear_layer)?);
        let (finest, _) = cavity(384, true)?;
        let uniform = runs(&[32, 48, 64, 96, 128, 192], &|n| cavity(n, false))?;
        against_finest("Cavity against 384² (stretched), uniform cells", &finest, uniform);
        let stretched = runs(&[32, 48, 64, 96, 128, 192], &|n| cavity(n, true))?;
        against_finest("Cavity against 384² (stretched), stretched cells", &finest, stretched);
        Ok::<(), FlowError>(())
    })?;
    Ok(())
}
