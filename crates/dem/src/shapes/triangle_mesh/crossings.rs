//! Faces that cross one another.
use super::box_tree::BoxTree;
use super::error::{MeshError, named};
use super::meeting::{Place, meet};
use crate::shapes::hull::predicate;
use interfaces::Vector;
use std::cmp::Ordering;
use std::collections::HashMap;

/// The search ends when so many pairs are found: a heap of triangles has too many to count.
const MOST: usize = 100_000;
/// As many faces around a vertex are compared pair by pair, for speed alone.
const FEW: usize = 8;

/// Faces in a tree of boxes, those around one vertex together.
pub(crate) struct FaceTree {
    pub(crate) tree: BoxTree,
    /// The faces, the vertices at one place replaced by the first of them.
    pub(crate) faces: Vec<[u32; 3]>,
    /// Places of all vertices, scaled for exact predicates.
    pub(crate) places: Vec<Place>,
    /// The vertex of each face that most faces have.
    pub(crate) hubs: Vec<u32>,
}

impl FaceTree {
    /// Tree of faces with these vertices.
    pub(crate) fn new(faces: &[[u32; 3]], vertices: &[[f64; 3]]) -> Self {
        let corners: Vec<[Vector; 3]> =
            faces.iter().map(|f| f.map(|v| Vector::from(vertices[v as usize]))).collect();
        let largest = corners.as_flattened().iter().map(|c| c.amax()).fold(0.0, f64::max);
        // By a power of two, which commits no rounding.
        let scale = 2.0_f64.powi(-largest.max(1e-300).log2().ceil() as i32);
        let places = vertices.iter().map(|v| v.map(|x| predicate(x * scale))).collect();
        // Vertices at one place are one: that they are two is another fault.
        let faces = one_per_place(faces, vertices);
        let mut counts = vec![0_u32; vertices.len()];
        faces.as_flattened().iter().for_each(|v| counts[*v as usize] += 1);
        let hub = |f: &[u32; 3]| f.iter().copied().max_by_key(|v| (counts[*v as usize], *v)).unwrap_or(0);
        let hubs: Vec<u32> = faces.iter().map(hub).collect();
        Self { tree: BoxTree::new(&corners, |f| hubs[f as usize]), faces, places, hubs }
    }

    /// The fault that some faces cross, named by their numbers.
    pub(crate) fn crossings(&self, number: &[usize]) -> Option<MeshError> {
        let pairs = self.crossing_pairs(number);
        let (count, all) = (pairs.len(), pairs.len() < MOST);
        (count > 0).then(|| MeshError::SelfIntersecting { count, all, faces: named(pairs) })
    }

    /// The pairs of faces, by their numbers, that have points in common other than those of corners
    /// and edges that they share. No face is degenerate.
    pub(crate) fn crossing_pairs(&self, number: &[usize]) -> Vec<[usize; 2]> {
        let mut pairs: Vec<[usize; 2]> = Vec::new();
        self.visit_candidates(|f, g| {
            let [f, g] = [f.min(g), f.max(g)].map(|f| f as usize);
            if meet(self.faces[f], self.faces[g], |v| self.places[v as usize]) {
                pairs.push([number[f], number[g]]);
            }
            pairs.len() < MOST
        });
        pairs.sort_unstable();
        pairs
    }

    /// Calls `visit` with all pairs of faces that may cross, and others near them, until it returns
    /// false.
    ///
    /// Two faces around one vertex cross if, seen from there, they are in one direction. So they
    /// are compared as arcs on a sphere around it: boxes around the faces themselves would all meet
    /// at the vertex.
    pub(crate) fn visit_candidates(&self, mut visit: impl FnMut(u32, u32) -> bool) {
        let mut goes_on = true;
        let mut once = |f, g| {
            goes_on = goes_on && visit(f, g);
            goes_on
        };
        self.tree.visit_pairs(&mut once);
        let mut sorted: Vec<u32> = (0..self.faces.len() as u32).collect();
        sorted.sort_by_key(|f| self.hubs[*f as usize]);
        for around in sorted.chunk_by(|f, g| self.hubs[*f as usize] == self.hubs[*g as usize]) {
            if around.len() <= FEW {
                let pairs = (0..around.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
                pairs.for_each(|(i, j)| {
                    once(around[i], around[j]);
                });
                continue;
            }
            let arcs: Vec<[Vector; 4]> = around.iter().map(|f| self.arc(*f)).collect();
            let tree = BoxTree::new(&arcs, |f| f);
            tree.visit_pairs(&mut |i, j| once(around[i as usize], around[j as usize]));
        }
    }

    /// Points whose hull holds the arc of a face on the unit sphere around its hub: the ends of the
    /// arc, and the points in which tangents at the ends meet that in the middle.
    fn arc(&self, face: u32) -> [Vector; 4] {
        let (corners, hub) = (self.faces[face as usize], self.hubs[face as usize]);
        let i = corners.iter().position(|v| *v == hub).unwrap_or(0);
        let at = |i: usize| Vector::from(self.places[corners[i % 3] as usize]);
        let ends = [1, 2].map(|k| (at(i + k) - at(i)).try_normalize(0.0));
        let [Some(u), Some(v)] = ends else { return WHOLE };
        // Nearly half a circle, of which round-off leaves the middle unknown.
        let Some(middle) = (u + v).try_normalize(0.1) else { return WHOLE };
        let tangents = |end: Vector| (end + middle) / (1.0 + end.dot(&middle));
        [u, v, tangents(u), tangents(v)]
    }
}

/// Corners of a tetrahedron around the unit sphere.
const WHOLE: [Vector; 4] = [
    Vector::new(2.0, 2.0, 2.0),
    Vector::new(2.0, -2.0, -2.0),
    Vector::new(-2.0, 2.0, -2.0),
    Vector::new(-2.0, -2.0, 2.0),
];

/// The faces, the vertices at one place replaced by the first of them.
fn one_per_place(faces: &[[u32; 3]], vertices: &[[f64; 3]]) -> Vec<[u32; 3]> {
    let mut first: HashMap<u32, u32> = HashMap::new();
    for [v, w] in coincident(faces, vertices) {
        let root = first.get(&v).copied().unwrap_or(v);
        first.insert(w, root);
    }
    if first.is_empty() {
        return faces.to_vec();
    }
    faces.iter().map(|f| f.map(|v| first.get(&v).copied().unwrap_or(v))).collect()
}

/// Vertices of faces at the same place: each with the one before it there.
pub(crate) fn coincident(faces: &[[u32; 3]], vertices: &[[f64; 3]]) -> Vec<[u32; 2]> {
    let mut used: Vec<u32> = faces.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    // 0 and −0 are one place.
    let mut places: Vec<([f64; 3], u32)> =
        used.iter().map(|v| (vertices[*v as usize].map(|x| x + 0.0), *v)).collect();
    let order = |a: &[f64; 3], b: &[f64; 3]| {
        a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
    };
    places.sort_by(|(a, v), (b, w)| order(a, b).then(v.cmp(w)));
    places.windows(2).filter(|p| p[0].0 == p[1].0).map(|p| [p[0].1, p[1].1]).collect()
}
