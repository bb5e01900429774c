//! A flow of which a part between planes of symmetry was computed, as a whole.
use crate::Outcome;
use fv_mesh::{Axis, CartesianGrid, Projection, Sampler, Side};
use ibm::{SurfaceLoads, SurfaceStress};
use interfaces::{Bodies, BodyId, VelocityField};

/// Both sides of the planes x_a = 0 that are lower sides of the box where `mirrored` says so: velocity and, in its order of
/// storage, pressure. Nothing else of the flow that is answered means anything.
///
/// # Errors
/// Those of grid and flow.
fn unfolded<const D: usize>(flow: &Projection<D>, mirrored: [bool; D]) -> Outcome<(Projection<D>, Vec<f64>)> {
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
    Ok((whole, pressure))
}

/// Pressure and friction on the first body of a flow with planes of symmetry, all of it, at elements `spacing` \[m\] apart.
///
/// # Errors
/// Those of the whole flow's grid and of [`SurfaceStress::on`].
pub fn whole_surface_loads<const D: usize>(
    flow: &Projection<D>,
    mirrored: [bool; D],
    bodies: &dyn Bodies,
    spacing: f64,
) -> Outcome<SurfaceLoads> {
    let (whole, pressure) = unfolded(flow, mirrored)?;
    let lattice = whole.grid().lattice(None, whole.sides());
    let fluid = whole.fluid();
    let velocity: &dyn VelocityField = whole.velocity();
    let stress = SurfaceStress::new(velocity, &lattice, &pressure, fluid.density * fluid.viscosity);
    Ok(stress.on(bodies, BodyId(0), spacing)?)
}
