//! Bodies that leave through outlets, by all forcings of moving bodies.
use crate::with_threads;
use siltflow::coupling::{Particles, Simulation, WeightBalance};
use siltflow::dem::{Disc, Material, RigidBodies, Sphere};
use siltflow::flow::{CartesianGrid, Fluid, Profile, Projection, Side};
use siltflow::ibm::{Forcing, Hfdib, SmoothForcing};
use siltflow::interfaces::{BodyId, Freedom, Kinematics, Periods, Pose, Twist, Vector};

const DENSITY: f64 = 1000.0;

/// Lowest and highest speed, over that before the side, of a body of five cells across that crosses
/// it in a stream of `stream` \[m/s\], and the largest velocity of the fluid \[m/s\].
fn crossing<const D: usize>(
    forcing: impl Forcing,
    density: f64,
    side: Side,
    stream: f64,
    virtual_mass: Option<f64>,
) -> [f64; 3] {
    let h = 0.002;
    let cells: [usize; D] = std::array::from_fn(|a| if a == 0 { 30 } else { 14 });
    let size = cells.map(|n| n as f64 * h);
    let grid = CartesianGrid::new(cells, size).unwrap();
    let inlet = Side::Inlet(Profile::Uniform([stream, 0.0, 0.0]));
    let sides =
        std::array::from_fn(|a| if a == 0 { [inlet.clone(), side.clone()] } else { Side::FreeSlip.both() });
    let mut flow = Projection::new(grid, sides, Fluid { density: DENSITY, viscosity: 1e-5 }).unwrap();
    flow.set_velocity(|_| std::array::from_fn(|c| if c == 0 { stream } else { 0.0 }));
    let mut bodies = RigidBodies::with_law(Periods::default(), ());
    let material = Material { density, ..Material::default() };
    let pose = Pose::at([size[0] - 0.03, 0.0143, if D == 2 { 0.0 } else { 0.0139 }]);
    let twist = Twist { linear: 0.08 * Vector::x(), ..Twist::default() };
    match D {
        2 => bodies.add(Disc::new(0.005).unwrap(), material, pose, twist, Freedom::PLANAR),
        _ => bodies.add(Sphere::new(0.005).unwrap(), material, pose, twist, Freedom::FREE),
    }
    .unwrap();
    let mut particles = Particles::new(bodies, forcing, DENSITY, Vector::zeros());
    if let Some(factor) = virtual_mass {
        particles = particles.with_virtual_mass(factor);
    }
    let mut run = Simulation::new(flow, particles, WeightBalance::None).unwrap();
    let (mut before, mut fastest, mut range) = (0.0, 0.0_f64, [f64::INFINITY, 0.0_f64]);
    for _ in 0..300 {
        let bodies = &run.particles.bodies;
        let (x, speed) = (bodies.pose(BodyId(0)).position.x, bodies.twist(BodyId(0)).linear.x);
        if x < size[0] - 0.0075 {
            before = speed;
        } else {
            range = [range[0].min(speed), range[1].max(speed)];
        }
        if x > size[0] + 0.0045 {
            return [range[0] / before, range[1] / before, fastest];
        }
        run.step(0.006).unwrap();
        let speeds = (0..D).flat_map(|c| run.flow.centred_velocity(c));
        fastest = speeds.fold(fastest, |most, u| most.max(u.abs()));
    }
    panic!("the body has not passed");
}

/// Bodies cross outlets at their speed, and nothing is faster than a stream past them: with outlets
/// that move on by the velocity before the forcing `Hfdib` diverges.
#[test]
fn bodies_pass_outlets_at_their_speed() {
    fn all<const D: usize>() {
        for side in [Side::ConvectiveOutlet, Side::PressureOutlet(0.0)] {
            for (density, stream) in [(1010.0, 0.08), (4000.0, 0.08), (1010.0, 0.05), (4000.0, 0.05)] {
                let found = [
                    crossing::<D>(SmoothForcing::new(DENSITY), density, side.clone(), stream, None),
                    crossing::<D>(Hfdib::new(DENSITY), density, side.clone(), stream, Some(1.0)),
                ];
                for (forcing, [least, most, fastest]) in ["smooth", "hfdib"].into_iter().zip(found) {
                    assert!(
                        least > 0.95 && most < 1.03 && fastest < 0.11,
                        "{D}D, {forcing}, {side:?}, {density}, {stream}: {least} {most} {fastest}"
                    );
                }
            }
        }
    }
    with_threads(1, || {
        all::<2>();
        all::<3>();
    });
}
