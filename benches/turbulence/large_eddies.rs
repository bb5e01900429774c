//! Large-eddy simulation.
use render::cpu::Stopwatch;
use siltflow::flow::{CartesianGrid, ClosureSlot, Fluid, Hooks, Modelled, Projection, Side, TransportParams};
use std::f64::consts::TAU;
use turb::{Wale, WaleConstants};
use validation::Outcome;

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
