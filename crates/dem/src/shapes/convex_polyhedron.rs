//! The convex polyhedron.
use super::Facets;
use super::hull::hull;
use super::triangle::{Part, Triangle};
use crate::{DemError, Form, Shape};
use interfaces::{Aabb, Inertia, Point, Polyhedron, Solid, Vector};
use nalgebra::Matrix3;

/// A convex body between flat faces, its centre of mass at the origin.
#[derive(Clone, Debug)]
pub struct ConvexPolyhedron {
    points: Vec<Point>,
    triangles: Vec<[u32; 3]>,
    /// The borders of the faces, one after the other, and where each begins.
    loops: Vec<u32>,
    starts: Vec<usize>,
    pub(crate) edges: Vec<HullEdge>,
    pub(crate) planes: Vec<Plane>,
    facets: Facets,
    /// ∫ (|x|² 1 − x xᵀ) dV.
    second: Matrix3<f64>,
    volume: f64,
    origin: Point,
}

/// All x with normal·x ≤ offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane {
    pub(crate) normal: Vector,
    pub(crate) offset: f64,
}

/// An edge between two vertices, with the faces on its left and right, seen from outside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HullEdge {
    pub(crate) ends: [u32; 2],
    pub(crate) faces: [u32; 2],
}

/// Vertices may stand out of a face's plane by this part of the body's size.
const FLATNESS: f64 = 1e-9;
/// Rounding, as a share of the body's size, where a plane parts the body from a point.
const PARTED: f64 = 1e-14;

impl ConvexPolyhedron {
    /// The body between these `faces`, each given by its `vertices` \[m\] one after the other, counter-clockwise seen from
    /// outside. It is moved so that its centre of mass is at the origin.
    ///
    /// # Errors
    /// [`DemError::Polyhedron`] that names the face which is not flat, or the edge at which the body is not closed or not convex.
    pub fn new(vertices: &[[f64; 3]], faces: &[Vec<u32>]) -> Result<Self, DemError> {
        let wrong = |face: usize, what: &'static str| DemError::Polyhedron { face, what };
        let points: Vec<Vector> = vertices.iter().map(|v| Vector::from(*v)).collect();
        let mut triangles = Vec::new();
        let mut of = Vec::new();
        for (f, face) in faces.iter().enumerate() {
            if face.len() < 3 {
                return Err(wrong(f, "has less than three vertices"));
            }
            if face.iter().any(|&v| v as usize >= points.len()) {
                return Err(wrong(f, "has a vertex that is not there"));
            }
            if !face.iter().all(|&v| points[v as usize].iter().all(|x| x.is_finite())) {
                return Err(wrong(f, "has a vertex that is not finite"));
            }
            for pair in face[1..].windows(2) {
                triangles.push([face[0], pair[0], pair[1]]);
                of.push(f);
            }
        }
        if triangles.len() < 4 {
            return Err(wrong(faces.len(), "is missing: there are fewer than four triangles"));
        }
        let start = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
        let corners = || triangles.iter().flatten().map(|&v| points[v as usize]);
        let (low, high) = corners().fold(start, |(l, h), x| (l.inf(&x), h.sup(&x)));
        // About the middle first, so that a body far from the origin loses no digits.
        let middle = 0.5 * (low + high);
        let open = |t: usize| {
            wrong(of[t], "has an edge that no other face has, or that a neighbour has in the same direction")
        };
        let centred = |centre: Vector| points.iter().map(|p| p - centre).collect::<Vec<_>>();
        let first = Facets::new(centred(middle), triangles.clone()).map_err(open)?.moments();
        let size = (high - low).max();
        if first.volume <= 1e-12 * size.powi(3) {
            return Err(wrong(0, "encloses no volume with the others, or is given clockwise as they are"));
        }
        let centre = middle + first.first / first.volume;
        let points = centred(centre);
        let planes = faces.iter().map(|face| plane(&points, face)).collect::<Vec<_>>();
        for (f, (face, plane)) in faces.iter().zip(&planes).enumerate() {
            let out = |x: &Vector| plane.normal.dot(x) - plane.offset;
            if !face.iter().all(|&v| out(&points[v as usize]).abs() <= FLATNESS * size) {
                return Err(wrong(f, "is not flat"));
            }
            if !points.iter().all(|x| out(x) <= FLATNESS * size) {
                return Err(wrong(f, "has part of the body in front of it, which therefore is not convex"));
            }
        }
        let starts = std::iter::once(0).chain(faces.iter().scan(0, |end, f| {
            *end += f.len();
            Some(*end)
        }));
        let starts = starts.collect();
        let edges = edges(faces);
        let facets = Facets::new(points.clone(), triangles.clone()).map_err(open)?;
        let moments = facets.moments();
        Ok(Self {
            points: points.into_iter().map(Point::from).collect(),
            triangles,
            loops: faces.concat(),
            starts,
            edges,
            planes,
            second: moments.inertia(),
            volume: moments.volume,
            facets,
            origin: Point::from(centre),
        })
    }

    /// The convex hull of `points` \[m\]; what is plane up to 1e-12 of its size is one face.
    ///
    /// ```
    /// use dem::{ConvexPolyhedron, DemError};
    ///
    /// let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.2, 0.2, 0.2]];
    /// let body = ConvexPolyhedron::from_points(&corners)?;
    /// assert_eq!((body.vertices().len(), body.n_faces()), (4, 4));
    /// # Ok::<(), DemError>(())
    /// ```
    ///
    /// # Errors
    /// [`DemError::TooFewPoints`], [`DemError::PointNotFinite`], [`DemError::PointsOnLine`] and [`DemError::PointsOnPlane`];
    /// [`DemError::Polyhedron`] for a hull that is too thin, or has faces so narrow that their planes are not known to 1e-9 of its
    /// size.
    pub fn from_points(points: &[[f64; 3]]) -> Result<Self, DemError> {
        let (vertices, faces) = hull(points)?;
        let vertices: Vec<[f64; 3]> = vertices.into_iter().map(Into::into).collect();
        Self::new(&vertices, &faces)
    }

    /// The vertices, from the centre of mass \[m\].
    pub fn vertices(&self) -> &[Point] {
        &self.points
    }
    /// The vertices of every face, counter-clockwise seen from outside.
    pub fn loops(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|ends| &self.loops[ends[0]..ends[1]])
    }
    /// The areas of the faces \[m²\].
    pub fn face_areas(&self) -> impl Iterator<Item = f64> {
        self.loops().map(|face| {
            let corner = |i: usize| self.points[face[i % face.len()] as usize].coords;
            let twice: Vector = (0..face.len()).map(|i| corner(i).cross(&corner(i + 1))).sum();
            0.5 * twice.norm()
        })
    }
    /// How many faces there are.
    pub fn n_faces(&self) -> usize {
        self.planes.len()
    }
    /// Volume \[m³\].
    pub fn volume(&self) -> f64 {
        self.volume
    }
    /// Where the centre of mass is in the coordinates that the vertices were given in \[m\].
    pub fn origin(&self) -> Point {
        self.origin
    }
    /// The least way to `x` from face `f`.
    fn way_from_face(&self, f: usize, x: Vector) -> Vector {
        let mut least = (f64::INFINITY, Vector::zeros());
        for t in self.fan(f) {
            let [a, b, c] = t.map(|v| self.points[v as usize].coords);
            let (from, part) = Triangle::new(a, b, c).nearest(x);
            let square = from.norm_squared();
            if square < least.0 {
                least = (square, from);
            }
            if part == Part::Inside {
                break;
            }
        }
        least.1
    }
    /// The triangles of face `f`, which all have its first vertex.
    fn fan(&self, f: usize) -> &[[u32; 3]] {
        &self.triangles[self.starts[f] - 2 * f..self.starts[f + 1] - 2 * (f + 1)]
    }
    /// The faces cut into triangles.
    pub(crate) fn facets(&self) -> &Facets {
        &self.facets
    }
}

/// By Newell's sum over the border.
fn plane(points: &[Vector], face: &[u32]) -> Plane {
    let corner = |i: usize| points[face[i % face.len()] as usize];
    let from = corner(0);
    let area = (1..face.len()).map(|i| (corner(i) - from).cross(&(corner(i + 1) - from))).sum::<Vector>();
    let normal = area.try_normalize(0.0).unwrap_or_default();
    let offset = (0..face.len()).map(|i| normal.dot(&corner(i))).sum::<f64>() / face.len() as f64;
    Plane { normal, offset }
}

/// Every edge once; that there are two faces to each is known.
fn edges(faces: &[Vec<u32>]) -> Vec<HullEdge> {
    let mut open = std::collections::HashMap::new();
    let mut edges = Vec::new();
    for (f, face) in (0..).zip(faces) {
        for i in 0..face.len() {
            let (from, to) = (face[i], face[(i + 1) % face.len()]);
            match open.remove(&(to, from)) {
                Some(e) => {
                    let edge: &mut HullEdge = &mut edges[e];
                    edge.faces[1] = f;
                }
                None => {
                    open.insert((from, to), edges.len());
                    edges.push(HullEdge { ends: [from, to], faces: [f, f] });
                }
            }
        }
    }
    edges
}

impl Shape for ConvexPolyhedron {
    fn name(&self) -> &'static str {
        "convex polyhedron"
    }
    fn inertia(&self, density: f64) -> Inertia {
        Inertia { mass: density * self.volume, volume: self.volume, tensor: density * self.second }
    }
    fn bounding_radius(&self) -> f64 {
        self.facets.radius
    }
    fn form(&self) -> Form<'_> {
        Form::Hull(self)
    }
}

impl Solid for ConvexPolyhedron {
    /// Within, the nearest plane; without, the nearest triangle of the faces that are seen from there.
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        let out = |p: &Plane| p.normal.dot(&x.coords) - p.offset;
        let more = |best: (usize, f64), now: (usize, f64)| if now.1 > best.1 { now } else { best };
        let (foremost, deepest) = self.planes.iter().map(out).enumerate().fold((0, f64::NEG_INFINITY), more);
        if deepest <= 0.0 || deepest >= band {
            return deepest;
        }
        let mut least = f64::INFINITY;
        // No point of a face is nearer than its plane.
        let seen = |&(f, p): &(usize, &Plane)| f != foremost && out(p) > 0.0;
        let others = self.planes.iter().enumerate().filter(seen).map(|(f, p)| (f, out(p)));
        for (f, out) in std::iter::once((foremost, deepest)).chain(others) {
            if out * out >= least {
                continue;
            }
            let from = self.way_from_face(f, x.coords);
            let square = from.norm_squared();
            if square < least {
                least = square;
                // No point of the body is nearer if a plane across the way parts them.
                let ahead = |y: &Point| from.dot(&(y - x)) + square;
                if self.points.iter().all(|y| ahead(y) <= PARTED * square.sqrt() * self.facets.radius) {
                    break;
                }
            }
        }
        least.sqrt()
    }
    fn aabb(&self) -> Aabb {
        let [low, high] = self.facets.bounds;
        Aabb { min: low.into(), max: high.into() }
    }
    fn polyhedron(&self) -> Option<Polyhedron<'_>> {
        Some(Polyhedron { vertices: &self.points, faces: &self.triangles })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Outside it is the distance from the nearest of all triangles, inside that from the nearest plane.
        #[test]
        fn distance_is_that_of_all_triangles(
            points in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 5..30),
            x in prop::array::uniform3(-1.5..1.5f64),
        ) {
            let Ok(body) = ConvexPolyhedron::from_points(&points) else { return Ok(()) };
            let x = Point::from(x);
            let found = body.signed_distance(x, f64::INFINITY);
            let triangle = |t: &[u32; 3]| {
                let [a, b, c] = t.map(|v| body.points[v as usize].coords);
                Triangle::new(a, b, c).nearest(x.coords).0.norm()
            };
            let nearest = body.triangles.iter().map(triangle).fold(f64::INFINITY, f64::min);
            prop_assert!((found.abs() - nearest).abs() < 1e-13, "{} {}", found, nearest);
            let behind_all = body.planes.iter().all(|p| p.normal.dot(&x.coords) < p.offset);
            prop_assert_eq!(found < 0.0, behind_all);
        }
    }
}
