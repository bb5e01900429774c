//! A tree of boxes around triangles, eight by eight.
use super::patches::{Patches, mean_normal, reach, within};
use interfaces::Vector;

/// Boxes that a node holds.
pub(crate) const WIDTH: usize = 8;

/// Eight boxes, each around a node or a triangle, of numbers rounded outwards. Missing ones are empty: they meet nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) low: [[f32; WIDTH]; 3],
    pub(crate) high: [[f32; WIDTH]; 3],
    /// The nodes in the boxes; of a leaf, the first of its triangles, repeated.
    pub(crate) children: [u32; WIDTH],
    pub(crate) is_leaf: bool,
    /// The number of the boxes along the surface around the nodes in this one; none of a leaf.
    pub(crate) patches: u32,
}

impl Default for Node {
    fn default() -> Self {
        let (low, high) = ([[f32::INFINITY; WIDTH]; 3], [[f32::NEG_INFINITY; WIDTH]; 3]);
        Self { low, high, children: [u32::MAX; WIDTH], is_leaf: false, patches: u32::MAX }
    }
}

impl Node {
    fn set(&mut self, slot: usize, low: Vector, high: Vector) {
        for a in 0..3 {
            (self.low[a][slot], self.high[a][slot]) = (below(low[a]), above(high[a]));
        }
    }
}

/// The greatest single-precision number not above `x`.
fn below(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) > x { near.next_down() } else { near }
}

/// The least one not below `x`.
fn above(x: f64) -> f32 {
    let near = x as f32;
    if f64::from(near) < x { near.next_up() } else { near }
}

/// Sorts the triangles into the tree's order. The root is the first node, and every leaf begins at a multiple of [`WIDTH`]. The
/// first of the patches has the root alone, the others are those in a node each.
pub(super) fn build(vertices: &[Vector], faces: &mut [[u32; 3]]) -> (Vec<Node>, Vec<Patches>) {
    let mut nodes = Vec::with_capacity(faces.len() / 4 + 1);
    let mut patches = vec![Patches::default()];
    if !faces.is_empty() {
        grow(vertices, faces, 0, &mut nodes, &mut patches);
        let corners = |f: &[u32; 3]| f.map(|v| vertices[v as usize]);
        patches[0].set(0, 0, faces.iter().map(corners));
    }
    (nodes, patches)
}

/// Adds a node around these faces and all below it; answers its number.
fn grow(
    vertices: &[Vector],
    faces: &mut [[u32; 3]],
    first: usize,
    nodes: &mut Vec<Node>,
    patches: &mut Vec<Patches>,
) -> u32 {
    let own = nodes.len();
    nodes.push(Node::default());
    let corners = |f: &[u32; 3]| f.map(|v| vertices[v as usize]);
    if faces.len() <= WIDTH {
        nodes[own].is_leaf = true;
        nodes[own].children = [first as u32; WIDTH];
        for (slot, f) in faces.iter().enumerate() {
            let [a, b, c] = corners(f);
            nodes[own].set(slot, a.inf(&b).inf(&c), a.sup(&b).sup(&c));
        }
        return own as u32;
    }
    // Halved three times, into parts as full as they can be, so that all nodes but the last of each level have eight.
    let mut unit = WIDTH;
    while unit * WIDTH < faces.len() {
        unit *= WIDTH;
    }
    let mut ends = vec![0, faces.len()];
    for _ in 0..3 {
        for i in (0..ends.len() - 1).rev() {
            let (start, end) = (ends[i], ends[i + 1]);
            let middle = start + ((end - start) / 2).next_multiple_of(unit);
            if end - start > unit && middle < end {
                split(vertices, &mut faces[start..end], middle - start);
                ends.insert(i + 1, middle);
            }
        }
    }
    let inner = patches.len();
    nodes[own].patches = inner as u32;
    patches.push(Patches::default());
    for (slot, pair) in ends.windows(2).enumerate() {
        let part = &mut faces[pair[0]..pair[1]];
        let start = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
        let around = |(low, high): (Vector, Vector), x: Vector| (low.inf(&x), high.sup(&x));
        let (low, high) = part.iter().flat_map(corners).fold(start, around);
        let child = grow(vertices, part, first + pair[0], nodes, patches);
        nodes[own].set(slot, low, high);
        nodes[own].children[slot] = child;
        patches[inner].set(slot, child, part.iter().map(corners));
    }
    own as u32
}

/// At most so many faces are nearly flat.
const FLAT: usize = WIDTH * WIDTH;
/// Directions within the surface in which these may be parted.
const DIRECTIONS: usize = 8;

/// Puts the lower faces along a direction before number `middle`: of many faces along the axis on which their centres are spread most,
/// of a few along that which leaves the smallest rectangles along the surface around both parts.
fn split(vertices: &[Vector], faces: &mut [[u32; 3]], middle: usize) {
    let centre = |f: &[u32; 3]| f.iter().map(|&v| vertices[v as usize]).sum::<Vector>();
    let part = |faces: &mut [[u32; 3]], along: Vector| {
        faces.select_nth_unstable_by(middle, |f, g| along.dot(&centre(f)).total_cmp(&along.dot(&centre(g))));
    };
    if faces.len() > FLAT {
        let start = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
        let (low, high) = faces.iter().map(centre).fold(start, |(l, h), c| (l.inf(&c), h.sup(&c)));
        part(faces, Vector::ith((high - low).imax(), 1.0));
        return;
    }
    let corners =
        |faces: &[[u32; 3]]| faces.as_flattened().iter().map(|&v| vertices[v as usize]).collect::<Vec<_>>();
    let [u, v, _] = within(mean_normal(faces.iter().map(|f| f.map(|v| vertices[v as usize]))));
    let mut best = (f64::INFINITY, u);
    for k in 0..DIRECTIONS {
        let (sin, cos) = (std::f64::consts::PI * k as f64 / DIRECTIONS as f64).sin_cos();
        let (along, across) = (cos * u + sin * v, cos * v - sin * u);
        part(faces, along);
        let (below, above) = faces.split_at(middle);
        let area: f64 = [below, above]
            .map(|part| {
                let corners = corners(part);
                let length = |axis: &Vector| {
                    let [low, high] = reach(corners.iter().copied(), axis);
                    high - low
                };
                length(&along) * length(&across)
            })
            .iter()
            .sum();
        if area < best.0 {
            best = (area, along);
        }
    }
    part(faces, best.1);
}
