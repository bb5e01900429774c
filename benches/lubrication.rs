//! What the grid resolves of the film between a sphere and a wall or another sphere, and the whole with the model of the rest.
//! `cargo bench --bench lubrication`, or with the names of cases after `--`; on one thread.
use render::cpu::Stopwatch;
use siltflow::dem::{Chen, Lubricated};
use siltflow::ibm::{SmoothFilm, SmoothForcing};
use siltflow::interfaces::UnresolvedFilm;
use validation::film::{Before, brenner, resistance, sinking, spheres};
use validation::{Outcome, run_cases};

fn main() -> Outcome<()> {
    run_cases(&[("wall", || table(Before::Wall)), ("spheres", || table(Before::Sphere)), ("sinking", sink)])
}

/// Gaps in cells.
const GAPS: [f64; 10] = [3.0, 2.0, 1.2, 0.9, 0.6, 0.4, 0.3, 0.2, 0.1, 0.05];

/// A sphere of diameter 1 at gaps that stay.
fn table(before: Before) -> Outcome<()> {
    println!(
        "\nSphere before {before:?}: force over 6πμRU (with the model), torque over 8πμR³Ω by the grid alone"
    );
    println!(
        "{:>6} {:>8} {:>8} {:>10} {:>10} {:>8} {:>12} {:>8} {:>10} {:>10} {:>8}",
        "per d",
        "δ/h",
        "δ/R",
        "exact",
        "grid",
        "off, %",
        "with model",
        "off, %",
        "sliding",
        "turning",
        "CPU s"
    );
    for per_diameter in [6, 8, 12, 16] {
        let film = SmoothFilm::new(1.0 / per_diameter as f64)?;
        for cells in GAPS {
            let watch = Stopwatch::start();
            let gap = cells / per_diameter as f64;
            let found = resistance(before, per_diameter, gap, 0.25, Box::new(SmoothForcing::new(1.0)))?;
            // 6πμR*²U/δ over 6πμRV, V the speed of one of them: R*/R is 1 or a half, U/V 1 or 2.
            let (exact, part, wall) = match before {
                Before::Wall => (brenner(2.0 * gap), 0.5, true),
                Before::Sphere => (spheres(2.0 * gap), 0.25, false),
            };
            let whole = found.approach + part * film.squeeze(gap, part, wall);
            let off = |found: f64| 100.0 * (found / exact - 1.0);
            println!(
                "{per_diameter:>6} {cells:>8} {:>8.4} {exact:>10.4} {:>10.4} {:>8.2} {whole:>12.4} {:>8.2} {:>10.4} {:>10.4} {:>8.1}",
                2.0 * gap,
                found.approach,
                off(found.approach),
                off(whole),
                found.sliding,
                found.turning,
                watch.elapsed().cpu
            );
        }
    }
    Ok(())
}

/// A sphere that sinks onto a wall.
fn sink() -> Outcome<()> {
    println!("\nSphere sinking onto a wall: net weight over 6πμRU");
    println!(
        "{:>6} {:>8} {:>8} {:>10} {:>10} {:>8} {:>12} {:>8}",
        "per d", "δ/h", "δ/R", "exact", "grid", "off, %", "with model", "off, %"
    );
    for per_diameter in [8, 12, 16] {
        let bare = sinking(per_diameter, Chen::default(), [1.2, 0.045], 0.1)?;
        let film = SmoothFilm::new(1.0 / per_diameter as f64)?;
        let whole = sinking(per_diameter, Lubricated::new(Chen::default(), 1.0, film)?, [1.2, 0.045], 0.1)?;
        for gap in [1.0, 0.5, 0.3, 0.2, 0.1, 0.05] {
            let exact = brenner(gap);
            let at = |series: &[[f64; 2]]| series.iter().find(|s| s[0] <= gap).map_or(f64::NAN, |s| s[1]);
            let [grid, with] = [at(&bare), at(&whole)];
            let off = |found: f64| 100.0 * (found / exact - 1.0);
            println!(
                "{per_diameter:>6} {:>8.2} {gap:>8} {exact:>10.4} {grid:>10.4} {:>8.2} {with:>12.4} {:>8.2}",
                0.5 * gap * per_diameter as f64,
                off(grid),
                off(with)
            );
        }
    }
    Ok(())
}
