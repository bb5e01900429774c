//! A sphere that settles in a closed box (ten Cate, Nieuwstad, Derksen & Van den Akker 2002, Phys. Fluids 14, 4012).
use crate::Outcome;
use crate::axes::gathered;
use crate::motion::Fall;
use crate::prescribed_bodies::{PrescribedBodies, forced_step};
use crate::reference_curve;
use coupling::{Particles, Simulation, WeightBalance};
use dem::{Chen, ContactLaw, HalfSpace, Lubricated, Material, RigidBodies, Sphere};
use fv_mesh::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use ibm::{Forcing, SmoothFilm, SmoothForcing};
use interfaces::{BodyId, Freedom, Periods, Point, Pose, Twist, Vector};
use std::f64::consts::PI;

/// Edges of the box \[m\]; gravity acts along −z.
pub const BOX: [f64; 3] = [0.1, 0.1, 0.16];
/// Diameter of the sphere \[m\].
pub const DIAMETER: f64 = 15e-3;
/// Density of the sphere \[kg/m³\].
pub const DENSITY: f64 = 1120.0;
/// Height of its centre at the start \[m\].
pub const START: f64 = 127.5e-3;
/// Gravity \[m/s²\].
pub const GRAVITY: f64 = 9.81;
/// Sphere and floor: soft enough for the contact to cost little, hard enough for the sphere to sink in by far less than a cell.
const YOUNGS_MODULUS: f64 = 1e6;
/// Cells by which equal ones reach beyond the sphere: more than any kernel does.
const MARGIN: f64 = 8.0;
/// Widths of neighbouring cells elsewhere.
const GROWTH: f64 = 1.1;
/// Fewer cells across the sphere cannot hold its markers.
const LEAST_CELLS: usize = 4;

/// The four silicone oils of the experiment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Case {
    /// Re 1.5.
    E1,
    /// Re 4.1.
    E2,
    /// Re 11.6.
    E3,
    /// Re 31.9.
    E4,
}

impl Case {
    /// Density \[kg/m³\] and dynamic viscosity \[Pa s\] of the oil.
    pub fn oil(self) -> [f64; 2] {
        match self {
            Self::E1 => [970.0, 0.373],
            Self::E2 => [965.0, 0.212],
            Self::E3 => [962.0, 0.113],
            Self::E4 => [960.0, 0.058],
        }
    }
    /// As the flow wants it.
    pub fn fluid(self) -> Fluid {
        let [density, viscosity] = self.oil();
        Fluid { density, viscosity: viscosity / density }
    }
    /// Time in which the sphere comes to the floor, roughly \[s\].
    pub fn end(self) -> f64 {
        match self {
            Self::E1 => 4.1,
            Self::E2 => 2.6,
            Self::E3 => 1.7,
            Self::E4 => 1.3,
        }
    }
    /// Largest speed that was measured \[m/s\], where it is known.
    pub fn peak(self) -> Option<f64> {
        match self {
            Self::E1 => Some(0.0363),
            Self::E4 => Some(0.1226),
            Self::E2 | Self::E3 => None,
        }
    }
    /// Upward velocity \[m/s\] over time \[s\] as measured; empty where it is not known.
    pub fn velocity(self) -> Vec<(f64, f64)> {
        match self {
            Self::E1 => {
                reference_curve::read(include_str!("../../../tests/data/ten_cate_2002_e1_velocity.csv"))
            }
            Self::E4 => {
                reference_curve::read(include_str!("../../../tests/data/ten_cate_2002_e4_velocity.csv"))
            }
            Self::E2 | Self::E3 => Vec::new(),
        }
    }
}

/// What may vary.
#[derive(Clone, Debug)]
pub struct SettlingSphere {
    /// The oil.
    pub case: Case,
    /// Cells across the sphere.
    pub cells_per_diameter: usize,
}

impl SettlingSphere {
    /// Edge of a cell \[m\].
    pub fn spacing(&self) -> f64 {
        DIAMETER / self.cells_per_diameter as f64
    }

    /// Contact with a film of the oil before it.
    ///
    /// # Errors
    /// None with a sensible number of cells.
    pub fn lubricated(&self) -> Outcome<Lubricated<Chen>> {
        let [_, viscosity] = self.case.oil();
        Ok(Lubricated::new(Chen::default(), viscosity, SmoothFilm::new(self.spacing())?)?)
    }

    /// The box: cubes where the sphere falls, cells that grow by a tenth towards the sides and the top.
    ///
    /// # Errors
    /// None with a sensible number of cells.
    pub fn grid(&self) -> Outcome<CartesianGrid<3>> {
        let (h, reach) = (self.spacing(), 0.5 * DIAMETER + MARGIN * self.spacing());
        let across =
            |length: f64| gathered(length, h, [0.5 * length - reach, 0.5 * length + reach], GROWTH, 0.0);
        let upright = gathered(BOX[2], h, [0.0, START + reach], GROWTH, 0.0)?;
        Ok(CartesianGrid::from_axes([across(BOX[0])?, across(BOX[1])?, upright])?)
    }

    /// Sphere, walls and fluid at rest; the sphere meets the floor by `law`.
    ///
    /// # Errors
    /// Those of grid, flow and bodies.
    pub fn build<L: ContactLaw>(&self, forcing: SmoothForcing, law: L) -> Outcome<Fall<3, L>> {
        if self.cells_per_diameter < LEAST_CELLS {
            return Err(format!(
                "{} cells across the sphere; at least {LEAST_CELLS} are needed: raise --cells-per-diameter",
                self.cells_per_diameter
            )
            .into());
        }
        let fluid = self.case.fluid();
        let flow = Projection::new(self.grid()?, Side::WALL.everywhere(), fluid)?
            .with_diffusion(Diffusion::Explicit);
        let material = Material { density: DENSITY, youngs_modulus: YOUNGS_MODULUS, ..Material::default() };
        let mut bodies = RigidBodies::with_law(Periods::default(), law);
        bodies.add_wall(HalfSpace::new(Point::origin(), Vector::z())?, material)?;
        let start = Pose::at([0.5 * BOX[0], 0.5 * BOX[1], START]);
        bodies.add(Sphere::new(0.5 * DIAMETER)?, material, start, Twist::default(), Freedom::FREE)?;
        let gravity = Vector::new(0.0, 0.0, -GRAVITY);
        let particles = Particles::new(bodies, forcing, fluid.density, gravity);
        Ok(Simulation::new(flow, particles, WeightBalance::None)?)
    }

    /// The speed \[m/s\] at which creeping flow bears the sphere's net weight in the middle of the box: no fall there is faster for long, since of all flows with these velocities on sphere and walls
    /// the creeping one dissipates least (Helmholtz 1868).
    ///
    /// # Errors
    /// Those of grid, flow and forcing.
    pub fn creeping_speed(&self) -> Outcome<f64> {
        let (fluid, h) = (self.case.fluid(), self.spacing());
        let reach = 0.5 * DIAMETER + MARGIN * h;
        let axis = |a: usize, shift| {
            gathered(BOX[a], h, [0.5 * BOX[a] - reach, 0.5 * BOX[a] + reach], GROWTH, shift)
        };
        let grid = CartesianGrid::from_axes([axis(0, 0.37)?, axis(1, 0.3)?, axis(2, 0.11)?])?;
        let mut flow =
            Projection::new(grid, Side::WALL.everywhere(), fluid)?.with_diffusion(Diffusion::Explicit);
        let mut forcing = SmoothForcing::new(fluid.density);
        let at = BOX.map(|l| 0.5 * l);
        // Reynolds number 1e-6.
        let speed = 1e-6 * fluid.viscosity / DIAMETER;
        let mut sphere = PrescribedBodies::default().with(Sphere::new(0.5 * DIAMETER)?, at, 0.0);
        sphere.put(
            BodyId(0),
            Pose::at(at),
            Twist { linear: Vector::new(0.0, 0.0, -speed), ..Twist::default() },
        );
        let (mut drags, mut last) = ([f64::NAN; 3], f64::NAN);
        loop {
            let end = flow.time() + DIAMETER * DIAMETER / fluid.viscosity;
            let mut drag = 0.0;
            while flow.time() < end {
                let dt = flow.stable_dt(0.4);
                forced_step(&mut flow, &mut forcing, &sphere, dt)?;
                drag = forcing.reaction(BodyId(0)).force.z / dt;
            }
            drags = [drags[1], drags[2], drag];
            // What the slowest mode leaves (Aitken).
            let [first, second] = [drags[1] - drags[0], drags[2] - drags[1]];
            let settled = drags[2] - second * second / (second - first);
            if (settled / last - 1.0).abs() < 1e-4 {
                let weight = (DENSITY - fluid.density) * PI / 6.0 * DIAMETER.powi(3) * GRAVITY;
                return Ok(weight * speed / settled);
            }
            last = settled;
        }
    }
}
