//! Heat in developed flow between immersed walls that are turned against the grid.
use turb::Sst;
use validation::Outcome;
use validation::developed_duct::DevelopedDuct;

/// A scalar that is to be the velocity (Pr = Pr_t = 1, the force its source) in ducts turned by 0 to 45°: what the walls take of what the source brings, and how far it is
/// from the velocity along the ducts.
pub(crate) fn warm_ducts() -> Outcome<()> {
    println!("\nReynolds' analogy in ducts turned against the grid, SST");
    println!("{:>6} {:>6} {:>6} {:>7} {:>11} {:>10}", "Re", "angle", "cells", "y+", "heat taken", "mean off");
    for viscosity in [1e-6, 1e-5, 1e-4] {
        for angle in [0.0, 15.0, 30.0, 45.0] {
            for cells in [20, 40] {
                let mut duct = DevelopedDuct::new(Sst::default(), angle, cells, 0.3, viscosity, 5e-3)?;
                let [taken, off] = duct.analogy()?;
                println!(
                    "{:>6.0e} {angle:>6} {cells:>6} {:>7.1} {:>9.3} % {:>8.2} %",
                    1.0 / viscosity,
                    duct.model.closure.y_plus().mean,
                    100.0 * taken,
                    100.0 * off
                );
            }
        }
    }
    Ok(())
}
