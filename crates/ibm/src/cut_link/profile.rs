//! Mean velocity over a cut edge (2D), relative to the wall, from velocity profiles along it.
//!
//! Lengths are in units of the edge, s from its node. A face that is wholly open carries the velocity of its node, which is u″/24 less than the
//! mean over the face; so does the open part of every face here, or neighbouring faces would not agree:
//!
//! ```text
//! F = ∫_open u ds − open u″/24
//! ```
//!
//! F is continuous in the place of the wall, also where the wall comes to an end of the edge, to its node or to the next one.
use interfaces::CutFace;

/// Point that a profile passes through.
#[derive(Clone, Copy, Debug)]
pub(super) enum Support {
    /// Wall at this distance from the node of the edge.
    Wall(f64),
    /// Velocity node with this storage index.
    Node(usize),
    /// Side of the box.
    None,
}

/// Edge and nodes on one side of the node of an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    /// Open part of this half, from 0 to ½.
    pub(super) open: f64,
    /// Whether the end of the edge is inside the body.
    pub(super) cut: bool,
    /// Next point, nearest first: the wall, or the neighbour of the node.
    pub(super) next: Support,
    /// Second neighbour.
    pub(super) second: Support,
}

/// Adds `weight` to the term of this node; walls have none, since velocities are relative to them.
fn add(face: &mut CutFace, support: Support, weight: f64) {
    let Support::Node(index) = support else { return };
    let mut terms = face.terms.iter_mut();
    if let Some(term) = terms.find(|term| term.0 == index || term.1 == 0.0 && term.0 == face.index) {
        *term = (index, term.1 + weight);
    }
}

/// Weights of an edge whose node is in the fluid: (1 − θ) E + θ Q with θ = 4 p q, p and q the open parts of both halves.
///
/// E is bounded however near the wall is to the node: straight between wall, node and next point, with the curvature of wall and two neighbours
/// on the open side. Q is the parabola through the node and the next point on both sides. Both are exact for parabolas where E has its
/// curvature, and Q is the velocity of the node if p = q = ½.
pub(super) fn around_node(sides: [Side; 2], face: &mut CutFace) {
    let [p, q] = sides.map(|side| side.open);
    let theta = 4.0 * p * q;
    let mut own = 0.0;
    for (side, other) in [(0, 1), (1, 0)] {
        let Side { open, cut, next, second } = sides[side];
        if cut {
            own += 0.5 * open * (1.0 - theta);
            continue;
        }
        let outward = match next {
            // Mean of s over the half: ⅛.
            Support::Wall(e) => {
                own -= 0.125 / e * (1.0 - theta);
                0.0
            }
            Support::Node(_) => {
                own -= 0.125 * (1.0 - theta);
                0.125
            }
            Support::None => 0.0,
        };
        own += 0.5 * (1.0 - theta);
        add(face, next, outward * (1.0 - theta));
        if sides[other].cut {
            bend(face, sides[other].open + 0.5, next, second, 1.0 - theta);
        }
    }
    if theta > 0.0 {
        own += theta * parabola(sides, face, theta);
    }
    add(face, Support::Node(face.index), own);
}

/// Adds the terms of the next points in Q, `theta` times, and returns the weight of the node.
///
/// u = u₀ + b s + c s² through (−e₀, v₀) and (e₁, v₁), Q = u₀ (p + q) + b (q² − p²)/2 + c ((p³ + q³)/3 − (p + q)/12).
fn parabola(sides: [Side; 2], face: &mut CutFace, theta: f64) -> f64 {
    let [p, q] = sides.map(|side| side.open);
    let ends = sides.map(|side| match side.next {
        Support::Wall(e) => Some(e),
        Support::Node(_) => Some(1.0),
        Support::None => None,
    });
    let (first, second) = (0.5 * (q * q - p * p), (p.powi(3) + q.powi(3)) / 3.0 - (p + q) / 12.0);
    let (own, next) = match ends {
        [Some(e), Some(f)] => {
            // Slopes m₀ = (u₀ − v₀)/e₀ and m₁ = (v₁ − u₀)/e₁, c = (m₁ − m₀)/(e₀ + e₁), b = m₀ + c e₀.
            let c = (first * e + second) / (e + f);
            let [m0, m1] = [first - c, c];
            (p + q + m0 / e - m1 / f, [-m0 / e, m1 / f])
        }
        [Some(e), None] => (p + q + first / e, [-first / e, 0.0]),
        [None, Some(f)] => (p + q - first / f, [0.0, first / f]),
        [None, None] => (p + q, [0.0; 2]),
    };
    for (side, weight) in sides.iter().zip(next) {
        add(face, side.next, theta * weight);
    }
    own
}

/// Weights of an edge whose node is inside: from the wall to the next node in the fluid, which is `open` + ½ from the wall, with the curvature of
/// both neighbours. Where the wall covers only a little on both sides of the node, less and less is left, down to the node's own velocity.
pub(super) fn from_walls(sides: [Side; 2], face: &mut CutFace) {
    for (side, other) in [(0, 1), (1, 0)] {
        let Side { open, next, second, .. } = sides[side];
        let covered = 2.0 * (0.5 - sides[other].open);
        add(face, next, 0.5 * open * open / (open + 0.5) * covered);
        if open > 0.0 {
            bend(face, open, next, second, covered);
        }
    }
}

/// Adds what the curvature of the profile changes in a flux by straight pieces, `factor` times; `next` and `second` are the neighbours on the open
/// side of a wall that leaves `a` of the edge open.
///
/// With t the distance from the wall, nodes at t₁ = a + ½ and t₂ = a + 3⁄2 and the second difference u″ of the wall and these two, the change is
/// −u″ (t₀³/12 + 1/24) for a > ½ (t₀ = a − ½) and −u″ (t₁a²/4 − a³/6) otherwise, and −u″ a/24 in either case.
fn bend(face: &mut CutFace, a: f64, next: Support, second: Support, factor: f64) {
    if !matches!(next, Support::Node(_)) || matches!(second, Support::None) {
        return;
    }
    let (t0, t1, t2) = (a - 0.5, a + 0.5, a + 1.5);
    let pieces = if t0 > 0.0 { t0.powi(3) / 12.0 + 1.0 / 24.0 } else { t1 * a * a / 4.0 - a.powi(3) / 6.0 };
    // u″ = 2 (u₂/t₂ − u₁/t₁), relative to the wall.
    let share = -2.0 * (pieces + a / 24.0) * factor;
    add(face, next, -share / t1);
    add(face, second, share / t2);
}

#[cfg(test)]
mod tests;
