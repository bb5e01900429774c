//! The plane wall.
use crate::{DemError, Form, Shape, SmoothConvex};
use interfaces::{Aabb, Inertia, Point, Pose, Solid, Vector};
use nalgebra::Matrix3;

/// A plane wall: everything behind the plane through `point` is solid, `normal` points out of it. Volume, mass and extent
/// are infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfSpace {
    point: Point,
    normal: Vector,
}

impl HalfSpace {
    /// The wall behind the plane through `point` with outward `normal` (of any length).
    ///
    /// # Errors
    /// [`DemError::Direction`] when the normal has no direction.
    pub fn new(point: Point, normal: Vector) -> Result<Self, DemError> {
        match normal.try_normalize(0.0) {
            Some(n) if n.iter().chain(point.iter()).all(|x| x.is_finite()) => Ok(Self { point, normal: n }),
            _ => Err(DemError::Direction { normal: normal.into() }),
        }
    }
    /// Outward unit normal.
    pub fn normal(&self) -> Vector {
        self.normal
    }
    /// The wall once its frame stands at `pose`.
    #[must_use]
    pub fn posed(&self, pose: &Pose) -> Self {
        Self { point: pose.to_world(self.point), normal: pose.orientation * self.normal }
    }
    /// Distance of `x` from the plane, negative in the wall \[m\].
    #[inline]
    pub fn signed_distance(&self, x: Point) -> f64 {
        self.normal.dot(&(x - self.point))
    }
}

/// Half the extent of the box around all space \[m\]; its squares are finite.
const EVERYWHERE: f64 = 1e100;

impl Shape for HalfSpace {
    fn name(&self) -> &'static str {
        "half-space"
    }
    fn inertia(&self, _density: f64) -> Inertia {
        let tensor = Matrix3::from_diagonal_element(f64::INFINITY);
        Inertia { mass: f64::INFINITY, volume: f64::INFINITY, tensor }
    }
    fn bounding_radius(&self) -> f64 {
        f64::INFINITY
    }
    fn form(&self) -> Form<'_> {
        Form::HalfSpace(self)
    }
}

impl Solid for HalfSpace {
    #[inline]
    fn signed_distance(&self, x: Point, _band: f64) -> f64 {
        self.normal.dot(&(x - self.point))
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::repeat(EVERYWHERE))
    }
    fn normal(&self, _x: Point, _band: f64) -> Vector {
        self.normal
    }
    fn curvature(&self, _x: Point, _band: f64) -> f64 {
        0.0
    }
}

impl SmoothConvex for HalfSpace {
    fn level(&self, x: Point) -> (f64, Vector) {
        (self.normal.dot(&(x - self.point)), self.normal)
    }
    fn chord(&self, o: Point, u: Vector) -> Option<[f64; 2]> {
        let (above, rate) = (self.normal.dot(&(o - self.point)), self.normal.dot(&u));
        if rate == 0.0 {
            (above <= 0.0).then_some([f64::NEG_INFINITY, f64::INFINITY])
        } else if rate > 0.0 {
            Some([f64::NEG_INFINITY, -above / rate])
        } else {
            Some([-above / rate, f64::INFINITY])
        }
    }
    /// Far away unless along the normal.
    fn support(&self, direction: Vector) -> Point {
        let across = direction - self.normal * self.normal.dot(&direction);
        self.point + across.try_normalize(0.0).unwrap_or_default() * EVERYWHERE
    }
}
