//! The coupled time step written by hand, from the pieces that `coupling::run` and `Simulation` are
//! made of: a disc falls onto the floor of a box of water.
//!
//! ```text
//! u* = uⁿ + Δt (−∇·(uu) − ∇p/ρ + ν∇²u)ⁿ        predict
//! vⁿ⁺¹, xⁿ⁺¹ by loads and contacts; f_ib, ∇p   couple
//! tⁿ⁺¹ = tⁿ + Δt                               finish
//! ```
//!
//! `cargo run --release --example by_hand [FOLDER]`, 1 s; `out/by_hand/height.png`.
use render::sketch::{Drawing, draw};
use siltflow::coupling::{Immersed, Particles, Timings};
use siltflow::dem::{Disc, HalfSpace, Material, RigidBodies};
use siltflow::flow::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{BodyId, Freedom, Kinematics, Periods, Point, Pose, Twist, Vector};
use std::error::Error;

const RADIUS: f64 = 0.5e-3; // m

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::args().nth(1).unwrap_or("out/by_hand".into());
    let water = Fluid { density: 1000.0, viscosity: 1e-6 };
    let grid = CartesianGrid::new([48, 96], [4e-3, 8e-3])?;
    let mut flow = Projection::new(grid, Side::WALL.everywhere(), water)?.with_diffusion(Diffusion::Explicit);

    let stone = Material { density: 2500.0, damping: 4.0, ..Material::default() };
    let mut bodies = RigidBodies::new(Periods::default());
    let (pose, rest) = (Pose::at([2e-3, 6e-3, 0.0]), Twist::default());
    bodies.add(Disc::new(RADIUS)?, stone, pose, rest, Freedom::PLANAR)?;
    bodies.add_wall(HalfSpace::new(Point::origin(), Vector::y())?, stone)?;
    let (gravity, forcing) = (Vector::new(0.0, -9.81, 0.0), SmoothForcing::new(water.density));
    let mut discs = Particles::new(bodies, forcing, water.density, gravity);

    let (mut timings, mut heights, mut next) = (Timings::default(), Vec::new(), 0.0);
    while flow.time() < 0.2 {
        // From rest in small steps: the speed of a body that is released grows like √t at first.
        let ramp = (0.05 * 1.15_f64.powi(flow.steps() as i32)).min(1.0);
        let dt = flow.stable_dt(0.2) * ramp;
        discs.begin(&mut flow)?;
        flow.predict(dt, [0.0, 0.0])?;
        discs.couple(&mut flow, dt, &mut timings)?;
        flow.finish(dt)?;

        let (pose, twist) = (discs.bodies.pose(BodyId(0)), discs.bodies.twist(BodyId(0)));
        let (time, height) = (flow.time(), 1e3 * (pose.position.y - RADIUS));
        heights.push([time, height]);
        if time >= next {
            let load = discs.report(BodyId(0), dt).hydrodynamic.force.y;
            let speed = 1e3 * twist.linear.y;
            println!("{time:.3} s  gap {height:6.3} mm  {speed:7.2} mm/s  load {load:.2e} N/m");
            next += 0.02;
        }
    }
    let labels = ["time in s", "gap to the floor in mm"];
    let picture = Drawing::curves("A disc falls in water", labels, &[("disc", heights)]);
    std::fs::create_dir_all(&out)?;
    Ok(draw(format!("{out}/height.png").as_ref(), 1, &[picture])?)
}
