//! The cylinder.
use super::{
    lines,
    spiral::{Profile, spiral},
};
use crate::{DemError, Form, Shape, SmoothConvex};
use interfaces::{Aabb, Inertia, Point, Solid, SurfaceElement, Vector};
use nalgebra::Matrix3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A cylinder with flat ends, its axis along z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylinder {
    radius: f64,
    half: f64,
}

impl Cylinder {
    /// A cylinder of `radius` and `length` \[m\].
    ///
    /// # Errors
    /// [`DemError::Length`] unless both are positive and finite.
    pub fn new(radius: f64, length: f64) -> Result<Self, DemError> {
        let radius = lines::length("radius of a cylinder", radius)?;
        Ok(Self { radius, half: 0.5 * lines::length("length of a cylinder", length)? })
    }
    /// Its radius \[m\].
    pub fn radius(&self) -> f64 {
        self.radius
    }
    /// Its length \[m\].
    pub fn length(&self) -> f64 {
        2.0 * self.half
    }
    /// Distance of `x` from the axis, and how far it is beyond the side and beyond the nearer end, negative within.
    fn beyond(&self, x: Point) -> (f64, [f64; 2]) {
        let out = x.x.hypot(x.y);
        (out, [out - self.radius, x.z.abs() - self.half])
    }
}

impl Shape for Cylinder {
    fn name(&self) -> &'static str {
        "cylinder"
    }
    /// ½mr² about the axis, m(3r² + L²)/12 across.
    fn inertia(&self, density: f64) -> Inertia {
        let (r, l) = (self.radius, self.length());
        let volume = PI * r * r * l;
        let mass = density * volume;
        let across = mass * (3.0 * r * r + l * l) / 12.0;
        let tensor = Matrix3::from_diagonal(&Vector::new(across, across, 0.5 * mass * r * r));
        Inertia { mass, volume, tensor }
    }
    fn bounding_radius(&self) -> f64 {
        self.radius.hypot(self.half)
    }
    fn form(&self) -> Form<'_> {
        Form::Cylinder(self)
    }
}

impl Solid for Cylinder {
    fn signed_distance(&self, x: Point, _band: f64) -> f64 {
        let (_, [side, end]) = self.beyond(x);
        if side > 0.0 && end > 0.0 { side.hypot(end) } else { side.max(end) }
    }
    fn aabb(&self) -> Aabb {
        Aabb::around(Point::origin(), Vector::new(self.radius, self.radius, self.half))
    }
    /// Off the axis and the middle; on edges of the distance's own, one of the two directions.
    fn normal(&self, x: Point, _band: f64) -> Vector {
        let (out, [side, end]) = self.beyond(x);
        let outward = if out > 0.0 { Vector::new(x.x / out, x.y / out, 0.0) } else { Vector::zeros() };
        let upward = Vector::new(0.0, 0.0, 1f64.copysign(x.z));
        if side > 0.0 && end > 0.0 {
            (side * outward + end * upward).normalize()
        } else if side > end {
            outward
        } else {
            upward
        }
    }
    /// Beside the ends 1/ϱ, above them 0, outside of both 1/d + (1 − r/ϱ)/d: the level surface is then a torus.
    fn curvature(&self, x: Point, _band: f64) -> f64 {
        let (out, [side, end]) = self.beyond(x);
        if side > 0.0 && end > 0.0 {
            let d = side.hypot(end);
            1.0 / d + side / (d * out)
        } else if side > end {
            1.0 / out.max(f64::MIN_POSITIVE)
        } else {
            0.0
        }
    }
    /// Equal areas on a spiral; they sum to the area of the offset surface to round-off. Outside, that surface has the
    /// rims rounded.
    fn surface(&self, spacing: f64, offset: f64) -> Option<Vec<SurfaceElement>> {
        let (inside, round) = (offset.min(0.0), offset.max(0.0));
        let (r, h) = (self.radius + inside, self.half + inside);
        if r.is_nan() || r <= 0.0 || h <= 0.0 {
            return None;
        }
        let (cap, side) = (PI * r * r, TAU * (r + round) * 2.0 * h);
        // Of the quarter torus down to the angle α from the axis: 2πd(rα + d(1 − cos α)).
        let rim = |alpha: f64| TAU * round * (r * alpha + round * (1.0 - alpha.cos()));
        let half = cap + rim(FRAC_PI_2) + 0.5 * side;
        spiral(2.0 * half, spacing, |area| {
            let (from_top, up) = if area < half { (area, 1.0) } else { (2.0 * half - area, -1.0) };
            if from_top < cap {
                Profile { place: [(from_top / PI).sqrt(), up * (h + round)], normal: [0.0, up] }
            } else if from_top < half - 0.5 * side {
                // The area grows with α, faster and faster: Newton's method from the end converges from above.
                let mut alpha = FRAC_PI_2;
                for _ in 0..8 {
                    let slope = TAU * round * (r + round * alpha.sin());
                    alpha = (alpha - (rim(alpha) - (from_top - cap)) / slope).clamp(0.0, FRAC_PI_2);
                }
                let (sin, cos) = alpha.sin_cos();
                Profile { place: [r + round * sin, up * (h + round * cos)], normal: [sin, up * cos] }
            } else {
                Profile {
                    place: [r + round, up * (half - from_top) / (TAU * (r + round))],
                    normal: [1.0, 0.0],
                }
            }
        })
    }
}

impl SmoothConvex for Cylinder {
    fn level(&self, x: Point) -> (f64, Vector) {
        let side = (x.x * x.x + x.y * x.y) / (self.radius * self.radius) - 1.0;
        let end = x.z * x.z / (self.half * self.half) - 1.0;
        if side > end {
            (side, Vector::new(x.x, x.y, 0.0) * (2.0 / (self.radius * self.radius)))
        } else {
            (end, Vector::new(0.0, 0.0, 2.0 * x.z / (self.half * self.half)))
        }
    }
    fn chord(&self, o: Point, u: Vector) -> Option<[f64; 2]> {
        let [side_in, side_out] = lines::quadratic(
            u.x * u.x + u.y * u.y,
            o.x * u.x + o.y * u.y,
            o.x * o.x + o.y * o.y - self.radius * self.radius,
        )?;
        let [end_in, end_out] = lines::slab(self.half, o.z, u.z)?;
        let (first, last) = (side_in.max(end_in), side_out.min(end_out));
        (first <= last).then_some([first, last])
    }
    fn support(&self, direction: Vector) -> Point {
        let out = direction.x.hypot(direction.y);
        let to_rim = if out > 0.0 { self.radius / out } else { 0.0 };
        Point::new(to_rim * direction.x, to_rim * direction.y, self.half.copysign(direction.z))
    }
}
