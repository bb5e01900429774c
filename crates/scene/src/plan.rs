//! What a scene would do.
use crate::build::BuildError;
use crate::setup::{Algorithm, ForcingChoice, Setup};
use crate::steady::Steady;
use coupling::{Evolving, Grains};
use fv_mesh::{Axis, Side};
use std::fmt;

/// What running a scene would mean: told before it is run.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The scene's name.
    pub name: String,
    /// Cells along each axis.
    pub cells: Vec<usize>,
    /// Bodies at the start.
    pub bodies: usize,
    /// Memory for fields and solvers, roughly \[bytes\].
    pub memory: f64,
    /// The first full step \[s\]; none for steady flow.
    pub dt: Option<f64>,
    /// Steps of that length to the end, or iterations allowed.
    pub steps: f64,
    /// CPU time, roughly \[s\].
    pub cpu: f64,
    /// Parts of the libraries: name, whether it is at work, and what it does or why it is skipped.
    pub parts: Vec<(&'static str, bool, String)>,
    /// The pressure solver and why it was chosen.
    pub pressure: String,
    /// What looks doubtful.
    pub warnings: Vec<String>,
}

/// CPU seconds per cell and step of the flow alone in the plane and in space (docs/results.md), and per marker.
const COST: [f64; 2] = [1.2e-8, 3.5e-8];
const COST_OF_MARKER: f64 = 1.5e-6;
/// The same per cell of a model of large eddies (scene `sphere_les`), and of two equations beside bodies (`turbulent_cylinder`).
const COST_OF_MODEL: [f64; 2] = [2.2e-7, 2.9e-7];
/// CPU seconds per body and step (of 20 steps of the contacts) without a fluid, of smooth bodies and of polyhedra in a pile.
const COST_OF_BODY: [f64; 2] = [8e-6, 2e-4];
/// More steps than this are hardly meant.
const MANY_STEPS: f64 = 1e8;
/// Cells so much longer than wide are hardly meant.
const THIN: f64 = 1000.0;
/// CPU seconds per cell and iteration of the steady algorithm.
const COST_OF_ITERATION: f64 = 4e-7;

impl Setup {
    /// Puts the scene together, without running it, and tells what a run would mean.
    pub(crate) fn plan(&self) -> Result<Plan, BuildError> {
        match self.dim() {
            2 => self.plan_in::<2>(),
            _ => self.plan_in::<3>(),
        }
    }

    fn plan_in<const D: usize>(&self) -> Result<Plan, BuildError> {
        let cells = self.cells() as f64;
        let moved = self.bodies.any_moves();
        // Bodies are put together without a flow, which they do not need for that.
        if moved && self.fluid.is_some() {
            self.cast(self.chen())?;
            if self.bodies.forcing() == ForcingChoice::Smooth {
                self.check_sizes()?;
            }
        }
        let (dt, pressure) = match self.flow.algorithm {
            _ if self.fluid.is_none() => {
                let contact = Grains::new(self.cast(self.chen())?).longest_dt();
                (Some(self.dt.unwrap_or(contact).min(self.end)), "no fluid".to_owned())
            }
            Algorithm::Simple => {
                let _: Steady<D> = self.steady()?;
                (None, "multigrid".to_owned())
            }
            Algorithm::Piso => (self.dt, "multigrid".to_owned()),
            Algorithm::Projection => {
                let flow = self.physics(self.projection::<D>()?)?;
                let speed = self.speed();
                let rate: f64 = self.axes.iter().map(|axis| speed / axis.narrowest()).sum();
                let stable = flow.stable_dt(self.courant);
                let dt = self.dt.unwrap_or(if rate > 0.0 { stable.min(self.courant / rate) } else { stable });
                (Some(dt.min(self.end)), flow.flow.pressure_solver().to_owned())
            }
        };
        let steps = match dt {
            Some(dt) => (self.end / dt).ceil(),
            None => self.flow.iterations as f64,
        };
        let h = self.axes.iter().map(Axis::narrowest).fold(f64::INFINITY, f64::min);
        let markers: f64 = if moved { self.bodies.list.iter().map(|b| surface(b, h, D)).sum() } else { 0.0 };
        let model = self.turbulence.as_ref().map_or(0.0, |t| COST_OF_MODEL[usize::from(t.model.averages())]);
        let cpu = steps
            * match self.flow.algorithm {
                _ if self.fluid.is_none() => {
                    let cost = |b: &crate::setup::BodySetup| {
                        COST_OF_BODY[usize::from(b.shape.polyhedron().is_some())]
                    };
                    self.bodies.list.iter().map(cost).sum()
                }
                Algorithm::Projection => cells * (COST[D - 2] + model) + markers * COST_OF_MARKER,
                Algorithm::Piso => 20.0 * cells * COST[D - 2] + markers * COST_OF_MARKER,
                Algorithm::Simple => cells * COST_OF_ITERATION,
            };
        let mut warnings = self.warnings();
        if steps > MANY_STEPS {
            warnings.push(format!(
                "{steps:.0e} steps to time.end: is everything in metres and seconds, and no cell far narrower than the others?"
            ));
        }
        Ok(Plan {
            name: self.name.clone(),
            cells: self.axes.iter().map(Axis::cells).collect(),
            bodies: self.bodies.list.len(),
            memory: self.memory(),
            dt,
            steps,
            cpu,
            parts: self.parts(),
            pressure,
            warnings,
        })
    }

    /// A speed \[m/s\] that the scene is likely to see: of inlets and walls, of bodies, of what falls or is driven.
    pub(crate) fn speed(&self) -> f64 {
        let centre = self.axes.iter().map(|axis| 0.5 * (axis.lower() + axis.upper()));
        let mut middle = [0.0; 4];
        centre.enumerate().for_each(|(a, x)| middle[a] = x);
        let norm = |u: [f64; 3]| u.iter().map(|u| u * u).sum::<f64>().sqrt();
        let of_side = |side: &Side| match side {
            Side::Wall(u) => norm(*u),
            Side::Inlet(fv_mesh::Profile::Uniform(u)) => norm(*u),
            Side::Inlet(fv_mesh::Profile::Parabolic { peak }) => peak.abs(),
            Side::Inlet(fv_mesh::Profile::Function(u)) => norm(u([middle[0], middle[1], middle[2]], 0.0)),
            _ => 0.0,
        };
        let sides = self.sides.iter().flatten().map(of_side).fold(0.0, f64::max);
        let initial = self.initial.as_ref().map_or(0.0, |u| norm(u.each_ref().map(|u| u.at(&middle[..3]))));
        let bodies = self.bodies.list.iter().map(|b| {
            let radius = b.shape.bounding_radius();
            let ratio = (b.material.density / self.fluid().density - 1.0).abs();
            let fall = if self.bodies.any_free() {
                (2.0 * radius * ratio * self.gravity.norm()).sqrt()
            } else {
                0.0
            };
            fall.max(b.twist.linear.norm() + b.twist.angular.norm() * radius)
        });
        sides.max(initial).max(bodies.fold(0.0, f64::max))
    }

    /// What looks doubtful.
    pub(crate) fn warnings(&self) -> Vec<String> {
        let mut out = Vec::new();
        let Some(fluid) = self.fluid else { return out };
        let h = self.axes.iter().map(Axis::narrowest).fold(f64::INFINITY, f64::min);
        let widths = self.axes.iter().map(|axis| axis.length() / axis.cells() as f64);
        let thin = widths.clone().fold(0.0, f64::max) / widths.fold(f64::INFINITY, f64::min);
        if thin > THIN {
            out.push(format!(
                "cells are {thin:.0} times longer than wide: is the box in metres along all axes?"
            ));
        }
        let starts = [("forces", self.forces.map(|f| f.start)), ("averages", self.averages.map(|a| a.start))];
        for (key, start) in starts {
            if let Some(start) = start.filter(|start| *start >= self.end) {
                let end = self.end;
                out.push(format!(
                    "{key}.start = {start} s is not before the end at {end} s: there will be no means"
                ));
            }
        }
        let list = &self.bodies.list;
        let extent = |b: &crate::setup::BodySetup| {
            let size = b.shape.aabb().posed(&b.pose).extent();
            (0..self.dim()).map(|a| size[a]).fold(f64::INFINITY, f64::min)
        };
        if let Some(least) = list.iter().map(extent).min_by(f64::total_cmp) {
            let cells = least / h;
            if cells < 8.0 {
                out.push(format!("the smallest body is {cells:.1} cells across; below 8 its drag is off by 5 % and more: take more cells"));
            }
        }
        // Bodies that reach beyond the box are its walls.
        let within = |b: &&crate::setup::BodySetup| {
            let bounds = b.shape.aabb().posed(&b.pose);
            self.axes
                .iter()
                .enumerate()
                .all(|(a, axis)| bounds.min[a] >= axis.lower() && bounds.max[a] <= axis.upper())
        };
        for (a, axis) in self.axes.iter().enumerate() {
            let name = ["x", "y", "z"][a];
            let widest = list
                .iter()
                .filter(within)
                .map(|b| b.shape.aabb().posed(&b.pose).extent()[a])
                .fold(0.0, f64::max);
            if widest > 0.5 * axis.length() && !self.bodies.any_moves() {
                out.push(format!(
                    "bodies block {:.0} % of the box along {name}",
                    100.0 * widest / axis.length()
                ));
            }
            if axis.largest_ratio() > 1.3 {
                out.push(format!(
                    "cells along {name} grow by a factor of {:.2} from one to the next; above 1.2 errors grow with it",
                    axis.largest_ratio()
                ));
            }
        }
        let speed = self.speed();
        if fluid.viscosity > 0.0 && speed > 0.0 {
            let cell = speed * h / fluid.viscosity;
            if cell > 50.0 && self.flow.convection == fv_mesh::Convection::Central {
                out.push(format!(
                    "the Reynolds number of a cell is {cell:.0}: central convection may oscillate; take more cells, or convection = \"quick\" or \"limited\""
                ));
            }
        }
        if let Some(dt) = self.dt
            && speed > 0.0
        {
            let rate: f64 = self.axes.iter().map(|axis| speed / axis.narrowest()).sum();
            if rate * dt > 0.5 && self.flow.algorithm == Algorithm::Projection {
                out.push(format!(
                    "time.dt gives a Courant number of about {:.2}; above 0.5 runs may diverge",
                    rate * dt
                ));
            }
        }
        let fluid_inside = list.iter().filter(within).map(|b| b.shape.inertia(1.0).volume).sum::<f64>();
        let volume: f64 = self.axes.iter().map(Axis::length).product();
        if fluid_inside > 0.6 * volume {
            out.push(format!("bodies fill {:.0} % of the box", 100.0 * fluid_inside / volume));
        }
        out
    }
}

/// Markers on a body: elements of its surface a cell wide, by the sphere around it.
fn surface(body: &crate::setup::BodySetup, h: f64, dim: usize) -> f64 {
    let r = body.shape.bounding_radius() / h;
    let pi = std::f64::consts::PI;
    if dim == 2 { 2.0 * pi * r } else { 4.0 * pi * r * r }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let cells: Vec<String> = self.cells.iter().map(usize::to_string).collect();
        let total: usize = self.cells.iter().product();
        writeln!(f, "{}", self.name)?;
        writeln!(f, "  cells     {} = {total}", cells.join(" × "))?;
        writeln!(f, "  bodies    {}", self.bodies)?;
        writeln!(f, "  memory    about {}", bytes(self.memory))?;
        match self.dt {
            Some(dt) => writeln!(f, "  step      {dt:.3e} s, about {:.0} of them", self.steps)?,
            None => writeln!(f, "  steady    up to {:.0} iterations", self.steps)?,
        }
        writeln!(f, "  cost      about {} on one core", duration(self.cpu))?;
        writeln!(f, "  pressure  {}", self.pressure)?;
        for (name, active, about) in &self.parts {
            writeln!(f, "  {} {name:<18} {about}", if *active { "on  " } else { "skip" })?;
        }
        for warning in &self.warnings {
            writeln!(f, "  warning: {warning}")?;
        }
        Ok(())
    }
}

fn bytes(n: f64) -> String {
    if n < 1e9 { format!("{:.0} MB", (n / 1e6).max(1.0)) } else { format!("{:.1} GB", n / 1e9) }
}

fn duration(seconds: f64) -> String {
    let duration = std::time::Duration::try_from_secs_f64(seconds).unwrap_or(std::time::Duration::MAX);
    example_support::cpu::readable(duration)
}
