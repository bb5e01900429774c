//! The benchmark 3D-1Z of Schäfer & Turek (1996): a cylinder of diameter 0.1 across a duct of 2.5 × 0.41 × 0.41 at Re 20, steady, by
//! cut links on cells gathered round it. The flow is the same on both sides of the duct's middle plane: one half is computed.
use crate::Outcome;
use crate::axes::gathered;
use crate::prescribed_bodies::{Post, PrescribedBodies};
use crate::unfolded::Unfolded;
use crate::walled_flows::put_walls;
use fv_mesh::{Axis, CartesianGrid, Convection, Diffusion, Fluid, Profile, Projection, Sampler, Side};
use interfaces::Vector;
use render::cpu::Stopwatch;

const DIAMETER: f64 = 0.1;
const LENGTH: f64 = 2.5;
const HEIGHT: f64 = 0.41;
const PLACE: [f64; 2] = [0.5, 0.2];
const FLUID: Fluid = Fluid { density: 1.0, viscosity: 1e-3 };
/// Largest and mean speed at the inlet.
const PEAK: f64 = 0.45;
const MEAN: f64 = 4.0 / 9.0 * PEAK;
/// Drag and lift coefficient 2F/(ρU²DH), by finite elements of high order (Braack & Richter 2006).
pub const DRAG: f64 = 6.18533;
/// See [`DRAG`].
pub const LIFT: f64 = 0.009401;
/// Between these lies the pressure drop across the cylinder in the middle plane \[Pa\] (Schäfer & Turek 1996).
pub const DROP: [f64; 2] = [0.165, 0.175];

/// The flow is steady when the drag changes by less than this part of itself in one unit of time (a flow of mean speed passes two
/// diameters), from `LEAST` on where it started from the inflow everywhere, from `AGAIN` on where from a coarser flow.
const STEADY: f64 = 2e-5;
const LEAST: f64 = 6.0;
const AGAIN: f64 = 2.0;
const MOST: f64 = 60.0;

/// What one grid gives.
pub struct Found {
    /// The flow at its end.
    pub flow: Projection<3>,
    /// Cells of the grid.
    pub cells: usize,
    /// Drag and lift coefficient, from the momentum that the walls take.
    pub coefficients: [f64; 2],
    /// The same from pressure and friction on the surface.
    pub surface: [f64; 2],
    /// Pressure drop from the front to the rear of the cylinder, in the middle plane \[Pa\].
    pub drop: f64,
    /// Steps made.
    pub steps: u64,
    /// CPU seconds, set-up included.
    pub cpu: f64,
}

/// Marches to the steady flow with `per_diameter` cells across the cylinder, moved by `shift` cells, from the flow on a `coarser` grid
/// or from the inflow everywhere.
///
/// # Errors
/// Those of grid, bodies and flow.
pub fn run(per_diameter: usize, shift: [f64; 2], coarser: Option<&Projection<3>>) -> Outcome<Found> {
    let watch = Stopwatch::start();
    let h = DIAMETER / per_diameter as f64;
    // Fine beside the wall, where the cylinder ends; from the middle plane on.
    let from_the_wall = gathered(0.5 * HEIGHT, h, [0.0, 0.05], 1.05, 0.0)?;
    let across: Vec<f64> = from_the_wall.faces().iter().rev().map(|z| 0.5 * HEIGHT - z).collect();
    let axes = [
        gathered(LENGTH, h, [0.42, 0.66], 1.05, shift[0])?,
        gathered(HEIGHT, h, [0.12, 0.28], 1.05, shift[1])?,
        Axis::from_faces(across)?,
    ];
    let grid = CartesianGrid::from_axes(axes)?;
    let cells = grid.n_cells();
    let inflow = |x: [f64; 3]| {
        let [y, z] = [x[1], x[2] + 0.5 * HEIGHT].map(|s| s * (HEIGHT - s) / (HEIGHT * HEIGHT));
        [16.0 * PEAK * y * z, 0.0, 0.0]
    };
    let inlet = Side::Inlet(Profile::function(move |x, _| inflow(x)));
    let sides = [[inlet, Side::PressureOutlet(0.0)], Side::WALL.both(), [Side::FreeSlip, Side::WALL]];
    let mut flow = Projection::new(grid, sides, FLUID)?
        .with_diffusion(Diffusion::Explicit)
        .with_convection(Convection::Quick);
    let post = Post { radius: 0.5 * DIAMETER, half: 0.5 * HEIGHT };
    let bodies = PrescribedBodies::default().with(post, [PLACE[0], PLACE[1], 0.0], 0.0);
    put_walls(&mut flow, &bodies)?;
    match coarser {
        None => flow.set_velocity(inflow),
        Some(coarser) => {
            let sampler = Sampler::new(coarser.grid(), coarser.sides());
            flow.set_velocity(|x| sampler.velocity(coarser.velocity(), x).unwrap_or_default());
        }
    }
    let coefficient = 2.0 / (FLUID.density * MEAN * MEAN * DIAMETER * 0.5 * HEIGHT);
    let (mut last, mut next) = (f64::INFINITY, if coarser.is_some() { AGAIN } else { LEAST });
    let force = loop {
        let dt = flow.stable_dt(0.4);
        flow.advance(dt, [0.0; 3])?;
        let force: Vector = flow.wall_impulses()[0].force * (coefficient / dt);
        if flow.time() < next {
            continue;
        }
        if (force.x / last - 1.0).abs() < STEADY || flow.time() > MOST {
            break force;
        }
        (last, next) = (force.x, flow.time() + 1.0);
    };
    let loads = Unfolded::new(&flow, [false, false, true])?.surface_loads(&bodies, h)?;
    let total = loads.total().force * (0.5 * coefficient);
    // At the stagnation points in the middle plane: the parabola through the pressures one, two and three cells before them.
    let sampler = Sampler::new(flow.grid(), flow.sides());
    let end = |sign: f64| -> Outcome<f64> {
        let at = |cells: f64| {
            sampler.at(flow.pressure(), [PLACE[0] + sign * (0.5 * DIAMETER + cells * h), PLACE[1], 0.0])
        };
        Ok(3.0 * (at(1.0)? - at(2.0)?) + at(3.0)?)
    };
    let drop = end(-1.0)? - end(1.0)?;
    Ok(Found {
        cells,
        coefficients: [force.x, force.y],
        surface: [total.x, total.y],
        drop,
        steps: flow.steps(),
        cpu: watch.elapsed().cpu,
        flow,
    })
}
