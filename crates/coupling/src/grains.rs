//! Bodies without a fluid.
use crate::serials::Serials;
use crate::{CouplingError, Evolving, Module, Timings};
use interfaces::{BodyId, Checkpoint, Dynamics, RestartError};

/// Bodies that move by themselves: gravity, springs and contacts, as they know them, and no fluid. [`run`](crate::run) moves them on with the same observers and saved states
/// as it does flows.
///
/// ```
/// use coupling::{Grains, Schedule, run};
/// use coupling::dem::{Material, RigidBodies, Sphere};
/// use coupling::{BodyId, Freedom, Kinematics, Periods, Pose, Twist, Vector};
/// let mut bodies = RigidBodies::new(Periods::default());
/// bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
/// bodies.add(Sphere::new(1e-3)?, Material::default(), Pose::at([0.0; 3]), Twist::default(), Freedom::FREE)?;
/// let mut fall = Grains::new(bodies);
/// let schedule = Schedule { end: 0.2, intervals: 2, ..Schedule::default() };
/// run(&mut fall, &schedule, &mut (), &false.into())?;
/// assert!((fall.bodies.twist(BodyId(0)).linear.z + 9.81 * 0.2).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Grains<B> {
    /// The bodies.
    pub bodies: B,
    serials: Serials,
    time: f64,
    steps: u64,
    last_dt: f64,
    timings: Timings,
}

/// Stable steps of the contacts in one of a run: what is done once per step costs little then.
const CONTACT_STEPS: f64 = 20.0;

impl<B: Dynamics> Grains<B> {
    /// These `bodies`, at time 0.
    pub fn new(bodies: B) -> Self {
        let timings = Timings::default();
        Self { bodies, serials: Serials::default(), time: 0.0, steps: 0, last_dt: 0.0, timings }
    }
    /// What body `b` keeps when numbers close up: bodies are counted as they come, from 0. `None` for one that has been added since the last step.
    pub fn serial(&self, b: BodyId) -> Option<u64> {
        self.serials.of(b)
    }
    /// Where the time went.
    pub fn timings(&self) -> &Timings {
        &self.timings
    }
    fn failed(time: f64) -> impl FnOnce(B::Error) -> CouplingError {
        move |e| CouplingError::Dynamics { time, source: Box::new(e) }
    }
}

impl<B: Dynamics> Evolving for Grains<B> {
    /// Bodies that are to go go, others come.
    fn begin(&mut self) -> Result<(), CouplingError> {
        if let Some(numbers) = self.bodies.renew(self.time).map_err(Self::failed(self.time))? {
            self.serials.renumber(&numbers);
        }
        let (before, now) = (self.serials.len(), self.bodies.n_bodies());
        if before > now {
            return Err(CouplingError::Renumbered { before, now });
        }
        self.serials.count(now);
        Ok(())
    }
    fn step(&mut self, dt: f64) -> Result<(), CouplingError> {
        let Self { bodies, timings, time, .. } = self;
        timings.measure(Module::Contact, || bodies.advance(dt)).map_err(Self::failed(*time))?;
        self.time += dt;
        self.steps += 1;
        self.last_dt = dt;
        Ok(())
    }
    fn time(&self) -> f64 {
        self.time
    }
    fn set_time(&mut self, time: f64) {
        self.time = time;
    }
    fn steps(&self) -> u64 {
        self.steps
    }
    fn last_dt(&self) -> f64 {
        self.last_dt
    }
    fn courant(&self, _: f64) -> f64 {
        0.0
    }
    fn convects(&self) -> bool {
        false
    }
    fn stable_dt(&self, _: f64) -> f64 {
        self.longest_dt()
    }
    fn longest_dt(&self) -> f64 {
        CONTACT_STEPS * self.bodies.stable_dt()
    }
}

impl<B: Dynamics> Checkpoint for Grains<B> {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        sink("clock", &[self.time, self.steps as f64, self.last_dt]);
        self.bodies.save(&mut |name, values| sink(&format!("bodies.{name}"), values));
        self.serials.save(sink);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.bodies.restore(&|name| source(&format!("bodies.{name}")))?;
        self.serials.restore(source, self.bodies.n_bodies())?;
        let clock = RestartError::take(source, "clock", 3)?;
        (self.time, self.steps, self.last_dt) = (clock[0], clock[1] as u64, clock[2]);
        Ok(())
    }
}
