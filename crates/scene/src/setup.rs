//! What a scene says, as the libraries take it.
mod bodies;
mod dry;
mod factories;
mod flow;
mod forces;
mod grid;
mod inlets;
mod measures;
mod models;
mod motions;
mod physics;
mod shapes;
mod sides;
mod steady;
mod stop;
mod surfaces;
mod tables;
mod time;
mod window;

pub(crate) use bodies::{Bodies, BodySetup, ContactLawChoice, ForcingChoice, StrategyChoice, WallSetup};
pub(crate) use factories::InflowSetup;
pub(crate) use flow::{Algorithm, FlowSetup};
pub(crate) use forces::Forces;
pub(crate) use measures::{
    Averages, FieldChoice, Images, LineSetup, Output, ProbeSetup, Quantity, Reference,
};
pub(crate) use models::{Coefficients, ModelSetup};
pub(crate) use motions::Motion;
pub(crate) use physics::{ModelChoice, ScalarSetup, ScaleChoice, TurbulenceSetup};
pub(crate) use sides::is_open;
pub(crate) use stop::StopSetup;
pub(crate) use surfaces::SurfaceVelocity;
pub(crate) use window::WindowSetup;

use crate::document::{Document, Place};
use crate::expression::Expression;
use crate::problem::{Problem, Problems};
use crate::reader::{Formula, Formulas, Reader};
use crate::schema::{self, FileKey};
use crate::start_field::StartField;
use coupling::WeightBalance;
use fv_mesh::{Axis, Fluid, Side, Sides};
use interfaces::{Lattice, Point, Vector};
use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use time::Span;

/// Everything that a scene says.
#[derive(Clone)]
pub(crate) struct Setup {
    /// The scene's name: that of its file.
    pub(crate) name: String,
    pub(crate) title: String,
    /// Two or three.
    pub(crate) axes: Vec<Axis>,
    pub(crate) sides: Vec<[Side; 2]>,
    /// None: bodies alone.
    pub(crate) fluid: Option<Fluid>,
    pub(crate) gravity: Vector,
    /// Body force per mass, of the time.
    pub(crate) force: Option<[Expression; 3]>,
    /// Axis and mean velocity along it, of the time.
    pub(crate) flow_rate: Option<(usize, Expression)>,
    pub(crate) initial: Option<[Expression; 3]>,
    /// The same from a file.
    pub(crate) start: Option<Arc<StartField>>,
    pub(crate) flow: FlowSetup,
    pub(crate) turbulence: Option<TurbulenceSetup>,
    pub(crate) scalars: Vec<ScalarSetup>,
    pub(crate) bodies: Bodies,
    pub(crate) balance: WeightBalance,
    pub(crate) end: f64,
    pub(crate) dt: Option<f64>,
    pub(crate) courant: f64,
    pub(crate) ramp: bool,
    pub(crate) output: Output,
    /// Window that follows a body.
    pub(crate) window: Option<WindowSetup>,
    /// Conditions that end the run before its time.
    pub(crate) stop: Option<StopSetup>,
    pub(crate) probes: Vec<ProbeSetup>,
    pub(crate) lines: Vec<LineSetup>,
    pub(crate) forces: Option<Forces>,
    pub(crate) averages: Option<Averages>,
    pub(crate) references: Vec<Reference>,
    pub(crate) models: Vec<ModelSetup>,
    /// Seconds of the wall clock between saved states.
    pub(crate) save_every: f64,
    pub(crate) save_at_end: bool,
    /// Keys of the file that the algorithm does not use.
    pub(crate) unused: Vec<String>,
    /// Warnings about the inlets.
    pub(crate) doubtful_inlets: Vec<String>,
    /// Changes of mesh files, one entry per file and change.
    pub(crate) mended: Vec<String>,
    /// All formulas of the file, to be asked whether they had a finite value wherever they were needed.
    pub(crate) formulas: Vec<Formula>,
    /// Keys of the file whose values are paths.
    pub(crate) files: Vec<FileKey>,
}

/// Message about a file, with its name once.
fn of_file(path: &Path, error: &dyn std::fmt::Display) -> String {
    let (name, text) = (path.display().to_string(), error.to_string());
    if text.starts_with(&name) { text } else { format!("{name}: {text}") }
}

/// Where the scene is being read.
pub(crate) struct Context<'a> {
    /// Folder of the file: paths in it begin there.
    pub(crate) folder: &'a Path,
    pub(crate) dim: usize,
    /// End of the run \[s\]; none for a steady flow.
    pub(crate) end: Option<f64>,
    /// Changes of files, for warnings.
    notes: RefCell<Vec<(String, String)>>,
}

impl Context<'_> {
    pub(crate) fn path(&self, text: &str) -> PathBuf {
        self.folder.join(text)
    }
    /// Keeps the first note of each key.
    pub(crate) fn note(&self, key: String, text: String) {
        let mut notes = self.notes.borrow_mut();
        if notes.iter().all(|(known, _)| *known != key) {
            notes.push((key, text));
        }
    }
}

impl Setup {
    /// Reads a document that has not been checked yet; `path` is its file's.
    pub(crate) fn new(document: &Document, path: &Path) -> Result<Self, Problems> {
        let files = schema::check(document)?;
        let formulas = Formulas::default();
        let root = Reader::new(&document.root, Place::File(0..0), "", &formulas);
        let folder = path.parent().unwrap_or(Path::new(""));
        let name = path.file_stem().map_or("scene".into(), |stem| stem.to_string_lossy().into_owned());
        let setup = Self::read(&root, folder, name).map_err(|problem| document.problems(vec![problem]))?;
        Ok(Self { formulas: formulas.take(), files, ..setup })
    }

    fn read(root: &Reader<'_>, folder: &Path, name: String) -> Result<Self, Problem> {
        let axes = grid::read(root, folder)?;
        let dim = axes.len();
        let turbulence = physics::turbulence(root, dim)?;
        let flow = flow::read(root, turbulence.as_ref().is_some_and(|t| t.model.averages()))?;
        let empty = crate::document::Section::default();
        let unread = Formulas::default();
        let table =
            |key: &str| root.table(key).unwrap_or(Reader::new(&empty, Place::File(0..0), key, &unread));
        let (time, checkpoint) = (table("time"), table("checkpoint"));
        let output = table("output");
        let steady = flow.algorithm == Algorithm::Simple;
        let Span { end, snapshots } = if steady { Span::STEADY } else { Span::read(&time, &output)? };
        let context = Context { folder, dim, end: (!steady).then_some(end), notes: RefCell::default() };
        let sides = sides::read(root, &context)?;
        let fluid = flow::fluid(root)?;
        let gravity = root.vector_of("gravity", dim)?.unwrap_or_default();
        let mut bodies = bodies::read(root, &context, &axes, &sides, (fluid, gravity))?;
        let window = window::read(root, &context, &bodies, &sides)?;
        if let Some(WindowSetup { axis, .. }) = window {
            // Sides that move with the box are no walls of bodies, which keep their places.
            let side = ["sides.x_", "sides.y_", "sides.z_"][axis];
            bodies.walls.retain(|wall| !wall.name.starts_with(side));
        }
        let force = root.formulas("force", &["t"], dim)?;
        let initial = match root.table("initial") {
            Some(table) => table.formulas("velocity", &["x", "y", "z"], dim)?,
            None => None,
        };
        let moved = bodies.any_moves();
        let periodic_along = |a: usize| matches!(sides[a][0], Side::Periodic);
        let balance = match bodies.coupling.balance {
            Some(balance) => balance,
            None if moved && (0..dim).any(|a| gravity[a] != 0.0 && periodic_along(a)) => {
                WeightBalance::NetWeight
            }
            None => WeightBalance::None,
        };
        let mut setup = Self {
            title: root.text("title").map_or_else(|| name.clone(), Into::into),
            output: measures::output(&output, &name, &axes, snapshots)?,
            stop: stop::read(&time, &bodies, (dim, fluid.is_some(), steady))?,
            probes: measures::probes(root, &context, &axes, &sides, steady)?,
            lines: measures::lines(root, &context, &axes, &sides)?,
            forces: root.table("forces").map(|t| forces::read(&t, end, dim, steady)).transpose()?,
            averages: root.table("averages").map(|t| measures::averages(&t, end, dim)).transpose()?,
            references: measures::references(root)?,
            name,
            fluid,
            gravity,
            force,
            flow_rate: flow::flow_rate(root, &sides, steady)?,
            initial,
            start: flow::start(root, &context, &axes, &sides)?,
            window,
            balance,
            end,
            dt: time.number("dt"),
            courant: time.number("courant").unwrap_or(if moved { 0.1 } else { 0.4 }),
            ramp: time.flag("ramp").unwrap_or(bodies.any_free() && fluid.is_some() && !time.has("steps")),
            save_every: checkpoint.number("every").unwrap_or(10.0),
            save_at_end: checkpoint.flag("at_end").unwrap_or(true),
            turbulence,
            scalars: physics::scalars(root, &context, &sides)?,
            models: Vec::new(),
            unused: steady::unused(root, flow.algorithm),
            doubtful_inlets: Vec::new(),
            mended: Vec::new(),
            formulas: Vec::new(),
            files: Vec::new(),
            axes,
            sides,
            flow,
            bodies,
        };
        let fields = setup.fields();
        let fields: Vec<&str> = fields.iter().map(String::as_str).collect();
        setup.models = models::read(root, &setup.axes, &setup.bodies, (snapshots, &fields))?;
        setup.agrees(root)?;
        setup.doubtful_inlets = inlets::agrees(root, &setup.axes, &setup.sides, (!steady).then_some(end))?;
        setup.mended = context.notes.take().into_iter().map(|(_, text)| text).collect();
        Ok(setup)
    }

    /// Does all of it go together?
    fn agrees(&self, root: &Reader<'_>) -> Result<(), Problem> {
        if self.fluid.is_none() {
            dry::agrees(root, self)?;
        }
        let dim = self.dim();
        let check = |key: &str, sides: Result<(), fv_mesh::FlowError>| sides.map_err(|e| root.fail(key, e));
        match dim {
            2 => check("sides", Sides::new([self.sides[0].clone(), self.sides[1].clone()]).map(drop))?,
            _ => check(
                "sides",
                Sides::new([self.sides[0].clone(), self.sides[1].clone(), self.sides[2].clone()]).map(drop),
            )?,
        }
        self.planes_slide(root)?;
        if self.flow_rate.is_some() && self.balance == WeightBalance::ZeroFlow {
            let message = "`coupling.balance` = \"zero-flow\" holds the mean velocity at zero; leave out one of the two";
            return Err(root.fail("flow_rate", message));
        }
        let bodies = !self.bodies.list.is_empty() || !self.bodies.inflows.is_empty();
        let flow = root.table("flow");
        let fail = |key: &str, message: &str| match &flow {
            Some(flow) => flow.fail(key, message),
            None => root.fail("flow", message),
        };
        if let Some(fluid) = root.table("fluid")
            && self.fluid().viscosity == 0.0
            && self.turbulence.as_ref().is_some_and(|t| t.model.averages())
        {
            let key = if fluid.has("nu") { "nu" } else { "mu" };
            let message = "a turbulence model of two equations needs the viscosity of the fluid beside walls; give one above 0, or leave out turbulence";
            return Err(fluid.fail(key, message));
        }
        match self.flow.algorithm {
            Algorithm::Simple => steady::agrees(root, self)?,
            Algorithm::Piso if self.turbulence.is_some() => {
                return Err(fail(
                    "algorithm",
                    "turbulence models go with \"projection\" and \"simple\"; take one of these",
                ));
            }
            Algorithm::Piso if bodies && self.bodies.forcing() != ForcingChoice::Hfdib => {
                return Err(fail(
                    "algorithm",
                    "\"piso\" goes with coupling.forcing = \"hfdib\" (the paper's algorithm) only; take \"projection\"",
                ));
            }
            Algorithm::Piso
                if bodies
                    && (self.bodies.law != ContactLawChoice::Chen
                        || self.bodies.repulsion.is_some()
                        || self.bodies.lubrication.is_some()) =>
            {
                return Err(fail(
                    "algorithm",
                    "\"piso\" goes with the contact law \"chen\" without lubrication and repulsion only; leave out contact.law, contact.repulsion and lubrication, or take \"projection\"",
                ));
            }
            Algorithm::Piso if self.dt.is_none() => {
                return Err(fail(
                    "algorithm",
                    "\"piso\" has no stability limit to choose a step by; give time.dt",
                ));
            }
            Algorithm::Piso | Algorithm::Projection => {}
        }
        if let Some(Quantity::Field(name)) = self.output.images.as_ref().map(|i| &i.quantity) {
            let known = self.others();
            if !known.contains(name) {
                let known = if known.is_empty() { "none".into() } else { known.join(", ") };
                let output = root.table("output").unwrap_or_else(|| root.clone());
                return Err(
                    output.fail("field", format!("there is no field \"{name}\" here; there are: {known}"))
                );
            }
        }
        if self.scalars.iter().any(|s| s.flux.is_some())
            && !(self.bodies.inflows.is_empty() && self.bodies.exits.is_empty())
        {
            let message = "`bodies_flux` is for bodies that stay; leave out inflows and exits, or give a value by `bodies`";
            return Err(root.fail("scalars", message));
        }
        if let Some(s) = self.scalars.iter().find(|s| s.bodies.is_some() || s.flux.is_some())
            && self.bodies.list.is_empty()
            && self.bodies.inflows.is_empty()
        {
            let message = format!(
                "scalars.{}.bodies and bodies_flux are for bodies, and there are none; leave them out",
                s.name
            );
            return Err(root.fail("scalars", message));
        }
        if !self.bodies.exits.is_empty() && !self.bodies.any_moves() {
            return Err(root.fail(
                "exits",
                "bodies leave here, and none moves; leave this out, or give bodies that are not `motion = \"fixed\"`",
            ));
        }
        if self.forces.is_some() && !bodies {
            return Err(root.fail("forces", "loads are those on bodies, and there are none; leave this out"));
        }
        forces::agrees(root, self)?;
        if dim == 2 && self.bodies.lubrication.is_some() {
            return Err(
                root.fail("lubrication", "films are for solids in space; leave this out in a plane scene")
            );
        }
        Ok(())
    }

    /// Whether planes with formulas of place and time for their velocities move along themselves, at their points over the run.
    fn planes_slide(&self, root: &Reader<'_>) -> Result<(), Problem> {
        let tables = root.table("contact").map(|t| t.tables("planes")).unwrap_or_default();
        let first = self.bodies.walls.len() - tables.len();
        for (t, wall) in tables.iter().zip(&self.bodies.walls[first..]) {
            let (normal, point) = (wall.plane.normal(), t.vector("point").unwrap_or_default());
            for time in self.instants() {
                let u = Vector::from(wall.surface.wall_velocity(point.into(), time).unwrap_or_default());
                if normal.dot(&u).abs() > 1e-9 * u.norm() {
                    let message = format!(
                        "a plane keeps its place and its surface slides only, and at t = {time:.4e} s it has {:.3e} m/s along `normal`; give a velocity at a right angle to `normal`, or take a body with motion \"prescribed\"",
                        normal.dot(&u)
                    );
                    return Err(t.fail("velocity", message));
                }
            }
        }
        Ok(())
    }

    /// Names of the fields besides λ, velocity and pressure.
    fn others(&self) -> Vec<String> {
        let of_model = match &self.turbulence {
            Some(t) if t.model.averages() => &["k", "eddy_viscosity"][..],
            Some(_) => &["eddy_viscosity"],
            None => &[],
        };
        self.scalars.iter().map(|s| s.name.as_str()).chain(of_model.iter().copied()).map(Into::into).collect()
    }
    /// Names of all fields.
    fn fields(&self) -> Vec<String> {
        let always: &[&str] =
            if self.fluid.is_some() { &["lambda", "velocity", "pressure"] } else { &["lambda", "velocity"] };
        always.iter().map(|name| (*name).into()).chain(self.others()).collect()
    }
    /// The fluid; without one a vacuum.
    pub(crate) fn fluid(&self) -> Fluid {
        self.fluid.unwrap_or(Fluid { density: 0.0, viscosity: 0.0 })
    }
    /// The centres of the cells.
    pub(crate) fn lattice(&self) -> Lattice {
        let nodes = |a: usize| self.axes[a].centres(self.periodic(a));
        let [nx, ny] = [0, 1].map(|a| self.axes[a].cells());
        match self.dim() {
            2 => Lattice::new([nodes(0), nodes(1)], 0, [1, nx]),
            _ => Lattice::new([nodes(0), nodes(1), nodes(2)], 0, [1, nx, nx * ny]),
        }
    }
    pub(crate) fn periodic(&self, a: usize) -> bool {
        self.sides.get(a).is_some_and(|pair| matches!(pair[0], Side::Periodic))
    }
    /// The lower corner of the box.
    pub(crate) fn corner(&self) -> Point {
        Point::from([0, 1, 2].map(|a| self.axes.get(a).map_or(0.0, Axis::lower)))
    }
    pub(crate) fn dim(&self) -> usize {
        self.axes.len()
    }
    pub(crate) fn cells(&self) -> usize {
        self.axes.iter().map(Axis::cells).product()
    }
}
