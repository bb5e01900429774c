//! Convex polyhedra, by cutting one off at the planes of the other.
use super::Overlap;
use super::facets::Sums;
use super::outline::Outline;
use crate::shapes::Plane;
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
    /// The second body's planes that may cut the first, in its frame.
    planes: Vec<Plane>,
    /// Of a cut: the new numbers of the places behind it, and the places that it makes.
    numbers: Vec<u32>,
    made: Vec<Vector>,
    /// Feet of the planes, the first body's before the second's.
    feet: Vec<Vector>,
    /// The edges that a cut makes.
    fresh: Vec<Edge>,
    /// Of every face that is being cut: where its border leaves what is kept, or enters; [`NONE`] where neither is known yet.
    open: Vec<[u32; 2]>,
    /// What finds that place taken: the face, the place and whether the border leaves there.
    later: Vec<(u32, u32, bool)>,
    /// Whether [`Overlap::pivot`] is requested.
    pub(crate) pivots: bool,
}

/// An edge from place to place, with the numbers of the faces on its left and right.
#[derive(Clone, Copy, Debug)]
struct Edge {
    ends: [u32; 2],
    faces: [u32; 2],
}

/// No place.
const NONE: u32 = u32::MAX;

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
        // The smaller one is cut, in its own frame: all places then are small numbers, however large the other is.
        if a.bounding_radius() > b.bounding_radius() {
            let first = out.len();
            self.overlap(b, at_b, a, at_a, out);
            out[first..].iter_mut().for_each(|o| *o = o.swapped());
            return;
        }
        let apart = at_a.position - at_b.position;
        let turn = (at_a.orientation.inverse() * at_b.orientation).to_rotation_matrix();
        let shift = at_b.orientation.inverse_transform_vector(&apart);
        let reach = a.bounding_radius();
        self.planes.clear();
        for plane in &b.planes {
            // The first body's centre is so far ahead of it.
            let height = plane.normal.dot(&shift) - plane.offset;
            if height >= reach {
                return;
            }
            if height > -reach {
                self.planes.push(Plane { normal: turn * plane.normal, offset: -height });
            }
        }
        self.places.clear();
        self.places.extend(a.vertices().iter().map(|x| x.coords));
        self.edges.clear();
        self.edges.extend(a.edges.iter().map(|e| Edge { ends: e.ends, faces: e.faces }));
        let first_planes = a.planes.len() as u32;
        self.open.clear();
        self.open.resize(a.planes.len() + self.planes.len(), [NONE; 2]);
        // Those planes first that have the centre before them: they leave little for the others to look at.
        for centre_ahead in [true, false] {
            for i in 0..self.planes.len() {
                let plane = self.planes[i];
                if (plane.offset < 0.0) == centre_ahead && !self.cut(plane, first_planes + i as u32) {
                    return;
                }
            }
        }
        // About a point within, so that small overlaps keep their digits.
        let ends = || self.edges.iter().map(|e| self.places[e.ends[0] as usize]);
        let reference = ends().sum::<Vector>() / self.edges.len() as f64;
        self.feet.clear();
        let foot = |p: &Plane| p.normal * (p.offset - p.normal.dot(&reference));
        self.feet.extend(a.planes.iter().map(foot));
        self.feet.extend(self.planes.iter().map(foot));
        let (mut sums, mut outline) = (Sums::default(), Outline::default());
        for e in &self.edges {
            let [p, q] = e.ends.map(|i| self.places[i as usize] - reference);
            let [left, right] = e.faces.map(|f| self.feet[f as usize]);
            sums.add_edge(p, q, left, right);
            let [p, q] = match e.faces.map(|f| f < first_planes) {
                [true, false] => [p, q],
                [false, true] => [q, p],
                _ => continue,
            };
            sums.add_curve(p, q);
            if self.pivots {
                outline.add(p, q);
            }
        }
        if sums.volume > 0.0 {
            let to_world = |x: Vector| (at_a.to_world((reference + x).into()), at_a.orientation * x);
            out.push(sums.overlap(&outline, to_world, apart.try_normalize(0.0).unwrap_or(Vector::x())));
        }
    }

    /// Keeps what lies behind a plane, which gets the number `face`; answers whether anything does.
    fn cut(&mut self, plane: Plane, face: u32) -> bool {
        self.heights.clear();
        self.heights.extend(self.places.iter().map(|x| plane.normal.dot(x) - plane.offset));
        if self.heights.iter().all(|h| *h <= 0.0) {
            return true;
        }
        self.numbers.clear();
        let mut behind = 0;
        for height in &self.heights {
            self.numbers.push(behind);
            behind += u32::from(*height <= 0.0);
        }
        self.made.clear();
        self.fresh.clear();
        let mut kept = 0;
        for i in 0..self.edges.len() {
            let mut edge = self.edges[i];
            let [start, end] = edge.ends.map(|v| self.heights[v as usize]);
            let (leaves, enters) = (start <= 0.0, end <= 0.0);
            if !(leaves || enters) {
                continue;
            }
            let [p, q] = edge.ends.map(|v| self.places[v as usize]);
            edge.ends = edge.ends.map(|v| self.numbers[v as usize]);
            if enters != leaves {
                let place = behind + self.made.len() as u32;
                self.made.push(p + (q - p) * (start / (start - end)));
                edge.ends[usize::from(leaves)] = place;
                // The face on the right has the edge the other way round.
                self.border(edge.faces[0], place, leaves, face);
                self.border(edge.faces[1], place, !leaves, face);
            }
            self.edges[kept] = edge;
            kept += 1;
        }
        self.edges.truncate(kept);
        let mut heights = self.heights.iter();
        self.places.retain(|_| heights.next().is_some_and(|h| *h <= 0.0));
        self.places.extend_from_slice(&self.made);
        // Planes that all but coincide may cut a border more than twice.
        let mut next = 0;
        while let Some((of, place, leaves)) = self.later.get(next).copied() {
            self.border(of, place, leaves, face);
            next += 1;
        }
        self.later.clear();
        self.edges.extend_from_slice(&self.fresh);
        !self.edges.is_empty()
    }

    /// Notes that the border of face `of` leaves or enters what is kept behind plane `face`; where both are known, a new edge joins
    /// them.
    #[inline(always)]
    fn border(&mut self, of: u32, place: u32, leaves: bool, face: u32) {
        let open = &mut self.open[of as usize];
        let (own, other) = if leaves { (0, 1) } else { (1, 0) };
        if open[other] != NONE {
            let other = std::mem::replace(&mut open[other], NONE);
            let ends = if leaves { [place, other] } else { [other, place] };
            self.fresh.push(Edge { ends, faces: [of, face] });
        } else if open[own] == NONE {
            open[own] = place;
        } else {
            self.later.push((of, place, leaves));
        }
    }
}
