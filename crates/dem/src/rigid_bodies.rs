//! The set of bodies; how they move is in `advance`.
mod advance;
mod body;
mod checkpoint;
mod contacts;
mod depth;
mod film;
mod meeting;
mod near;
mod push;
mod removal;
mod sleep;
mod surfaces;
mod sweep;
mod tether;
mod time_step;
mod turning;

pub use depth::{DEEP, Depth, RestingDepth, resting_depth};

use crate::broad_phase::{NearPair, PairList};
use crate::contact::{Chen, ContactLaw, Potential};
use crate::{DemError, HalfSpace, Material, Overlap, OverlapSolver, PairProperties, Shape};
use body::{Body, Constants, Kind, Loads, is_finite, shared};
use contacts::{Chunk, Patch, Wall, wall_of};
use interfaces::{
    Aabb, Bodies, BodyId, Freedom, Inertia, Kinematics, Periods, Point, Pose, Solid, Twist, Vector, Wrench,
    is_longer,
};
use meeting::shift;
use near::Listed;
pub use sleep::Sleep;
use sleep::Sleepers;
use std::sync::Arc;
use surfaces::Surfaces;
use sweep::Felt;
pub use tether::Tether;

/// Rigid bodies of any shape that touch one another and plane walls, in a box that may be periodic.
///
/// [`advance`](interfaces::Dynamics::advance) moves them by the drift–kick–drift form of the leapfrog method (symplectic, second order;
/// rotations of unequal moments by a symmetric splitting about the principal axes), in one step while no bounding boxes can meet,
/// else in steps of at most [`stable_dt`](interfaces::Dynamics::stable_dt). Damping and friction see the velocity at the start of a
/// sub-step, so they are of first order. `L` is the law of contact: [`Chen`] as in the literature, [`Potential`] where energy and
/// restitution matter, either in [`Rolling`](crate::Rolling). A warmed-up `advance` on one thread allocates nothing; results do not depend on the number of threads.
#[derive(Clone, Debug)]
pub struct RigidBodies<L: ContactLaw = Chen> {
    law: L,
    periods: Periods,
    gravity: Vector,
    bodies: Vec<Body>,
    constants: Vec<Constants>,
    loads: Loads,
    /// Contact wrenches now, and their time integrals over the last advance.
    contact: Vec<Wrench>,
    impulse: Vec<Wrench>,
    walls: Vec<Wall>,
    /// Materials of one density: contacts do not depend on it.
    materials: Vec<Material>,
    /// Properties of every pair of materials, by [`pair_index`].
    properties: Vec<PairProperties>,
    /// Where bodies were when pairs were listed, and the boxes that came of it.
    listed: Vec<Listed>,
    boxes: Vec<Aabb>,
    movable: Vec<bool>,
    /// Are all bodies balls or discs?
    all_round: bool,
    pairs: PairList,
    /// Pairs of bodies, then of bodies and (numbered from the top down) walls, each in ascending order; and those listed before.
    near: Vec<NearPair>,
    last_near: Vec<NearPair>,
    /// Where threads share the work.
    felt: Felt,
    chunks: Vec<Chunk<L::Memory>>,
    carried: Vec<(NearPair, Patch<L::Memory>)>,
    sleepers: Sleepers<L::Memory>,
    surfaces: Surfaces,
    /// Whether any surface slides.
    any_slides: bool,
    /// One per body, or none at all.
    tethers: Vec<Option<Tether>>,
    /// Number of bodies with a tether.
    tied: usize,
    contact_time: f64,
    overlap_calls: u64,
    /// Kept, because every advance asks for it.
    stable_dt: f64,
    /// Largest stiffness over mass in the last sub-step \[1/s²\].
    stiffest: f64,
    /// Largest rate of approach by size when pairs were listed \[1/s\].
    fastest: f64,
    /// How far ahead pairs were listed \[s\].
    listed_for: f64,
    /// Length of the last sub-step \[s\].
    last_step: f64,
    /// Time \[s\].
    time: f64,
}

/// Place of the properties of a pair of materials: those of material m and the ones before it
/// follow the pairs of these.
#[inline]
fn pair_index(a: u32, b: u32) -> usize {
    let (a, b) = (a as usize, b as usize);
    let m = a.max(b);
    m * m + if a == m { b } else { m + 1 + a }
}

/// Depth of overlaps at the start that count as round-off, over the radius around the smaller body.
const ROUND_OFF: f64 = 1e-9;

/// A patch that two bodies share, and what it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The body that feels the force.
    pub body: BodyId,
    /// What it touches.
    pub partner: Partner,
    /// Volume that both share \[m³\].
    pub volume: f64,
    /// Area of the patch, |∂V/∂x| \[m²\].
    pub area: f64,
    /// Its centroid, next to `body` \[m\].
    pub point: Point,
    /// The way the overlap pushes `body`, of unit length.
    pub normal: Vector,
    /// Force on `body` at the centroid \[N\].
    pub force: Vector,
    /// Torque on it besides \[N m\].
    pub couple: Vector,
}

/// What a body touches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Partner {
    /// Another body, or rather its image so many periods away.
    Body(BodyId, [i32; 3]),
    /// A wall, by its number.
    Wall(usize),
}

impl std::fmt::Display for Partner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Body(b, [0, 0, 0]) => write!(f, "body {}", b.0),
            Self::Body(b, image) => write!(f, "body {}, {image:?} periods away", b.0),
            Self::Wall(wall) => write!(f, "wall {wall}"),
        }
    }
}

impl RigidBodies {
    /// No bodies yet, in space that repeats after `periods`; contacts by [`Chen`]'s law.
    pub fn new(periods: Periods) -> Self {
        Self::with_law(periods, Chen::default())
    }
}

impl<L: ContactLaw> RigidBodies<L> {
    /// No bodies yet, in space that repeats after `periods`; contacts by `law`.
    pub fn with_law(periods: Periods, law: L) -> Self {
        Self {
            law,
            periods,
            gravity: Vector::zeros(),
            bodies: Vec::new(),
            constants: Vec::new(),
            loads: Loads::default(),
            contact: Vec::new(),
            impulse: Vec::new(),
            walls: Vec::new(),
            materials: Vec::new(),
            properties: Vec::new(),
            listed: Vec::new(),
            boxes: Vec::new(),
            movable: Vec::new(),
            all_round: true,
            pairs: PairList::new(periods),
            near: Vec::new(),
            last_near: Vec::new(),
            felt: Felt::default(),
            chunks: Vec::new(),
            carried: Vec::new(),
            sleepers: Sleepers::default(),
            surfaces: Surfaces::default(),
            any_slides: false,
            tethers: Vec::new(),
            tied: 0,
            contact_time: 0.0,
            overlap_calls: 0,
            stable_dt: f64::INFINITY,
            stiffest: 0.0,
            fastest: 0.0,
            listed_for: 0.0,
            last_step: 0.0,
            time: 0.0,
        }
    }

    /// Weight: every body that can be moved is accelerated by `gravity` \[m/s²\], besides its load. None unless told.
    pub fn set_gravity(&mut self, gravity: Vector) {
        if gravity != self.gravity {
            self.wake_all();
        }
        self.gravity = gravity;
    }

    /// Adds a body. Bodies may share a shape in an `Arc`.
    ///
    /// # Errors
    /// [`DemError`] for a law, material, place, motion or size that makes no sense here, and for a disc among solid bodies
    /// or a solid body among discs. Overlaps are left to [`check_overlaps`](Self::check_overlaps).
    pub fn add(
        &mut self,
        shape: impl Shape + 'static,
        material: Material,
        pose: Pose,
        twist: Twist,
        freedom: Freedom,
    ) -> Result<BodyId, DemError> {
        let body = BodyId(self.bodies.len());
        material.check()?;
        self.law.check()?;
        let place = pose.position.iter().chain(pose.orientation.coords.iter());
        if !place.into_iter().all(|x| x.is_finite()) {
            return Err(DemError::Start { body, position: pose.position.into() });
        }
        if !is_finite(&twist) {
            let (linear, angular) = (twist.linear.into(), twist.angular.into());
            return Err(DemError::StartMotion { body, linear, angular });
        }
        let constants = Constants::new(shared(shape), material.density, freedom);
        let kind = constants.kind();
        if !constants.inertia.mass.is_finite() {
            return Err(DemError::Unsupported { a: constants.shape.name(), b: "body" });
        }
        let plane = constants.shape.form().is_plane();
        if !L::PLANE && plane {
            return Err(DemError::Unsupported { a: constants.shape.name(), b: "film" });
        }
        if let (Some(first), Some(other)) = (self.bodies.first(), self.constants.first())
            && first.is_plane() != plane
        {
            return Err(DemError::Unsupported { a: other.shape.name(), b: constants.shape.name() });
        }
        let extent = constants.shape.aabb().posed(&pose).extent();
        for axis in 0..3 {
            // Contact with its own image does nothing to a body that is held.
            if let Some(period) = self.periods.along(axis)
                && is_longer(extent[axis], period)
                && constants.movable()
            {
                return Err(DemError::Period { body, axis, size: extent[axis], period });
            }
        }
        self.all_round &= kind != Kind::Other;
        let number = self.number_of(material);
        self.bodies.push(Body {
            pose,
            twist,
            radius: constants.shape.bounding_radius(),
            inverse_mass: if constants.pinned() { 0.0 } else { 1.0 / constants.inertia.mass },
            material: number,
            kind,
            plane,
        });
        self.constants.push(constants);
        self.loads.add();
        self.contact.push(Wrench::default());
        self.impulse.push(Wrench::default());
        self.listed.push(Listed::not_yet());
        self.sleepers.add();
        self.stable_dt = self.stable_dt.min(self.stable_dt_of(body.0));
        Ok(body)
    }

    /// Adds a plane wall of `material` (its density does not matter: walls keep their place). Its surface may
    /// [move](Self::set_wall_velocity).
    ///
    /// # Errors
    /// [`DemError::Material`].
    pub fn add_wall(&mut self, plane: HalfSpace, material: Material) -> Result<(), DemError> {
        material.check()?;
        let material = self.number_of(material);
        self.wake_all();
        self.walls.push(Wall { plane, material });
        self.listed.iter_mut().for_each(|l| *l = Listed::not_yet());
        self.stable_dt = self.least_stable_dt(0.0);
        Ok(())
    }

    /// The number of a material, a new one if it was not there; properties of its pairs are
    /// appended. Materials that differ in density only have one number.
    fn number_of(&mut self, material: Material) -> u32 {
        let material = Material { density: Material::default().density, ..material };
        if let Some(known) = self.materials.iter().position(|m| *m == material) {
            return known as u32;
        }
        let number = self.materials.len();
        self.materials.push(material);
        // Pairs in the order of `pair_index`.
        let (law, all) = (&self.law, &self.materials);
        self.properties.extend(all.iter().map(|b| law.properties(&material, b)));
        self.properties.extend(all[..number].iter().map(|a| law.properties(a, &material)));
        number as u32
    }

    fn pair_properties(&self, a: u32, b: u32) -> &PairProperties {
        &self.properties[pair_index(a, b)]
    }

    /// Are all bodies clear of one another and of the walls? Bodies that cannot be moved are not compared with one another.
    /// Overlaps of up to 10⁻⁹ of the radius of the smaller body's bounding sphere count as round-off of bodies that touch.
    ///
    /// # Errors
    /// [`DemError::OverlappingStart`] or [`DemError::InWall`] for the first that are not, and what the overlaps themselves answer.
    pub fn check_overlaps(&mut self) -> Result<(), DemError> {
        if self.listed.iter().any(|l| l.margin < 0.0) {
            self.list(0.0)?;
        }
        let mut solver = OverlapSolver::new();
        for pair in &self.near {
            let mut depth = None;
            let mut found = |patches: &[Overlap]| {
                // Of a cap.
                let of = |o: &Overlap| if o.area() > 0.0 { 2.0 * o.volume / o.area() } else { f64::INFINITY };
                depth = patches.iter().map(of).reduce(f64::max);
            };
            self.view().overlaps(pair, &mut solver, &mut found)?;
            let Some(depth) = depth else { continue };
            let (a, b) = (pair.a as usize, pair.b as usize);
            let body = &self.bodies[a];
            if let Some(other) = self.bodies.get(b) {
                let apart = other.pose.position + shift(&self.periods, pair.image) - body.pose.position;
                let round = body.kind != Kind::Other && other.kind != Kind::Other;
                let depth = if round { body.radius + other.radius - apart.norm() } else { depth };
                if depth <= ROUND_OFF * body.radius.min(other.radius) {
                    continue;
                }
                return Err(DemError::OverlappingStart { a: BodyId(a), b: BodyId(b), depth });
            }
            let wall = wall_of(pair.b);
            let gap = self.walls[wall].plane.signed_distance(body.pose.position) - body.radius;
            let depth = if body.kind == Kind::Other { depth } else { -gap };
            if depth <= ROUND_OFF * body.radius {
                continue;
            }
            return Err(DemError::InWall { body: BodyId(a), wall, depth });
        }
        Ok(())
    }

    /// The smallest distance between any two surfaces \[m\], negative when they overlap; walls count. `None`
    /// with one body and no walls. Bodies that are not round count as the spheres around them, so the true distance may be larger. Looks at all pairs.
    pub fn smallest_gap(&self) -> Option<f64> {
        let gaps = (0..self.bodies.len()).flat_map(|j| {
            let b = &self.bodies[j];
            let pairs = self.bodies[..j].iter().map(move |a| {
                let apart = self.periods.nearest(b.pose.position - a.pose.position);
                apart.norm() - b.radius - a.radius
            });
            let to_wall = |w: &Wall| w.plane.signed_distance(b.pose.position) - b.radius;
            pairs.chain(self.walls.iter().map(to_wall))
        });
        gaps.reduce(f64::min)
    }
    /// All patches that bodies shared in the last sub-step, in a fixed order.
    pub fn contacts(&self) -> impl Iterator<Item = Contact> {
        let awake = self.chunks.iter().flat_map(|c| &c.patches).map(|p| (self.near[p.near as usize], p));
        awake.chain(self.sleepers.kept()).map(|(pair, p)| {
            let (body, partner) = (BodyId(pair.a as usize), self.view().partner(&pair));
            let Patch { volume, area, point, normal, force, couple, .. } = *p;
            Contact { body, partner, volume, area, point, normal, force, couple }
        })
    }
    /// Seconds so far in which anything touched anything.
    pub fn contact_time(&self) -> f64 {
        self.contact_time
    }
    /// How many patches bodies shared in the last sub-step, those with walls included.
    pub fn n_contacts(&self) -> usize {
        let awake: usize = self.chunks.iter().map(|c| c.patches.len()).sum();
        awake + self.sleepers.patches.len() + self.sleepers.woken.len()
    }
    /// How many overlaps were computed in all steps so far; pairs whose boxes are apart cost none.
    pub fn overlap_calls(&self) -> u64 {
        self.overlap_calls
    }
    /// Σ ½mU² + ½ΩIΩ \[J\]; per metre of depth in a plane scene.
    pub fn kinetic_energy(&self) -> f64 {
        let energy = |(b, c): (&Body, &Constants)| {
            let turned = b.pose.orientation.inverse_transform_vector(&b.twist.angular);
            0.5 * (c.inertia.mass * b.twist.linear.norm_squared() + turned.dot(&(c.inertia.tensor * turned)))
        };
        self.bodies.iter().zip(&self.constants).map(energy).sum()
    }
    /// The periods of space.
    pub fn periods(&self) -> Periods {
        self.periods
    }
    /// The walls.
    pub fn walls(&self) -> impl Iterator<Item = &HalfSpace> {
        self.walls.iter().map(|w| &w.plane)
    }
    /// The shape of body `b`.
    pub fn shape(&self, b: BodyId) -> &dyn Shape {
        &**self.shared_shape(b)
    }
    pub(crate) fn shared_shape(&self, b: BodyId) -> &Arc<dyn Shape> {
        &self.constants[b.0].shape
    }
}

impl RigidBodies<Potential> {
    /// ΣE(V) over all pairs that overlap now \[J\].
    ///
    /// # Errors
    /// Those of the overlaps.
    pub fn elastic_energy(&mut self) -> Result<f64, DemError> {
        if self.strayed() {
            self.list(0.0)?;
        }
        let (mut solver, mut energy) = (OverlapSolver::new(), 0.0);
        let mut asleep: Vec<NearPair> = self.sleepers.patches.iter().map(|(pair, _)| *pair).collect();
        asleep.dedup();
        for pair in self.near.iter().chain(&asleep) {
            let (a, b) = (pair.a as usize, pair.b as usize);
            let (size, face, material) = match self.bodies.get(b) {
                Some(body) => (self.constants[b].size, self.constants[b].face, body.material),
                None => (f64::INFINITY, f64::INFINITY, self.walls[wall_of(pair.b)].material),
            };
            let first = &self.constants[a];
            let properties = self.pair_properties(self.bodies[a].material, material);
            let (sizes, face, plane) = ([first.size, size], first.face.min(face), self.bodies[a].is_plane());
            let mut found = |patches: &[Overlap]| {
                let volume = patches.iter().map(|o| o.volume).sum();
                energy += self.law.energy(properties, sizes, face, volume, plane).0;
            };
            self.view().overlaps(pair, &mut solver, &mut found)?;
        }
        Ok(energy)
    }
}

impl<L: ContactLaw> Kinematics for RigidBodies<L> {
    fn n_bodies(&self) -> usize {
        self.bodies.len()
    }
    fn pose(&self, b: BodyId) -> Pose {
        self.bodies[b.0].pose
    }
    fn twist(&self, b: BodyId) -> Twist {
        self.bodies[b.0].twist
    }
    fn surface_motion(&self, b: BodyId, arm: Vector) -> Option<Vector> {
        self.surfaces.body(b.0, &self.bodies[b.0].pose, arm, self.time)
    }
}

impl<L: ContactLaw> Bodies for RigidBodies<L> {
    fn solid(&self, b: BodyId) -> &dyn Solid {
        &self.constants[b.0].shape
    }
    fn inertia(&self, b: BodyId) -> Inertia {
        self.constants[b.0].inertia
    }
    fn freedom(&self, b: BodyId) -> Freedom {
        self.constants[b.0].freedom
    }
}
