//! Steady flows beside immersed walls with exact or published answers.
use crate::Outcome;
use crate::prescribed_bodies::{Banks, Bore, PrescribedBodies};
use coupling::FlowSolver;
use dem::{Disc, Sphere};
use fv_mesh::{CartesianGrid, Diffusion, Fluid, Projection, Side};
use ibm::{ControlVolume, Forcing, SmoothForcing, SolidFraction, SurfaceLoads, SurfaceStress, cut_walls};
use interfaces::{BodyId, Point, VelocityField, Wrench};
use std::f64::consts::PI;

/// Kinematic viscosity of the plane flows \[m²/s\].
const VISCOSITY: f64 = 0.1;

/// Makes walls of `bodies`; tells how many faces they cut or close.
///
/// # Errors
/// Those of the cuts and of the flow.
pub fn put_walls<const D: usize>(flow: &mut Projection<D>, bodies: &PrescribedBodies) -> Outcome<usize> {
    let walls = cut_walls(flow.velocity(), bodies)?;
    let faces = walls.components.iter().map(|component| component.faces.len()).sum();
    flow.set_walls(Some(walls))?;
    Ok(faces)
}

/// Pressure and friction on body `b` from the fields beside it, at elements a cell apart; nodes nearer than `clearance` cells
/// are left out.
///
/// # Errors
/// Those of [`SurfaceStress::on`].
pub fn surface_loads<const D: usize>(
    flow: &Projection<D>,
    bodies: &PrescribedBodies,
    b: usize,
    clearance: f64,
) -> Outcome<SurfaceLoads> {
    let lattice = flow.grid().lattice(None, flow.sides());
    let fluid = flow.fluid();
    let spacing = flow.grid().spacing().into_iter().fold(f64::INFINITY, f64::min);
    Ok(SurfaceStress::new(flow.velocity(), &lattice, flow.pressure().data(), fluid.density * fluid.viscosity)
        .with_clearance(clearance)
        .on(bodies, BodyId(b), spacing)?)
}

/// The load on what is at rest between these corners in a steady flow with this `pressure`, from the momentum that comes in.
///
/// # Errors
/// Those of [`ControlVolume::new`].
pub fn load_between<const D: usize>(
    flow: &Projection<D>,
    pressure: &[f64],
    corners: [Point; 2],
) -> Outcome<Wrench> {
    let (fluid, lattice) = (flow.fluid(), flow.grid().lattice(None, flow.sides()));
    let properties = [fluid.density, fluid.density * fluid.viscosity];
    Ok(ControlVolume::new(flow.velocity(), &lattice, pressure, properties, corners)?.outflow() * -1.0)
}

/// Advances at a Courant number of 0.4 until `value` changes by less than the part `tolerance` of itself within `interval` \[s\].
///
/// # Errors
/// Those of the flow, and if that takes more than a thousand intervals.
pub fn settle<const D: usize>(
    flow: &mut Projection<D>,
    force: [f64; D],
    times: [f64; 2],
    value: impl Fn(&mut Projection<D>) -> f64,
) -> Outcome<f64> {
    settle_by(flow, times, |flow, dt| Ok(flow.advance(dt, force)?), value)
}

/// The same with steps of another kind.
fn settle_by<const D: usize>(
    flow: &mut Projection<D>,
    [interval, tolerance]: [f64; 2],
    mut step: impl FnMut(&mut Projection<D>, f64) -> Outcome<()>,
    value: impl Fn(&mut Projection<D>) -> f64,
) -> Outcome<f64> {
    let mut last = f64::INFINITY;
    for _ in 0..1000 {
        let end = flow.time() + interval;
        while flow.time() < end {
            let dt = flow.stable_dt(0.4);
            step(flow, dt)?;
        }
        let now = value(flow);
        if (now - last).abs() < tolerance * now.abs() {
            return Ok(now);
        }
        last = now;
    }
    Err(format!("not steady after 1000 intervals of {interval} s: {last}").into())
}

/// Largest difference of a velocity component from the exact one, and root mean square of the vector's, at the nodes where the
/// exact one is not zero.
pub fn velocity_errors<const D: usize>(
    flow: &Projection<D>,
    exact: impl Fn([f64; D]) -> [f64; D],
) -> [f64; 2] {
    let (mut worst, mut sum, mut nodes) = (0.0_f64, 0.0, 0);
    for c in 0..D {
        let lattice = flow.velocity().lattice(c);
        let [nx, ny, nz] = lattice.shape();
        for at in (0..nx * ny * nz).map(|i| [i % nx, i / nx % ny, i / (nx * ny)].map(|i| i as isize)) {
            let x = lattice.position(at);
            let wanted = exact(std::array::from_fn(|a| x[a]))[c];
            if wanted != 0.0
                && let Some(index) = lattice.index(at)
            {
                let error = flow.velocity().component(c)[index] - wanted;
                worst = worst.max(error.abs());
                sum += error * error;
                nodes += 1;
            }
        }
    }
    [worst, (D as f64 * sum / f64::from(nodes)).sqrt()]
}

/// Taylor–Couette flow: R 0.25 turns at 1 in R 0.5 at rest, `cells` per unit of length, moved by `shift` cells. It starts with
/// the exact velocity; the body of the inner wall is number 0.
///
/// # Errors
/// Those of the walls and of the flow.
pub fn couette(cells: usize, shift: [f64; 2]) -> Outcome<(Projection<2>, PrescribedBodies)> {
    let h = 1.0 / cells as f64;
    let half = 0.5 + 2.0 * h;
    let grid =
        CartesianGrid::new([cells + 4; 2], [2.0 * half; 2])?.with_origin(shift.map(|s| s * h - half))?;
    let fluid = Fluid { density: 1.0, viscosity: VISCOSITY };
    let mut flow = Projection::new(grid, Side::WALL.everywhere(), fluid)?;
    let inner = PrescribedBodies::default().with(Disc::new(0.25)?, [0.0; 3], 1.0);
    let bodies = inner.with(Bore { radius: 0.5, half: [2.0 * half; 2] }, [0.0; 3], 0.0);
    put_walls(&mut flow, &bodies)?;
    flow.set_velocity(couette_velocity);
    Ok((flow, bodies))
}

/// u_θ = −r/3 + 1/(12 r).
pub fn couette_velocity(x: [f64; 2]) -> [f64; 2] {
    let r = x[0].hypot(x[1]);
    let turn = if (0.25..0.5).contains(&r) { -1.0 / 3.0 + 1.0 / (12.0 * r * r) } else { 0.0 };
    [-turn * x[1], turn * x[0]]
}

/// Torque on the outer wall, 4πμ/12 \[N m per m\].
pub const COUETTE_TORQUE: f64 = 4.0 * PI * VISCOSITY / 12.0;

/// Plane Poiseuille flow in a channel that is turned against the grid, of width 1 and mean velocity 1.
pub struct TurnedChannel {
    /// The flow, which starts with the exact velocity.
    pub flow: Projection<2>,
    /// Faces that the walls cut or close.
    pub faces: usize,
    banks: Banks,
    place: [f64; 2],
}

impl TurnedChannel {
    /// Turned by about `degrees` (the box has whole cells), `cells` across, a little off the nodes of the grid.
    ///
    /// # Errors
    /// Those of the walls and of the flow.
    pub fn new(degrees: f64, cells: usize) -> Outcome<Self> {
        let (flow, banks, place, bodies) = turned(degrees, cells)?;
        let mut channel = Self { flow, faces: 0, banks, place };
        channel.faces = put_walls(&mut channel.flow, &bodies)?;
        channel.flow.set_velocity(|x| exact_in(&banks, place, x));
        Ok(channel)
    }
    /// The force per mass that drives it \[m/s²\].
    pub fn force(&self) -> [f64; 2] {
        pull(&self.banks)
    }
    /// The parabola, zero in the banks.
    pub fn exact(&self, x: [f64; 2]) -> [f64; 2] {
        exact_in(&self.banks, self.place, x)
    }
    /// Advances until the flow is steady; answers its mean velocity.
    ///
    /// # Errors
    /// Those of [`settle`].
    pub fn mean(&mut self, tolerance: f64) -> Outcome<f64> {
        let ([along, _], lengths, force) = (self.banks.axes(), self.banks.lengths, self.force());
        settle(&mut self.flow, force, [0.05 / VISCOSITY, tolerance], |flow| {
            let total = flow.statistics().volume_flow;
            (total.x * along[0] + total.y * along[1]) / lengths[0].hypot(lengths[1])
        })
    }
}

/// The force per mass that drives a mean velocity of 1 \[m/s²\].
fn pull(banks: &Banks) -> [f64; 2] {
    banks.axes()[0].map(|a| a * 12.0 * VISCOSITY)
}

/// A periodic box with banks of a channel; the place of the banks, too.
fn turned(degrees: f64, cells: usize) -> Outcome<(Projection<2>, Banks, [f64; 2], PrescribedBodies)> {
    let h = 1.0 / cells as f64;
    let slope = degrees.to_radians();
    let count = [2.0 / slope.sin(), 2.0 / slope.cos()].map(|length| (length / h).round());
    let lengths = count.map(|n| n * h);
    let grid = CartesianGrid::new(count.map(|n| n as usize), lengths)?;
    let grid = grid.with_origin(lengths.map(|l| -0.5 * l))?;
    let fluid = Fluid { density: 1.0, viscosity: VISCOSITY };
    let flow = Projection::new(grid, Side::Periodic.everywhere(), fluid)?.with_diffusion(Diffusion::Explicit);
    let banks = Banks { lengths, width: 1.0 };
    let place = [0.0123 * h, 0.0371 * h];
    let bodies = PrescribedBodies::default().with(banks, [place[0], place[1], 0.0], 0.0);
    Ok((flow, banks, place, bodies))
}

/// The turned channel by [`SmoothForcing`]; the force acts on the fluid alone.
pub struct ForcedChannel {
    /// The flow, which starts with the exact velocity.
    pub flow: Projection<2>,
    forcing: SmoothForcing,
    bodies: PrescribedBodies,
    banks: Banks,
    /// 1 − λ at the nodes of either component.
    open: [Vec<f64>; 2],
}

impl ForcedChannel {
    /// Turned by about `degrees`, `cells` across.
    ///
    /// # Errors
    /// Those of the flow and of λ.
    pub fn new(degrees: f64, cells: usize, forcing: SmoothForcing) -> Outcome<Self> {
        let (mut flow, banks, place, bodies) = turned(degrees, cells)?;
        flow.set_velocity(|x| exact_in(&banks, place, x));
        let mut open = [Vec::new(), Vec::new()];
        for (c, open) in open.iter_mut().enumerate() {
            let mut inside = SolidFraction::new();
            inside.update(flow.velocity().lattice(c), &bodies)?;
            open.resize(flow.velocity().component(c).len(), 1.0);
            // The banks go on in the images of the box: nodes beside its sides may come twice.
            inside.nodes(BodyId(0)).iter().for_each(|node| open[node.index] = 1.0 - node.fraction);
        }
        Ok(Self { flow, forcing, bodies, banks, open })
    }
    /// Advances until the flow is steady; answers the flow rate of the channel, and of all the box.
    ///
    /// # Errors
    /// Those of flow and forcing.
    pub fn rates(&mut self, tolerance: f64) -> Outcome<[f64; 2]> {
        let Self { flow, forcing, bodies, banks, open } = self;
        let ([along, _], pull) = (banks.axes(), pull(banks));
        let length = banks.lengths[0].hypot(banks.lengths[1]);
        let cell: f64 = flow.grid().spacing().into_iter().product();
        let rate = |flow: &Projection<2>| {
            let through = |c: usize| -> f64 {
                let lattice = flow.velocity().lattice(c);
                let u = flow.velocity().component(c);
                let [nx, ny, _] = lattice.shape();
                let nodes =
                    (0..nx * ny).filter_map(|i| lattice.index([(i % nx) as isize, (i / nx) as isize, 0]));
                nodes.map(|i| open[c][i] * u[i]).sum()
            };
            cell * (through(0) * along[0] + through(1) * along[1]) / length
        };
        let step = |flow: &mut Projection<2>, dt: f64| -> Outcome<()> {
            flow.predict(dt, [0.0; 2])?;
            for c in 0..2 {
                let u = flow.velocity_mut().component_mut(c);
                u.iter_mut().zip(&open[c]).for_each(|(u, open)| *u += dt * pull[c] * open);
            }
            forcing.begin(flow.viscous_step(dt));
            forcing.place(flow.velocity(), bodies)?;
            forcing.force(flow.velocity_mut(), bodies);
            flow.project(dt)?;
            Ok(flow.finish(dt)?)
        };
        let channel = settle_by(flow, [0.05 / VISCOSITY, tolerance], step, |flow| rate(flow))?;
        let total = flow.statistics().volume_flow;
        Ok([channel, (total.x * along[0] + total.y * along[1]) / length])
    }
}

fn exact_in(banks: &Banks, place: [f64; 2], x: [f64; 2]) -> [f64; 2] {
    let d = banks.across([x[0] - place[0], x[1] - place[1]]);
    banks.axes()[0].map(|a| a * (6.0 * (0.25 - d * d)).max(0.0))
}

/// A simple-cubic array of spheres that fills the share `fraction` of a box of edge 1, in a fluid of density and viscosity 1.
pub struct SphereArray {
    /// The flow.
    pub flow: Projection<3>,
    /// The sphere.
    pub bodies: PrescribedBodies,
    /// Faces that the walls cut or close.
    pub faces: usize,
    /// Radius of the spheres \[m\].
    pub radius: f64,
}

impl SphereArray {
    /// The force on the box along x \[N\]: so small that inertia plays no part.
    pub const FORCE: f64 = 1e-3;

    /// Of `cells` along every axis.
    ///
    /// # Errors
    /// Those of the walls and of the flow.
    pub fn new(fraction: f64, cells: usize) -> Outcome<Self> {
        let radius = Self::radius(fraction);
        let grid = CartesianGrid::new([cells; 3], [1.0; 3])?;
        let fluid = Fluid { density: 1.0, viscosity: 1.0 };
        let mut flow = Projection::new(grid, Side::Periodic.everywhere(), fluid)?;
        let bodies = PrescribedBodies::default().with(Sphere::new(radius)?, [0.513, 0.487, 0.505], 0.0);
        let faces = put_walls(&mut flow, &bodies)?;
        Ok(Self { flow, bodies, faces, radius })
    }
    /// The radius that fills `fraction` \[m\].
    pub fn radius(fraction: f64) -> f64 {
        (fraction * 3.0 / (4.0 * PI)).cbrt()
    }
    /// Advances until the flow is steady; answers K = F/(6πμaU), U the mean velocity over box and spheres.
    ///
    /// # Errors
    /// Those of [`settle`].
    pub fn drag_factor(&mut self, tolerance: f64) -> Outcome<f64> {
        let force = [Self::FORCE, 0.0, 0.0];
        let mean = |flow: &mut Projection<3>| flow.statistics().volume_flow.x;
        let speed = settle(&mut self.flow, force, [0.01, tolerance], mean)?;
        Ok(Self::FORCE / (6.0 * PI * self.radius * speed))
    }
}
