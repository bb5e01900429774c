//! Fluid alone. Errors are root mean squares of the velocity vector; the largest speeds are 1.
//!
//! 1. Taylor–Green vortices on [0, 2π]², ν 0.01, t 1, beside OpenFOAM's icoFoam (GAMG) and jax-cfd (direct solver, double
//!    precision, explicit Euler) as measured on a machine like this one. Their convection is a gradient, which flatters.
//! 2. A doubly periodic shear layer (Minion & Brown 1997: u = tanh 30(¼ − |y − ½|), v = 0.05 sin 2πx, ν 5e-4) at t 0.8 against
//!    the finest grid.
//! 3. The cavity at Re 400, t 4, against the finest grid; with the lid gathering the cells too.
use crate::{Point, Runs, Table};
use render::cpu::Stopwatch;
use siltflow::flow::{
    Axis, CartesianGrid, Cluster, FlowError, Fluid, GridMismatch, Integrals, Projection, Sampler, Side,
};
use std::f64::consts::TAU;
use validation::Outcome;

/// A flow and the CPU seconds it took.
type Run = Result<(Projection<2>, f64), FlowError>;

/// Root mean square of the velocity's difference to `exact`.
fn error(flow: &Projection<2>, exact: impl Fn([f64; 2]) -> [f64; 2]) -> Result<f64, GridMismatch> {
    Ok(Integrals::new(flow.grid()).velocity_norms(flow.velocity(), exact)?.l2)
}

/// Runs to `end` at the given Courant number; CPU seconds with set-up.
fn timed(make: impl FnOnce() -> Result<Projection<2>, FlowError>, end: f64, courant: f64) -> Run {
    let watch = Stopwatch::start();
    let mut flow = make()?;
    while flow.time() < end - 1e-12 {
        let left = end - flow.time();
        let steps = (left / flow.stable_dt(courant)).ceil();
        flow.advance(left / steps, [0.0; 2])?;
    }
    Ok((flow, watch.elapsed().cpu))
}

fn taylor_green(n: usize) -> Outcome<Point> {
    let exact = |x: [f64; 2], t: f64| {
        let decay = (-0.02 * t).exp();
        [-x[0].cos() * x[1].sin() * decay, x[0].sin() * x[1].cos() * decay]
    };
    let make = || {
        let grid = CartesianGrid::new([n, n], [TAU, TAU])?;
        let fluid = Fluid { density: 1.0, viscosity: 0.01 };
        let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid)?;
        flow.set_velocity(|x| exact(x, 0.0));
        Ok(flow)
    };
    // The median of five, as these are short.
    let mut points = Vec::new();
    for _ in 0..5 {
        let (flow, cpu) = timed(make, 1.0, 0.6)?;
        points.push(Point::new(format!("{n}²"), error(&flow, |x| exact(x, 1.0))?, cpu));
    }
    points.sort_by(|a, b| a.cpu.total_cmp(&b.cpu));
    Ok(points.swap_remove(2))
}

fn shear_layer(n: usize) -> Run {
    let make = || {
        let grid = CartesianGrid::new([n, n], [1.0, 1.0])?;
        let fluid = Fluid { density: 1.0, viscosity: 5e-4 };
        let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid)?;
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

/// Errors of `run` on grids of these sizes against a finer one.
fn against(finest: &Projection<2>, sizes: &[usize], run: impl Fn(usize) -> Run) -> Outcome<Vec<Point>> {
    let sampler = Sampler::new(finest.grid(), finest.sides());
    let reference = |x: [f64; 2]| sampler.velocity(finest.velocity(), x).unwrap_or([f64::NAN; 2]);
    let mut points = Vec::new();
    for &n in sizes {
        let (flow, cpu) = run(n)?;
        points.push(Point::new(format!("{n}²"), error(&flow, reference)?, cpu));
    }
    Ok(points)
}

/// The tables of all cases.
pub(crate) fn tables() -> Outcome<Vec<Table>> {
    let ours = [32, 64, 96, 128, 216, 256, 288, 512].map(taylor_green).into_iter().collect::<Outcome<_>>()?;
    let vortices = vec![
        Runs { label: "ours, second order", ours: true, points: ours },
        Runs {
            label: "icoFoam",
            ours: false,
            points: vec![Point::new("128²", 8.3e-5, 1.0), Point::new("256²", 4.8e-6, 12.5)],
        },
        Runs {
            label: "jax-cfd",
            ours: false,
            points: vec![Point::new("128²", 6.0e-7, 0.012), Point::new("256²", 1.0e-6, 0.12)],
        },
    ];
    let (finest, _) = shear_layer(768)?;
    let layer = against(&finest, &[64, 96, 128, 192, 256], shear_layer)?;
    let (finest, _) = cavity(384, true)?;
    let sizes = [32, 48, 64, 96, 128, 192];
    let uniform = against(&finest, &sizes, |n| cavity(n, false))?;
    let stretched = against(&finest, &sizes, |n| cavity(n, true))?;
    let error = "rms velocity error";
    Ok(vec![
        Table { title: "Taylor–Green vortices, t 1", error, runs: vortices },
        Table {
            title: "Shear layer, t 0.8, against 768²",
            error,
            runs: vec![Runs { label: "ours", ours: true, points: layer }],
        },
        Table {
            title: "Cavity Re 400, t 4, against 384² (stretched)",
            error,
            runs: vec![
                Runs { label: "ours, uniform cells", ours: true, points: uniform },
                Runs { label: "ours, cells gathered at the walls (tanh 1.2)", ours: true, points: stretched },
            ],
        },
    ])
}
