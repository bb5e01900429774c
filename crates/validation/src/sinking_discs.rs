//! Discs that sink in a closed plane box of 2 × 6 cm: two that draft, kiss and tumble (Uhlmann 2005, J. Comput. Phys. 209, 448), and one
//! alone (Glowinski, Pan, Hesla, Joseph & Périaux 2001, J. Comput. Phys. 169, 363; Wan & Turek 2006, Int. J. Numer. Meth. Fluids 51, 531).
use crate::Outcome;
use crate::motion::Fall;
use coupling::{Particles, Simulation, WeightBalance};
use dem::{ContactLaw, Disc, HalfSpace, Material, RigidBodies};
use fv_mesh::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use ibm::SmoothForcing;
use interfaces::{Freedom, Periods, Point, Pose, Twist, Vector};

/// Edges of the box \[m\]; gravity acts along −y.
pub const BOX: [f64; 2] = [0.02, 0.06];
/// Diameter of the discs \[m\].
pub const DIAMETER: f64 = 2.5e-3;
/// Density of the fluid \[kg/m³\].
pub const FLUID_DENSITY: f64 = 1000.0;
/// Gravity \[m/s²\].
pub const GRAVITY: f64 = 9.81;
/// Discs and walls: soft enough for a contact to take few sub-steps, hard enough for the discs to share less than a hundredth of a radius;
/// wet contacts do not rebound.
const MATERIAL: Material = Material {
    density: 1000.0,
    youngs_modulus: 1e6,
    poisson_ratio: 0.3,
    damping: 4.0,
    restitution: 0.5,
    friction: 0.0,
    rolling_friction: 0.0,
};
/// Fewer cells across a disc cannot hold its markers.
const LEAST_CELLS: usize = 4;

/// What sinks, in which fluid.
#[derive(Clone, Debug)]
pub struct SinkingDiscs {
    /// Where the centres are at the start \[m\].
    pub starts: Vec<[f64; 2]>,
    /// Density of the discs over that of the fluid.
    pub density_ratio: f64,
    /// Kinematic viscosity \[m²/s\].
    pub viscosity: f64,
    /// Cells across a disc.
    pub cells_per_diameter: usize,
    /// Coefficient of friction between discs.
    pub friction: f64,
}

impl SinkingDiscs {
    /// Two discs one above the other, a little beside the middle line: ρ_s/ρ_f = 1.5, ν = 0.01 cm²/s. The first one is the upper one, which trails.
    pub fn drafting(cells_per_diameter: usize) -> Self {
        Self {
            starts: vec![[0.01 + 1e-5, 0.05], [0.01 - 1e-5, 0.045]],
            density_ratio: 1.5,
            viscosity: 1e-6,
            cells_per_diameter,
            friction: 0.0,
        }
    }

    /// One disc on the middle line, 4 cm above the floor: ρ_s/ρ_f = 1.25, ν = 0.1 cm²/s.
    pub fn single(cells_per_diameter: usize) -> Self {
        Self {
            starts: vec![[0.01, 0.04]],
            density_ratio: 1.25,
            viscosity: 1e-5,
            cells_per_diameter,
            friction: 0.0,
        }
    }

    /// Edge of a cell \[m\].
    pub fn spacing(&self) -> f64 {
        DIAMETER / self.cells_per_diameter as f64
    }

    /// Cells along x and y.
    pub fn cells(&self) -> [usize; 2] {
        BOX.map(|l| (l / self.spacing()).round().max(1.0) as usize)
    }

    /// Discs, walls and fluid at rest.
    ///
    /// # Errors
    /// Those of grid, flow and bodies.
    pub fn build<L: ContactLaw>(&self, forcing: SmoothForcing, law: L) -> Outcome<Fall<2, L>> {
        if self.cells_per_diameter < LEAST_CELLS {
            return Err(format!(
                "{} cells across a disc; at least {LEAST_CELLS} are needed: raise --cells-per-diameter",
                self.cells_per_diameter
            )
            .into());
        }
        let fluid = Fluid { density: FLUID_DENSITY, viscosity: self.viscosity };
        let flow = Projection::new(CartesianGrid::new(self.cells(), BOX)?, Side::WALL.everywhere(), fluid)?
            .with_diffusion(Diffusion::Explicit);
        let material =
            Material { density: self.density_ratio * FLUID_DENSITY, friction: self.friction, ..MATERIAL };
        let mut bodies = RigidBodies::with_law(Periods::default(), law);
        for (corner, inwards) in [([0.0; 2], Vector::x()), ([0.0; 2], Vector::y()), (BOX, -Vector::x())] {
            bodies.add_wall(HalfSpace::new(Point::new(corner[0], corner[1], 0.0), inwards)?, material)?;
        }
        for [x, y] in &self.starts {
            let (disc, start) = (Disc::new(0.5 * DIAMETER)?, Pose::at([*x, *y, 0.0]));
            bodies.add(disc, material, start, Twist::default(), Freedom::PLANAR)?;
        }
        bodies.check_overlaps()?;
        let gravity = Vector::new(0.0, -GRAVITY, 0.0);
        let particles = Particles::new(bodies, forcing, FLUID_DENSITY, gravity);
        Ok(Simulation::new(flow, particles, WeightBalance::None)?)
    }
}
