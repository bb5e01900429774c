//! Bodies of a scene: free, fixed, in prescribed motion, coming in and going out.
use crate::setup::Motion;
use dem::placing::PlacingError;
use dem::{BodyFrames, ContactLaw, Depth, Origin, Population, PrescribedMotion, RigidDynamics};
use interfaces::{
    Bodies, BodyId, Checkpoint, Dynamics, Freedom, Inertia, Kinematics, Load, Point, Pose, Renumbering,
    RestartError, Solid, Twist, Vector, Wrench,
};
use std::io;

/// Population under any law of contact: what couples it to a flow is compiled once for all laws.
pub(crate) trait AnyPopulation: Dynamics<Error = PlacingError> {
    /// Origin of body `b`.
    fn origin(&self, b: BodyId) -> Origin;
    /// Number of bodies that came in by an inflow.
    fn entered(&self, inflow: usize) -> u64;
    /// Number of bodies that left.
    fn left(&self) -> u64;
    /// Number of contacts.
    fn contacts(&self) -> usize;
    /// Deepest overlap of the last step.
    fn deepest(&self) -> Option<Depth>;
    /// Kinetic energy \[J\].
    fn kinetic_energy(&self) -> f64;
    /// Writes a frame of the bodies for ParaView; returns its path.
    fn write(&self, frames: &mut BodyFrames, corner: Point, index: usize) -> io::Result<String>;
}

impl<L: ContactLaw> AnyPopulation for Population<L>
where
    Self: Checkpoint,
{
    fn origin(&self, b: BodyId) -> Origin {
        Self::origin(self, b)
    }
    fn entered(&self, inflow: usize) -> u64 {
        Self::entered(self, inflow)
    }
    fn left(&self) -> u64 {
        Self::left(self)
    }
    fn contacts(&self) -> usize {
        self.rigid_bodies().n_contacts()
    }
    fn deepest(&self) -> Option<Depth> {
        self.rigid_bodies().deepest()
    }
    fn kinetic_energy(&self) -> f64 {
        self.rigid_bodies().kinetic_energy()
    }
    fn write(&self, frames: &mut BodyFrames, corner: Point, index: usize) -> io::Result<String> {
        let bodies = self.rigid_bodies();
        frames.write(bodies, corner, bodies.ids(), index)
    }
}

/// Population some of whose bodies move by formulas.
pub(crate) struct Cast {
    pub(crate) bodies: Box<dyn AnyPopulation>,
    inflows: usize,
    /// In the order of their numbers.
    scripts: Vec<Script>,
    /// Where they are in the list now.
    places: Vec<Option<BodyId>>,
    /// Time at the start of the step \[s\].
    time: f64,
}

/// Motion of a body by formulas.
pub(crate) struct Script {
    /// The body's number at the start.
    pub(crate) number: usize,
    /// Its formulas.
    pub(crate) formulas: Motion,
    pub(crate) motion: PrescribedMotion,
}

impl Cast {
    /// Bodies with so many inflows, of whom some (by their number at the start, in this order) move
    /// by formulas.
    pub(crate) fn new<L: ContactLaw + 'static>(
        bodies: Population<L>,
        inflows: usize,
        scripts: Vec<Script>,
    ) -> Self
    where
        Population<L>: Checkpoint,
    {
        let places = vec![None; scripts.len()];
        let mut cast = Self { bodies: Box::new(bodies), inflows, scripts, places, time: 0.0 };
        cast.find();
        cast
    }
    /// Numbers of bodies that came in and that left.
    pub(crate) fn turnover(&self) -> [u64; 2] {
        [(0..self.inflows).map(|i| self.bodies.entered(i)).sum(), self.bodies.left()]
    }

    /// Finds those who move by formulas; numbers close up when bodies leave.
    fn find(&mut self) {
        if self.scripts.is_empty() {
            return;
        }
        self.places.fill(None);
        for b in (0..self.bodies.n_bodies()).map(BodyId) {
            if let Origin::Start(start) = self.bodies.origin(b)
                && let Ok(place) = self.scripts.binary_search_by_key(&start, |script| script.number)
            {
                self.places[place] = Some(b);
            }
        }
    }

    fn direct(&mut self, twist: impl Fn(&PrescribedMotion) -> Twist) {
        for (script, place) in self.scripts.iter().zip(&self.places) {
            if let Some(b) = place {
                self.bodies.set_twist(*b, twist(&script.motion));
            }
        }
    }
}

impl Kinematics for Cast {
    fn n_bodies(&self) -> usize {
        self.bodies.n_bodies()
    }
    fn pose(&self, b: BodyId) -> Pose {
        self.bodies.pose(b)
    }
    fn twist(&self, b: BodyId) -> Twist {
        self.bodies.twist(b)
    }
    fn surface_motion(&self, b: BodyId, arm: Vector) -> Option<Vector> {
        self.bodies.surface_motion(b, arm)
    }
}

impl Bodies for Cast {
    fn solid(&self, b: BodyId) -> &dyn Solid {
        self.bodies.solid(b)
    }
    fn inertia(&self, b: BodyId) -> Inertia {
        self.bodies.inertia(b)
    }
    fn freedom(&self, b: BodyId) -> Freedom {
        self.bodies.freedom(b)
    }
}

impl Dynamics for Cast {
    type Error = PlacingError;
    fn apply(&mut self, b: BodyId, load: Load) {
        self.bodies.apply(b, load);
    }
    /// Those who move by formulas are where these say at the end, up to round-off, and have the velocity there.
    fn advance(&mut self, dt: f64) -> Result<(), PlacingError> {
        let time = self.time;
        self.scripts.iter().for_each(|script| script.formulas.try_at(time + dt));
        self.direct(|motion| motion.mean(time, dt));
        self.bodies.advance(dt)?;
        self.direct(|motion| motion.velocity(time + dt, dt));
        Ok(())
    }
    fn contact_impulse(&self, b: BodyId) -> Wrench {
        self.bodies.contact_impulse(b)
    }
    fn set_twist(&mut self, b: BodyId, twist: Twist) {
        self.bodies.set_twist(b, twist);
    }
    fn stable_dt(&self) -> f64 {
        self.bodies.stable_dt()
    }
    fn exit_distance(&self, b: BodyId, direction: Vector) -> f64 {
        self.bodies.exit_distance(b, direction)
    }
    fn renew(&mut self, time: f64) -> Result<Option<Renumbering>, PlacingError> {
        self.time = time;
        let numbers = self.bodies.renew(time)?;
        if numbers.is_some() {
            self.find();
        }
        Ok(numbers)
    }
}

impl Checkpoint for Cast {
    fn save(&self, sink: &mut dyn FnMut(&str, &[f64])) {
        self.bodies.save(sink);
    }
    fn restore<'a>(&mut self, source: &dyn Fn(&str) -> Option<&'a [f64]>) -> Result<(), RestartError> {
        self.bodies.restore(source)?;
        self.find();
        Ok(())
    }
}
