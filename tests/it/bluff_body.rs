//! A cylinder in a turbulent stream, with its walls immersed.
use siltflow::dem::Disc;
use siltflow::flow::{
    Axis, CartesianGrid, Convection, Fluid, Modelled, Profile, Side, Simple, SimpleParams, TransportParams,
    WallStress,
};
use siltflow::ibm::{StaticBodies, cut_cells};
use siltflow::interfaces::Pose;
use turb::{Inflow, KOmegaSst, Sst};
use validation::axes::gathered;

/// Of half a cylinder at Re 10⁴ with so many cells per diameter: Cd, and friction's part of it.
fn drag(cells: usize, stress: WallStress) -> [f64; 2] {
    let (h, re) = (1.0 / cells as f64, 1e4);
    let x = gathered(50.0, h, [9.2, 11.5], 1.1, 0.0).unwrap();
    let both = gathered(40.0, h, [19.2, 20.8], 1.1, 0.0).unwrap();
    let y: Vec<_> = both.faces().iter().map(|y| y - 20.0).filter(|y| *y > -1e-9).collect();
    let grid = CartesianGrid::from_axes([x, Axis::from_faces(y).unwrap()]).unwrap();
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let sides = [[inlet, Side::PressureOutlet(0.0)], Side::FreeSlip.both()];
    let params = SimpleParams { velocity_relaxation: 0.9, viscous_share: 0.03, ..SimpleParams::turbulent() };
    let mut flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity: 1.0 / re })
        .unwrap()
        .with_convection(Convection::Quick)
        .with_params(params)
        .unwrap();
    let walls = StaticBodies::new().with(Disc::new(0.5).unwrap(), Pose::at([10.0, 0.0, 0.0]));
    let cuts = cut_cells(flow.velocity(), &walls).unwrap();
    flow.set_walls(Some((&cuts, stress))).unwrap();
    flow.set_velocity(|_| [1.0, 0.0]);
    let inflow = Inflow::from_viscosity_ratio(1.0, 0.05, 100.0, 1.0 / re).unwrap();
    let closure = KOmegaSst::new(Sst::default(), grid.n_cells(), inflow).unwrap();
    let mut model = Modelled::new(closure, flow.grid(), flow.sides(), TransportParams::steady()).unwrap();
    for (i, distance) in model.transport_mut().wall_distance_mut().iter_mut().enumerate() {
        let [x, y] = grid.centre(grid.cell(i));
        *distance = ((x - 10.0).hypot(y) - 0.5).max(0.0);
    }
    // Not at rest by then where relaxation counts all of the viscous terms.
    flow.solve_with(&mut model, 700, 1e-4).unwrap();
    // Of half a cylinder: Cd = F/(½ρU² D/2).
    let friction = 4.0 * flow.wall_friction()[0].force.x;
    [friction + 4.0 * flow.wall_pressure_force()[0].force.x, friction]
}

/// 80 cells per diameter (y+ 0 to 11): wall-resolved body-fitted cells (simpleFoam, SST) have Cd 0.772, of which friction 0.022; ours 0.764 and 0.017. Where velocities
/// beside walls are reconstructed without the wall Cd is 0.32, where momentum there is carried with errors of second order 0.86 and 0.011, and from a stream that passes
/// through the cylinder, not freed of its divergence, the iterations diverge.
#[test]
fn the_layer_of_a_cylinder_separates() {
    let [cd, friction] = drag(80, WallStress::LAW_OF_THE_WALL);
    assert!((cd / 0.772 - 1.0).abs() < 0.04, "{cd} {friction}");
    assert!((friction / 0.022 - 1.0).abs() < 0.3, "{cd} {friction}");
}

/// With half as many cells the layer is one cell thick: by the law of the wall the drag is 38 % too small, of fluid that sticks to the wall 9 %.
#[test]
fn a_layer_as_thin_as_cells_separates_where_the_fluid_sticks_to_the_wall() {
    let [cd, friction] = drag(40, WallStress::NoSlip);
    assert!((cd / 0.772 - 1.0).abs() < 0.12, "{cd} {friction}");
}
