//! What the height of the first cells does to friction, from the viscous sublayer to the logarithmic layer.
use example_support::Outcome;
use example_support::turbulent_flows::{between_walls, steady_couette};
use siltflow::flow::Axis;
use turb::{Law, Sst, Sublayer, WallFunctions, Wilcox};

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
            let y_plus = steady_couette(Sst::default(), default, Axis::uniform(cells, 0.0, 1.0)?, nu)?.1.mean;
            println!(
                "{:>6.0e} {cells:>6} {y_plus:>8.1} {:>7.1} % {:>7.1} % {:>14.1} %",
                1.0 / nu,
                off(Sst::default(), default, cells, nu, sst)?,
                off(Wilcox::default(), default, cells, nu, wilcox)?,
                off(Sst::default(), linear, cells, nu, sst)?
            );
        }
    }
    Ok(())
}

/// How far friction is from that of fine cells \[%\].
fn off<L: Law>(law: L, functions: WallFunctions, cells: usize, nu: f64, fine: f64) -> Outcome<f64> {
    let (friction, _) = steady_couette(law, functions, Axis::uniform(cells, 0.0, 1.0)?, nu)?;
    Ok(100.0 * (friction / fine - 1.0))
}
