//! Every validation case on three grids, with its grid convergence index: `cargo bench -p siltflow-fv-mesh --bench validation`
//! (about three minutes on one thread; `-- cavity` runs the cases whose name holds that word).
//!
//! Per case and grid: the value found, the reference, the error, CPU seconds. Then the observed order p and the grid
//! convergence index GCI = 1.25 |f₁ − f₂| / (|f₁| (r^p − 1)) of the finest grid (Roache 1994), r the refinement ratio;
//! p is taken from the three values and held within 0.5 … 3.
mod cases;
#[path = "../support/centrelines.rs"]
mod centrelines;

use cpu_time::ProcessTime;

/// What a case found on one grid.
pub(crate) struct Found {
    /// The value whose convergence is judged.
    pub(crate) value: f64,
    /// Its error as the case defines it.
    pub(crate) error: f64,
    /// Cells of the grid.
    pub(crate) cells: usize,
}

/// A case: what is measured, against what, and how.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    /// What `value` is, and its reference.
    pub(crate) what: &'static str,
    pub(crate) reference: f64,
    /// Numbers of cells along an axis, coarse to fine.
    pub(crate) grids: [usize; 3],
    pub(crate) run: fn(usize) -> Result<Found, fv_mesh::FlowError>,
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    println!(
        "{:<46} {:>9} {:>13} {:>13} {:>10} {:>8} {:>6} {:>9}",
        "case", "cells", "value", "reference", "error", "CPU s", "order", "GCI"
    );
    for case in
        cases::ALL.iter().filter(|c| wanted.is_empty() || wanted.iter().any(|w| c.name.contains(w.as_str())))
    {
        let mut values = Vec::new();
        for (i, &n) in case.grids.iter().enumerate() {
            let start = ProcessTime::now();
            let Found { value, error, cells } = pool.install(|| (case.run)(n))?;
            values.push(value);
            let mut line = format!(
                "{:<46} {cells:>9} {value:>13.7} {:>13.7} {error:>10.2e} {:>8.2}",
                if i == 0 { format!("{}: {}", case.name, case.what) } else { String::new() },
                case.reference,
                start.elapsed().as_secs_f64()
            );
            if i == 2 {
                let ratio = case.grids[2] as f64 / case.grids[1] as f64;
                let (coarse, fine) = (values[0] - values[1], values[1] - values[2]);
                let order = ((coarse / fine).abs().ln() / ratio.ln()).clamp(0.5, 3.0);
                let gci = 1.25 * fine.abs() / (values[2].abs().max(1e-30) * (ratio.powf(order) - 1.0));
                line += &format!(" {order:>6.2} {:>8.4}%", 100.0 * gci);
            }
            println!("{line}");
        }
    }
    Ok(())
}
