//! A flat plate at no pressure gradient.
use render::cpu::Stopwatch;
use render::profiles::{Curve, Panel, draw};
use siltflow::flow::{
    Axis, CartesianGrid, Convection, Fluid, Modelled, Patch, Profile, Side, Simple, SimpleParams,
    TransportParams,
};
use siltflow::interfaces::Closure;
use std::path::Path;
use turb::{Inflow, KOmegaSst, Sst};
use validation::Outcome;
use validation::turbulent_flows::{growing, numbers};

/// Cf of CFL3D on 545 × 385 points.
const FINEST: &str = include_str!("../../tests/data/turbulence/flat_plate_sstv.csv");
/// Cf at x = 0.97 of an incompressible and a compressible code on as many points.
const REFERENCES: [[f64; 2]; 3] = [[0.00258, 0.00255], [0.00265, 0.00263], [0.00269, 0.00266]];

/// NASA's Turbulence Modeling Resource, "2D zero pressure gradient flat plate": Re 5·10⁶ per unit length, plate from x = 0 to 2,
/// fluid from x = −0.33 and up to y = 1, where the pressure is given.
pub(crate) fn flat_plate() -> Outcome<()> {
    println!("\nFlat plate, k-omega SST, Re 5e6 per length (NASA TMR): Cf at x = 0.97");
    println!(
        "{:>10} {:>8} {:>22} {:>7} {:>15} {:>6} {:>7} {:>11}",
        "cells", "Cf", "others (Ma 0, Ma 0.2)", "off", "y+", "its", "CPU s", "us/cell/it"
    );
    let mut curves = Vec::new();
    for (refine, others) in [1, 2, 4].into_iter().zip(REFERENCES) {
        let watch = Stopwatch::start();
        let (flow, model) = solve(refine)?;
        let seconds = watch.elapsed().cpu;
        let cf = friction(&flow, &model);
        let at = |x: f64| {
            let i = cf.partition_point(|p| p.0 < x).clamp(1, cf.len() - 1);
            let ((x0, c0), (x1, c1)) = (cf[i - 1], cf[i]);
            c0 + (c1 - c0) * (x - x0) / (x1 - x0)
        };
        let (n, y_plus) = (flow.grid().cells(), model.closure.y_plus());
        println!(
            "{:>10} {:>8.6} {:>11.5} {:>10.5} {:>5.1} % {:>15} {:>6} {:>7.2} {:>11.3}",
            format!("{} x {}", n[0], n[1]),
            at(0.97),
            others[0],
            others[1],
            100.0 * (at(0.97) / others[0] - 1.0),
            format!("{:.2} to {:.2}", y_plus.least, y_plus.most),
            flow.iterations(),
            seconds,
            1e6 * seconds / (flow.iterations() * flow.grid().n_cells()) as f64
        );
        let label = format!("{} × {} cells", n[0], n[1]);
        let points = cf.into_iter().filter(|p| p.0 > 0.01 && p.0 < 1.9).collect();
        curves.push(Curve { label, points, line: true });
    }
    let finest = numbers::<2>(FINEST).into_iter().filter(|p| p[0] > 0.01).step_by(4);
    curves.push(Curve {
        label: "CFL3D, 545 × 385".into(),
        points: finest.map(|p| (p[0], p[1])).collect(),
        line: false,
    });
    let panel = Panel { title: "Flat plate, k-ω SST".into(), x: "x".into(), y: "Cf".into(), curves };
    std::fs::create_dir_all("out/turbulence")?;
    draw(Path::new("out/turbulence/plate.png"), &[panel])?;
    Ok(())
}

type Solved = (Simple<2>, Modelled<2, KOmegaSst>);

fn solve(refine: usize) -> Outcome<Solved> {
    let nu = 1.0 / 5e6;
    let first = 0.008 / refine as f64;
    let mut x: Vec<f64> = growing(6 * refine, 0.0, 0.33, first).iter().rev().map(|x| -x).collect();
    x.extend(&growing(28 * refine, 0.0, 2.0, first)[1..]);
    let y = growing(24 * refine, 0.0, 1.0, 8e-6 / refine as f64);
    let grid = CartesianGrid::from_axes([Axis::from_faces(x)?, Axis::from_faces(y)?])?;
    let far = f64::INFINITY;
    let bottom = Side::Patches(vec![
        Patch { lower: [-far; 3], upper: [0.0, far, far], side: Side::FreeSlip },
        Patch { lower: [0.0, -far, -far], upper: [far; 3], side: Side::WALL },
    ]);
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let sides = [[inlet, Side::PressureOutlet(0.0)], [bottom, Side::PressureOutlet(0.0)]];
    let mut flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity: nu })?
        .with_convection(Convection::LinearUpwind)
        .with_params(SimpleParams::turbulent())?;
    flow.set_velocity(|_| [1.0, 0.0]);
    // k = 9·10⁻⁹ a², ν_t = 0.009 ν at Ma 0.2.
    let k = 9e-9 / 0.04;
    let model = KOmegaSst::new(Sst::default(), grid.n_cells(), Inflow { k, omega: k / (0.009 * nu) })?;
    let mut model = Modelled::new(model, &grid, flow.sides(), TransportParams::steady())?;
    flow.solve_with(&mut model, 3000, 1e-6)?;
    Ok((flow, model))
}

/// x and Cf along the plate.
fn friction(flow: &Simple<2>, model: &Modelled<2, KOmegaSst>) -> Vec<(f64, f64)> {
    let (grid, nu) = (flow.grid(), flow.fluid().viscosity);
    let rows = model.wall_rows().iter().zip(model.closure.wall_viscosity());
    rows.map(|(r, nu_t)| (grid.centre(grid.cell(r.cell))[0], 2.0 * (nu + nu_t) * r.u_t / r.y)).collect()
}
