//! Surfaces that slide along themselves: belts, walls that move in their own plane.
use super::RigidBodies;
use super::contacts::wall_of;
use crate::DemError;
use crate::contact::ContactLaw;
use interfaces::{BodyId, Point, Renumbering, Vector};
use std::fmt;
use std::sync::Arc;

/// Velocity of a surface \[m/s\] by the place: of a wall in the world, of a body as the arm from its centre of mass in the world.
type Field = Arc<dyn Fn(Vector) -> Vector + Send + Sync>;

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
    pub(super) fn body(&self, b: usize, arm: Vector) -> Option<Vector> {
        self.of_body(b).map(|u| u(arm))
    }
    /// Whether the surface of a pair's second slides, or of its first.
    pub(super) fn slides(&self, a: usize, b: usize, wall: Option<usize>) -> bool {
        let second = match wall {
            Some(wall) => self.of_wall(wall),
            None => self.of_body(b),
        };
        second.is_some() || self.of_body(a).is_some()
    }

    /// Velocity of the first surface of a `pair` against the second at the `places` in these, besides that of the bodies; the part normal
    /// to the contact, by which a surface blows or sucks, is left out.
    #[cold]
    pub(super) fn slip(&self, [a, b]: [u32; 2], [at_a, at_b]: [Vector; 2], normal: Vector) -> Vector {
        let second = self.of_body(b as usize).or_else(|| self.of_wall(wall_of(b)));
        let [first, second] = [(self.of_body(a as usize), at_a), (second, at_b)]
            .map(|(u, at)| u.map_or_else(Vector::zeros, |u| u(at)));
        let slip = first - second;
        slip - normal * normal.dot(&slip)
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
            if velocity == Vector::zeros() { None } else { Some(Arc::new(move |_| velocity)) };
        *at(&mut self.surfaces.walls, wall) = field;
        self.surfaces_changed();
        Ok(())
    }

    /// The same with a velocity by the place in the world, until another one is set. Its part out of the plane has no effect.
    ///
    /// # Errors
    /// [`DemError::NoSuchWall`].
    pub fn set_wall_motion(
        &mut self,
        wall: usize,
        velocity: impl Fn(Point) -> Vector + Send + Sync + 'static,
    ) -> Result<(), DemError> {
        let walls = self.walls.len();
        if wall >= walls {
            return Err(DemError::NoSuchWall { wall, walls });
        }
        *at(&mut self.surfaces.uniform, wall) = None;
        *at(&mut self.surfaces.walls, wall) = Some(Arc::new(move |x: Vector| velocity(Point::from(x))));
        self.surfaces_changed();
        Ok(())
    }

    /// The surface of body `b` moves besides the body, by the arm from its centre of mass in the world, until another motion is
    /// set: what [`surface_motion`](interfaces::Kinematics::surface_motion) then returns to the flow, and contacts take the part
    /// along the surface of. Sleeping bodies wake.
    ///
    /// # Errors
    /// [`DemError::NoSuchBody`].
    pub fn set_surface_motion(
        &mut self,
        b: BodyId,
        velocity: impl Fn(Vector) -> Vector + Send + Sync + 'static,
    ) -> Result<(), DemError> {
        let bodies = self.bodies.len();
        if b.0 >= bodies {
            return Err(DemError::NoSuchBody { body: b, bodies });
        }
        *at(&mut self.surfaces.bodies, b.0) = Some(Arc::new(velocity));
        self.surfaces_changed();
        Ok(())
    }

    fn surfaces_changed(&mut self) {
        let Surfaces { bodies, walls, .. } = &self.surfaces;
        self.any_slides = bodies.iter().chain(walls).any(Option::is_some);
        self.wake_all();
    }
}
