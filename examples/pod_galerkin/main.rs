//! Reduced models by projection (Isoz et al. 2023, equation (8)): the wake of a cylinder at Re 100, and diffusion.
//!
//! A cylinder stands in a stream; the box is 20 D × 10 D, the cylinder's walls are cut links, convection is central, so that the rate of change of the velocity is a polynomial
//! of second degree. When its wake swings evenly, snapshots of two periods give POD modes, and projecting the flow solver's own rate on them a model of a few unknowns; it is
//! integrated for ten periods beside the full flow. Then a rod that heats up: the error of its reduced models beside their a-posteriori bound, and a
//! source that depends on the temperature, sampled in a few cells (DEIM).
//!
//! Sample runs:
//! ```text
//! cargo run --release --example pod_galerkin                                  # 15 CPU seconds; out/pod_galerkin
//! cargo run --release --example pod_galerkin -- --cells-per-diameter 16 --modes 8,12,20
//! ```
mod cylinder;
mod diffusion;

use clap::Parser;
use cylinder::{Galerkin, Wake};
use example_support::Outcome;
use example_support::files::make_folder;
use example_support::granular::{Ending, main_of};
use example_support::table::{Table, number, write_json};
use render::Domain;
use render::Scalar;
use render::comparison::{Comparison, Curve, Panel};
use render::gallery::{Gallery, Row, Tile};
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// Reduced models of a cylinder's wake and of diffusion, by projection.
#[derive(Clone, Debug, Parser)]
#[command(version)]
struct Cli {
    /// Cells across the cylinder.
    #[arg(long, default_value_t = 12)]
    cells_per_diameter: usize,
    /// Reynolds number.
    #[arg(long, default_value_t = 100.0)]
    reynolds: f64,
    /// Modes of the models, separated by commas.
    #[arg(long, value_delimiter = ',', default_values_t = [4, 8, 12])]
    modes: Vec<usize>,
    /// Time until the wake swings evenly [D/U].
    #[arg(long, default_value_t = 120.0)]
    settle: f64,
    /// Folder for everything that is written.
    #[arg(long, default_value = "out/pod_galerkin")]
    out: PathBuf,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    main_of(1, |stop| run(&cli, stop))
}

fn run(cli: &Cli, stop: &AtomicBool) -> Outcome<Ending> {
    let most =
        cli.modes.iter().copied().max().filter(|&m| m > 0).ok_or("give at least one number of modes")?;
    if !(4..=100).contains(&cli.cells_per_diameter) {
        return Err(format!("{} cells across the cylinder; give 4 to 100", cli.cells_per_diameter).into());
    }
    make_folder(&cli.out)?;
    let Some(mut wake) = Wake::run(cli.reynolds, cli.cells_per_diameter, cli.settle, stop)? else {
        return Ok(Ending::Stopped);
    };
    let pod = wake.modes(most)?;
    let models: Vec<Galerkin> =
        cli.modes.iter().map(|&r| wake.project(&pod.truncated(r))).collect::<Outcome<_>>()?;
    draw(cli, &wake, &pod, &models)?;
    let rod = diffusion::run()?;
    let mut table = Table::new();
    table.section("the wake of a cylinder").row("Reynolds number", cli.reynolds, "");
    table.row("unknowns of the full model", wake.rows(), "").row("full model", number(wake.cpu), "CPU s");
    table.row("snapshots in two periods", cylinder::SNAPSHOTS, "").row("POD", number(wake.pod_cpu), "CPU s");
    table.row("Strouhal number, full", number(wake.strouhal), "");
    let rows = models.iter().map(|m| {
        let errors = [m.errors[0], m.errors[1], m.errors[2]].map(|e| format!("{:.2e}", e));
        let costs = [number(1e3 * m.project_cpu), number(1e3 * m.solve_cpu)];
        let head = [m.rank.to_string(), format!("{:.2e}", m.projection), number(m.strouhal)];
        head.into_iter().chain(errors).chain(costs).collect()
    });
    let header =
        ["modes", "projection", "Strouhal", "1 period", "5 periods", "10 periods", "set-up ms", "run ms"];
    table.matrix(&header, rows.collect());
    table.note("Errors of the velocity relative to its fluctuation, largest within so many periods; projection: over the snapshots.");
    let best = &models[models.len() - 1];
    let speed_up = wake.predicted_cpu / best.solve_cpu;
    table.row(&format!("speed-up over the full model, {} modes", best.rank), number(speed_up), "");
    table.section("a rod that heats up, 200 cells");
    let rows = rod.iter().map(|r| {
        let numbers = [r.error, r.bound, r.sampled].map(|e| format!("{e:.2e}"));
        [r.rank.to_string()].into_iter().chain(numbers).collect()
    });
    table.matrix(&["modes", "error", "bound", "with a sampled source"], rows.collect());
    table.note(
        "Largest errors in time, relative to the largest norm; bound: a posteriori, from the residual alone.",
    );
    println!("{table}");
    write_json(
        &cli.out.join("result.json"),
        &json!({
            "strouhal": wake.strouhal, "full_cpu": wake.cpu, "predicted_cpu": wake.predicted_cpu,
            "models": models.iter().map(|m| json!({
                "modes": m.rank, "projection": m.projection, "strouhal": m.strouhal, "errors": m.errors,
                "project_cpu": m.project_cpu, "solve_cpu": m.solve_cpu,
            })).collect::<Vec<_>>(),
            "rod": rod.iter().map(|r| json!({
                "modes": r.rank, "error": r.error, "bound": r.bound, "sampled": r.sampled,
            })).collect::<Vec<_>>(),
        }),
    )?;
    println!("pictures in {}", cli.out.display());
    Ok(Ending::Whole)
}

/// The modes, and the coefficients of full and reduced models over time.
fn draw(cli: &Cli, wake: &Wake, pod: &mor::pod::Pod, models: &[Galerkin]) -> Outcome<()> {
    let [nx, ny] = wake.cells();
    let field =
        |column: &[f64], component: usize| column[component * nx * ny..(component + 1) * nx * ny].to_vec();
    let shown = pod.rank().min(4);
    let parts: Vec<Vec<Vec<f64>>> =
        (0..2).map(|c| (0..shown).map(|k| field(pod.modes.col_as_slice(k), c)).collect()).collect();
    let row = |c: usize| {
        let titled = parts[c].iter().enumerate().map(|(k, values)| Tile {
            title: format!("{} of mode {}, σ {:.3}", ["u", "v"][c], k + 1, pod.singular_values[k]),
            field: Scalar { nx, ny, values },
        });
        Row { label: String::new(), range: None, tiles: titled.collect() }
    };
    Gallery { periodic: [false; 2], aspect: cylinder::BOX[1] / cylinder::BOX[0], rows: vec![row(0), row(1)] }
        .draw(&cli.out.join("modes.png"))?;
    let best = &models[models.len() - 1];
    let panel = |k: usize| Panel {
        x: "time in D/U".into(),
        y: format!("coefficient {}", k + 1),
        curves: vec![Curve {
            label: String::new(),
            line: wake.times().iter().enumerate().map(|(j, &t)| (t, best.states[(k, j)])).collect(),
            points: wake
                .times()
                .iter()
                .enumerate()
                .step_by(9)
                .map(|(j, &t)| (t, best.truth[(k, j)]))
                .collect(),
        }],
    };
    let panels: Vec<Panel> = [0, 2].into_iter().filter(|&k| k < best.rank).map(panel).collect();
    let domain = Domain { width: 1.0, height: 1.0, periodic: [false; 2] };
    let names = ["reduced", "full flow"];
    Comparison { domain, fields: &[], panels: &panels, columns: 1, names }
        .draw(&cli.out.join("coefficients.png"))?;
    Ok(())
}
