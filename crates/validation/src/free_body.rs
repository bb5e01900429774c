//! Bodies that rise or settle in a periodic box.
use crate::Outcome;
use coupling::{CouplingError, Exchange, Observer, Particles, Simulation, StepInfo, Strategy, WeightBalance};
use dem::{Ellipsoid, Material, RigidBodies, Shape, Sphere, TriangleMesh};
use fv_mesh::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use ibm::{Forcing, SmoothForcing};
use interfaces::{BodyId, Dynamics, Freedom, Periods, Pose, Rotation, Twist, Vector};
use std::f64::consts::PI;
use std::sync::Arc;

/// Bodies of the volume of a sphere of diameter 1, free to move and turn, in fluid of density 1 under gravity 1 along −z. Times are in √(d/g), speeds in
/// √(g d). The Galileo number √(|ρ_s/ρ − 1| g d³)/ν tells the viscosity. Periodic box, net weight balanced.
#[derive(Clone)]
pub struct FreeBody {
    /// The shape, of volume π/6.
    pub shape: Arc<dyn Shape>,
    /// ρ_s/ρ.
    pub density_ratio: f64,
    /// √(|ρ_s/ρ − 1| g d³)/ν.
    pub galileo: f64,
    /// Cells along a diameter.
    pub per_diameter: usize,
    /// Box in diameters.
    pub box_: [usize; 3],
    /// How many, all alike.
    pub bodies: usize,
    /// How viscous terms are computed.
    pub diffusion: Diffusion,
    /// By which the fluid follows the bodies; in fluid of density 1.
    pub forcing: SmoothForcing,
}

/// Volume of every body.
const VOLUME: f64 = PI / 6.0;

impl FreeBody {
    /// A sphere of so much of the fluid's density at Galileo number 50, 10 cells per diameter, in a box of 4 × 4 × 8.
    ///
    /// # Errors
    /// None that is known.
    pub fn new(density_ratio: f64) -> Outcome<Self> {
        let (shape, diffusion) = (Self::sphere()?, Diffusion::Explicit);
        let (galileo, per_diameter, box_, bodies) = (50.0, 10, [4, 4, 8], 1);
        let forcing = SmoothForcing::new(1.0);
        Ok(Self { shape, density_ratio, galileo, per_diameter, box_, bodies, diffusion, forcing })
    }
    /// The sphere.
    ///
    /// # Errors
    /// None that is known.
    pub fn sphere() -> Outcome<Arc<dyn Shape>> {
        Ok(Arc::new(Sphere::new(0.5)?))
    }
    /// An ellipsoid with axes 1 : 1.5 : 2.
    ///
    /// # Errors
    /// None that is known.
    pub fn ellipsoid() -> Outcome<Arc<dyn Shape>> {
        let scale = 0.5 / 3.0_f64.cbrt();
        Ok(Arc::new(Ellipsoid::new([scale, 1.5 * scale, 2.0 * scale])?))
    }
    /// A mesh brought to the right volume.
    ///
    /// # Errors
    /// Those of the mesh.
    pub fn rock(mesh: &TriangleMesh) -> Outcome<Arc<dyn Shape>> {
        let scale = (VOLUME / mesh.volume()).cbrt();
        let scaled: Vec<[f64; 3]> = mesh.vertices().iter().map(|p| (scale * p.coords).into()).collect();
        Ok(Arc::new(TriangleMesh::new(&scaled, mesh.faces())?))
    }
    /// ν.
    pub fn viscosity(&self) -> f64 {
        (self.density_ratio - 1.0).abs().sqrt() / self.galileo
    }

    /// Where the bodies start: one in the middle but off the grid's symmetries, more on a lattice that is disturbed by up to a third of the room between them.
    fn starts(&self) -> Vec<[f64; 3]> {
        let size = self.box_.map(|n| n as f64);
        if self.bodies == 1 {
            let h = 1.0 / self.per_diameter as f64;
            return vec![[0.5 * size[0] + 0.31 * h, 0.5 * size[1] + 0.17 * h, 0.5 * size[2] + 0.43 * h]];
        }
        let per_axis = (self.bodies as f64).cbrt().ceil() as usize;
        let mut state = 1_u64;
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut place = |i: usize| {
            let at = [i % per_axis, i / per_axis % per_axis, i / (per_axis * per_axis)];
            [0, 1, 2].map(|a| {
                let room = size[a] / per_axis as f64;
                (at[a] as f64 + 0.5) * room + draw() * 2.0 / 3.0 * (room - 1.0).max(0.0)
            })
        };
        (0..self.bodies).map(&mut place).collect()
    }

    /// The bodies at rest in fluid at rest.
    ///
    /// # Errors
    /// For what makes no scene.
    pub fn build<S: Exchange<3, Projection<3>>>(&self, strategy: S) -> Outcome<Fall<S>> {
        let size = self.box_.map(|n| n as f64);
        let grid = CartesianGrid::new(self.box_.map(|n| n * self.per_diameter), size)?;
        let fluid = Fluid { density: 1.0, viscosity: self.viscosity() };
        let flow = Projection::new(grid, Side::Periodic.everywhere(), fluid)?.with_diffusion(self.diffusion);
        let mut bodies = RigidBodies::new(Periods::new(size.map(Some)));
        let material = Material { density: self.density_ratio, ..Material::default() };
        for at in self.starts() {
            let orientation = Rotation::from_euler_angles(0.7, 0.4, 0.2);
            let pose = Pose { orientation, ..Pose::at(at) };
            bodies.add(self.shape.clone(), material, pose, Twist::default(), Freedom::FREE)?;
        }
        bodies.check_overlaps()?;
        let particles = Particles::new(bodies, self.forcing.clone(), 1.0, -Vector::z());
        Ok(Simulation::new(flow, particles.with_strategy(strategy), WeightBalance::NetWeight)?)
    }
}

/// The scene as a simulation.
pub type Fall<S> = Simulation<3, Particles<SmoothForcing, RigidBodies, S>>;

/// Time and mean velocity of the bodies at every snapshot.
#[derive(Clone, Debug, Default)]
pub struct Speeds(pub Vec<(f64, Vector)>);

impl<const D: usize, F: Forcing, B: Dynamics, S: Strategy> Observer<Simulation<D, Particles<F, B, S>>>
    for Speeds
{
    fn snapshot(
        &mut self,
        simulation: &mut Simulation<D, Particles<F, B, S>>,
        _: usize,
        info: &StepInfo,
    ) -> Result<(), CouplingError> {
        let bodies = &simulation.particles.bodies;
        let sum: Vector = (0..bodies.n_bodies()).map(|b| bodies.twist(BodyId(b)).linear).sum();
        self.0.push((info.time, sum / bodies.n_bodies() as f64));
        Ok(())
    }
}

impl Speeds {
    /// The velocity at the snapshot nearest to `time`.
    pub fn at(&self, time: f64) -> Option<Vector> {
        let off = |s: &&(f64, Vector)| (s.0 - time).abs();
        self.0.iter().min_by(|a, b| off(a).total_cmp(&off(b))).map(|s| s.1)
    }
}
