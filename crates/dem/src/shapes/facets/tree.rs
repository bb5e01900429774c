//! A tree of boxes around triangles.
use interfaces::Vector;

/// A leaf holds at most so many triangles.
const MOST: usize = 4;

/// A box around the triangles `first..first + count`; `count` is zero where two boxes follow instead: the next in the list, and
/// that with number `first`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) centre: Vector,
    pub(crate) half: Vector,
    pub(crate) first: u32,
    pub(crate) count: u32,
}

/// Sorts the triangles into the tree's order.
pub(super) fn build(vertices: &[Vector], faces: &mut [[u32; 3]]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(faces.len());
    if !faces.is_empty() {
        halve(vertices, faces, 0, &mut nodes);
    }
    nodes
}

fn halve(vertices: &[Vector], faces: &mut [[u32; 3]], first: u32, nodes: &mut Vec<Node>) {
    let start = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
    let corners = faces.iter().flatten().map(|&v| vertices[v as usize]);
    let (low, high) = corners.fold(start, |(l, h), x| (l.inf(&x), h.sup(&x)));
    let (own, count) = (nodes.len(), faces.len() as u32);
    // A hair wider, for the rounding of centre and half.
    let half = 0.5 * (high - low) + 1e-15 * low.abs().sup(&high.abs());
    nodes.push(Node { centre: 0.5 * (low + high), half, first, count });
    if faces.len() <= MOST {
        return;
    }
    let centre = |f: &[u32; 3], axis: usize| f.iter().map(|&v| vertices[v as usize][axis]).sum::<f64>();
    let spread = |axis: usize| {
        let places = || faces.iter().map(|f| centre(f, axis));
        places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min)
    };
    let spreads = [spread(0), spread(1), spread(2)];
    let axis = (1..3).fold(0, |best, a| if spreads[a] > spreads[best] { a } else { best });
    let middle = faces.len() / 2;
    faces.select_nth_unstable_by(middle, |f, g| centre(f, axis).total_cmp(&centre(g, axis)));
    let (below, above) = faces.split_at_mut(middle);
    halve(vertices, below, first, nodes);
    let second = nodes.len() as u32;
    halve(vertices, above, first + middle as u32, nodes);
    (nodes[own].first, nodes[own].count) = (second, 0);
}
