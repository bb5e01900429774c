//! The benchmark 2D-1 of Schäfer & Turek (1996): a cylinder of diameter 0.1 at (0.2, 0.2) in a channel of 2.2 × 0.41 at Re 20,
//! steady, by all ways to immerse it.
use crate::Outcome;
use crate::axes::{gathered, moved};
use crate::prescribed_bodies::{PrescribedBodies, forced_step};
use crate::walled_flows::{load_between, put_walls, surface_loads};
use dem::Disc;
use fv_mesh::{CartesianGrid, Convection, Diffusion, Fluid, Profile, Projection, Side};
use ibm::{Forcing, Hfdib, SmoothForcing};
use interfaces::{BodyId, Point, Vector};
use render::cpu::Stopwatch;
use std::fmt;

const DIAMETER: f64 = 0.1;
const LENGTHS: [f64; 2] = [2.2, 0.41];
const FLUID: Fluid = Fluid { density: 1.0, viscosity: 1e-3 };
/// Largest and mean speed at the inlet.
const PEAK: f64 = 0.3;
const MEAN: f64 = 0.2;
/// Drag and lift coefficient, and the pressure drop across the cylinder \[Pa\], by a spectral method (Nabh 1998).
pub const DRAG: f64 = 5.57953523384;
/// See [`DRAG`].
pub const LIFT: f64 = 0.010618948146;
/// See [`DRAG`].
pub const DROP: f64 = 0.11752016697;

/// The flow is steady when the drag changes by less than this part of itself in one unit of time (a flow of mean speed passes
/// two diameters), but not before the fluid at the inlet has passed the cylinder several times.
const STEADY: f64 = 2e-5;
const LEAST: f64 = 6.0;
const MOST: f64 = 60.0;

/// The ways to immerse it.
#[derive(Clone, Copy, Debug)]
pub enum Way {
    /// Cut links, with this convection scheme.
    CutLinks(Convection),
    /// [`SmoothForcing`].
    Smooth,
    /// [`Hfdib`].
    Hfdib,
}

/// The cells, always moved against the cylinder by parts of a cell; the inlet and the walls stay.
#[derive(Clone, Copy, Debug)]
pub enum Cells {
    /// All equal but beside the sides.
    Equal,
    /// Gathered round the cylinder, growing by this ratio outside.
    Gathered(f64),
}

/// What one grid gives.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Cells of the grid.
    pub cells: usize,
    /// Relative errors of the drag and lift coefficients, from the momentum that the walls or the forcing take, and of the
    /// pressure drop.
    pub errors: [f64; 3],
    /// Drag and lift coefficient.
    pub coefficients: [f64; 2],
    /// Relative errors of the drag and lift coefficients that pressure and friction on the surface give.
    pub surface: [f64; 2],
    /// The same of those that the momentum which enters a square of edge 2 D around the cylinder gives.
    pub around: [f64; 2],
    /// Steps made.
    pub steps: u64,
    /// CPU seconds, set-up included.
    pub cpu: f64,
}

/// What advances the flow by one step and tells the impulse on the cylinder.
type Step = Box<dyn FnMut(&mut Projection<2>, f64) -> Outcome<Vector>>;

impl fmt::Display for Way {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CutLinks(scheme) => write!(f, "cut links, {scheme:?}"),
            Self::Smooth => write!(f, "SmoothForcing"),
            Self::Hfdib => write!(f, "Hfdib"),
        }
    }
}

impl Way {
    /// Cells beside the surface whose values are not those of the fluid.
    fn clearance(self) -> f64 {
        match self {
            Self::CutLinks(_) => 0.0,
            Self::Hfdib => 1.0,
            // The kernel reaches 2½ cells from markers that stand ⅓ inside.
            Self::Smooth => 2.0,
        }
    }
    fn step(self, flow: &mut Projection<2>, bodies: PrescribedBodies) -> Outcome<Step> {
        Ok(match self {
            Self::Smooth => forced(SmoothForcing::new(FLUID.density), bodies),
            Self::Hfdib => forced(Hfdib::new(FLUID.density), bodies),
            Self::CutLinks(_) => {
                put_walls(flow, &bodies)?;
                Box::new(|flow, dt| {
                    flow.advance(dt, [0.0; 2])?;
                    Ok(flow.wall_impulses()[0].force)
                })
            }
        })
    }
}

fn forced(mut forcing: impl Forcing + 'static, bodies: PrescribedBodies) -> Step {
    Box::new(move |flow, dt| {
        forced_step(flow, &mut forcing, &bodies, dt)?;
        Ok(forcing.reaction(BodyId(0)).force)
    })
}

/// Marches to the steady flow with `per_diameter` cells across the cylinder, moved by `shift` cells.
///
/// # Errors
/// Those of grid, bodies and flow.
pub fn run(way: Way, kind: Cells, per_diameter: usize, shift: [f64; 2]) -> Outcome<Found> {
    let watch = Stopwatch::start();
    let h = DIAMETER / per_diameter as f64;
    let axes = match kind {
        Cells::Equal => [moved(LENGTHS[0], h, shift[0])?, moved(LENGTHS[1], h, shift[1])?],
        Cells::Gathered(ratio) => [
            gathered(LENGTHS[0], h, [0.12, 0.36], ratio, shift[0])?,
            gathered(LENGTHS[1], h, [0.12, 0.28], ratio, shift[1])?,
        ],
    };
    let grid = CartesianGrid::from_axes(axes)?;
    let cells = grid.n_cells();
    let inlet = Side::Inlet(Profile::Parabolic { peak: PEAK });
    let sides = [[inlet, Side::PressureOutlet(0.0)], Side::WALL.both()];
    let mut flow = Projection::new(grid, sides, FLUID)?.with_diffusion(Diffusion::Explicit);
    if let Way::CutLinks(scheme) = way {
        flow = flow.with_convection(scheme);
    }
    flow.set_velocity(|x| [4.0 * PEAK * x[1] * (LENGTHS[1] - x[1]) / (LENGTHS[1] * LENGTHS[1]), 0.0]);
    let bodies = PrescribedBodies::default().with(Disc::new(0.5 * DIAMETER)?, [0.2, 0.2, 0.0], 0.0);
    let mut step = way.step(&mut flow, bodies.clone())?;
    let coefficient = 2.0 / (FLUID.density * MEAN * MEAN * DIAMETER);
    let (mut last, mut next) = (f64::INFINITY, LEAST);
    let force = loop {
        let dt = flow.stable_dt(0.4);
        let force = step(&mut flow, dt)? * (coefficient / dt);
        if flow.time() < next {
            continue;
        }
        if (force.x / last - 1.0).abs() < STEADY || flow.time() > MOST {
            break force;
        }
        (last, next) = (force.x, flow.time() + 1.0);
    };
    let loads = surface_loads(&flow, &bodies, 0, way.clearance())?;
    let total = loads.total().force * coefficient;
    let corners = [0.1, 0.3].map(|x| Point::new(x, x, 0.0));
    let around = load_between(&flow, flow.pressure().data(), corners)?.force * coefficient;
    // At the stagnation points.
    let end = |sign: f64| {
        let nearest = loads.points.iter().max_by(|p, q| (sign * p.normal.x).total_cmp(&(sign * q.normal.x)));
        nearest.map_or(f64::NAN, |p| p.pressure)
    };
    Ok(Found {
        cells,
        errors: [force.x / DRAG - 1.0, force.y / LIFT - 1.0, (end(-1.0) - end(1.0)) / DROP - 1.0],
        coefficients: [force.x, force.y],
        surface: [total.x / DRAG - 1.0, total.y / LIFT - 1.0],
        around: [around.x / DRAG - 1.0, around.y / LIFT - 1.0],
        steps: flow.steps(),
        cpu: watch.elapsed().cpu,
    })
}
