//! Smooth forcing of surfaces that are a fraction of a cell from their own periodic images, from
//! one another or from a side.
use crate::with_threads;
use siltflow::coupling::{Particles, Simulation, WeightBalance};
use siltflow::dem::{Cuboid, Disc, Material, Polygon, RigidBodies, Sphere};
use siltflow::flow::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use siltflow::ibm::SmoothForcing;
use siltflow::interfaces::{BodyId, Freedom, Kinematics, Periods, Pose, Twist, Vector};

type Forced<const D: usize> = Simulation<D, Particles<SmoothForcing, RigidBodies>>;

/// Gaps in cells.
const GAPS: [f64; 10] = [-0.5, -0.1, 0.0, 0.05, 0.1, 0.3, 0.5, 1.0, 2.0, 3.0];

const FLUID: Fluid = Fluid { density: 1.0, viscosity: 0.01 };

/// Largest |u_c| of any node that `at` selects.
fn fastest<const D: usize>(flow: &Projection<D>, at: impl Fn([f64; D]) -> bool) -> f64 {
    let grid = flow.grid();
    (0..D)
        .flat_map(|c| flow.centred_velocity(c).enumerate())
        .filter(|(cell, _)| at(grid.centre(grid.cell(*cell))))
        .fold(0.0, |most: f64, (_, u)| if u.is_nan() { f64::NAN } else { most.max(u.abs()) })
}

/// 1 × 1 m in 24 cells, x periodic, a lid above that moves at 1 m/s, over a fixed block whose top
/// is at 0.5 m and that is `gap` cells shorter than the period.
fn covered(gap: f64) -> Forced<2> {
    let n = 24;
    let grid = CartesianGrid::new([n, n], [1.0, 1.0]).unwrap();
    let sides = [Side::Periodic.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]];
    let mut flow = Projection::new(grid, sides, FLUID).unwrap().with_diffusion(Diffusion::Explicit);
    flow.set_velocity(|[_, y]| [(2.0 * y - 1.0).max(0.0), 0.0]);
    let mut bodies = RigidBodies::new(Periods::new([Some(1.0), None, None]));
    let block = Polygon::rectangle([1.0 - gap / n as f64, 0.3]).unwrap();
    let pose = Pose::at([0.513, 0.35, 0.0]);
    bodies.add(block, Material::default(), pose, Twist::default(), Freedom::NONE).unwrap();
    let particles = Particles::new(bodies, SmoothForcing::new(1.0), 1.0, Vector::zeros());
    Simulation::new(flow, particles, WeightBalance::None).unwrap()
}

/// Couette flow over a block that closes on itself, or nearly so, whatever the step. Measured: 0.02
/// in the solid 1.2 cells below its surface, as in a block that is clear of its image.
#[test]
fn a_block_and_its_images_are_a_wall() {
    with_threads(1, || {
        for gap in GAPS {
            for share in [1.0, 0.1] {
                let mut run = covered(gap);
                let dt = share * 0.8 * run.flow.viscous_limit().min(0.4 / 24.0);
                for _ in 0..(0.5 / dt).ceil() as usize {
                    run.step(dt).unwrap();
                }
                let solid = fastest(&run.flow, |[_, y]| (0.25..0.45).contains(&y));
                let grid = run.flow.grid();
                let off = |(cell, u): (usize, f64)| {
                    let y = grid.centre(grid.cell(cell))[1];
                    if y > 0.53 { (u - (2.0 * y - 1.0)).abs() } else { 0.0 }
                };
                let off = run.flow.centred_velocity(0).enumerate().map(off).fold(0.0, f64::max);
                assert!(solid < 0.03 && off < 0.03, "{gap} cells, {share}: {solid} {off}");
            }
        }
    });
}

/// A force of 1 N/kg along y in a periodic box that a block and its images close but for a slot: a
/// slot of three cells lets through three quarters of what fully developed flow would (it is not
/// yet), two cells half of that, closed ones less than 1/250 of the free fall.
#[test]
fn slots_let_through_what_they_should() {
    with_threads(1, || {
        for gap in GAPS {
            for share in [1.0, 0.1] {
                let n = 24;
                let grid = CartesianGrid::new([n, n], [1.0, 1.0]).unwrap();
                let flow = Projection::new(grid, Side::Periodic.everywhere(), FLUID).unwrap();
                let mut bodies = RigidBodies::new(Periods::new([Some(1.0), Some(1.0), None]));
                let block = Polygon::rectangle([1.0 - gap / n as f64, 0.4]).unwrap();
                let pose = Pose::at([0.513, 0.35, 0.0]);
                bodies.add(block, Material::default(), pose, Twist::default(), Freedom::NONE).unwrap();
                let particles = Particles::new(bodies, SmoothForcing::new(1.0), 1.0, Vector::zeros());
                let flow = flow.with_diffusion(Diffusion::Explicit);
                let run = Simulation::new(flow, particles, WeightBalance::None).unwrap();
                let mut run = run.with_force(|_| Vector::y());
                let dt = share * 0.8 * run.flow.viscous_limit().min(0.4 / 24.0);
                for _ in 0..(0.5 / dt).ceil() as usize {
                    run.step(dt).unwrap();
                }
                let rate = run.flow.statistics().volume_flow.y;
                // All of the head is lost in the slot: G w³/12ν, G = 1/0.4.
                let width = gap / n as f64;
                let developed = width.powi(3) / (0.4 * 12.0 * FLUID.viscosity);
                match gap {
                    ..0.9 => assert!(rate.abs() < 2e-3, "{gap} cells, {share}: {rate}"),
                    ..1.9 => assert!((0.0..developed).contains(&rate), "{gap} cells, {share}: {rate}"),
                    _ => assert!(
                        (0.3..0.9).contains(&(rate / developed)),
                        "{gap} cells, {share}: {rate} {developed}"
                    ),
                }
            }
        }
    });
}

/// Bodies 8 cells across under a lid, 1.5 times as heavy as the fluid: fixed and free side by side,
/// and at a side.
fn beside<const D: usize>(gap: f64, free: &[bool], at_side: bool, round: bool) -> Forced<D> {
    let h = 1.0 / 20.0;
    let grid = CartesianGrid::new([20; D], [1.0; D]).unwrap();
    let sides = std::array::from_fn(|a| {
        if a == 1 { [Side::WALL, Side::Wall([1.0, 0.0, 0.0])] } else { Side::WALL.both() }
    });
    let flow = Projection::new(grid, sides, FLUID).unwrap().with_diffusion(Diffusion::Explicit);
    let mut bodies = RigidBodies::new(Periods::default());
    let material = Material { density: 1.5, ..Material::default() };
    let wide = if D == 2 { 8.0 * h } else { 6.0 * h };
    let first = if at_side { gap * h + 0.5 * wide } else { 0.26 };
    for (b, &free) in free.iter().enumerate() {
        let freedom = match (free, D) {
            (false, _) => Freedom::NONE,
            (true, 2) => Freedom::PLANAR,
            (true, _) => Freedom::FREE,
        };
        let at = first + b as f64 * (wide + gap * h);
        let (pose, twist) = (Pose::at([at, 0.51, if D == 2 { 0.0 } else { 0.49 }]), Twist::default());
        match (D, round) {
            (2, true) => bodies.add(Disc::new(0.5 * wide).unwrap(), material, pose, twist, freedom),
            (2, false) => bodies.add(Polygon::rectangle([wide; 2]).unwrap(), material, pose, twist, freedom),
            (_, true) => bodies.add(Sphere::new(0.5 * wide).unwrap(), material, pose, twist, freedom),
            (_, false) => bodies.add(Cuboid::new([wide; 3]).unwrap(), material, pose, twist, freedom),
        }
        .unwrap();
    }
    let particles = Particles::new(bodies, SmoothForcing::new(1.0), 1.0, -Vector::y());
    Simulation::new(flow, particles, WeightBalance::None).unwrap()
}

/// Nothing is faster than the lid, and what the bodies do hardly depends on the step.
fn stays_slow<const D: usize>(steps: usize) {
    with_threads(1, || {
        for (free, at_side) in [
            (&[false, false][..], false),
            (&[false, true], false),
            (&[true, true], false),
            (&[true], true),
            (&[false], true),
        ] {
            // Overlapping bodies that are free push one another apart.
            let overlapping = !free.contains(&true);
            for gap in GAPS.into_iter().filter(|gap| *gap >= 0.0 || overlapping) {
                for round in [true, false] {
                    for share in [1, 10] {
                        let mut run = beside::<D>(gap, free, at_side, round);
                        let dt = 0.8 * run.flow.viscous_limit().min(0.4 / 20.0) / share as f64;
                        for _ in 0..steps * share {
                            run.step(dt).unwrap();
                        }
                        let fast = fastest(&run.flow, |_| true);
                        let bodies = &run.particles.bodies;
                        let speed = (0..free.len())
                            .map(|b| bodies.twist(BodyId(b)).linear.norm())
                            .fold(0.0, f64::max);
                        let fall = steps as f64 * dt * share as f64;
                        assert!(
                            fast < 1.0 && speed < 0.5 * fall,
                            "{free:?}, side {at_side}, {gap} cells, round {round}, dt/{share}: {fast} {speed}"
                        );
                    }
                }
            }
        }
    });
}

#[test]
fn bodies_side_by_side_and_at_sides_in_the_plane() {
    stays_slow::<2>(20);
}

#[test]
fn bodies_side_by_side_and_at_sides_in_space() {
    stays_slow::<3>(4);
}
