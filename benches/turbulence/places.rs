//! Walls along the grid, wherever they cut its cells.
use siltflow::flow::Side;
use turb::{Law, Realizable, Sst, StandardKEpsilon, Wilcox};
use validation::Outcome;
use validation::plane_duct::turbulent_duct;
use validation::turbulent_flows::iterate;

const PLACES: [f64; 17] =
    [0.0, 1e-4, 0.002, 0.009, 0.019, 0.029, 0.06, 0.1, 0.11, 0.3, 0.5, 0.7, 0.9, 0.97, 0.99, 0.998, 0.9999];

/// Iterations until a duct comes to rest.
pub(crate) fn places() -> Outcome<()> {
    println!(
        "\nDuct along the grid, walls so much of a cell behind its lines: iterations to residuals of 1e-5"
    );
    print!("{:>16} {:>6} {:>6} {:>10}", "model", "cells", "Re", "outlet");
    PLACES.iter().for_each(|place| print!(" {place:>6}"));
    println!();
    for (cells, re) in [(40, 1e6), (20, 1e5), (20, 1e4)] {
        of_model("k-omega SST", Sst::default(), cells, re)?;
        of_model("k-omega", Wilcox::openfoam(), cells, re)?;
        of_model("k-epsilon", StandardKEpsilon::default(), cells, re)?;
        of_model("realizable k-eps", Realizable::default(), cells, re)?;
    }
    Ok(())
}

fn of_model<L: Law>(name: &str, law: L, cells: usize, re: f64) -> Outcome<()> {
    for (outlet, side) in [(Side::ConvectiveOutlet, "convective"), (Side::PressureOutlet(0.0), "pressure")] {
        print!("{name:>16} {cells:>6} {re:>6.0e} {side:>10}");
        for place in PLACES {
            let (mut flow, mut model) = turbulent_duct(law.clone(), cells, re, place, outlet.clone())?;
            let told = match iterate(&mut flow, &mut model, 600, 1e-5) {
                Ok((info, true)) => info.iterations.to_string(),
                Ok((info, false)) => format!("{:.0e}", info.largest()),
                Err(_) => "error".into(),
            };
            print!(" {told:>6}");
        }
        println!();
    }
    Ok(())
}
