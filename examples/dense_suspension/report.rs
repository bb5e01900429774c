//! The closing table, `result.json` and the figure of the run.
use example_support::Outcome;
use example_support::coupled::{Fall, Plan, Record};
use example_support::suspension::{Diary, Suspension};
use example_support::table::{Table, grouped, number, write_json};
use render::cpu;
use render::sketch::{Drawing, Paint, draw};
use serde_json::json;
use siltflow::dem::ContactLaw;
use siltflow::interfaces::{Bodies, Kinematics};

pub(crate) fn tell<L: ContactLaw>(
    scene: &Suspension,
    fall: &Fall<3, L>,
    record: &Record<Diary>,
    plan: &Plan<'_, 3, L>,
    no_images: bool,
) -> Outcome<()> {
    let (diary, bodies, grid) = (&record.motion, &fall.particles.bodies, fall.flow.grid());
    let l = diary.ledger();
    let last = |name: &str| diary.column(name).last().copied().unwrap_or(f64::NAN);
    let most = |name: &str| diary.column(name).into_iter().map(f64::abs).fold(0.0, f64::max);
    let [nx, ny, nz] = grid.cells();
    let cells = nx * ny * nz;
    let volume: f64 = bodies.ids().map(|b| bodies.inertia(b).volume).sum();
    let started = volume / grid.volume();
    let in_steps: f64 = record.modules.iter().map(|m| m.1).sum();
    let steps = record.summary.steps.max(1) as f64;
    let reynolds = |speed: f64| speed * scene.diameter / scene.viscosity;

    let mut t = Table::new();
    t.section("Dense suspension");
    t.row("bodies", bodies.n_bodies(), "");
    t.row("cells", format!("{nx} × {ny} × {nz} = {}", grouped(cells as u64)), "");
    t.row("solid fraction at the start", number(started), "");
    t.row("simulated time", number(fall.flow.time()), "s");
    t.row("steps", grouped(record.summary.steps), "");
    t.row("longest time step", number(1e3 * record.summary.dt[1]), "ms");
    t.row("largest Courant number", number(record.summary.courant), "");
    t.section("Bodies");
    t.row("most outside the box at any time", most("outside"), "");
    let finite = diary.lost().map_or("yes".to_owned(), |t| format!("not after {} s", number(t)));
    t.row("all numbers finite", finite, "");
    t.row("fastest at any time", number(1e3 * most("fastest")), "mm/s");
    t.row("  Reynolds number", number(reynolds(most("fastest"))), "");
    t.row("  a sphere alone would have", number(reynolds(scene.alone())), "");
    t.row("fastest at the end", number(1e3 * last("fastest")), "mm/s");
    t.row("contacts per body at the end", number(last("coordination")), "");
    if L::FILMS {
        // Of those that touch or are so close that the model acts between them.
        let close: Vec<_> = diary.column("contacts").into_iter().zip(diary.column("films")).collect();
        let share = |(touch, film): (f64, f64)| 100.0 * film / (touch + film).max(1.0);
        let mean = close.iter().map(|c| share(*c)).sum::<f64>() / close.len().max(1) as f64;
        t.row("of the pairs close or in touch, kept apart by a film, mean", number(mean), "%");
        t.row("  at the end", number(close.last().map_or(f64::NAN, |c| share(*c))), "%");
    }
    t.row("overlap by radius at the end, mean", number(100.0 * last("overlap")), "%");
    t.row("  largest of all", number(100.0 * most("largest_overlap")), "%");
    t.row("volume of overlaps by volume of bodies at the end", number(100.0 * last("shared")), "%");
    t.section("Bed");
    t.row(
        "height below which 19 of 20 centres are",
        number(last("bed_height") / scene.diameter),
        "diameters",
    );
    t.row("porosity", number(1.0 - last("bed_fraction")), "");
    if !scene.periodic {
        t.row("  without a diameter beside the walls", number(1.0 - last("core_fraction")), "");
    }
    t.section("Ledger");
    t.row("divergence × time step", number(l.divergence), "");
    t.row("momentum residual of a step / Σ|impulse|", number(l.momentum_step), "");
    t.row("momentum residual of the run / Σ|impulse|", number(l.momentum_total), "");
    t.row("work of net weight", number(1e6 * l.work), "µJ");
    t.row("kinetic energy, largest", number(1e6 * most("energy")), "µJ");
    t.row("  now", number(1e6 * l.energy[1]), "µJ");
    t.row("viscous dissipation", number(1e6 * l.dissipation), "µJ");
    t.row("work of contacts", number(1e6 * l.contact_work), "µJ");
    t.row("not accounted for / work of the run", number(l.energy_residual / l.work), "");
    t.row("  largest of any time", number(most("energy_residual") / l.work), "");
    t.section("Cost");
    t.row("processor time", number(record.elapsed.cpu), "s");
    t.row("wall time", number(record.elapsed.wall), "s");
    t.row("per cell and step", number(1e6 * in_steps / (cells as f64 * steps)), "µs");
    for (name, seconds) in record.modules {
        t.row(
            &format!("  {name}"),
            format!("{} ({:.1} %)", number(seconds), 100.0 * seconds / in_steps),
            "s",
        );
    }
    if let Some(bytes) = cpu::peak_memory() {
        t.row("peak memory", number(bytes as f64 / 1e6), "MB");
    }
    t.note("modules, processor time and memory are those of this run, without the placing");
    println!("{t}\n  files are in {}", plan.out.display());

    let modules: serde_json::Map<_, _> =
        record.modules.iter().map(|(name, seconds)| ((*name).to_owned(), json!(seconds))).collect();
    let result = json!({
        "bodies": bodies.n_bodies(), "cells": [nx, ny, nz], "cells_per_diameter": scene.cells_per_diameter,
        "fraction_at_the_start": started, "time": fall.flow.time(), "steps": record.summary.steps, "dt": record.summary.dt,
        "outside": most("outside"), "finite": diary.lost().is_none(), "fastest": most("fastest"),
        "fastest_at_the_end": last("fastest"), "coordination": last("coordination"), "contacts": last("contacts"), "films": last("films"), "largest_overlap": most("largest_overlap"), "shared": last("shared"),
        "bed_height": last("bed_height"), "porosity": 1.0 - last("bed_fraction"),
        "porosity_of_the_core": 1.0 - last("core_fraction"), "momentum_residual_step": l.momentum_step,
        "momentum_residual_total": l.momentum_total, "kinetic_energy": l.energy, "work": l.work,
        "contact_work": l.contact_work, "dissipation": l.dissipation, "energy_residual": l.energy_residual,
        "largest_energy_residual": most("energy_residual"), "cpu_seconds": record.elapsed.cpu, "modules": modules,
    });
    write_json(&plan.out.join("result.json"), &result)?;
    if no_images { Ok(()) } else { Ok(draw(&plan.out.join("summary.png"), 2, &figure(scene, diary))?) }
}

/// Energies, solid fraction and speed over time, and the solid fraction over the height.
fn figure(scene: &Suspension, diary: &Diary) -> Vec<Drawing> {
    let times = diary.column("time");
    let end = times.last().copied().unwrap_or(1.0).max(f64::MIN_POSITIVE);
    let over_time = |title: &str, label: &str, curves: &[(&str, f64, &str)]| {
        let lines: Vec<(Vec<[f64; 2]>, &str)> = curves
            .iter()
            .map(|&(name, by, text)| {
                let points = times.iter().zip(diary.column(name)).map(|(t, v)| [*t, by * v]);
                (points.filter(|p| p[1].is_finite()).collect(), text)
            })
            .filter(|line: &(Vec<_>, &str)| !line.0.is_empty())
            .collect();
        plot(title, [label, "time, s"], (0.0, end), &lines)
    };
    let mut energies = vec![
        ("work", 1e6, "work of weight less buoyancy"),
        ("dissipation", 1e6, "viscous dissipation"),
        ("contact_work", -1e6, "lost or stored in contacts"),
        ("energy", 1e6, "kinetic energy"),
    ];
    energies.push(("energy_residual", 1e6, "not accounted for"));
    let profiles = diary.profiles();
    let turned: Vec<(Vec<[f64; 2]>, &str)> = profiles
        .iter()
        .zip(["at the start", "at the end"])
        .map(|(p, text)| (p.iter().map(|[z, f]| [z / scene.diameter, *f]).collect(), text))
        .collect();
    let top = profiles[1].last().map_or(1.0, |p| p[0] / scene.diameter);
    vec![
        over_time("Energies", "µJ", &energies),
        over_time(
            "Solid fraction of the bed",
            "",
            &[("bed_fraction", 1.0, "whole width"), ("core_fraction", 1.0, "a diameter from the walls")],
        ),
        plot("Solid fraction over height", ["", "height by diameter"], (0.0, top), &turned),
        over_time("Fastest body", "mm/s", &[("fastest", 1e3, "speed")]),
    ]
}

fn plot(title: &str, [up, along]: [&str; 2], x: (f64, f64), lines: &[(Vec<[f64; 2]>, &str)]) -> Drawing {
    let values = || lines.iter().flat_map(|l| &l.0).map(|p| p[1]);
    let (low, high) = (values().fold(0.0, f64::min), values().fold(0.0, f64::max));
    let air = if high > low { 0.06 * (high - low) } else { 1.0 };
    Drawing {
        title: title.into(),
        range: [x, (if low < 0.0 { low - air } else { 0.0 }, high + air)],
        labels: Some([along.into(), up.into()]),
        lines: lines.iter().enumerate().map(|(k, l)| (l.0.clone(), 3.0, Paint::Kind(k, 0.0))).collect(),
        legend: lines.iter().enumerate().map(|(k, l)| (Paint::Kind(k, 0.0), l.1.to_owned())).collect(),
        ..Drawing::default()
    }
}
