//! A sphere of diameter 1 in a stream of speed 1, by cut links on cells gathered round it. Up to a Reynolds number of 210 the wake is
//! steady and the same all round: a quarter between two planes of symmetry is computed.
use crate::Outcome;
use crate::axes::gathered;
use crate::prescribed_bodies::PrescribedBodies;
use crate::unfolded::Unfolded;
use crate::wake::wake_length;
use crate::walled_flows::put_walls;
use dem::Sphere;
use fv_mesh::{CartesianGrid, Convection, Diffusion, Fluid, Profile, Projection, Sampler, Side};
use interfaces::Point;
use render::cpu::Stopwatch;
use std::f64::consts::PI;

/// The sphere stands 12 D behind the inlet and 20 D before the outlet; the sides are 12 D away, so that it covers 0.14 % of the stream.
const LENGTHS: [f64; 3] = [32.0, 12.0, 12.0];
const PLACE: f64 = 12.0;
/// Growth of the cells away from the sphere.
const GROWTH: f64 = 1.1;
/// A quarter of the sphere faces the stream with this area.
const AREA: f64 = PI / 16.0;

/// The flow is steady when drag and wake change by less than this part of themselves in the time 2 D/U, from `LEAST` on where it
/// started from the undisturbed stream, from `AGAIN` on where from a coarser flow.
const STEADY: f64 = 2e-4;
const LEAST: f64 = 16.0;
const AGAIN: f64 = 6.0;
const MOST: f64 = 100.0;

/// Reynolds number, drag coefficient (Johnson & Patel 1999, J. Fluid Mech. 378, 19), and drag coefficient and length of the wake
/// \[D\] of axisymmetric solutions of the stream function and the vorticity (30 D around, second order, extrapolated from
/// 180 × 108 and 240 × 144 cells along ln r and the angle).
pub const REFERENCES: [[f64; 4]; 3] =
    [[25.0, 2.366, 2.367, 0.071], [100.0, 1.102, 1.089, 0.870], [200.0, 0.790, 0.773, 1.436]];

/// What one run gives.
pub struct Found {
    /// The flow at its end.
    pub flow: Projection<3>,
    /// Cells of the grid.
    pub cells: usize,
    /// Drag coefficient 2F/(ρU²πR²).
    pub drag: f64,
    /// The same from the stress on the surface.
    pub surface: f64,
    /// The same from the momentum that enters a cube of edge 2 D around it.
    pub around: f64,
    /// Length of the wake behind the sphere \[D\].
    pub wake: f64,
    /// Time at the end \[D/U\].
    pub time: f64,
    /// Steps made.
    pub steps: u64,
    /// CPU seconds.
    pub cpu: f64,
}

/// Marches to the steady flow with `per_diameter` cells across the sphere, moved by `shift` cells along the stream, from the flow on a
/// `coarser` grid or from the undisturbed stream.
///
/// # Errors
/// Those of grid, walls and flow.
pub fn run(
    reynolds: f64,
    per_diameter: usize,
    shift: f64,
    coarser: Option<&Projection<3>>,
) -> Outcome<Found> {
    let watch = Stopwatch::start();
    let h = 1.0 / per_diameter as f64;
    let across = gathered(LENGTHS[1], h, [0.0, 0.75], GROWTH, 0.0)?;
    let along = gathered(LENGTHS[0], h, [PLACE - 0.75, PLACE + 2.25], GROWTH, shift)?;
    let sides = [
        [Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0])), Side::PressureOutlet(0.0)],
        Side::FreeSlip.both(),
        Side::FreeSlip.both(),
    ];
    let fluid = Fluid { density: 1.0, viscosity: 1.0 / reynolds };
    let grid = CartesianGrid::from_axes([along, across.clone(), across])?;
    let flow = Projection::new(grid, sides, fluid)?;
    let mut flow = flow.with_diffusion(Diffusion::Explicit).with_convection(Convection::Quick);
    let bodies = PrescribedBodies::default().with(Sphere::new(0.5)?, [PLACE, 0.0, 0.0], 0.0);
    put_walls(&mut flow, &bodies)?;
    match coarser {
        None => flow.set_velocity(|_| [1.0, 0.0, 0.0]),
        Some(coarser) => {
            let sampler = Sampler::new(coarser.grid(), coarser.sides());
            flow.set_velocity(|x| sampler.velocity(coarser.velocity(), x).unwrap_or_default());
        }
    }
    let mut last = [f64::INFINITY; 2];
    let least = if coarser.is_some() { AGAIN } else { LEAST };
    let [drag, wake] = loop {
        let end = flow.time() + 2.0;
        let mut drag = 0.0;
        while flow.time() < end {
            let dt = flow.stable_dt(0.4);
            flow.advance(dt, [0.0; 3])?;
            drag = flow.wall_impulses()[0].force.x * (2.0 / (AREA * dt));
        }
        let now = [drag, wake(&flow, h)?];
        let steady = (0..2).all(|i| (now[i] - last[i]).abs() <= STEADY * now[i]);
        if steady && flow.time() > least || flow.time() > MOST {
            break now;
        }
        last = now;
    };
    let whole = Unfolded::new(&flow, [false, true, true])?;
    let surface = whole.surface_loads(&bodies, h)?.total().force.x * (0.5 / AREA);
    let corner = |side: f64| Point::new(PLACE + side, side, side);
    let around = whole.load_between([corner(-1.0), corner(1.0)])?.force.x * (0.5 / AREA);
    Ok(Found {
        cells: flow.grid().n_cells(),
        drag,
        surface,
        around,
        wake,
        time: flow.time(),
        steps: flow.steps(),
        cpu: watch.elapsed().cpu,
        flow,
    })
}

/// From the rear of the sphere to where the velocity on the axis changes its sign.
fn wake(flow: &Projection<3>, h: f64) -> Outcome<f64> {
    let sampler = Sampler::new(flow.grid(), flow.sides());
    // On the axis: the parabolas through the first two nodes, along y and z.
    let speed = |distance: f64| -> Outcome<f64> {
        let at = |y: f64, z: f64| -> Outcome<f64> {
            Ok(sampler.velocity(flow.velocity(), [PLACE + 0.5 + distance, y, z])?[0])
        };
        let [near, far] = [0.5 * h, 1.5 * h];
        Ok(1.25 * at(near, near)? - 0.125 * (at(far, near)? + at(near, far)?))
    };
    wake_length(speed, 0.02, 0.01)
}
