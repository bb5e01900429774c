//! The disc.
use crate::{DemError, Form, Shape};
use interfaces::{Aabb, Inertia, Point, Solid, SurfaceElement, Vector};
use nalgebra::Matrix3;
use std::f64::consts::{PI, TAU};

/// A disc in the plane z = 0; all its quantities are per metre of depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disc {
    radius: f64,
}

impl Disc {
    /// A disc of `radius` \[m\].
    ///
    /// # Errors
    /// [`DemError::Length`] unless the radius is positive and finite.
    pub fn new(radius: f64) -> Result<Self, DemError> {
        if radius.is_finite() && radius > 0.0 {
            Ok(Self { radius })
        } else {
            Err(DemError::Length { what: "radius of a disc", value: radius })
        }
    }
    /// Its radius \[m\].
    pub fn radius(&self) -> f64 {
        self.radius
    }
}

impl Shape for Disc {
    fn name(&self) -> &'static str {
        "disc"
    }
    /// Mass ρπr² \[kg/m\], area πr² \[m²\], moment of inertia ½mr² about z.
    fn inertia(&self, density: f64) -> Inertia {
        let r2 = self.radius * self.radius;
        let (volume, mass) = (PI * r2, density * PI * r2);
        let about_z = 0.5 * mass * r2;
        // About the axes in the plane a disc of a plane scene never turns; half the polar moment
        // is that of a thin plate.
        let tensor = Matrix3::from_diagonal(&Vector::new(0.5 * about_z, 0.5 * about_z, about_z));
        Inertia { mass, volume, tensor }
    }
    fn bounding_radius(&self) -> f64 {
        self.radius
    }
    fn form(&self) -> Form<'_> {
        Form::Disc(self)
    }
}

impl Solid for Disc {
    fn signed_distance(&self, x: Point, _band: f64) -> f64 {
        (x.x * x.x + x.y * x.y).sqrt() - self.radius
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(self.radius, self.radius, 0.0))
    }
    fn normal(&self, x: Point, _band: f64) -> Vector {
        Vector::new(x.x, x.y, 0.0).try_normalize(0.0).unwrap_or_default()
    }
    fn curvature(&self, x: Point, _band: f64) -> f64 {
        1.0 / (x.x * x.x + x.y * x.y).sqrt().max(f64::MIN_POSITIVE)
    }
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        let r = self.radius + offset;
        if !(r > 0.0 && spacing > 0.0) {
            return None;
        }
        // A multiple of four, so that the set is symmetric about both axes.
        let n = 4.0 * (TAU * r / spacing / 4.0).round().max(1.0);
        let element = |i: usize| {
            let (sin, cos) = (TAU * i as f64 / n).sin_cos();
            let normal = Vector::new(cos, sin, 0.0);
            SurfaceElement { point: Point::from(r * normal), normal, area: TAU * r / n }
        };
        Some((0..n as usize).map(element).collect())
    }
}
