//! A parametric study: two falling discs, 5 densities of the upper one × 5 places where the lower one starts, and reduced models of all runs.
//!
//! λ is shown by modes that move along with the discs (sPODIANN; the paths are functions of time and parameters, too), the velocity by those of a proper orthogonal
//! decomposition (PODIANN). Each run in turn is left out whole, modes and all, and predicted from the other 24.
//!
//! ```text
//! cargo run --release --example parameter_study        # some two CPU minutes; out/parameter_study
//! ```
#[path = "../reduced_discs/fall.rs"]
mod fall;
mod study;

use clap::Parser;
use example_support::Outcome;
use example_support::granular::{Ending, main_of};
use example_support::scene::Scene;
use example_support::table::{Table, number, write_json};
use render::Scalar;
use render::cpu::Stopwatch;
use render::gallery::{Gallery, Row, Tile};
use serde_json::json;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use study::{Errors, Models, Run, Sizes};

/// Reduced models of falling discs with two parameters.
#[derive(Clone, Debug, Parser)]
#[command(version)]
struct Cli {
    /// Cells across a disc.
    #[arg(long, default_value_t = 15)]
    cells_per_diameter: usize,
    /// End time [s].
    #[arg(long, default_value_t = 0.2)]
    end: f64,
    /// Intervals between snapshots of a run.
    #[arg(long, default_value_t = 8)]
    intervals: usize,
    /// Densities of the upper disc [kg/m³]: the lowest and the highest of five.
    #[arg(long, value_delimiter = ',', num_args = 2, default_values_t = [1040.0, 1060.0])]
    densities: Vec<f64>,
    /// Where the lower disc starts, aside of the upper one [m]: the least and the most of five.
    #[arg(long, value_delimiter = ',', num_args = 2, default_values_t = [0.2e-3, 1.0e-3])]
    aside: Vec<f64>,
    /// Modes of each disc for λ.
    #[arg(long, default_value_t = 1)]
    shifted_modes: usize,
    /// Modes for the velocity.
    #[arg(long, default_value_t = 20)]
    modes: usize,
    /// Folder for everything that is written.
    #[arg(long, default_value = "out/parameter_study")]
    out: PathBuf,
}

/// Values of each parameter.
const VALUES: usize = 5;

fn main() -> ExitCode {
    let cli = Cli::parse();
    main_of(1, |stop| run(&cli, stop))
}

fn run(cli: &Cli, stop: &AtomicBool) -> Outcome<Ending> {
    if cli.intervals < 8 {
        return Err(format!("{} intervals; give at least 8", cli.intervals).into());
    }
    std::fs::create_dir_all(&cli.out)?;
    let value = |ends: &[f64], i: usize| ends[0] + (ends[1] - ends[0]) * i as f64 / (VALUES - 1) as f64;
    let mut runs = Vec::new();
    for number in 0..VALUES * VALUES {
        let (density, aside) = (value(&cli.densities, number % VALUES), value(&cli.aside, number / VALUES));
        let scene = Scene {
            cells_per_diameter: cli.cells_per_diameter,
            densities: vec![density, 1030.0],
            aside,
            ..Scene::default()
        };
        let Some(fallen) = fall::run(&scene, cli.end, cli.intervals, stop)? else {
            return Ok(Ending::Stopped);
        };
        runs.push(Run { density, aside, fallen });
    }
    let sizes = Sizes { shifted: cli.shifted_modes, plain: cli.modes };
    let watch = Stopwatch::start();
    let mut errors: Vec<Errors> = Vec::new();
    let mut shown = None;
    let middle = runs.len() / 2;
    for out in 0..runs.len() {
        if stop.load(Ordering::Relaxed) {
            return Ok(Ending::Stopped);
        }
        eprintln!("run {} of {} left out", out + 1, runs.len());
        let models = Models::without(&runs, Some(out), sizes)?;
        errors.push(models.errors(&runs[out])?);
        if out == middle {
            shown = Some(models.last_fields(&runs[out])?);
        }
    }
    let left_out_cpu = watch.elapsed().cpu;
    let watch = Stopwatch::start();
    let models = Models::without(&runs, None, sizes)?;
    let fit_cpu = watch.elapsed().cpu;
    let costs = models.costs(&runs[middle])?;
    if let Some([lambda, velocity]) = shown {
        draw(&runs[middle], [&lambda, &velocity], &cli.out)?;
    }
    models.save(&cli.out)?;

    let full = runs.iter().map(|r| r.fallen.elapsed.cpu).sum::<f64>() / runs.len() as f64;
    let inside = |i: &usize| [i % VALUES, i / VALUES].iter().all(|&p| p > 0 && p < VALUES - 1);
    let mean = |of: &dyn Fn(&Errors) -> f64, which: &[usize]| {
        (which.iter().map(|&i| of(&errors[i]).powi(2)).sum::<f64>() / which.len() as f64).sqrt()
    };
    let (all, within): (Vec<usize>, Vec<usize>) =
        ((0..runs.len()).collect(), (0..runs.len()).filter(inside).collect());
    let mut table = Table::new();
    let cells = runs[0].fallen.cells;
    table.section("25 runs").row("cells", format!("{} × {}", cells[0], cells[1]), "");
    table.row("snapshots of a run", cli.intervals + 1, "").row("one run", number(full), "CPU s");
    table.row("steps of the last one", runs[runs.len() - 1].fallen.steps, "");
    table.section("each run left out whole");
    type Of<'a> = &'a dyn Fn(&Errors) -> f64;
    let quantities: [(&str, Of<'_>); 5] = [
        ("λ, sPODIANN", &|e| e.lambda.total),
        ("λ, its modes alone", &|e| e.lambda.projection),
        ("velocity, PODIANN", &|e| e.velocity.total),
        ("velocity, its modes alone", &|e| e.velocity.projection),
        ("places of the discs, in diameters", &|e| e.place),
    ];
    let rows = quantities.iter().map(|(name, of)| {
        let worst = errors.iter().map(of).fold(0.0, f64::max);
        let numbers = [mean(of, &within), mean(of, &all), worst];
        [(*name).to_owned()].into_iter().chain(numbers.map(|e| format!("{e:.2e}"))).collect()
    });
    table.matrix(&["relative error", "9 inner runs", "all 25", "worst"], rows.collect());
    let by_run = |i: usize| {
        let row = (0..VALUES).map(|j| format!("{:.2e}", errors[i * VALUES + j].lambda.total));
        [format!("{:.2} mm", 1e3 * runs[i * VALUES].aside)].into_iter().chain(row).collect()
    };
    let header: Vec<String> = (0..VALUES).map(|j| format!("{:.0}", runs[j].density)).collect();
    let header: Vec<&str> =
        ["λ: aside \\ kg/m³"].into_iter().chain(header.iter().map(String::as_str)).collect();
    table.matrix(&header, (0..VALUES).map(by_run).collect());
    table.section("costs").row("modes and functions of all runs", number(fit_cpu), "CPU s");
    table.row("all 25 left out", number(left_out_cpu), "CPU s");
    let steps = runs[0].fallen.times.len() as f64;
    let names = [
        "places of both discs at a time",
        "λ at a time",
        "velocity at a time",
        "λ, each of all times together",
        "velocity, each of all times together",
    ];
    for (name, cost) in names.iter().zip([costs[0], costs[1], costs[2], costs[3] / steps, costs[4] / steps]) {
        table.row(name, format!("{} ({:.0} times as quick as a run)", number(1e6 * cost), full / cost), "µs");
    }
    let whole = costs[3] + costs[4];
    table.row(
        "λ and velocity at all times of a run",
        format!("{} ({:.0} times as quick as a run)", number(1e3 * whole), full / whole),
        "ms",
    );
    println!("{table}");
    let result = json!({
        "cells": cells, "full_cpu": full, "fit_cpu": fit_cpu, "left_out_cpu": left_out_cpu, "costs": costs,
        "runs": runs.iter().zip(&errors).map(|(r, e)| json!({
            "density": r.density, "aside": r.aside, "lambda": e.lambda.total, "velocity": e.velocity.total, "place": e.place,
        })).collect::<Vec<_>>(),
    });
    write_json(&cli.out.join("result.json"), &result)?;
    Ok(Ending::Whole)
}

/// The end of a run and what models say that have not seen it.
fn draw(run: &Run, [lambda, velocity]: [&[f64]; 2], out: &std::path::Path) -> Outcome<()> {
    let [nx, ny] = run.fallen.cells;
    let n = nx * ny;
    let last = run.fallen.times.len() - 1;
    let truth = run.fallen.lambda[last * n..][..n].to_vec();
    let falling = |v: &[f64]| v[n..].iter().map(|v| 1e3 * v).collect::<Vec<_>>();
    let speed = falling(&run.fallen.velocity[last * 2 * n..][..2 * n]);
    let most = speed.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let off = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>();
    let predicted = falling(velocity);
    let fields = [
        [truth.clone(), lambda.to_vec(), off(lambda, &truth)],
        [speed.clone(), predicted.clone(), off(&predicted, &speed)],
    ];
    let named = [
        ("solid fraction λ", (0.0, 1.0), "sPODIANN"),
        ("vertical velocity in mm/s", (-most, most), "PODIANN"),
    ];
    let rows = fields.iter().zip(named).map(|(fields, (label, range, model))| {
        let titles = ["simulation, left out".to_owned(), model.to_owned(), "difference".to_owned()];
        let tiles = titles.into_iter().zip(fields);
        let tiles = tiles.map(|(title, values)| Tile { title, field: Scalar { nx, ny, values } }).collect();
        Row { label: label.into(), range: Some(range), tiles }
    });
    Gallery { periodic: [true; 2], aspect: ny as f64 / nx as f64, rows: rows.collect() }
        .draw(&out.join("left_out.png"))?;
    Ok(())
}
