//! Two posed smooth shapes, seen from one frame.
use crate::SmoothConvex;
use interfaces::{Point, Pose, Vector};
use nalgebra::Matrix3;

/// A posed shape; the common frame has the world's axes and its origin at the first body's place, so that pairs far from
/// the world's origin lose no digits.
#[derive(Clone, Copy)]
pub(super) struct Body<'a> {
    shape: &'a dyn SmoothConvex,
    /// From the body's frame to the common one.
    turn: Matrix3<f64>,
    /// Origin of the body's frame, a point inside.
    pub(super) centre: Vector,
}

impl<'a> Body<'a> {
    pub(super) fn new(shape: &'a dyn SmoothConvex, at: &Pose, origin: Point) -> Self {
        let turn = at.orientation.to_rotation_matrix().into_inner();
        Self { shape, turn, centre: at.position - origin }
    }
    /// The point farthest along `n`.
    pub(super) fn support(&self, n: Vector) -> Vector {
        self.centre + self.turn * self.shape.support(self.turn.tr_mul(&n)).coords
    }
    /// The shape seen from `origin` in coordinates along `axes`.
    pub(super) fn view(&self, origin: Vector, axes: &[Vector; 3]) -> View<'a> {
        let to_body = |v: &Vector| self.turn.tr_mul(v);
        View {
            shape: self.shape,
            origin: Point::from(to_body(&(origin - self.centre))),
            axes: axes.each_ref().map(to_body),
        }
    }
    /// Where the line through `x` along `u` enters and leaves.
    pub(super) fn chord(&self, x: Vector, u: Vector) -> Option<[f64; 2]> {
        self.shape.chord(Point::from(self.turn.tr_mul(&(x - self.centre))), self.turn.tr_mul(&u))
    }
    /// Outward unit normal at the surface point `x`.
    pub(super) fn normal(&self, x: Vector) -> Option<Vector> {
        let (_, gradient) = self.shape.level(Point::from(self.turn.tr_mul(&(x - self.centre))));
        gradient.try_normalize(0.0).map(|n| self.turn * n)
    }
}

/// A shape seen from a point in coordinates (x, y, z) of oblique or stretched axes; everything is in the body's own frame,
/// so that nothing is turned per evaluation.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub(super) shape: &'a dyn SmoothConvex,
    pub(super) origin: Point,
    pub(super) axes: [Vector; 3],
}

impl View<'_> {
    /// Direction in the plane of the first two axes.
    pub(super) fn across(&self, cos: f64, sin: f64) -> Vector {
        self.axes[0] * cos + self.axes[1] * sin
    }
}

/// Two posed shapes.
#[derive(Clone, Copy)]
pub(super) struct Pair<'a> {
    pub(super) a: Body<'a>,
    pub(super) b: Body<'a>,
}

/// The piece of a line that both share, and where it leaves the first and enters the second.
#[derive(Clone, Copy)]
pub(super) struct Shared {
    pub(super) ends: [f64; 2],
    pub(super) leaves_a: f64,
    pub(super) enters_b: f64,
}

impl Shared {
    pub(super) fn middle(&self) -> f64 {
        0.5 * (self.ends[0] + self.ends[1])
    }
    pub(super) fn half(&self) -> f64 {
        0.5 * (self.ends[1] - self.ends[0])
    }
}

impl Pair<'_> {
    /// What both share of the line through `x` along `u`, if that has a length.
    pub(super) fn shared(&self, x: Vector, u: Vector) -> Option<Shared> {
        let (a, b) = (self.a.chord(x, u)?, self.b.chord(x, u)?);
        let ends = [a[0].max(b[0]), a[1].min(b[1])];
        (ends[1] > ends[0]).then_some(Shared { ends, leaves_a: a[1], enters_b: b[0] })
    }
}
