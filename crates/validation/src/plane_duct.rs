//! A plane duct whose walls are immersed, anywhere on the grid.
use crate::Outcome;
use fv_mesh::{
    Axis, CartesianGrid, Convection, Fluid, Modelled, Profile, Side, Simple, SimpleParams, TransportParams,
    WallStress,
};
use ibm::{StaticBodies, cut_cells};
use interfaces::{Aabb, Point, Pose, Solid, Vector};
use turb::{Inflow, Law, TwoEquation};

/// All that is more than `half` away from a line through `at`, which rises by `angle` \[rad\].
#[derive(Clone, Copy, Debug)]
pub struct PlaneDuct {
    /// Half its height \[m\].
    pub half: f64,
    /// Of the line against x.
    pub angle: f64,
    /// On the line \[m\].
    pub at: [f64; 2],
}

impl PlaneDuct {
    /// Height over the line \[m\].
    pub fn height(&self, [x, y]: [f64; 2]) -> f64 {
        (y - self.at[1]) * self.angle.cos() - (x - self.at[0]) * self.angle.sin()
    }

    /// Distance from the nearest wall, positive in the fluid \[m\].
    pub fn distance(&self, x: [f64; 2]) -> f64 {
        self.half - self.height(x).abs()
    }
}

impl Solid for PlaneDuct {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        self.distance([x.x, x.y])
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(10.0, 10.0, 0.0))
    }
}

/// Fluid enters a duct along x at speed 1 with 5 % turbulence; it is 6 long, with 60 cells, and `cells` of height 1/`cells` high, and both walls are
/// so much of a cell `behind` lines of the grid.
///
/// # Errors
/// Those of the flow, the walls and the model.
pub fn turbulent_duct<L: Law>(
    law: L,
    cells: usize,
    re: f64,
    behind: f64,
    outlet: Side,
) -> Outcome<(Simple<2>, Modelled<2, TwoEquation<L>>)> {
    let (h, margin) = (1.0 / cells as f64, 3);
    let across = cells + 2 * margin;
    let y = Axis::uniform(across, -(margin as f64) * h, 1.0 + margin as f64 * h)?;
    let grid = CartesianGrid::from_axes([Axis::uniform(60, 0.0, 6.0)?, y])?;
    let sides = [[Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0])), outlet], Side::FreeSlip.both()];
    let mut flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity: 1.0 / re })?
        .with_convection(Convection::Quick)
        .with_params(SimpleParams::turbulent())?;
    let duct = PlaneDuct { half: 0.5 + behind * h, angle: 0.0, at: [0.0, 0.5] };
    let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(duct, Pose::at([0.0; 3])))?;
    flow.set_walls(Some((&cuts, WallStress::LAW_OF_THE_WALL)))?;
    flow.set_velocity(|_| [1.0, 0.0]);
    let model = TwoEquation::new(law, grid.n_cells(), Inflow::from_length(1.0, 0.05, 0.07)?)?;
    let mut model = Modelled::new(model, &grid, flow.sides(), TransportParams::steady())?;
    for (cell, distance) in model.transport_mut().wall_distance_mut().iter_mut().enumerate() {
        *distance = duct.distance(grid.centre(grid.cell(cell))).max(0.0);
    }
    Ok((flow, model))
}
