//! A duct with a force in its middle, past which the flow along the walls speeds up and slows down again, or the other way round.
use crate::Outcome;
use crate::plane_duct::PlaneDuct;
use crate::turbulent_flows::{between_walls, growing, iterate};
use fv_mesh::{
    Axis, CartesianGrid, Convection, Fluid, Modelled, Profile, Scalar, ScalarSide, Settling, Side, Simple,
    SimpleParams, TransportParams, WallStress,
};
use ibm::{StaticBodies, cut_cells};
use interfaces::{Closure, CutCells, Pose};
use turb::{Inflow, Law, TwoEquation};

/// Kinematic viscosity \[m²/s\].
const VISCOSITY: f64 = 1e-6;
/// The distance from the middle of the duct at which the force is 1/e of what it is there \[m\].
const RADIUS: f64 = 0.2;
/// Where cells are even along the duct, and the cells before and behind that.
const EVEN: [f64; 2] = [-1.2, 2.4];
const TAIL: usize = 60;

/// What the walls of the duct are.
#[derive(Clone, Copy, Debug)]
pub enum DuctWalls {
    /// Sides of the box; the first cells are so high \[m\], all of them 1/cells without it.
    Sides(Option<f64>),
    /// In cut cells, so much of a cell behind lines of the grid.
    Immersed(f64, WallStress),
}

/// The flow at rest.
pub struct ForcedDuct<L: Law> {
    flow: Simple<2>,
    model: Modelled<2, TwoEquation<L>>,
    cuts: Option<CutCells>,
    /// Places along the lower wall \[m\], and its friction over the density there \[m²/s²\].
    friction: Vec<[f64; 2]>,
}

impl<L: Law> ForcedDuct<L> {
    /// Of a duct of height 1 with so many cells across, at Re 10⁶, with this force on the fluid in its middle \[m/s²\].
    ///
    /// # Errors
    /// Those of the flow, the walls and the model, and if the flow does not come to rest.
    pub fn new(law: L, walls: DuctWalls, cells: usize, force: f64) -> Outcome<Self> {
        let h = 1.0 / cells as f64;
        let (y, side) = match walls {
            DuctWalls::Sides(Some(first)) => (between_walls(cells, 1.0, first)?, Side::WALL),
            DuctWalls::Sides(None) => (Axis::uniform(cells, 0.0, 1.0)?, Side::WALL),
            DuctWalls::Immersed(..) => (Axis::uniform(cells + 8, -4.0 * h, 1.0 + 4.0 * h)?, Side::FreeSlip),
        };
        let grid = CartesianGrid::from_axes([along(h)?, y])?;
        let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
        let sides = [[inlet, Side::PressureOutlet(0.0)], side.both()];
        let mut flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity: VISCOSITY })?
            .with_convection(Convection::Quick)
            .with_params(SimpleParams { velocity_relaxation: 0.9, ..SimpleParams::turbulent() })?;
        let model = TwoEquation::new(law, grid.n_cells(), Inflow::from_length(1.0, 0.05, 0.07)?)?;
        let mut model = Modelled::new(model, &grid, flow.sides(), TransportParams::steady())?;
        let mut immersed = None;
        if let DuctWalls::Immersed(behind, stress) = walls {
            let duct = PlaneDuct { half: 0.5 + behind * h, angle: 0.0, at: [0.0, 0.5] };
            let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(duct, Pose::at([0.0; 3])))?;
            flow.set_walls(Some((&cuts, stress)))?;
            immersed = Some(cuts);
            for (cell, distance) in model.transport_mut().wall_distance_mut().iter_mut().enumerate() {
                *distance = duct.distance(grid.centre(grid.cell(cell))).max(0.0);
            }
        }
        flow.set_velocity(|_| [1.0, 0.0]);
        flow.source_mut()[0]
            .set(|[x, y]| force * (-(x * x + (y - 0.5) * (y - 0.5)) / (RADIUS * RADIUS)).exp());
        let (info, rests) = iterate(&mut flow, &mut model, 2000, 1e-5)?;
        if !rests {
            return Err(format!("the flow is not at rest: {info:?}").into());
        }
        let mut friction: Vec<[f64; 2]> = match &immersed {
            Some(cuts) => {
                let all = cuts.walls.iter().zip(flow.wall_tractions()).filter(|(wall, _)| wall.foot.y < 0.5);
                all.map(|(wall, traction)| [wall.foot.x, traction.x]).collect()
            }
            None => {
                let all = model.wall_rows().iter().zip(model.closure.wall_viscosity());
                let all = all.map(|(row, nu_t)| (grid.centre(grid.cell(row.cell)), row, nu_t));
                let lower = all.filter(|(x, ..)| x[1] < 0.5);
                lower.map(|(x, row, nu_t)| [x[0], (VISCOSITY + nu_t) * row.u_t / row.y]).collect()
            }
        };
        friction.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Ok(Self { flow, model, cuts: immersed, friction })
    }

    /// At `x` along the wall \[m²/s²\].
    pub fn friction(&self, x: f64) -> f64 {
        let k = self.friction.partition_point(|at| at[0] < x).clamp(1, self.friction.len() - 1);
        let [[x0, f0], [x1, f1]] = [self.friction[k - 1], self.friction[k]];
        f0 + (f1 - f0) * (x - x0) / (x1 - x0)
    }

    /// Flux of warmth through sections of the duct at `x`, which enters at 1 and is 0 on the walls (Pr 0.7) \[m²/s\].
    ///
    /// # Errors
    /// Those of the scalar and the walls.
    pub fn warmth<const N: usize>(&mut self, x: [f64; N]) -> Outcome<[f64; N]> {
        let Self { flow, model, cuts, .. } = self;
        let grid = flow.grid();
        let ends = [ScalarSide::value(1.0), ScalarSide::NO_GRADIENT];
        let sides = if cuts.is_some() { ScalarSide::NO_GRADIENT } else { ScalarSide::value(0.0) };
        let mut warmth =
            Scalar::new(grid, [ends, sides.both()], VISCOSITY / 0.7)?.with_convection(Convection::Quick);
        warmth.set_walls(cuts.as_ref().map(|cuts| (cuts, 0.0)))?;
        warmth.mix(model.eddy_stress(VISCOSITY, 0.0)?.ok_or("a model without eddy viscosity")?, VISCOSITY);
        if cuts.is_some() {
            warmth.rub(&flow.wall_friction_velocities(), VISCOSITY)?;
        }
        let settling = Settling { tolerance: 1e-7, max_iterations: 10_000 };
        warmth.settle(flow.velocity(), 0.0, settling, &[], |_| ())?;
        let (u, phi) = (flow.velocity().field(0), warmth.field());
        Ok(x.map(|x| {
            let i = (0..grid.cells()[0] - 1).find(|&i| grid.axis(0).centre(i) > x).unwrap_or_default();
            let of = |j: usize| {
                let [u, t] = [u.row(j), phi.row(j)];
                u[i] * 0.5 * (t[i - 1] + t[i]) * grid.axis(1).width(j)
            };
            (0..grid.cells()[1]).map(of).sum()
        }))
    }

    /// Friction before the force, 0.9 before its middle, over that of `other`, less 1; and least and largest of what it is off that of `other` from there to 1.8 behind
    /// the middle, both over what they are before.
    pub fn off(&self, other: &Self) -> [f64; 3] {
        let ratio = |x: f64| self.friction(x) / other.friction(x);
        let before = ratio(-0.9);
        let off = (-18..=36).map(|k| ratio(0.05 * f64::from(k)) / before - 1.0);
        let [low, high] = off.fold([0.0_f64; 2], |[low, high], o| [low.min(o), high.max(o)]);
        [before - 1.0, low, high]
    }
}

/// Faces from 9 before the force to 6 behind it.
fn along(h: f64) -> Outcome<Axis> {
    let [a, b] = EVEN;
    let before = growing(TAIL, 0.0, 9.0 + a, h);
    let behind = growing(TAIL, 0.0, 6.0 - b, h);
    let even = ((b - a) / h).round() as usize;
    let mut faces: Vec<f64> = before.iter().skip(1).rev().map(|x| a - x).collect();
    faces.extend((0..=even).map(|k| a + k as f64 * h));
    faces.extend(behind.iter().skip(1).map(|x| b + x));
    Ok(Axis::from_faces(faces)?)
}
