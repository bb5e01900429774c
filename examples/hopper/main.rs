//! A hopper is filled, opened, and runs out.
//!
//! Grains fall into a silo of square section over a funnel of 24 fixed pieces (or a flat bottom, `--slope 0`) that is shut by a gate. The gate
//! is drawn away, the grains run out into the bin below. Measured: mass that has come out, mass flow, and what the law of Beverloo et al. (1961,
//! Chem. Eng. Sci. 15, 260) says of it,
//!
//! ```text
//! W = C ρ_b √g (D − k d)^{5/2},   C = 0.58, k = 1.4 for a round hole in a flat bottom,
//! ```
//!
//! ρ_b being the bulk density above the opening. Colours are those of the layers in which the grains started; the front half is cut away.
//!
//! Sample runs:
//! ```text
//! cargo run --release --example hopper                                     # 1500 spheres, about two minutes
//! cargo run --release --example hopper -- --slope 0 --orifice 0.042        # against Beverloo's law
//! cargo run --release --example hopper -- --shape polyhedron --number 500  # slower: 26 vertices each
//! cargo run --release --example hopper -- --help
//! ```
mod silo;

use clap::Parser;
use example_support::Outcome;
use example_support::granular::{
    Ending, GRAVITY, GrainOptions, History, RunOptions, Start, line, main_of, run,
};
use example_support::table::{Table, number, write_json};
use render::sketch::{Drawing, Paint, draw};
use silo::Silo;
use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

/// A hopper is filled, opened, and runs out.
#[derive(Clone, Debug, Parser)]
#[command(version)]
pub(crate) struct Cli {
    /// How many grains.
    #[arg(long, default_value_t = 1500)]
    pub(crate) number: usize,
    /// Width of the silo [m].
    #[arg(long, default_value_t = 0.07, allow_negative_numbers = true)]
    pub(crate) width: f64,
    /// Diameter of the opening [m].
    #[arg(long, default_value_t = 0.036, allow_negative_numbers = true)]
    pub(crate) orifice: f64,
    /// Slope of the funnel [degrees], 0 to 75; 0 is a flat bottom.
    #[arg(long, default_value_t = 45.0, allow_negative_numbers = true)]
    pub(crate) slope: f64,
    /// When the gate opens [s].
    #[arg(long, default_value_t = 0.3, allow_negative_numbers = true)]
    pub(crate) open: f64,
    /// How grains are arranged at first.
    #[arg(long, value_enum, default_value_t = Start::Lattice)]
    pub(crate) start: Start,
    #[command(flatten)]
    pub(crate) grains: GrainOptions,
    #[command(flatten)]
    pub(crate) run: RunOptions,
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    main_of(cli.run.threads, |stop| fill_and_empty(&cli, stop))
}

fn fill_and_empty(cli: &Cli, stop: &AtomicBool) -> Outcome<Ending> {
    let (mut silo, mut bodies) = Silo::build(cli)?;
    let end = cli.run.end.unwrap_or(cli.open + 1.25 * silo.foreseen());
    let out = cli.run.out.clone().unwrap_or_else(|| "out/hopper".into());
    let setup =
        format!("{:?}", (cli.number, cli.width, cli.orifice, cli.slope, cli.open, cli.start, &cli.grains));
    let (ending, history) = run(&mut silo, &mut bodies, &cli.run, (end, &out, &setup), stop)?;
    tell(cli, &silo, &history, &out)?;
    Ok(ending)
}

/// Mass flow \[kg/s\] by the line through what has come out, from the first fifth to the last but one fifth of all.
fn steady_flow(history: &History, all: f64) -> Option<(f64, f64)> {
    let points: Vec<(f64, f64)> = history
        .over_time("discharged")
        .into_iter()
        .filter(|(_, mass)| (0.15 * all..0.6 * all).contains(mass))
        .collect();
    (points.len() >= 3).then(|| line(&points))
}

fn tell(cli: &Cli, silo: &Silo, history: &History, out: &Path) -> Outcome<()> {
    let last = |name: &str| history.column(name).last().copied().unwrap_or(0.0);
    let most = |name: &str| history.column(name).into_iter().fold(0.0, f64::max);
    let mut table = Table::new();
    table.section("Hopper");
    table.row("discharged", number(last("discharged")), "kg");
    table.row("of", number(silo.mass), "kg");
    table.row("fastest grain of all", number(most("fastest")), "m/s");
    table.row("largest overlap by radius", number(most("largest_overlap")), "");
    table.row("grains beyond the walls", most("outside"), "");
    let mut result = serde_json::json!({
        "grains": cli.number, "orifice": cli.orifice, "mass": silo.mass, "discharged": last("discharged"),
        "fastest": most("fastest"), "outside": most("outside"), "largest_overlap": most("largest_overlap"),
    });
    let flow = steady_flow(history, silo.mass);
    let density = silo.bulk_density();
    if let (Some((_, flow)), Some(density)) = (flow, density) {
        let reach = cli.orifice - 1.4 * cli.grains.diameter;
        let unit = density * GRAVITY.sqrt() * reach.max(0.0).powf(2.5);
        table.section("Mass flow and Beverloo's law");
        table.row("bulk density above the opening", number(density), "kg/m³");
        table.row("mass flow W", number(flow), "kg/s");
        table.row("0.58 ρ_b √g (D − 1.4 d)^5/2", number(0.58 * unit), "kg/s");
        table.row("C = W/(ρ_b √g (D − 1.4 d)^5/2)", number(flow / unit), "");
        result["flow"] = flow.into();
        result["bulk_density"] = density.into();
        result["beverloo_c"] = (flow / unit).into();
    }
    if flow.is_none() || density.is_none() {
        table.note(
            "no mass flow against Beverloo's law: too few grains above the opening, or too few have come out",
        );
    }
    println!("{table}\n  pictures and files: {}", out.display());
    write_json(&out.join("result.json"), &result)?;
    if !cli.run.no_images {
        draw(&out.join("summary.png"), 2, &figure(cli, silo, history, flow, density))?;
    }
    Ok(())
}

fn figure(
    cli: &Cli,
    silo: &Silo,
    history: &History,
    flow: Option<(f64, f64)>,
    density: Option<f64>,
) -> Vec<Drawing> {
    let points =
        |name: &str, by: f64| history.over_time(name).iter().map(|(t, v)| [*t, by * v]).collect::<Vec<_>>();
    let end = history.column("time").last().copied().unwrap_or(1.0);
    let over_time = |title: &str, label: &str, line: Vec<[f64; 2]>| {
        let top = line.iter().map(|p| p[1]).fold(0.0, f64::max);
        Drawing {
            title: title.into(),
            range: [(0.0, end), (0.0, if top > 0.0 { 1.08 * top } else { 1.0 })],
            labels: Some(["time, s".into(), label.into()]),
            lines: vec![(line, 3.0, Paint::Kind(0, 0.0))],
            ..Drawing::default()
        }
    };
    let mut mass = over_time("Mass that has come out", "kg", points("discharged", 1.0));
    mass.range[1].1 = 1.08 * silo.mass;
    if let (Some((start, flow)), Some(density)) = (flow, density) {
        let law =
            0.58 * density * GRAVITY.sqrt() * (cli.orifice - 1.4 * cli.grains.diameter).max(0.0).powf(2.5);
        // Through the same first point.
        let from = (0.15 * silo.mass - start) / flow;
        let to = from + 0.6 * silo.mass / law;
        let at = |t: f64| [t, 0.15 * silo.mass + law * (t - from)];
        mass.lines.push((vec![at(from), at(to)], 2.0, Paint::Kind(1, 0.0)));
        mass.legend = vec![
            (Paint::Kind(0, 0.0), format!("measured: {} kg/s", number(flow))),
            (Paint::Kind(1, 0.0), format!("Beverloo, C = 0.58, k = 1.4: {} kg/s", number(law))),
        ];
    }
    vec![
        mass,
        over_time("Kinetic energy of all grains", "mJ", points("kinetic_energy", 1e3)),
        over_time("Contacts per grain", "", points("coordination", 1.0)),
        over_time("Depth of overlaps by radius, mean", "%", points("overlap", 100.0)),
    ]
}
