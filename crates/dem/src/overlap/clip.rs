//! Convex polyhedra, by cutting one off at the planes of the other.
use super::Overlap;
use super::facets::Sums;
use crate::{ConvexPolyhedron, Shape};
use interfaces::{Pose, Vector};

/// Cuts polyhedra at planes; keeps the memory that this takes.
///
/// What is left of the first body is a list of edges, each with the faces on its left and right. A plane drops the edges in front of
/// it and shortens those that pass through it; on every face so cut a new edge runs from where the border leaves to where it
/// enters again. Every cut leaves the surface closed, however the signs of corners near the plane are rounded, so faces that share
/// a plane need no care. Volume and moments are sums over the edges ([`Sums`]).
#[derive(Clone, Debug, Default)]
pub(crate) struct Clipper {
    places: Vec<Vector>,
    edges: Vec<Edge>,
    heights: Vec<f64>,
    /// Feet of the planes, the first body's before the second's.
    feet: Vec<Vector>,
    open: Vec<Open>,
}

/// An edge from place to place, with the numbers of the faces on its left and right.
#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [u32; 2],
    faces: [u32; 2],
}

/// A place where a face's border leaves what is kept, or enters.
#[derive(Clone, Copy, Debug)]
struct Open {
    face: u32,
    place: u32,
    leaves: bool,
}

impl Clipper {
    /// One patch, if any.
    pub(crate) fn overlap(
        &mut self,
        a: &ConvexPolyhedron,
        at_a: &Pose,
        b: &ConvexPolyhedron,
        at_b: &Pose,
        out: &mut Vec<Overlap>,
    ) {
        // The frame of the smaller one has the smaller numbers.
        if a.bounding_radius() < b.bounding_radius() {
            let first = out.len();
            self.overlap(b, at_b, a, at_a, out);
            out[first..].iter_mut().for_each(|o| *o = o.swapped());
            return;
        }
        let apart = at_a.position - at_b.position;
        if apart.norm() > a.bounding_radius() + b.bounding_radius() {
            return;
        }
        let turn = at_b.orientation.inverse() * at_a.orientation;
        let turn = turn.to_rotation_matrix();
        let shift = at_b.orientation.inverse_transform_vector(&apart);
        self.places.clear();
        self.places.extend(a.vertices().iter().map(|x| turn * x.coords + shift));
        self.edges.clear();
        self.edges.extend(a.edges.iter().map(|e| Edge { ends: e.ends, faces: e.faces }));
        let first_planes = a.planes.len() as u32;
        for (face, plane) in (first_planes..).zip(&b.planes) {
            if !self.cut(plane.normal, plane.offset, face) {
                return;
            }
        }
        // About a point within, so that small overlaps keep their digits.
        let ends = || self.edges.iter().map(|e| self.places[e.ends[0] as usize]);
        let reference = ends().sum::<Vector>() / self.edges.len() as f64;
        self.feet.clear();
        self.feet.extend(a.planes.iter().map(|p| {
            let normal = turn * p.normal;
            normal * (p.offset + normal.dot(&(shift - reference)))
        }));
        self.feet.extend(b.planes.iter().map(|p| p.normal * (p.offset - p.normal.dot(&reference))));
        let mut sums = Sums::default();
        for e in &self.edges {
            let [p, q] = e.ends.map(|i| self.places[i as usize] - reference);
            let [left, right] = e.faces.map(|f| self.feet[f as usize]);
            sums.add_edge(p, q, left, right);
            match e.faces.map(|f| f < first_planes) {
                [true, false] => sums.add_curve(p, q),
                [false, true] => sums.add_curve(q, p),
                _ => {}
            }
        }
        if sums.volume > 0.0 {
            let to_world = |x: Vector| (at_b.to_world((reference + x).into()), at_b.orientation * x);
            out.push(sums.overlap(to_world, apart.try_normalize(0.0).unwrap_or_default()));
        }
    }

    /// Keeps what lies behind a plane, which gets the number `face`; answers whether anything does.
    fn cut(&mut self, normal: Vector, offset: f64, face: u32) -> bool {
        self.heights.clear();
        self.heights.extend(self.places.iter().map(|x| normal.dot(x) - offset));
        // Places that are no longer on any edge may be ahead, too: then the edges all stay.
        if self.heights.iter().all(|h| *h <= 0.0) {
            return true;
        }
        self.open.clear();
        let mut kept = 0;
        for i in 0..self.edges.len() {
            let mut edge = self.edges[i];
            let [start, end] = edge.ends.map(|v| self.heights[v as usize]);
            let leaves = start <= 0.0;
            if (end <= 0.0) != leaves {
                let [p, q] = edge.ends.map(|v| self.places[v as usize]);
                let place = self.places.len() as u32;
                self.places.push(p + (q - p) * (start / (start - end)));
                edge.ends[usize::from(leaves)] = place;
                // The face on the right has the edge the other way round.
                self.open.push(Open { face: edge.faces[0], place, leaves });
                self.open.push(Open { face: edge.faces[1], place, leaves: !leaves });
            } else if !leaves {
                continue;
            }
            self.edges[kept] = edge;
            kept += 1;
        }
        self.edges.truncate(kept);
        while let Some(here) = self.open.pop() {
            let other = self.open.iter().position(|o| o.face == here.face && o.leaves != here.leaves);
            if let Some(other) = other {
                let other = self.open.swap_remove(other);
                let ends = if here.leaves { [here.place, other.place] } else { [other.place, here.place] };
                self.edges.push(Edge { ends, faces: [here.face, face] });
            }
        }
        !self.edges.is_empty()
    }
}
