//! Turbulent plane Couette flow whose lower wall is a side of the box, or a plate that slides in the box.
use crate::Outcome;
use crate::moved_body::MovedScene;
use coupling::Walled;
use fv_mesh::{CartesianGrid, Diffusion, Fluid, Hooked, Hooks, Modelled, Projection, Side, TransportParams};
use ibm::SmoothForcing;
use interfaces::{Aabb, Closure, Point, Solid, SurfaceElement, Twist, Vector};
use turb::{Inflow, Law, TwoEquation};

/// A turbulent flow with a model that sees bodies.
pub type TurbulentFlow<L> = Hooked<2, (), Walled<2, TwoEquation<L>>>;

/// `flow` with the model `law`, all of it as `start`.
///
/// # Errors
/// Those of the model.
pub fn with_model<L: Law>(flow: Projection<2>, law: L, start: Inflow) -> Outcome<TurbulentFlow<L>> {
    let model = TwoEquation::new(law, flow.grid().n_cells(), start)?;
    let model = Modelled::new(model, flow.grid(), flow.sides(), TransportParams::default())?;
    Ok(Hooked::new(flow, Hooks::none().with_closure(Walled::new(model))))
}

/// All that is below y = 0 in its frame, `length` long.
struct Plate {
    length: f64,
    depth: f64,
}

impl Solid for Plate {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        x.y
    }
    fn aabb(&self) -> Aabb {
        let half = 0.5 * self.length;
        Aabb { min: Point::new(-half, -self.depth, 0.0), max: Point::new(half, 0.0, 0.0) }
    }
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        let n = (self.length / spacing).round();
        let area = self.length / n;
        let element = |i: usize| SurfaceElement {
            point: Point::new((i as f64 + 0.5) * area - 0.5 * self.length, offset, 0.0),
            normal: Vector::y(),
            area,
        };
        Some((0..n as usize).map(element).collect())
    }
}

/// Two plane walls 1 apart, of which the upper one moves at 1 along x past the lower one.
#[derive(Clone, Copy, Debug)]
pub struct Couette {
    /// Cells between the walls.
    pub cells: usize,
    /// ν over speed and distance of the walls.
    pub viscosity: f64,
    /// What the fluid is at the start.
    pub start: Inflow,
    /// Time that is computed.
    pub time: f64,
    /// Courant number of the steps; an explicit ν_t may ask for less than 0.3.
    pub courant: f64,
}

/// What holds the lower wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lower {
    /// A side of the box.
    Side,
    /// A plate whose surface lies such a share of a cell above a face of the grid.
    Plate(f64),
}

/// The flow across.
#[derive(Clone, Debug)]
pub struct CouetteProfile {
    /// Distance of the cells from the lower wall, upwards.
    pub y: Vec<f64>,
    /// Velocity relative to the lower wall.
    pub u: Vec<f64>,
    /// k.
    pub k: Vec<f64>,
    /// ω or ε.
    pub scale: Vec<f64>,
    /// ν_t.
    pub nu_t: Vec<f64>,
    /// τ/ρ on the lower and on the upper wall.
    pub friction: [f64; 2],
    /// Values of k and ω or ε that had to be set.
    pub floored: usize,
}

impl CouetteProfile {
    /// One of its lists at a distance from the lower wall, linear between the cells.
    pub fn at(&self, list: &[f64], y: f64) -> f64 {
        let after = self.y.partition_point(|&p| p < y).clamp(1, self.y.len() - 1);
        let part = (y - self.y[after - 1]) / (self.y[after] - self.y[after - 1]);
        list[after - 1] + part * (list[after] - list[after - 1])
    }
}

/// Cells of the grid in the plate.
const UNDER: usize = 6;

impl Couette {
    /// Computes it with the model `law`, in a frame in which the lower wall moves at `drift`.
    ///
    /// # Errors
    /// Those of flow, model and forcing.
    pub fn run<L: Law>(&self, law: L, lower: Lower, drift: f64) -> Outcome<CouetteProfile> {
        let Self { cells, viscosity, start, time, courant } = *self;
        let (cells, depth) = match lower {
            Lower::Side => (cells, 0.0),
            Lower::Plate(share) => (cells + UNDER, (UNDER as f64 - share) / cells as f64),
        };
        let h = (1.0 + depth) / cells as f64;
        let length = 8.0 * h;
        let axis = fv_mesh::Axis::uniform(cells, -depth, 1.0)?;
        let grid = CartesianGrid::from_axes([fv_mesh::Axis::uniform(8, 0.0, length)?, axis])?;
        let moves = |u: f64| Side::Wall([u, 0.0, 0.0]);
        let sides = [Side::Periodic.both(), [moves(drift), moves(1.0 + drift)]];
        let mut flow = Projection::new(grid.clone(), sides, Fluid { density: 1.0, viscosity })?
            .with_diffusion(Diffusion::Explicit);
        flow.set_velocity(|[_, y]| [drift + y.clamp(0.0, 1.0), 0.0]);
        let flow = with_model(flow, law, start)?;
        let dt = courant * h / (1.0 + drift.abs());
        let steps = (time / dt).round() as usize;
        let (flow, on_plate) = match lower {
            Lower::Side => {
                let mut flow = flow;
                for _ in 0..steps {
                    flow.predict(dt, [0.0; 2])?;
                    flow.project(dt)?;
                    flow.finish(dt)?;
                }
                (flow, None)
            }
            Lower::Plate(_) => {
                let twist = Twist { linear: Vector::new(drift, 0.0, 0.0), ..Twist::default() };
                let at = |t: f64| Point::new(0.5 * length + drift * t, 0.0, 0.0);
                let plate = (Plate { length, depth: 2.0 * depth }, length * depth);
                let forcing = Box::new(SmoothForcing::new(1.0));
                let mut scene = MovedScene::new(flow, forcing, plate, at(0.0), twist);
                let mut force = 0.0;
                for step in 1..=steps {
                    force = scene.step(dt, at(dt * step as f64), twist)?.force.x;
                }
                (scene.flow, Some(force / length))
            }
        };
        let Walled { model, .. } = &flow.hooks.closure;
        let rows = model.wall_rows().iter().zip(model.closure.wall_viscosity());
        let on_side = |upper: bool| {
            let (friction, area) = rows
                .clone()
                .filter(|(row, _)| row.seen.is_none() && (row.cell / 8 == cells - 1) == upper)
                .map(|(row, nu_t)| (row.area * (viscosity + nu_t) * row.u_t / row.y, row.area))
                .fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1));
            friction / area
        };
        let y: Vec<f64> = grid.axis(1).faces().windows(2).map(|f| 0.5 * (f[0] + f[1])).collect();
        let first_fluid = y.iter().position(|y| *y > 0.0).unwrap_or(0);
        let u: Vec<f64> = flow.centred_velocity(0).map(|u| u - drift).collect();
        let column = |list: &[f64]| (first_fluid..cells).map(|j| list[8 * j]).collect::<Vec<f64>>();
        Ok(CouetteProfile {
            u: column(&u),
            k: column(model.closure.k()),
            scale: column(model.closure.scale()),
            nu_t: column(model.closure.nu_t()),
            y: y[first_fluid..].to_vec(),
            friction: [on_plate.unwrap_or_else(|| on_side(false)), on_side(true)],
            floored: model.closure.floored(),
        })
    }
}
