//! A running simulation as those see it who look on, whatever its types.
use crate::cast::Cast;
use crate::physics::{Model, Physics, Scalars, Segregated};
use crate::setup::FieldChoice;
use crate::steady::Steady;
use crate::still::Still;
use crate::watch::Solids;
use coupling::{Particles, StepInfo, Strategy, Timings};
use dem::{BodyFrames, Depth};
use fv_mesh::{
    Axis, CartesianGrid, CellWriter, Field, FlowStatistics, Hooked, InverseOutlook, OutputError, SampleError,
    Sampler, Sides, Velocity,
};
use ibm::{FluidSampler, Forcing, IbmError, SurfaceLoads, SurfaceStress};
use interfaces::{Bodies, BodyId, Closure, Lattice, Point, ThinPart, Vector, Wrench};
use render::progress::Status;
use std::io::{self, Write};
use turb::YPlus;

/// What is asked of a simulation by its observers. Where there is no fluid, there is nothing to tell of it.
pub(crate) trait View {
    fn axis(&self, a: usize) -> &Axis;
    fn dim(&self) -> usize;
    fn periodic(&self, a: usize) -> bool;
    fn time(&self) -> f64;
    fn steps(&self) -> u64;
    /// Of the flow, if there is a fluid.
    fn statistics(&mut self) -> Option<FlowStatistics> {
        None
    }
    /// Of the flow; of the bodies where there is no fluid \[J\].
    fn kinetic_energy(&mut self) -> f64 {
        self.statistics().map_or(0.0, |flow| flow.kinetic_energy)
    }
    /// What progress tells of a step.
    fn status(&mut self, info: &StepInfo) -> String {
        let divergence = self.statistics().map_or(0.0, |flow| flow.divergence * info.dt);
        Status { time: info.time, dt: info.dt, courant: info.courant, divergence }.to_string()
    }
    fn timings(&self) -> &Timings;
    /// Uniform body force per mass in the last step \[m/s²\].
    fn body_force(&self) -> Vector {
        Vector::zeros()
    }
    /// The lattice of the cells' centres.
    fn lattice(&self) -> Lattice;
    /// The components of the velocity at the centres, x fastest, into the first of `out`.
    fn centred(&self, out: &mut [Vec<f64>]) {
        out.iter_mut().for_each(Vec::clear);
    }
    /// The same for pictures: without a fluid that of the bodies where λ is taken, and 0 elsewhere.
    fn shown(&self, solids: &Solids, out: &mut [Vec<f64>]) {
        let _ = solids;
        self.centred(out);
    }
    fn pressure(&self, out: &mut Vec<f64>) {
        out.clear();
    }
    /// Fields besides these at the centres, x fastest: what scalars and a turbulence model have.
    fn others(&self) -> Vec<Other<'_>> {
        Vec::new()
    }
    /// How far from walls a turbulence model finds the first cells.
    fn y_plus(&self) -> Option<YPlus> {
        None
    }
    /// Hands velocity and pressure at every point to `take`, under the point's number.
    fn sample(
        &self,
        points: &[[f64; 3]],
        take: &mut dyn FnMut(usize, [f64; 3], f64),
    ) -> Result<(), SampleError> {
        let _ = (points, take);
        Ok(())
    }
    /// Iterations of the last pressure solution.
    fn pressure_iterations(&self) -> usize {
        0
    }
    /// Progress to the inverse of the pressure equation at immersed walls, if one is to come.
    fn inverse_outlook(&self) -> Option<InverseOutlook> {
        None
    }
    /// Pressure solver, and why it is taken.
    fn pressure_solver(&self) -> String {
        "no fluid".into()
    }
    /// Writes λ, the fields of a choice, and derived ones (name and components) for ParaView; the
    /// name's extension is [`extension`](Self::extension).
    fn write_fields(
        &self,
        choice: FieldChoice,
        lambda: &[f64],
        derived: &[(&str, Vec<&[f64]>)],
        out: &mut dyn Write,
    ) -> Result<(), OutputError> {
        let _ = (choice, lambda, derived, out);
        Ok(())
    }
    /// Writes other fields: name, and one, two or three components.
    fn write_named(&self, fields: &[(&str, Vec<&[f64]>)], out: &mut dyn Write) -> Result<(), OutputError> {
        let _ = (fields, out);
        Ok(())
    }
    fn extension(&self) -> &'static str {
        ""
    }
    fn bodies(&self) -> &dyn Bodies;
    /// Parts of bodies that are too thin for the grid.
    fn thin(&self) -> &[ThinPart] {
        &[]
    }
    /// A number that a body keeps, however many come and go.
    fn serial(&self, b: BodyId) -> u64;
    /// Loads of fluid (without buoyancy) and contacts over the last step of length `dt`.
    fn loads(&self, b: BodyId, dt: f64) -> [Wrench; 2];
    /// Pressure and viscous stress along the surface of a wall by cut links or cut cells in a fluid of
    /// this dynamic viscosity \[Pa s\]; nothing of other bodies.
    fn surface(&self, b: BodyId, viscosity: f64) -> Result<SurfaceLoads, IbmError> {
        let _ = (b, viscosity);
        Ok(SurfaceLoads::default())
    }
    /// Pressure and friction of the load on such a wall.
    fn load_parts(&self, b: BodyId, viscosity: f64) -> Result<[Wrench; 2], IbmError> {
        let surface = self.surface(b, viscosity)?;
        Ok([surface.pressure(), surface.friction()])
    }
    fn contacts(&self) -> usize;
    /// The deepest overlap of the last step.
    fn deepest(&self) -> Option<Depth>;
    /// Bodies that came in and that left so far.
    fn turnover(&self) -> [u64; 2];
    /// Writes a frame of the bodies for ParaView and returns its path; `None` if there are none to write.
    fn write_bodies(&self, frames: &mut BodyFrames, index: usize) -> io::Result<Option<String>>;
}

/// A field besides velocity and pressure.
pub(crate) struct Other<'a> {
    pub(crate) name: &'a str,
    pub(crate) unit: &'a str,
    pub(crate) values: Box<dyn Iterator<Item = f64> + 'a>,
}

/// What a turbulence model has to show.
fn of_model<const D: usize>(model: Option<&Model<D>>) -> Vec<Other<'_>> {
    let Some(Model { closure, .. }) = model else { return Vec::new() };
    fn field<'a>(name: &'a str, unit: &'a str, values: &'a [f64]) -> Other<'a> {
        Other { name, unit, values: Box::new(values.iter().copied()) }
    }
    let k = closure.kinetic_energy().map(|k| field("k", "m²/s²", k));
    let eddy = closure.eddy_viscosity().map(|e| field("eddy_viscosity", "m²/s", e));
    k.into_iter().chain(eddy).collect()
}

/// What the scalars have to show.
fn of_scalars<const D: usize>(scalars: &Scalars<D>) -> impl Iterator<Item = Other<'_>> {
    scalars.iter().map(|(name, unit, field)| Other { name, unit, values: Box::new(field.values()) })
}

/// A flow, whatever computes it.
pub(crate) trait Flow<const D: usize> {
    fn grid(&self) -> &CartesianGrid<D>;
    fn sides(&self) -> &Sides<D>;
    fn velocity(&self) -> &Velocity<D>;
    fn pressure(&self) -> &Field<D>;
    fn centred_velocity(&self, c: usize) -> Box<dyn Iterator<Item = f64> + '_>;
    fn statistics(&mut self) -> FlowStatistics;
    fn time(&self) -> f64;
    fn steps(&self) -> u64;
    fn pressure_iterations(&self) -> usize;
    /// Progress to the inverse of the pressure equation at immersed walls, if one is to come.
    fn inverse_outlook(&self) -> Option<InverseOutlook> {
        None
    }
    /// Pressure solver, and why it is taken.
    fn pressure_solver(&self) -> String {
        "multigrid".into()
    }
    /// Impulses on walls inside the box in the last step; of a steady flow loads.
    fn wall_impulses(&self) -> &[Wrench];
    /// Fields besides velocity and pressure.
    fn others(&self) -> Vec<Other<'_>> {
        Vec::new()
    }
    /// How far from walls a turbulence model finds the first cells.
    fn y_plus(&self) -> Option<YPlus> {
        None
    }
    /// Pressure and friction of the loads on walls inside the box, where the flow knows them.
    fn wall_parts(&self) -> Option<[Vec<Wrench>; 2]> {
        None
    }
}

/// What all flows have, by the part that keeps it.
macro_rules! flow {
    ($part:ident) => {
        fn grid(&self) -> &CartesianGrid<D> {
            self.$part.grid()
        }
        fn sides(&self) -> &Sides<D> {
            self.$part.sides()
        }
        fn velocity(&self) -> &Velocity<D> {
            self.$part.velocity()
        }
        fn pressure(&self) -> &Field<D> {
            self.$part.pressure()
        }
        fn centred_velocity(&self, c: usize) -> Box<dyn Iterator<Item = f64> + '_> {
            Box::new(self.$part.centred_velocity(c))
        }
        fn statistics(&mut self) -> FlowStatistics {
            self.$part.statistics()
        }
    };
}

impl<const D: usize> Flow<D> for Physics<D> {
    flow!(flow);
    fn time(&self) -> f64 {
        Hooked::time(self)
    }
    fn steps(&self) -> u64 {
        Hooked::steps(self)
    }
    fn pressure_iterations(&self) -> usize {
        self.flow.pressure_info().iterations
    }
    fn inverse_outlook(&self) -> Option<InverseOutlook> {
        self.flow.inverse_outlook()
    }
    fn pressure_solver(&self) -> String {
        self.flow.pressure_solver().to_owned()
    }
    fn wall_impulses(&self) -> &[Wrench] {
        self.flow.wall_impulses()
    }
    fn others(&self) -> Vec<Other<'_>> {
        of_scalars(&self.hooks.scalars)
            .chain(of_model(self.hooks.closure.as_ref().map(|walled| &walled.model)))
            .collect()
    }
    fn y_plus(&self) -> Option<YPlus> {
        self.hooks.closure.as_ref()?.model.closure.y_plus()
    }
}

impl<const D: usize> Flow<D> for Segregated<D> {
    flow!(flow);
    fn time(&self) -> f64 {
        self.flow.time()
    }
    fn steps(&self) -> u64 {
        self.flow.steps()
    }
    fn others(&self) -> Vec<Other<'_>> {
        of_scalars(&self.scalars).collect()
    }
    fn pressure_iterations(&self) -> usize {
        0
    }
    fn wall_impulses(&self) -> &[Wrench] {
        &[]
    }
}

impl<const D: usize> Flow<D> for Steady<D> {
    flow!(flow);
    fn time(&self) -> f64 {
        self.time
    }
    fn steps(&self) -> u64 {
        self.flow.iterations() as u64
    }
    fn pressure_iterations(&self) -> usize {
        0
    }
    fn wall_impulses(&self) -> &[Wrench] {
        &self.loads
    }
    fn wall_parts(&self) -> Option<[Vec<Wrench>; 2]> {
        Some([self.flow.wall_pressure_force(), self.flow.wall_friction()])
    }
    fn others(&self) -> Vec<Other<'_>> {
        of_scalars(&self.scalars).chain(of_model(self.model.as_ref())).collect()
    }
    fn y_plus(&self) -> Option<YPlus> {
        self.model.as_ref()?.closure.y_plus()
    }
}

/// A flow and what is immersed in it, as observers see them.
pub(crate) struct Seen<'a, const D: usize> {
    pub(crate) flow: &'a mut dyn Flow<D>,
    pub(crate) guests: &'a dyn Guests,
    pub(crate) timings: Timings,
    /// Uniform body force per mass in the last step \[m/s²\].
    pub(crate) force: Vector,
}

/// What is immersed, as observers ask for it.
pub(crate) trait Guests {
    fn bodies(&self) -> &dyn Bodies;
    /// Bodies that are walls of the flow, not forced on it.
    fn walls(&self) -> Option<&dyn Bodies> {
        None
    }
    /// Parts that are too thin for the grid.
    fn thin(&self) -> &[ThinPart] {
        &[]
    }
    fn serial(&self, b: BodyId) -> u64;
    fn loads(&self, b: BodyId, dt: f64, walls: &[Wrench]) -> [Wrench; 2];
    fn contacts(&self) -> usize;
    fn deepest(&self) -> Option<Depth>;
    fn turnover(&self) -> [u64; 2];
    fn write(&self, corner: Point, frames: &mut BodyFrames, index: usize) -> io::Result<Option<String>>;
}

impl Guests for Still {
    fn bodies(&self) -> &dyn Bodies {
        &self.bodies
    }
    fn walls(&self) -> Option<&dyn Bodies> {
        Some(&self.bodies)
    }
    fn thin(&self) -> &[ThinPart] {
        &self.thin
    }
    fn serial(&self, b: BodyId) -> u64 {
        b.0 as u64
    }
    fn loads(&self, b: BodyId, dt: f64, walls: &[Wrench]) -> [Wrench; 2] {
        let impulse = walls.get(b.0).copied().unwrap_or_default();
        [impulse * (1.0 / dt), Wrench::default()]
    }
    fn contacts(&self) -> usize {
        0
    }
    fn deepest(&self) -> Option<Depth> {
        None
    }
    fn turnover(&self) -> [u64; 2] {
        [0; 2]
    }
    fn write(&self, _: Point, _: &mut BodyFrames, _: usize) -> io::Result<Option<String>> {
        Ok(None)
    }
}

impl<F: Forcing, S: Strategy> Guests for Particles<F, Cast, S> {
    fn bodies(&self) -> &dyn Bodies {
        &self.bodies
    }
    fn serial(&self, b: BodyId) -> u64 {
        Self::serial(self, b).unwrap_or(b.0 as u64)
    }
    fn loads(&self, b: BodyId, dt: f64, _: &[Wrench]) -> [Wrench; 2] {
        let report = self.report(b, dt);
        [report.hydrodynamic, report.contact]
    }
    fn contacts(&self) -> usize {
        self.bodies.bodies.contacts()
    }
    fn deepest(&self) -> Option<Depth> {
        self.bodies.bodies.deepest()
    }
    fn turnover(&self) -> [u64; 2] {
        self.bodies.turnover()
    }
    fn write(&self, corner: Point, frames: &mut BodyFrames, index: usize) -> io::Result<Option<String>> {
        self.bodies.bodies.write(frames, corner, index).map(Some)
    }
}

/// Writes in single precision, or in double precision values that it does not hold.
fn in_single_or_double<'a, const D: usize>(
    grid: &'a CartesianGrid<D>,
    mut write: impl FnMut(CellWriter<'a, D>) -> Result<(), OutputError>,
) -> Result<(), OutputError> {
    match write(CellWriter::new(grid)) {
        // Nothing has been written.
        Err(OutputError::Range { .. }) => write(CellWriter::new(grid).double_precision()),
        other => other,
    }
}

/// `writer` with fields of one, two or three components.
fn with_named<'a, const D: usize>(
    writer: CellWriter<'a, D>,
    fields: &'a [(&str, Vec<&[f64]>)],
) -> CellWriter<'a, D> {
    fields.iter().fold(writer, |writer, (name, components)| match components.as_slice() {
        [one] => writer.scalar(name, one.iter().copied()),
        many => {
            let component = |c: usize| many[c.min(many.len() - 1)].iter().copied();
            writer.vector(name, std::array::from_fn(component))
        }
    })
}

impl<const D: usize> View for Seen<'_, D> {
    fn axis(&self, a: usize) -> &Axis {
        self.flow.grid().axis(a)
    }
    fn dim(&self) -> usize {
        D
    }
    fn periodic(&self, a: usize) -> bool {
        self.flow.sides().periodic(a)
    }
    fn time(&self) -> f64 {
        self.flow.time()
    }
    fn steps(&self) -> u64 {
        self.flow.steps()
    }
    fn statistics(&mut self) -> Option<FlowStatistics> {
        Some(self.flow.statistics())
    }
    fn timings(&self) -> &Timings {
        &self.timings
    }
    fn body_force(&self) -> Vector {
        self.force
    }
    fn lattice(&self) -> Lattice {
        self.flow.grid().lattice(None, self.flow.sides())
    }
    fn centred(&self, out: &mut [Vec<f64>]) {
        for (c, out) in out.iter_mut().enumerate().take(D) {
            out.clear();
            self.flow.centred_velocity(c).for_each(|u| out.push(u));
        }
    }
    fn pressure(&self, out: &mut Vec<f64>) {
        out.clear();
        out.extend(self.flow.pressure().values());
    }
    fn others(&self) -> Vec<Other<'_>> {
        self.flow.others()
    }
    fn y_plus(&self) -> Option<YPlus> {
        self.flow.y_plus()
    }
    fn sample(
        &self,
        points: &[[f64; 3]],
        take: &mut dyn FnMut(usize, [f64; 3], f64),
    ) -> Result<(), SampleError> {
        let sampler = Sampler::new(self.flow.grid(), self.flow.sides());
        let (flow, lattice) = (&self.flow, self.lattice());
        // Walls cut the cells next to them; forcings leave fields that go on through bodies.
        let walls = self.guests.walls().map(FluidSampler::new);
        for (i, x) in points.iter().enumerate() {
            let (at, point): ([f64; D], _) = (std::array::from_fn(|a| x[a]), Point::from(*x));
            let (mut pressure, mut velocity) = (None, None);
            if let Some(walls) = walls {
                // Fields are those of their lattices, so there is no error.
                pressure = walls.pressure(&lattice, flow.pressure().data(), point).ok().flatten();
                velocity = walls.velocity(flow.velocity(), point).ok().flatten().map(<[f64; 3]>::from);
            }
            let pressure = pressure.map_or_else(|| sampler.at(flow.pressure(), at), Ok)?;
            let between = || -> Result<[f64; 3], SampleError> {
                let velocity = sampler.velocity(flow.velocity(), at)?;
                Ok(std::array::from_fn(|a| velocity.get(a).copied().unwrap_or(0.0)))
            };
            take(i, velocity.map_or_else(between, Ok)?, pressure);
        }
        Ok(())
    }
    fn pressure_iterations(&self) -> usize {
        self.flow.pressure_iterations()
    }
    fn inverse_outlook(&self) -> Option<InverseOutlook> {
        self.flow.inverse_outlook()
    }
    fn pressure_solver(&self) -> String {
        self.flow.pressure_solver()
    }
    fn write_fields(
        &self,
        choice: FieldChoice,
        lambda: &[f64],
        derived: &[(&str, Vec<&[f64]>)],
        mut out: &mut dyn Write,
    ) -> Result<(), OutputError> {
        in_single_or_double(self.flow.grid(), |writer| {
            let mut writer = writer.scalar("lambda", lambda.iter().copied());
            if choice.velocity {
                writer = writer.vector("velocity", std::array::from_fn(|c| self.flow.centred_velocity(c)));
            }
            if choice.pressure {
                writer = writer.scalar("pressure", self.flow.pressure().values());
            }
            let others = if choice.others { self.flow.others() } else { Vec::new() };
            writer = others.into_iter().fold(writer, |w, other| w.scalar(other.name, other.values));
            with_named(writer, derived).write(&mut out)
        })
    }
    fn write_named(
        &self,
        fields: &[(&str, Vec<&[f64]>)],
        mut out: &mut dyn Write,
    ) -> Result<(), OutputError> {
        in_single_or_double(self.flow.grid(), |writer| with_named(writer, fields).write(&mut out))
    }
    fn extension(&self) -> &'static str {
        CellWriter::new(self.flow.grid()).extension()
    }
    fn bodies(&self) -> &dyn Bodies {
        self.guests.bodies()
    }
    fn thin(&self) -> &[ThinPart] {
        self.guests.thin()
    }
    fn serial(&self, b: BodyId) -> u64 {
        self.guests.serial(b)
    }
    fn loads(&self, b: BodyId, dt: f64) -> [Wrench; 2] {
        self.guests.loads(b, dt, self.flow.wall_impulses())
    }
    fn surface(&self, b: BodyId, viscosity: f64) -> Result<SurfaceLoads, IbmError> {
        let Some(walls) = self.guests.walls() else { return Ok(SurfaceLoads::default()) };
        let (lattice, pressure) = (self.lattice(), self.flow.pressure().data());
        let spacing = (0..D).map(|a| self.axis(a).narrowest()).fold(f64::INFINITY, f64::min);
        SurfaceStress::new(self.flow.velocity(), &lattice, pressure, viscosity).on(walls, b, spacing)
    }
    fn load_parts(&self, b: BodyId, viscosity: f64) -> Result<[Wrench; 2], IbmError> {
        if let Some(parts) = self.flow.wall_parts() {
            return Ok(parts.map(|part| part.get(b.0).copied().unwrap_or_default()));
        }
        let surface = self.surface(b, viscosity)?;
        Ok([surface.pressure(), surface.friction()])
    }
    fn contacts(&self) -> usize {
        self.guests.contacts()
    }
    fn deepest(&self) -> Option<Depth> {
        self.guests.deepest()
    }
    fn turnover(&self) -> [u64; 2] {
        self.guests.turnover()
    }
    fn write_bodies(&self, frames: &mut BodyFrames, index: usize) -> io::Result<Option<String>> {
        let corner = self.flow.grid().origin();
        let corner = Point::from(std::array::from_fn(|a| corner.get(a).copied().unwrap_or(0.0)));
        self.guests.write(corner, frames, index)
    }
}
