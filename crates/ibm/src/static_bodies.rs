//! Solids at rest.
use interfaces::{Bodies, BodyId, Freedom, Inertia, Kinematics, Pose, Solid, Twist};
use nalgebra::Matrix3;

/// Any [`Solid`]s that stay where they are, as walls do: bodies without inertia or freedom.
///
/// ```
/// use ibm::StaticBodies;
/// use ibm::{Aabb, Kinematics, Point, Pose, Solid, Vector};
///
/// struct Disc(f64);
/// impl Solid for Disc {
///     fn signed_distance(&self, x: Point, _band: f64) -> f64 {
///         x.x.hypot(x.y) - self.0
///     }
///     fn aabb(&self) -> Aabb {
///         Aabb::around(Point::origin(), Vector::new(self.0, self.0, 0.0))
///     }
/// }
/// let walls = StaticBodies::new().with(Disc(0.1), Pose::at([0.2, 0.2, 0.0])).with(Disc(0.05), Pose::at([0.6, 0.2, 0.0]));
/// assert_eq!(walls.n_bodies(), 2);
/// ```
#[derive(Default)]
pub struct StaticBodies {
    bodies: Vec<(Box<dyn Solid>, Pose)>,
}

impl StaticBodies {
    /// None yet.
    pub fn new() -> Self {
        Self::default()
    }
    /// The same and `solid` at `pose`.
    #[must_use]
    pub fn with(mut self, solid: impl Solid + 'static, pose: Pose) -> Self {
        self.bodies.push((Box::new(solid), pose));
        self
    }
}

impl Kinematics for StaticBodies {
    fn n_bodies(&self) -> usize {
        self.bodies.len()
    }
    fn pose(&self, b: BodyId) -> Pose {
        self.bodies[b.0].1
    }
    fn twist(&self, _: BodyId) -> Twist {
        Twist::default()
    }
}

impl Bodies for StaticBodies {
    fn solid(&self, b: BodyId) -> &dyn Solid {
        &*self.bodies[b.0].0
    }
    fn inertia(&self, _: BodyId) -> Inertia {
        Inertia { mass: f64::INFINITY, volume: 0.0, tensor: Matrix3::repeat(f64::INFINITY) }
    }
    fn freedom(&self, _: BodyId) -> Freedom {
        Freedom::NONE
    }
}
