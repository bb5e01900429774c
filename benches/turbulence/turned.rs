//! Developed flow between immersed walls that are turned against the grid.
use example_support::Outcome;
use example_support::cpu::Stopwatch;
use example_support::turbulent_flows::numbers;
use example_support::turned_ducts::TurnedDucts;
use siltflow::flow::{Convection, Fluid, Modelled, Side, Simple, SimpleParams, TransportParams, WallStress};
use siltflow::ibm::{StaticBodies, cut_cells};
use turb::{Inflow, Law, Sst, TwoEquation, Wilcox};

const VISCOSITY: f64 = 1e-6;
/// How fast the force brings the mean velocity to 1 m/s \[1/s\].
const GAIN: f64 = 0.02;

/// Walls turned by 0 to 45°, driven to the mean velocity of simpleFoam's mesh c, whose profiles they are held against.
pub(crate) fn turned_ducts() -> Outcome<()> {
    println!("\nDeveloped flow in ducts turned against the grid, Re 1e6, against simpleFoam's mesh c");
    println!(
        "{:>8} {:>6} {:>6} {:>9} {:>7} {:>7} {:>7} {:>13} {:>5} {:>8} {:>6}",
        "model",
        "angle",
        "cells",
        "f off",
        "u off",
        "k off",
        "nu_t",
        "force missed",
        "its",
        "residual",
        "CPU s"
    );
    for angle in [0.0, 15.0, 30.0, 45.0] {
        for cells in [20, 40] {
            let sst = include_str!("../../tests/data/turbulence/channel_kOmegaSST_c.csv");
            of_model("SST", Sst::default(), sst, angle, cells)?;
            let wilcox = include_str!("../../tests/data/turbulence/channel_kOmega_c.csv");
            of_model("k-omega", Wilcox::openfoam(), wilcox, angle, cells)?;
        }
    }
    Ok(())
}

/// 2-norm of differences, and of what they are differences from.
#[derive(Default)]
struct Norms([f64; 2]);

impl Norms {
    fn add(&mut self, ours: f64, given: f64) {
        self.0[0] += (ours - given).powi(2);
        self.0[1] += given * given;
    }

    fn relative(&self) -> f64 {
        (self.0[0] / self.0[1]).sqrt()
    }
}

fn of_model<L: Law>(name: &str, law: L, text: &str, angle: f64, cells: usize) -> Outcome<()> {
    let reference = numbers::<6>(text);
    let h = 1.0 / cells as f64;
    let (ducts, grid) = TurnedDucts::new(1.0, angle.to_radians(), h, 0.3)?;
    let [along, up] = ducts.along();
    let fluid = Fluid { density: 1.0, viscosity: VISCOSITY };
    let mut flow = Simple::new(grid.clone(), [Side::Periodic.both(), Side::Periodic.both()], fluid)?
        .with_convection(Convection::Quick)
        .with_params(SimpleParams { velocity_relaxation: 0.97, ..SimpleParams::turbulent() })?;
    let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(ducts, ducts.pose()))?;
    flow.set_walls(Some((&cuts, WallStress::LAW_OF_THE_WALL)))?;
    flow.set_velocity(|_| [along, up]);
    let closure = TwoEquation::new(law, grid.n_cells(), Inflow::from_length(1.0, 0.05, 0.07)?)?;
    let mut model = Modelled::new(closure, flow.grid(), flow.sides(), TransportParams::steady())?;
    let centre = |i: usize| grid.centre(grid.cell(i));
    for (i, distance) in model.transport_mut().wall_distance_mut().iter_mut().enumerate() {
        *distance = ducts.distance(centre(i)).max(0.0);
    }
    let u_tau = reference[0][1] * VISCOSITY / reference[0][0];
    let given = 2.0 * u_tau * u_tau;
    let (mut force, mut residual, mut settled) = (given, f64::INFINITY, 0);
    let watch = Stopwatch::start();
    while settled < 20 && flow.iterations() < 4000 {
        flow.set_force([along, up].map(|x| x * force));
        residual = flow.iterate_with(&mut model)?.largest();
        let bulk = ducts.mean_velocity(&flow, &cuts);
        settled = if residual < 1e-5 && (bulk - 1.0).abs() < 1e-4 { settled + 1 } else { 0 };
        force = ducts.drag(&flow) / ducts.area() + GAIN * (1.0 - bulk);
    }
    let at = |y: f64, column: usize| {
        let y = y.min(1.0 - y);
        let k = reference.partition_point(|r| r[0] < y).clamp(1, reference.len() - 1);
        let (below, above) = (&reference[k - 1], &reference[k]);
        let part = ((y - below[0]) / (above[0] - below[0])).clamp(0.0, 1.0);
        below[column] + part * (above[column] - below[column])
    };
    let (mut u, mut k, mut nu_t) = (Norms::default(), Norms::default(), Norms::default());
    let [columns, rows] = grid.cells();
    for i in (0..grid.n_cells()).filter(|&i| ducts.distance(centre(i)) > 0.0) {
        let (y, [a, b]) = (ducts.height_of(centre(i)), grid.cell(i));
        let ends = [[(a, b), ((a + 1) % columns, b)], [(a, b), (a, (b + 1) % rows)]];
        let mean =
            |c: usize| ends[c].iter().map(|&(i, j)| 0.5 * flow.velocity().field(c).row(j)[i]).sum::<f64>();
        // The faces of nearer cells are cut.
        if ducts.distance(centre(i)) > 1.5 * h {
            u.add(along * mean(0) + up * mean(1), u_tau * at(y, 2));
        }
        k.add(model.closure.k()[i] / u_tau.powi(2), at(y, 3));
        nu_t.add(model.closure.nu_t()[i] / VISCOSITY, at(y, 5));
    }
    println!(
        "{name:>8} {angle:>6} {cells:>6} {:>7.2} % {:>5.2} % {:>5.1} % {:>5.1} % {:>11.2} % {:>5} {:>8.0e} {:>6.1}",
        100.0 * (force / given - 1.0),
        100.0 * u.relative(),
        100.0 * k.relative(),
        100.0 * nu_t.relative(),
        100.0 * (ducts.drag(&flow) / (force * ducts.area()) - 1.0),
        flow.iterations(),
        residual,
        watch.elapsed().cpu
    );
    Ok(())
}
