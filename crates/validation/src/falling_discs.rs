//! Two discs of different weight that fall through a fluid (Isoz et al. 2023, section 5 and figure 9).
use coupling::{CouplingError, HfdibDem, Particles, Simulation, WeightBalance, hfdib_dem};
use dem::{DemError, Disc, HalfSpace, Material, RigidBodies};
use fv_mesh::{CartesianGrid, Diffusion, FlowError, Fluid, Piso, Projection, Side};
use ibm::Forcing;
use interfaces::{Freedom, Periods, Point, Pose, Twist, Vector};

/// Box \[m\]: 10 × 20 of the paper's diameters.
pub const BOX: [f64; 2] = [10e-3, 20e-3];
/// The fluid is water.
pub const FLUID: Fluid = Fluid { density: 1000.0, viscosity: 1e-6 };
/// Gravity \[m/s²\], along −y.
pub const GRAVITY: f64 = 9.81;
/// What discs and floor are made of: soft enough for the contact to be cheap, hard enough for the discs to sink
/// less than a thousandth of their radius into the floor under their own weight, damped like a wet contact.
pub const MATERIAL: Material = Material {
    density: 1000.0,
    youngs_modulus: 1e6,
    poisson_ratio: 0.3,
    damping: 4.0,
    restitution: 0.5,
    friction: 0.3,
    rolling_friction: 0.0,
};
/// Fewer cells across a disc cannot hold its markers.
const LEAST_CELLS: usize = 4;
/// About a hundred bytes each.
const MOST_CELLS: usize = 200_000_000;

/// What may vary.
#[derive(Clone, Debug)]
pub struct FallingDiscs {
    /// Cells across a disc.
    pub cells_per_diameter: usize,
    /// How many discs.
    pub bodies: usize,
    /// Densities of the discs \[kg/m³\], repeated as needed.
    pub densities: Vec<f64>,
    /// Diameter of the discs \[m\].
    pub diameter: f64,
    /// Kinematic viscosity of the fluid \[m²/s\].
    pub viscosity: f64,
    /// How far the second disc starts aside of the first \[m\].
    pub aside: f64,
    /// Walls below and above instead of a periodic box.
    pub floor: bool,
    /// What holds up the discs' net weight in the periodic box.
    pub balance: WeightBalance,
    /// How the discs may move.
    pub freedom: Freedom,
    /// Virtual mass of the coupling in displaced masses, if not the coupling's own choice.
    pub virtual_mass: Option<f64>,
    /// Moves everything by this much \[m\] against the grid.
    pub shift: [f64; 2],
}

impl Default for FallingDiscs {
    fn default() -> Self {
        Self {
            cells_per_diameter: 15,
            bodies: 2,
            densities: vec![1060.0, 1030.0],
            diameter: 1e-3,
            viscosity: FLUID.viscosity,
            aside: 0.05e-3,
            floor: false,
            balance: WeightBalance::NetWeight,
            freedom: Freedom::PLANAR,
            virtual_mass: None,
            shift: [0.0; 2],
        }
    }
}

/// Why the scene cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum SetupError {
    /// The grid or the flow.
    #[error(transparent)]
    Flow(#[from] FlowError),
    /// The discs or the floor.
    #[error(transparent)]
    Bodies(#[from] DemError),
    /// Both together.
    #[error(transparent)]
    Coupling(#[from] CouplingError),
    /// The grid cannot hold the discs' markers.
    #[error(
        "{found} cells across a disc; at least {LEAST_CELLS} are needed, and 10 or more are advised: raise --cells-per-diameter"
    )]
    TooCoarse {
        /// Cells across a disc.
        found: usize,
    },
    /// The grid needs too much memory.
    #[error("{} × {} cells would need more than {:.0} GB; lower --cells-per-diameter or raise --diameter", cells[0], cells[1], MOST_CELLS as f64 * 100e-9)]
    TooFine {
        /// Cells along x and y.
        cells: [usize; 2],
    },
    /// No body, or more than there is room for.
    #[error("{found} bodies; give between 1 and {most}: what fits into the box in rows two diameters apart")]
    Count {
        /// How many.
        found: usize,
        /// How many there is room for.
        most: usize,
    },
    /// No density was given.
    #[error("no densities were given; give at least one, as in --densities 1060,1030")]
    NoDensity,
    /// A diameter that is not a length.
    #[error("a diameter of {found} m; give a positive one")]
    Diameter {
        /// The diameter \[m\].
        found: f64,
    },
}

impl FallingDiscs {
    /// Cells along x and y, so many to a diameter.
    pub fn cells(&self) -> [usize; 2] {
        BOX.map(|l| (l / self.diameter * self.cells_per_diameter as f64).round().max(1.0) as usize)
    }

    /// Where the discs start: the paper's two, further ones in rows from the top.
    pub fn centres(&self) -> Result<Vec<[f64; 2]>, SetupError> {
        let d = self.diameter;
        let mut all = vec![[5e-3, 16e-3], [5e-3 + self.aside, 13.5e-3]];
        let per_row = ((BOX[0] / (2.0 * d)).floor() as usize).min(1000);
        let rows = ((11e-3 / (2.0 * d)).floor() as usize).min(1000);
        for k in 0..if self.bodies > 2 { per_row * rows } else { 0 } {
            let (row, place) = ((k / per_row) as f64, (k % per_row) as f64);
            all.push([d * (2.0 * place + 1.0), 11e-3 - 2.0 * d * (row + 0.5)]);
        }
        if self.bodies == 0 || self.bodies > all.len() {
            return Err(SetupError::Count { found: self.bodies, most: 2 + per_row * rows });
        }
        all.truncate(self.bodies);
        Ok(all.into_iter().map(|[x, y]| [x + self.shift[0], y + self.shift[1]]).collect())
    }

    /// The fluid alone.
    ///
    /// # Errors
    /// Where the scene makes no sense.
    pub fn flow(&self) -> Result<Projection<2>, SetupError> {
        let flow = Projection::new(self.grid()?, self.sides(), self.fluid())?;
        // The immersed boundary's accuracy is known for explicit diffusion.
        Ok(flow.with_diffusion(Diffusion::Explicit))
    }

    fn fluid(&self) -> Fluid {
        Fluid { viscosity: self.viscosity, ..FLUID }
    }

    fn sides(&self) -> [[Side; 2]; 2] {
        [Side::Periodic.both(), if self.floor { Side::WALL.both() } else { Side::Periodic.both() }]
    }

    fn grid(&self) -> Result<CartesianGrid<2>, SetupError> {
        if !(self.diameter.is_finite() && self.diameter > 0.0) {
            return Err(SetupError::Diameter { found: self.diameter });
        }
        if self.cells_per_diameter < LEAST_CELLS {
            return Err(SetupError::TooCoarse { found: self.cells_per_diameter });
        }
        let cells = self.cells();
        if cells[0].saturating_mul(cells[1]) > MOST_CELLS {
            return Err(SetupError::TooFine { cells });
        }
        Ok(CartesianGrid::new(cells, BOX)?)
    }

    /// The discs alone, without fluid.
    pub fn discs(&self) -> Result<RigidBodies, SetupError> {
        let periods = Periods::new([Some(BOX[0]), (!self.floor).then_some(BOX[1]), None]);
        let mut bodies = RigidBodies::new(periods);
        if self.densities.is_empty() {
            return Err(SetupError::NoDensity);
        }
        let material = |density: f64| Material { density, ..MATERIAL };
        for (centre, &density) in self.centres()?.into_iter().zip(self.densities.iter().cycle()) {
            bodies.add(
                Disc::new(0.5 * self.diameter)?,
                material(density),
                Pose::at([centre[0], centre[1], 0.0]),
                Twist::default(),
                self.freedom,
            )?;
        }
        if self.floor {
            bodies.add_wall(HalfSpace::new(Point::origin(), Vector::y())?, MATERIAL)?;
            bodies.add_wall(HalfSpace::new(Point::new(0.0, BOX[1], 0.0), -Vector::y())?, MATERIAL)?;
        }
        bodies.check_overlaps()?;
        Ok(bodies)
    }

    /// Everything.
    pub fn build<F: Forcing>(
        &self,
        forcing: F,
    ) -> Result<Simulation<2, Particles<F, RigidBodies>>, SetupError> {
        let flow = self.flow()?;
        let gravity = Vector::new(0.0, -GRAVITY, 0.0);
        let mut particles = Particles::new(self.discs()?, forcing, FLUID.density, gravity);
        if let Some(factor) = self.virtual_mass {
            particles = particles.with_virtual_mass(factor);
        }
        Ok(Simulation::new(flow, particles, self.weight_balance())?)
    }

    fn weight_balance(&self) -> WeightBalance {
        if self.floor { WeightBalance::None } else { self.balance }
    }

    /// The same by the paper's algorithm.
    ///
    /// # Errors
    /// Where the scene makes no sense.
    pub fn hfdib_dem(&self) -> Result<HfdibDem<2>, SetupError> {
        let flow = Piso::new(self.grid()?, self.sides(), self.fluid())?;
        Ok(hfdib_dem(flow, self.discs()?, Vector::new(0.0, -GRAVITY, 0.0), self.weight_balance())?)
    }
}
