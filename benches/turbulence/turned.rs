//! Developed flow between immersed walls that are turned against the grid.
use render::cpu::Stopwatch;
use turb::{Inflow, Law, Sst, WallFunctions, Wilcox};
use validation::Outcome;
use validation::developed_duct::DevelopedDuct;
use validation::turbulent_flows::{Drive, between_walls, developed_channel, numbers};

const VISCOSITY: f64 = 1e-6;
/// That of the ducts whose first cells are in the buffer layer.
const VISCOUS: f64 = 1e-4;

/// Walls turned by 0 to 45°, driven to the mean velocity of simpleFoam's mesh c, whose profiles they are held against.
pub(crate) fn turned_ducts() -> Outcome<()> {
    println!("\nDeveloped flow in ducts turned against the grid, Re 1e6, against simpleFoam's mesh c");
    println!(
        "{:>8} {:>6} {:>6} {:>9} {:>9} {:>9} {:>7} {:>7} {:>7} {:>13} {:>5} {:>8} {:>6}",
        "model",
        "angle",
        "cells",
        "f off",
        "rising",
        "receding",
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
    println!("\nThe same at Re 1e4: friction against that of cells which resolve the layer");
    println!(
        "{:>8} {:>6} {:>6} {:>9} {:>9} {:>9} {:>7} {:>5} {:>8}",
        "model", "angle", "cells", "f off", "rising", "receding", "mean y+", "its", "residual"
    );
    let fine = developed_channel(
        Sst::default(),
        WallFunctions::default(),
        between_walls(200, 1.0, 3.0 * VISCOUS)?,
        VISCOUS,
        Drive::Bulk(1.0),
        Inflow::from_length(1.0, 0.05, 0.07)?,
    )?;
    let given = 2.0 * fine.u_tau * fine.u_tau;
    for angle in [0.0, 15.0, 45.0] {
        for cells in [10, 20, 40] {
            let DevelopedDuct { flow, model, force, frictions, residual, .. } =
                DevelopedDuct::new(Sst::default(), angle, cells, 0.3, VISCOUS, given)?;
            println!(
                "{:>8} {angle:>6} {cells:>6} {:>7.2} % {:>7.1} % {:>7.1} % {:>7.1} {:>5} {residual:>8.0e}",
                "SST",
                100.0 * (force / given - 1.0),
                100.0 * (2.0 * frictions[0] / given - 1.0),
                100.0 * (2.0 * frictions[1] / given - 1.0),
                model.closure.y_plus().mean,
                flow.iterations()
            );
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
    let u_tau = reference[0][1] * VISCOSITY / reference[0][0];
    let given = 2.0 * u_tau * u_tau;
    let watch = Stopwatch::start();
    let DevelopedDuct { ducts, flow, model, force, frictions, residual } =
        DevelopedDuct::new(law, angle, cells, 0.3, VISCOSITY, given)?;
    let grid = flow.grid();
    let centre = |i: usize| grid.centre(grid.cell(i));
    let at = |y: f64, column: usize| {
        let y = y.min(1.0 - y);
        let k = reference.partition_point(|r| r[0] < y).clamp(1, reference.len() - 1);
        let (below, above) = (&reference[k - 1], &reference[k]);
        let part = ((y - below[0]) / (above[0] - below[0])).clamp(0.0, 1.0);
        below[column] + part * (above[column] - below[column])
    };
    let (mut u, mut k, mut nu_t) = (Norms::default(), Norms::default(), Norms::default());
    for i in (0..grid.n_cells()).filter(|&i| ducts.distance(centre(i)) > 0.0) {
        let y = ducts.height_of(centre(i));
        // The faces of nearer cells are cut.
        if ducts.distance(centre(i)) > 1.5 * h {
            u.add(ducts.speed(&flow, grid.cell(i)), u_tau * at(y, 2));
        }
        k.add(model.closure.k()[i] / u_tau.powi(2), at(y, 3));
        nu_t.add(model.closure.nu_t()[i] / VISCOSITY, at(y, 5));
    }
    println!(
        "{name:>8} {angle:>6} {cells:>6} {:>7.2} % {:>7.1} % {:>7.1} % {:>5.2} % {:>5.1} % {:>5.1} % {:>11.2} % {:>5} {:>8.0e} {:>6.1}",
        100.0 * (force / given - 1.0),
        100.0 * (2.0 * frictions[0] / given - 1.0),
        100.0 * (2.0 * frictions[1] / given - 1.0),
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
