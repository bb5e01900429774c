//! Table, files and pictures.
use crate::contact::{Contact, DIAMETER, Way};
use example_support::Outcome;
use example_support::table::{Table, number};
use render::plot::{self, Panel, Series};
use render::sketch::{self, Drawing, Paint};
use std::fmt::Write;
use std::path::Path;

pub(crate) fn write(out: &Path, runs: &[Contact]) -> Outcome<()> {
    let formula = runs.iter().find(|r| r.way == Way::Formula).ok_or("no run by the formula")?;
    std::fs::write(out.join("forces.csv"), forces(runs)?)?;
    std::fs::write(out.join("costs.csv"), costs(runs, formula)?)?;
    sketch::draw(&out.join("figure_7a.png"), 2, &figure_7a(runs))?;
    plot::draw(&out.join("figure_7b.png"), &figure_7b(runs, formula))?;
    print(runs, formula);
    println!("forces.csv, costs.csv, figure_7a.png, figure_7b.png: {}", out.display());
    Ok(())
}

fn forces(runs: &[Contact]) -> Result<String, std::fmt::Error> {
    let mut text = String::from("way,overlap_m,force_N,exact_force_N\n");
    for run in runs {
        for [overlap, force, exact] in &run.path {
            writeln!(text, "{},{overlap:e},{force:e},{exact:e}", run.way.name().replace(',', ""))?;
        }
    }
    Ok(text)
}

fn costs(runs: &[Contact], formula: &Contact) -> Result<String, std::fmt::Error> {
    let mut text = String::from("way,error_of_peak,steps,cpu_s,cpu_of_overlaps_s,cost_relative,rebound\n");
    for run in runs {
        let (name, cost) = (run.way.name().replace(',', ""), run.cpu / formula.cpu);
        let (error, steps, cpu) = (run.error(), run.steps, run.cpu);
        writeln!(text, "{name},{error:e},{steps},{cpu:e},{:e},{cost:e},{}", run.overlap_cpu, run.rebound)?;
    }
    Ok(text)
}

fn print(runs: &[Contact], formula: &Contact) {
    let mut table = Table::new();
    table.section("Contact of two spheres");
    let peak = formula.path.iter().map(|p| p[1]).fold(0.0, f64::max);
    let depth = formula.path.iter().map(|p| p[0]).fold(0.0, f64::max);
    table.row("largest force", number(peak), "N");
    table.row("largest overlap over the diameter", number(depth / DIAMETER), "");
    table.row("steps, of which in contact", format!("{}, {}", formula.steps, formula.path.len() - 1), "");
    let row = |run: &Contact| {
        vec![
            run.way.name(),
            format!("{:.4} %", 100.0 * run.error()),
            number(1e6 * run.overlap_cpu / run.path.len() as f64),
            number(1e3 * run.cpu),
            format!("{:.2}", run.cpu / formula.cpu),
            format!("{:.5}", run.rebound),
        ]
    };
    let header = ["way", "error of peak", "µs per overlap", "ms per contact", "cost, formula = 1", "rebound"];
    table.matrix(&header, runs.iter().map(row).collect());
    // As the paper has it: what does not depend on the level counts, too.
    if let Some(power) = exponent(runs, |run| run.cpu) {
        table.row("a whole contact's cost by tree grows like the level to the", number(power), "");
    }
    // Of 4^ℓ, the number of boxes that a surface cuts, the slope is ℓ ln 4.
    if let Some(power) = exponent(runs, |run| run.overlap_cpu) {
        table.row("the overlaps' alone, by tree, like the level to the", number(power), "");
    }
    table.note("cost: all of a contact, with both spheres put into the flow mesh in every step");
    println!("{table}");
}

/// p of a·ℓ^p through a cost by the trees of all levels ℓ, by least squares of logarithms.
fn exponent(runs: &[Contact], cost: impl Fn(&Contact) -> f64) -> Option<f64> {
    let points: Vec<[f64; 2]> = runs
        .iter()
        .filter_map(|run| match run.way {
            Way::Tree(l) => Some([f64::from(l).ln(), cost(run).ln()]),
            _ => None,
        })
        .collect();
    let n = points.len() as f64;
    let mean = |f: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(f).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p[0]), mean(&|p| p[1]));
    let square = mean(&|p| (p[0] - x).powi(2));
    (square > 0.0).then(|| mean(&|p| (p[0] - x) * (p[1] - y)) / square)
}

fn figure_7a(runs: &[Contact]) -> Vec<Drawing> {
    let percent = |x: f64| 100.0 * x / DIAMETER;
    let exact: Vec<[f64; 2]> = runs[0].path.iter().map(|p| [percent(p[0]), p[2]]).collect();
    let (most, peak) = exact.iter().fold((0.0_f64, 0.0_f64), |(x, y), p| (x.max(p[0]), y.max(p[1])));
    let trees = || runs.iter().filter(|r| matches!(r.way, Way::Tree(_)));
    // On the way in.
    let half = |run: &Contact| run.path.len() / 2;
    let mut forces = Drawing {
        title: "|f_c| against overlap: formula, and trees of several levels".into(),
        range: [(0.0, 1.05 * most), (0.0, 1.1 * peak)],
        labels: Some(["overlap over diameter, %".into(), "|f_c|, N".into()]),
        ..Drawing::default()
    };
    let mut errors = Drawing {
        title: "Error of |f_c| over the largest force".into(),
        labels: Some(["overlap over diameter, %".into(), "error, %".into()]),
        ..Drawing::default()
    };
    forces.lines.push((exact, 6.0, Paint::Share(0.35)));
    forces.legend.push((Paint::Share(0.35), "formula".into()));
    let mut worst: f64 = 0.0;
    for (i, run) in trees().enumerate() {
        let paint = Paint::Kind(i, 0.0);
        let way_in = &run.path[..half(run)];
        forces.lines.push((way_in.iter().map(|p| [percent(p[0]), p[1]]).collect(), 2.0, paint));
        let off: Vec<[f64; 2]> =
            way_in.iter().map(|p| [percent(p[0]), 100.0 * (p[1] - p[2]) / peak]).collect();
        worst = off.iter().map(|p| p[1].abs()).fold(worst, f64::max);
        errors.lines.push((off, 2.0, paint));
        errors.legend.push((paint, run.way.name()));
        forces.legend.push((paint, run.way.name()));
    }
    errors.range = [(0.0, 1.05 * most), (-1.1 * worst, 1.1 * worst)];
    vec![forces, errors]
}

fn figure_7b(runs: &[Contact], formula: &Contact) -> Vec<Panel> {
    let series = |label: &str, value: &dyn Fn(&Contact) -> f64, mesh: bool| Series {
        label: label.into(),
        points: runs
            .iter()
            .filter_map(|run| match run.way {
                Way::Tree(l) if !mesh => Some((f64::from(l), value(run), l.to_string())),
                Way::Mesh(l @ 1..) if mesh => Some((f64::from(l), value(run), l.to_string())),
                _ => None,
            })
            .collect(),
        ours: true,
    };
    let whole = |run: &Contact| run.cpu / formula.cpu;
    let overlap = |run: &Contact| 1e6 * run.overlap_cpu / run.path.len() as f64;
    vec![
        Panel {
            title: "Cost of a whole contact, formula = 1".into(),
            x: "levels".into(),
            y: "relative CPU time".into(),
            series: vec![
                series("virtual mesh (tree)", &whole, false),
                series("flow mesh, refined", &whole, true),
            ],
        },
        Panel {
            title: "Cost of one overlap".into(),
            x: "levels".into(),
            y: "µs of CPU time".into(),
            series: vec![
                series("virtual mesh (tree)", &overlap, false),
                series("flow mesh, refined", &overlap, true),
            ],
        },
    ]
}
