//! A running simulation as those see it who look on, whatever its types.
use crate::cast::Cast;
use crate::still::Still;
use coupling::{Particles, Strategy, Timings};
use dem::{ContactLaw, Population, RigidDynamics};
use fv_mesh::{
    Axis, CartesianGrid, CellWriter, Field, FlowStatistics, OutputError, Piso, Projection, SampleError,
    Sampler, Sides, Simple, Velocity,
};
use ibm::Forcing;
use interfaces::{Bodies, BodyId, Checkpoint, Lattice, Point, Wrench};
use std::io::{self, Write};

/// What is asked of a simulation by its observers.
pub(crate) trait View {
    fn axis(&self, a: usize) -> &Axis;
    fn dim(&self) -> usize;
    fn periodic(&self, a: usize) -> bool;
    fn time(&self) -> f64;
    fn steps(&self) -> u64;
    fn statistics(&mut self) -> FlowStatistics;
    fn timings(&self) -> &Timings;
    /// The lattice of the cells' centres.
    fn lattice(&self) -> Lattice;
    /// Component `c` of the velocity at the centres, x fastest.
    fn centred(&self, c: usize, out: &mut Vec<f64>);
    fn pressure(&self, out: &mut Vec<f64>);
    /// Hands velocity and pressure at every point to `take`, under the point's number.
    fn sample(
        &self,
        points: &[[f64; 3]],
        take: &mut dyn FnMut(usize, [f64; 3], f64),
    ) -> Result<(), SampleError>;
    /// Iterations of the last pressure solution.
    fn pressure_iterations(&self) -> usize;
    /// Writes λ, velocity and pressure for ParaView; the name's extension is [`extension`](Self::extension).
    fn write_fields(&self, lambda: &[f64], out: &mut dyn Write) -> Result<(), OutputError>;
    /// Writes other fields: name, and one, two or three components.
    fn write_named(&self, fields: &[(&str, Vec<&[f64]>)], out: &mut dyn Write) -> Result<(), OutputError>;
    fn extension(&self) -> &'static str;
    fn bodies(&self) -> &dyn Bodies;
    /// A number that a body keeps, however many come and go.
    fn serial(&self, b: BodyId) -> u64;
    /// Loads of fluid (without buoyancy) and contacts over the last step of length `dt`.
    fn loads(&self, b: BodyId, dt: f64) -> [Wrench; 2];
    fn contacts(&self) -> usize;
    /// Bodies that came in and that left so far.
    fn turnover(&self) -> [u64; 2];
    /// Writes the bodies for ParaView; `false` if there are none to write.
    fn write_bodies(&self, out: &mut dyn Write) -> io::Result<bool>;
}

/// A flow, whatever computes it.
pub(crate) trait Flow<const D: usize> {
    fn grid(&self) -> &CartesianGrid<D>;
    fn sides(&self) -> &Sides<D>;
    fn velocity(&self) -> &Velocity<D>;
    fn pressure(&self) -> &Field<D>;
    fn centred_velocity(&self, c: usize) -> impl Iterator<Item = f64> + '_;
    fn statistics(&mut self) -> FlowStatistics;
    fn time(&self) -> f64;
    fn steps(&self) -> u64;
    fn pressure_iterations(&self) -> usize;
    /// Impulses on walls inside the box in the last step.
    fn wall_impulses(&self) -> &[Wrench];
}

/// What all flows have, and what one has besides.
macro_rules! flow {
    ($flow:ident, $time:expr, $steps:expr, $iterations:expr, $impulses:expr) => {
        impl<const D: usize> Flow<D> for $flow<D> {
            fn grid(&self) -> &CartesianGrid<D> {
                $flow::grid(self)
            }
            fn sides(&self) -> &Sides<D> {
                $flow::sides(self)
            }
            fn velocity(&self) -> &Velocity<D> {
                $flow::velocity(self)
            }
            fn pressure(&self) -> &Field<D> {
                $flow::pressure(self)
            }
            fn centred_velocity(&self, c: usize) -> impl Iterator<Item = f64> + '_ {
                $flow::centred_velocity(self, c)
            }
            fn statistics(&mut self) -> FlowStatistics {
                $flow::statistics(self)
            }
            fn time(&self) -> f64 {
                $time(self)
            }
            fn steps(&self) -> u64 {
                $steps(self)
            }
            fn pressure_iterations(&self) -> usize {
                $iterations(self)
            }
            fn wall_impulses(&self) -> &[Wrench] {
                $impulses(self)
            }
        }
    };
}

flow!(
    Projection,
    Projection::time,
    Projection::steps,
    |f: &Self| f.pressure_info().iterations,
    Projection::wall_impulses
);
flow!(Piso, Piso::time, Piso::steps, |_: &Self| 0, no_walls);
flow!(Simple, |_: &Self| 0.0, |f: &Self| f.iterations() as u64, |_: &Self| 0, no_walls);

fn no_walls<T>(_: &T) -> &'static [Wrench] {
    &[]
}

/// A flow and what is immersed in it, as observers see them.
pub(crate) struct Seen<'a, const D: usize, A, P> {
    pub(crate) flow: &'a mut A,
    pub(crate) guests: &'a P,
    pub(crate) timings: Timings,
}

/// What is immersed, as observers ask for it.
pub(crate) trait Guests {
    fn bodies(&self) -> &dyn Bodies;
    fn serial(&self, b: BodyId) -> u64;
    fn loads(&self, b: BodyId, dt: f64, walls: &[Wrench]) -> [Wrench; 2];
    fn contacts(&self) -> usize;
    fn turnover(&self) -> [u64; 2];
    fn write(&self, corner: Point, out: &mut dyn Write) -> io::Result<bool>;
}

impl Guests for Still {
    fn bodies(&self) -> &dyn Bodies {
        &self.0
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
    fn turnover(&self) -> [u64; 2] {
        [0; 2]
    }
    fn write(&self, _: Point, _: &mut dyn Write) -> io::Result<bool> {
        Ok(false)
    }
}

impl<F: Forcing, L: ContactLaw, S: Strategy> Guests for Particles<F, Cast<L>, S>
where
    Population<L>: Checkpoint,
{
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
        self.bodies.rigid_bodies().n_contacts()
    }
    fn turnover(&self) -> [u64; 2] {
        self.bodies.turnover()
    }
    fn write(&self, corner: Point, mut out: &mut dyn Write) -> io::Result<bool> {
        self.bodies.rigid_bodies().write_vtp(&mut out, corner)?;
        Ok(true)
    }
}

impl<const D: usize, A: Flow<D>, P: Guests> View for Seen<'_, D, A, P> {
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
    fn statistics(&mut self) -> FlowStatistics {
        self.flow.statistics()
    }
    fn timings(&self) -> &Timings {
        &self.timings
    }
    fn lattice(&self) -> Lattice {
        self.flow.grid().lattice(None, self.flow.sides())
    }
    fn centred(&self, c: usize, out: &mut Vec<f64>) {
        out.clear();
        out.extend(self.flow.centred_velocity(c));
    }
    fn pressure(&self, out: &mut Vec<f64>) {
        out.clear();
        out.extend(self.flow.pressure().values());
    }
    fn sample(
        &self,
        points: &[[f64; 3]],
        take: &mut dyn FnMut(usize, [f64; 3], f64),
    ) -> Result<(), SampleError> {
        let sampler = Sampler::new(self.flow.grid(), self.flow.sides());
        for (i, x) in points.iter().enumerate() {
            let at: [f64; D] = std::array::from_fn(|a| x[a]);
            let velocity = sampler.velocity(self.flow.velocity(), at)?;
            let pressure = sampler.at(self.flow.pressure(), at)?;
            take(i, std::array::from_fn(|a| velocity.get(a).copied().unwrap_or(0.0)), pressure);
        }
        Ok(())
    }
    fn pressure_iterations(&self) -> usize {
        self.flow.pressure_iterations()
    }
    fn write_fields(&self, lambda: &[f64], mut out: &mut dyn Write) -> Result<(), OutputError> {
        CellWriter::new(self.flow.grid())
            .scalar("lambda", lambda.iter().copied())
            .vector("velocity", std::array::from_fn(|c| self.flow.centred_velocity(c)))
            .scalar("pressure", self.flow.pressure().values())
            .write(&mut out)
    }
    fn write_named(
        &self,
        fields: &[(&str, Vec<&[f64]>)],
        mut out: &mut dyn Write,
    ) -> Result<(), OutputError> {
        let mut writer = CellWriter::new(self.flow.grid());
        for (name, components) in fields {
            writer = match components.as_slice() {
                [one] => writer.scalar(name, one.iter().copied()),
                many => {
                    writer.vector(name, std::array::from_fn(|c| many[c.min(many.len() - 1)].iter().copied()))
                }
            };
        }
        writer.write(&mut out)
    }
    fn extension(&self) -> &'static str {
        CellWriter::new(self.flow.grid()).extension()
    }
    fn bodies(&self) -> &dyn Bodies {
        self.guests.bodies()
    }
    fn serial(&self, b: BodyId) -> u64 {
        self.guests.serial(b)
    }
    fn loads(&self, b: BodyId, dt: f64) -> [Wrench; 2] {
        self.guests.loads(b, dt, self.flow.wall_impulses())
    }
    fn contacts(&self) -> usize {
        self.guests.contacts()
    }
    fn turnover(&self) -> [u64; 2] {
        self.guests.turnover()
    }
    fn write_bodies(&self, out: &mut dyn Write) -> io::Result<bool> {
        let corner = self.flow.grid().origin();
        let corner = Point::from(std::array::from_fn(|a| corner.get(a).copied().unwrap_or(0.0)));
        self.guests.write(corner, out)
    }
}
