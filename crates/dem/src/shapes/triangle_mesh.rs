//! Bodies given as closed triangle meshes.
mod admission;
mod box_tree;
mod cluster;
mod crossings;
mod error;
mod flat_faces;
mod meeting;
mod nesting;
mod obj;
mod oriented_box;
mod polygon;
mod repair;
mod repair_report;
mod soup;
mod sphere;
mod stl;
mod surface;
#[cfg(test)]
mod tests;
mod text;
mod thickness;
mod topology;
mod welding;
mod winding;

pub use admission::{AdmissionReport, Shell};
pub use error::MeshError;
pub use repair_report::{Changes, RepairReport};
pub use soup::TriangleSoup;
pub use thickness::Thinnest;

use crate::shapes::{Facets, Moments};
use crate::{ConvexPolyhedron, FacetIndex, Form, Shape};
use interfaces::{Aabb, Inertia, Point, Polyhedron, Solid, Vector};
use std::path::Path;
use std::sync::OnceLock;
use surface::{Nearest, Surface};

/// A body whose surface is a closed, consistently oriented triangle mesh.
///
/// Signed distances are exact: the nearest point is found with a tree of boxes, the sign from the
/// angle-weighted pseudo-normal of the face, edge or vertex it lies on, which is right for every closed
/// oriented 2-manifold (Bærentzen & Aanæs 2005, IEEE Trans. Vis. Comput. Graph. 11, 243), concave or
/// with cavities. Meshes that cross or touch themselves, near which signs would be wrong, are refused.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    vertices: Vec<Point>,
    faces: Vec<[u32; 3]>,
    surface: Surface,
    facets: Facets,
    /// The same body, if it is convex and small: cutting is faster then.
    hull: Option<Box<ConvexPolyhedron>>,
    /// For the adaptive tree, made when first asked for.
    index: OnceLock<FacetIndex>,
    bounds: Aabb,
    /// Distance of the farthest vertex.
    radius: f64,
    volume: f64,
    /// Second moments about the centre of mass per density.
    moments: Moments,
    origin: Point,
}

impl TriangleMesh {
    /// The body between these `vertices` \[m\], three of which make each of the `faces`,
    /// counter-clockwise seen from outside (or all of them clockwise: then they are turned). It is
    /// moved so that its centre of mass is at the origin. Faces without area between others, which
    /// close the surface where a vertex lies in the middle of an edge, are flipped with a neighbour.
    ///
    /// # Errors
    /// [`MeshError`], naming the faces: the first fault that an [`AdmissionReport`] would tell.
    pub fn new(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Self, MeshError> {
        let mut faces = admission::check(vertices, faces)?;
        let used = || faces.as_flattened().iter().map(|v| *v as usize);
        let (low, high) = corners(used().map(|v| Point::from(vertices[v])));
        // About the middle of the box, so that a mesh far from the origin loses no digits.
        let middle = nalgebra::center(&low, &high);
        let mut points: Vec<Vector> = vertices.iter().map(|v| Point::from(*v) - middle).collect();
        let mut whole = Moments::of(&points, faces.iter().copied());
        if whole.volume < 0.0 {
            faces.iter_mut().for_each(|f| f.swap(1, 2));
            whole = Moments::of(&points, faces.iter().copied());
        }
        let centre = whole.first / whole.volume;
        points.iter_mut().for_each(|p| *p -= centre);
        let moments = Moments::of(&points, faces.iter().copied());
        let bounds = Aabb { min: low - middle.coords - centre, max: high - middle.coords - centre };
        let farthest = faces.as_flattened().iter().map(|v| points[*v as usize].norm()).fold(0.0, f64::max);
        let vertices = points.iter().map(|p| Point::from(*p)).collect();
        let open = |face| MeshError::NotClosed { count: 1, faces: vec![face] };
        let facets = Facets::new(points.clone(), faces.clone()).map_err(open)?;
        let hull = convex(&points, &faces).map(Box::new);
        let surface = Surface::new(points, faces.clone());
        Ok(Self {
            vertices,
            faces,
            surface,
            facets,
            hull,
            index: OnceLock::new(),
            bounds,
            radius: farthest,
            volume: moments.volume,
            moments,
            origin: middle + centre,
        })
    }

    /// The body in an STL file, text or binary, whose unit of length is `unit` \[m\] (1e-3 for
    /// millimetres). If corners that should be one differ by round-off: [`TriangleSoup::welded`]; for
    /// other faults: [`TriangleSoup::repaired`].
    ///
    /// # Errors
    /// Those of [`new`](Self::new) and [`TriangleSoup::from_stl`].
    pub fn from_stl(path: impl AsRef<Path>, unit: f64) -> Result<Self, MeshError> {
        TriangleSoup::from_stl(path, unit)?.try_into()
    }
    /// The body in a Wavefront OBJ file, whose unit of length is `unit` \[m\].
    ///
    /// # Errors
    /// Those of [`new`](Self::new) and [`TriangleSoup::from_obj`].
    pub fn from_obj(path: impl AsRef<Path>, unit: f64) -> Result<Self, MeshError> {
        TriangleSoup::from_obj(path, unit)?.try_into()
    }

    /// Number of triangles.
    pub fn n_faces(&self) -> usize {
        self.faces.len()
    }
    /// Volume, by the divergence theorem \[m³\].
    pub fn volume(&self) -> f64 {
        self.volume
    }
    /// Where the centre of mass is in the coordinates that the vertices were given in \[m\].
    pub fn origin(&self) -> Point {
        self.origin
    }
    /// Places of the vertices, in the body's frame \[m\].
    pub fn vertices(&self) -> &[Point] {
        &self.vertices
    }
    /// Numbers of three vertices for every face, counter-clockwise seen from outside.
    pub fn faces(&self) -> &[[u32; 3]] {
        &self.faces
    }
    /// How often the surface goes around `x`, in the body's frame: 1 inside, 0 outside, up to round-off. It takes a sum over
    /// all faces; [`signed_distance`](Solid::signed_distance) is much faster and has the same sign.
    pub fn winding_number(&self, x: Point) -> f64 {
        winding::winding_number(self.faces.iter(), |v| self.vertices[v as usize], x)
    }
}

impl Shape for TriangleMesh {
    fn name(&self) -> &'static str {
        "triangle mesh"
    }
    /// By the divergence theorem: exact, whatever the triangles.
    fn inertia(&self, density: f64) -> Inertia {
        Inertia { mass: density * self.volume, volume: self.volume, tensor: self.moments.inertia() * density }
    }
    fn bounding_radius(&self) -> f64 {
        self.radius
    }
    fn form(&self) -> Form<'_> {
        self.hull.as_deref().map_or(Form::Facets(&self.facets), Form::Hull)
    }
    fn facet_index(&self) -> Option<&FacetIndex> {
        let surface = Polyhedron { vertices: &self.vertices, faces: &self.faces };
        Some(self.index.get_or_init(|| FacetIndex::new(surface)))
    }
}

/// Convex bodies with no more vertices than this are taken for [`ConvexPolyhedron`]s.
const SMALL: usize = 30;

/// The body as a polyhedron, if it is small and convex, but for round-off.
fn convex(points: &[Vector], faces: &[[u32; 3]]) -> Option<ConvexPolyhedron> {
    let size = points.iter().map(|p| p.amax()).fold(0.0, f64::max);
    let behind = |f: &[u32; 3]| {
        let [a, b, c] = f.map(|v| points[v as usize]);
        let normal = (b - a).cross(&(c - a)).normalize();
        points.iter().all(|p| normal.dot(&(p - a)) <= 1e-14 * size)
    };
    if points.len() > SMALL || !faces.iter().all(behind) {
        return None;
    }
    let vertices: Vec<[f64; 3]> = points.iter().map(|p| (*p).into()).collect();
    let faces: Vec<Vec<u32>> = faces.iter().map(|f| f.to_vec()).collect();
    ConvexPolyhedron::new(&vertices, &faces).ok()
}

/// Lower and upper corner of the box around places.
fn corners(places: impl Iterator<Item = Point>) -> (Point, Point) {
    let start = (Point::from([f64::INFINITY; 3]), Point::from([f64::NEG_INFINITY; 3]));
    places.fold(start, |(low, high), p| (low.inf(&p), high.sup(&p)))
}

/// What is known from the point before: points in a batch are near one another.
struct Last {
    at: Point,
    /// |d| is no less there.
    least: f64,
    sign: f64,
    face: u32,
}

impl Solid for TriangleMesh {
    fn signed_distance(&self, x: Point, band: f64) -> f64 {
        let mut out = [0.0];
        self.signed_distances(&[x], band, &mut out);
        out[0]
    }

    fn signed_distances(&self, points: &[Point], band: f64, out: &mut [f64]) {
        let mut last: Option<Last> = None;
        for (x, out) in points.iter().zip(out) {
            let gap = (self.bounds.min - x).sup(&(x - self.bounds.max)).map(|g| g.max(0.0)).norm();
            if gap >= band {
                // Outside the box: nothing to look for.
                *out = gap;
                continue;
            }
            let step = last.as_ref().map_or(f64::INFINITY, |l| (x - l.at).norm());
            // Too near where the surface was far.
            if let Some(l) = last.as_ref().filter(|l| l.least - step >= band) {
                *out = (l.least - step).copysign(l.sign);
                continue;
            }
            let seed = last.as_ref().map(|l| l.face);
            let mut found = self.surface.nearest(*x, band, seed);
            if found.is_none() {
                // |d| ≥ band; and since d changes by no more than the step, its sign may be known.
                if let Some(l) = last.as_mut().filter(|l| step < band + l.least) {
                    *out = band.copysign(l.sign);
                    (l.at, l.least) = (*x, band);
                    continue;
                }
                found = self.surface.nearest(*x, f64::INFINITY, seed);
            }
            let Some(Nearest { face, distance, outside, .. }) = found else { continue };
            let sign = if outside { 1.0 } else { -1.0 };
            *out = distance * sign;
            last = Some(Last { at: *x, least: distance, sign, face });
        }
    }

    fn aabb(&self) -> Aabb {
        self.bounds
    }

    fn polyhedron(&self) -> Option<Polyhedron<'_>> {
        Some(Polyhedron { vertices: &self.vertices, faces: &self.faces })
    }

    fn normal(&self, x: Point, _band: f64) -> Vector {
        self.surface.nearest(x, f64::INFINITY, None).map_or_else(Vector::zeros, |n| {
            let away = if n.outside { x - n.point } else { n.point - x };
            // On the surface itself, the pseudo-normal.
            if n.distance > 1e-9 * self.bounds.extent().max() { away / n.distance } else { n.normal }
        })
    }
}
