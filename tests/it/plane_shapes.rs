//! Polygons that the flow moves.
use crate::with_threads;
use siltflow::coupling::{self, Particles, Schedule, Simulation, WeightBalance};
use siltflow::dem::{Disc, Material, Polygon, RigidBodies, Shape};
use siltflow::flow::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{BodyId, Freedom, Kinematics, Periods, Pose, Rotation, Twist, Vector};
use std::sync::atomic::AtomicBool;

const DIAMETER: f64 = 1e-3;

/// Twist of a body of 1.1 times the water's density, let go from rest, after 0.1 s: Reynolds number about 20, 12 cells per diameter.
fn after(shape: impl Shape + 'static, angle: f64) -> Twist {
    let (water, gravity) = (Fluid { density: 1000.0, viscosity: 1e-6 }, Vector::new(0.0, -9.81, 0.0));
    let grid = CartesianGrid::new([72, 96], [6.0 * DIAMETER, 8.0 * DIAMETER]).unwrap();
    let flow =
        Projection::new(grid, Side::WALL.everywhere(), water).unwrap().with_diffusion(Diffusion::Explicit);
    let mut bodies = RigidBodies::new(Periods::default());
    let stone = Material { density: 1100.0, ..Material::default() };
    let start = Pose {
        orientation: Rotation::from_scaled_axis(Vector::z() * angle),
        ..Pose::at([2.7 * DIAMETER, 6.1 * DIAMETER, 0.0])
    };
    bodies.add(shape, stone, start, Twist::default(), Freedom::PLANAR).unwrap();
    let particles = Particles::new(bodies, SmoothForcing::new(water.density), water.density, gravity);
    let mut fall = Simulation::new(flow, particles, WeightBalance::None).unwrap();
    let schedule = Schedule { end: 0.1, intervals: 1, courant: 0.2, ..Schedule::default() };
    coupling::run(&mut fall, &schedule, &mut (), &AtomicBool::new(false)).unwrap();
    fall.particles.bodies.twist(BodyId(0))
}

/// A polygon of many corners sinks as the disc that it stands for.
#[test]
fn polygons_sink_as_what_they_stand_for() {
    with_threads(1, || {
        let disc = after(Disc::new(0.5 * DIAMETER).unwrap(), 0.0);
        let many = after(Polygon::ellipse([0.5 * DIAMETER; 2], 120).unwrap(), 0.1);
        assert!(disc.linear.y < -1e-2, "{disc:?}");
        let off = (many.linear - disc.linear).norm() / disc.linear.norm();
        assert!(off < 5e-3, "{off:e}");
        assert!((many.angular - disc.angular).norm() * DIAMETER < 5e-3 * disc.linear.norm());
    });
}
