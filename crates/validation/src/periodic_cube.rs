//! Creeping flow through a cubic array of spheres.
use crate::Outcome;
use crate::prescribed_bodies::PrescribedBodies;
use coupling::FlowSolver;
use dem::Sphere;
use fv_mesh::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use ibm::Forcing;
use std::f64::consts::PI;

/// Edge of the cube over the diameter.
const EDGE: usize = 4;
/// Force per mass that drives the flow.
const PUSH: f64 = 1e-3;

/// The drag of a fixed sphere of diameter 1 in a periodic cube of edge 4 over 6πμRU, U the mean velocity of fluid and sphere together, Re → 0.
///
/// # Errors
/// Those of grid, flow and forcing.
pub fn drag(per_diameter: usize, mut forcing: Box<dyn Forcing>) -> Outcome<f64> {
    let (edge, h) = (EDGE as f64, 1.0 / per_diameter as f64);
    let grid = CartesianGrid::new([EDGE * per_diameter; 3], [edge; 3])?;
    let fluid = Fluid { density: 1.0, viscosity: 1.0 };
    let mut flow =
        Projection::new(grid, Side::Periodic.everywhere(), fluid)?.with_diffusion(Diffusion::Explicit);
    // Neither on a face nor on a centre.
    let at = [0.23, 0.11, 0.37].map(|part| 0.5 * edge + part * h);
    let sphere = PrescribedBodies::default().with(Sphere::new(0.5)?, at, 0.0);
    let volume = edge.powi(3);
    let mut last = 0.0;
    loop {
        let end = flow.time() + 0.2;
        while flow.time() < end {
            let dt = flow.stable_dt(0.4);
            flow.predict(dt, [PUSH, 0.0, 0.0])?;
            forcing.begin(flow.viscous_step(dt));
            forcing.place(flow.velocity(), &sphere)?;
            for _ in 0..forcing.rounds() {
                forcing.force(flow.velocity_mut(), &sphere);
                flow.project(dt)?;
            }
            flow.finish(dt)?;
        }
        let mean = flow.statistics().volume_flow.x / volume;
        if (mean / last - 1.0_f64).abs() < 1e-5 {
            return Ok(PUSH * volume / (3.0 * PI * mean));
        }
        last = mean;
    }
}

/// What it is after Hasimoto (1959, J. Fluid Mech. 5, 317) with a term more by Sangani & Acrivos (1982, Int. J. Multiphase Flow 8, 343):
/// 1/(1 − 1.7601 φ^⅓ + φ − 1.5593 φ²), φ the share of the cube that the sphere fills; 1.5304.
pub fn hasimoto() -> f64 {
    let share = PI / 6.0 / (EDGE as f64).powi(3);
    1.0 / (1.0 - 1.7601 * share.cbrt() + share - 1.5593 * share * share)
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_sphere_of_a_cube_of_four_diameters_is_held_back_half_as_much_again() {
        assert!((super::hasimoto() - 1.5304).abs() < 1e-4);
    }
}
