//! Bodies given as closed triangle meshes.
mod cluster;
mod error;
mod mass;
mod sphere;
mod surface;
#[cfg(test)]
mod tests;
mod triangle;

pub use error::MeshError;

use interfaces::{Aabb, Inertia, Point, Polyhedron, Solid, Vector};
use mass::Moments;
use std::path::Path;
use surface::{Nearest, Surface};

/// A body whose surface is a closed, consistently oriented triangle mesh.
///
/// Signed distances are exact: the nearest point is found with a tree of boxes, the sign from the
/// angle-weighted pseudo-normal of the face, edge or vertex it lies on, which is right for every closed
/// oriented 2-manifold (Bærentzen & Aanæs 2005, IEEE Trans. Vis. Comput. Graph. 11, 243), concave or
/// with cavities. Meshes that intersect themselves, or touch themselves in a vertex, are not found out: signs may be
/// wrong near there.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    vertices: Vec<Point>,
    faces: Vec<[u32; 3]>,
    surface: Surface,
    bounds: Aabb,
    volume: f64,
    /// Second moments about the centre of mass per density.
    moments: Moments,
    origin: Point,
}

impl TriangleMesh {
    /// The body between these `vertices` \[m\], three of which make each of the `faces`,
    /// counter-clockwise seen from outside (or all of them clockwise: then they are turned). It is
    /// moved so that its centre of mass is at the origin.
    ///
    /// # Errors
    /// [`MeshError`], naming the faces, if it is empty, not closed, not consistently oriented,
    /// degenerate or not finite.
    pub fn new(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Self, MeshError> {
        error::check(vertices, faces)?;
        let (low, high) = corners(vertices);
        let size = (high - low).max();
        // About the middle of the box, so that a mesh far from the origin loses no digits.
        let middle = nalgebra::center(&low, &high);
        let mut points: Vec<Vector> = vertices.iter().map(|v| Point::from(*v) - middle).collect();
        let mut faces = faces.to_vec();
        let mut whole = Moments::of(&points, &faces);
        if whole.volume < 0.0 {
            faces.iter_mut().for_each(|f| f.swap(1, 2));
            whole = Moments::of(&points, &faces);
        }
        if whole.volume <= 1e-12 * size.powi(3) {
            return Err(MeshError::Flat { volume: whole.volume, size });
        }
        let centre = whole.first / whole.volume;
        points.iter_mut().for_each(|p| *p -= centre);
        let moments = Moments::of(&points, &faces);
        let bounds = Aabb { min: low - middle.coords - centre, max: high - middle.coords - centre };
        let vertices = points.iter().map(|p| Point::from(*p)).collect();
        let surface = Surface::new(points, faces.clone());
        Ok(Self {
            vertices,
            faces,
            surface,
            bounds,
            volume: moments.volume,
            moments,
            origin: middle + centre,
        })
    }

    /// The body in an STL file, text or binary, whose unit of length is `unit` \[m\] (1e-3 for
    /// millimetres).
    ///
    /// # Errors
    /// Those of [`new`](Self::new), and [`MeshError::File`] if the file cannot be read.
    pub fn from_stl(path: impl AsRef<Path>, unit: f64) -> Result<Self, MeshError> {
        let path = path.as_ref();
        let failed = |e: std::io::Error| MeshError::File { path: path.into(), what: e.to_string() };
        let mut file = std::io::BufReader::new(std::fs::File::open(path).map_err(failed)?);
        let stl = stl_io::read_stl(&mut file).map_err(failed)?;
        let vertices: Vec<_> = stl.vertices.iter().map(|v| v.0.map(|x| f64::from(x) * unit)).collect();
        let too_many = |_| MeshError::File { path: path.into(), what: "more than 2³² vertices".into() };
        let faces = stl.faces.iter().map(|f| {
            let [a, b, c] = f.vertices.map(u32::try_from);
            Ok([a?, b?, c?])
        });
        let faces = faces.collect::<Result<Vec<_>, std::num::TryFromIntError>>().map_err(too_many)?;
        Self::new(&vertices, &faces)
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
    /// Mass properties at `density` \[kg/m³\], by the divergence theorem.
    pub fn inertia(&self, density: f64) -> Inertia {
        Inertia { mass: density * self.volume, volume: self.volume, tensor: self.moments.inertia() * density }
    }
}

/// Lower and upper corner of the box around the vertices.
fn corners(vertices: &[[f64; 3]]) -> (Point, Point) {
    let start = (Point::from([f64::INFINITY; 3]), Point::from([f64::NEG_INFINITY; 3]));
    vertices.iter().fold(start, |(low, high), v| {
        let v = Point::from(*v);
        (low.inf(&v), high.sup(&v))
    })
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
