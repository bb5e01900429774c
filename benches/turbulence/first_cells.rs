//! What the height of the first cells does to friction, from the viscous sublayer to the logarithmic layer.
use siltflow::flow::Axis;
use turb::{Sst, Sublayer, WallFunctions, Wilcox};
use validation::Outcome;
use validation::turbulent_flows::{between_walls, steady_couette};

/// Plane Couette flow at Re 10⁴ and 10⁵ (speed and distance of the walls), even cells, against 200 cells that begin at y+ 0.1.
pub(crate) fn first_cells() -> Outcome<()> {
    println!("\nPlane Couette flow, even cells: friction against that of 200 cells that begin at y+ 0.1");
    println!(
        "{:>6} {:>6} {:>8} {:>9} {:>9} {:>16}",
        "Re", "cells", "y+", "SST", "k-omega", "SST, omega linear"
    );
    for (nu, u_tau) in [(1e-4, 0.0282), (1e-5, 0.0218)] {
        let fine = || between_walls(200, 1.0, 0.2 * nu / u_tau);
        let default = WallFunctions::default();
        let linear = WallFunctions { sublayer: Sublayer::Linear, ..default };
        let (sst, _) = steady_couette(Sst::default(), default, fine()?, nu)?;
        let (wilcox, _) = steady_couette(Wilcox::default(), default, fine()?, nu)?;
        println!("{:>6.0e} {:>6} {:>8.1} {sst:>9.3e} {wilcox:>9.3e}", 1.0 / nu, 200, 0.1);
        for cells in [160, 113, 80, 56, 40, 28, 20, 14, 10] {
            let even = || Axis::uniform(cells, 0.0, 1.0);
            let (of_sst, y_plus) = steady_couette(Sst::default(), default, even()?, nu)?;
            let (of_wilcox, _) = steady_couette(Wilcox::default(), default, even()?, nu)?;
            let (of_linear, _) = steady_couette(Sst::default(), linear, even()?, nu)?;
            let off = |friction: f64, fine: f64| 100.0 * (friction / fine - 1.0);
            println!(
                "{:>6.0e} {cells:>6} {:>8.1} {:>7.1} % {:>7.1} % {:>14.1} %",
                1.0 / nu,
                y_plus.mean,
                off(of_sst, sst),
                off(of_wilcox, wilcox),
                off(of_linear, sst)
            );
        }
    }
    Ok(())
}
