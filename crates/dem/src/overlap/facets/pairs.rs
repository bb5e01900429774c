//! Which faces cross, and where.
use super::Bodies;
use super::body::Body;
use super::crossings::{Crossings, Segment};
use super::signs::{Side, passes};
use crate::shapes::WIDTH;
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
        stack.clear();
        stack.push([0, 0]);
        while let Some([m, n]) = stack.pop() {
            let (p, q) = (first.node(m), &tree[n as usize]);
            let hits = p.meets(q);
            let (own, others) = (p.children, q.children);
            match (p.is_leaf, q.is_leaf) {
                (true, true) => {
                    for (i, hits) in hits.into_iter().enumerate().filter(|(_, hits)| *hits != 0) {
                        let f = own[i] + i as u32;
                        for j in bits(hits) {
                            cross(first, f, second, others[j] + j as u32, crossings);
                        }
                    }
                }
                (true, false) => {
                    let met = hits.iter().fold(0, |all, hits| all | hits);
                    stack.extend(bits(met).map(|j| [m, others[j]]));
                }
                (false, true) => {
                    let met = (0..WIDTH).filter(|&i| hits[i] != 0);
                    stack.extend(met.map(|i| [own[i], n]));
                }
                (false, false) => {
                    for (i, hits) in hits.into_iter().enumerate() {
                        stack.extend(bits(hits).map(|j| [own[i], others[j]]));
                    }
                }
            }
        }
    }
}

/// The numbers of the bits that are set.
#[inline(always)]
fn bits(mut of: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lowest = of.trailing_zeros();
        of &= of.wrapping_sub(1);
        (lowest < 32).then_some(lowest as usize)
    })
}

/// An edge of a face that crosses the plane of another: its number, and its ends, that behind the plane first.
#[derive(Clone, Copy)]
struct Straddling {
    edge: u32,
    behind: Vector,
    ahead: Vector,
    /// Does it leave, in the direction of [`Edge`](crate::shapes::Edge)?
    leaves: bool,
}

/// The edges along which a face's border leaves and enters what lies behind a plane; `behind` has a bit for every corner there.
#[inline]
fn straddling(own: &Body<'_>, f: u32, corners: &[Vector; 3], behind: u32) -> [Straddling; 2] {
    const NEXT: [usize; 3] = [1, 2, 0];
    // Of one corner alone on its side: the edge that leaves starts there or ends there.
    let (alone, is_behind) = match behind {
        0b001 => (0, true),
        0b010 => (1, true),
        0b100 => (2, true),
        0b110 => (0, false),
        0b101 => (1, false),
        _ => (2, false),
    };
    let face = &own.facets.faces[f as usize];
    let before = NEXT[NEXT[alone]];
    let edge = |i: usize, leaving: bool| {
        let (inner, outer) = if leaving { (i, NEXT[i]) } else { (NEXT[i], i) };
        let forward = own.facets.edges[face.edges[i] as usize].left == f;
        Straddling {
            edge: face.edges[i],
            behind: corners[inner],
            ahead: corners[outer],
            leaves: leaving == forward,
        }
    };
    if is_behind { [edge(alone, true), edge(before, false)] } else { [edge(before, true), edge(alone, false)] }
}

/// Finds the segment in which two faces cross, if they do (after Devillers & Guigue 2002, INRIA report 4488).
fn cross(first: &mut Body<'_>, f: u32, second: &mut Body<'_>, g: u32, crossings: &mut Crossings) {
    let (a, b) = (first.corners(f), second.corners(g));
    let behind_b = second.plane(g).behind(Side::First, &a, &b);
    if behind_b == 0 || behind_b == 0b111 {
        return;
    }
    let behind_a = first.plane(f).behind(Side::Second, &b, &a);
    if behind_a == 0 || behind_a == 0b111 {
        return;
    }
    // Along n_a × n_b, the first face's border leaves at the low end and enters at the high one; the second's, the other way.
    let [low_a, high_a] = straddling(first, f, &a, behind_b);
    let [high_b, low_b] = straddling(second, g, &b, behind_a);
    let before = |e: Straddling, k: Straddling| passes(e.behind, e.ahead, k.behind, k.ahead) < 0.0;
    if !before(low_a, high_b) || before(high_a, low_b) {
        return;
    }
    let low = if before(low_a, low_b) {
        crossings.get(second, first, low_b.edge, f, low_b.leaves)
    } else {
        crossings.get(first, second, low_a.edge, g, low_a.leaves)
    };
    let high = if before(high_a, high_b) {
        crossings.get(first, second, high_a.edge, g, high_a.leaves)
    } else {
        crossings.get(second, first, high_b.edge, f, high_b.leaves)
    };
    first.cut(f);
    second.cut(g);
    crossings.segments.push(Segment { first: f, second: g, ends: [low, high] });
}
