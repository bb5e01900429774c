//! Large-eddy simulation of the channel at Re_τ 178.
use render::cpu::Stopwatch;
use render::profiles::{Curve, Panel, draw};
use siltflow::flow::{
    Axis, CartesianGrid, ClosureSlot, Cluster, Fluid, Hooked, Hooks, Modelled, Projection, Side,
    TransportParams,
};
use std::f64::consts::PI;
use std::path::Path;
use turb::{Smagorinsky, SmagorinskyConstants, Wale, WaleConstants};
use validation::Outcome;
use validation::turbulent_flows::numbers;

const RE: f64 = 178.12;
/// Of the DNS, and its table of y+ and U+.
const BULK: f64 = 15.679;
const DNS: &str = include_str!("../../tests/data/turbulence/dns_180.csv");

/// 4π × 2 × 4π/3 half-heights, driven by the force of the DNS; means over the planes, both halves, and the second part of the time.
/// Cells along x, y and z from the environment variable `LES_CELLS` ("32 48 32"), half-heights per friction velocity of the run and
/// of its first part, which is not looked at, from `LES_TIMES` ("40 15").
pub(crate) fn channel() -> Outcome<()> {
    let read = |name: &str, default: &str| std::env::var(name).unwrap_or_else(|_| default.into());
    let cells: Vec<usize> =
        read("LES_CELLS", "32 48 32").split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
    let times: Vec<f64> =
        read("LES_TIMES", "40 15").split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
    let ([nx, ny, nz], [end, from]) = (cells[..].try_into()?, times[..].try_into()?);
    let grid = CartesianGrid::from_axes([
        Axis::uniform(nx, 0.0, 4.0 * PI)?,
        Axis::tanh(ny, 0.0, 2.0, 1.9, Cluster::Both)?,
        Axis::uniform(nz, 0.0, 4.0 / 3.0 * PI)?,
    ])?;
    let first = grid.centre([0; 3])[1] * RE;
    println!("\nChannel at Re_tau {RE}, {nx} x {ny} x {nz} cells, first centre at y+ {first:.2}");
    println!(
        "{:>12} {:>8} {:>8} {:>11} {:>6} {:>11} {:>7} {:>8}",
        "model", "bulk u+", "off", "largest off", "at y+", "rms y+>10", "steps", "CPU s"
    );
    let dns = numbers::<2>(DNS);
    let n = grid.n_cells();
    let mut curves = Vec::new();
    let run = |name, profile: Vec<[f64; 2]>, curves: &mut Vec<Curve>| {
        let points = profile.iter().map(|[y, u]| (*y, *u)).collect();
        curves.push(Curve { label: String::from(name), points, line: true });
    };
    let params = TransportParams::default;
    run("no model", of_model("none", &grid, [end, from], &dns, |_| Ok(()))?, &mut curves);
    let wale = |flow: &Projection<3>| {
        Ok(Modelled::new(Wale::new(WaleConstants::default(), n)?, flow.grid(), flow.sides(), params())?)
    };
    run("WALE", of_model("WALE", &grid, [end, from], &dns, wale)?, &mut curves);
    let smagorinsky = |c_s: f64| {
        let constants = SmagorinskyConstants { c_s, ..SmagorinskyConstants::default() };
        move |flow: &Projection<3>| {
            let closure = Smagorinsky::new(constants, n)?;
            Ok(Modelled::new(closure, flow.grid(), flow.sides(), params())?)
        }
    };
    for (name, c_s) in [("C_s 0.065", 0.065), ("C_s 0.1", 0.1)] {
        run(name, of_model(name, &grid, [end, from], &dns, smagorinsky(c_s))?, &mut curves);
    }
    let points = dns.iter().step_by(2).map(|p| (p[0], p[1])).filter(|p| p.0 > 0.3).collect();
    curves.push(Curve { label: "DNS".into(), points, line: false });
    let title = format!("large eddies, Re_τ {RE:.0}, {nx} × {ny} × {nz} cells");
    std::fs::create_dir_all("out/turbulence")?;
    draw(Path::new("out/turbulence/les.png"), &[Panel { title, x: "y+".into(), y: "u+".into(), curves }])?;
    Ok(())
}

fn of_model<C: ClosureSlot<3>>(
    name: &str,
    grid: &CartesianGrid<3>,
    [end, from]: [f64; 2],
    dns: &[[f64; 2]],
    closure: impl Fn(&Projection<3>) -> Outcome<C>,
) -> Outcome<Vec<[f64; 2]>> {
    let sides = [Side::Periodic.both(), Side::WALL.both(), Side::Periodic.both()];
    let mut flow = Projection::new(grid.clone(), sides, Fluid { density: 1.0, viscosity: 1.0 / RE })?;
    flow.set_velocity(begin);
    let closure = closure(&flow)?;
    let mut flow = Hooked::new(flow, Hooks::none().with_closure(closure));
    let watch = Stopwatch::start();
    let [nx, ny, nz] = grid.cells();
    let (mut sums, mut time) = (vec![0.0; ny], 0.0);
    let mut steps = 0;
    while flow.flow.time() < end {
        let dt = flow.stable_dt(0.5);
        flow.predict(dt, [1.0, 0.0, 0.0])?;
        flow.project(dt)?;
        flow.finish(dt)?;
        steps += 1;
        if flow.flow.time() > from && steps % 10 == 0 {
            let u = flow.velocity().field(0);
            let means = (0..u.n_rows()).map(|row| u.row(row).iter().sum::<f64>());
            for (row, sum) in means.enumerate() {
                sums[row % ny] += sum / (nx * nz) as f64;
            }
            time += 1.0;
        }
    }
    let profile: Vec<[f64; 2]> = (0..ny / 2)
        .map(|j| [grid.centre([0, j, 0])[1] * RE, 0.5 * (sums[j] + sums[ny - 1 - j]) / time])
        .collect();
    let heights: Vec<f64> = (0..ny).map(|j| grid.cell_volume([0, j, 0])).collect();
    let bulk =
        heights.iter().zip(&sums).map(|(h, s)| h * s).sum::<f64>() / (time * heights.iter().sum::<f64>());
    let of_dns = |y: f64| {
        let k = dns.partition_point(|p| p[0] < y).clamp(1, dns.len() - 1);
        let [a, b] = [dns[k - 1], dns[k]];
        a[1] + (b[1] - a[1]) * (y - a[0]) / (b[0] - a[0])
    };
    let off: Vec<[f64; 2]> = profile.iter().map(|[y, u]| [*y, u / of_dns(*y) - 1.0]).collect();
    let worst = off.iter().max_by(|a, b| a[1].abs().total_cmp(&b[1].abs())).copied().unwrap_or_default();
    let outer: Vec<f64> = off.iter().filter(|p| p[0] > 10.0).map(|p| p[1] * p[1]).collect();
    println!(
        "{name:>12} {bulk:>8.3} {:>6.1} % {:>9.1} % {:>6.1} {:>9.1} % {steps:>7} {:>8.0}",
        100.0 * (bulk / BULK - 1.0),
        100.0 * worst[1],
        worst[0],
        100.0 * (outer.iter().sum::<f64>() / outer.len() as f64).sqrt(),
        watch.elapsed().cpu
    );
    Ok(profile)
}

/// Reichardt's (1951) mean and eddies along and across, strong enough to become turbulence.
fn begin([x, y, z]: [f64; 3]) -> [f64; 3] {
    let wall = y.min(2.0 - y) * RE;
    let mean =
        2.5 * (0.41 * wall).ln_1p() + 7.8 * (1.0 - (-wall / 11.0).exp() - wall / 11.0 * (-wall / 3.0).exp());
    let damp = (y * (2.0 - y)).powi(2);
    let wave = |a: f64, b: f64, phase: f64| (a * 0.5 * x + b * 1.5 * z + phase).sin();
    let some = |shift: f64| {
        wave(1.0, 1.0, shift)
            + wave(2.0, -3.0, 2.0 * shift)
            + wave(3.0, 2.0, 3.7 * shift)
            + wave(5.0, 4.0, 1.3 + shift)
    };
    [mean + 2.0 * damp * some(0.3), 1.5 * damp * some(1.9), 1.5 * damp * some(4.1)]
}
