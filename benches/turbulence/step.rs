//! A backward-facing step.
use render::cpu::Stopwatch;
use siltflow::flow::{
    Axis, CartesianGrid, Convection, Fluid, Modelled, Patch, Profile, Side, Simple, SimpleParams,
    TransportParams,
};
use turb::{Inflow, Law, Realizable, Scale, Sst, StandardKEpsilon, TwoEquation, Wilcox};
use validation::Outcome;
use validation::turbulent_flows::growing;

/// ν of Re_H 36 000 with the step's height and the speed of the stream as units.
const NU: f64 = 1.0 / 36_000.0;

/// Driver & Seegmiller (1985): a channel of 8 step heights that opens to 9; reattachment was measured at 6.26 ± 0.10 heights.
///
/// The box begins at the step's edge. What enters there is the profile of a channel of the same height where its boundary layer has
/// Re_θ = 5000, 4 heights further on: the walls before the step are not in the box.
pub(crate) fn backward_facing_step() -> Outcome<()> {
    println!("\nBackward-facing step, Re_H 36 000: reattachment (measured: 6.26 +- 0.10)");
    println!("{:>16} {:>11} {:>15} {:>6} {:>6} {:>7}", "model", "cells", "y+", "x_r/H", "its", "CPU s");
    run("k-omega SST", Sst::default())?;
    run("k-epsilon", StandardKEpsilon::default())?;
    run("k-omega", Wilcox::default())?;
    run("realizable k-eps", Realizable::default())
}

/// Faces from 0 to 9, closer at the walls and on both sides of the edge.
fn across() -> Vec<f64> {
    let first = 0.04;
    let mut y = growing(10, 0.0, 0.5, first);
    y.extend(growing(10, 0.0, 0.5, first).iter().rev().skip(1).map(|y| 1.0 - y));
    y.extend(&growing(24, 1.0, 6.0, first)[1..]);
    y.extend(growing(12, 0.0, 3.0, first).iter().rev().skip(1).map(|y| 9.0 - y));
    y
}

/// Velocity, k and ω over the height.
struct Layer {
    y: Vec<f64>,
    u: Vec<f64>,
    turbulence: Vec<Inflow>,
}

fn flow(grid: &CartesianGrid<2>, sides: [[Side; 2]; 2]) -> Outcome<Simple<2>> {
    Ok(Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity: NU })?
        .with_convection(Convection::LinearUpwind)
        .with_params(SimpleParams::turbulent())?)
}

/// The channel before the step.
fn before<L: Law>(law: L, y: &[f64]) -> Outcome<Layer> {
    let y: Vec<f64> = y.iter().copied().filter(|y| *y > 1.0 - 1e-9).collect();
    let grid = CartesianGrid::from_axes([Axis::uniform(100, 0.0, 100.0)?, Axis::from_faces(y)?])?;
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let mut flow = flow(&grid, [[inlet, Side::PressureOutlet(0.0)], Side::WALL.both()])?;
    flow.set_velocity(|_| [1.0, 0.0]);
    let inflow = Inflow::from_viscosity_ratio(1.0, 0.003, 1.0, NU)?;
    let model = TwoEquation::new(law, grid.n_cells(), inflow)?;
    let mut model = Modelled::new(model, &grid, flow.sides(), TransportParams::steady())?;
    flow.solve_with(&mut model, 5000, 1e-5)?;
    let (axis, u) = (grid.axis(1), flow.velocity().field(0));
    let n = axis.cells();
    let middle = axis.locate(5.0).unwrap_or(n / 2);
    let momentum_thickness = |i: usize| -> f64 {
        let part = |j: usize| u.row(j)[i] / u.row(middle)[i];
        (0..middle).map(|j| part(j) * (1.0 - part(j)).max(0.0) * axis.width(j)).sum()
    };
    let reached = |i: &usize| momentum_thickness(*i) * u.row(middle)[*i] / NU > 5000.0;
    let at = (1..96).find(reached).ok_or("the boundary layer does not reach Re_θ = 5000")?;
    // In units of the stream there.
    let stream = u.row(middle)[at];
    let edge = at + 4;
    let turbulence = |j: usize| {
        let cell = grid.index([edge, j]);
        let (k, scale) = (model.closure.k()[cell], model.closure.scale()[cell]);
        let omega = match L::SCALE {
            Scale::Omega => scale,
            Scale::Epsilon => scale / (0.09 * k),
        };
        Inflow { k: k / (stream * stream), omega: omega / stream }
    };
    Ok(Layer {
        y: (0..n).map(|j| axis.centre(j)).collect(),
        u: (0..n).map(|j| u.row(j)[edge] / stream).collect(),
        turbulence: (0..n).map(turbulence).collect(),
    })
}

fn run<L: Law>(name: &str, law: L) -> Outcome<()> {
    let watch = Stopwatch::start();
    let faces = across();
    let Layer { y, u, turbulence } = before(law.clone(), &faces)?;
    let n = y.len();
    let profile = move |x: [f64; 3], _: f64| {
        let k = y.partition_point(|y| *y < x[1]).clamp(1, n - 1);
        let s = ((x[1] - y[k - 1]) / (y[k] - y[k - 1])).clamp(0.0, 1.0);
        [u[k - 1] + s * (u[k] - u[k - 1]), 0.0, 0.0]
    };
    let x = Axis::from_faces(growing(200, 0.0, 25.0, 0.04))?;
    let grid = CartesianGrid::from_axes([x, Axis::from_faces(faces)?])?;
    let far = f64::INFINITY;
    let left = Side::Patches(vec![
        Patch { lower: [-far; 3], upper: [far, 1.0, far], side: Side::WALL },
        Patch { lower: [-far; 3], upper: [far; 3], side: Side::Inlet(Profile::function(profile)) },
    ]);
    let mut flow = flow(&grid, [[left, Side::PressureOutlet(0.0)], Side::WALL.both()])?;
    flow.set_velocity(|x| [if x[1] > 1.0 { 0.9 } else { 0.0 }, 0.0]);
    let mut model = TwoEquation::new(law, grid.n_cells(), Inflow { k: 1e-3, omega: 1.0 })?;
    let first = grid.cells()[1] - n;
    model.give(turbulence.iter().enumerate().map(|(j, t)| (grid.index([0, first + j]), *t)))?;
    let mut model = Modelled::new(model, &grid, flow.sides(), TransportParams::steady())?;
    let info = flow.solve_with(&mut model, 5000, 1e-5)?;
    let (u, faces) = (flow.velocity().field(0).row(0), grid.axis(0).faces());
    let mut turns = (1..u.len()).filter(|&i| (u[i] > 0.0) && (u[i - 1] <= 0.0));
    let last = turns.next_back().ok_or("the flow does not reattach")?;
    let x_r = faces[last - 1] + (faces[last] - faces[last - 1]) * u[last - 1] / (u[last - 1] - u[last]);
    let (cells, y_plus) = (grid.cells(), model.closure.y_plus());
    println!(
        "{name:>16} {:>11} {:>15} {x_r:>6.2} {:>6} {:>7.2}",
        format!("{} x {}", cells[0], cells[1]),
        format!("{:.1} to {:.1}", y_plus.least, y_plus.most),
        info.iterations,
        watch.elapsed().cpu
    );
    Ok(())
}
