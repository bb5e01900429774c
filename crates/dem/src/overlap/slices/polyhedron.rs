//! Convex polyhedra in slices.
use super::frame::Frame;
use super::slice::{Corner, Place, Side, Slice, Tag};
use crate::ConvexPolyhedron;
use interfaces::{Pose, Vector};

/// A convex polyhedron as a frame's slices see it; keeps the memory that this takes.
#[derive(Clone, Debug, Default)]
pub(super) struct SlicedPolyhedron {
    points: Vec<Vector>,
    faces: Vec<Face>,
    edges: Vec<[u32; 4]>,
    /// The corners of a slice in the order of edges, with the face that is next.
    found: Vec<(Corner, u32)>,
    pub(super) low: f64,
    pub(super) high: f64,
}

#[derive(Clone, Copy, Debug)]
struct Face {
    normal: Vector,
    offset: f64,
    /// Number of the corner at which its side of a slice ends.
    end: u32,
}

/// Faces whose normals have less than this in the slices are not seen by their planes.
const FLAT: f64 = 0.01;

impl SlicedPolyhedron {
    pub(super) fn place(&mut self, body: &ConvexPolyhedron, at: &Pose, frame: &Frame) {
        self.points.clear();
        self.faces.clear();
        self.edges.clear();
        let centre = frame.place(at.position);
        let direction = |v: Vector| frame.direction(at.orientation * v);
        self.points.extend(body.vertices().iter().map(|v| centre + direction(v.coords)));
        self.faces.extend(body.planes.iter().map(|p| {
            let normal = direction(p.normal);
            Face { normal, offset: p.offset + normal.dot(&centre), end: 0 }
        }));
        self.edges.extend(body.edges.iter().map(|e| {
            let ([p, q], [left, right]) = (e.ends, e.faces);
            // Upwards.
            if self.points[p as usize].z <= self.points[q as usize].z {
                [p, q, left, right]
            } else {
                [q, p, right, left]
            }
        }));
        let heights = || self.points.iter().map(|x| x.z);
        self.low = heights().fold(f64::INFINITY, f64::min);
        self.high = heights().fold(f64::NEG_INFINITY, f64::max);
    }
    pub(super) fn lift(&mut self, by: f64) {
        self.points.iter_mut().for_each(|x| x.z += by);
        self.faces.iter_mut().for_each(|f| f.offset += f.normal.z * by);
        self.low += by;
        self.high += by;
    }
    /// Seen from outside, the outline runs from the left face of an upward edge to its right one.
    pub(super) fn slice(&mut self, h: f64, slice: &mut Slice) {
        slice.corners.clear();
        slice.sides.clear();
        (slice.radius, slice.slope) = (0.0, 0.0);
        self.found.clear();
        for &[low, high, left, right] in &self.edges {
            let (p, q) = (&self.points[low as usize], &self.points[high as usize]);
            if p.z <= h && q.z > h {
                let dx = (q.xy() - p.xy()) / (q.z - p.z);
                self.faces[left as usize].end = self.found.len() as u32;
                self.found.push((Corner { x: p.xy() + dx * (h - p.z), dx }, right));
            }
        }
        let mut at = 0;
        for _ in 0..self.found.len() {
            let Some(&(corner, number)) = self.found.get(at) else { break };
            let face = &self.faces[number as usize];
            at = face.end as usize;
            let Some(&(next, _)) = self.found.get(at) else { break };
            let flat = face.normal.xy().norm();
            let side = if flat > FLAT {
                let normal = face.normal.xy() / flat;
                let offset = (face.offset - face.normal.z * h) / flat;
                Some((normal, offset, face.normal.z / flat))
            } else {
                let way = next.x - corner.x;
                Place::new(way.y, -way.x)
                    .try_normalize(0.0)
                    .map(|normal| (normal, normal.dot(&(0.5 * (corner.x + next.x))), -normal.dot(&corner.dx)))
            };
            if let Some((normal, offset, slope)) = side {
                slice.corners.push(corner);
                slice.sides.push(Side { normal, offset, slope, tag: Tag::new(slice.body, number) });
            }
            if at == 0 {
                break;
            }
        }
        // Lines have no inside.
        if slice.sides.len() < 3 {
            slice.sides.clear();
            slice.corners.clear();
        }
    }
}
