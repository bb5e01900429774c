//! On which side things lie, without rounding and without ties.
//!
//! The corners of both bodies are taken as the numbers they are, rounded or not; the first body is moved by (ε, ε², ε³) with an
//! ε smaller than any number (simulation of simplicity, Edelsbrunner & Mücke 1990, ACM Trans. Graph. 9, 66). So faces of
//! the two never share a plane, and all answers fit together: they are those of two bodies in general position.
use interfaces::Vector;
use robust::{Coord, Coord3D, orient2d, orient3d};

/// Which of the two bodies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    First = 0,
    Second = 1,
}

impl Side {
    pub(super) fn other(self) -> Self {
        match self {
            Self::First => Self::Second,
            Self::Second => Self::First,
        }
    }
}

/// Does a corner `p` of the body `of` lie behind the face `a` `b` `c` of the other one?
#[cold]
pub(super) fn is_behind(of: Side, p: Vector, [a, b, c]: [Vector; 3]) -> bool {
    let behind = orient(a, b, c, p);
    if behind != 0.0 {
        return behind > 0.0;
    }
    // p moves by ε against the face, or the face by ε against p.
    let ahead = first_of_normal(a, b, c);
    if of == Side::First { ahead < 0.0 } else { ahead > 0.0 }
}

/// Sign of (q − p)×(s − r)·(r − p): how the line from `p` to `q` on the first body passes that from `r` to `s` on the second.
#[cold]
pub(super) fn passes(p: Vector, q: Vector, r: Vector, s: Vector) -> f64 {
    let passes = orient(p, q, r, s);
    if passes != 0.0 {
        return passes;
    }
    // Its derivative along ε: (q − p) × (r − s).
    let component = |i: usize, j: usize| cross([q[i], p[i]], [q[j], p[j]], [r[i], s[i]], [r[j], s[j]]);
    first([component(1, 2), component(2, 0), component(0, 1)])
}

/// How many times the ray from `p`, a corner of the body `of`, along x leaves (1) or enters (−1) the other body through its face.
pub(super) fn ray_crosses(of: Side, p: Vector, [a, b, c]: [Vector; 3]) -> i32 {
    let [low, high] = [a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x)];
    if high < p.x {
        return 0;
    }
    // The turn of each side about the ray, seen against x; ties as if p moved by (ε², ε³), or the face did.
    let turn = |r: Vector, s: Vector| {
        let t = orient2d(flat(r), flat(s), flat(p));
        if t != 0.0 {
            return t;
        }
        // The derivative of the area r s p along p: (r.z − s.z, s.y − r.y).
        let d = first([r.z - s.z, s.y - r.y, 0.0]);
        if of == Side::First { d } else { -d }
    };
    let turns = [turn(a, b), turn(b, c), turn(c, a)];
    if !(turns.iter().all(|t| *t > 0.0) || turns.iter().all(|t| *t < 0.0)) {
        return 0;
    }
    let leaves = turns[0] > 0.0;
    if low <= p.x && is_behind(of, p, [a, b, c]) != leaves {
        return 0;
    }
    if leaves { 1 } else { -1 }
}

fn flat(p: Vector) -> Coord<f64> {
    Coord { x: p.y, y: p.z }
}

/// Six times the volume of a tetrahedron, with the right sign: positive where `d` lies below a, b, c counter-clockwise.
#[inline]
fn orient(a: Vector, b: Vector, c: Vector, d: Vector) -> f64 {
    let p = |v: Vector| Coord3D { x: v.x, y: v.y, z: v.z };
    orient3d(p(a), p(b), p(c), p(d))
}

/// The first component of (b − a) × (c − a) that is not zero.
#[cold]
fn first_of_normal(a: Vector, b: Vector, c: Vector) -> f64 {
    let component = |i: usize, j: usize| {
        let at = |v: Vector| Coord { x: v[i], y: v[j] };
        orient2d(at(a), at(b), at(c))
    };
    first([component(1, 2), component(2, 0), component(0, 1)])
}

fn first(components: [f64; 3]) -> f64 {
    components.into_iter().find(|c| *c != 0.0).unwrap_or(1.0)
}

/// (a − b)(g − h) − (c − d)(e − f) for `[a, b]`, `[c, d]`, `[e, f]`, `[g, h]`, with the right sign.
#[cold]
fn cross([a, b]: [f64; 2], [c, d]: [f64; 2], [e, f]: [f64; 2], [g, h]: [f64; 2]) -> f64 {
    let mut sum = Exact::default();
    sum.add_product([a, b], [g, h], 1.0);
    sum.add_product([c, d], [e, f], -1.0);
    sum.sign()
}

/// A sum that is not rounded: numbers of growing size that do not overlap (Shewchuk 1997, Discrete Comput. Geom. 18, 305).
#[derive(Default)]
struct Exact {
    parts: [f64; 16],
    len: usize,
}

impl Exact {
    /// Adds ± (a − b)(c − d).
    fn add_product(&mut self, [a, b]: [f64; 2], [c, d]: [f64; 2], sign: f64) {
        let (u, v) = (two_sum(a, -b), two_sum(c, -d));
        for x in u {
            for y in v {
                let product = sign * x * y;
                self.add((sign * x).mul_add(y, -product));
                self.add(product);
            }
        }
    }
    fn add(&mut self, x: f64) {
        let mut carry = x;
        for part in &mut self.parts[..self.len] {
            [carry, *part] = two_sum(carry, *part);
        }
        self.parts[self.len] = carry;
        self.len += 1;
    }
    fn sign(&self) -> f64 {
        self.parts[..self.len].iter().rev().copied().find(|p| *p != 0.0).unwrap_or(0.0)
    }
}

/// a + b as what it rounds to and the rest.
fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let of_b = sum - a;
    [sum, (a - (sum - of_b)) + (b - of_b)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn small() -> impl Strategy<Value = Vector> {
        prop::array::uniform3(-3..=3i32).prop_map(|p| Vector::from(p.map(f64::from)))
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 20_000, failure_persistence: None, ..ProptestConfig::default() })]

        /// Ties are broken as if the first body had really moved, by amounts that small integers can bear.
        #[test]
        fn ties_are_those_of_a_small_move(p in small(), q in small(), r in small(), s in small()) {
            let moved = |v: Vector| v + Vector::new(1e-3, 1e-6, 1e-9);
            let det = |p: Vector, q: Vector, r: Vector, s: Vector| (q - p).cross(&(s - r)).dot(&(r - p));
            if (q - p).cross(&(s - r)).norm() > 0.0 {
                let truth = det(moved(p), moved(q), r, s);
                prop_assert_eq!(passes(p, q, r, s) > 0.0, truth > 0.0);
            }
            let normal = (r - q).cross(&(s - q));
            if normal.norm() > 0.0 {
                prop_assert_eq!(is_behind(Side::First, p, [q, r, s]), normal.dot(&(moved(p) - q)) < 0.0);
                prop_assert_eq!(
                    is_behind(Side::Second, p, [q, r, s]), normal.dot(&(p - moved(q))) < 0.0
                );
                for (of, start, t) in [(Side::First, moved(p), [q, r, s]), (Side::Second, p, [q, r, s].map(moved))] {
                    // Where the ray meets the plane, by Cramer's rule.
                    let (u, v, w) = (t[1] - t[0], t[2] - t[0], start - t[0]);
                    let d = Vector::x().dot(&u.cross(&v));
                    let hit = if d == 0.0 { 0 } else {
                        let (l, m) = (Vector::x().dot(&w.cross(&v)) / d, Vector::x().dot(&u.cross(&w)) / d);
                        let ahead = -w.dot(&u.cross(&v)) / d;
                        if l > 0.0 && m > 0.0 && l + m < 1.0 && ahead > 0.0 { d.signum() as i32 } else { 0 }
                    };
                    prop_assert_eq!(ray_crosses(of, p, [q, r, s]), hit);
                }
            }
        }

        /// The sum has the sign that whole numbers give.
        #[test]
        fn exact(n in prop::array::uniform8(-1_000_000_000_000i64..1_000_000_000_000), near in any::<bool>()) {
            let mut n = n;
            if near {
                // (a − b)(g − h) ≈ (c − d)(e − f).
                (n[4], n[5], n[6], n[7]) = (n[0] + 1, n[1], n[2], n[3]);
            }
            let [a, b, c, d, e, f, g, h] = n;
            let truth = i128::from(a - b) * i128::from(g - h) - i128::from(c - d) * i128::from(e - f);
            let x = |i: i64| i as f64;
            let sign = cross([x(a), x(b)], [x(c), x(d)], [x(e), x(f)], [x(g), x(h)]);
            prop_assert_eq!(sign.partial_cmp(&0.0), truth.cmp(&0).into());
        }
    }
}
