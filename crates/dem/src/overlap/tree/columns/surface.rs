//! Surfaces as columns see them.
use super::super::quadric::Quadric;

/// A surface as columns see it: f = a t² + b t + c along each, b and c after where it stands.
#[derive(Clone, Copy, Default)]
pub(super) struct Surface {
    pub(super) a: f64,
    /// b = b₀ + b₁u + b₂v.
    pub(super) b: [f64; 3],
    /// c = c₀ + c₁u + c₂v + c₃u² + c₄v² + c₅uv.
    pub(super) c: [f64; 6],
}

impl Surface {
    /// `axes`: those of u, v and t, in cyclic order.
    pub(super) fn new(q: &Quadric, [u, v, t]: [usize; 3]) -> Self {
        Self {
            a: 0.5 * q.h[t],
            // q.m is numbered by the axis that is not there.
            b: [q.g[t], q.m[v], q.m[u]],
            c: [q.c, q.g[u], q.g[v], 0.5 * q.h[u], 0.5 * q.h[v], q.m[t]],
        }
    }
    #[inline(always)]
    pub(super) fn at(&self, u: f64, v: f64) -> [f64; 2] {
        let c = &self.c;
        let value = c[0] + u * (c[1] + c[3] * u + c[5] * v) + v * (c[2] + c[4] * v);
        [self.b[0] + self.b[1] * u + self.b[2] * v, value]
    }
    /// ∂f/∂u, ∂f/∂v and ∂f/∂t.
    #[inline(always)]
    pub(super) fn slope(&self, u: f64, v: f64, t: f64) -> [f64; 3] {
        let (b, c) = (&self.b, &self.c);
        [
            c[1] + 2.0 * c[3] * u + c[5] * v + b[1] * t,
            c[2] + 2.0 * c[4] * v + c[5] * u + b[2] * t,
            b[0] + b[1] * u + b[2] * v + 2.0 * self.a * t,
        ]
    }
    /// f at the end t of the columns, as a polynomial like c.
    pub(super) fn face(&self, t: f64) -> [f64; 6] {
        let (mut face, b) = (self.c, &self.b);
        face[0] += self.a * t * t + b[0] * t;
        face[1] += b[1] * t;
        face[2] += b[2] * t;
        face
    }
    /// The discriminant b² − 4ac as a polynomial like c.
    pub(super) fn discriminant(&self) -> [f64; 6] {
        let (b, c) = (&self.b, self.c.map(|c| 4.0 * self.a * c));
        [
            b[0] * b[0] - c[0],
            2.0 * b[0] * b[1] - c[1],
            2.0 * b[0] * b[2] - c[2],
            b[1] * b[1] - c[3],
            b[2] * b[2] - c[4],
            2.0 * b[1] * b[2] - c[5],
        ]
    }
    /// How steeply columns cross it.
    pub(super) fn flatness(&self) -> f64 {
        self.b[0].abs() / (self.c[1].abs() + self.c[2].abs() + self.b[0].abs())
    }
    /// Does f only grow, or only fall, along every column?
    pub(super) fn is_monotone(&self) -> bool {
        self.b[0].abs() - self.b[1].abs() - self.b[2].abs() > 2.0 * self.a.abs()
    }
    /// Where f = 0 on a monotone column; beyond ±1, on the right side, if it is nowhere.
    #[inline(always)]
    pub(super) fn root(&self, u: f64, v: f64) -> f64 {
        let [b, c] = self.at(u, v);
        -2.0 * c / (b + (b * b - 4.0 * self.a * c).max(0.0).sqrt().copysign(b))
    }
    /// Where f < 0 on a monotone column.
    #[inline(always)]
    pub(super) fn span(&self, u: f64, v: f64) -> [f64; 2] {
        let root = self.root(u, v).clamp(-1.0, 1.0);
        if self.b[0] > 0.0 { [-1.0, root] } else { [root, 1.0] }
    }
}

/// Where a·t² + b·t + c < 0 between −1 and 1: at most two spans, the first `n` count.
#[derive(Clone, Copy)]
pub(super) struct Spans {
    pub(super) n: usize,
    pub(super) span: [[f64; 2]; 2],
}

pub(super) const WHOLE: Spans = Spans { n: 1, span: [[-1.0, 1.0]; 2] };
pub(super) const NONE: Spans = Spans { n: 0, span: [[0.0; 2]; 2] };

#[inline]
pub(super) fn behind(a: f64, b: f64, c: f64) -> Spans {
    if b.abs() > 2.0 * a.abs() {
        // Monotone.
        let (low, high) = (a - b + c, a + b + c);
        if low >= 0.0 && high >= 0.0 {
            return NONE;
        }
        if low < 0.0 && high < 0.0 {
            return WHOLE;
        }
        let root = (-2.0 * c / (b + (b * b - 4.0 * a * c).max(0.0).sqrt().copysign(b))).clamp(-1.0, 1.0);
        let span = if b > 0.0 { [-1.0, root] } else { [root, 1.0] };
        return Spans { n: 1, span: [span; 2] };
    }
    let square = b * b - 4.0 * a * c;
    if square <= 0.0 {
        return if a + c < 0.0 || (a == 0.0 && c < 0.0) { WHOLE } else { NONE };
    }
    let far = -0.5 * (b + square.sqrt().copysign(b));
    let (r, s) = (far / a, if far == 0.0 { 0.0 } else { c / far });
    let (low, high) = (r.min(s), r.max(s));
    let mut out = NONE;
    let mut push = |from: f64, to: f64| {
        let span = [from.clamp(-1.0, 1.0), to.clamp(-1.0, 1.0)];
        if span[0] < span[1] {
            out.span[out.n] = span;
            out.n += 1;
        }
    };
    if a > 0.0 {
        push(low, high);
    } else {
        push(-1.0, low);
        push(high, 1.0);
    }
    out
}

/// Is anything behind all `surfaces` on the side of the box at `sign` of `axis`? Lines along axis `k` tell.
pub(crate) fn holds(surfaces: [Option<&Quadric>; 2], axis: usize, sign: f64, k: usize) -> bool {
    let across = 3 - axis - k;
    [-1.0, -0.6, -0.2, 0.2, 0.6, 1.0].into_iter().any(|v| {
        let spans = surfaces.map(|q| {
            let Some(q) = q else { return WHOLE };
            let seen = Surface::new(q, [axis, across, k]);
            let [b, c] = seen.at(sign, v);
            behind(seen.a, b, c)
        });
        let mut pairs = spans[0].span[..spans[0].n]
            .iter()
            .flat_map(|p| spans[1].span[..spans[1].n].iter().map(move |q| (p, q)));
        pairs.any(|(p, q)| p[0].max(q[0]) < p[1].min(q[1]))
    })
}
