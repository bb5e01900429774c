//! Which faces cross, and where.
use super::Bodies;
use super::body::Body;
use super::crossings::{Crossings, Segment, Straddling};
use super::signs::{Side, is_behind, passes};
use crate::shapes::{Leaf, WIDTH};
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
        let tree = &second.facets.tree;
        let shift = first.moved.map_or(0.0, |(_, shift)| shift.amax());
        // normal·(x − a) is rounded by less than this times the square of the face's size: with sums and products rounded by ε
        // each, 48 ε of that and of the largest coordinate.
        let round_off = 64.0 * f64::EPSILON * (first.facets.radius + second.facets.radius + shift);
        stack.clear();
        stack.push([0, 0]);
        while let Some([m, n]) = stack.pop() {
            first.prepare(m);
            let (p, q) = (first.node(m), &tree[n as usize]);
            let (own, others) = (p.children, q.children);
            let near = q.gaps_to_all(p);
            if p.is_leaf && !q.is_leaf {
                stack.extend((0..WIDTH).filter(|&j| near[j] <= 0.0).map(|j| [m, others[j]]));
                continue;
            }
            if q.is_leaf && !p.is_leaf {
                let near = p.gaps_to_all(q);
                stack.extend((0..WIDTH).filter(|&i| near[i] <= 0.0).map(|i| [own[i], n]));
                continue;
            }
            for j in (0..WIDTH).filter(|&j| near[j] <= 0.0) {
                let gaps = first.node(m).gaps_to(q, j);
                if !q.is_leaf {
                    stack.extend((0..WIDTH).filter(|&i| gaps[i] <= 0.0).map(|i| [own[i], others[j]]));
                } else if gaps.iter().any(|gap| *gap <= 0.0) {
                    let sides = sides(first.leaf(own[0]), second.leaf(others[0]), j, round_off);
                    for i in (0..WIDTH).filter(|&i| gaps[i] <= 0.0) {
                        let [behind_first, behind_second, unsure] = sides.map(|s| s[i] as u32);
                        let same = |behind: u32| behind == 0 || behind == 0b111;
                        if unsure != 0 || !(same(behind_first) || same(behind_second)) {
                            let at = [[own[0], i as u32], [others[0], j as u32]];
                            cross(first, second, at, [behind_first, behind_second], unsure != 0, crossings);
                        }
                    }
                }
            }
        }
    }
}

/// Of every face of `own` and face `j` of the `other` leaf: which of the other's corners lie behind our face, which of ours behind the
/// other, a bit each, and whether any of that is not sure.
#[inline(always)]
fn sides(own: &Leaf, other: &Leaf, j: usize, round_off: f64) -> [[u64; WIDTH]; 3] {
    let [mut behind_own, mut behind_other, mut unsure] = [[0_u64; WIDTH]; 3];
    let n = [other.normals[0][j], other.normals[1][j], other.normals[2][j]];
    let (height, doubt) = (other.heights[j], other.sizes[j] * round_off);
    for k in 0..3 {
        let theirs = [other.corners[k][0][j], other.corners[k][1][j], other.corners[k][2][j]];
        let ours = &own.corners[k];
        for i in 0..WIDTH {
            let h =
                own.normals[0][i] * theirs[0] + own.normals[1][i] * theirs[1] + own.normals[2][i] * theirs[2]
                    - own.heights[i];
            let d = n[0] * ours[0][i] + n[1] * ours[1][i] + n[2] * ours[2][i] - height;
            behind_own[i] |= u64::from(h < 0.0) << k;
            behind_other[i] |= u64::from(d < 0.0) << k;
            unsure[i] |= u64::from(h.abs() <= own.sizes[i] * round_off) | u64::from(d.abs() <= doubt);
        }
    }
    [behind_own, behind_other, unsure]
}

/// The edges along which the border of a leaf's triangle leaves and enters what lies behind a plane; `behind` has a bit for every
/// corner there.
#[inline(always)]
fn straddling(own: &Body<'_>, first: u32, lane: usize, behind: u32) -> [Straddling; 2] {
    const NEXT: [usize; 3] = [1, 2, 0];
    // The corner that is alone on its side.
    let (alone, is_behind) = match behind {
        0b001 => (0, true),
        0b010 => (1, true),
        0b100 => (2, true),
        0b110 => (0, false),
        0b101 => (1, false),
        _ => (2, false),
    };
    let (next, before) = (NEXT[alone], NEXT[NEXT[alone]]);
    let (leaf, f) = (own.leaf(first), first + lane as u32);
    let corner =
        |k: usize| Vector::new(leaf.corners[k][0][lane], leaf.corners[k][1][lane], leaf.corners[k][2][lane]);
    let (peak, p, q) = (corner(alone), corner(next), corner(before));
    let face = &own.facets.faces[f as usize];
    let forward = |e: u32| own.facets.edges[e as usize].left == f;
    // From the lone corner on, and back to it.
    let (on, back) = (face.edges[alone], face.edges[before]);
    if is_behind {
        let leaving = Straddling { edge: on, behind: peak, ahead: p, leaves: forward(on) };
        [leaving, Straddling { edge: back, behind: peak, ahead: q, leaves: !forward(back) }]
    } else {
        let leaving = Straddling { edge: back, behind: q, ahead: peak, leaves: forward(back) };
        [leaving, Straddling { edge: on, behind: p, ahead: peak, leaves: !forward(on) }]
    }
}

/// Finds the segment in which two faces cross, if they do (after Devillers & Guigue 2002, INRIA report 4488). Each is given by the
/// first of its leaf and the number in it, with the other's corners behind it, which may be `unsure`.
fn cross(
    first: &mut Body<'_>,
    second: &mut Body<'_>,
    at: [[u32; 2]; 2],
    [mut behind_a, mut behind_b]: [u32; 2],
    unsure: bool,
    crossings: &mut Crossings,
) {
    let [[leaf_a, i], [leaf_b, j]] = at;
    let (f, g) = (leaf_a + i, leaf_b + j);
    let (own, other) = (first.leaf(leaf_a), second.leaf(leaf_b));
    if unsure {
        let (a, b) = (own.triangle(i as usize), other.triangle(j as usize));
        let bits = |behind: [bool; 3]| (0..3).map(|k| u32::from(behind[k]) << k).sum();
        behind_b = bits(a.map(|p| is_behind(Side::First, p, b)));
        behind_a = bits(b.map(|p| is_behind(Side::Second, p, a)));
        if [behind_a, behind_b].iter().any(|&behind| behind == 0 || behind == 0b111) {
            return;
        }
    }
    // Along n_a × n_b, the first face's border leaves at the low end and enters at the high one; the second's, the other way.
    let [low_a, high_a] = straddling(first, leaf_a, i as usize, behind_b);
    let [high_b, low_b] = straddling(second, leaf_b, j as usize, behind_a);
    let before = |e: &Straddling, k: &Straddling| passes(e.behind, e.ahead, k.behind, k.ahead) < 0.0;
    if !before(&low_a, &high_b) || before(&high_a, &low_b) {
        return;
    }
    let (own, other) = (first.leaf(leaf_a), second.leaf(leaf_b));
    let (a, n_a) = (own.corner(i as usize), own.normal(i as usize));
    let (b, n_b) = (other.corner(j as usize), other.normal(j as usize));
    let low = if before(&low_a, &low_b) {
        crossings.get(second, &low_b, f, a, n_a)
    } else {
        crossings.get(first, &low_a, g, b, n_b)
    };
    let high = if before(&high_a, &high_b) {
        crossings.get(first, &high_a, g, b, n_b)
    } else {
        crossings.get(second, &high_b, f, a, n_a)
    };
    let (f, g) = (first.cut(f, a, n_a), second.cut(g, b, n_b));
    crossings.segments.push(Segment { first: f, second: g, ends: [low, high] });
}
