//! Closing tables, `result.json` and summary figures.
use example_support::Outcome;
use example_support::coupled::{Plan, Record, State};
use example_support::reference_curve::{Distance, at, passes, read};
use example_support::sinking_discs::{BOX, DIAMETER, SinkingDiscs};
use example_support::table::{Table, grouped, number, write_json};
use render::comparison::{Comparison, Curve, Panel};
use serde_json::json;
use siltflow::dem::ContactLaw;

/// Over one of Uhlmann's curves: what it is, unit, ours in that unit, and the points of the trailing and the leading disc.
struct Quantity {
    name: &'static str,
    unit: &'static str,
    of: fn(&State) -> f64,
    published: [&'static str; 2],
}

macro_rules! published {
    ($name:literal) => {
        [
            include_str!(concat!("../../tests/data/uhlmann_2005_trailing_", $name, ".csv")),
            include_str!(concat!("../../tests/data/uhlmann_2005_leading_", $name, ".csv")),
        ]
    };
}

const QUANTITIES: [Quantity; 5] = [
    Quantity {
        name: "way from the top",
        unit: "cm",
        of: |s| 100.0 * (BOX[1] - s.position[1]),
        published: published!("streamwise_position"),
    },
    Quantity {
        name: "velocity down",
        unit: "cm/s",
        of: |s| -100.0 * s.velocity[1],
        published: published!("streamwise_velocity"),
    },
    Quantity {
        name: "way aside",
        unit: "cm",
        of: |s| 100.0 * (s.position[0] - 0.5 * BOX[0]),
        published: published!("lateral_position"),
    },
    Quantity {
        name: "velocity aside",
        unit: "cm/s",
        of: |s| 100.0 * s.velocity[0],
        published: published!("lateral_velocity"),
    },
    Quantity {
        name: "angular velocity",
        unit: "rad/s",
        of: |s| s.spin[2],
        published: published!("angular_velocity"),
    },
];

const DISCS: [&str; 2] = ["trailing", "leading"];

/// Distance between the centres over time, in diameters.
fn separation(discs: [&[State]; 2]) -> Vec<(f64, f64)> {
    let pairs = discs[0].iter().zip(discs[1]);
    let apart = |(a, b): (&State, &State)| {
        let d = (a.position[0] - b.position[0]).hypot(a.position[1] - b.position[1]);
        (a.time, d / DIAMETER)
    };
    pairs.map(apart).collect()
}

/// The same of Uhlmann's discs, at the times of the trailing one's path.
fn published_separation() -> Vec<(f64, f64)> {
    let [along, across] = [0, 2].map(|q: usize| QUANTITIES[q].published.map(read));
    let point = |&(t, x): &(f64, f64)| {
        let dx = at(&along[1], t)? - x;
        let dy = at(&across[1], t)? - at(&across[0], t)?;
        Some((t, dx.hypot(dy) / (100.0 * DIAMETER)))
    };
    along[0].iter().filter_map(point).collect()
}

/// Discs kiss from when their surfaces are this near, and are apart again from the last time on \[diameters\].
const KISSING_GAP: f64 = 0.1;

/// When kissing begins and ends.
fn kissing(apart: &[(f64, f64)]) -> [Option<f64>; 2] {
    let near = 1.0 + KISSING_GAP;
    let begin = passes(apart, near);
    let after = apart.iter().rposition(|p| p.1 < near);
    let end = after.and_then(|i| passes(&apart[i..], near));
    [begin, end]
}

/// When the trailing disc comes level with the leading one.
fn level(sunk: [&[(f64, f64)]; 2]) -> Option<f64> {
    let ahead: Vec<(f64, f64)> =
        sunk[0].iter().filter_map(|&(t, x)| Some((t, at(sunk[1], t)? - x))).collect();
    passes(&ahead, 0.0)
}

fn head(title: &str, scene: &SinkingDiscs, record: &Record) -> Table {
    let [nx, ny] = scene.cells();
    let mut t = Table::new();
    t.section(title);
    t.row("cells", format!("{nx} × {ny} = {}", grouped((nx * ny) as u64)), "");
    t.row("steps", grouped(record.summary.steps), "");
    t.row("longest time step", number(1e3 * record.summary.dt[1]), "ms");
    t.row("processor time", number(record.elapsed.cpu), "s");
    for (name, seconds) in record.modules {
        t.row(&format!("  {name}"), number(seconds), "s");
    }
    t
}

/// Two discs, beside Uhlmann's.
pub(crate) fn two<L: ContactLaw>(
    scene: &SinkingDiscs,
    record: &Record,
    plan: &Plan<'_, 2, L>,
    no_images: bool,
) -> Outcome<()> {
    let mut t = head("Drafting, kissing, tumbling", scene, record);
    let [trailing, leading] = [0, 1].map(|b| record.motion.bodies.get(b).map_or(&[][..], Vec::as_slice));
    let apart = separation([trailing, leading]);
    let ours = kissing(&apart);
    let theirs = kissing(&published_separation());
    let sunk = [0, 1].map(|b| record.motion.over_time(b, QUANTITIES[0].of));
    let published = QUANTITIES[0].published.map(read);
    let levels = [level([&sunk[0], &sunk[1]]), level([&published[0], &published[1]])];
    let phases = [
        ("kissing begins", ours[0], theirs[0]),
        ("trailing disc is level with the other", levels[0], levels[1]),
        ("kissing ends", ours[1], theirs[1]),
    ];
    let show = |time: Option<f64>| time.map_or("–".to_owned(), |t| format!("{t:.4}"));
    let rows = phases.iter().map(|(name, ours, theirs)| {
        let off =
            ours.zip(*theirs).map_or("–".to_owned(), |(o, t)| format!("{:+.1}", 100.0 * (o / t - 1.0)));
        vec![(*name).to_owned(), show(*ours), show(*theirs), off]
    });
    t.matrix(&["phase (surfaces within d/10)", "here s", "Uhlmann s", "off %"], rows.collect());
    // Before the discs meet nothing is left to chance.
    let meeting = theirs[0].unwrap_or(f64::INFINITY);
    let mut json_curves = Vec::new();
    let mut rows = Vec::new();
    for q in &QUANTITIES {
        for (b, disc) in DISCS.iter().enumerate() {
            let points = read(q.published[b]);
            let line = record.motion.over_time(b, q.of);
            let peak = points.iter().fold(0.0, |most: f64, p| most.max(p.1.abs()));
            let before = Distance::between(&line, &points, |t| t < meeting);
            let all = Distance::between(&line, &points, |_| true);
            let percent = |x: f64| format!("{:.2}", 100.0 * x / peak);
            rows.push(vec![
                format!("{}, {disc}", q.name),
                format!("{peak:.3} {}", q.unit),
                percent(before.rms),
                percent(before.largest),
                percent(all.rms),
                percent(all.largest),
            ]);
            json_curves.push(json!({
                "quantity": q.name, "disc": disc, "peak": peak, "unit": q.unit,
                "before_kissing": {"rms": before.rms / peak, "largest": before.largest / peak},
                "all": {"rms": all.rms / peak, "largest": all.largest / peak},
            }));
        }
    }
    let header = ["off by, % of peak", "peak", "rms before kissing", "largest", "rms, all", "largest"];
    t.matrix(&header, rows);
    let least = apart.iter().fold(f64::INFINITY, |least, p| least.min(p.1));
    t.row("smallest gap", number((least - 1.0) * DIAMETER / scene.spacing()), "cells");
    t.row("time in contact", number(record.motion.contact_seconds), "s");
    println!("{t}\n  files are in {}", plan.out.display());
    let phases: Vec<_> = phases
        .iter()
        .map(|(name, ours, theirs)| json!({"phase": name, "here": ours, "uhlmann": theirs}))
        .collect();
    let result = json!({
        "cells_per_diameter": scene.cells_per_diameter, "cells": scene.cells(), "steps": record.summary.steps,
        "cpu_seconds": record.elapsed.cpu, "phases": phases, "curves": json_curves,
        "smallest_gap_diameters": least - 1.0, "contact_seconds": record.motion.contact_seconds,
    });
    write_json(&plan.out.join("result.json"), &result)?;
    if no_images {
        return Ok(());
    }
    let mut panels: Vec<Panel> = QUANTITIES
        .iter()
        .map(|q| {
            let curve = |b: usize| Curve {
                label: DISCS[b].into(),
                line: record.motion.over_time(b, q.of),
                points: read(q.published[b]),
            };
            let y = format!("{} in {}", q.name, q.unit);
            Panel { x: "t in s".into(), y, curves: vec![curve(0), curve(1)] }
        })
        .collect();
    let gap = |c: Vec<(f64, f64)>| c.into_iter().map(|(t, d)| (t, d - 1.0)).collect();
    let curve = Curve { label: String::new(), line: gap(apart), points: gap(published_separation()) };
    panels.push(Panel { x: "t in s".into(), y: "gap between discs in d".into(), curves: vec![curve] });
    figure(record, plan, (&panels, 2), ["computed", "Uhlmann (2005)"])
}

/// Largest Reynolds number ρ_s U d/μ, with the disc's density, that others found of the single disc: Wan & Turek 17.15 to 17.42, by the grid.
const PUBLISHED_REYNOLDS: [f64; 2] = [17.15, 17.42];

/// One disc.
pub(crate) fn one<L: ContactLaw>(
    scene: &SinkingDiscs,
    record: &Record,
    plan: &Plan<'_, 2, L>,
    no_images: bool,
) -> Outcome<()> {
    let mut t = head("A disc that sinks", scene, record);
    let states = record.motion.bodies.first().map_or(&[][..], Vec::as_slice);
    let fastest = states.iter().max_by(|a, b| a.velocity[1].abs().total_cmp(&b.velocity[1].abs()));
    let Some(fastest) = fastest else { return Ok(()) };
    let reynolds =
        scene.density_ratio * fastest.velocity[1].hypot(fastest.velocity[0]) * DIAMETER / scene.viscosity;
    let landed = passes(&record.motion.over_time(0, |s| s.position[1]), 0.5 * DIAMETER + scene.spacing());
    t.row("largest ρ_s U d/μ", number(reynolds), "");
    t.row("  others", format!("{:.2} to {:.2}", PUBLISHED_REYNOLDS[0], PUBLISHED_REYNOLDS[1]), "");
    t.row("  speed", number(100.0 * fastest.velocity[1].abs()), "cm/s");
    t.row("  at", number(fastest.time), "s");
    t.row("  height of the centre", number(100.0 * fastest.position[1]), "cm");
    t.row("a cell above the floor at", landed.map_or("–".to_owned(), number), "s");
    let aside = states.iter().map(|s| (s.position[0] - 0.5 * BOX[0]).abs()).fold(0.0, f64::max);
    t.row("farthest from the middle line", number(aside / DIAMETER), "d");
    t.row("time in contact", number(record.motion.contact_seconds), "s");
    println!("{t}\n  files are in {}", plan.out.display());
    let result = json!({
        "cells_per_diameter": scene.cells_per_diameter, "cells": scene.cells(), "steps": record.summary.steps,
        "cpu_seconds": record.elapsed.cpu, "reynolds": reynolds, "published": PUBLISHED_REYNOLDS,
        "speed": fastest.velocity[1].abs(), "time": fastest.time, "height": fastest.position[1], "landed": landed,
        "aside_diameters": aside / DIAMETER,
    });
    write_json(&plan.out.join("result.json"), &result)?;
    if no_images {
        return Ok(());
    }
    let panel = |y: &str, of: fn(&State) -> f64| {
        let curve = Curve { label: String::new(), line: record.motion.over_time(0, of), points: Vec::new() };
        Panel { x: "t in s".into(), y: y.into(), curves: vec![curve] }
    };
    let panels = [
        panel("height of the centre in cm", |s| 100.0 * s.position[1]),
        panel("velocity down in cm/s", |s| -100.0 * s.velocity[1]),
    ];
    figure(record, plan, (&panels, 1), ["computed", ""])
}

/// The flow at a few times beside the curves.
fn figure<L: ContactLaw>(
    record: &Record,
    plan: &Plan<'_, 2, L>,
    (panels, columns): (&[Panel], usize),
    names: [&str; 2],
) -> Outcome<()> {
    let n = record.slices.len();
    let mut chosen: Vec<usize> = (1..=3).map(|k| k * n.saturating_sub(1) / 3).collect();
    chosen.dedup();
    let fields: Vec<_> = chosen.into_iter().filter(|&i| i < n).map(|i| record.slices[i].field()).collect();
    let figure = Comparison { domain: plan.view.domain, fields: &fields, panels, columns, names };
    Ok(figure.draw(&plan.out.join("summary.png"))?)
}
