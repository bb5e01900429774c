//! A tree of boxes around triangles, eight by eight.
use super::leaf::Leaf;
use interfaces::Vector;
use nalgebra::Matrix3;

/// Boxes that a node holds.
pub(crate) const WIDTH: usize = 8;

/// Eight boxes, each around a node or a triangle, of numbers rounded outwards. Missing ones are empty: they meet nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub(crate) low: [[f32; WIDTH]; 3],
    pub(crate) high: [[f32; WIDTH]; 3],
    /// The box around all.
    low_all: [f32; 3],
    high_all: [f32; 3],
    /// The nodes in the boxes; of a leaf, the first of its triangles, repeated.
    pub(crate) children: [u32; WIDTH],
    pub(crate) is_leaf: bool,
}

impl Default for Node {
    fn default() -> Self {
        let (low, high) = ([[f32::INFINITY; WIDTH]; 3], [[f32::NEG_INFINITY; WIDTH]; 3]);
        let (low_all, high_all) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        Self { low, high, low_all, high_all, children: [u32::MAX; WIDTH], is_leaf: false }
    }
}

impl Node {
    fn set(&mut self, slot: usize, low: Vector, high: Vector) {
        for a in 0..3 {
            (self.low[a][slot], self.high[a][slot]) = (below(low[a]), above(high[a]));
        }
        self.set_all();
    }
    #[inline(always)]
    fn set_all(&mut self) {
        for a in 0..3 {
            (self.low_all[a], self.high_all[a]) = (f32::INFINITY, f32::NEG_INFINITY);
            for i in 0..WIDTH {
                self.low_all[a] =
                    if self.low[a][i] < self.low_all[a] { self.low[a][i] } else { self.low_all[a] };
                self.high_all[a] =
                    if self.high[a][i] > self.high_all[a] { self.high[a][i] } else { self.high_all[a] };
            }
        }
    }
    /// How far these boxes are from another one, along the axis on which they are farthest; not positive where they meet.
    #[inline(always)]
    fn gaps(&self, low: [f32; 3], high: [f32; 3]) -> [f32; WIDTH] {
        let mut gaps = [f32::NEG_INFINITY; WIDTH];
        for a in 0..3 {
            for i in 0..WIDTH {
                gaps[i] =
                    more_single(gaps[i], more_single(self.low[a][i] - high[a], low[a] - self.high[a][i]));
            }
        }
        gaps
    }
    /// How far these boxes are from the box around all of `other`'s.
    #[inline(always)]
    pub(crate) fn gaps_to_all(&self, other: &Self) -> [f32; WIDTH] {
        self.gaps(other.low_all, other.high_all)
    }
    /// How far these boxes are from box `j` of `other`.
    #[inline(always)]
    pub(crate) fn gaps_to(&self, other: &Self, j: usize) -> [f32; WIDTH] {
        let [low, high] = [&other.low, &other.high].map(|side| [side[0][j], side[1][j], side[2][j]]);
        self.gaps(low, high)
    }

    /// The boxes around these boxes, turned and shifted; `extent` is a length that none of their places exceeds.
    #[inline(always)]
    pub(crate) fn moved(&self, turn: &Matrix3<f64>, shift: &Vector, extent: f64) -> Self {
        let mut moved = Self { children: self.children, is_leaf: self.is_leaf, ..Self::default() };
        // For rounding to single precision.
        let slack = 1e-6 * (extent as f32 + shift.amax() as f32);
        for a in 0..3 {
            let (row, s) = ([0, 1, 2].map(|k| 0.5 * turn[(a, k)] as f32), shift[a] as f32);
            for i in 0..WIDTH {
                let (mut centre, mut half) = (s, slack);
                for k in 0..3 {
                    centre += row[k] * (self.high[k][i] + self.low[k][i]);
                    half += row[k].abs() * (self.high[k][i] - self.low[k][i]);
                }
                // Of an empty box the half is −∞ or no number.
                let filled = half > 0.0;
                moved.low[a][i] = if filled { centre - half } else { f32::INFINITY };
                moved.high[a][i] = if filled { centre + half } else { f32::NEG_INFINITY };
            }
        }
        moved.set_all();
        moved
    }

    /// The boxes around the triangles of a leaf.
    #[inline(always)]
    pub(crate) fn around(&self, leaf: &Leaf) -> Self {
        let mut around = *self;
        let [p, q, r] = &leaf.corners;
        for a in 0..3 {
            for i in 0..WIDTH {
                let (low, high) =
                    (less(less(p[a][i], q[a][i]), r[a][i]), more(more(p[a][i], q[a][i]), r[a][i]));
                let filled = self.low[a][i] <= self.high[a][i];
                // A rounding of 2⁻²⁴, outwards.
                let (low, high) = (low - low.abs() * 1e-7, high + high.abs() * 1e-7);
                around.low[a][i] = if filled { low as f32 } else { f32::INFINITY };
                around.high[a][i] = if filled { high as f32 } else { f32::NEG_INFINITY };
            }
        }
        around.set_all();
        around
    }
}

/// The less of two numbers that are not NaN: one instruction.
#[inline(always)]
fn less(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The greater of two numbers that are not NaN.
#[inline(always)]
pub(super) fn more(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[inline(always)]
fn more_single(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
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

/// Sorts the triangles into the tree's order; the root is the first node, and every leaf begins at a multiple of [`WIDTH`].
pub(super) fn build(vertices: &[Vector], faces: &mut [[u32; 3]]) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(faces.len() / 4 + 1);
    if !faces.is_empty() {
        grow(vertices, faces, 0, &mut nodes);
    }
    nodes
}

/// Adds a node around these faces and all below it; answers its number.
fn grow(vertices: &[Vector], faces: &mut [[u32; 3]], first: usize, nodes: &mut Vec<Node>) -> u32 {
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
    // Halved three times, so that all leaves but the last are full.
    let mut ends = vec![0, faces.len()];
    for _ in 0..3 {
        for i in (0..ends.len() - 1).rev() {
            let (start, end) = (ends[i], ends[i + 1]);
            let middle = start + ((end - start) / 2).next_multiple_of(WIDTH);
            if end - start > WIDTH && middle < end {
                split(vertices, &mut faces[start..end], middle - start);
                ends.insert(i + 1, middle);
            }
        }
    }
    for (slot, pair) in ends.windows(2).enumerate() {
        let part = &mut faces[pair[0]..pair[1]];
        let start = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
        let around = |(low, high): (Vector, Vector), x: Vector| (low.inf(&x), high.sup(&x));
        let (low, high) = part.iter().flat_map(corners).fold(start, around);
        let child = grow(vertices, part, first + pair[0], nodes);
        nodes[own].set(slot, low, high);
        nodes[own].children[slot] = child;
    }
    own as u32
}

/// Puts the lower faces, along the axis on which their centres are spread most, before number `middle`.
fn split(vertices: &[Vector], faces: &mut [[u32; 3]], middle: usize) {
    let centre = |f: &[u32; 3], axis: usize| f.iter().map(|&v| vertices[v as usize][axis]).sum::<f64>();
    let spread = |axis: usize| {
        let places = || faces.iter().map(|f| centre(f, axis));
        places().fold(f64::NEG_INFINITY, f64::max) - places().fold(f64::INFINITY, f64::min)
    };
    let spreads = [spread(0), spread(1), spread(2)];
    let axis = (1..3).fold(0, |best, a| if spreads[a] > spreads[best] { a } else { best });
    faces.select_nth_unstable_by(middle, |f, g| centre(f, axis).total_cmp(&centre(g, axis)));
}
