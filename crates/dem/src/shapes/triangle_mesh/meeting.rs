//! Do two triangles meet? Decided exactly.
use robust::{Coord, Coord3D, orient2d, orient3d};
use std::cmp::Ordering;

/// A place in space whose coordinates neither overflow nor underflow when multiplied by one another.
pub(crate) type Place = [f64; 3];

/// On which side of the plane through a, b and c is d? By Shewchuk's adaptive arithmetic.
pub(crate) fn side(a: Place, b: Place, c: Place, d: Place) -> Ordering {
    let [a, b, c, d] = [a, b, c, d].map(|[x, y, z]| Coord3D { x, y, z });
    sign(orient3d(a, b, c, d))
}

fn sign(x: f64) -> Ordering {
    x.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

/// Are none of them on this side, or none on the other?
fn not_both(sides: [Ordering; 3]) -> bool {
    !(sides.contains(&Ordering::Less) && sides.contains(&Ordering::Greater))
}

/// The plane along two of the axes, onto which a triangle is projected.
#[derive(Clone, Copy)]
struct Shadow(usize, usize);

impl Shadow {
    /// Where the triangle's shadow has an area; `None` if its corners are on a line.
    fn of([a, b, c]: [Place; 3]) -> Option<Self> {
        let shadows = [Self(0, 1), Self(1, 2), Self(2, 0)];
        shadows.into_iter().find(|s| s.turn(a, b, c) != Ordering::Equal)
    }
    /// Which way a, b and c turn there.
    fn turn(self, a: Place, b: Place, c: Place) -> Ordering {
        let [a, b, c] = [a, b, c].map(|p| Coord { x: p[self.0], y: p[self.1] });
        sign(orient2d(a, b, c))
    }
    /// Is `p` in the triangle or on its edges?
    fn holds(self, [a, b, c]: [Place; 3], p: Place) -> bool {
        not_both([self.turn(a, b, p), self.turn(b, c, p), self.turn(c, a, p)])
    }
    /// Do two segments have a point in common?
    fn cross(self, [p, q]: [Place; 2], [r, s]: [Place; 2]) -> bool {
        let (to_r, to_s) = (self.turn(p, q, r), self.turn(p, q, s));
        let (to_p, to_q) = (self.turn(r, s, p), self.turn(r, s, q));
        if [to_r, to_s, to_p, to_q] == [Ordering::Equal; 4] {
            // On one line: the intervals overlap.
            return [self.0, self.1].into_iter().all(|axis| {
                let (low, high) = (p[axis].min(q[axis]), p[axis].max(q[axis]));
                r[axis].min(s[axis]) <= high && r[axis].max(s[axis]) >= low
            });
        }
        (to_r != to_s || to_r == Ordering::Equal) && (to_p != to_q || to_p == Ordering::Equal)
    }
}

/// Do the segment from p to q and the triangle have a point in common, ends and edges included?
fn pierces(p: Place, q: Place, triangle: [Place; 3]) -> bool {
    let [a, b, c] = triangle;
    match (side(a, b, c, p), side(a, b, c, q)) {
        (Ordering::Equal, Ordering::Equal) => Shadow::of(triangle).is_some_and(|shadow| {
            let edges = [[a, b], [b, c], [c, a]];
            shadow.holds(triangle, p) || edges.into_iter().any(|e| shadow.cross([p, q], e))
        }),
        (up, down) if up == down => false,
        _ => not_both([side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)]),
    }
}

/// Do two triangles, neither of them degenerate, have points in common besides the corners that they share by number?
/// If they share an edge, only such as overlap count.
pub(crate) fn meet(f: [u32; 3], g: [u32; 3], place: impl Fn(u32) -> Place) -> bool {
    let corner_of = |t: [u32; 3], other: [u32; 3]| (0..3).find(|&i| !other.contains(&t[i]));
    let (at_f, at_g) = (f.map(&place), g.map(&place));
    match f.iter().filter(|v| g.contains(v)).count() {
        0 => {
            let one_side = |t: [Place; 3], other: [Place; 3]| {
                let sides = other.map(|p| side(t[0], t[1], t[2], p));
                sides[0] != Ordering::Equal && sides == [sides[0]; 3]
            };
            let edges = |t: [Place; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
            !one_side(at_f, at_g)
                && !one_side(at_g, at_f)
                && (edges(at_f).into_iter().any(|[p, q]| pierces(p, q, at_g))
                    || edges(at_g).into_iter().any(|[p, q]| pierces(p, q, at_f)))
        }
        1 => {
            // What they share is a segment that starts at their corner: it ends on one of the edges across from it.
            let across = |t: [u32; 3], at: [Place; 3], other: [u32; 3]| {
                let shared = (0..3).find(|&i| other.contains(&t[i])).unwrap_or(0);
                [at[(shared + 1) % 3], at[(shared + 2) % 3]]
            };
            let ([p, q], [r, s]) = (across(f, at_f, g), across(g, at_g, f));
            pierces(p, q, at_g) || pierces(r, s, at_f)
        }
        2 => {
            let (Some(i), Some(j)) = (corner_of(f, g), corner_of(g, f)) else { return false };
            let [from, to] = [at_f[(i + 1) % 3], at_f[(i + 2) % 3]];
            let (tip, other) = (at_f[i], at_g[j]);
            side(from, to, tip, other) == Ordering::Equal
                && Shadow::of(at_f).is_some_and(|s| s.turn(from, to, tip) == s.turn(from, to, other))
        }
        _ => false,
    }
}
