//! The plane wall.
use crate::DemError;
use interfaces::{Point, Vector};

/// A plane wall: everything behind the plane through `point` is solid, `normal` points out of it.
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
    /// Distance of `x` from the plane, negative in the wall \[m\].
    pub fn signed_distance(&self, x: Point) -> f64 {
        self.normal.dot(&(x - self.point))
    }
}
