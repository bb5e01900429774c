//! Bodies as a frame near the contact sees them.
use interfaces::{Aabb, Point, Pose, Solid, Vector};
use nalgebra::Matrix3;

/// A body whose points are reached from a frame: place in the body's frame = turn·y + shift.
#[derive(Clone, Copy)]
pub(crate) struct Seen<'a> {
    solid: &'a dyn Solid,
    pub(crate) turn: Matrix3<f64>,
    pub(crate) shift: Vector,
}

/// Most points of one call.
const BLOCK: usize = 16;

impl<'a> Seen<'a> {
    /// From axes along the world's, at `origin` from the place that `pose` is given from.
    pub(crate) fn new(solid: &'a dyn Solid, pose: &Pose, origin: Vector) -> Self {
        let turn = pose.orientation.to_rotation_matrix().matrix().transpose();
        Self { solid, turn, shift: turn * (origin - pose.position.coords) }
    }
    /// From a frame in this one: its axes are the columns of `axes`.
    pub(crate) fn within(&self, axes: &Matrix3<f64>, origin: Vector) -> Self {
        Self { solid: self.solid, turn: self.turn * axes, shift: self.turn * origin + self.shift }
    }
    #[inline]
    fn place(&self, y: Vector) -> Point {
        Point::from(self.turn * y + self.shift)
    }
    #[inline]
    pub(crate) fn distance(&self, y: Vector, band: f64) -> f64 {
        self.solid.signed_distance(self.place(y), band)
    }
    /// Distances of up to [`BLOCK`] points.
    #[inline]
    pub(crate) fn distances<const N: usize>(&self, points: &[Vector; N], band: f64) -> [f64; N] {
        const { assert!(N <= BLOCK) };
        let mut places = [Point::origin(); N];
        for (place, y) in places.iter_mut().zip(points) {
            *place = self.place(*y);
        }
        let mut out = [0.0; N];
        self.solid.signed_distances(&places, band, &mut out);
        out
    }
}

/// What two boxes share; `None` if they are apart.
pub(crate) fn shared(a: &Aabb, b: &Aabb) -> Option<Aabb> {
    let both = Aabb { min: a.min.sup(&b.min), max: a.max.inf(&b.max) };
    both.extent().iter().all(|e| *e > 0.0).then_some(both)
}
