//! Turbulent plane Couette flow: a plate that slides through the box against a wall of the box.
use render::cpu::Stopwatch;
use turb::{Inflow, Law, Realizable, Sst, StandardKEpsilon, Wilcox};
use validation::Outcome;
use validation::sliding_plate::{Couette, Lower};

pub(crate) fn sliding_plate() -> Outcome<()> {
    println!(
        "\nTurbulent plane Couette flow: the lower wall is a plate in the box, against a side of the box; 40 cells across"
    );
    println!(
        "{:>16} {:>7} {:>6} {:>6} {:>6} | {:>9} {:>9} | {:>8} {:>8} {:>8} {:>8} | {:>7}",
        "model",
        "nu",
        "y+",
        "at",
        "drift",
        "friction",
        "upper",
        "u 0.1",
        "u 0.5",
        "k 0.2",
        "nu_t 0.5",
        "CPU s"
    );
    for viscosity in [1e-6, 1e-5, 1e-4] {
        of_model("k-omega SST", Sst::default(), viscosity, 0.3)?;
    }
    of_model("k-omega", Wilcox::default(), 1e-5, 0.3)?;
    of_model("k-epsilon", StandardKEpsilon::default(), 1e-5, 0.1)?;
    of_model("realizable k-eps", Realizable::default(), 1e-5, 0.1)
}

fn of_model<L: Law>(name: &str, law: L, viscosity: f64, courant: f64) -> Outcome<()> {
    let couette =
        Couette { cells: 40, viscosity, start: Inflow { k: 3e-3, omega: 1.0 }, time: 150.0, courant };
    let side = couette.run(law.clone(), Lower::Side, 0.0)?;
    let y_plus = 0.5 / 40.0 * side.friction[0].sqrt() / viscosity;
    for (share, drift) in [(0.0, 0.0), (0.25, 0.0), (0.5, 0.0), (0.75, 0.0), (0.5, -0.5)] {
        let watch = Stopwatch::start();
        let plate = couette.run(law.clone(), Lower::Plate(share), drift)?;
        let off = |a: &[f64], b: &[f64], y: f64| 100.0 * (plate.at(a, y) / side.at(b, y) - 1.0);
        println!(
            "{name:>16} {viscosity:>7.0e} {y_plus:>6.1} {share:>6} {drift:>6} | {:>8.2}% {:>8.2}% | {:>7.2}% {:>7.2}% {:>7.2}% {:>7.2}% | {:>7.1}",
            100.0 * (plate.friction[0].abs() / side.friction[0] - 1.0),
            100.0 * (plate.friction[1] / side.friction[1] - 1.0),
            off(&plate.u, &side.u, 0.1),
            off(&plate.u, &side.u, 0.5),
            off(&plate.k, &side.k, 0.2),
            off(&plate.nu_t, &side.nu_t, 0.5),
            watch.elapsed().cpu
        );
    }
    Ok(())
}
