//! A lid-driven cavity, without any particles.
use fv_mesh::{CartesianGrid, FlowError, Fluid, Projection, Side};

fn main() -> Result<(), FlowError> {
    let grid = CartesianGrid::new([32, 32], [1.0, 1.0])?;
    let lid = Side::Wall([1.0, 0.0, 0.0]);
    let fluid = Fluid { density: 1.0, viscosity: 0.01 };
    let mut flow = Projection::new(grid, [[Side::WALL, Side::WALL], [Side::WALL, lid]], fluid)?;
    while flow.time() < 5.0 {
        flow.advance(flow.stable_dt(0.3), [0.0, 0.0])?;
    }
    println!("fv-mesh: kinetic energy {:.4e} J", flow.statistics().kinetic_energy);
    Ok(())
}
