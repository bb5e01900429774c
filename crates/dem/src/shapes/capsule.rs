//! The capsule.
use super::{
    lines,
    spiral::{Profile, spiral},
};
use crate::{DemError, Form, Shape, SmoothConvex};
use interfaces::{Aabb, Inertia, Point, Solid, SurfaceElement, Vector};
use nalgebra::Matrix3;
use std::f64::consts::{PI, TAU};

/// A cylinder with a hemisphere on either end, its axis along z: all within a radius of a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    radius: f64,
    half: f64,
}

impl Capsule {
    /// A capsule of `radius` around a line of `length` between the centres of its hemispheres \[m\]; it is
    /// length + 2 radius long.
    ///
    /// # Errors
    /// [`DemError::Length`] unless both are positive and finite.
    pub fn new(radius: f64, length: f64) -> Result<Self, DemError> {
        let radius = lines::length("radius of a capsule", radius)?;
        Ok(Self { radius, half: 0.5 * lines::length("length of a capsule", length)? })
    }
    /// Its radius \[m\].
    pub fn radius(&self) -> f64 {
        self.radius
    }
    /// Distance of the centres of its hemispheres \[m\].
    pub fn length(&self) -> f64 {
        2.0 * self.half
    }
    /// `x` as seen from the nearest point of the line within.
    fn off_line(&self, x: Point) -> Vector {
        Vector::new(x.x, x.y, x.z - x.z.clamp(-self.half, self.half))
    }
}

impl Shape for Capsule {
    fn name(&self) -> &'static str {
        "capsule"
    }
    /// With the masses m of the cylinder and M of both hemispheres, ½mr² + ⅖Mr² about the axis and
    /// m(3r² + L²)/12 + M(⅖r² + ¼L² + ⅜Lr) across.
    fn inertia(&self, density: f64) -> Inertia {
        let (r, l) = (self.radius, self.length());
        let (tube, ball) = (PI * r * r * l, 4.0 / 3.0 * PI * r.powi(3));
        let (m, ends) = (density * tube, density * ball);
        let along = 0.5 * m * r * r + 0.4 * ends * r * r;
        let across = m * (3.0 * r * r + l * l) / 12.0 + ends * (0.4 * r * r + 0.25 * l * l + 0.375 * l * r);
        let tensor = Matrix3::from_diagonal(&Vector::new(across, across, along));
        Inertia { mass: m + ends, volume: tube + ball, tensor }
    }
    fn bounding_radius(&self) -> f64 {
        self.half + self.radius
    }
    fn form(&self) -> Form<'_> {
        Form::Capsule(self)
    }
}

impl Solid for Capsule {
    fn signed_distance(&self, x: Point, _band: f64) -> f64 {
        self.off_line(x).norm() - self.radius
    }
    fn aabb(&self) -> Aabb {
        let r = self.radius;
        Aabb::around(Point::origin(), Vector::new(r, r, r + self.half))
    }
    fn normal(&self, x: Point, _band: f64) -> Vector {
        self.off_line(x).try_normalize(0.0).unwrap_or_default()
    }
    fn curvature(&self, x: Point, _band: f64) -> f64 {
        let sides = if x.z.abs() > self.half { 2.0 } else { 1.0 };
        sides / self.off_line(x).norm().max(f64::MIN_POSITIVE)
    }
    /// Equal areas on a spiral; they sum to the area of the offset surface to round-off.
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        let (r, h) = (self.radius + offset, self.half);
        if r.is_nan() || r <= 0.0 {
            return None;
        }
        // Both the sphere and the cylinder gain 2πr of area per height.
        spiral(TAU * r * 2.0 * (h + r), spacing, |area| {
            let z = h + r - area / (TAU * r);
            let up = z - z.clamp(-h, h);
            let out = (r * r - up * up).max(0.0).sqrt();
            Profile { place: [out, z], normal: [out / r, up / r] }
        })
    }
}

impl SmoothConvex for Capsule {
    fn level(&self, x: Point) -> (f64, Vector) {
        let from = self.off_line(x);
        (from.norm_squared() - self.radius * self.radius, 2.0 * from)
    }
    fn chord(&self, o: Point, u: Vector) -> Option<[f64; 2]> {
        let (r2, h) = (self.radius * self.radius, self.half);
        // The cylinder without ends first, then the ball at the end that the line leaves through.
        let tube = lines::quadratic(u.x * u.x + u.y * u.y, o.x * u.x + o.y * u.y, o.x * o.x + o.y * o.y - r2);
        let mut ends = tube?;
        for (t, first) in ends.iter_mut().zip([true, false]) {
            let z = if t.is_finite() { o.z + *t * u.z } else { *t * u.z };
            if z.abs() > h {
                let from = o.coords - Vector::new(0.0, 0.0, h.copysign(z));
                let ball = lines::quadratic(u.norm_squared(), from.dot(&u), from.norm_squared() - r2)?;
                *t = ball[usize::from(!first)];
            }
        }
        Some(ends)
    }
    fn support(&self, direction: Vector) -> Point {
        let n = direction.try_normalize(0.0).unwrap_or(Vector::z());
        Point::new(0.0, 0.0, self.half.copysign(n.z)) + self.radius * n
    }
}
