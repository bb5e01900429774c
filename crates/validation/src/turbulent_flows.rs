//! Turbulent flows between walls, with models.
use crate::Outcome;
use fv_mesh::{
    Axis, CartesianGrid, FlowError, Fluid, Modelled, Profile, Side, Simple, SimpleInfo, SimpleParams,
    TransportParams,
};
use interfaces::Closure;
use turb::{Inflow, Law, TwoEquation, WallFunctions, YPlus};

/// `cells` + 1 faces from `from` to `to` whose widths grow by one ratio from `first`.
pub fn growing(cells: usize, from: f64, to: f64, first: f64) -> Vec<f64> {
    let sum = |r: f64| (0..cells as i32).map(|i| first * r.powi(i)).sum::<f64>();
    let (mut low, mut high) = (0.1, 10.0);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if sum(middle) < to - from { low = middle } else { high = middle }
    }
    let (mut x, mut faces) = (from, vec![from]);
    for i in 0..cells {
        x += first * low.powi(i as i32);
        faces.push(if i + 1 == cells { to } else { x });
    }
    faces
}

/// An even number of cells from 0 to `height` that grow from either end towards the middle.
///
/// # Errors
/// [`FlowError::Grid`].
pub fn between_walls(cells: usize, height: f64, first: f64) -> Result<Axis, FlowError> {
    let mut faces = growing(cells / 2, 0.0, 0.5 * height, first);
    faces.extend(growing(cells / 2, 0.0, 0.5 * height, first).iter().rev().skip(1).map(|y| height - y));
    Axis::from_faces(faces)
}

/// What drives the flow in a channel without ends.
#[derive(Clone, Copy, Debug)]
pub enum Drive {
    /// A force per mass \[m/s²\].
    Force(f64),
    /// The force that gives this mean velocity \[m/s\].
    Bulk(f64),
}

/// Half a profile across a channel.
#[derive(Clone, Debug)]
pub struct ChannelProfile {
    /// Distance from the wall \[m\].
    pub y: Vec<f64>,
    /// Velocity \[m/s\].
    pub u: Vec<f64>,
    /// k \[m²/s²\].
    pub k: Vec<f64>,
    /// ν_t \[m²/s\].
    pub nu_t: Vec<f64>,
    /// Friction velocity, from the force \[m/s\].
    pub u_tau: f64,
    /// Mean velocity \[m/s\].
    pub bulk: f64,
    /// Iterations made.
    pub iterations: usize,
    /// y+ of the cells beside the walls.
    pub y_plus: YPlus,
}

/// Developed flow between two walls: the model `law` on the axis `y`.
///
/// # Errors
/// Those of the flow and the model, and if it is not developed after 20 000 iterations.
pub fn developed_channel<L: Law>(
    law: L,
    functions: WallFunctions,
    y: Axis,
    viscosity: f64,
    drive: Drive,
    start: Inflow,
) -> Outcome<ChannelProfile> {
    let (n, height) = (y.cells(), y.length());
    let length = 0.1 * height;
    let grid = CartesianGrid::from_axes([Axis::uniform(2, 0.0, length)?, y])?;
    let sides = [Side::Periodic.both(), Side::WALL.both()];
    let mut flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity })?;
    let (mut force, wanted) = match drive {
        Drive::Force(f) => (f, None),
        Drive::Bulk(u) => (0.0025 * u * u / height, Some(u)),
    };
    let speed = wanted.unwrap_or(18.0 * (0.5 * force * height).sqrt());
    flow.set_velocity(|_| [speed, 0.0]);
    let model = TwoEquation::new(law, grid.n_cells(), start)?.with_wall_functions(functions)?;
    let mut model = Modelled::new(model, &grid, flow.sides(), TransportParams::steady())?;
    let mut bulk = speed;
    let mut settled = 0;
    while settled < 20 {
        flow.set_force([force, 0.0]);
        let info = flow.iterate_with(&mut model)?;
        bulk = flow.statistics().volume_flow.x / (length * height);
        let off = wanted.map_or(0.0, |u| (bulk / u - 1.0).abs());
        settled = if info.largest() < 1e-6 && off < 1e-5 { settled + 1 } else { 0 };
        if let Some(u) = wanted {
            force *= (u / bulk).powf(0.3);
        }
        if info.iterations == 20_000 {
            return Err(format!("the channel is not developed: {info:?}, mean velocity {bulk}").into());
        }
    }
    let column = |list: &[f64]| (0..n / 2).map(|j| list[grid.index([0, j])]).collect::<Vec<_>>();
    let (u, model, iterations) = (flow.velocity().field(0), &model.closure, flow.iterations());
    Ok(ChannelProfile {
        y: (0..n / 2).map(|j| grid.axis(1).centre(j)).collect(),
        u: (0..n / 2).map(|j| u.row(j)[0]).collect(),
        k: column(model.k()),
        nu_t: column(model.nu_t()),
        u_tau: (0.5 * force * height).sqrt(),
        bulk,
        iterations,
        y_plus: model.y_plus(),
    })
}

/// Steady plane Couette flow in cells `y` between a wall at rest and one that moves at 1, which share a shear stress: that over the density
/// \[m²/s²\], and the y+ of the cells beside the walls.
///
/// # Errors
/// Those of the flow and the model, and if the flow does not come to rest.
pub fn steady_couette<L: Law>(
    law: L,
    functions: WallFunctions,
    y: Axis,
    viscosity: f64,
) -> Outcome<(f64, YPlus)> {
    let height = y.length();
    let grid = CartesianGrid::from_axes([Axis::uniform(2, 0.0, 0.1 * height)?, y])?;
    let sides = [Side::Periodic.both(), [Side::WALL, Side::Wall([1.0, 0.0, 0.0])]];
    let mut flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity })?;
    flow.set_velocity(|[_, y]| [y / height, 0.0]);
    let start = Inflow { k: 3e-3, omega: 1.0 };
    let model = TwoEquation::new(law, grid.n_cells(), start)?.with_wall_functions(functions)?;
    let mut model = Modelled::new(model, &grid, flow.sides(), TransportParams::steady())?;
    let mut last = f64::INFINITY;
    while last > 1e-7 {
        let info = flow.iterate_with(&mut model)?;
        last = info.largest();
        if info.iterations == 30_000 {
            return Err(format!("the flow is not at rest: {info:?}").into());
        }
    }
    let rows = model.wall_rows().iter().zip(model.closure.wall_viscosity());
    let (force, area) = rows.fold((0.0, 0.0), |(force, area), (row, nu_t)| {
        (force + row.area * (viscosity + nu_t) * row.u_t / row.y, area + row.area)
    });
    Ok((force / area, model.closure.y_plus()))
}

/// A duct of height 1 and length 15 at Re 10⁶ that fluid enters at speed 1 with `inflow`.
///
/// # Errors
/// Those of the flow and the model.
pub fn duct<L: Law>(
    law: L,
    cells: [usize; 2],
    first: f64,
    inflow: Inflow,
) -> Outcome<(Simple<2>, Modelled<2, TwoEquation<L>>)> {
    let grid = CartesianGrid::from_axes([
        Axis::uniform(cells[0], 0.0, 15.0)?,
        between_walls(cells[1], 1.0, first)?,
    ])?;
    let inlet = Side::Inlet(Profile::Uniform([1.0, 0.0, 0.0]));
    let sides = [[inlet, Side::PressureOutlet(0.0)], Side::WALL.both()];
    let flow = Simple::new(grid.clone(), sides, Fluid { density: 1.0, viscosity: 1e-6 })?
        .with_convection(fv_mesh::Convection::LinearUpwind)
        .with_params(SimpleParams::turbulent())?;
    let model = TwoEquation::new(law, grid.n_cells(), inflow)?;
    let model = Modelled::new(model, &grid, flow.sides(), TransportParams::steady())?;
    Ok((flow, model))
}

/// Iterates to `tolerance`; gives what the last iteration had to tell, and whether that was enough.
///
/// # Errors
/// Those of the flow and the model.
pub fn iterate<L: Law>(
    flow: &mut Simple<2>,
    model: &mut Modelled<2, TwoEquation<L>>,
    most: usize,
    tolerance: f64,
) -> Result<(SimpleInfo, bool), FlowError> {
    let mut info = SimpleInfo::default();
    for _ in 0..most {
        info = flow.iterate_with(model)?;
        if info.largest() <= tolerance {
            return Ok((info, true));
        }
    }
    Ok((info, false))
}

/// The numbers of a table in a text: lines of `N` or more, what begins otherwise is left out.
pub fn numbers<const N: usize>(text: &str) -> Vec<[f64; N]> {
    text.lines()
        .filter_map(|line| {
            let mut row = [0.0; N];
            let mut words = line.split([',', ' ']).filter(|w| !w.is_empty());
            row.iter_mut().try_for_each(|v| words.next()?.parse().ok().map(|x| *v = x))?;
            Some(row)
        })
        .collect()
}
