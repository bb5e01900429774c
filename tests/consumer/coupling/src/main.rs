//! A disc settles in a periodic box of water.
use coupling::dem::{Disc, Material, RigidBodies};
use coupling::fv_mesh::{CartesianGrid, Fluid, Projection, Side};
use coupling::ibm::SmoothForcing;
use coupling::{BodyId, Freedom, Kinematics, Periods, Pose, Twist, Vector};
use coupling::{Particles, Simulation, WeightBalance};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (size, water) = ([4e-3, 8e-3], Fluid { density: 1000.0, viscosity: 1e-6 });
    let mut bodies = RigidBodies::new(Periods::new([Some(size[0]), Some(size[1]), None]));
    let (disc, heavy) = (Disc::new(0.5e-3)?, Material { density: 1100.0, ..Material::default() });
    bodies.add(disc, heavy, Pose::at([2e-3, 6e-3, 0.0]), Twist::default(), Freedom::PLANAR)?;
    let flow = Projection::new(CartesianGrid::new([32, 64], size)?, Side::Periodic.everywhere(), water)?;
    let gravity = Vector::new(0.0, -9.81, 0.0);
    let discs = Particles::new(bodies, SmoothForcing::new(water.density), water.density, gravity);
    let mut simulation = Simulation::new(flow, discs, WeightBalance::NetWeight)?;
    for _ in 0..50 {
        simulation.step(2e-4)?;
    }
    let speed = -simulation.particles.bodies.twist(BodyId(0)).linear.y;
    assert!(speed > 0.0 && speed < 0.1);
    println!("coupling: settles at {speed:.2e} m/s");
    Ok(())
}
