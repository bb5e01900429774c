//! What a scene would do.
use crate::build_error::BuildError;
use crate::run::RunError;
use crate::setup::{Algorithm, ContactLawChoice, ForcingChoice, Setup};
use crate::trial::{ANY_COURANT, Trial, Tried};
use coupling::{Evolving, Grains, check_places};
use fv_mesh::{Axis, CartesianGrid, Projection, Side};
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
    /// Mean length of a step \[s\]; none for steady flow.
    pub dt: Option<f64>,
    /// Steps to the end, or iterations allowed.
    pub steps: f64,
    /// CPU time, roughly \[s\].
    pub cpu: f64,
    /// Parts of the libraries: name, whether it is at work, and what it does or why it is skipped.
    pub parts: Vec<(&'static str, bool, String)>,
    /// Whether the first steps were taken: a run may refuse others at its start.
    pub tried: bool,
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
/// CPU seconds per cell and iteration of the steady algorithm.
const COST_OF_ITERATION: f64 = 4e-7;

/// Memory \[bytes\] and bodies of scenes too large for first steps in a check.
const LARGE: f64 = 5e8;
const MANY_BODIES: usize = 100_000;
/// Cells along each axis of the grid that stands for a large one.
const WINDOW: usize = 16;

impl Setup {
    /// Puts the scene together, without running it, and tells what a run would mean.
    pub(crate) fn plan(&self) -> Result<Plan, BuildError> {
        match self.dim() {
            2 => self.plan_in::<2>(),
            _ => self.plan_in::<3>(),
        }
    }

    /// Findings about a scene that is too large to be tried: limits of its narrowest cells, of the
    /// flow alone.
    fn untried<const D: usize>(&self) -> Result<Tried, BuildError> {
        let longest = match self.flow.algorithm {
            _ if self.fluid.is_none() => Some(Grains::new(self.cast(self.chen())?).longest_dt()),
            Algorithm::Simple => None,
            Algorithm::Piso => Some(f64::INFINITY),
            Algorithm::Projection => {
                let window = |a: usize| {
                    let n = WINDOW.min(self.axes[a].cells());
                    Axis::uniform(n, 0.0, self.axes[a].narrowest() * n as f64)
                };
                let axes: Vec<_> = (0..D).map(window).collect::<Result<_, _>>()?;
                let grid = CartesianGrid::<D>::from_axes(std::array::from_fn(|a| axes[a].clone()))?;
                let walls = std::array::from_fn(|_| [Side::Wall([0.0; 3]), Side::Wall([0.0; 3])]);
                let flow = Projection::new(grid, walls, self.fluid())?.with_diffusion(self.diffusion());
                Some(flow.stable_dt(ANY_COURANT))
            }
        };
        self.initial(&self.grid::<D>()?)?;
        let initial = self.initial_speed() / self.narrowest();
        let limits = longest.map(|longest| [longest, initial]);
        let pressure = "chosen at the start of the run".into();
        Ok(Tried { limits, pressure, thin: Vec::new(), step: None })
    }

    fn plan_in<const D: usize>(&self) -> Result<Plan, BuildError> {
        let cells = self.cells() as f64;
        let moved = self.bodies.any_moves();
        self.check_memory()?;
        // Bodies are put together without a flow, which they do not need for that.
        if self.is_forced() {
            let (grid, periodic) = (self.grid::<D>()?, |a| self.periodic(a));
            match (self.flow.algorithm, self.bodies.law) {
                (Algorithm::Projection, ContactLawChoice::None) => {
                    check_places(&grid, periodic, &self.cast(())?)?;
                }
                _ => check_places(&grid, periodic, &self.cast(self.chen())?)?,
            }
            if self.flow.algorithm == Algorithm::Projection && self.bodies.forcing() == ForcingChoice::Smooth
            {
                self.check_sizes()?;
            }
        }
        self.check_paths::<D>()?;
        let large = self.memory() > LARGE || self.bodies.list.len() > MANY_BODIES;
        let Tried { limits, pressure, thin, step } = match large {
            true => self.untried::<D>()?,
            false => {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(RunError::from);
                pool.and_then(|pool| pool.install(|| self.execute(&Trial(self))))?
            }
        };
        let pace = limits.map(|[longest, rate]| self.expected_steps(longest, rate));
        let (dt, steps) = (pace.map(|p| p.dt), pace.map_or(self.flow.iterations as f64, |p| p.steps));
        let h = self.narrowest();
        let markers: f64 = if moved { self.bodies.list.iter().map(|b| surface(b, h, D)).sum() } else { 0.0 };
        let model = self.turbulence.as_ref().map_or(0.0, |t| COST_OF_MODEL[usize::from(t.model.averages())]);
        let cpu = steps
            * match self.flow.algorithm {
                _ if step.is_some() => step.unwrap_or(0.0),
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
        warnings.extend(self.thin_warnings(&thin));
        if steps > MANY_STEPS {
            warnings.push(format!(
                "{} steps to time.end, {} on one core: is everything in metres and seconds, and no cell far narrower than the others?",
                count(steps),
                duration(cpu)
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
            tried: !large,
            pressure,
            warnings,
        })
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
            Some(dt) => writeln!(f, "  step      {dt:.3e} s, about {} of them", count(self.steps))?,
            None => writeln!(f, "  steady    up to {:.0} iterations", self.steps)?,
        }
        writeln!(f, "  cost      about {} on one core", duration(self.cpu))?;
        writeln!(f, "  pressure  {}", self.pressure)?;
        if !self.tried {
            writeln!(
                f,
                "  not tried: too large for first steps; a run may refuse at its start what passes here"
            )?;
        }
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

/// A number that people can read.
fn count(n: f64) -> String {
    if n < 1e9 { format!("{n:.0}") } else { format!("{n:.1e}") }
}

/// Seconds of a year.
const YEAR: f64 = 365.25 * 86400.0;

fn duration(seconds: f64) -> String {
    if seconds > YEAR {
        return format!("{} years", count(seconds / YEAR));
    }
    let duration = std::time::Duration::try_from_secs_f64(seconds).unwrap_or(std::time::Duration::MAX);
    example_support::cpu::readable(duration)
}
