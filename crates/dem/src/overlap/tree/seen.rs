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
    /// Another body, from where this one is seen.
    pub(crate) fn of<'b>(&self, solid: &'b dyn Solid) -> Seen<'b> {
        Seen { solid, turn: self.turn, shift: self.shift }
    }
    /// All of it, to be cut.
    pub(crate) fn whole<const N: usize>(&self) -> Behind<'a, N> {
        Behind { solid: self.solid, planes: [(Vector::zeros(), 0.0); N], n: 0 }
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

/// What of a body is behind up to `N` planes, n·x ≤ h in its own frame.
pub(crate) struct Behind<'a, const N: usize> {
    solid: &'a dyn Solid,
    planes: [(Vector, f64); N],
    n: usize,
}

impl<const N: usize> Behind<'_, N> {
    /// Leaves what is behind a plane through `foot`, as a frame sees both that sees the body as `seen`.
    pub(crate) fn cut(&mut self, seen: &Seen<'_>, normal: Vector, foot: Vector) {
        let normal = seen.turn * normal;
        self.planes[self.n] = (normal, normal.dot(&seen.place(foot).coords));
        self.n += 1;
    }
    fn above(&self, x: Point) -> f64 {
        let height = |(normal, height): &(Vector, f64)| normal.dot(&x.coords) - height;
        self.planes[..self.n].iter().map(height).fold(f64::NEG_INFINITY, f64::max)
    }
}

impl<const N: usize> Solid for Behind<'_, N> {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        self.solid.signed_distance(x, band).max(self.above(x))
    }
    fn signed_distances(&self, points: &[Point], band: f64, out: &mut [f64]) {
        self.solid.signed_distances(points, band, out);
        for (d, x) in out.iter_mut().zip(points) {
            *d = d.max(self.above(*x));
        }
    }
    fn aabb(&self) -> Aabb {
        self.solid.aabb()
    }
}

/// What two boxes share; `None` if they are apart.
pub(crate) fn shared(a: &Aabb, b: &Aabb) -> Option<Aabb> {
    let both = Aabb { min: a.min.sup(&b.min), max: a.max.inf(&b.max) };
    both.extent().iter().all(|e| *e > 0.0).then_some(both)
}
