//! Polygonal surfaces of shapes.
use super::marching_tetrahedra::marching_tetrahedra;
use crate::{ConvexPolyhedron, Form, Part, Polygon, Shape};
use interfaces::{Point, Polyhedron, Vector};
use nalgebra::Vector2;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::{Arc, LazyLock};

/// Edges of a circle: chords depart from it by 1 − cos(π/32) = 0.5 % of its radius.
pub(super) const EDGES: usize = 32;

/// A polygonal surface, counter-clockwise seen from outside; closed, if its shape is not plane.
#[derive(Clone, Debug, Default)]
pub(super) struct PolygonSurface {
    pub(super) points: Vec<Point>,
    /// Numbers of points of all polygons, one polygon after the other.
    pub(super) corners: Vec<usize>,
    /// End of every polygon in `corners`.
    pub(super) ends: Vec<usize>,
    /// Lines drawn on it.
    pub(super) lines: Vec<[usize; 2]>,
}

/// PolygonSurface of a shape, in units that make copies of a shape equal that differ in size.
#[derive(Clone, Debug)]
pub(super) struct ScaledSurface {
    pub(super) surface: Arc<PolygonSurface>,
    /// Factors along x, y and z from the surface to the body's frame \[m\].
    pub(super) scale: Vector,
}

static DISC: LazyLock<Arc<PolygonSurface>> = LazyLock::new(|| Arc::new(disc()));
static SPHERE: LazyLock<Arc<PolygonSurface>> =
    LazyLock::new(|| Arc::new(lathe(&arc(1.0, [-EIGHTHS, EIGHTHS]))));
static CYLINDER: LazyLock<Arc<PolygonSurface>> =
    LazyLock::new(|| Arc::new(lathe(&[[1.0, -1.0], [1.0, 1.0]])));

/// Edges of a quarter of a circle.
const EIGHTHS: i32 = EDGES as i32 / 4;

impl ScaledSurface {
    /// PolygonSurface of `shape`: faces of flat-faced shapes; circles by 32 edges, spheres, ellipsoids,
    /// capsules and cylinders by meridians and parallels along them; discs with a line from the
    /// centre to the rim; others by marching tetrahedra over 32 cells along the longest edge of
    /// their box. Empty for shapes without end, and for plane shapes of unknown form.
    pub(super) fn of(shape: &dyn Shape) -> Self {
        match shape.form() {
            Form::Disc(disc) => Self::scaled(&DISC, [disc.radius(), disc.radius(), 1.0]),
            Form::Sphere(sphere) => Self::scaled(&SPHERE, [sphere.radius(); 3]),
            Form::Ellipsoid(ellipsoid) => Self::scaled(&SPHERE, ellipsoid.semi_axes().into()),
            Form::Cylinder(c) => Self::scaled(&CYLINDER, [c.radius(), c.radius(), 0.5 * c.length()]),
            Form::Capsule(c) => {
                let half = 0.5 * c.length();
                let ends = [arc(c.radius(), [-EIGHTHS, 0]), arc(c.radius(), [0, EIGHTHS])];
                let [lower, upper] = [(&ends[0], -half), (&ends[1], half)]
                    .map(|(end, height)| end.iter().map(move |[r, z]| [*r, z + height]));
                Self::normalized(lathe(&lower.chain(upper).collect::<Vec<_>>()), shape)
            }
            Form::Polygon(polygon) => Self::normalized(plane(polygon), shape),
            Form::Hull(hull) => Self::normalized(faces(hull), shape),
            Form::Union(parts) => Self::normalized(joined(parts), shape),
            Form::HalfSpace(_) => Self::scaled(&Arc::default(), [1.0; 3]),
            Form::Facets(_) | Form::Smooth(_) | Form::Distance => {
                let surface = shape.polyhedron().map_or_else(|| marching_tetrahedra(shape, EDGES), triangles);
                Self::normalized(surface, shape)
            }
        }
    }

    fn scaled(surface: &Arc<PolygonSurface>, scale: [f64; 3]) -> Self {
        Self { surface: surface.clone(), scale: scale.into() }
    }

    /// PolygonSurface in metres, divided by the shape's bounding radius.
    fn normalized(mut surface: PolygonSurface, shape: &dyn Shape) -> Self {
        let radius = shape.bounding_radius();
        surface.points.iter_mut().for_each(|p| *p /= radius);
        Self { surface: Arc::new(surface), scale: Vector::repeat(radius) }
    }

    /// Points in the body's frame \[m\].
    pub(super) fn points(&self) -> impl Iterator<Item = Vector> {
        self.surface.points.iter().map(|p| p.coords.component_mul(&self.scale))
    }
}

impl PolygonSurface {
    /// The same with coordinates rounded to 2⁻²⁴, single precision at 1, so that scaled copies are
    /// equal.
    pub(super) fn rounded(&self) -> Self {
        let unit = f64::from(1 << 24);
        // Zeros have one sign.
        let points = self.points.iter().map(|p| p.map(|x| (x * unit).round() / unit + 0.0)).collect();
        Self { points, ..self.clone() }
    }
    pub(super) fn push_polygon(&mut self, corners: impl IntoIterator<Item = usize>) {
        self.corners.extend(corners);
        self.ends.push(self.corners.len());
    }
}

/// Unit disc with a line from its centre to its rim.
fn disc() -> PolygonSurface {
    let rim = circle().map(|[cos, sin]| Point::new(cos, sin, 0.0));
    let mut disc = PolygonSurface { lines: vec![[EDGES, 0]], ..PolygonSurface::default() };
    disc.points = rim.chain([Point::origin()]).collect();
    disc.push_polygon(0..EDGES);
    disc
}

fn circle() -> impl Iterator<Item = [f64; 2]> {
    (0..EDGES).map(|i| {
        let (sin, cos) = (TAU * i as f64 / EDGES as f64).sin_cos();
        [cos, sin]
    })
}

/// Distances from the axis and heights on a meridian, `range` counting edges from the equator.
fn arc(radius: f64, range: [i32; 2]) -> Vec<[f64; 2]> {
    let point = |i: i32| {
        let (sin, cos) = (FRAC_PI_2 * f64::from(i) / f64::from(EIGHTHS)).sin_cos();
        [if i.abs() == EIGHTHS { 0.0 } else { radius * cos }, radius * sin]
    };
    (range[0]..=range[1]).map(point).collect()
}

/// PolygonSurface of revolution about z of a profile of distances from the axis and heights, upwards. An
/// end on the axis is a pole, another one a flat cap.
fn lathe(profile: &[[f64; 2]]) -> PolygonSurface {
    let mut surface = PolygonSurface::default();
    let mut below: Option<Vec<usize>> = None;
    for [radius, height] in profile {
        let first = surface.points.len();
        let ring: Vec<usize> = if *radius > 0.0 {
            surface.points.extend(circle().map(|[cos, sin]| Point::new(radius * cos, radius * sin, *height)));
            (first..first + EDGES).collect()
        } else {
            surface.points.push(Point::new(0.0, 0.0, *height));
            vec![first; EDGES]
        };
        match below {
            None if *radius > 0.0 => surface.push_polygon(ring.iter().rev().copied()),
            None => {}
            Some(below) => {
                for i in 0..EDGES {
                    let next = (i + 1) % EDGES;
                    let mut corners = vec![below[i], below[next], ring[next], ring[i]];
                    corners.dedup();
                    surface.push_polygon(corners);
                }
            }
        }
        below = Some(ring);
    }
    if let (Some(ring), Some([radius, _])) = (below, profile.last())
        && *radius > 0.0
    {
        surface.push_polygon(ring);
    }
    surface
}

/// Convex pieces of a polygon.
fn plane(polygon: &Polygon) -> PolygonSurface {
    let mut surface = PolygonSurface::default();
    let mut numbers = std::collections::HashMap::new();
    for piece in polygon.pieces() {
        let corners: Vec<usize> = piece
            .corners
            .iter()
            .map(|c: &Vector2<f64>| {
                *numbers.entry([c.x.to_bits(), c.y.to_bits()]).or_insert_with(|| {
                    surface.points.push(Point::new(c.x, c.y, 0.0));
                    surface.points.len() - 1
                })
            })
            .collect();
        surface.push_polygon(corners);
    }
    surface
}

fn faces(hull: &ConvexPolyhedron) -> PolygonSurface {
    let mut surface = PolygonSurface { points: hull.vertices().to_vec(), ..PolygonSurface::default() };
    for face in hull.loops() {
        surface.push_polygon(face.iter().map(|&v| v as usize));
    }
    surface
}

fn triangles(polyhedron: Polyhedron<'_>) -> PolygonSurface {
    let mut surface = PolygonSurface { points: polyhedron.vertices.to_vec(), ..PolygonSurface::default() };
    for face in polyhedron.faces {
        surface.push_polygon(face.map(|v| v as usize));
    }
    surface
}

/// Surfaces of all parts, in the frame of the whole.
fn joined(parts: &[Part]) -> PolygonSurface {
    let mut whole = PolygonSurface::default();
    for part in parts {
        let own = ScaledSurface::of(&*part.shape);
        let first = whole.points.len();
        whole.points.extend(own.points().map(|p| part.pose.to_world(Point::from(p))));
        let mut start = 0;
        for &end in &own.surface.ends {
            whole.push_polygon(own.surface.corners[start..end].iter().map(|i| first + i));
            start = end;
        }
        whole.lines.extend(own.surface.lines.iter().map(|line| line.map(|i| first + i)));
    }
    whole
}

#[cfg(test)]
mod tests;
