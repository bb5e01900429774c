//! The coupled time loop written by hand, from the pieces that `coupling::run` and `Simulation` are made of: a disc falls onto the floor of a box of water.
//!
//! Sample run: `cargo run --release --example by_hand`, a second; it prints height and speed.
use siltflow::coupling::{Immersed, Particles, Timings};
use siltflow::dem::{DemError, Disc, HalfSpace, Material, RigidBodies};
use siltflow::flow::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{BodyId, Freedom, Kinematics, Periods, Point, Pose, Twist, Vector};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (water, gravity) = (Fluid { density: 1000.0, viscosity: 1e-6 }, Vector::new(0.0, -9.81, 0.0));
    let grid = CartesianGrid::new([48, 96], [4e-3, 8e-3])?;
    let mut flow = Projection::new(grid, Side::WALL.everywhere(), water)?.with_diffusion(Diffusion::Explicit);
    let mut discs =
        Particles::new(disc_over_floor()?, SmoothForcing::new(water.density), water.density, gravity);
    let mut timings = Timings::default();
    let mut next = 0.0;
    while flow.time() < 0.2 {
        // From rest in small steps: a body that is let go is accelerated like √t.
        let dt = flow.stable_dt(0.2) * (0.05 * 1.15_f64.powi(flow.steps() as i32)).min(1.0);
        discs.begin(&mut flow)?;
        flow.predict(dt, [0.0, 0.0])?;
        discs.couple(&mut flow, dt, &mut timings)?;
        flow.finish(dt)?;
        if flow.time() >= next {
            let (pose, twist) = (discs.bodies.pose(BodyId(0)), discs.bodies.twist(BodyId(0)));
            let load = discs.report(BodyId(0), dt).hydrodynamic.force.y;
            let (height, speed) = (1e3 * pose.position.y, 1e3 * twist.linear.y);
            println!(
                "t {:.3} s  height {height:.3} mm  velocity {speed:7.2} mm/s  drag {load:.2e} N/m",
                flow.time()
            );
            next += 0.02;
        }
    }
    Ok(())
}

fn disc_over_floor() -> Result<RigidBodies, DemError> {
    let stone = Material { density: 2500.0, youngs_modulus: 1e6, ..Material::default() };
    let mut bodies = RigidBodies::new(Periods::default());
    bodies.add(Disc::new(0.5e-3)?, stone, Pose::at([2e-3, 6e-3, 0.0]), Twist::default(), Freedom::PLANAR)?;
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::y())?, stone)?;
    Ok(bodies)
}
