//! Faces that cross one another.
use super::error::{MeshError, named};
use super::meeting::{Place, meet};
use crate::shapes::hull::predicate;
use interfaces::Point;
use parry3d::bounding_volume::Aabb;
use parry3d::partitioning::{Bvh, BvhBuildStrategy, BvhNode};
use std::cmp::Ordering;
use std::collections::HashMap;

/// The search ends when so many pairs are found: a heap of triangles has too many to count.
const MOST: usize = 100_000;

/// A tree of the boxes around faces, with the boxes themselves.
pub(crate) struct FaceTree {
    pub(crate) tree: Bvh,
    boxes: Vec<Aabb>,
}

impl FaceTree {
    /// Of faces with vertices `at` these places.
    pub(crate) fn new(faces: &[[u32; 3]], at: impl Fn(u32) -> Point) -> Self {
        let around = |f: &[u32; 3]| {
            let [a, b, c] = f.map(&at);
            let (low, high) = (a.inf(&b).inf(&c), a.sup(&b).sup(&c));
            Aabb::new(<[f64; 3]>::from(low).into(), <[f64; 3]>::from(high).into())
        };
        let boxes: Vec<Aabb> = faces.iter().map(around).collect();
        Self { tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes), boxes }
    }

    /// The fault that some faces cross, named by their numbers.
    pub(crate) fn crossings(
        &self,
        faces: &[[u32; 3]],
        number: &[usize],
        at: impl Fn(u32) -> Point,
    ) -> Option<MeshError> {
        let pairs = self.crossing_pairs(faces, number, at);
        let (count, all) = (pairs.len(), pairs.len() < MOST);
        (count > 0).then(|| MeshError::SelfIntersecting { count, all, faces: named(pairs) })
    }

    /// The pairs of faces, by their numbers, that have points in common other than those of corners
    /// and edges that they share. No face is degenerate.
    pub(crate) fn crossing_pairs(
        &self,
        faces: &[[u32; 3]],
        number: &[usize],
        at: impl Fn(u32) -> Point,
    ) -> Vec<[usize; 2]> {
        // By a power of two, which commits no rounding.
        let largest = faces.as_flattened().iter().map(|v| at(*v).coords.amax()).fold(0.0, f64::max);
        let scale = 2.0_f64.powi(-largest.max(1e-300).log2().ceil() as i32);
        // Vertices at one place are one: that they are two is another fault.
        let faces = &one_per_place(faces, &at);
        let place = |v: u32| -> Place { (at(v) * scale).map(predicate).into() };
        let mut pairs: Vec<[usize; 2]> = Vec::new();
        for (f, around) in self.boxes.iter().enumerate() {
            let leaf = BvhNode::leaf(*around, f as u32);
            for g in self.tree.leaves(|node| node.intersects(&leaf)) {
                if g as usize > f && meet(faces[f], faces[g as usize], place) {
                    pairs.push([number[f], number[g as usize]]);
                }
            }
            if pairs.len() >= MOST {
                break;
            }
        }
        pairs.sort_unstable();
        pairs
    }
}

/// The faces, the vertices at one place replaced by the first of them.
fn one_per_place(faces: &[[u32; 3]], at: impl Fn(u32) -> Point) -> Vec<[u32; 3]> {
    let mut first: HashMap<u32, u32> = HashMap::new();
    for [v, w] in coincident(faces, at) {
        let root = first.get(&v).copied().unwrap_or(v);
        first.insert(w, root);
    }
    faces.iter().map(|f| f.map(|v| first.get(&v).copied().unwrap_or(v))).collect()
}

/// Vertices of faces at the same place: each with the one before it there.
pub(crate) fn coincident(faces: &[[u32; 3]], at: impl Fn(u32) -> Point) -> Vec<[u32; 2]> {
    let mut used: Vec<u32> = faces.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    // 0 and −0 are one place.
    let mut places: Vec<([f64; 3], u32)> =
        used.iter().map(|v| (at(*v).coords.map(|x| x + 0.0).into(), *v)).collect();
    let order = |a: &[f64; 3], b: &[f64; 3]| {
        a.iter().zip(b).map(|(a, b)| a.total_cmp(b)).find(|o| o.is_ne()).unwrap_or(Ordering::Equal)
    };
    places.sort_by(|(a, v), (b, w)| order(a, b).then(v.cmp(w)));
    places.windows(2).filter(|p| p[0].0 == p[1].0).map(|p| [p[0].1, p[1].1]).collect()
}
