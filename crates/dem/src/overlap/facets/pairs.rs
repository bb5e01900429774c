//! Which faces cross, and where.
use super::Bodies;
use super::body::Body;
use super::crossings::{Crossings, Segment};
use super::signs::{Side, is_behind, passes};
use crate::shapes::Node;
use interfaces::Vector;
use nalgebra::Matrix3;

impl Bodies<'_> {
    /// Walks down both trees where their boxes meet, and finds where the faces there cross.
    pub(super) fn find_pairs(&mut self, stack: &mut Vec<[u32; 2]>, crossings: &mut Crossings) {
        let (a, b) = (self.first.facets, self.second.facets);
        let boxes = Boxes::new(self.first.moved.unwrap_or((Matrix3::identity(), Vector::zeros())), a.radius + b.radius);
        stack.clear();
        stack.push([0, 0]);
        while let Some([m, n]) = stack.pop() {
            let (p, q) = (&a.tree[m as usize], &b.tree[n as usize]);
            if !boxes.meet(p, q) {
                continue;
            }
            if p.count > 0 && q.count > 0 {
                for f in p.first..p.first + p.count {
                    for g in q.first..q.first + q.count {
                        cross(&mut self.first, f, &mut self.second, g, crossings);
                    }
                }
            } else if q.count > 0 || (p.count == 0 && p.half.max() >= q.half.max()) {
                stack.push([m + 1, n]);
                stack.push([p.first, n]);
            } else {
                stack.push([m, n + 1]);
                stack.push([m, q.first]);
            }
        }
    }
}

/// Boxes of the first body's frame against those of the second's.
struct Boxes {
    turn: Matrix3<f64>,
    size: Matrix3<f64>,
    shift: Vector,
    slack: f64,
}

impl Boxes {
    fn new((turn, shift): (Matrix3<f64>, Vector), extent: f64) -> Self {
        Self { turn, size: turn.abs(), shift, slack: 1e-14 * (extent + shift.norm()) }
    }
    #[inline]
    fn meet(&self, p: &Node, q: &Node) -> bool {
        let apart = self.turn * p.centre + self.shift - q.centre;
        let within = self.size * p.half + q.half;
        if (0..3).any(|i| apart[i].abs() > within[i] + self.slack) {
            return false;
        }
        let apart = self.turn.tr_mul(&apart);
        let within = self.size.tr_mul(&q.half) + p.half;
        !(0..3).any(|i| apart[i].abs() > within[i] + self.slack)
    }
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

/// The edges along which a face's border leaves and enters what lies behind a plane.
#[inline]
fn straddling(own: &Body<'_>, f: u32, corners: &[Vector; 3], behind: [bool; 3]) -> [Straddling; 2] {
    let face = &own.facets.faces[f as usize];
    let edge = |i: usize| {
        let next = (i + 1) % 3;
        let (inner, outer) = if behind[i] { (i, next) } else { (next, i) };
        let forward = own.facets.edges[face.edges[i] as usize].left == f;
        let leaves = behind[i] == forward;
        Straddling { edge: face.edges[i], behind: corners[inner], ahead: corners[outer], leaves }
    };
    let at = |leaving: bool| (0..3).find(|&i| behind[i] == leaving && behind[(i + 1) % 3] != leaving).unwrap_or(0);
    [edge(at(true)), edge(at(false))]
}

/// Finds the segment in which two faces cross, if they do (after Devillers & Guigue 2002, INRIA report 4488).
#[inline]
fn cross(first: &mut Body<'_>, f: u32, second: &mut Body<'_>, g: u32, crossings: &mut Crossings) {
    let (a, b) = (first.corners(f), second.corners(g));
    for i in 0..3 {
        let (low_a, high_a) = (a[0][i].min(a[1][i]).min(a[2][i]), a[0][i].max(a[1][i]).max(a[2][i]));
        let (low_b, high_b) = (b[0][i].min(b[1][i]).min(b[2][i]), b[0][i].max(b[1][i]).max(b[2][i]));
        if low_a > high_b || low_b > high_a {
            return;
        }
    }
    let mixed = |s: &[bool; 3]| s[0] != s[1] || s[1] != s[2];
    let behind_b = a.map(|p| is_behind(Side::First, p, b));
    if !mixed(&behind_b) {
        return;
    }
    let behind_a = b.map(|p| is_behind(Side::Second, p, a));
    if !mixed(&behind_a) {
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
    crossings.segments.push(Segment { first: f, second: g, ends: [low, high] });
}
