//! Overlap of two bodies: error of the volume and of the normal against CPU time, route by route:
//! `cargo bench --bench overlap` (some minutes; `-- cubes` takes only the cases with this word).
//!
//! Every case is a pair in twelve random poses in which the bodies share a certain part of the smaller one, 2 % unless said. Errors are the
//! largest of the twelve, times the median. Routes that are exact are off by what rounding leaves. The table also goes to
//! out/overlap/work.csv and, if all cases are run, is drawn to docs/images/overlap.png.
mod cases;
mod poses;

use cases::{Case, Way};
use cpu_time::ProcessTime;
use poses::{Placed, poses};
use render::plot::{self, Panel, Series};
use siltflow::dem::{Overlap, OverlapSolver, Shape};
use siltflow::interfaces::Pose;
use std::fmt::Write as _;
use std::path::Path;
use validation::Outcome;

/// What a way costs, and what it is worth.
struct Row {
    way: &'static str,
    setting: String,
    /// Relative, of the volume.
    error: f64,
    /// Of the normal \[°\].
    degrees: f64,
    /// CPU µs per pair.
    cost: f64,
}

/// Volume and normal of all that two bodies share.
fn whole(patches: &[Overlap]) -> (f64, siltflow::interfaces::Vector) {
    let volume = patches.iter().map(|p| p.volume).sum();
    let largest = patches.iter().max_by(|p, q| p.volume.total_cmp(&q.volume));
    (volume, largest.map_or_else(Default::default, |p| p.normal))
}

/// CPU µs per call, the best of five runs: the clock is shared.
fn time(solver: &mut OverlapSolver, a: &dyn Shape, b: &dyn Shape, at: &Placed) -> f64 {
    let mut run = |n: u32| {
        let start = ProcessTime::now();
        for _ in 0..n {
            let found = solver.solve(a, &at.a, std::hint::black_box(b), &at.b).map(<[_]>::len);
            let _ = std::hint::black_box(found);
        }
        start.elapsed().as_secs_f64() * 1e6 / f64::from(n)
    };
    let n = (2e3 / run(2).max(1e-2)).clamp(1.0, 2e4) as u32;
    (0..5).map(|_| run(n)).fold(f64::INFINITY, f64::min)
}

fn median(mut all: Vec<f64>) -> f64 {
    all.sort_by(f64::total_cmp);
    all[all.len() / 2]
}

fn measure(case: &mut Case, way: &mut Way, placed: &[Placed]) -> Outcome<Row> {
    let (a, b) = (&*case.a, &*case.b);
    let (mut error, mut degrees, mut times) = (0.0_f64, 0.0_f64, Vec::new());
    for at in placed {
        // Exact routes are compared with themselves after a common turn, which rounds all numbers anew.
        let turn = at.turned();
        let reference = whole(case.reference.solve(a, &turn.a, b, &turn.b)?);
        let found = whole(way.solver.solve(a, &at.a, b, &at.b)?);
        let normal = at.common_turn().inverse() * reference.1;
        error = error.max((found.0 / reference.0 - 1.0).abs());
        degrees = degrees.max(found.1.cross(&normal).norm().atan2(found.1.dot(&normal)).to_degrees());
        times.push(time(&mut way.solver, a, b, at));
    }
    Ok(Row { way: way.label, setting: way.setting.clone(), error, degrees, cost: median(times) })
}

/// One line per way, its points in the order of their settings.
fn panel(title: &str, rows: &[Row]) -> Panel {
    let mut series: Vec<Series> = Vec::new();
    // The plane fit changes the normal only.
    for row in rows.iter().filter(|r| r.way != cases::PLANE_FIT) {
        let point = (row.cost, row.error.max(1e-16), row.setting.clone());
        match series.iter_mut().find(|s| s.label == row.way) {
            Some(s) => s.points.push(point),
            None => series.push(Series { label: row.way.into(), points: vec![point], ours: true }),
        }
    }
    Panel {
        title: title.into(),
        x: "CPU time per pair in µs".into(),
        y: "relative error of the volume".into(),
        series,
    }
}

fn main() -> Outcome<()> {
    let word = std::env::args().skip(1).find(|word| !word.starts_with('-'));
    let wanted = |case: &Case| word.as_ref().is_none_or(|word| case.name.contains(word));
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut csv =
        String::from("case,way,setting,relative error of volume,error of normal [deg],CPU us per pair\n");
    let mut panels = Vec::new();
    for mut case in cases::all()?.into_iter().filter(wanted) {
        println!(
            "\n{}\n{:>34} {:>8} {:>11} {:>10} {:>11}",
            case.name, "", "", "error", "normal, °", "CPU µs"
        );
        let placed = poses(&mut case)?;
        let mut rows = Vec::new();
        for mut way in std::mem::take(&mut case.ways) {
            let row = measure(&mut case, &mut way, &placed)?;
            let Row { way, setting, error, degrees, cost } = &row;
            println!("{way:>34} {setting:>8} {error:>11.1e} {degrees:>10.1e} {cost:>11.3}");
            writeln!(csv, "\"{}\",\"{way}\",{setting},{error:.3e},{degrees:.3e},{cost:.4}", case.name)?;
            rows.push(row);
        }
        panels.push(panel(case.name, &rows));
    }
    let folder = root.join("out/overlap");
    std::fs::create_dir_all(&folder)?;
    std::fs::write(folder.join("work.csv"), csv)?;
    println!("\nwritten to {}", folder.join("work.csv").display());
    if word.is_none() {
        let path = root.join("docs/images/overlap.png");
        plot::draw(&path, &panels)?;
        println!("drawn to {}", path.display());
    }
    Ok(())
}

impl Placed {
    /// Both turned together.
    fn turned(&self) -> Self {
        let turn = self.common_turn();
        let pose = |at: &Pose| Pose { position: turn * at.position, orientation: turn * at.orientation };
        Self { a: pose(&self.a), b: pose(&self.b) }
    }
}
