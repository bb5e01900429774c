//! Faces with the same three corners.
use super::super::topology::Sets;
use super::sheets::edges;

/// Splits faces into those to keep and copies to leave out, in order.
///
/// Of a face that is there several times the first is kept. Copies connected by edges that no other
/// face has make a patch. One that is bounded, and each of whose bounding edges belongs to an even
/// number of other faces, divides the inside of a surface that is closed without it: all its faces
/// are left out.
pub(super) fn split(faces: &[[u32; 3]]) -> (Vec<usize>, Vec<usize>) {
    let sorted = |f: usize| {
        let mut corners = faces[f];
        corners.sort_unstable();
        corners
    };
    let mut order: Vec<usize> = (0..faces.len()).collect();
    order.sort_by_key(|f| (sorted(*f), *f));
    let groups: Vec<&[usize]> = order.chunk_by(|f, g| sorted(*f) == sorted(*g)).collect();
    if groups.len() == faces.len() {
        return ((0..faces.len()).collect(), Vec::new());
    }
    // From here on each face once.
    let single: Vec<[u32; 3]> = groups.iter().map(|group| faces[group[0]]).collect();
    let several = |g: u32| groups[g as usize].len() > 1;
    let edges = edges(&single);
    let mut patches = Sets::new(single.len());
    let inner = |faces: &[(u32, bool)]| matches!(faces, [(f, _), (g, _)] if several(*f) && several(*g));
    for edge in edges.iter().filter(|e| inner(&e.faces)) {
        patches.join(edge.faces[0].0, edge.faces[1].0);
    }
    let (mut bounded, mut needed) = (vec![false; single.len()], vec![false; single.len()]);
    for edge in edges.iter().filter(|e| !inner(&e.faces)) {
        for (f, _) in edge.faces.iter().filter(|(f, _)| several(*f)) {
            let patch = patches.find(*f) as usize;
            bounded[patch] = true;
            needed[patch] |= edge.faces.len() % 2 == 0;
        }
    }
    let (mut kept, mut left_out) = (Vec::new(), Vec::new());
    for (g, group) in groups.iter().enumerate() {
        let patch = patches.find(g as u32) as usize;
        let divides = several(g as u32) && bounded[patch] && !needed[patch];
        let from = usize::from(!divides);
        kept.extend(&group[..from]);
        left_out.extend(&group[from..]);
    }
    kept.sort_unstable();
    left_out.sort_unstable();
    (kept, left_out)
}
