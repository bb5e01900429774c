//! Table and picture.
use crate::Options;
use crate::map::{FINEST, Kind, Map, Run};
use example_support::Outcome;
use example_support::picture::sketch::{self, Drawing, Paint};
use example_support::table::{Table, number};

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
    let finest = map.find(run.kind, run.ratio, FINEST, options.finest)?;
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
    let mut rows = Vec::new();
    for &ratio in &options.ratios {
        let coarse = options.courants.iter().map(|&c| (c, options.cells));
        for (courant, cells) in coarse.chain([(FINEST, options.finest)]) {
            let Some(run) = map.find(kind, ratio, courant, cells) else { continue };
            let off = off(options, map, run).unwrap_or([f64::NAN; 2]);
            let percent = |x: f64| if x.is_finite() { format!("{:+.2}", 100.0 * x) } else { String::new() };
            let mut row = vec![number(ratio), courant.to_string(), cells.to_string()];
            row.extend(run.speeds.map(|s| if s.is_finite() { format!("{s:.5}") } else { "unstable".into() }));
            row.extend(off.map(percent));
            row.extend([run.steps.to_string(), format!("{:.2}", run.reached), format!("{:.0}", run.cpu)]);
            rows.push(row);
        }
    }
    let stable = map.runs.iter().filter(|r| r.kind == kind && is_stable(r)).count();
    let all = map.runs.iter().filter(|r| r.kind == kind).count();
    table.matrix(&header, rows);
    table.row("stable runs", format!("{stable} of {all}"), "");
    table
}

/// A cell for every density ratio and Courant number, the darker the farther from the finest run.
fn drawing(options: &Options, map: &Map, kind: Kind) -> Drawing {
    let (columns, rows) = (options.courants.len() as f64, options.ratios.len() as f64);
    let mut drawing = Drawing {
        title: format!("{}: off the finest run, % (at 10 / at 30)", kind.name()),
        range: [(0.0, columns), (0.0, rows)],
        ..Drawing::default()
    };
    for (i, &courant) in options.courants.iter().enumerate() {
        for (j, &ratio) in options.ratios.iter().enumerate() {
            let Some(run) = map.find(kind, ratio, courant, options.cells) else { continue };
            let off = off(options, map, run).map(|off| off.map(f64::abs));
            let (paint, text) = match off {
                _ if !is_stable(run) => (Paint::Kind(3, 0.2), "unstable".into()),
                Some([first, last]) => {
                    let worst = first.max(last);
                    (Paint::Share(10.0 * worst), format!("{:.1} / {:.1}", 100.0 * first, 100.0 * last))
                }
                None => (Paint::Share(0.0), "stable".into()),
            };
            let (x, y) = (i as f64, j as f64);
            drawing.cells.push(([x + 0.02, y + 0.04], [x + 0.98, y + 0.96], paint));
            let label = format!("{ratio} at {courant}: {text}");
            drawing.points.push(([x + 0.05, y + 0.5], Paint::Ink, label));
        }
    }
    drawing
}
