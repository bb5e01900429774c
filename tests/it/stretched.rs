//! Bodies on grids that are stretched away from them.
use crate::with_threads;
use siltflow::coupling::{CouplingError, Particles, Simulation, WeightBalance};
use siltflow::dem::{Disc, Material, RigidBodies};
use siltflow::flow::{Axis, CartesianGrid, Diffusion, Projection, Side};
use siltflow::ibm::{Forcing, Hfdib, IbmError, SmoothForcing};
use siltflow::interfaces::{BodyId, Freedom, Kinematics, Periods, Pose, Twist, Vector};
use validation::axes::gathered;
use validation::falling_discs::{BOX, FLUID, GRAVITY, MATERIAL};

const DIAMETER: f64 = 1e-3;
const CELLS: f64 = 15.0;

/// An axis from 0 to `length` with equal cells within `patch` that grow by `ratio` from cell to cell outside.
fn axis(length: f64, patch: [f64; 2], ratio: f64) -> Axis {
    gathered(length, DIAMETER / CELLS, patch, ratio, 0.0).unwrap()
}

fn simulation<F: Forcing>(
    axes: [Axis; 2],
    forcing: F,
) -> Result<Simulation<2, Particles<F, RigidBodies>>, CouplingError> {
    let mut bodies = RigidBodies::new(Periods::new(
        BOX.map(Some).into_iter().chain([None]).collect::<Vec<_>>().try_into().unwrap(),
    ));
    let material = Material { density: 1060.0, ..MATERIAL };
    let pose = Pose::at([5.02e-3, 16.03e-3, 0.0]);
    bodies
        .add(Disc::new(0.5 * DIAMETER).unwrap(), material, pose, Twist::default(), Freedom::PLANAR)
        .unwrap();
    let grid = CartesianGrid::from_axes(axes).unwrap();
    let sides = [Side::Periodic.both(), Side::Periodic.both()];
    let flow = Projection::new(grid, sides, FLUID).unwrap().with_diffusion(Diffusion::Explicit);
    let particles = Particles::new(bodies, forcing, FLUID.density, Vector::new(0.0, -GRAVITY, 0.0));
    // The paper's forcing is unstable for bodies this light without.
    let particles = particles.with_virtual_mass(1.0);
    Simulation::new(flow, particles, WeightBalance::NetWeight)
}

/// Falling speed after so many steps of 0.2 ms.
fn speed(axes: [Axis; 2], forcing: impl Forcing, steps: usize) -> f64 {
    with_threads(1, || {
        let mut simulation = simulation(axes, forcing).unwrap();
        for _ in 0..steps {
            simulation.step(2e-4).unwrap();
        }
        -simulation.particles.bodies.twist(BodyId(0)).linear.y
    })
}

#[test]
fn a_disc_falls_as_fast_where_the_grid_is_coarser_far_away() {
    let uniform = || [axis(BOX[0], [0.0, BOX[0]], 1.1), axis(BOX[1], [0.0, BOX[1]], 1.1)];
    let stretched = || [axis(BOX[0], [3.4e-3, 6.6e-3], 1.06), axis(BOX[1], [14.0e-3, 18.0e-3], 1.06)];
    let cells = stretched().map(|a| a.cells());
    assert!(cells[0] * cells[1] < 15_000, "{cells:?} instead of 150 × 300");
    let pairs = [
        ("smooth", [uniform(), stretched()].map(|a| speed(a, SmoothForcing::new(FLUID.density), 100))),
        ("paper's", [uniform(), stretched()].map(|a| speed(a, Hfdib::new(FLUID.density), 100))),
    ];
    for (name, [u, s]) in pairs {
        println!("{name}: {u:e} {s:e}, {:e}", s / u - 1.0);
        assert!(u > 1e-3 && (s / u - 1.0).abs() < 5e-3, "{name}: {u:e} on the uniform grid, {s:e}");
    }
}

/// The smooth forcing says where it lacks equal cells; the paper's does without.
#[test]
fn a_body_among_unequal_cells_is_named() {
    let axes = || [axis(BOX[0], [4.7e-3, 5.3e-3], 1.04), axis(BOX[1], [14.0e-3, 18.0e-3], 1.06)];
    let error = with_threads(1, || {
        simulation(axes(), SmoothForcing::new(FLUID.density)).unwrap().step(1e-4).unwrap_err()
    });
    let CouplingError::Immersed(IbmError::Stretched { body: BodyId(0), axis: 0, least, most }) = error else {
        panic!("{error}");
    };
    assert!((least / (DIAMETER / CELLS) - 1.0).abs() < 1e-6 && most > 1.04 * least, "{least} {most}");
    assert!(speed(axes(), Hfdib::new(FLUID.density), 10) > 1e-4);
}
