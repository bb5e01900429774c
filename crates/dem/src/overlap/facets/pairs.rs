//! Which faces cross, and where.
use super::Bodies;
use super::body::Body;
use super::crossings::{Crossings, Segment, Straddling};
use super::signs::{Side, is_behind, passes};
use crate::shapes::{Leaf, WIDTH, bits};
use interfaces::Vector;
use pulp::{Arch, Simd, WithSimd};

impl Bodies<'_> {
    /// Walks down both trees where their boxes meet, and finds where the faces there cross.
    pub(super) fn find_pairs(&mut self, stack: &mut Vec<[u32; 2]>, crossings: &mut Crossings) {
        Arch::new().dispatch(Walk { bodies: self, stack, crossings });
    }
}

/// The walk down both trees, in the widest vectors that the processor has.
struct Walk<'w, 'b> {
    bodies: &'w mut Bodies<'b>,
    stack: &'w mut Vec<[u32; 2]>,
    crossings: &'w mut Crossings,
}

impl WithSimd for Walk<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { bodies: Bodies { first, second }, stack, crossings } = self;
        let (tree_a, tree_b) = (&first.facets.tree, &second.facets.tree);
        let shift = first.moved.map_or(0.0, |(_, shift)| shift.amax());
        // normal·(x − a) is rounded by less than this times the square of the face's size: with sums and products rounded by ε
        // each, 48 ε of that and of the largest coordinate.
        let round_off = 64.0 * f64::EPSILON * (first.facets.radius + second.facets.radius + shift);
        stack.clear();
        // Pairs of boxes, each by eight times the number of its patches, and its place there.
        stack.push([0, 0]);
        first.prepare_patches(0);
        while let Some([m, n]) = stack.pop() {
            let (own, other) = (first.patches(m / WIDE), second.patches(n / WIDE));
            let (i, j) = ((m % WIDE) as usize, (n % WIDE) as usize);
            let (a, b) = (own.children[i], other.children[j]);
            let (node_a, node_b) = (&tree_a[a as usize], &tree_b[b as usize]);
            if node_a.is_leaf && node_b.is_leaf {
                let leaves = [node_a.children[0] / WIDE, node_b.children[0] / WIDE];
                cross_leaves(first, second, leaves, round_off, crossings);
                continue;
            }
            let (own, other) = (own.patch(i), other.patch(j));
            if node_b.is_leaf || (!node_a.is_leaf && own.size() > other.size()) {
                first.prepare_patches(node_a.patches);
                let meeting = first.patches(node_a.patches).meeting(&other);
                stack.extend(ones(meeting).map(|i| [node_a.patches * WIDE + i, n]));
            } else {
                let meeting = second.patches(node_b.patches).meeting(&own);
                stack.extend(ones(meeting).map(|j| [m, node_b.patches * WIDE + j]));
            }
        }
    }
}

const WIDE: u32 = WIDTH as u32;

/// The numbers of the bits that are set.
#[inline(always)]
fn ones(mut bits: u32) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let next = (bits != 0).then_some(bits.trailing_zeros());
        bits &= bits.wrapping_sub(1);
        next
    })
}

/// Finds where the faces of two leaves cross.
#[inline(always)]
fn cross_leaves(
    first: &mut Body<'_>,
    second: &mut Body<'_>,
    [a, b]: [u32; 2],
    round_off: f64,
    crossings: &mut Crossings,
) {
    first.prepare_leaf(a);
    let (own, other) = (first.leaf(a), second.leaf(b));
    if own.meeting_any(other) == 0 {
        return;
    }
    for j in ones(other.meeting_any(own)) {
        let (own, other) = (first.leaf(a), second.leaf(b));
        let near = own.meeting(other, j as usize);
        if near == 0 {
            continue;
        }
        let sides = Sides::new(own, other, j as usize, round_off);
        for i in ones(near & sides.mixed) {
            cross(first, second, [[a, i], [b, j]], sides.of(i as usize), crossings);
        }
    }
}

/// How the faces of a leaf and a face of the other body's lie to one another.
struct Sides {
    /// The other's corners over our faces, and ours over the other face.
    over_own: [[f64; WIDTH]; 3],
    over_other: [[f64; WIDTH]; 3],
    /// What these are off by at most.
    doubts: [f64; WIDTH],
    doubt: f64,
    /// Faces that may cross the other one, a bit each: neither has all corners on one side of the other.
    mixed: u32,
}

impl Sides {
    /// Of every face of `own` and face `j` of the `other` leaf.
    #[inline(always)]
    fn new(own: &Leaf, other: &Leaf, j: usize, round_off: f64) -> Self {
        let n = [other.normals[0][j], other.normals[1][j], other.normals[2][j]];
        let (height, doubt) = (other.heights[j], other.sizes[j] * round_off);
        let [mut over_own, mut over_other] = [[[0.0; WIDTH]; 3]; 2];
        let mut doubts = [0.0; WIDTH];
        for k in 0..3 {
            let ours = &own.corners[k];
            for i in 0..WIDTH {
                over_other[k][i] = n[0] * ours[0][i] + n[1] * ours[1][i] + n[2] * ours[2][i] - height;
            }
        }
        for k in 0..3 {
            let theirs = [other.corners[k][0][j], other.corners[k][1][j], other.corners[k][2][j]];
            for i in 0..WIDTH {
                over_own[k][i] = own.normals[0][i] * theirs[0]
                    + own.normals[1][i] * theirs[1]
                    + own.normals[2][i] * theirs[2]
                    - own.heights[i];
            }
        }
        let mut gaps = [0.0; WIDTH];
        for i in 0..WIDTH {
            doubts[i] = own.sizes[i] * round_off;
            let low = |h: &[[f64; WIDTH]; 3]| less(less(h[0][i], h[1][i]), h[2][i]);
            let high = |h: &[[f64; WIDTH]; 3]| more(more(h[0][i], h[1][i]), h[2][i]);
            let gap = more(
                more(low(&over_own), -high(&over_own)) - doubts[i],
                more(low(&over_other), -high(&over_other)) - doubt,
            );
            gaps[i] = gap as f32;
        }
        Self { over_own, over_other, doubts, doubt, mixed: bits(gaps) }
    }

    /// Which of the other's corners lie behind face `i`, and which of its behind the other, a bit each; none if that is not sure.
    #[inline(always)]
    fn of(&self, i: usize) -> Option<[u32; 2]> {
        let (mut sure, mut behind) = (true, [0; 2]);
        for k in 0..3 {
            let (over_own, over_other) = (self.over_own[k][i], self.over_other[k][i]);
            behind[0] |= u32::from(over_own < 0.0) << k;
            behind[1] |= u32::from(over_other < 0.0) << k;
            sure &= over_own.abs() > self.doubts[i] && over_other.abs() > self.doubt;
        }
        sure.then_some(behind)
    }
}

/// A triangle that crosses the plane of another: its corner that is alone on one side, and those after and before it.
#[derive(Clone, Copy)]
struct Split {
    alone: usize,
    corners: [Vector; 3],
    /// Does the lone corner lie behind the plane?
    is_behind: bool,
}

impl Split {
    /// Of a triangle of a leaf; `behind` has a bit for every corner behind the plane.
    #[inline(always)]
    fn new(leaf: &Leaf, lane: usize, behind: u32) -> Self {
        let (alone, is_behind) = match behind {
            0b001 => (0, true),
            0b010 => (1, true),
            0b100 => (2, true),
            0b110 => (0, false),
            0b101 => (1, false),
            _ => (2, false),
        };
        let corner = |k: usize| {
            Vector::new(leaf.corners[k][0][lane], leaf.corners[k][1][lane], leaf.corners[k][2][lane])
        };
        Self { alone, corners: [corner(alone), corner(NEXT[alone]), corner(NEXT[NEXT[alone]])], is_behind }
    }
    /// The ends of the edges along which the triangle's border leaves (`true`) or enters what lies behind the plane, that behind it
    /// first.
    #[inline(always)]
    fn ends(&self, leaves: bool) -> [Vector; 2] {
        // From the lone corner on, or back to it.
        let other = self.corners[if leaves == self.is_behind { 1 } else { 2 }];
        if self.is_behind { [self.corners[0], other] } else { [other, self.corners[0]] }
    }
    /// That edge, of face `f`.
    #[inline(always)]
    fn edge(&self, own: &Body<'_>, f: u32, leaves: bool) -> Straddling {
        let on = leaves == self.is_behind;
        let edge = own.facets.faces[f as usize].edges[if on { self.alone } else { NEXT[NEXT[self.alone]] }];
        let forward = own.facets.edges[edge as usize].left == f;
        let [behind, ahead] = self.ends(leaves);
        Straddling { edge, behind, ahead, leaves: forward == leaves }
    }
}

const NEXT: [usize; 3] = [1, 2, 0];

/// Finds the segment in which two faces cross, if they do (after Devillers & Guigue 2002, INRIA report 4488). Each is given by its
/// leaf and the number in it, with the corners that lie behind the other, if that is sure.
#[inline(always)]
fn cross(
    first: &mut Body<'_>,
    second: &mut Body<'_>,
    at: [[u32; 2]; 2],
    sides: Option<[u32; 2]>,
    crossings: &mut Crossings,
) {
    let [[leaf_a, i], [leaf_b, j]] = at;
    let (f, g) = (leaf_a * WIDE + i, leaf_b * WIDE + j);
    let (own, other) = (first.leaf(leaf_a), second.leaf(leaf_b));
    let [behind_a, behind_b] = match sides {
        Some(sides) => sides,
        None => exact_sides(own.triangle(i as usize), other.triangle(j as usize)),
    };
    let same = |behind: u32| behind == 0 || behind == 0b111;
    if same(behind_a) || same(behind_b) {
        return;
    }
    let (a, b) = (Split::new(own, i as usize, behind_b), Split::new(other, j as usize, behind_a));
    // Along n_a × n_b, the first face's border leaves at the low end and enters at the high one; the second's, the other way.
    let order = Passes::new(&a, &b);
    if !order.before(true, true) || order.before(false, false) {
        return;
    }
    let (corner_a, n_a) = (own.corner(i as usize), own.normal(i as usize));
    let (corner_b, n_b) = (other.corner(j as usize), other.normal(j as usize));
    let low = if order.before(true, false) {
        crossings.get(second, &b.edge(second, g, false), f, corner_a, n_a)
    } else {
        crossings.get(first, &a.edge(first, f, true), g, corner_b, n_b)
    };
    let high = if order.before(false, true) {
        crossings.get(first, &a.edge(first, f, false), g, corner_b, n_b)
    } else {
        crossings.get(second, &b.edge(second, g, true), f, corner_a, n_a)
    };
    let (f, g) = (first.cut(f, corner_a, n_a), second.cut(g, corner_b, n_b));
    crossings.segments.push(Segment { first: f, second: g, ends: [low, high] });
}

/// Which of the second triangle's corners lie behind the first, and which of the first's behind the second, a bit each.
#[cold]
fn exact_sides(a: [Vector; 3], b: [Vector; 3]) -> [u32; 2] {
    let bits = |behind: [bool; 3]| (0..3).map(|k| u32::from(behind[k]) << k).sum();
    [bits(b.map(|p| is_behind(Side::Second, p, a))), bits(a.map(|p| is_behind(Side::First, p, b)))]
}

/// How the edges from the lone corners of two triangles pass one another.
struct Passes<'s> {
    first: &'s Split,
    second: &'s Split,
    /// Of the first's edges on and back, then of the second's: from the lone corner.
    near: [[f64; 2]; 2],
    doubts: [[f64; 2]; 2],
    sign: f64,
}

impl<'s> Passes<'s> {
    #[inline(always)]
    fn new(first: &'s Split, second: &'s Split) -> Self {
        let ([p, on, back], [q, others_on, others_back]) = (&first.corners, &second.corners);
        let (on, back, others_on, others_back, between) =
            (on - p, back - p, others_on - q, others_back - q, q - p);
        let size = |v: &Vector| v.x.abs() + v.y.abs() + v.z.abs();
        // Sums and products are rounded by ε each.
        let (moment_on, size_on) =
            (others_on.cross(&between), 64.0 * f64::EPSILON * size(&others_on) * size(&between));
        let (moment_back, size_back) =
            (others_back.cross(&between), 64.0 * f64::EPSILON * size(&others_back) * size(&between));
        let near =
            [[on.dot(&moment_on), on.dot(&moment_back)], [back.dot(&moment_on), back.dot(&moment_back)]];
        let doubts =
            [[size(&on) * size_on, size(&on) * size_back], [size(&back) * size_on, size(&back) * size_back]];
        let sign = if first.is_behind == second.is_behind { 1.0 } else { -1.0 };
        Self { first, second, near, doubts, sign }
    }
    /// Does the edge where the first's border leaves, or enters, come before that where the second's does?
    #[inline(always)]
    fn before(&self, leaves: bool, others_leaves: bool) -> bool {
        let (u, v) = (
            usize::from(leaves != self.first.is_behind),
            usize::from(others_leaves != self.second.is_behind),
        );
        let near = self.near[u][v];
        if near.abs() > self.doubts[u][v] {
            return self.sign * near < 0.0;
        }
        let ([p, q], [r, s]) = (self.first.ends(leaves), self.second.ends(others_leaves));
        passes(p, q, r, s) < 0.0
    }
}

#[inline(always)]
fn less(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
fn more(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
