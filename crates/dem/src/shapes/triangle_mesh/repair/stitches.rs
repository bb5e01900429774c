//! Vertices in the middle of open edges.
use super::sheets::Edge;
use interfaces::Vector;
use rstar::primitives::GeomWithData;
use rstar::{AABB, RTree};
use std::collections::BTreeMap;

/// Faces divided where a vertex of an open edge lies on an open edge of theirs, within `tolerance`
/// \[m\], and those vertices; `None` if there are none.
pub(super) fn stitch(
    vertices: &[[f64; 3]],
    faces: &[[u32; 3]],
    edges: &[Edge],
    tolerance: f64,
) -> Option<(Vec<[u32; 3]>, Vec<u32>)> {
    let open: Vec<&Edge> = edges.iter().filter(|e| e.faces.len() == 1).collect();
    let mut ends: Vec<u32> = open.iter().flat_map(|e| e.ends).collect();
    ends.sort_unstable();
    ends.dedup();
    let tree =
        RTree::bulk_load(ends.into_iter().map(|v| GeomWithData::new(vertices[v as usize], v)).collect());
    let mut found: Vec<u32> = Vec::new();
    // Vertices on each edge of a face, in the face's direction.
    let mut divided: BTreeMap<u32, [Vec<u32>; 3]> = BTreeMap::new();
    for edge in open {
        let (f, up) = edge.faces[0];
        let [from, to] = if up { edge.ends } else { [edge.ends[1], edge.ends[0]] };
        let [a, b] = [from, to].map(|v| Vector::from(vertices[v as usize]));
        let length = (b - a).norm();
        let within = tolerance.max(1e-14 * length);
        let (low, high) = (a.inf(&b).add_scalar(-within), a.sup(&b).add_scalar(within));
        let mut on: Vec<(f64, u32)> = Vec::new();
        for near in tree.locate_in_envelope_intersecting(AABB::from_corners(low.into(), high.into())) {
            let place = Vector::from(*near.geom()) - a;
            let along = place.dot(&(b - a)) / length;
            let apart = (place - (b - a) * (along / length)).norm();
            if along > within && along < length - within && apart <= within {
                on.push((along, near.data));
            }
        }
        if on.is_empty() {
            continue;
        }
        on.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.cmp(&q.1)));
        let on: Vec<u32> = on.into_iter().map(|(_, v)| v).collect();
        found.extend(&on);
        let corner = (0..3).find(|i| faces[f as usize][*i] == from).unwrap_or(0);
        divided.entry(f).or_default()[corner] = on;
    }
    if found.is_empty() {
        return None;
    }
    let mut all = faces.to_vec();
    for (f, on) in divided {
        let mut pieces = Vec::new();
        divide(faces[f as usize], on, &mut pieces);
        all[f as usize] = pieces[0];
        all.extend(&pieces[1..]);
    }
    Some((all, found))
}

/// Divides a face at vertices on its edges ab, bc and ca.
fn divide([a, b, c]: [u32; 3], [ab, bc, ca]: [Vec<u32>; 3], pieces: &mut Vec<[u32; 3]>) {
    match ab.split_first() {
        Some((m, rest)) => {
            divide([a, *m, c], [Vec::new(), Vec::new(), ca], pieces);
            divide([*m, b, c], [rest.to_vec(), bc, Vec::new()], pieces);
        }
        None if bc.is_empty() && ca.is_empty() => pieces.push([a, b, c]),
        None => divide([b, c, a], [bc, ca, ab], pieces),
    }
}
