//! Friction where the flow along a wall speeds up and slows down.
use example_support::Outcome;
use example_support::hindered_duct::{DuctWalls, HinderedDuct};
use siltflow::flow::WallStress;
use siltflow::interfaces::LawOfTheWall;
use turb::{Law, Sst, Wilcox};

/// A duct whose middle is hindered by a force, against itself with first cells at y+ 33: by how much friction is off before it, and at least and at most
/// past it, with walls that are sides of the box or immersed, whose law takes so much from the velocity.
pub(crate) fn hindered() -> Outcome<()> {
    println!(
        "\nFriction past a force in the middle of a duct, Re 1e6, against first cells of 0.0015; before it (least to largest)"
    );
    println!("{:>8} {:>6} {:>14} {:>22} {:>22} {:>22}", "model", "cells", "walls", "w 0", "w 0.4", "w 1");
    of_model("SST", Sst::default())?;
    of_model("k-omega", Wilcox::openfoam())
}

fn of_model<L: Law>(name: &str, law: L) -> Outcome<()> {
    let fine = HinderedDuct::new(law.clone(), DuctWalls::Sides(Some(0.0015)), 160)?;
    let tell = |walls: DuctWalls, cells: usize| -> Outcome<()> {
        let duct = HinderedDuct::new(law.clone(), walls, cells)?;
        let before = duct.friction(-0.9) / fine.friction(-0.9) - 1.0;
        let [low, high] = duct.off(&fine);
        let percent = [before, low, high].map(|o| format!("{:+.1}", 100.0 * o));
        print!(" {:>22}", format!("{} ({} to {})", percent[0], percent[1], percent[2]));
        Ok(())
    };
    for cells in [40, 80] {
        print!("{name:>8} {cells:>6} {:>14}", "sides");
        tell(DuctWalls::Sides(None), cells)?;
        println!();
        for behind in [0.0, 0.3, 0.49, 0.51, 0.7] {
            print!("{name:>8} {cells:>6} {:>14}", format!("{behind} behind"));
            for velocity_weight in [0.0, 0.4, 1.0] {
                let stress = WallStress::Law { law: LawOfTheWall::USUAL, distance: 0.5, velocity_weight };
                tell(DuctWalls::Immersed(behind, stress), cells)?;
            }
            println!();
        }
    }
    Ok(())
}
