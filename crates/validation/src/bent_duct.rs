//! Turbulent flow through bent and turned ducts with immersed walls: figure 5 of Isoz et al. (2023).
//!
//! The duct is 1 m high; air enters at 1 m/s with a turbulence intensity of 5 %.
use crate::Outcome;
use crate::axes::{even, widening};
use fv_mesh::{
    Axis, CartesianGrid, Convection, Fluid, Modelled, Patch, Profile, Side, Simple, SimpleParams,
    TransportParams, WallStress,
};
use ibm::{StaticBodies, cut_cells};
use interfaces::{Aabb, Closure, CutCells, Point, Pose, Solid, Vector};
use std::f64::consts::{FRAC_PI_2, PI};

/// Solid around a duct of height 1 m. Before it is turned, it comes along +x at y = −2 … −1, and bends
/// between the radii 1 and 2 about the origin.
#[derive(Clone, Copy, Debug)]
pub struct Duct {
    /// Angle of the bend, 0 to π.
    pub bend: f64,
    /// Angle by which everything is turned.
    pub turn: f64,
}

impl Duct {
    /// Point in the frame in which the fluid enters along +x.
    fn own(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (s, c) = self.turn.sin_cos();
        [c * x + s * y, c * y - s * x]
    }
    /// Point of that frame in the world.
    fn world(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (s, c) = self.turn.sin_cos();
        [c * x - s * y, s * x + c * y]
    }
    /// End of the bend: direction from the origin, and that of the flow.
    fn end(&self) -> [[f64; 2]; 2] {
        let angle = self.bend - FRAC_PI_2;
        [[angle.cos(), angle.sin()], [-angle.sin(), angle.cos()]]
    }
    /// Point at `s` \[m\] along the centreline from the bend's start and at radius `r`.
    pub fn point(&self, s: f64, r: f64) -> [f64; 2] {
        let length = 1.5 * self.bend;
        self.world(if s < 0.0 {
            [s, -r]
        } else if s < length {
            let angle = s / 1.5 - FRAC_PI_2;
            [r * angle.cos(), r * angle.sin()]
        } else {
            let [e, t] = self.end();
            [0, 1].map(|a| r * e[a] + (s - length) * t[a])
        })
    }
    /// Distance along the centreline and radius of a point in the duct or on its walls \[m\].
    pub fn place(&self, x: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.own(x);
        let angle = (y.atan2(x) + FRAC_PI_2).rem_euclid(2.0 * PI);
        let [e, t] = self.end();
        if x < 0.0 && y < 0.0 {
            [x, -y]
        } else if angle < self.bend {
            [1.5 * angle, x.hypot(y)]
        } else {
            [1.5 * self.bend + x * t[0] + y * t[1], x * e[0] + y * e[1]]
        }
    }
    /// Direction of the duct at `s`.
    pub fn along(&self, s: f64) -> [f64; 2] {
        let angle = (s / 1.5).clamp(0.0, self.bend);
        self.world([angle.cos(), angle.sin()])
    }
    /// Distance from the nearest wall, positive in the fluid.
    pub fn distance(&self, x: [f64; 2]) -> f64 {
        let [x, y] = self.own(x);
        let mut off = f64::INFINITY;
        if x <= 0.0 {
            off = off.min((y + 1.5).abs());
        }
        let angle = (y.atan2(x) + FRAC_PI_2).rem_euclid(2.0 * PI);
        if angle <= self.bend {
            off = off.min((x.hypot(y) - 1.5).abs());
        }
        let [e, t] = self.end();
        if x * t[0] + y * t[1] >= 0.0 {
            off = off.min((x * e[0] + y * e[1] - 1.5).abs());
        }
        0.5 - off.min(10.0)
    }
}

impl Solid for Duct {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        self.distance([x.x, x.y])
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(100.0, 100.0, 0.0))
    }
}

/// Set-up of a flow.
#[derive(Clone, Copy, Debug)]
pub struct BentDuct {
    /// Duct; only a straight one may be turned.
    pub duct: Duct,
    /// Cells across it.
    pub cells: usize,
    /// Reynolds number of height and mean velocity.
    pub reynolds: f64,
}

/// Ratio of neighbouring widths of cells along straight parts, up to a tenth of the height.
const GROWTH: f64 = 1.05;

impl BentDuct {
    /// Cells that are even where walls cross them at an angle and widen along straight parts.
    fn grid(&self) -> Outcome<CartesianGrid<2>> {
        let (duct, h) = (self.duct, 1.0 / self.cells as f64);
        let margin = 2.0 * h;
        let widening = |length| widening(length, h, GROWTH, 0.1);
        let before: Vec<f64> = widening(5.0).iter().rev().map(|e| -e).collect();
        let bend = even(0.0, 2.0 + margin, h);
        let [x, y] = if duct.bend > 0.75 * PI {
            [[before, bend].concat(), even(-2.0 - margin, 2.0 + margin, h)]
        } else if duct.bend > 0.0 {
            [[before, bend].concat(), [even(-2.0 - margin, 0.0, h), widening(10.0)].concat()]
        } else if duct.turn == 0.0 {
            [[before, vec![0.0], widening(10.0)].concat(), even(-2.0 - margin, -1.0 + margin, h)]
        } else {
            // From where both walls have begun to where the first one ends.
            let [start, end] = [-5.0, 4.0].map(|s| [1.0, 2.0].map(|r| duct.point(s, r)));
            let x = even(start[0][0].max(start[1][0]), end[0][0].min(end[1][0]), h);
            [x, even(start[1][1] - 1.0, end[0][1] + 1.0, h)]
        };
        Ok(CartesianGrid::from_axes([Axis::from_faces(x)?, Axis::from_faces(y)?])?)
    }

    fn sides(&self) -> [[Side; 2]; 2] {
        let [u, v] = self.duct.along(-1.0);
        let (inlet, outlet) = (Side::Inlet(Profile::Uniform([u, v, 0.0])), Side::PressureOutlet(0.0));
        if self.duct.bend > 0.75 * PI {
            let part =
                |lower, upper, side| Patch { lower: [-9.0, lower, 0.0], upper: [9.0, upper, 0.0], side };
            let left = Side::Patches(vec![part(-9.0, 0.0, inlet), part(0.0, 9.0, outlet)]);
            [[left, Side::FreeSlip], Side::FreeSlip.both()]
        } else if self.duct.bend > 0.0 {
            [[inlet, Side::FreeSlip], [Side::FreeSlip, outlet]]
        } else {
            [[inlet, outlet], Side::FreeSlip.both()]
        }
    }

    /// Flow, turbulence model and cut cells before the first iteration.
    ///
    /// # Errors
    /// Those of the grid, the walls and the model.
    pub fn start<C: Closure>(
        &self,
        closure: impl FnOnce(usize) -> Outcome<C>,
    ) -> Outcome<(Simple<2>, Modelled<2, C>, CutCells)> {
        let (grid, duct) = (self.grid()?, self.duct);
        let fluid = Fluid { density: 1.0, viscosity: 1.0 / self.reynolds };
        let mut flow = Simple::new(grid.clone(), self.sides(), fluid)?
            .with_convection(Convection::Quick)
            .with_params(SimpleParams::turbulent())?;
        let cuts = cut_cells(flow.velocity(), &StaticBodies::new().with(duct, Pose::at([0.0; 3])))?;
        flow.set_walls(Some((&cuts, WallStress::LAW_OF_THE_WALL)))?;
        flow.set_velocity(|x| duct.along(duct.place(x)[0]));
        let closure = closure(grid.n_cells())?;
        let mut model = Modelled::new(closure, &grid, flow.sides(), TransportParams::steady())?;
        let centres = (0..grid.n_cells()).map(|i| grid.centre(grid.cell(i)));
        for (distance, x) in model.transport_mut().wall_distance_mut().iter_mut().zip(centres) {
            *distance = duct.distance(x).max(0.0);
        }
        Ok((flow, model, cuts))
    }
}
