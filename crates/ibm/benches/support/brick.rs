//! A body with edges.
use interfaces::{Aabb, Point, Solid, Vector};

/// A box of these half-widths.
pub(crate) struct Brick(pub(crate) Vector);

impl Solid for Brick {
    fn signed_distance(&self, x: Point, _: f64) -> f64 {
        let q = x.coords.abs() - self.0;
        q.map(|q| q.max(0.0)).norm() + q.max().min(0.0)
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), self.0)
    }
}
