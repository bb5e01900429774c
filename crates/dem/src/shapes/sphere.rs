//! The sphere.
use super::lines;
use crate::overlap::{Overlap, closed};
use crate::{DemError, Form, Shape, SmoothConvex};
use interfaces::{Aabb, Inertia, Point, Solid, SurfaceElement, Vector};
use nalgebra::Matrix3;
use std::f64::consts::PI;

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    radius: f64,
}

impl Sphere {
    /// A sphere of `radius` \[m\].
    ///
    /// # Errors
    /// [`DemError::Length`] unless the radius is positive and finite.
    pub fn new(radius: f64) -> Result<Self, DemError> {
        if radius.is_finite() && radius > 0.0 {
            Ok(Self { radius })
        } else {
            Err(DemError::Length { what: "radius of a sphere", value: radius })
        }
    }
    /// Its radius \[m\].
    #[inline]
    pub fn radius(&self) -> f64 {
        self.radius
    }
    /// What this one, its centre at `at`, shares with another: what [`OverlapSolver`](crate::OverlapSolver) answers, for those who know
    /// that both are spheres and that their places are finite.
    #[inline]
    pub fn overlap(&self, at: Point, other: &Self, at_other: Point) -> Option<Overlap> {
        closed::spheres(self.radius, at, other.radius, at_other)
    }
}

impl Shape for Sphere {
    fn name(&self) -> &'static str {
        "sphere"
    }
    /// Mass ρ 4πr³/3, volume, moment of inertia ⅖mr².
    fn inertia(&self, density: f64) -> Inertia {
        let r2 = self.radius * self.radius;
        let volume = 4.0 / 3.0 * PI * r2 * self.radius;
        let mass = density * volume;
        Inertia { mass, volume, tensor: Matrix3::from_diagonal_element(0.4 * mass * r2) }
    }
    fn bounding_radius(&self) -> f64 {
        self.radius
    }
    #[inline]
    fn form(&self) -> Form<'_> {
        Form::Sphere(self)
    }
}

impl Solid for Sphere {
    fn signed_distance(&self, x: Point, _band: f64) -> f64 {
        x.coords.norm() - self.radius
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::repeat(self.radius))
    }
    fn normal(&self, x: Point, _band: f64) -> Vector {
        x.coords.try_normalize(0.0).unwrap_or_default()
    }
    fn curvature(&self, x: Point, _band: f64) -> f64 {
        2.0 / x.coords.norm().max(f64::MIN_POSITIVE)
    }
    /// Equal areas on a Fibonacci spiral.
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        let r = self.radius + offset;
        if !(r > 0.0 && spacing > 0.0) {
            return None;
        }
        let whole = 4.0 * PI * r * r;
        let n = (whole / (spacing * spacing)).round().max(6.0);
        let golden = PI * (3.0 - 5.0_f64.sqrt());
        let element = |i: usize| {
            let z = 1.0 - (2.0 * i as f64 + 1.0) / n;
            let (sin, cos) = (golden * i as f64).sin_cos();
            let rho = (1.0 - z * z).sqrt();
            let normal = Vector::new(rho * cos, rho * sin, z);
            SurfaceElement { point: Point::from(r * normal), normal, area: whole / n }
        };
        Some((0..n as usize).map(element).collect())
    }
}

impl SmoothConvex for Sphere {
    fn level(&self, x: Point) -> (f64, Vector) {
        (x.coords.norm_squared() - self.radius * self.radius, 2.0 * x.coords)
    }
    fn chord(&self, o: Point, u: Vector) -> Option<[f64; 2]> {
        let o = o.coords;
        lines::quadratic(u.norm_squared(), o.dot(&u), o.norm_squared() - self.radius * self.radius)
    }
    fn support(&self, direction: Vector) -> Point {
        Point::from(self.radius * direction.try_normalize(0.0).unwrap_or(Vector::z()))
    }
}
