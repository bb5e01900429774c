//! The polygon.
mod cutting;
#[cfg(test)]
mod tests;

use crate::{DemError, Form, Shape};
use interfaces::{Aabb, Inertia, Point, Solid, Vector};
use nalgebra::{Matrix3, Vector2};
use std::f64::consts::TAU;

/// A part of the plane z = 0 within one closed line of straight edges, convex or not, its centre of mass at the origin; all its quantities are per metre of depth.
#[derive(Clone, Debug)]
pub struct Polygon {
    /// Counter-clockwise.
    corners: Vec<Vector2<f64>>,
    /// What it is cut into for its overlaps.
    pieces: Vec<Piece>,
    area: f64,
    /// ∫ x², ∫ y², ∫ xy dA.
    second: [f64; 3],
    origin: Point,
}

/// A convex piece of a polygon.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    /// Counter-clockwise.
    pub(crate) corners: Vec<Vector2<f64>>,
    /// Of the edge from each corner to the next: the piece beyond it; `None` where it is an edge of the polygon.
    pub(crate) beyond: Vec<Option<u32>>,
    /// Middle and radius of a circle around it.
    pub(crate) middle: Vector2<f64>,
    pub(crate) radius: f64,
}

/// Area, and first and second moments, of the triangle between the origin and an edge.
fn moments(p: &Vector2<f64>, q: &Vector2<f64>) -> (f64, Vector2<f64>, [f64; 3]) {
    let twice = p.perp(q);
    let square = |a: f64, b: f64| twice * (a * a + a * b + b * b) / 12.0;
    let mixed = twice * (2.0 * (p.x * p.y + q.x * q.y) + p.x * q.y + q.x * p.y) / 24.0;
    (0.5 * twice, (p + q) * (twice / 6.0), [square(p.x, q.x), square(p.y, q.y), mixed])
}

impl Polygon {
    /// The polygon with these `corners` \[m\], one after the other, in either direction. It is moved so that its centre of mass is at the origin.
    ///
    /// ```
    /// use dem::{DemError, Polygon};
    ///
    /// let angle = Polygon::new(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]])?;
    /// assert!((angle.area() - 3.0).abs() < 1e-15);
    /// assert!((angle.origin().x - 5.0 / 6.0).abs() < 1e-15);
    /// # Ok::<(), DemError>(())
    /// ```
    ///
    /// # Errors
    /// [`DemError::Polygon`] for fewer than three corners, one that is not finite, edges that cross or touch one another, and no area.
    pub fn new(corners: &[[f64; 2]]) -> Result<Self, DemError> {
        let wrong = |corner: usize, what: &'static str| DemError::Polygon { corner, what };
        if corners.len() < 3 {
            return Err(wrong(corners.len(), "is missing: give at least three corners"));
        }
        if let Some(corner) = corners.iter().position(|c| !c.iter().all(|x| x.is_finite())) {
            return Err(wrong(corner, "is not finite"));
        }
        if let Some(corner) = cutting::crossing(corners) {
            return Err(wrong(
                corner,
                "begins an edge that crosses or touches another one; give one closed line",
            ));
        }
        // About the first corner, so that a body far from the origin loses no digits.
        let first = Vector2::from(corners[0]);
        let mut own: Vec<_> = corners.iter().map(|c| Vector2::from(*c) - first).collect();
        let sums = |own: &[Vector2<f64>]| {
            let next = own.iter().cycle().skip(1);
            own.iter().zip(next).fold((0.0, Vector2::zeros(), [0.0; 3]), |(a, f, s), (p, q)| {
                let (da, df, ds) = moments(p, q);
                (a + da, f + df, std::array::from_fn(|i| s[i] + ds[i]))
            })
        };
        let (area, moment, _) = sums(&own);
        let size = own.iter().map(|c| c.amax()).fold(0.0, f64::max);
        if area.abs() <= 1e-12 * size * size || !area.is_finite() {
            return Err(wrong(0, "and the others enclose no area"));
        }
        let centre = moment / area;
        own.iter_mut().for_each(|c| *c -= centre);
        if area < 0.0 {
            own.reverse();
        }
        let (area, _, second) = sums(&own);
        let pieces = cutting::convex(&own);
        let origin = first + centre;
        Ok(Self { corners: own, pieces, area, second, origin: Point::new(origin.x, origin.y, 0.0) })
    }

    /// A rectangle with these `edges` \[m\].
    ///
    /// # Errors
    /// [`DemError::Length`] unless both are positive and finite.
    pub fn rectangle(edges: [f64; 2]) -> Result<Self, DemError> {
        let [x, y] = lengths("edge of a rectangle", edges)?.map(|e| 0.5 * e);
        Self::new(&[[-x, -y], [x, -y], [x, y], [-x, y]])
    }

    /// An ellipse with these `semi_axes` \[m\], of the same area, by so many corners, the eccentric angle between them being the same.
    ///
    /// # Errors
    /// [`DemError::Length`] unless both are positive and finite; [`DemError::Polygon`] for fewer than three corners.
    pub fn ellipse(semi_axes: [f64; 2], corners: usize) -> Result<Self, DemError> {
        let [a, b] = lengths("semi-axis of an ellipse", semi_axes)?;
        let angle = TAU / corners.max(1) as f64;
        // n/2 ab sin(2π/n) of the inscribed one is πab.
        let wider = (angle / angle.sin()).sqrt();
        let corner = |i: usize| {
            let (sin, cos) = (angle * i as f64).sin_cos();
            [wider * a * cos, wider * b * sin]
        };
        Self::new(&(0..corners).map(corner).collect::<Vec<_>>())
    }

    /// The corners from the centre of mass, counter-clockwise \[m\].
    pub fn corners(&self) -> &[Vector2<f64>] {
        &self.corners
    }
    /// Area \[m²\].
    pub fn area(&self) -> f64 {
        self.area
    }
    /// Where the centre of mass is in the coordinates that the corners were given in \[m\].
    pub fn origin(&self) -> Point {
        self.origin
    }
    pub(crate) fn pieces(&self) -> &[Piece] {
        &self.pieces
    }
    pub(crate) fn edges(&self) -> impl Iterator<Item = [Vector2<f64>; 2]> {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(p, q)| [*p, *q])
    }
    /// The longest edge \[m\].
    pub(crate) fn longest_edge(&self) -> f64 {
        self.edges().map(|[p, q]| (q - p).norm()).fold(0.0, f64::max)
    }

    /// The way to `x` from the nearest place of the border, and whether `x` is outside.
    fn way(&self, x: Vector2<f64>) -> (Vector2<f64>, bool) {
        let (mut least, mut way, mut inside) = (f64::INFINITY, Vector2::zeros(), false);
        for [p, q] in self.edges() {
            let from = x - nearest_on_edge([p, q], x);
            let square = from.norm_squared();
            if square < least {
                (least, way) = (square, from);
            }
            // Does a ray along x cross the edge?
            if (p.y > x.y) != (q.y > x.y) && x.x < p.x + (x.y - p.y) / (q.y - p.y) * (q.x - p.x) {
                inside = !inside;
            }
        }
        (way, !inside)
    }
}

/// The place of an edge that is nearest to `x`.
pub(crate) fn nearest_on_edge([p, q]: [Vector2<f64>; 2], x: Vector2<f64>) -> Vector2<f64> {
    let along = q - p;
    p + along * ((x - p).dot(&along) / along.norm_squared()).clamp(0.0, 1.0)
}

fn lengths(what: &'static str, of: [f64; 2]) -> Result<[f64; 2], DemError> {
    match of.into_iter().find(|value| !(value.is_finite() && *value > 0.0)) {
        Some(value) => Err(DemError::Length { what, value }),
        None => Ok(of),
    }
}

impl Shape for Polygon {
    fn name(&self) -> &'static str {
        "polygon"
    }
    /// Mass ρA \[kg/m\], area A \[m²\], moments of inertia of a thin plate.
    fn inertia(&self, density: f64) -> Inertia {
        let [xx, yy, xy] = self.second.map(|s| density * s);
        let tensor = Matrix3::new(yy, -xy, 0.0, -xy, xx, 0.0, 0.0, 0.0, xx + yy);
        Inertia { mass: density * self.area, volume: self.area, tensor }
    }
    fn bounding_radius(&self) -> f64 {
        self.corners.iter().map(Vector2::norm).fold(0.0, f64::max)
    }
    fn form(&self) -> Form<'_> {
        Form::Polygon(self)
    }
}

impl Solid for Polygon {
    fn signed_distance(&self, x: Point, _band: f64) -> f64 {
        let (way, outside) = self.way(x.coords.xy());
        if outside { way.norm() } else { -way.norm() }
    }
    fn aabb(&self) -> Aabb {
        let low = self.corners.iter().fold(self.corners[0], |low, c| low.inf(c));
        let high = self.corners.iter().fold(self.corners[0], |high, c| high.sup(c));
        Aabb { min: Point::new(low.x, low.y, 0.0), max: Point::new(high.x, high.y, 0.0) }
    }
    fn normal(&self, x: Point, _band: f64) -> Vector {
        let x = x.coords.xy();
        let (way, outside) = self.way(x);
        let mut out = if outside { way } else { -way };
        // On the surface itself, that of the nearest edge; corners run counter-clockwise.
        if way.norm() <= 1e-9 * self.bounding_radius() {
            let distance = |[p, q]: &[Vector2<f64>; 2]| (x - nearest_on_edge([*p, *q], x)).norm_squared();
            let nearest = self.edges().min_by(|a, b| distance(a).total_cmp(&distance(b)));
            out = nearest.map_or(out, |[p, q]| Vector2::new(q.y - p.y, p.x - q.x));
        }
        Vector::new(out.x, out.y, 0.0).try_normalize(0.0).unwrap_or_default()
    }
}
