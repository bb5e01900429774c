//! What models cost, and what they bear.
use render::cpu::Stopwatch;
use turb::{Inflow, Law, Realizable, Sst, StandardKEpsilon, Wilcox};
use validation::Outcome;
use validation::turbulent_flows::{duct, iterate};

/// Of the reference runs.
fn inflow() -> Outcome<Inflow> {
    Ok(Inflow::from_length(1.0, 0.05, 0.07)?)
}

/// A duct of 200 × 40 cells, across those of mesh c, to residuals of 10⁻⁵.
pub(crate) fn cost() -> Outcome<()> {
    println!("\nDuct of 15 heights at Re 1e6, 200 x 40 cells, from uniform flow to residuals of 1e-5");
    println!("{:>16} {:>6} {:>7} {:>11} {:>9}", "model", "its", "CPU s", "us/cell/it", "u, outlet");
    of_model("k-omega SST", Sst::default())?;
    of_model("k-omega", Wilcox::openfoam())?;
    of_model("k-epsilon", StandardKEpsilon::default())?;
    of_model("realizable k-eps", Realizable::default())
}

fn of_model<L: Law>(name: &str, law: L) -> Outcome<()> {
    let mut best = f64::INFINITY;
    let (mut iterations, mut middle) = (0, 0.0);
    for _ in 0..3 {
        let (mut flow, mut model) = duct(law.clone(), [200, 40], 3e-3, inflow()?)?;
        flow.set_velocity(|_| [1.0, 0.0]);
        let watch = Stopwatch::start();
        let (info, done) = iterate(&mut flow, &mut model, 1000, 1e-5)?;
        if !done {
            return Err(format!("{name}: {info:?}").into());
        }
        best = best.min(watch.elapsed().cpu);
        iterations = info.iterations;
        middle = flow.velocity().field(0).row(20)[199];
    }
    let each = 1e6 * best / (iterations * 8000) as f64;
    println!("{name:>16} {iterations:>6} {best:>7.2} {each:>11.3} {middle:>9.4}");
    Ok(())
}

/// From rest, with a hundred times the k that the inflow should have or a hundredth, and on cells of y+ 0.1 and 1000.
pub(crate) fn bad_starts() -> Outcome<()> {
    println!("\nDuct at Re 1e6, 60 cells along it: iterations to residuals of 1e-5, or what stopped them");
    println!("{:>16} {:>28} {:>24} {:>8} {:>9}", "model", "start", "y+", "its", "residual");
    of_start("k-omega SST", Sst::default())?;
    of_start("k-omega", Wilcox::openfoam())?;
    of_start("k-epsilon", StandardKEpsilon::default())?;
    of_start("realizable k-eps", Realizable::default())
}

fn of_start<L: Law>(name: &str, law: L) -> Outcome<()> {
    let good = inflow()?;
    let times = |f: f64| Inflow { k: f * good.k, ..good };
    for (what, cells, first, inflow, start, speed) in [
        ("from rest", 40, 3e-3, good, good, 0.0),
        ("100 k at first", 40, 3e-3, good, times(100.0), 1.0),
        ("k/100 at first", 40, 3e-3, good, times(0.01), 1.0),
        ("100 k enters", 40, 3e-3, times(100.0), times(100.0), 1.0),
        ("cells of y+ 0.1", 120, 5.6e-6, good, good, 1.0),
        ("cells of y+ 5", 80, 2.8e-4, good, good, 1.0),
        ("cells of y+ 1000", 16, 5.6e-2, good, good, 1.0),
    ] {
        let (mut flow, mut model) = duct(law.clone(), [60, cells], first, inflow)?;
        flow.set_velocity(|_| [speed, 0.0]);
        model.closure.fill(start)?;
        let (its, residual) = match iterate(&mut flow, &mut model, 3000, 1e-5) {
            Ok((info, true)) => (info.iterations.to_string(), info.largest()),
            Ok((info, false)) => (format!("> {}", info.iterations), info.largest()),
            Err(error) => (format!("{error}"), f64::NAN),
        };
        let y = model.closure.y_plus();
        println!(
            "{name:>16} {what:>28} {:>24} {its:>8} {residual:>9.1e}",
            format!("{:.2} to {:.2}", y.least, y.most)
        );
    }
    Ok(())
}
