//! Table and picture.
use crate::Options;
use crate::map::{Case, FINEST, Kind, Map, Run};
use example_support::Outcome;
use example_support::table::{Table, number};
use render::sketch::{self, Drawing, Paint};

pub(crate) fn write(options: &Options, map: &Map) -> Outcome<()> {
    let picture = options.out.join("stability_map.png");
    let drawings: Vec<Drawing> = options.shapes.iter().map(|&kind| drawing(options, map, kind)).collect();
    sketch::draw(&picture, drawings.len(), &drawings)?;
    for &kind in &options.shapes {
        println!("{}", table(options, map, kind));
    }
    println!("map.csv, stability_map.png: {}", options.out.display());
    Ok(())
}

/// How far the speeds are from the finest run's, as parts of those.
fn off(options: &Options, map: &Map, run: &Run) -> Option<[f64; 2]> {
    let finest = map.find(Case::new(options, run.case.kind, run.case.ratio, FINEST, options.finest))?;
    Some([0, 1].map(|i| run.speeds[i] / finest.speeds[i] - 1.0))
}

fn is_stable(run: &Run) -> bool {
    run.speeds.iter().all(|s| s.is_finite())
}

fn table(options: &Options, map: &Map, kind: Kind) -> Table {
    let mut table = Table::new();
    table.section(&format!("{}: upward speed over √(g d)", kind.name()));
    let header = [
        "ρ_s/ρ",
        "Courant",
        "cells per d",
        "at 10",
        "at 30",
        "off, %",
        "",
        "steps",
        "largest Courant",
        "CPU s",
    ];
    let (mut rows, mut runs) = (Vec::new(), Vec::new());
    for &ratio in &options.ratios {
        let coarse = options.courants.iter().map(|&c| (c, options.cells));
        for (courant, cells) in coarse.chain([(FINEST, options.finest)]) {
            let Some(run) = map.find(Case::new(options, kind, ratio, courant, cells)) else { continue };
            let off = off(options, map, run).unwrap_or([f64::NAN; 2]);
            let percent = |x: f64| if x.is_finite() { format!("{:+.2}", 100.0 * x) } else { String::new() };
            let mut row = vec![number(ratio), courant.to_string(), cells.to_string()];
            row.extend(run.speeds.map(|s| if s.is_finite() { format!("{s:.5}") } else { "unstable".into() }));
            row.extend(off.map(percent));
            row.extend([run.steps.to_string(), format!("{:.2}", run.reached), format!("{:.0}", run.cpu)]);
            rows.push(row);
            runs.push(run);
        }
    }
    let stable = runs.iter().filter(|r| is_stable(r)).count();
    let all = runs.len();
    table.matrix(&header, rows);
    table.row("stable runs", format!("{stable} of {all}"), "");
    table
}

/// Over the density ratio: how far the speeds are from the finest run's, the worse of both times; a line per Courant number.
fn drawing(options: &Options, map: &Map, kind: Kind) -> Drawing {
    let mut drawing = Drawing {
        title: format!("{}: speeds off the finest run's, the worse of two times", kind.name()),
        labels: Some(["log₁₀ of the density ratio ρ_s/ρ".into(), "%".into()]),
        ..Drawing::default()
    };
    let place = |ratio: f64| ratio.log10();
    let mut worst = LIMIT;
    for (i, &courant) in options.courants.iter().enumerate() {
        let paint = Paint::Kind(i, 0.0);
        let mut line = Vec::new();
        for &ratio in &options.ratios {
            let Some(run) = map.find(Case::new(options, kind, ratio, courant, options.cells)) else {
                continue;
            };
            match off(options, map, run) {
                _ if !is_stable(run) => drawing.points.push(([place(ratio), 0.0], paint, "unstable".into())),
                Some(off) => line.push([place(ratio), 100.0 * off[0].abs().max(off[1].abs())]),
                // Without a finest run nothing is known.
                None => {}
            }
        }
        line.sort_by(|p, q| p[0].total_cmp(&q[0]));
        worst = line.iter().map(|p| p[1]).fold(worst, f64::max);
        // The same lines may lie on one another.
        drawing.lines.push((line, 6.0 - 2.0 * i as f64, paint));
        drawing.legend.push((paint, format!("Courant number up to {courant}")));
    }
    let ends = options
        .ratios
        .iter()
        .map(|r| place(*r))
        .fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)));
    drawing.lines.push((vec![[ends.0 - 0.2, LIMIT], [ends.1 + 0.2, LIMIT]], 1.5, Paint::Ink));
    drawing.legend.push((Paint::Ink, format!("{LIMIT} %")));
    drawing.range = [(ends.0 - 0.2, ends.1 + 0.2), (0.0, 1.1 * worst)];
    drawing
}

/// What is asked for \[%\].
const LIMIT: f64 = 3.0;
