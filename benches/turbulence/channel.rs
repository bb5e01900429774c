//! Developed flow between two walls.
use render::cpu::Stopwatch;
use render::profiles::{Curve, Panel, draw};
use siltflow::flow::Axis;
use std::path::Path;
use turb::{Inflow, Law, Realizable, Sst, StandardKEpsilon, Sublayer, WallFunctions, Wilcox};
use validation::Outcome;
use validation::turbulent_flows::{ChannelProfile, Drive, between_walls, developed_channel, numbers};

macro_rules! simple_foam {
    ($model:literal) => {
        [
            include_str!(concat!("../../tests/data/turbulence/channel_", $model, "_c.csv")),
            include_str!(concat!("../../tests/data/turbulence/channel_", $model, "_f.csv")),
        ]
    };
}

/// Re 10⁶ by mean velocity and height, with wall functions, on the meshes c and f of the reference runs.
pub(crate) fn against_simple_foam() -> Outcome<()> {
    println!("\nDeveloped channel, Re 1e6, wall functions, against simpleFoam on the same cells across");
    println!(
        "{:>16} {:>5} {:>8} {:>10} {:>10} {:>8} {:>8} {:>9} {:>6} {:>6} {:>6}",
        "model", "mesh", "setting", "Darcy f", "reference", "off", "u off", "nu_t off", "y+", "its", "CPU s"
    );
    let mut panels = Vec::new();
    of_model("k-omega SST", Sst::default(), simple_foam!("kOmegaSST"), &mut panels)?;
    of_model("k-omega", Wilcox::openfoam(), simple_foam!("kOmega"), &mut panels)?;
    of_model("k-epsilon", StandardKEpsilon::default(), simple_foam!("kEpsilon"), &mut panels)?;
    of_model("realizable k-eps", Realizable::default(), simple_foam!("realizableKE"), &mut panels)?;
    std::fs::create_dir_all("out/turbulence")?;
    draw(Path::new("out/turbulence/channel.png"), &panels)?;
    Ok(())
}

fn of_model<L: Law>(name: &str, law: L, texts: [&str; 2], panels: &mut Vec<Panel>) -> Outcome<()> {
    let nu = 1e-6;
    let (own, alone) = (WallFunctions::default(), WallFunctions::of_k_alone());
    for (mesh, setting, functions, cells, first, text) in [
        ("c", "k alone", alone, 40, 3e-3, texts[0]),
        ("c", "", own, 40, 3e-3, texts[0]),
        ("f", "k alone", alone, 80, 1.5e-3, texts[1]),
        ("f", "", own, 80, 1.5e-3, texts[1]),
    ] {
        let reference = numbers::<6>(text);
        let start = Inflow::from_length(1.0, 0.05, 0.07)?;
        let y = between_walls(cells, 1.0, first)?;
        let watch = Stopwatch::start();
        let ours = developed_channel(law.clone(), functions, y, nu, Drive::Bulk(1.0), start)?;
        let seconds = watch.elapsed().cpu;
        let u_tau = reference[0][1] * nu / reference[0][0];
        let half = reference.len().min(ours.y.len());
        let sum = |f: &dyn Fn(usize) -> f64| (0..half).map(f).sum::<f64>();
        let u = (sum(&|j| (ours.u[j] - reference[j][2] * u_tau).powi(2)) / half as f64).sqrt();
        let nu_t = (sum(&|j| (ours.nu_t[j] / nu - reference[j][5]).powi(2))
            / sum(&|j| reference[j][5].powi(2)))
        .sqrt();
        let f = |u_tau: f64| 8.0 * u_tau * u_tau;
        println!(
            "{name:>16} {mesh:>5} {setting:>8} {:>10.5} {:>10.5} {:>6.2} % {:>6.3} % {:>7.2} % {:>6.1} {:>6} {:>6.2}",
            f(ours.u_tau),
            f(u_tau),
            100.0 * (f(ours.u_tau) / f(u_tau) - 1.0),
            100.0 * u,
            100.0 * nu_t,
            ours.y_plus.mean,
            ours.iterations,
            seconds
        );
        if mesh == "c" && setting.is_empty() {
            let points = |column: usize| reference[..half].iter().map(|r| (r[1], r[column])).collect();
            let wall = ours.u_tau / nu;
            let line = |list: &[f64], unit: f64| {
                ours.y.iter().zip(list).map(|(y, v)| (y * wall, v / unit)).collect()
            };
            let panel = |quantity: &str, line, points| Panel {
                title: format!("{name}: {quantity}"),
                x: "y+".into(),
                y: quantity.into(),
                curves: vec![
                    Curve { label: "ours".into(), points: line, line: true },
                    Curve { label: "simpleFoam".into(), points, line: false },
                ],
            };
            panels.push(panel("u+", line(&ours.u, ours.u_tau), points(2)));
            panels.push(panel("ν_t/ν", line(&ours.nu_t, nu), points(5)));
        }
    }
    Ok(())
}

/// Re_τ, U_b+ and the table of a direct numerical simulation.
const DNS: [(f64, f64, &str); 2] = [
    (587.19, 18.654, include_str!("../../tests/data/turbulence/dns_590.csv")),
    (1000.512, 19.990, include_str!("../../tests/data/turbulence/dns_1000.csv")),
];

/// Driven by the force of the DNS; the logarithmic layer is y+ ≥ 30 (from the first cell that is nominally there), y ≤ 0.3 h.
pub(crate) fn against_dns() -> Outcome<()> {
    println!("\nDeveloped channel against DNS, driven by the same force");
    println!(
        "{:>16} {:>7} {:>6} {:>11} {:>6} {:>14} {:>9} {:>8} {:>6} {:>6}",
        "model", "Re_tau", "y+", "setting", "cells", "log layer off", "at y+", "Cf off", "its", "CPU s"
    );
    let mut panels = Vec::new();
    for (re, bulk, text) in DNS {
        let dns = numbers::<2>(text);
        let mut resolved = Vec::new();
        let default = WallFunctions::default();
        let linear = WallFunctions { sublayer: Sublayer::Linear, ..default };
        let alone = WallFunctions::of_k_alone();
        for (y_plus, setting, functions) in [
            (0.3, "", default),
            (0.3, "linear", linear),
            (1.0, "", default),
            (1.0, "linear", linear),
            (30.0, "", default),
            (30.0, "k alone", alone),
            (100.0, "", default),
            (100.0, "k alone", alone),
        ] {
            let case = Channel { re, bulk, dns: &dns, y_plus, setting, functions };
            let sst = case.run("k-omega SST", Sst::default())?;
            let wilcox = case.run("k-omega", Wilcox::default())?;
            if y_plus > 1.0 {
                case.run("k-epsilon", StandardKEpsilon::default())?;
                case.run("realizable k-eps", Realizable::default())?;
            } else if resolved.is_empty() {
                resolved = vec![("k-ω SST", sst), ("k-ω", wilcox)];
            }
        }
        let mut curves: Vec<Curve> = resolved
            .iter()
            .map(|(label, p)| Curve {
                label: (*label).into(),
                points: p.y.iter().zip(&p.u).map(|(y, u)| (y * re, *u)).collect(),
                line: true,
            })
            .collect();
        let points = dns.iter().step_by(4).map(|p| (p[0], p[1])).filter(|p| p.0 > 0.3).collect();
        curves.push(Curve { label: "DNS".into(), points, line: false });
        let title = format!("wall-resolved, Re_τ {re:.0}");
        panels.push(Panel { title, x: "y+".into(), y: "u+".into(), curves });
    }
    std::fs::create_dir_all("out/turbulence")?;
    draw(Path::new("out/turbulence/dns.png"), &panels)?;
    Ok(())
}

struct Channel<'a> {
    re: f64,
    bulk: f64,
    dns: &'a [[f64; 2]],
    y_plus: f64,
    /// What is not the default in the functions.
    setting: &'static str,
    functions: WallFunctions,
}

impl Channel<'_> {
    fn run<L: Law>(&self, name: &str, law: L) -> Outcome<ChannelProfile> {
        let Self { re, bulk, dns, y_plus, setting, functions } = *self;
        let y = if y_plus > 1.0 {
            Axis::uniform(2 * (re / (2.0 * y_plus)).round() as usize, 0.0, 2.0)?
        } else {
            between_walls(if re < 700.0 { 96 } else { 120 }, 2.0, 2.0 * y_plus / re)?
        };
        let cells = y.cells();
        let watch = Stopwatch::start();
        let start = Inflow { k: 1.0, omega: 10.0 };
        let ours = developed_channel(law, functions, y, 1.0 / re, Drive::Force(1.0), start)?;
        let exact = |y: f64| {
            let i = dns.partition_point(|p| p[0] < y).clamp(1, dns.len() - 1);
            let ([y0, u0], [y1, u1]) = (dns[i - 1], dns[i]);
            u0 + (u1 - u0) * (y - y0) / (y1 - y0)
        };
        let layer = ours.y.iter().zip(&ours.u).map(|(y, u)| (y * re, u));
        let worst = layer
            .filter(|(y, _)| (29.0..=0.3 * re).contains(y))
            .map(|(y, u)| (u / exact(y) - 1.0, y))
            .fold((0.0_f64, 0.0), |a, b| if b.0.abs() > a.0.abs() { b } else { a });
        println!(
            "{name:>16} {re:>7.0} {:>6.1} {:>11} {cells:>6} {:>12.2} % {:>9.0} {:>6.2} % {:>6} {:>6.2}",
            ours.y_plus.mean,
            setting,
            100.0 * worst.0,
            worst.1,
            100.0 * ((bulk / ours.bulk).powi(2) - 1.0),
            ours.iterations,
            watch.elapsed().cpu
        );
        Ok(ours)
    }
}
