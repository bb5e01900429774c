//! What the grid resolves of the film between a sphere and a wall or another sphere.
//! `cargo bench --bench lubrication`, on one thread.
use example_support::cpu::Stopwatch;
use example_support::film::{Before, brenner, resistance};
use example_support::{Outcome, run_cases};
use siltflow::ibm::SmoothForcing;

fn main() -> Outcome<()> {
    run_cases(&[("wall", wall), ("spheres", spheres), ("probe", probe)])
}

/// Gaps in cells.
const GAPS: [f64; 10] = [3.0, 2.0, 1.5, 1.2, 0.9, 0.6, 0.4, 0.3, 0.2, 0.1];

fn wall() -> Outcome<()> {
    table(Before::Wall)
}
fn spheres() -> Outcome<()> {
    table(Before::Sphere)
}

fn table(before: Before) -> Outcome<()> {
    println!("\nSphere before {before:?}: force over 6πμRU, torque over 8πμR³Ω by the grid alone");
    println!(
        "{:>6} {:>8} {:>8} {:>10} {:>10} {:>8} {:>10} {:>10} {:>8}",
        "per d", "δ/h", "δ/R", "approach", "exact", "off, %", "sliding", "turning", "CPU s"
    );
    for per_diameter in [8, 12] {
        for cells in GAPS {
            let watch = Stopwatch::start();
            let gap = cells / per_diameter as f64;
            let found = resistance(before, per_diameter, gap, 0.0, Box::new(SmoothForcing::new(1.0)))?;
            let exact = brenner(2.0 * gap);
            let (off, cpu) = (100.0 * (found.approach / exact - 1.0), watch.elapsed().cpu);
            println!(
                "{per_diameter:>6} {cells:>8} {:>8.4} {:>10.4} {exact:>10.4} {off:>8.2} {:>10.4} {:>10.4} {cpu:>8.1}",
                2.0 * gap,
                found.approach,
                found.sliding,
                found.turning
            );
        }
    }
    Ok(())
}
fn probe() -> Outcome<()> {
    let a: Vec<f64> = std::env::var("P").unwrap().split(',').map(|s| s.parse().unwrap()).collect();
    let before = if std::env::var("S").is_ok() { Before::Sphere } else { Before::Wall };
    let gap = a[1] / a[0];
    let f = resistance(before, a[0] as usize, gap, a[2], Box::new(SmoothForcing::new(1.0)))?;
    println!("{a:?} {f:?} {:.2}", 100.0 * (f.approach / brenner(2.0 * gap) - 1.0));
    Ok(())
}
