//! What a smooth convex shape tells of itself.
use interfaces::{Point, Vector};

/// A convex shape that answers for straight lines and planes; all in its own frame.
///
/// Overlaps of such shapes are integrals over columns, one patch each, to a relative error of 1e-5 and better: a type of
/// your own that can do this offers itself in [`Form::Smooth`](crate::Form::Smooth). Edges are allowed, but slow the
/// integrals down.
pub trait SmoothConvex: Send + Sync {
    /// A convex function at `x`, negative inside, zero on the surface and positive outside, and its gradient, which must
    /// not vanish on the surface or outside of it. The squared distance to a line within less r² is one.
    fn level(&self, x: Point) -> (f64, Vector);
    /// Where the line `origin` + t `direction` enters and leaves the shape; `None` where it misses it.
    fn chord(&self, origin: Point, direction: Vector) -> Option<[f64; 2]>;
    /// A point of the shape that is farthest along `direction`.
    fn support(&self, direction: Vector) -> Point;
}
