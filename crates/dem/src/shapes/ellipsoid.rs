//! The ellipsoid.
use super::{ellipsoid_surface, lines};
use crate::{DemError, Form, Shape, SmoothConvex};
use interfaces::{Aabb, Inertia, Point, Solid, SurfaceElement, Vector};
use nalgebra::Matrix3;
use std::f64::consts::PI;

/// An ellipsoid, its axes along x, y and z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    semi_axes: Vector,
}

impl Ellipsoid {
    /// An ellipsoid with these semi-axes along x, y and z \[m\].
    ///
    /// # Errors
    /// [`DemError::Length`] unless all three are positive and finite.
    pub fn new(semi_axes: [f64; 3]) -> Result<Self, DemError> {
        for length in semi_axes {
            lines::length("semi-axis of an ellipsoid", length)?;
        }
        Ok(Self { semi_axes: semi_axes.into() })
    }
    /// Its semi-axes along x, y and z \[m\].
    pub fn semi_axes(&self) -> Vector {
        self.semi_axes
    }
    /// Sum and product of the principal curvatures at the surface point `c`: with g = (x/a², y/b², z/c²) they are
    /// (Σ1/a² − Σ(gₓ/a)²/|g|²)/|g| and 1/((abc)²|g|⁴).
    pub(crate) fn curvatures(&self, c: Point) -> [f64; 2] {
        let e = &self.semi_axes;
        // Everything times the smallest axis, so that squares of squares stay finite.
        let unit = e.min();
        let inverse = e.map(|a| unit / a);
        let g = c.coords.component_mul(&inverse).component_mul(&inverse) / unit;
        let length = g.norm();
        let along = g.component_mul(&inverse).norm_squared() / (length * length);
        let product = inverse.product() / (length * length);
        [(inverse.norm_squared() - along) / (length * unit), product * product / (unit * unit)]
    }
    /// The point of the surface nearest to `x` and the signed distance of `x` (Eberly, Distance from a Point to an Ellipse,
    /// an Ellipsoid, or a Hyperellipsoid, Geometric Tools, 2013): nearest point cᵢ = eᵢ²xᵢ/(t + eᵢ²) with t the largest root of
    /// Σ(eᵢxᵢ/(t + eᵢ²))² = 1. The unknown is σ = 1 + t/e₀², e₀ the smallest axis, positive and known to all its digits;
    /// Newton's method on 1/√Σ, nearly linear, within a bracket.
    pub(crate) fn nearest(&self, x: Point) -> (Point, f64) {
        let e = &self.semi_axes;
        let e0 = e.min();
        // eᵢ²/e₀² − 1 without cancellation.
        let rest = e.map(|a| (a - e0) / e0 * ((a + e0) / e0));
        let ratio = rest.add_scalar(1.0);
        let z = x.coords.component_div(e);
        let pole = Vector::from_fn(|i, _| if rest[i] == 0.0 { z[i] } else { 0.0 }).norm();
        let sum = |sigma: f64| {
            let q = Vector::from_fn(|i, _| ratio[i] * z[i] / (sigma + rest[i]));
            let slope = Vector::from_fn(|i, _| q[i] * q[i] / (sigma + rest[i]));
            (q.norm_squared(), slope.sum())
        };
        if pole == 0.0 {
            // No pole at σ = 0: perhaps no root either, the nearest points are then a pair off the plane of symmetry.
            let flat = Vector::from_fn(|i, _| if rest[i] == 0.0 { 0.0 } else { x[i] * ratio[i] / rest[i] });
            let room = 1.0 - flat.component_div(e).norm_squared();
            if room >= 0.0 {
                let axis = (0..3).find(|i| rest[*i] == 0.0).unwrap_or(0);
                let mut c = Point::from(flat);
                c[axis] = e0 * room.sqrt();
                return (c, -(c - x).norm());
            }
        }
        let (mut low, mut high) = (pole, ratio.component_mul(&z).norm());
        let mut sigma = if sum(1.0).0 > 1.0 { 1.0 } else { low.max(f64::MIN_POSITIVE) };
        for _ in 0..200 {
            let (q2, slope) = sum(sigma);
            if q2 > 1.0 {
                low = sigma
            } else {
                high = sigma
            }
            // 1/√Σ − 1 over its derivative Σ^(−3/2) Σq²/(σ + …).
            let mut next = sigma + q2 * (q2.sqrt() - 1.0) / slope;
            if !(next >= low && next <= high) {
                next = 0.5 * (low + high);
            }
            let step = (next - sigma).abs();
            sigma = next;
            if step <= 4.0 * f64::EPSILON * sigma {
                break;
            }
        }
        let c = Point::from(Vector::from_fn(|i, _| ratio[i] * x[i] / (sigma + rest[i])));
        // c − x = (1 − σ) x/(σ + …)
        let away = Vector::from_fn(|i, _| x[i] / (sigma + rest[i]));
        (c, (sigma - 1.0) * away.norm())
    }
}

impl Shape for Ellipsoid {
    fn name(&self) -> &'static str {
        "ellipsoid"
    }
    /// Volume 4πabc/3, moment of inertia m(b² + c²)/5 about x and so on.
    fn inertia(&self, density: f64) -> Inertia {
        let volume = 4.0 / 3.0 * PI * self.semi_axes.product();
        let mass = density * volume;
        let squares = self.semi_axes.component_mul(&self.semi_axes);
        let about = squares.map(|s| 0.2 * mass * (squares.sum() - s));
        Inertia { mass, volume, tensor: Matrix3::from_diagonal(&about) }
    }
    fn bounding_radius(&self) -> f64 {
        self.semi_axes.max()
    }
    fn form(&self) -> Form<'_> {
        Form::Ellipsoid(self)
    }
}

impl Solid for Ellipsoid {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        // The surface grown or shrunk to pass through x is at least so far: enough beyond the band.
        let bound = (x.coords.component_div(&self.semi_axes).norm() - 1.0) * self.semi_axes.min();
        if bound.abs() >= band { bound } else { self.nearest(x).1 }
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), self.semi_axes)
    }
    fn normal(&self, x: Point, _band: f64) -> Vector {
        self.level(self.nearest(x).0).1.normalize()
    }
    /// (κ₁ + κ₂ + 2dκ₁κ₂)/((1 + dκ₁)(1 + dκ₂)) with the curvatures at the nearest point.
    fn curvature(&self, x: Point, _band: f64) -> f64 {
        let (c, d) = self.nearest(x);
        let [sum, product] = self.curvatures(c);
        (sum + 2.0 * d * product) / (1.0 + d * (sum + d * product)).max(f64::MIN_POSITIVE)
    }
    /// Equal areas; they sum to the area of the offset surface to 1e-6 for axis ratios up to ten. `None` within a radius
    /// of curvature, where the level surfaces have edges.
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        ellipsoid_surface::elements(self, spacing, offset)
    }
}

impl SmoothConvex for Ellipsoid {
    fn level(&self, x: Point) -> (f64, Vector) {
        let z = x.coords.component_div(&self.semi_axes);
        (z.norm_squared() - 1.0, 2.0 * z.component_div(&self.semi_axes))
    }
    fn chord(&self, o: Point, u: Vector) -> Option<[f64; 2]> {
        let (o, u) = (o.coords.component_div(&self.semi_axes), u.component_div(&self.semi_axes));
        lines::quadratic(u.norm_squared(), o.dot(&u), o.norm_squared() - 1.0)
    }
    fn support(&self, direction: Vector) -> Point {
        let scaled = self.semi_axes.component_mul(&direction);
        let unit = scaled.try_normalize(0.0).unwrap_or(Vector::z());
        Point::from(self.semi_axes.component_mul(&unit))
    }
}
