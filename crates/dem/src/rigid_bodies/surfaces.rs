//! Surfaces that slide along themselves: belts, walls that move in their own plane.
use super::RigidBodies;
use super::contacts::wall_of;
use super::meeting::{Meeting, Other};
use crate::DemError;
use crate::contact::ContactLaw;
use interfaces::{BodyId, Point, Pose, Renumbering, Vector};
use std::fmt;
use std::sync::Arc;

/// Velocity of a surface \[m/s\] as a function of place \[m\] and time \[s\]: of a wall in the world, of a body in its own frame.
type Field = Arc<dyn Fn(Point, f64) -> Vector + Send + Sync>;

/// Velocity in the world of a body's surface at `arm` from its centre of mass in the world.
fn turned(u: &Field, pose: &Pose, arm: Vector, time: f64) -> Vector {
    let place = pose.orientation.inverse_transform_vector(&arm);
    pose.orientation * u(Point::from(place), time)
}

/// Velocities of surfaces besides those of their bodies.
#[derive(Clone, Default)]
pub(super) struct Surfaces {
    bodies: Vec<Option<Field>>,
    walls: Vec<Option<Field>>,
    /// Velocities of walls that are the same everywhere.
    uniform: Vec<Option<Vector>>,
}

impl fmt::Debug for Surfaces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = |fields: &[Option<Field>]| fields.iter().flatten().count();
        f.debug_struct("Surfaces")
            .field("bodies", &count(&self.bodies))
            .field("walls", &count(&self.walls))
            .finish()
    }
}

/// The place `i` of a list that is filled up to there.
fn at<T: Clone + Default>(list: &mut Vec<T>, i: usize) -> &mut T {
    if list.len() <= i {
        list.resize(i + 1, T::default());
    }
    &mut list[i]
}

impl Surfaces {
    pub(super) fn renumber(&mut self, numbers: &Renumbering) {
        if !self.bodies.is_empty() {
            self.bodies.resize(numbers.before(), None);
            numbers.apply(&mut self.bodies);
        }
    }
    fn of_body(&self, b: usize) -> Option<&Field> {
        self.bodies.get(b)?.as_ref()
    }
    fn of_wall(&self, wall: usize) -> Option<&Field> {
        self.walls.get(wall)?.as_ref()
    }
    pub(super) fn body(&self, b: usize, pose: &Pose, arm: Vector, time: f64) -> Option<Vector> {
        self.of_body(b).map(|u| turned(u, pose, arm, time))
    }
    /// Whether the surface of a pair's second slides, or of its first.
    pub(super) fn slides(&self, a: usize, b: usize, wall: Option<usize>) -> bool {
        let second = match wall {
            Some(wall) => self.of_wall(wall),
            None => self.of_body(b),
        };
        second.is_some() || self.of_body(a).is_some()
    }

    /// Velocities of both surfaces of a pair at `point` and `time`, besides those of the bodies; the parts normal to the contact, by
    /// which a surface blows or sucks, are left out.
    #[cold]
    pub(super) fn both(&self, meeting: &Meeting<'_>, point: Point, normal: Vector, time: f64) -> [Vector; 2] {
        let (pair, pose) = (meeting.pair, &meeting.a.pose);
        let first = self.body(pair.a as usize, pose, point - pose.position, time);
        let second = match meeting.other {
            Other::Body(b, at_b) => self.body(pair.b as usize, &b.pose, point - at_b, time),
            Other::Wall(_) => self.of_wall(wall_of(pair.b)).map(|u| u(point, time)),
        };
        [first, second].map(|u| {
            let u = u.unwrap_or_default();
            u - normal * normal.dot(&u)
        })
    }

    /// Velocity of the first surface against the second.
    pub(super) fn slip(&self, meeting: &Meeting<'_>, point: Point, normal: Vector, time: f64) -> Vector {
        let [first, second] = self.both(meeting, point, normal, time);
        first - second
    }

    /// Rate at which the first surface turns against the second about the normal: ½ n·∇×u by differences over the
    /// radius of gyration `radius` of the patch.
    #[cold]
    pub(super) fn spin(&self, meeting: &Meeting<'_>, patch: (Point, Vector, f64), time: f64) -> Vector {
        let (point, normal, radius) = patch;
        let first = normal.cross(&Vector::ith(normal.iamin(), 1.0)).normalize();
        let second = normal.cross(&first);
        let along = |e: Vector| {
            let [ahead, behind] = [radius, -radius].map(|h| self.slip(meeting, point + e * h, normal, time));
            (ahead - behind) / (2.0 * radius)
        };
        normal * (0.5 * (along(first).dot(&second) - along(second).dot(&first)))
    }
}

impl<L: ContactLaw> RigidBodies<L> {
    /// The surface of a wall moves in its plane with this `velocity` \[m/s\], as a belt does; sleeping bodies wake.
    ///
    /// # Errors
    /// [`DemError::NoSuchWall`]; [`DemError::WallVelocity`] for a velocity that is not finite or leads out of the plane.
    pub fn set_wall_velocity(&mut self, wall: usize, velocity: Vector) -> Result<(), DemError> {
        let walls = self.walls.len();
        let Some(plane) = self.walls.get(wall).map(|w| w.plane) else {
            return Err(DemError::NoSuchWall { wall, walls });
        };
        let along = plane.normal().dot(&velocity).abs() <= 1e-12 * velocity.norm();
        if !(velocity.iter().all(|u| u.is_finite()) && along) {
            let normal = plane.normal().into();
            return Err(DemError::WallVelocity { wall, velocity: velocity.into(), normal });
        }
        let known = at(&mut self.surfaces.uniform, wall);
        if known.replace(velocity) == Some(velocity) {
            return Ok(());
        }
        let field: Option<Field> =
            if velocity == Vector::zeros() { None } else { Some(Arc::new(move |_, _| velocity)) };
        *at(&mut self.surfaces.walls, wall) = field;
        self.surfaces_changed();
        Ok(())
    }

    /// The same with a velocity as a function of the place in the world and of the time \[s\], until another one is set. Its part
    /// out of the plane has no effect. Time is that of [`renew`](interfaces::Dynamics::renew), from 0 on.
    ///
    /// # Errors
    /// [`DemError::NoSuchWall`].
    pub fn set_wall_motion(
        &mut self,
        wall: usize,
        velocity: impl Fn(Point, f64) -> Vector + Send + Sync + 'static,
    ) -> Result<(), DemError> {
        let walls = self.walls.len();
        if wall >= walls {
            return Err(DemError::NoSuchWall { wall, walls });
        }
        *at(&mut self.surfaces.uniform, wall) = None;
        *at(&mut self.surfaces.walls, wall) = Some(Arc::new(velocity));
        self.surfaces_changed();
        Ok(())
    }

    /// The surface of body `b` moves besides the body with a `velocity` that depends on place and time \[s\], both vectors in the
    /// body's frame, until another one is set: flows have all of it
    /// ([`surface_motion`](interfaces::Kinematics::surface_motion)), contacts and films the part along the surface. Time is that of
    /// [`renew`](interfaces::Dynamics::renew), from 0 on. Sleeping bodies wake.
    ///
    /// # Errors
    /// [`DemError::NoSuchBody`].
    pub fn set_surface_motion(
        &mut self,
        b: BodyId,
        velocity: impl Fn(Point, f64) -> Vector + Send + Sync + 'static,
    ) -> Result<(), DemError> {
        let bodies = self.bodies.len();
        if b.0 >= bodies {
            return Err(DemError::NoSuchBody { body: b, bodies });
        }
        *at(&mut self.surfaces.bodies, b.0) = Some(Arc::new(velocity));
        self.any_slides = true;
        self.wake_all();
        Ok(())
    }

    fn surfaces_changed(&mut self) {
        let Surfaces { bodies, walls, .. } = &self.surfaces;
        self.any_slides = bodies.iter().chain(walls).any(Option::is_some);
        self.wake_all();
    }
}
