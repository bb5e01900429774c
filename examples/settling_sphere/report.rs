//! The closing table, `result.json` and the summary figure.
use example_support::Outcome;
use example_support::coupled::{Plan, Record};
use example_support::reference_curve::{Distance, at, passes};
use example_support::settling_sphere::{Case, DIAMETER, SettlingSphere};
use example_support::table::{Table, grouped, number, write_json};
use render::comparison::{Comparison, Curve, Panel};
use serde_json::json;
use siltflow::dem::ContactLaw;

/// Below so many cells between sphere and floor the flow is not resolved.
const RESOLVED_GAP: f64 = 2.0;

/// Heights between which the mean speed is told \[diameters above the floor\].
const HEIGHTS: [f64; 2] = [7.0, 2.0];

/// Mean speed between [`HEIGHTS`] of a gap over the diameter \[m/s\].
fn mean_speed(gap: &[(f64, f64)]) -> Option<f64> {
    let [from, to] = HEIGHTS.map(|h| passes(gap, h));
    Some((HEIGHTS[0] - HEIGHTS[1]) * DIAMETER / (to? - from?))
}

pub(crate) fn tell<L: ContactLaw>(
    scene: &SettlingSphere,
    record: &Record,
    plan: &Plan<'_, 3, L>,
    no_images: bool,
) -> Outcome<()> {
    let velocity = record.motion.over_time(0, |s| s.velocity[2]);
    let gap = record.motion.over_time(0, |s| s.position[2] - 0.5 * DIAMETER);
    let (peak_time, lowest) = velocity.iter().fold((0.0, 0.0), |p, &v| if v.1 < p.1 { v } else { p });
    let peak = -lowest;
    let measured_peak = scene.case.peak();
    let measured = scene.case.velocity();
    let scale = measured_peak.unwrap_or(peak);
    let near = |t: f64| at(&gap, t).is_some_and(|g| g < RESOLVED_GAP * scene.spacing());
    let resolved = Distance::between(&velocity, &measured, |t| !near(t));
    let unresolved = Distance::between(&velocity, &measured, near);
    let closest = gap.iter().fold(f64::INFINITY, |least, g| least.min(g.1));
    let [nx, ny, nz] = scene.grid()?.cells();
    let [density, viscosity] = scene.case.oil();
    let sideways =
        record.motion.bodies.first().map_or(0.0, |states| {
            states.iter().map(|s| s.velocity[0].hypot(s.velocity[1])).fold(0.0, f64::max)
        });

    let mut t = Table::new();
    t.section(&format!("Settling sphere, {:?}", scene.case));
    t.row("cells", format!("{nx} × {ny} × {nz} = {}", grouped((nx * ny * nz) as u64)), "");
    t.row("steps", grouped(record.summary.steps), "");
    t.row("longest time step", number(1e3 * record.summary.dt[1]), "ms");
    t.row("processor time", number(record.elapsed.cpu), "s");
    for (name, seconds) in record.modules {
        t.row(&format!("  {name}"), number(seconds), "s");
    }
    t.row("largest speed", number(1e3 * peak), "mm/s");
    t.row("  at", number(peak_time), "s");
    t.row("  Reynolds number", number(peak * DIAMETER * density / viscosity), "");
    if let Some(measured) = measured_peak {
        t.row("  measured", number(1e3 * measured), "mm/s");
        t.row("  off by", format!("{:+.2}", 100.0 * (peak / measured - 1.0)), "%");
    }
    if !measured.is_empty() {
        let percent = |x: f64| format!("{:.2}", 100.0 * x / scale);
        t.row("curve off by, rms over measured peak", percent(resolved.rms), "%");
        t.row("  largest", percent(resolved.largest), "%");
        t.row("    at", number(resolved.at), "s");
        t.row("  measured points", resolved.points, "");
        if unresolved.points > 0 {
            t.row("gap below two cells: rms", percent(unresolved.rms), "%");
            t.row("  largest", percent(unresolved.largest), "%");
            t.row("  measured points", unresolved.points, "");
        }
    }
    // What was measured as heights does not depend on what was measured as speeds.
    let over_diameter: Vec<_> = gap.iter().map(|&(t, g)| (t, g / DIAMETER)).collect();
    let means = [mean_speed(&over_diameter), mean_speed(&scene.case.gap_over_diameter())];
    if let [Some(ours), measured] = means {
        let [from, to] = HEIGHTS;
        let name = format!("mean speed between {from} and {to} diameters above the floor");
        t.row(&name, number(1e3 * ours), "mm/s");
        if let Some(measured) = measured {
            t.row("  by the measured heights", number(1e3 * measured), "mm/s");
            t.row("  off by", format!("{:+.2}", 100.0 * (ours / measured - 1.0)), "%");
        }
    }
    t.row("fastest sideways / peak", number(sideways / peak.max(f64::MIN_POSITIVE)), "");
    t.row("smallest gap to the floor", number(closest / scene.spacing()), "cells");
    t.row("time in contact", number(record.motion.contact_seconds), "s");
    if L::FILMS {
        t.row("  kept off the floor by a film below two cells", number(record.motion.film_seconds), "s");
    }
    println!("{t}\n  files are in {}", plan.out.display());
    let of = |d: &Distance| json!({"rms": d.rms / scale, "largest": d.largest / scale, "at": d.at, "points": d.points});
    let result = json!({
        "case": format!("{:?}", scene.case), "cells_per_diameter": scene.cells_per_diameter, "cells": [nx, ny, nz],
        "steps": record.summary.steps, "dt": record.summary.dt, "cpu_seconds": record.elapsed.cpu,
        "peak_speed": peak, "peak_time": peak_time, "measured_peak_speed": measured_peak,
        "curve_over_peak": of(&resolved), "curve_over_peak_below_two_cells": of(&unresolved),
        "mean_speed": means[0], "measured_mean_speed": means[1], "smallest_gap": closest, "contact_seconds": record.motion.contact_seconds,
        "film_seconds": record.motion.film_seconds,
    });
    write_json(&plan.out.join("result.json"), &result)?;
    if !no_images { figure(scene.case, record, plan) } else { Ok(()) }
}

/// The flow at three times, speed and gap over time.
fn figure<L: ContactLaw>(case: Case, record: &Record, plan: &Plan<'_, 3, L>) -> Outcome<()> {
    let n = record.slices.len();
    let mut chosen: Vec<usize> = [n / 4, n / 2, n - n.min(1 + n / 12)].into();
    chosen.dedup();
    let fields: Vec<_> = chosen.into_iter().filter(|&i| i < n).map(|i| record.slices[i].field()).collect();
    let scaled = |curve: Vec<(f64, f64)>, by: f64| curve.into_iter().map(|(t, v)| (t, by * v)).collect();
    let end = record.motion.bodies.first().and_then(|s| s.last()).map_or(0.0, |s| s.time);
    let panel = |y: &str, line: Vec<(f64, f64)>, points: Vec<(f64, f64)>| {
        let label = format!("{case:?}");
        let points = points.into_iter().filter(|p: &(f64, f64)| p.0 <= end).collect();
        Panel { x: "t in s".into(), y: y.into(), curves: vec![Curve { label, line, points }] }
    };
    let motion = &record.motion;
    let panels = [
        panel(
            "upward velocity in mm/s",
            motion.over_time(0, |s| 1e3 * s.velocity[2]),
            scaled(case.velocity(), 1e3),
        ),
        panel(
            "gap to the floor over diameter",
            motion.over_time(0, |s| s.position[2] / DIAMETER - 0.5),
            case.gap_over_diameter(),
        ),
    ];
    let names =
        if case.velocity().is_empty() { ["computed", ""] } else { ["computed", "ten Cate et al. (2002)"] };
    let figure = Comparison { domain: plan.view.domain, fields: &fields, panels: &panels, columns: 1, names };
    Ok(figure.draw(&plan.out.join("summary.png"))?)
}
