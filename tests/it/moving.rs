//! Bodies that move through the grid. `benches/moving` has more forcings, resolutions and steps.
use example_support::moved_body::{Noise, Swinging, passing};
use siltflow::coupling::{Particles, Simulation, WeightBalance};
use siltflow::dem::{Material, RigidBodies, Sphere};
use siltflow::flow::{CartesianGrid, Fluid, Projection, Side};
use siltflow::ibm::{Forcing, Hfdib, Kernel, SmoothForcing};
use siltflow::interfaces::{BodyId, Freedom, Kinematics, Periods, Pose, Twist, Vector};

fn quiet() -> Box<dyn Forcing> {
    Box::new(SmoothForcing::new(1.0).with_kernel(Kernel::QuinticSpline))
}

fn mean(series: &[f64]) -> f64 {
    series.iter().sum::<f64>() / series.len() as f64
}

/// A cylinder swings (Dütsch et al. 1998), 10 cells per diameter: what the grid adds to the force stays small, and does not grow as the step
/// shrinks. Measured: 0.09 % of the peak with both steps.
#[test]
fn forces_on_a_swinging_cylinder_are_quiet() {
    let noise = [200, 400].map(|steps| {
        let mut cylinder = Swinging::new(10, steps, [0.37, 0.3], quiet()).unwrap();
        cylinder.swing().unwrap();
        let noise = Noise::of(&cylinder.swing().unwrap(), 12);
        assert!((1.6..1.9).contains(&noise.peak), "{noise:?}");
        noise.rms / noise.peak
    });
    assert!(noise[0] < 2e-3 && noise[1] < 1.3 * noise[0], "{noise:?}");
}

/// A body that moves through fluid at rest and fluid that moves past the body at rest: one drag, in the plane and in space.
/// Measured: 0.3 and 0.4 % apart.
#[test]
fn it_does_not_matter_what_moves() {
    let ways: [fn() -> Box<dyn Forcing>; 2] = [quiet, || Box::new(Hfdib::new(1.0))];
    for forcing in ways {
        let drag = |moves| mean(&passing::<2>(moves, 8, 10, 0.025, [2.0, 0.02], forcing()).unwrap()[50..]);
        let (moving, still) = (drag(true), drag(false));
        assert!((moving / still - 1.0).abs() < 0.01, "{moving} {still}");
    }
    let drag = |moves| mean(&passing::<3>(moves, 3, 10, 0.025, [1.2, 0.02], quiet()).unwrap()[30..]);
    let (moving, still) = (drag(true), drag(false));
    assert!((moving / still - 1.0).abs() < 0.01, "{moving} {still}");
}

/// A free sphere falls straight down, more slowly than in empty space, and faster than a lighter one.
#[test]
fn a_sphere_falls_in_space() {
    let speed = |density: f64| {
        let grid = CartesianGrid::new([24; 3], [2.4e-3; 3]).unwrap();
        let flow =
            Projection::new(grid, Side::Periodic.everywhere(), Fluid { density: 1000.0, viscosity: 1e-6 })
                .unwrap();
        let mut bodies = RigidBodies::new(Periods::new([Some(2.4e-3); 3]));
        let material = Material { density, ..Material::default() };
        let start = Pose::at([1.213e-3, 1.196e-3, 1.207e-3]);
        bodies.add(Sphere::new(0.5e-3).unwrap(), material, start, Twist::default(), Freedom::FREE).unwrap();
        let gravity = Vector::new(0.0, 0.0, -9.81);
        let particles = Particles::new(bodies, SmoothForcing::new(1000.0), 1000.0, gravity);
        let mut simulation = Simulation::new(flow, particles, WeightBalance::NetWeight).unwrap();
        for _ in 0..40 {
            simulation.step(2.5e-4).unwrap();
        }
        let twist = simulation.particles.bodies.twist(BodyId(0));
        let sideways = twist.linear.xy().norm();
        assert!(sideways < 0.02 * twist.linear.z.abs(), "{twist:?}");
        -twist.linear.z
    };
    let (heavy, light) = (speed(2000.0), speed(1200.0));
    // In an ideal fluid it would be (ρ_s − ρ) g t/(ρ_s + ½ρ), 0.039 and 0.0115 m/s at 0.01 s.
    assert!((0.5 * 0.0392..0.0392).contains(&heavy), "{heavy}");
    assert!((0.5 * 0.01154..0.01154).contains(&light), "{light}");
}
