//! A cylinder of diameter 1 in a stream of speed 1, at least 30 diameters from every side, by cut links on cells gathered round it.
use crate::Outcome;
use crate::axes::gathered;
use crate::prescribed_bodies::PrescribedBodies;
use crate::wake::wake_length;
use crate::walled_flows::{put_walls, surface_loads};
use dem::Disc;
use fv_mesh::{CartesianGrid, Convection, Diffusion, Fluid, Profile, Projection, Sampler, Side};
use render::cpu::Stopwatch;

const LENGTHS: [f64; 2] = [68.0, 60.0];
const PLACE: [f64; 2] = [30.0, 30.0];

/// Less lift is what is left of the swirl that the run begins with.
const SWINGS: f64 = 0.05;

/// What one run gives.
#[derive(Clone, Copy, Debug, Default)]
pub struct Found {
    /// Cells of the grid.
    pub cells: usize,
    /// Drag coefficient 2F/(ρU²D), its mean where it swings.
    pub drag: f64,
    /// The same from the stress on the surface, at the end.
    pub surface: f64,
    /// The drag at the end, to compare with that.
    pub drag_at_end: f64,
    /// Length of the wake behind the cylinder \[D\], where it is steady.
    pub wake: f64,
    /// Amplitude of the lift coefficient.
    pub lift: f64,
    /// Strouhal number of the lift, fD/U; 0 where it does not swing.
    pub strouhal: f64,
    /// Steps made.
    pub steps: u64,
    /// CPU seconds.
    pub cpu: f64,
}

/// Runs to `end` \[D/U\]; the last half of the time counts where the wake swings, which it does above a Reynolds number of 47.
///
/// # Errors
/// Those of grid, walls and flow.
pub fn run(reynolds: f64, per_diameter: usize, end: f64) -> Outcome<Found> {
    let watch = Stopwatch::start();
    let h = 1.0 / per_diameter as f64;
    let axes = [
        gathered(LENGTHS[0], h, [PLACE[0] - 1.0, PLACE[0] + 3.5], 1.05, 0.37)?,
        gathered(LENGTHS[1], h, [PLACE[1] - 1.25, PLACE[1] + 1.25], 1.05, 0.3)?,
    ];
    let sides = [
        [Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0])), Side::PressureOutlet(0.0)],
        [Side::FreeSlip, Side::FreeSlip],
    ];
    let fluid = Fluid { density: 1.0, viscosity: 1.0 / reynolds };
    let flow = Projection::new(CartesianGrid::from_axes(axes)?, sides, fluid)?;
    let mut flow = flow.with_diffusion(Diffusion::Explicit).with_convection(Convection::Quick);
    let bodies = PrescribedBodies::default().with(Disc::new(0.5)?, [PLACE[0], PLACE[1], 0.0], 0.0);
    put_walls(&mut flow, &bodies)?;
    // A swirl behind the cylinder, so that a wake that may swing does.
    flow.set_velocity(|x| {
        let r2 = (x[0] - PLACE[0] - 1.5).powi(2) + (x[1] - PLACE[1]).powi(2);
        [1.0, 0.3 * (-r2).exp()]
    });
    let mut forces = Vec::new();
    while flow.time() < end {
        let dt = flow.stable_dt(0.4);
        flow.advance(dt, [0.0; 2])?;
        let force = flow.wall_impulses()[0].force * (2.0 / dt);
        forces.push([flow.time(), force.x, force.y]);
    }
    let late: Vec<[f64; 3]> = forces.into_iter().filter(|f| f[0] > 0.5 * end).collect();
    let last = late.last().copied().unwrap_or_default();
    let surface = 2.0 * surface_loads(&flow, &bodies, 0, 0.0)?.total().force.x;
    let mut found = Found {
        cells: flow.grid().n_cells(),
        drag: last[1],
        surface,
        drag_at_end: last[1],
        steps: flow.steps(),
        cpu: watch.elapsed().cpu,
        ..Found::default()
    };
    // Times at which the lift rises through zero.
    let rises: Vec<f64> = late
        .windows(2)
        .filter(|w| w[0][2] < 0.0 && w[1][2] >= 0.0)
        .map(|w| w[0][0] + (w[1][0] - w[0][0]) * w[0][2] / (w[0][2] - w[1][2]))
        .collect();
    found.lift = late.iter().fold(0.0, |most: f64, f| most.max(f[2].abs()));
    match rises[..] {
        [first, .., end] if found.lift > SWINGS => {
            found.strouhal = (rises.len() - 1) as f64 / (end - first);
            let whole: Vec<f64> = late.iter().filter(|f| f[0] >= first && f[0] < end).map(|f| f[1]).collect();
            found.drag = whole.iter().sum::<f64>() / whole.len() as f64;
        }
        _ => found.wake = wake(&flow)?,
    }
    Ok(found)
}

/// From the rear of the cylinder to where the velocity on the axis changes its sign.
fn wake(flow: &Projection<2>) -> Outcome<f64> {
    let sampler = Sampler::new(flow.grid(), flow.sides());
    let speed = |distance: f64| -> Outcome<f64> {
        Ok(sampler.velocity(flow.velocity(), [PLACE[0] + 0.5 + distance, PLACE[1]])?[0])
    };
    wake_length(speed, 0.2, 0.02)
}
