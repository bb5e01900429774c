//! Figure 9 of Isoz et al. (2023): reduced models of two falling discs, from the full simulation to the picture.
//!
//! The discs of the example `falling_discs` fall; λ and velocity are handed on as they are computed, with the paths of the discs. Every second snapshot makes the models
//! (601 of them), the others are between. PODIANN interpolates the coefficients of the modes of a proper orthogonal decomposition (equation (7)); sPODIANN those
//! of modes that move along with the discs (equation (9)), the shifts straight from their paths. Both take a neural network, as the paper does, splines, radial functions, and the
//! method with the least error of samples left out.
//!
//! Sample runs:
//! ```text
//! cargo run --release --example reduced_discs                                   # two minutes; out/reduced_discs
//! cargo run --release --example reduced_discs -- --cells-per-diameter 8 --snapshots 201 --modes 4,10
//! ```
mod fall;
mod pictures;
mod study;

use clap::Parser;
use example_support::Outcome;
use example_support::files::make_folder;
use example_support::granular::{Ending, main_of};
use example_support::scene::Scene;
use example_support::table::{Table, number, write_json};
use fall::Fallen;
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use study::{Kind, Quantity, Study};

/// Reduced models of two falling discs, from the full simulation to the picture.
#[derive(Clone, Debug, Parser)]
#[command(version)]
struct Cli {
    /// Cells across a disc.
    #[arg(long, default_value_t = 15)]
    cells_per_diameter: usize,
    /// End time [s].
    #[arg(long, default_value_t = 0.6)]
    end: f64,
    /// Snapshots that make the models, evenly spaced; as many less one are between.
    #[arg(long, default_value_t = 601)]
    snapshots: usize,
    /// Modes of each model in all, separated by commas.
    #[arg(long, value_delimiter = ',', default_values_t = [5, 10, 20, 40])]
    modes: Vec<usize>,
    /// Shifted models with more modes than this are left out.
    #[arg(long, default_value_t = 10)]
    most_shifted: usize,
    /// Folder for everything that is written.
    #[arg(long, default_value = "out/reduced_discs")]
    out: PathBuf,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    main_of(1, |stop| run(&cli, stop))
}

fn run(cli: &Cli, stop: &AtomicBool) -> Outcome<Ending> {
    if cli.snapshots < 20 {
        return Err(format!("{} snapshots; give at least 20", cli.snapshots).into());
    }
    if cli.modes.iter().any(|&n| n < 2 || n >= cli.snapshots) {
        return Err(
            format!("{:?} modes; give numbers from 2 to below that of the snapshots", cli.modes).into()
        );
    }
    make_folder(&cli.out)?;
    let scene = Scene { cells_per_diameter: cli.cells_per_diameter, ..Scene::default() };
    let Some(fallen) = fall::run(&scene, cli.end, 2 * (cli.snapshots - 1), stop)? else {
        return Ok(Ending::Stopped);
    };
    let mut studies = Vec::new();
    for quantity in [Quantity::Lambda, Quantity::Velocity] {
        let study = Study::new(&fallen, quantity, &cli.modes, cli.most_shifted, stop)?;
        let Some(study) = study else { return Ok(Ending::Stopped) };
        studies.push(study);
    }
    pictures::decay(&studies, &cli.out.join("singular_values.png"))?;
    for study in &studies {
        pictures::fields(study, &fallen, &cli.out)?;
    }
    tell(cli, &fallen, &studies)?;
    println!("pictures, modes (.vti) and models in {}", cli.out.display());
    Ok(Ending::Whole)
}

/// The table of errors and times, and `result.json`.
fn tell(cli: &Cli, fallen: &Fallen, studies: &[Study]) -> Outcome<()> {
    let mut table = Table::new();
    table.section("the full simulation").row(
        "cells",
        format!("{} × {}", fallen.cells[0], fallen.cells[1]),
        "",
    );
    table.row("steps", fallen.steps, "").row("cost", number(fallen.elapsed.cpu), "CPU s");
    for study in studies {
        table.section(study.quantity.name());
        let rows = study.models.iter().map(|m| {
            let kind = match m.kind {
                Kind::Pod => "POD".to_owned(),
                Kind::Shifted(ranks) => format!("sPOD {}+{}", ranks[0], ranks[1]),
            };
            let errors = [m.within.projection, m.within.total, m.between.projection, m.between.total];
            let costs = [m.modes_cpu, m.training_cpu, 1e3 * m.evaluation];
            let mut fitted = m.fitted.clone();
            fitted.dedup();
            [kind, m.modes.to_string(), m.method.into(), fitted.join("; ")]
                .into_iter()
                .chain(errors.map(|e| format!("{e:.2e}")))
                .chain(costs.map(number))
                .collect()
        });
        let header = [
            "model",
            "modes",
            "given",
            "coefficients",
            "projection",
            "total",
            "between: proj.",
            "total",
            "modes CPU s",
            "fit CPU s",
            "one field ms",
        ];
        table.matrix(&header, rows.collect());
    }
    table.note(
        "Errors relative to the fields' norm, over 25 snapshots that made the models and 25 between them;",
    );
    table.note("projection: the nearest field that the modes can show; total: what the model predicts from the time alone.");
    println!("{table}");
    let assessed = |m: &study::Fitted| {
        json!({
            "shifted": matches!(m.kind, Kind::Shifted(_)), "modes": m.modes, "given": m.method, "coefficients": m.fitted,
            "projection": m.within.projection, "total": m.within.total,
            "between_projection": m.between.projection, "between_total": m.between.total,
            "modes_cpu": m.modes_cpu, "training_cpu": m.training_cpu, "evaluation": m.evaluation,
        })
    };
    let all = studies.iter().map(|s| (s.quantity.name().to_owned(), s.models.iter().map(assessed).collect()));
    let result = json!({
        "cells": fallen.cells, "snapshots": cli.snapshots, "full_cpu": fallen.elapsed.cpu,
        "models": all.collect::<serde_json::Map<String, serde_json::Value>>(),
    });
    Ok(write_json(&cli.out.join("result.json"), &result)?)
}
