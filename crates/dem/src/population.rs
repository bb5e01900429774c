//! Bodies that come and go.
mod checkpoint;
mod inflow;

pub use inflow::{Entrant, Inflow};

use crate::contact::{Chen, ContactLaw};
use crate::placing::PlacingError;
use crate::{DemError, HalfSpace, RigidBodies, RigidDynamics, SmoothConvex};
use interfaces::{
    Bodies, BodyId, Dynamics, Freedom, Inertia, Kinematics, Load, Pose, Renumbering, Solid, Twist, Vector,
    Wrench,
};

/// [`RigidBodies`] that come in through [`Inflow`]s and go through exits while a run is on its way.
///
/// [`renew`](Dynamics::renew) takes away whose centre is inside an exit, and whom [`dismiss`](Self::dismiss) named, and lets in who is due.
/// It is called before every step: by the coupling in a flow, else by who makes the steps.
///
/// ```
/// use dem::{Entrant, HalfSpace, Inflow, Material, Population, RigidBodies, Sphere, placing::Region};
/// use dem::{Aabb, Dynamics, Freedom, Kinematics, Periods, Point, Twist, Vector};
/// use std::sync::Arc;
///
/// let mut bodies = RigidBodies::new(Periods::default());
/// bodies.set_gravity(Vector::new(0.0, 0.0, -9.81));
/// // 50 balls per second come in within a box at the top, and go 0.1 m below the origin.
/// let ball = Arc::new(Sphere::new(5e-3)?);
/// let spout = Aabb { min: Point::new(-0.02, -0.02, 0.1), max: Point::new(0.02, 0.02, 0.14) };
/// let inflow = Inflow::new(Region::cuboid(spout, [false; 3])?, 50.0, move |_| Entrant {
///     shape: ball.clone(),
///     material: Material::default(),
///     twist: Twist::default(),
///     freedom: Freedom::FREE,
/// })?;
/// let below = HalfSpace::new(Point::new(0.0, 0.0, -0.1), Vector::z())?;
/// let mut balls = Population::new(bodies).with_inflow(inflow).with_exit(below);
/// let dt = 1e-3;
/// for step in 0..1000 {
///     balls.renew(f64::from(step) * dt)?;
///     balls.advance(dt)?;
/// }
/// assert_eq!(balls.entered(0), 50);
/// assert!(balls.left() > 30 && balls.n_bodies() + balls.left() as usize == 50);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Population<L: ContactLaw = Chen> {
    bodies: RigidBodies<L>,
    inflows: Vec<Inflow>,
    exits: Vec<HalfSpace>,
    /// Where every body is from; those of the start come first, the others in the order in which they came in.
    origins: Vec<Origin>,
    /// How many came in through each inflow.
    entered: Vec<u64>,
    /// Who is to go at the next renewal.
    dismissed: Vec<BodyId>,
    left: u64,
}

/// Where a body is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Origin {
    /// It was there from the start, under this number.
    Start(usize),
    /// It came in.
    Inflow {
        /// Number of the inflow.
        inflow: usize,
        /// Its serial number there, from 0.
        serial: u64,
    },
}

impl<L: ContactLaw> Population<L> {
    /// Those `bodies` to begin with; nobody comes or goes.
    pub fn new(bodies: RigidBodies<L>) -> Self {
        let origins = (0..bodies.n_bodies()).map(Origin::Start).collect();
        Self { bodies, inflows: vec![], exits: vec![], origins, entered: vec![], dismissed: vec![], left: 0 }
    }
    /// Bodies come in here, too.
    #[must_use]
    pub fn with_inflow(mut self, inflow: Inflow) -> Self {
        self.inflows.push(inflow);
        self.entered.push(0);
        self
    }
    /// Whose centre is inside this half-space goes.
    #[must_use]
    pub fn with_exit(mut self, exit: HalfSpace) -> Self {
        self.exits.push(exit);
        self
    }
    /// Takes body `b` away at the next renewal.
    ///
    /// # Errors
    /// [`DemError::NoSuchBody`].
    pub fn dismiss(&mut self, b: BodyId) -> Result<(), DemError> {
        let bodies = self.bodies.n_bodies();
        if b.0 >= bodies {
            return Err(DemError::NoSuchBody { body: b, bodies });
        }
        self.dismissed.push(b);
        Ok(())
    }

    /// Where body `b` is from: what it keeps when numbers close up.
    pub fn origin(&self, b: BodyId) -> Origin {
        self.origins[b.0]
    }
    /// How many came in through an inflow so far; 0 if there is no such inflow.
    pub fn entered(&self, inflow: usize) -> u64 {
        self.entered.get(inflow).copied().unwrap_or(0)
    }
    /// How many found no place in an inflow and wait at `time` \[s\].
    pub fn waiting(&self, inflow: usize, time: f64) -> u64 {
        self.inflows.get(inflow).map_or(0, |i| i.due(time).saturating_sub(self.entered(inflow)))
    }
    /// How many went so far.
    pub fn left(&self) -> u64 {
        self.left
    }

    /// Takes away who is to go.
    fn see_off(&mut self) -> Result<Option<Renumbering>, DemError> {
        let Self { bodies, exits, .. } = &*self;
        let out = |b: &BodyId| exits.iter().any(|exit| exit.signed_distance(bodies.pose(*b).position) < 0.0);
        let mut gone: Vec<BodyId> = bodies.ids().filter(out).collect();
        gone.append(&mut self.dismissed);
        if gone.is_empty() {
            return Ok(None);
        }
        let numbers = self.bodies.remove(&gone)?;
        numbers.apply(&mut self.origins);
        self.left += (numbers.before() - numbers.left()) as u64;
        Ok(Some(numbers))
    }

    /// Lets in who is due through an inflow, as far as there is room.
    fn let_in(&mut self, inflow: usize, time: f64) -> Result<(), PlacingError> {
        // Bodies within this distance of the zone, sought anew for larger entrants only.
        let (mut reach, mut near) = (f64::NEG_INFINITY, Vec::new());
        while self.waiting(inflow, time) > 0 {
            let Self { bodies, inflows, entered, .. } = &*self;
            let serial = entered[inflow];
            let zone = &inflows[inflow];
            let entrant = (zone.recipe)(serial);
            let wanted = zone.reach(&*entrant.shape);
            if wanted > reach {
                reach = wanted;
                let is_near = |b: &BodyId| {
                    zone.is_near(bodies.shape(*b), bodies.pose(*b).position, reach, &bodies.periods())
                };
                near = bodies.ids().filter(is_near).collect();
            }
            let others = near.iter().map(|&b| (bodies.shape(b), bodies.pose(b)));
            let place =
                zone.place(&*entrant.shape, (serial, time), others, bodies.walls(), &bodies.periods())?;
            let Some(pose) = place else { return Ok(()) };
            near.push(self.add(entrant, pose, Origin::Inflow { inflow, serial })?);
            self.entered[inflow] += 1;
        }
        Ok(())
    }

    fn add(&mut self, entrant: Entrant, pose: Pose, origin: Origin) -> Result<BodyId, DemError> {
        let Entrant { shape, material, twist, freedom } = entrant;
        let body = self.bodies.add(shape, material, pose, twist, freedom)?;
        self.origins.push(origin);
        Ok(body)
    }
}

impl<L: ContactLaw> std::fmt::Debug for Population<L> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Population")
            .field("bodies", &self.bodies.n_bodies())
            .field("entered", &self.entered)
            .field("left", &self.left)
            .finish_non_exhaustive()
    }
}

impl<L: ContactLaw> Kinematics for Population<L> {
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

impl<L: ContactLaw> Bodies for Population<L> {
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

impl<L: ContactLaw> RigidDynamics for Population<L> {
    type Law = L;
    fn rigid_bodies(&self) -> &RigidBodies<L> {
        &self.bodies
    }
}

impl<L: ContactLaw> Dynamics for Population<L> {
    type Error = PlacingError;
    fn apply(&mut self, b: BodyId, load: Load) {
        self.bodies.apply(b, load);
    }
    fn advance(&mut self, dt: f64) -> Result<(), PlacingError> {
        Ok(self.bodies.advance(dt)?)
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
    /// Along the line from the centre of body `b` into the nearest exit.
    fn exit_distance(&self, b: BodyId, direction: Vector) -> f64 {
        if self.dismissed.contains(&b) {
            return 0.0;
        }
        let centre = self.bodies.pose(b).position;
        let ahead = |exit: &HalfSpace| {
            let [from, to] = exit.chord(centre, direction)?;
            // The plane itself is not inside.
            (to > 0.0).then_some(from.max(0.0))
        };
        self.exits.iter().filter_map(ahead).fold(f64::INFINITY, f64::min)
    }
    /// Called again at the same time it changes nothing.
    fn renew(&mut self, time: f64) -> Result<Option<Renumbering>, PlacingError> {
        self.bodies.renew(time)?;
        let numbers = self.see_off()?;
        for inflow in 0..self.inflows.len() {
            self.let_in(inflow, time)?;
        }
        Ok(numbers)
    }
}
