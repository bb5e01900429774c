//! Polyhedra that settle in a fluid: a dense suspension becomes a bed.
mod bed;
mod diary;

pub use bed::Bed;
pub use diary::{Diary, Portraits};

use crate::Outcome;
use crate::coupled::{Fall, Slice, View};
use crate::granular::{GRAVITY, Grain, Kind, squeezed};
use coupling::{Particles, Simulation, WeightBalance};
use dem::placing::SizeDistribution;
use dem::{Chen, ContactLaw, HalfSpace, Lubricated, Material, RigidBodies};
use fv_mesh::{CartesianGrid, Diffusion, Fluid, Projection, Sampler, Side};
use ibm::{SmoothFilm, SmoothForcing};
use interfaces::{Aabb, Bodies, Freedom, Kinematics, Periods, Point, Twist, Vector};
use render::Domain;
use std::f64::consts::PI;

/// Density of the fluid \[kg/m³\].
pub const FLUID_DENSITY: f64 = 1000.0;
/// Box: height over width, roughly.
const SLENDER: f64 = 1.25;
/// Bodies are placed this much larger than they are, so that there is fluid between all of them at the start.
const SWOLLEN: f64 = 1.03;
/// Fewer cells across the smallest body cannot hold its markers.
const LEAST_CELLS: usize = 5;
/// Points of a picture per cell along each axis.
const FINER: usize = 3;
/// Solid fraction to which polyhedra settle, roughly.
const SETTLED: f64 = 0.56;

/// A closed box full of fluid and bodies.
#[derive(Clone, Debug)]
pub struct Suspension {
    /// How many bodies.
    pub number: usize,
    /// Solid fraction at the start.
    pub fraction: f64,
    /// Middle diameter of spheres of the bodies' volumes \[m\].
    pub diameter: f64,
    /// Diameters are drawn evenly from 1 − spread to 1 + spread times the middle one.
    pub spread: f64,
    /// Cells across a body of the middle diameter.
    pub cells_per_diameter: usize,
    /// Density of the bodies over that of the fluid.
    pub density_ratio: f64,
    /// Kinematic viscosity of the fluid \[m²/s\].
    pub viscosity: f64,
    /// Coefficient of friction, between bodies and at walls.
    pub friction: f64,
    /// Young's modulus of bodies and walls \[Pa\].
    pub youngs_modulus: f64,
    /// No walls at the sides: the box repeats.
    pub periodic: bool,
    /// Of all that is drawn at random.
    pub seed: u64,
}

impl Default for Suspension {
    fn default() -> Self {
        Self {
            number: 500,
            fraction: 0.4,
            diameter: 2e-3,
            spread: 0.15,
            cells_per_diameter: 8,
            density_ratio: 2.5,
            viscosity: 1e-5,
            friction: 0.3,
            youngs_modulus: 3e5,
            periodic: false,
            seed: 1,
        }
    }
}

impl Suspension {
    /// Edge of a cell \[m\].
    pub fn spacing(&self) -> f64 {
        self.diameter / self.cells_per_diameter as f64
    }
    /// The fluid.
    pub fn fluid(&self) -> Fluid {
        Fluid { density: FLUID_DENSITY, viscosity: self.viscosity }
    }
    /// Galileo number √((ρ_s/ρ − 1) g d³)/ν.
    pub fn galileo(&self) -> f64 {
        ((self.density_ratio - 1.0).abs() * GRAVITY * self.diameter.powi(3)).sqrt() / self.viscosity
    }
    /// Speed of a sphere of the middle diameter that falls alone \[m/s\]: its weight against the drag of Schiller & Naumann (1933),
    /// Ga² = 18 Re (1 + 0.15 Re^0.687), by bisection.
    pub fn alone(&self) -> f64 {
        let drag = |re: f64| 18.0 * re * (1.0 + 0.15 * re.powf(0.687));
        let weight = self.galileo().powi(2);
        let (mut low, mut high) = (0.0, weight / 18.0);
        for _ in 0..60 {
            let re = 0.5 * (low + high);
            *(if drag(re) < weight { &mut low } else { &mut high }) = re;
        }
        0.5 * (low + high) * self.viscosity / self.diameter
    }
    /// Speed at which a suspension of such spheres settles \[m/s\]: U (1 − φ)ⁿ of Richardson & Zaki (1954) with
    /// (4.7 − n)/(n − 2.35) = 0.175 Re^0.75 (Rowe 1987).
    pub fn hindered(&self) -> f64 {
        let re = self.alone() * self.diameter / self.viscosity;
        let x = 0.175 * re.powf(0.75);
        let n = (4.7 + 2.35 * x) / (1.0 + x);
        self.alone() * (1.0 - self.fraction).powf(n)
    }
    /// Time until all is at rest, roughly \[s\]: three times what the uppermost bodies need.
    pub fn end(&self) -> f64 {
        let way = self.lengths(self.volume_foreseen())[2] * (1.0 - (self.fraction / SETTLED).min(0.95));
        3.0 * way / self.hindered()
    }
    /// Of all bodies, from the law of their sizes \[m³\].
    fn volume_foreseen(&self) -> f64 {
        // ⟨d³⟩ of an even distribution.
        PI / 6.0 * self.diameter.powi(3) * (1.0 + self.spread.powi(2)) * self.number as f64
    }
    /// Edges of a box in which bodies of this volume have the solid fraction, in whole cells \[m\].
    fn lengths(&self, volume: f64) -> [f64; 3] {
        let (h, whole) = (self.spacing(), volume / self.fraction);
        let width = ((whole / SLENDER).cbrt() / (2.0 * h)).round().max(1.0) * 2.0 * h;
        let height = (whole / (width * width) / h).round().max(1.0) * h;
        [width, width, height]
    }

    /// Do the numbers make sense?
    ///
    /// # Errors
    /// For the first that does not, with what to give instead.
    pub fn check(&self) -> Outcome<()> {
        let positive = |x: f64| x.is_finite() && x > 0.0;
        let tests = [
            (self.number > 0, format!("--bodies {}: give at least 1", self.number)),
            (
                self.fraction > 0.0 && self.fraction <= 0.5,
                format!("--fraction {}: give a number above 0, at most 0.5", self.fraction),
            ),
            (positive(self.diameter), format!("--diameter {}: give a positive length", self.diameter)),
            (
                (0.0..=0.5).contains(&self.spread),
                format!("--spread {}: give a number from 0 to 0.5", self.spread),
            ),
            (
                self.cells_per_diameter >= LEAST_CELLS,
                format!("--cells-per-diameter {}: give at least {LEAST_CELLS}", self.cells_per_diameter),
            ),
            (
                self.density_ratio.is_finite() && self.density_ratio > 1.0,
                format!("--density-ratio {}: give a number above 1, or nothing settles", self.density_ratio),
            ),
            (positive(self.viscosity), format!("--viscosity {}: give a positive number", self.viscosity)),
        ];
        match tests.into_iter().find(|t| !t.0) {
            Some((_, text)) => Err(text.into()),
            None => Ok(()),
        }
    }

    /// The bodies before they have a place, `by` times as large.
    fn grains(&self, by: f64) -> Outcome<Vec<Grain>> {
        let (d, s) = (self.diameter, self.spread);
        let law = if s > 0.0 {
            SizeDistribution::uniform((1.0 - s) * d, (1.0 + s) * d)?
        } else {
            SizeDistribution::constant(d)?
        };
        let sizes: Vec<f64> = law.sample(self.number, self.seed).iter().map(|d| by * d).collect();
        Kind::Polyhedron.grains(&sizes)
    }

    /// Chen's law of contact, and what the grid does not resolve of the films between bodies that are close.
    ///
    /// # Errors
    /// For a viscosity or a spacing that makes no sense.
    pub fn lubricated(&self) -> Outcome<Lubricated<Chen>> {
        let viscosity = self.viscosity * FLUID_DENSITY;
        Ok(Lubricated::new(Chen::default(), viscosity, SmoothFilm::new(self.spacing())?)?)
    }

    /// Fluid and bodies at rest, these at random all over the box and nowhere in touch; `law` is that of their contacts.
    ///
    /// # Errors
    /// For numbers that make no sense, and those of placing, grid, flow and bodies.
    pub fn build<L: ContactLaw>(&self, forcing: SmoothForcing, law: L) -> Outcome<Fall<3, L>> {
        self.check()?;
        let grains = self.grains(1.0)?;
        let volume = grains.iter().map(|g| g.shape.inertia(1.0).volume).sum();
        let lengths = self.lengths(volume);
        let cells = lengths.map(|l| (l / self.spacing()).round() as usize);
        let material = Material {
            density: self.density_ratio * FLUID_DENSITY,
            youngs_modulus: self.youngs_modulus,
            friction: self.friction,
            ..Material::default()
        };
        let side = if self.periodic { Side::Periodic } else { Side::WALL };
        let sides = [side.both(), side.both(), Side::WALL.both()];
        let flow = Projection::new(CartesianGrid::new(cells, lengths)?, sides, self.fluid())?
            .with_diffusion(Diffusion::Explicit);
        let period = |axis: usize| self.periodic.then_some(lengths[axis]);
        let mut bodies = RigidBodies::with_law(Periods::new([period(0), period(1), None]), law);
        let gravity = Vector::new(0.0, 0.0, -GRAVITY);
        let room = Aabb { min: Point::origin(), max: lengths.into() };
        for axis in if self.periodic { 2..3 } else { 0..3 } {
            bodies.add_wall(HalfSpace::new(room.min, Vector::ith(axis, 1.0))?, material)?;
            bodies.add_wall(HalfSpace::new(room.max, -Vector::ith(axis, 1.0))?, material)?;
        }
        let poses = squeezed(&self.grains(SWOLLEN)?, room, [self.periodic; 2], self.seed)?;
        for (grain, pose) in grains.into_iter().zip(poses) {
            bodies.add(grain.shape, material, pose, Twist::default(), Freedom::FREE)?;
        }
        bodies.check_overlaps()?;
        let particles = Particles::new(bodies, forcing, FLUID_DENSITY, gravity);
        Ok(Simulation::new(flow, particles, WeightBalance::None)?)
    }

    /// The upright plane through the middle of the box, x to the right.
    pub fn view<L: ContactLaw>(&self, fall: &Fall<3, L>) -> View<3, L> {
        let [width, _, height] = fall.flow.grid().lengths();
        let domain = Domain { width, height, periodic: [self.periodic, false] };
        View { domain, max_speed: 2.0 * self.hindered(), slice }
    }
}

fn slice<L: ContactLaw>(fall: &Fall<3, L>) -> Slice {
    let (flow, bodies) = (&fall.flow, &fall.particles.bodies);
    let grid = flow.grid();
    let ([nx, _, nz], fine) = (grid.cells().map(|n| FINER * n), grid.spacing()[0] / FINER as f64);
    let middle = 0.5 * grid.lengths()[1];
    let sampler = Sampler::new(grid, flow.sides());
    let at = |i: usize| [((i % nx) as f64 + 0.5) * fine, middle, ((i / nx) as f64 + 0.5) * fine];
    let speed = |i| sampler.velocity(flow.velocity(), at(i)).map_or(f64::NAN, |u| Vector::from(u).norm());
    // By the distance from the surface.
    let share = |i, b| {
        let away = bodies.periods().nearest(Point::from(at(i)) - bodies.pose(b).position);
        if away.norm() > bodies.shape(b).bounding_radius() + fine {
            return 0.0;
        }
        let place = Point::from(bodies.pose(b).orientation.inverse_transform_vector(&away));
        (0.5 - bodies.solid(b).signed_distance(place, fine) / fine).clamp(0.0, 1.0)
    };
    let solid = |i| bodies.ids().map(|b| share(i, b)).fold(0.0, f64::max);
    Slice {
        time: flow.time(),
        cells: [nx, nz],
        speed: (0..nx * nz).map(speed).collect(),
        solid: (0..nx * nz).map(solid).collect(),
        discs: Vec::new(),
    }
}
