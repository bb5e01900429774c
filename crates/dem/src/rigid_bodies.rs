//! The set of bodies; how they move is in `motion`.
mod broad_phase;
mod checkpoint;
mod motion;
mod round;
#[cfg(test)]
mod tests;

use crate::{DemError, HalfSpace, Material};
pub use round::Round;

use broad_phase::{BroadPhase, Listed};
use interfaces::{
    Bodies, BodyId, Freedom, Inertia, Kinematics, Load, Periods, Pose, Solid, Twist, Vector, Wrench,
};

/// Rigid bodies that touch one another and plane walls, in a box that may be periodic.
///
/// [`advance`](interfaces::Dynamics::advance) moves them by the drift–kick–drift form of the leapfrog method
/// (symplectic, second order), in one step while no bounding boxes can meet, else in steps of at most
/// [`stable_dt`](interfaces::Dynamics::stable_dt). Damping and friction see the velocity at the start of a
/// sub-step, so they are of first order. A warmed-up `advance` allocates nothing.
#[derive(Clone, Debug)]
pub struct RigidBodies {
    periods: Periods,
    bodies: Vec<Body>,
    walls: Vec<(HalfSpace, Material)>,
    /// L_c = `length_factor` · l_i l_j/(l_i + l_j).
    length_factor: f64,
    /// Elastic tangential forces of touching pairs, sorted by pair; and those of the sub-step before.
    springs: Vec<Spring>,
    last_springs: Vec<Spring>,
    /// Pairs that may touch during this advance, sorted.
    near: Vec<Pair>,
    broad_phase: BroadPhase,
    contact_time: f64,
    overlap_calls: u64,
    /// Kept, because every advance asks for it.
    stable_dt: f64,
}

#[derive(Clone, Copy, Debug)]
struct Body {
    shape: Round,
    material: Material,
    inertia: Inertia,
    pose: Pose,
    twist: Twist,
    freedom: Freedom,
    load: Load,
    /// Contact wrench now, and its time integral over the last advance.
    contact: Wrench,
    impulse: Wrench,
    listed: Listed,
}

/// Two bodies, the lower number first, or a body and (from `n_bodies` on) a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Pair(usize, usize);

/// The elastic tangential force on the first of a pair.
#[derive(Clone, Copy, Debug)]
struct Spring {
    pair: Pair,
    force: Vector,
}

impl RigidBodies {
    /// No bodies yet, in space that repeats after `periods`.
    pub fn new(periods: Periods) -> Self {
        Self {
            periods,
            bodies: Vec::new(),
            walls: Vec::new(),
            length_factor: 4.0,
            springs: Vec::new(),
            last_springs: Vec::new(),
            near: Vec::new(),
            broad_phase: BroadPhase::default(),
            contact_time: 0.0,
            overlap_calls: 0,
            stable_dt: f64::INFINITY,
        }
    }
    /// Another factor c in L_c = c·l_i l_j/(l_i + l_j), positive; 4 unless told. [`add`](Self::add) refuses bodies
    /// when it is not.
    #[must_use]
    pub fn with_length_factor(mut self, factor: f64) -> Self {
        self.length_factor = factor;
        self.stable_dt = self.least_stable_dt();
        self
    }

    /// Adds a body.
    ///
    /// # Errors
    /// [`DemError`] for a material, place, motion or size that makes no sense here, and for a disc among spheres
    /// or a sphere among discs. Overlaps are left to [`check_overlaps`](Self::check_overlaps).
    pub fn add(
        &mut self,
        shape: impl Into<Round>,
        material: Material,
        pose: Pose,
        twist: Twist,
        freedom: Freedom,
    ) -> Result<BodyId, DemError> {
        let (shape, body) = (shape.into(), BodyId(self.bodies.len()));
        material.check()?;
        if !(self.length_factor.is_finite() && self.length_factor > 0.0) {
            return Err(DemError::LengthFactor { factor: self.length_factor });
        }
        if let Some(first) = self.bodies.first()
            && first.shape.is_plane() != shape.is_plane()
        {
            return Err(DemError::Unsupported { a: first.shape.name(), b: shape.name() });
        }
        let place = pose.position.iter().chain(pose.orientation.coords.iter());
        if !place.into_iter().all(|x| x.is_finite()) {
            return Err(DemError::Start { body, position: pose.position.into() });
        }
        if !twist.linear.iter().chain(&twist.angular).all(|x| x.is_finite()) {
            let (linear, angular) = (twist.linear.into(), twist.angular.into());
            return Err(DemError::StartMotion { body, linear, angular });
        }
        let extent = shape.solid().aabb().posed(&pose).extent();
        for axis in 0..3 {
            if let Some(period) = self.periods.along(axis)
                && extent[axis] > 0.5 * period
            {
                return Err(DemError::Period { body, axis, size: extent[axis], period });
            }
        }
        let new = Body {
            shape,
            material,
            inertia: shape.inertia(material.density),
            pose,
            twist,
            freedom,
            load: Load::default(),
            contact: Wrench::default(),
            impulse: Wrench::default(),
            listed: Listed { centre: pose.position, margin: 0.0 },
        };
        self.stable_dt = self.stable_dt.min(self.stable_dt_of(&new));
        self.bodies.push(new);
        Ok(body)
    }

    /// Adds a plane wall of `material` (its density does not matter: walls do not move).
    ///
    /// # Errors
    /// [`DemError::Material`].
    pub fn add_wall(&mut self, wall: HalfSpace, material: Material) -> Result<(), DemError> {
        material.check()?;
        self.walls.push((wall, material));
        self.stable_dt = self.least_stable_dt();
        Ok(())
    }

    /// Are all bodies clear of one another and of the walls?
    ///
    /// # Errors
    /// [`DemError::OverlappingStart`] or [`DemError::InWall`] for the first that are not.
    pub fn check_overlaps(&self) -> Result<(), DemError> {
        for (j, b) in self.bodies.iter().enumerate() {
            for (i, a) in self.bodies[..j].iter().enumerate() {
                let apart = self.periods.nearest(b.pose.position - a.pose.position);
                let at_b = a.pose.position + apart;
                if a.shape.overlap(a.pose.position, &b.shape, at_b)?.is_some() {
                    let depth = a.shape.radius() + b.shape.radius() - apart.norm();
                    return Err(DemError::OverlappingStart { a: BodyId(i), b: BodyId(j), depth });
                }
            }
            for (wall, (plane, _)) in self.walls.iter().enumerate() {
                if b.shape.wall_overlap(b.pose.position, plane).is_some() {
                    let depth = b.shape.radius() - plane.signed_distance(b.pose.position);
                    return Err(DemError::InWall { body: BodyId(j), wall, depth });
                }
            }
        }
        Ok(())
    }

    /// The smallest distance between any two surfaces \[m\], negative when they overlap; walls count. `None`
    /// with one body and no walls. Looks at all pairs.
    pub fn smallest_gap(&self) -> Option<f64> {
        let gaps = (0..self.bodies.len()).flat_map(|j| {
            let b = &self.bodies[j];
            let radius = b.shape.radius();
            let pairs = self.bodies[..j].iter().map(move |a| {
                let apart = self.periods.nearest(b.pose.position - a.pose.position);
                apart.norm() - radius - a.shape.radius()
            });
            pairs.chain(self.walls.iter().map(move |(w, _)| w.signed_distance(b.pose.position) - radius))
        });
        gaps.reduce(f64::min)
    }
    /// Seconds so far in which anything touched anything.
    pub fn contact_time(&self) -> f64 {
        self.contact_time
    }
    /// How many pairs touched in the last sub-step, those with walls included.
    pub fn n_contacts(&self) -> usize {
        self.springs.len()
    }
    /// How many overlaps were computed in all steps so far; pairs whose boxes are apart cost none.
    pub fn overlap_calls(&self) -> u64 {
        self.overlap_calls
    }
    /// Σ ½mU² + ½ΩIΩ \[J\]; per metre of depth in a plane scene.
    pub fn kinetic_energy(&self) -> f64 {
        let energy = |b: &Body| {
            let turned = b.pose.orientation.inverse_transform_vector(&b.twist.angular);
            0.5 * (b.inertia.mass * b.twist.linear.norm_squared() + turned.dot(&(b.inertia.tensor * turned)))
        };
        self.bodies.iter().map(energy).sum()
    }
    /// The periods of space.
    pub fn periods(&self) -> Periods {
        self.periods
    }
    /// The shape of body `b`.
    pub fn shape(&self, b: BodyId) -> &Round {
        &self.bodies[b.0].shape
    }
}

impl Body {
    /// How far the body may come from where its centre was listed, along any axis.
    fn reach(&self) -> f64 {
        self.shape.radius() + self.listed.margin
    }
    /// May its centre not be moved? Contacts then feel an infinite mass.
    fn pinned(&self) -> bool {
        self.freedom.linear == [false; 3]
    }
    /// Can forces change anything about it?
    fn movable(&self) -> bool {
        self.freedom != Freedom::NONE
    }
}

impl Kinematics for RigidBodies {
    fn n_bodies(&self) -> usize {
        self.bodies.len()
    }
    fn pose(&self, b: BodyId) -> Pose {
        self.bodies[b.0].pose
    }
    fn twist(&self, b: BodyId) -> Twist {
        self.bodies[b.0].twist
    }
}

impl Bodies for RigidBodies {
    fn solid(&self, b: BodyId) -> &dyn Solid {
        self.bodies[b.0].shape.solid()
    }
    fn inertia(&self, b: BodyId) -> Inertia {
        self.bodies[b.0].inertia
    }
    fn freedom(&self, b: BodyId) -> Freedom {
        self.bodies[b.0].freedom
    }
}
