//! What a shape owes its neighbours.
use crate::{Aabb, Point, Vector};

/// A piece of a body's surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceElement {
    /// Its centre, in the body's frame \[m\].
    pub point: Point,
    /// Outward unit normal, in the body's frame.
    pub normal: Vector,
    /// Its area \[m²\]; in a plane scene its length \[m\].
    pub area: f64,
}

/// A closed surface made of triangles, in the body's frame.
#[derive(Clone, Copy, Debug)]
pub struct Polyhedron<'a> {
    /// Places \[m\].
    pub vertices: &'a [Point],
    /// Numbers of three vertices each, counter-clockwise seen from outside.
    pub faces: &'a [[u32; 3]],
}

/// A closed shape in its own frame, centre of mass at the origin; negative distances are inside.
pub trait Solid: Send + Sync {
    /// Signed distance to the surface \[m\]. Exact where |d| < `band`; beyond it only the sign and
    /// |d| ≥ `band` are promised.
    fn signed_distance(&self, x: Point, band: f64) -> f64;

    /// Signed distances of many points: one call for a block of them. Points that follow one another
    /// are best near one another. Default: one by one.
    fn signed_distances(&self, points: &[Point], band: f64, out: &mut [f64]) {
        for (d, x) in out.iter_mut().zip(points) {
            *d = self.signed_distance(*x, band);
        }
    }

    /// A box that holds the shape, in its own frame. A plane shape has no extent along z.
    fn aabb(&self) -> Aabb;

    /// Outward unit normal of the level surface through `x`: the gradient of the distance.
    /// Default: central differences over `band`/1000; zero where the gradient vanishes.
    fn normal(&self, x: Point, band: f64) -> Vector {
        let h = 1e-3 * band;
        let flat = self.aabb().extent().z == 0.0;
        let mut g = Vector::zeros();
        for a in 0..if flat { 2 } else { 3 } {
            let mut e = Vector::zeros();
            e[a] = h;
            let near = 4.0 * band;
            g[a] = self.signed_distance(x + e, near) - self.signed_distance(x - e, near);
        }
        g.try_normalize(1e-300).unwrap_or_default()
    }

    /// Sum of the principal curvatures of the level surface through `x` \[1/m\]: the divergence of
    /// the normal, positive where the body bulges. Default: central differences over `band`/10.
    fn curvature(&self, x: Point, band: f64) -> f64 {
        let h = 0.1 * band;
        let flat = self.aabb().extent().z == 0.0;
        let mut sum = 0.0;
        for a in 0..if flat { 2 } else { 3 } {
            let mut e = Vector::zeros();
            e[a] = h;
            sum += (self.normal(x + e, band)[a] - self.normal(x - e, band)[a]) / (2.0 * h);
        }
        sum
    }

    /// Elements of the level surface at signed distance `offset`, about `spacing` apart, whose
    /// areas sum to that surface's area. `None` from shapes that cannot tell (the default).
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        let _ = (spacing, offset);
        None
    }

    /// The surface itself, of shapes that are made of triangles: how much of a cell in space they fill is then exact. Others
    /// have `None` (the default).
    fn polyhedron(&self) -> Option<Polyhedron<'_>> {
        None
    }
}

impl<T: Solid + ?Sized> Solid for std::sync::Arc<T> {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        (**self).signed_distance(x, band)
    }
    fn signed_distances(&self, points: &[Point], band: f64, out: &mut [f64]) {
        (**self).signed_distances(points, band, out);
    }
    fn aabb(&self) -> Aabb {
        (**self).aabb()
    }
    fn normal(&self, x: Point, band: f64) -> Vector {
        (**self).normal(x, band)
    }
    fn curvature(&self, x: Point, band: f64) -> f64 {
        (**self).curvature(x, band)
    }
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        (**self).surface(spacing, offset)
    }
    fn polyhedron(&self) -> Option<Polyhedron<'_>> {
        (**self).polyhedron()
    }
}
