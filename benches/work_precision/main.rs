//! Error against run time, on one thread: `cargo bench --bench work_precision` (about six minutes; `-- flows`, `-- cylinder`
//! and `-- discs` run one part; only when named: `-- settling`, half an hour, and `-- algorithms`).
//!
//! 1. flows: fluid alone. Taylor–Green vortices and a shear layer in periodic boxes, the lid-driven cavity ([`flows`]).
//! 2. cylinder: an immersed cylinder in a channel, steady ([`cylinder`]).
//! 3. discs: the falling discs ([`discs`]).
//! 4. settling: one sphere, and 64 ([`settling`]).
//! 5. algorithms: the falling discs by the paper's algorithm and by ours, with their books ([`algorithms`]).
//!
//! Reference points of other codes stand in the same tables. With `-- plot` (or without any part named) 1 and 2 are drawn to
//! docs/images/work_precision.png.
mod algorithms;
mod cylinder;
mod discs;
mod flows;
mod settling;

use render::plot::{self, Panel, Series};
use std::path::Path;
use validation::Outcome;

/// What a run costs and what it is worth.
#[derive(Clone, Debug)]
pub(crate) struct Point {
    /// The grid, for tables and plots.
    pub(crate) grid: String,
    pub(crate) error: f64,
    /// CPU seconds, set-up included.
    pub(crate) cpu: f64,
}

impl Point {
    pub(crate) fn new(grid: impl Into<String>, error: f64, cpu: f64) -> Self {
        Self { grid: grid.into(), error, cpu }
    }
}

/// Runs of one code or kind.
#[derive(Clone, Debug)]
pub(crate) struct Runs {
    pub(crate) label: &'static str,
    pub(crate) ours: bool,
    pub(crate) points: Vec<Point>,
}

/// Runs of one case.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    pub(crate) title: &'static str,
    /// What the error is of.
    pub(crate) error: &'static str,
    pub(crate) runs: Vec<Runs>,
}

impl Table {
    fn print(&self) {
        println!(
            "\n{}: {}\n{:>34} {:>10} {:>11} {:>10}",
            self.title, self.error, "", "grid", "error", "CPU s"
        );
        for Runs { label, points, .. } in &self.runs {
            for Point { grid, error, cpu } in points {
                println!("{label:>34} {grid:>10} {error:>11.2e} {cpu:>10.4}");
            }
        }
    }

    fn panel(&self) -> Panel {
        let series = |runs: &Runs| Series {
            label: runs.label.into(),
            points: runs.points.iter().map(|p| (p.cpu, p.error, p.grid.clone())).collect(),
            ours: runs.ours,
        };
        Panel {
            title: self.title.into(),
            x: "CPU time in s".into(),
            y: self.error.into(),
            series: self.runs.iter().map(series).collect(),
        }
    }
}

fn main() -> Outcome<()> {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let runs = |part: &str| wanted.is_empty() || wanted.iter().any(|w| w == part);
    rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| {
        let mut tables = Vec::new();
        if runs("flows") || runs("plot") {
            tables.extend(flows::tables()?);
        }
        if runs("cylinder") || runs("plot") {
            tables.extend(cylinder::tables()?);
        }
        tables.iter().for_each(Table::print);
        if runs("plot") {
            let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/images/work_precision.png");
            let panels: Vec<Panel> = tables.iter().map(Table::panel).collect();
            plot::draw(&path, &panels)?;
            println!("\ndrawn to {}", path.display());
        }
        if wanted.iter().any(|w| w == "settling") {
            settling::run()?;
        }
        if wanted.iter().any(|w| w == "algorithms") {
            algorithms::run()?;
        }
        if runs("discs") {
            discs::run()?;
        }
        Ok(())
    })
}
