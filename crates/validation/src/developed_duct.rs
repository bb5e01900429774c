//! Developed turbulent flow in ducts that are turned against the grid.
use crate::Outcome;
use crate::turned_ducts::TurnedDucts;
use fv_mesh::{
    Convection, Fluid, Modelled, Scalar, ScalarSide, Settling, Side, Simple, SimpleParams, TransportParams,
    WallStress,
};
use ibm::{StaticBodies, cut_cells};
use turb::{Inflow, Law, TwoEquation};

/// How fast the force brings the mean velocity to 1 m/s \[1/s\].
const GAIN: f64 = 0.02;

/// Flow of mean velocity 1 m/s in ducts of height 1 m, developed.
pub struct DevelopedDuct<L: Law> {
    /// The solid between the ducts.
    pub ducts: TurnedDucts,
    /// The flow in them.
    pub flow: Simple<2>,
    /// Its model.
    pub model: Modelled<2, TwoEquation<L>>,
    /// The force per mass that keeps it up \[m/s²\].
    pub force: f64,
    /// Friction of the walls that rise along the stream and of those that recede \[Pa\].
    pub frictions: [f64; 2],
    /// The largest residual of the last iteration.
    pub residual: f64,
}

impl<L: Law> DevelopedDuct<L> {
    /// Ducts turned by `angle` \[°\] with so many cells across, the first wall `shift` cells from a corner of the grid, in a fluid of kinematic `viscosity`
    /// \[m²/s\]; iterates until the flow rests to 1e-5 and its mean velocity to 1e-4, or 4000 times. `force`: a guess of it \[m/s²\].
    ///
    /// # Errors
    /// Those of the flow, the walls and the model.
    pub fn new(
        law: L,
        angle: f64,
        cells: usize,
        shift: f64,
        viscosity: f64,
        mut force: f64,
    ) -> Outcome<Self> {
        let (ducts, grid) = TurnedDucts::new(1.0, angle.to_radians(), 1.0 / cells as f64, shift)?;
        let along = ducts.along();
        let sides = [Side::Periodic.both(), Side::Periodic.both()];
        let mut flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity })?
            .with_convection(Convection::Quick)
            .with_params(SimpleParams { velocity_relaxation: 0.97, ..SimpleParams::turbulent() })?;
        let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(ducts, ducts.pose()))?;
        flow.set_walls(Some((&cuts, WallStress::LAW_OF_THE_WALL)))?;
        flow.set_velocity(|_| along);
        let closure = TwoEquation::new(law, grid.n_cells(), Inflow::from_length(1.0, 0.05, 0.07)?)?;
        let mut model = Modelled::new(closure, flow.grid(), flow.sides(), TransportParams::steady())?;
        for (i, distance) in model.transport_mut().wall_distance_mut().iter_mut().enumerate() {
            *distance = ducts.distance(grid.centre(grid.cell(i))).max(0.0);
        }
        let (mut residual, mut settled) = (f64::INFINITY, 0);
        while settled < 20 && flow.iterations() < 4000 {
            flow.set_force(along.map(|x| x * force));
            residual = flow.iterate_with(&mut model)?.largest();
            let bulk = ducts.mean_velocity(&flow, &cuts);
            settled = if residual < 1e-5 && (bulk - 1.0).abs() < 1e-4 { settled + 1 } else { 0 };
            force = ducts.drag(&flow) / ducts.area() + GAIN * (1.0 - bulk);
        }
        let frictions = ducts.friction_of_each(&flow, &cuts);
        Ok(Self { ducts, flow, model, force, frictions, residual })
    }

    /// The velocity's image: what gains per time what the force gives the flow, is conducted and mixed as momentum (Pr = Pr_t = 1) and 0 on the walls.
    ///
    /// # Errors
    /// Those of the scalar and the walls.
    pub fn warmth(&mut self) -> Outcome<Scalar<2>> {
        let Self { ducts, flow, model, force, .. } = self;
        let viscosity = flow.fluid().viscosity;
        let periodic = [ScalarSide::Periodic.both(), ScalarSide::Periodic.both()];
        let mut warmth = Scalar::new(flow.grid(), periodic, viscosity)?
            .with_turbulent_prandtl(1.0)?
            .with_convection(Convection::Quick);
        let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(*ducts, ducts.pose()))?;
        warmth.set_walls(Some((&cuts, 0.0)))?;
        warmth.source_mut().data_mut().fill(*force);
        let eddies = model.eddy_stress(viscosity, 0.0)?.ok_or("a model without eddy viscosity")?;
        warmth.mix(eddies, viscosity);
        warmth.rub(&flow.wall_friction_velocities(), viscosity)?;
        let settling = Settling { tolerance: 1e-7, max_iterations: 10_000 };
        warmth.settle(flow.velocity(), 0.0, settling, &[], |_| ())?;
        Ok(warmth)
    }

    /// What the walls take of what [`warmth`](Self::warmth) gains, and its mean over that of the velocity along the ducts, less 1, in cells whose faces are not cut.
    ///
    /// # Errors
    /// As there.
    pub fn analogy(&mut self) -> Outcome<[f64; 2]> {
        let warmth = self.warmth()?;
        let Self { ducts, flow, force, .. } = self;
        let (grid, h) = (flow.grid(), flow.grid().axis(0).width(0));
        let mut sums = [0.0; 2];
        for cell in (0..grid.n_cells()).map(|i| grid.cell(i)) {
            if ducts.distance(grid.centre(cell)) > 1.5 * h {
                sums = [sums[0] + ducts.speed(flow, cell), sums[1] + warmth.field().row(cell[1])[cell[0]]];
            }
        }
        let taken = -warmth.given_off().unwrap_or_default() / (*force * ducts.area());
        Ok([taken, sums[1] / sums[0] - 1.0])
    }
}
