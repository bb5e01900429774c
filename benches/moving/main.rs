//! Bodies that move through the grid as they are told: a swinging cylinder against measured forces, and how much of the forces
//! comes from the grid. And free ones in creeping shear. On one thread: `cargo bench --bench moving`, or with the names of cases after `--`.
mod shear;

use render::cpu::Stopwatch;
use siltflow::flow::Diffusion;
use siltflow::ibm::{Forcing, Hfdib, Kernel, SmoothForcing};
use validation::moved_body::{Noise, Swinging, passing, turning};
use validation::settling_sphere::{Case, SettlingSphere};
use validation::{Outcome, periodic_cube, run_cases};

/// Harmonics that belong to the flow.
const HARMONICS: usize = 12;

/// Time over period, force over ρU²D: Dütsch et al. (1998).
const MEASURED: &str = include_str!("../../tests/data/dutsch_1998_inline_force.csv");

fn main() -> Outcome<()> {
    run_cases(&[
        ("swinging", swinging),
        ("passing", passing_2d),
        ("sphere", passing_3d),
        ("turning", turning_sphere),
        ("cube", sphere_in_cube),
        ("box", creeping_in_a_box),
        ("shear", shear::sphere_in_shear),
        ("jeffery", shear::jeffery_orbit),
    ])
}

type Way = (&'static str, fn() -> Box<dyn Forcing>);

const WAYS: [Way; 4] = [
    ("smooth, Yang", || Box::new(SmoothForcing::new(1.0).with_kernel(Kernel::Yang))),
    ("smooth, quartic", || Box::new(SmoothForcing::new(1.0).with_kernel(Kernel::QuarticSpline))),
    ("smooth, quintic", || Box::new(SmoothForcing::new(1.0).with_kernel(Kernel::QuinticSpline))),
    ("hfdib", || Box::new(Hfdib::new(1.0))),
];

fn measured() -> Outcome<Vec<[f64; 2]>> {
    let row = |line: &str| -> Outcome<[f64; 2]> {
        let (time, force) =
            line.split_once(' ').ok_or_else(|| format!("{line:?} is not a time and a force"))?;
        Ok([time.parse()?, force.parse()?])
    };
    MEASURED.lines().filter(|line| !line.starts_with('#')).map(row).collect()
}

/// The value of a series over one period at a time, over the period; entry i is at the end of step i.
fn at(series: &[f64], time: f64) -> f64 {
    let n = series.len();
    // Forces are means over steps.
    let place = (time * n as f64 - 0.5).rem_euclid(n as f64);
    let (i, part) = (place as usize, place.fract());
    series[i % n] * (1.0 - part) + series[(i + 1) % n] * part
}

fn swinging() -> Outcome<()> {
    println!("\nSwinging cylinder, Re 100, KC 5 (Dütsch et al. 1998): in-line force in the fifth swing");
    println!(
        "{:>16} {:>6} {:>6} {:>8} {:>12} {:>8} {:>10} {:>8}",
        "forcing", "per D", "steps", "peak", "rms off", "largest", "noise", "CPU s"
    );
    let measured = measured()?;
    let most = measured.iter().fold(0.0, |most: f64, m| most.max(m[1].abs()));
    for (name, forcing) in WAYS {
        for per_diameter in [10, 20, 40] {
            for halvings in 0..if per_diameter < 40 { 3 } else { 1 } {
                let steps = (20 << halvings) * per_diameter;
                let watch = Stopwatch::start();
                let mut scene = Swinging::new(per_diameter, steps, [0.37, 0.3], forcing())?;
                for _ in 0..4 {
                    scene.swing()?;
                }
                let series = scene.swing()?;
                let noise = Noise::of(&series, HARMONICS);
                // The cylinder starts at its middle place, at full speed, as the table does.
                let off: Vec<f64> = measured.iter().map(|[t, force]| at(&series, *t) - force).collect();
                let rms = (off.iter().map(|e| e * e).sum::<f64>() / off.len() as f64).sqrt();
                let largest = off.iter().fold(0.0, |most: f64, e| most.max(e.abs()));
                println!(
                    "{name:>16} {per_diameter:>6} {steps:>6} {:>8.4} {:>11.2}% {:>7.2}% {:>9.3}% {:>8.2}",
                    noise.peak,
                    100.0 * rms / most,
                    100.0 * largest / most,
                    100.0 * noise.rms / noise.peak,
                    watch.elapsed().cpu
                );
            }
        }
    }
    Ok(())
}

fn passing_2d() -> Outcome<()> {
    println!("\nCylinder, Re 40, periodic box of 8 D: it moves, the fluid moves");
    table::<2>(8, [0.2, 0.1])
}

fn passing_3d() -> Outcome<()> {
    println!("\nSphere, Re 40, periodic box of 4 D: it moves, the fluid moves");
    // At the larger one explicit diffusion is just stable with the finer cells.
    table::<3>(4, [0.16, 0.08])
}

/// The drag from 1 to 3 units of time after the start.
fn table<const D: usize>(edge: usize, courant_numbers: [f64; 2]) -> Outcome<()> {
    println!(
        "{:>16} {:>6} {:>8} {:>10} {:>10} {:>9} {:>10} {:>10} {:>8}",
        "forcing", "per D", "Courant", "Cd moving", "Cd at rest", "differ", "noise", "at rest", "CPU s"
    );
    for (name, forcing) in WAYS {
        for per_diameter in [10, 20] {
            for courant in courant_numbers {
                let watch = Stopwatch::start();
                let dt = courant / per_diameter as f64;
                let drag = |moves| passing::<D>(moves, edge, per_diameter, 1.0 / 40.0, [3.0, dt], forcing());
                let late = |series: Vec<f64>| series[series.len() / 3..].to_vec();
                let [moving, still] = [late(drag(true)?), late(drag(false)?)];
                let mean = |series: &[f64]| series.iter().sum::<f64>() / series.len() as f64;
                let [m, s] = [mean(&moving), mean(&still)];
                let noise = |series: &[f64]| 100.0 * Noise::of(series, HARMONICS).rms / s;
                println!(
                    "{name:>16} {per_diameter:>6} {courant:>8} {m:>10.4} {s:>10.4} {:>8.2}% {:>9.3}% {:>9.3}% {:>8.2}",
                    100.0 * (m / s - 1.0),
                    noise(&moving),
                    noise(&still),
                    watch.elapsed().cpu
                );
            }
        }
    }
    Ok(())
}

fn turning_sphere() -> Outcome<()> {
    println!(
        "\nSphere that turns in creeping flow: torque over 8πμR³Ω, with explicit and with implicit diffusion"
    );
    println!("{:>16} {:>6} {:>9} {:>9} {:>8}", "forcing", "per D", "explicit", "implicit", "CPU s");
    for (name, forcing) in WAYS {
        for per_diameter in [8, 12] {
            let watch = Stopwatch::start();
            let torque = |diffusion| turning(per_diameter, forcing(), diffusion);
            let [explicit, implicit] = [torque(Diffusion::Explicit)?, torque(Diffusion::Implicit)?];
            println!(
                "{name:>16} {per_diameter:>6} {explicit:>9.4} {implicit:>9.4} {:>8.1}",
                watch.elapsed().cpu
            );
        }
    }
    Ok(())
}

fn sphere_in_cube() -> Outcome<()> {
    let exact = periodic_cube::hasimoto();
    println!(
        "\nFixed sphere in a periodic cube of 4 D, creeping flow: drag over 6πμRU, {exact:.4} by Hasimoto"
    );
    println!("{:>16} {:>6} {:>9} {:>8} {:>8}", "forcing", "per D", "drag", "off", "CPU s");
    for (name, forcing) in WAYS {
        for per_diameter in [6, 8, 12] {
            let watch = Stopwatch::start();
            let drag = periodic_cube::drag(per_diameter, forcing())?;
            let (off, cpu) = (100.0 * (drag / exact - 1.0), watch.elapsed().cpu);
            println!("{name:>16} {per_diameter:>6} {drag:>9.4} {off:>7.2}% {cpu:>8.1}");
        }
    }
    Ok(())
}

fn creeping_in_a_box() -> Outcome<()> {
    println!(
        "\nSphere of ten Cate et al. (2002), E1, in creeping flow in the middle of its box: speed under its net weight"
    );
    println!("{:>6} {:>12} {:>8}", "per D", "speed mm/s", "CPU s");
    for cells_per_diameter in [6, 8, 12] {
        let watch = Stopwatch::start();
        let speed = SettlingSphere { case: Case::E1, cells_per_diameter }.creeping_speed()?;
        println!("{cells_per_diameter:>6} {:>12.3} {:>8.1}", 1e3 * speed, watch.elapsed().cpu);
    }
    Ok(())
}
