//! Bodies as their neighbours see them.
use crate::{Aabb, Checkpoint, Pose, Renumbering, Solid, Twist, Vector, Wrench};
use nalgebra::Matrix3;

/// A body's number, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId(pub usize);

/// Mass, volume and central inertia of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// Mass \[kg\]; kg per metre of depth in a plane scene.
    pub mass: f64,
    /// Volume \[m³\]; area \[m²\] in a plane scene.
    pub volume: f64,
    /// Inertia tensor about the centre of mass, in the body's frame \[kg m²\].
    pub tensor: Matrix3<f64>,
}

/// Which components of a body's twist are free to change; the others stay as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Freedom {
    /// Translation along x, y, z.
    pub linear: [bool; 3],
    /// Rotation about x, y, z.
    pub angular: [bool; 3],
}

impl Freedom {
    /// All six.
    pub const FREE: Self = Self { linear: [true; 3], angular: [true; 3] };
    /// Motion in the plane z = 0.
    pub const PLANAR: Self = Self { linear: [true, true, false], angular: [false, false, true] };
    /// None: the twist is prescribed (zero for a body at rest).
    pub const NONE: Self = Self { linear: [false; 3], angular: [false; 3] };
}

/// Where bodies are and how they move.
pub trait Kinematics: Sync {
    /// How many there are.
    fn n_bodies(&self) -> usize;
    /// Where body `b` is.
    fn pose(&self, b: BodyId) -> Pose;
    /// How body `b` moves.
    fn twist(&self, b: BodyId) -> Twist;
    /// What the surface of body `b` does besides, at `arm` from its centre of mass, in the world: it slides, or blows and sucks (in a
    /// box without outlet as much as it sucks). Contacts take the part along the surface of what `dem::RigidBodies` is given
    /// (`set_surface_motion`). It is asked for on the surface and up to two cells from it. `None` (the
    /// default), everywhere, if it only moves with the body \[m/s\].
    fn surface_motion(&self, b: BodyId, arm: Vector) -> Option<Vector> {
        let _ = (b, arm);
        None
    }
    /// Velocity of the surface of body `b` at `arm` from its centre of mass: U + Ω × r + what it does besides \[m/s\].
    fn surface_velocity(&self, b: BodyId, arm: Vector) -> Vector {
        self.twist(b).at(arm) + self.surface_motion(b, arm).unwrap_or_default()
    }
    /// All their numbers.
    fn ids(&self) -> impl Iterator<Item = BodyId> + use<Self>
    where
        Self: Sized,
    {
        (0..self.n_bodies()).map(BodyId)
    }
}

/// Bodies with shape and mass.
pub trait Bodies: Kinematics {
    /// The shape of body `b`.
    fn solid(&self, b: BodyId) -> &dyn Solid;
    /// Mass properties of body `b`.
    fn inertia(&self, b: BodyId) -> Inertia;
    /// What body `b` is free to do.
    fn freedom(&self, b: BodyId) -> Freedom;
    /// The box around body `b` in the world.
    fn aabb(&self, b: BodyId) -> Aabb {
        self.solid(b).aabb().posed(&self.pose(b))
    }
}

/// What the surroundings do to a body during one step: (m + m_a) dU/dt = F + contact, and alike
/// for rotation. m_a is the part of the fluid that has to be accelerated along with the body.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Force and torque, held over the step.
    pub wrench: Wrench,
    /// Mass that the surroundings add to the body's own \[kg\].
    pub added_mass: f64,
    /// Moment of inertia, the same about every axis, that they add \[kg m²\].
    pub added_moment: f64,
}

/// Bodies that move one another and are moved.
pub trait Dynamics: Bodies + Checkpoint {
    /// Why a step could not be made.
    type Error: std::error::Error + Send + Sync + 'static;
    /// The load on body `b` during the next [`advance`](Self::advance).
    fn apply(&mut self, b: BodyId, load: Load);
    /// Moves all bodies by `dt` \[s\] under loads and contacts, in as many sub-steps as they need.
    ///
    /// # Errors
    /// When a step of this length cannot be made (non-finite load, overlap beyond the model …).
    fn advance(&mut self, dt: f64) -> Result<(), Self::Error>;
    /// Time integral of the contact wrench on body `b` over the last [`advance`](Self::advance).
    fn contact_impulse(&self, b: BodyId) -> Wrench;
    /// Gives body `b` another motion, within its [`Freedom`].
    fn set_twist(&mut self, b: BodyId, twist: Twist);
    /// The longest stable step of the contact model \[s\]; infinite without contacts.
    fn stable_dt(&self) -> f64;
    /// Before a step that begins at `time` \[s\]: bodies may go, as the answer tells, and others may be added behind those that are left.
    /// Nobody does unless told. It is called once per step at least, and at the same time changes nothing more.
    ///
    /// # Errors
    /// When who is due cannot come or go.
    fn renew(&mut self, time: f64) -> Result<Option<Renumbering>, Self::Error> {
        let _ = time;
        Ok(None)
    }
    /// Distance \[m\] that body `b` may move along the unit vector `direction` before [`renew`](Self::renew) removes it:
    /// 0 if the next call does, infinite (the default) if none will.
    fn exit_distance(&self, b: BodyId, direction: Vector) -> f64 {
        let _ = (b, direction);
        f64::INFINITY
    }
}
