//! Cuts polygons into convex pieces.
use super::Piece;
use nalgebra::Vector2;
use robust::{Coord, orient2d};
use std::collections::BTreeMap;

/// On which side of the way from `a` to `b` is `c`? Positive on the left, exact in its sign.
fn side(a: Vector2<f64>, b: Vector2<f64>, c: Vector2<f64>) -> f64 {
    let [a, b, c] = [a, b, c].map(|v| Coord { x: v.x, y: v.y });
    orient2d(a, b, c)
}

/// Is `c`, which is on the line through `a` and `b`, between them?
fn between(a: Vector2<f64>, b: Vector2<f64>, c: Vector2<f64>) -> bool {
    let (low, high) = (a.inf(&b), a.sup(&b));
    low.x <= c.x && c.x <= high.x && low.y <= c.y && c.y <= high.y
}

/// Do two edges share a place?
fn meet([a, b]: [Vector2<f64>; 2], [c, d]: [Vector2<f64>; 2]) -> bool {
    let [ac, ad] = [c, d].map(|x| side(a, b, x));
    let [ca, cb] = [a, b].map(|x| side(c, d, x));
    (ac * ad < 0.0 && ca * cb < 0.0)
        || (ac == 0.0 && between(a, b, c))
        || (ad == 0.0 && between(a, b, d))
        || (ca == 0.0 && between(c, d, a))
        || (cb == 0.0 && between(c, d, b))
}

/// The first edge that meets another one elsewhere than at the corner that both have.
pub(super) fn crossing(corners: &[[f64; 2]]) -> Option<usize> {
    let n = corners.len();
    let edge = |i: usize| [i, (i + 1) % n].map(|i| Vector2::from(corners[i]));
    (0..n).find(|&i| {
        let [a, b] = edge(i);
        let next = edge((i + 1) % n)[1];
        // Turns back on itself, or has no length.
        let back = side(a, b, next) == 0.0 && (next - b).dot(&(b - a)) <= 0.0;
        let others = (i + 2)..n;
        back || a == b || others.into_iter().any(|j| (j + 1) % n != i && meet([a, b], edge(j)))
    })
}

/// Convex pieces of a polygon that is counter-clockwise and does not cross itself: triangles cut off at its convex corners one after the other (Meisters 1975), joined again over each cut
/// where what that makes is convex (Hertel & Mehlhorn 1983: at most four times as many pieces as needed).
pub(super) fn convex(corners: &[Vector2<f64>]) -> Vec<Piece> {
    // Half-edges, three of each triangle: where each begins, and its neighbours around its piece.
    let from: Vec<usize> = triangles(corners).into_flattened();
    let turn = |e: usize, by: usize| e - e % 3 + (e + by) % 3;
    let mut next: Vec<usize> = (0..from.len()).map(|e| turn(e, 1)).collect();
    let mut last: Vec<usize> = (0..from.len()).map(|e| turn(e, 2)).collect();
    let by_ends: BTreeMap<_, _> = (0..from.len()).map(|e| ([from[e], from[next[e]]], e)).collect();
    let twin: Vec<Option<usize>> =
        (0..from.len()).map(|e| by_ends.get(&[from[next[e]], from[e]]).copied()).collect();
    let left = |a: usize, b: usize, c: usize| side(corners[a], corners[b], corners[c]) >= 0.0;
    let mut gone = vec![false; from.len()];
    for e in 0..from.len() {
        let Some(f) = twin[e].filter(|f| e < *f) else { continue };
        let ends = [(e, f), (f, e)];
        if ends.iter().all(|&(e, f)| left(from[last[e]], from[e], from[next[next[f]]])) {
            for (e, f) in ends {
                (next[last[e]], last[next[f]]) = (next[f], last[e]);
                gone[e] = true;
            }
        }
    }
    let mut piece_of = vec![None; from.len()];
    let mut rings = Vec::new();
    for e in (0..from.len()).filter(|&e| !gone[e]) {
        if piece_of[e].is_some() {
            continue;
        }
        let around = || std::iter::successors(Some(e), |&k| Some(next[k]).filter(|&k| k != e));
        around().for_each(|k| piece_of[k] = Some(rings.len() as u32));
        rings.push(around().collect::<Vec<_>>());
    }
    let piece = |ring: &Vec<usize>| {
        let own = ring.iter().map(|&e| corners[from[e]]).collect();
        piece(own, ring.iter().map(|&e| piece_of[twin[e]?]).collect())
    };
    rings.iter().map(piece).collect()
}

fn piece(corners: Vec<Vector2<f64>>, beyond: Vec<Option<u32>>) -> Piece {
    let low = corners.iter().fold(corners[0], |low, c| low.inf(c));
    let high = corners.iter().fold(corners[0], |high, c| high.sup(c));
    let middle = 0.5 * (low + high);
    let radius = corners.iter().map(|c| (c - middle).norm()).fold(0.0, f64::max);
    Piece { corners, beyond, middle, radius }
}

/// Triangles, as three numbers of corners each.
fn triangles(corners: &[Vector2<f64>]) -> Vec<[usize; 3]> {
    let mut ring: Vec<usize> = (0..corners.len()).collect();
    let mut cut = Vec::with_capacity(corners.len());
    while ring.len() > 3 {
        let n = ring.len();
        let around = |i: usize| [(i + n - 1) % n, i, (i + 1) % n].map(|i| ring[i]);
        let turn = |i: usize| {
            let [a, b, c] = around(i);
            side(corners[a], corners[b], corners[c])
        };
        let is_free = |i: usize| {
            let t = around(i);
            let [a, b, c] = t.map(|i| corners[i]);
            let holds =
                |x: Vector2<f64>| side(a, b, x) >= 0.0 && side(b, c, x) >= 0.0 && side(c, a, x) >= 0.0;
            ring.iter().all(|i| t.contains(i) || !holds(corners[*i]))
        };
        // There always are two; straight corners go last, with those that they are cut off with.
        let ear = (0..n).find(|&i| turn(i) > 0.0 && is_free(i)).or_else(|| (0..n).find(|&i| turn(i) == 0.0));
        let Some(ear) = ear else { break };
        cut.push(around(ear));
        ring.remove(ear);
    }
    cut.push([ring[0], ring[1], ring[2]]);
    cut
}
