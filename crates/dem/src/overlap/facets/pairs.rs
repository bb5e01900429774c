//! Which faces cross, and where.
use super::Bodies;
use super::body::Body;
use super::crossings::{Crossings, Segment, Straddling};
use super::signs::{Side, is_behind, passes};
use crate::shapes::{WIDTH, Words, parts, slack};
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
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { bodies: Bodies { first, second }, stack, crossings } = self;
        let (tree_a, tree_b) = (&first.facets.tree, &second.facets.tree);
        let slack = slack(first.extent() + second.extent());
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
                cross_leaves(simd, (first, second), leaves, slack, crossings);
                continue;
            }
            let (own, other) = (own.patch(i), other.patch(j));
            if node_b.is_leaf || (!node_a.is_leaf && own.size() > other.size()) {
                first.prepare_patches(node_a.patches);
                let meeting = first.patches(node_a.patches).meeting(simd, &other);
                stack.extend(ones(meeting.into()).map(|i| [node_a.patches * WIDE + i, n]));
            } else {
                let meeting = second.patches(node_b.patches).meeting(simd, &own);
                stack.extend(ones(meeting.into()).map(|j| [m, node_b.patches * WIDE + j]));
            }
        }
    }
}

const WIDE: u32 = WIDTH as u32;

/// The numbers of the bits that are set.
#[inline(always)]
fn ones(mut bits: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let next = (bits != 0).then_some(bits.trailing_zeros());
        bits &= bits.wrapping_sub(1);
        next
    })
}

/// Finds where the faces of two leaves cross.
#[inline(always)]
fn cross_leaves<S: Simd>(
    simd: S,
    (first, second): (&mut Body<'_>, &mut Body<'_>),
    [a, b]: [u32; 2],
    slack: f32,
    crossings: &mut Crossings,
) {
    first.prepare_leaf(a);
    let (leaf_a, leaf_b) = (&first.facets.leaves[a as usize], &second.facets.leaves[b as usize]);
    let (own, other) = (first.places(a), second.places(b));
    let (near_own, near_other) = (own.meeting(simd, other), other.meeting(simd, own));
    if near_own == 0 || near_other == 0 {
        return;
    }
    let (n_own, n_other) = (leaf_a.vertices().len(), leaf_b.vertices().len());
    // Which corners surely lie behind each of their faces or ahead of it, and of each of ours.
    let [mut theirs, mut ours] = [[[0; WIDTH]; 2]; 2];
    for part in parts::<S>() {
        let [behind, ahead] = other.sides(simd, part, (own, n_own), slack);
        behind.store(&mut theirs[0], part);
        ahead.store(&mut theirs[1], part);
    }
    // Faces of the other leaf that may cross each of ours, a bit each: neither has all corners on one side of the other.
    let mut may_cross = [0; WIDTH];
    for part in parts::<S>() {
        let sides = own.sides(simd, part, (other, n_other), slack);
        sides[0].store(&mut ours[0], part);
        sides[1].store(&mut ours[1], part);
        let corners = Words::load(simd, &leaf_a.corners, part);
        let mut found = Words::splat(simd, 0);
        for j in ones(near_other.into()) {
            let j = j as usize;
            let others = Words::splat(simd, leaf_b.corners[j]);
            let (behind, ahead) = (Words::splat(simd, theirs[0][j]), Words::splat(simd, theirs[1][j]));
            let mixed = others.without(sides[0]).negative()
                & others.without(sides[1]).negative()
                & corners.without(behind).negative()
                & corners.without(ahead).negative();
            found = found | mixed.without(own.apart(simd, part, other, j)).highest(j);
        }
        found.store(&mut may_cross, part);
    }
    let may_cross = (0..WIDTH).fold(0, |all, i| all | u64::from(may_cross[i]) << (i * WIDTH));
    for pair in ones(may_cross) {
        let (i, j) = ((pair / WIDE) as usize, (pair % WIDE) as usize);
        let (corners_a, corners_b) = (leaf_a.corners[i], leaf_b.corners[j]);
        let sure =
            corners_b & !(ours[0][i] | ours[1][i]) == 0 && corners_a & !(theirs[0][j] | theirs[1][j]) == 0;
        let sides = sure.then(|| [leaf_b.pick(ours[0][i], j), leaf_a.pick(theirs[0][j], i)]);
        cross(first, second, [a * WIDE + i as u32, b * WIDE + j as u32], sides, crossings);
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
    /// Of face `f`; `behind` has a bit for every corner behind the plane.
    #[inline(always)]
    fn new(own: &Body<'_>, f: u32, behind: u32) -> Self {
        let (alone, is_behind) = LONE[behind as usize & 7];
        let order = [alone, NEXT[alone], NEXT[NEXT[alone]]];
        let corners = own.facets.faces[f as usize].corners;
        Self { alone, corners: order.map(|k| own.prepared(corners[k])), is_behind }
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

/// Which corner is alone, and whether it is behind, by the bits of those behind.
const LONE: [(usize, bool); 8] =
    [(0, false), (0, true), (1, true), (2, false), (2, true), (1, false), (0, false), (0, true)];

/// Finds the segment in which two faces cross, if they do (after Devillers & Guigue 2002, INRIA report 4488); with the corners of
/// either that lie behind the other, if that is sure.
#[inline(always)]
fn cross(
    first: &mut Body<'_>,
    second: &mut Body<'_>,
    [f, g]: [u32; 2],
    sides: Option<[u32; 2]>,
    crossings: &mut Crossings,
) {
    let [behind_a, behind_b] = match sides {
        Some(sides) => sides,
        None => {
            let corners =
                |body: &Body<'_>, f: u32| body.facets.faces[f as usize].corners.map(|v| body.prepared(v));
            let sides = exact_sides(corners(first, f), corners(second, g));
            let same = |behind: u32| behind == 0 || behind == 0b111;
            if sides.into_iter().any(same) {
                return;
            }
            sides
        }
    };
    let (a, b) = (Split::new(first, f, behind_b), Split::new(second, g, behind_a));
    // Along n_a × n_b, the first face's border leaves at the low end and enters at the high one; the second's, the other way.
    let order = Passes::new(&a, &b);
    if !order.before(true, true) || order.before(false, false) {
        return;
    }
    let (f, g) = (first.cut(f, &a.corners), second.cut(g, &b.corners));
    let low = if order.before(true, false) {
        crossings.get(second, &b.edge(second, g.face, false), &f)
    } else {
        crossings.get(first, &a.edge(first, f.face, true), &g)
    };
    let high = if order.before(false, true) {
        crossings.get(first, &a.edge(first, f.face, false), &g)
    } else {
        crossings.get(second, &b.edge(second, g.face, true), &f)
    };
    crossings.segments.push(Segment { first: f.number, second: g.number, ends: [low, high] });
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
    /// What these are off by at most.
    doubt: f64,
    sign: f64,
}

impl<'s> Passes<'s> {
    #[inline(always)]
    fn new(first: &'s Split, second: &'s Split) -> Self {
        let ([p, on, back], [q, others_on, others_back]) = (&first.corners, &second.corners);
        let (on, back, others_on, others_back, between) =
            (on - p, back - p, others_on - q, others_back - q, q - p);
        let (moment_on, moment_back) = (others_on.cross(&between), others_back.cross(&between));
        let near =
            [[on.dot(&moment_on), on.dot(&moment_back)], [back.dot(&moment_on), back.dot(&moment_back)]];
        // Sums and products are rounded by ε each.
        let sum = |v: &Vector| v.x.abs() + v.y.abs() + v.z.abs();
        let longer = |a: f64, b: f64| if a > b { a } else { b };
        let (edge, others_edge) = (longer(sum(&on), sum(&back)), longer(sum(&others_on), sum(&others_back)));
        let doubt = 64.0 * f64::EPSILON * (edge * others_edge * sum(&between));
        let sign = if first.is_behind == second.is_behind { 1.0 } else { -1.0 };
        Self { first, second, near, doubt, sign }
    }
    /// Does the edge where the first's border leaves, or enters, come before that where the second's does?
    #[inline(always)]
    fn before(&self, leaves: bool, others_leaves: bool) -> bool {
        let (u, v) = (
            usize::from(leaves != self.first.is_behind),
            usize::from(others_leaves != self.second.is_behind),
        );
        let near = self.near[u][v];
        if near.abs() > self.doubt {
            return self.sign * near < 0.0;
        }
        let ([p, q], [r, s]) = (self.first.ends(leaves), self.second.ends(others_leaves));
        passes(p, q, r, s) < 0.0
    }
}
