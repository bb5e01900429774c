//! Large-eddy simulation.
use example_support::Outcome;
use example_support::cpu::Stopwatch;
use siltflow::flow::{
    Axis, CartesianGrid, ClosureSlot, Cluster, Fluid, Hooks, Modelled, Projection, Side, TransportParams,
};
use std::f64::consts::TAU;
use turb::{Wale, WaleConstants};

/// Peak of −dE/dt at Re 1600, 512³ spectral, and when.
const PEAK: [f64; 2] = [1.28575e-2, 8.97];

/// The vortices of Taylor & Green (1937) in three dimensions at Re 1600: the peak of −dE/dt, E the mean of ½u². Cells along an axis
/// from the environment variable `TGV_CELLS` (64).
pub(crate) fn taylor_green() -> Outcome<()> {
    let n = std::env::var("TGV_CELLS").map_or(Ok(64), |n| n.parse())?;
    println!(
        "\nTaylor-Green vortices, Re 1600, {n}^3 cells: peak of -dE/dt (reference {:.5e} at {})",
        PEAK[0], PEAK[1]
    );
    println!("{:>8} {:>12} {:>8} {:>8} {:>7} {:>8}", "model", "peak", "off", "at", "steps", "CPU s");
    of_vortices("none", n, |_| Ok(()))?;
    of_vortices("WALE", n, |flow| {
        let closure = Wale::new(WaleConstants::default(), flow.grid().n_cells())?;
        Ok(Modelled::new(closure, flow.grid(), flow.sides(), TransportParams::default())?)
    })
}

fn of_vortices<C: ClosureSlot<3>>(
    name: &str,
    n: usize,
    closure: impl Fn(&Projection<3>) -> Outcome<C>,
) -> Outcome<()> {
    let grid = CartesianGrid::new([n; 3], [TAU; 3])?;
    let fluid = Fluid { density: 1.0, viscosity: 1.0 / 1600.0 };
    let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid)?;
    flow.set_velocity(|[x, y, z]| [x.sin() * y.cos() * z.cos(), -x.cos() * y.sin() * z.cos(), 0.0]);
    let mut hooks = Hooks::none().with_closure(closure(&flow)?);
    let watch = Stopwatch::start();
    let volume = TAU.powi(3);
    let energy = |flow: &mut Projection<3>| flow.statistics().kinetic_energy / volume;
    let (mut before, mut last, mut peak, mut at, mut steps) = (energy(&mut flow), 0.0, 0.0, 0.0, 0);
    while flow.time() < 11.0 {
        flow.advance_with(flow.stable_dt(0.5), &mut hooks)?;
        steps += 1;
        let (now, t) = (energy(&mut flow), flow.time());
        let rate = (before - now) / (t - last);
        if rate > peak {
            (peak, at) = (rate, 0.5 * (t + last));
        }
        (before, last) = (now, t);
    }
    println!(
        "{name:>8} {peak:>12.5e} {:>6.1} % {at:>8.2} {steps:>7} {:>8.0}",
        100.0 * (peak / PEAK[0] - 1.0),
        watch.elapsed().cpu
    );
    Ok(())
}

/// Channel at Re_τ 180 on few cells, driven by the force of the direct numerical simulation (Moser, Kim & Mansour 1999): the mean
/// profile. Cells from the environment variable `LES_CELLS` (32 along, 48 across, 32 in span).
pub(crate) fn channel() -> Outcome<()> {
    println!("\nChannel, Re_tau 180, WALE against direct numerical simulation");
    let re = 178.12;
    let (lengths, cells) = ([6.0, 2.0, 3.0], [32, 48, 32]);
    let axes = [
        Axis::uniform(cells[0], 0.0, lengths[0])?,
        Axis::tanh(cells[1], 0.0, lengths[1], 2.0, Cluster::Both)?,
        Axis::uniform(cells[2], 0.0, lengths[2])?,
    ];
    let grid = CartesianGrid::from_axes(axes)?;
    let sides = [Side::Periodic.both(), Side::WALL.both(), Side::Periodic.both()];
    let mut flow = Projection::new(grid, sides, Fluid { density: 1.0, viscosity: 1.0 / re })?;
    flow.set_velocity(|[x, y, z]| {
        let (ax, az) = (TAU * x / lengths[0], TAU * z / lengths[2]);
        let envelope = y * (2.0 - y);
        [
            18.0 * envelope + 2.0 * envelope * ((2.0 * az).cos() + (3.0 * az + ax).sin()),
            1.5 * envelope * ((2.0 * az).sin() + (2.0 * ax + az).cos()),
            2.0 * envelope * ((2.0 * ax + 1.0).sin() + (3.0 * ax - az).cos()),
        ]
    });
    let closure = Wale::new(WaleConstants::default(), flow.grid().n_cells())?;
    let modelled = Modelled::new(closure, flow.grid(), flow.sides(), TransportParams::default())?;
    let mut hooks = Hooks::none().with_body_force([1.0, 0.0, 0.0]).with_closure(modelled);
    let watch = Stopwatch::start();
    let mut mean = vec![0.0; cells[1]];
    let (mut weight, mut steps) = (0.0, 0);
    while flow.time() < 30.0 {
        let dt = flow.stable_dt(0.5);
        flow.advance_with(dt, &mut hooks)?;
        steps += 1;
        if flow.time() < 12.0 {
            continue;
        }
        weight += dt;
        let u = flow.velocity().field(0);
        for (j, mean) in mean.iter_mut().enumerate() {
            let rows = (0..cells[2]).map(|k| u.row(j + cells[1] * k).iter().sum::<f64>());
            *mean += dt * rows.sum::<f64>() / (cells[0] * cells[2]) as f64;
        }
    }
    let reference: Vec<[f64; 2]> = include_str!("../../tests/data/turbulence/mkm_180_means.dat")
        .lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| {
            let mut numbers = line.split_whitespace().map(str::parse::<f64>);
            let (y, _, u) = (numbers.next()?.ok()?, numbers.next()?, numbers.next()?.ok()?);
            Some([y, u])
        })
        .collect();
    let mut worst = 0.0_f64;
    println!("{:>8} {:>8} {:>8} {:>8}", "y+", "U+", "DNS", "off");
    for j in 0..cells[1] / 2 {
        let y = flow.grid().axis(1).centre(j);
        let u = 0.5 * (mean[j] + mean[cells[1] - 1 - j]) / weight;
        let Some(pair) = reference.windows(2).find(|pair| pair[1][0] >= y) else { continue };
        let part = (y - pair[0][0]) / (pair[1][0] - pair[0][0]);
        let dns = pair[0][1] + part * (pair[1][1] - pair[0][1]);
        let off = u / dns - 1.0;
        worst = if off.abs() > worst.abs() { off } else { worst };
        if j % 3 == 0 {
            println!("{:>8.1} {u:>8.3} {dns:>8.3} {:>6.1} %", y * re, 100.0 * off);
        }
    }
    println!("largest {:.1} %; {steps} steps, {:.0} CPU s", 100.0 * worst, watch.elapsed().cpu);
    Ok(())
}
