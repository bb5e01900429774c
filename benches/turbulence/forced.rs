//! Friction where the flow along a wall speeds up and slows down.
use siltflow::flow::WallStress;
use siltflow::interfaces::LawOfTheWall;
use turb::{Law, Sst, Wilcox};
use validation::Outcome;
use validation::forced_duct::{DuctWalls, ForcedDuct};

/// Along the stream \[m/s²\]: past the first the flow along the walls is faster by a fourth, past the second slower by as much.
const FORCES: [f64; 2] = [-1.5, 1.6];

/// A duct with a force in its middle against itself with cells that resolve the layers: by how much friction is off before it, and at least and at most past it
/// (over what it is before), with walls that are sides of the box or immersed, whose law takes so much from the velocity.
pub(crate) fn forced() -> Outcome<()> {
    println!(
        "\nFriction past a force in the middle of a duct, Re 1e6, against cells that resolve the layers"
    );
    println!(
        "{:>8} {:>6} {:>6} {:>14} {:>22} {:>22} {:>22}",
        "model", "force", "cells", "walls", "w 0", "w 0.4", "w 1"
    );
    for force in FORCES {
        of_model("SST", Sst::default(), force)?;
        of_model("k-omega", Wilcox::openfoam(), force)?;
    }
    Ok(())
}

fn of_model<L: Law>(name: &str, law: L, force: f64) -> Outcome<()> {
    let fine = ForcedDuct::new(law.clone(), DuctWalls::Sides(Some(2e-5)), 160, force)?;
    let tell = |walls: DuctWalls, cells: usize| -> Outcome<()> {
        let off = ForcedDuct::new(law.clone(), walls, cells, force)?.off(&fine);
        let [before, low, high] = off.map(|o| format!("{:+.1}", 100.0 * o));
        print!(" {:>22}", format!("{before} ({low} to {high})"));
        Ok(())
    };
    let case = |cells: usize, walls: &str| print!("{name:>8} {force:>6} {cells:>6} {walls:>14}");
    for cells in [40, 80, 160] {
        case(cells, "sides");
        tell(DuctWalls::Sides(None), cells)?;
        println!();
        for behind in [0.0, 0.3, 0.7] {
            case(cells, &format!("{behind} behind"));
            for velocity_weight in [0.0, 0.4, 1.0] {
                let stress = WallStress::Law { law: LawOfTheWall::USUAL, distance: 0.5, velocity_weight };
                tell(DuctWalls::Immersed(behind, stress), cells)?;
            }
            println!();
        }
    }
    for first in [0.003, 0.0015] {
        case(160, &format!("sides, {first}"));
        tell(DuctWalls::Sides(Some(first)), 160)?;
        println!();
    }
    Ok(())
}
