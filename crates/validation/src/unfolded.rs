//! A flow of which a part between planes of symmetry was computed, as a whole.
use crate::Outcome;
use crate::walled_flows::load_between;
use fv_mesh::{Axis, CartesianGrid, Projection, Sampler, Side};
use ibm::{SurfaceLoads, SurfaceStress};
use interfaces::{Bodies, BodyId, Point, Wrench};

/// A flow on both sides of planes of symmetry.
pub struct Unfolded<const D: usize> {
    /// Of this only velocity, grid and fluid mean anything.
    flow: Projection<D>,
    /// In its order of storage.
    pressure: Vec<f64>,
}

impl<const D: usize> Unfolded<D> {
    /// On both sides of the planes x_a = 0 that are lower sides of the box where `mirrored` says so.
    ///
    /// # Errors
    /// Those of grid and flow.
    pub fn new(flow: &Projection<D>, mirrored: [bool; D]) -> Outcome<Self> {
        let mut axes = Vec::new();
        for (a, mirrored) in mirrored.into_iter().enumerate() {
            let faces = flow.grid().axis(a).faces();
            let beyond = faces.iter().rev().map(|x| -x).take(if mirrored { faces.len() - 1 } else { 0 });
            axes.push(Axis::from_faces(beyond.chain(faces.iter().copied()).collect::<Vec<f64>>())?);
        }
        let axes = axes.try_into().map_err(|_| "as many axes as dimensions")?;
        let mut whole =
            Projection::new(CartesianGrid::from_axes(axes)?, Side::FreeSlip.everywhere(), flow.fluid())?;
        let sampler = Sampler::new(flow.grid(), flow.sides());
        let fold = |x: [f64; D]| std::array::from_fn(|a| if mirrored[a] { x[a].abs() } else { x[a] });
        whole.set_velocity(|x| {
            let u = sampler.velocity(flow.velocity(), fold(x)).unwrap_or([0.0; D]);
            std::array::from_fn(|a| if mirrored[a] && x[a] < 0.0 { -u[a] } else { u[a] })
        });
        let lattice = whole.grid().lattice(None, whole.sides());
        let [nx, ny, nz] = lattice.shape();
        let mut pressure = vec![0.0; whole.pressure().data().len()];
        for at in (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / (nx * ny)].map(|i| i as isize)) {
            let x = lattice.position(at);
            if let Some(index) = lattice.index(at) {
                pressure[index] = sampler.at(flow.pressure(), fold(std::array::from_fn(|a| x[a])))?;
            }
        }
        Ok(Self { flow: whole, pressure })
    }

    /// Pressure and friction on the first body, all of it, at elements `spacing` \[m\] apart.
    ///
    /// # Errors
    /// Those of [`SurfaceStress::on`].
    pub fn surface_loads(&self, bodies: &dyn Bodies, spacing: f64) -> Outcome<SurfaceLoads> {
        let fluid = self.flow.fluid();
        let lattice = self.flow.grid().lattice(None, self.flow.sides());
        let viscosity = fluid.density * fluid.viscosity;
        let stress = SurfaceStress::new(self.flow.velocity(), &lattice, &self.pressure, viscosity);
        Ok(stress.on(bodies, BodyId(0), spacing)?)
    }

    /// The load on what is at rest between these corners in a steady flow, from the momentum that comes in.
    ///
    /// # Errors
    /// Those of [`ibm::ControlVolume::new`].
    pub fn load_between(&self, corners: [Point; 2]) -> Outcome<Wrench> {
        load_between(&self.flow, &self.pressure, corners)
    }
}
