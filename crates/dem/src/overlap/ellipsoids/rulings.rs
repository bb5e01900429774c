//! A cone on which the curve lies, and its lines.
use interfaces::Vector;
use std::f64::consts::{PI, TAU};

/// Lines at which it is looked whether they meet the sphere.
const LOOKS: usize = 32;
/// Halvings at most.
const HALVINGS: usize = 100;
/// A step of Newton's method that is nearly the last.
const CLOSE: f64 = 1e-9;
/// Farther away, in radii of the sphere, a vertex leads to lines whose places are rounded too much.
const FARTHEST: f64 = 1e4;
/// Eigenvalues less than this share of all apart make a cone too flat.
const FLATTEST: f64 = 1e-7;

/// A cone with its vertex v and the lines v + s d(t), d = (1, r cos t, r' sin t) in the order of axes that is its own.
///
/// With C = diag(c) and D = 2b·w + wᵀCw, D + μ(|w|² − 1) vanishes on the curve, and is a cone with its vertex at
/// vᵢ = −bᵢ/(cᵢ − μ) where μ = Σ bᵢ²/(cᵢ − μ). Between two eigenvalues μ minus that sum falls from ∞ to −∞.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    vertex: Vector,
    /// d, and the moment m = v × d, without and with cos t and sin t.
    directions: [Vector; 3],
    moments: [Vector; 3],
}

/// A closed piece of the curve.
#[derive(Clone, Copy, Debug)]
pub(super) enum Piece {
    /// All lines, which meet the sphere in two places, each on a piece of its own: that on which w·d has this sign.
    Round(f64),
    /// Lines with t from `middle` − `half` to `middle` + `half`, at the ends of which both places are one.
    Between { middle: f64, half: f64 },
}

/// The pieces of the curve, no more than two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pieces {
    found: [Piece; 2],
    number: usize,
    /// The least share of the largest square of half a line's length within the sphere, at the ends of a piece as a share of
    /// what it is for half a circle: the larger, the smoother the pieces.
    pub(super) smooth: f64,
}

impl Pieces {
    pub(super) fn iter(&self) -> impl Iterator<Item = &Piece> {
        self.found[..self.number].iter()
    }
}

impl Cone {
    /// The cone between the eigenvalue `first` in order (0 or 1) and the next, if it is a good one.
    pub(super) fn new(c: Vector, b: Vector, first: usize) -> Option<Self> {
        let mut order = [0, 1, 2];
        order.sort_by(|i, j| c[*i].total_cmp(&c[*j]));
        let [mut low, mut high] = [c[order[first]], c[order[first + 1]]];
        let (size, least) = (c.amax() + b.amax(), FLATTEST * (c.amax() + b.amax()));
        for _ in 0..HALVINGS {
            let mu = 0.5 * (low + high);
            if mu <= low || mu >= high {
                break;
            }
            let falls = mu - (0..3).map(|i| b[i] * b[i] / (c[i] - mu)).sum::<f64>();
            if falls > 0.0 { low = mu } else { high = mu }
        }
        let mu = 0.5 * (low + high);
        let gaps = c.map(|c| c - mu);
        if !(gaps.map(f64::abs).min() > least && size.is_finite()) {
            return None;
        }
        // The eigenvalue alone on its side of μ is the axis.
        let axes = if first == 0 { order } else { [order[2], order[0], order[1]] };
        let ratio = |i: usize| {
            let mut v = Vector::zeros();
            v[axes[i]] = (gaps[axes[0]] / gaps[axes[i]]).abs().sqrt();
            v
        };
        let vertex = -b.component_div(&gaps);
        let directions = [0, 1, 2].map(ratio);
        let moments = directions.map(|d| vertex.cross(&d));
        (vertex.norm() < FARTHEST).then_some(Self { vertex, directions, moments })
    }
    /// The square of half a line's length within the sphere, times that of |d|², as |d|² − |m|², which cancels least; its
    /// change with t and that of this.
    fn chord(&self, t: f64) -> [f64; 3] {
        let (sin, cos) = t.sin_cos();
        let [[d, dd], [m, dm]] = [&self.directions, &self.moments].map(|x| around(x, sin, cos));
        let bend = |x: &Vector, dx: &Vector, still: &Vector| dx.norm_squared() + x.dot(&(still - x));
        [
            d.norm_squared() - m.norm_squared(),
            2.0 * (d.dot(&dd) - m.dot(&dm)),
            2.0 * (bend(&d, &dd, &self.directions[0]) - bend(&m, &dm, &self.moments[0])),
        ]
    }
    /// The pieces of the curve; `None` where there are none or too many.
    pub(super) fn pieces(&self) -> Option<Pieces> {
        let mut looks = [(0.0, [0.0; 3]); 2 * LOOKS];
        let mut n = 0;
        let mut last = (0.0, self.chord(0.0));
        for k in 1..=LOOKS {
            let t = TAU * k as f64 / LOOKS as f64;
            let now = (t, self.chord(t));
            looks[n] = last;
            n += 1;
            // An extreme place in between may have the other sign.
            let ([f, df, _], [g, dg, _]) = (last.1, now.1);
            if (f > 0.0) == (g > 0.0) && (df > 0.0) != (dg > 0.0) && (df < 0.0) == (f > 0.0) {
                let at = zero([last.0, t], |t| {
                    let [_, slope, bend] = self.chord(t);
                    [slope, bend]
                });
                looks[n] = (at, self.chord(at));
                n += 1;
            }
            last = now;
        }
        let looks = &looks[..n];
        let most = looks.iter().map(|l| l.1[0]).fold(0.0, f64::max);
        // Where the sign changes, from the first change upwards.
        let (mut ends, mut number, mut first) = ([0.0; 4], 0, 0);
        for (i, look) in looks.iter().enumerate() {
            let next = if i + 1 == n { (TAU, looks[0].1) } else { looks[i + 1] };
            if (look.1[0] > 0.0) != (next.1[0] > 0.0) {
                if number == ends.len() {
                    return None;
                }
                if number == 0 && look.1[0] > 0.0 {
                    first = 1;
                }
                ends[number] = zero([look.0, next.0], |t| {
                    let [chord, slope, _] = self.chord(t);
                    [chord, slope]
                });
                number += 1;
            }
        }
        if number == 0 {
            let least = looks.iter().map(|l| l.1[0]).fold(f64::INFINITY, f64::min);
            let found = [Piece::Round(1.0), Piece::Round(-1.0)];
            return (least > 0.0).then_some(Pieces { found, number: 2, smooth: least / most });
        }
        let mut found = [Piece::Round(0.0); 2];
        let mut smooth = f64::INFINITY;
        for (k, piece) in found.iter_mut().take(number / 2).enumerate() {
            let low = ends[(2 * k + first) % number];
            let next = ends[(2 * k + first + 1) % number];
            let high = if next > low { next } else { next + TAU };
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            *piece = Piece::Between { middle, half };
            let shares = (0..LOOKS / 2).map(|k| {
                let (sin, cos) = (PI * ((k as f64 + 0.5) / (LOOKS / 2) as f64 - 0.5)).sin_cos();
                self.chord(middle + half * sin)[0] / (cos * cos)
            });
            let (least, most) =
                shares.fold((f64::INFINITY, 0.0), |(low, high), x| (f64::min(low, x), f64::max(high, x)));
            smooth = smooth.min(least / most);
        }
        (smooth > 0.0).then_some(Pieces { found, number: number / 2, smooth })
    }
    /// The place on the sphere at s of a period of a piece, and its change with s. Between two ends t is
    /// `middle` + `half` sin s and half a line's length a smooth function of s times cos s.
    #[inline]
    pub(super) fn place(&self, piece: &Piece, s: f64) -> [Vector; 2] {
        let (t, half, side, [dt, sign]) = match *piece {
            Piece::Round(sign) => (s, 1.0, sign, [1.0, sign]),
            Piece::Between { middle, half } => {
                let (sin, cos) = s.sin_cos();
                (middle + half * sin, half, cos, [cos, 1.0])
            }
        };
        let (sin, cos) = t.sin_cos();
        let [[d, change], [m, _]] = [&self.directions, &self.moments].map(|x| around(x, sin, cos));
        let square = d.norm_squared();
        let root = (square - m.norm_squared()).max(0.0).sqrt() / side.abs();
        let w = (d.cross(&m) + d * (side * root)) / square;
        let reach = (side * root - self.vertex.dot(&d)) / square;
        // From |w| = 1: dw/dt = reach (d' − d (w·d')/(w·d)), and w·d = side root.
        let aside = w.dot(&change) / root * sign;
        [w, (change * dt - d * aside) * (reach * half)]
    }
}

/// x + y cos t + z sin t and its change with t.
#[inline]
fn around([x, y, z]: &[Vector; 3], sin: f64, cos: f64) -> [Vector; 2] {
    [x + y * cos + z * sin, z * cos - y * sin]
}

/// Where a function that is given with its slope changes its sign between `ends`: Newton's method between brackets, until two steps
/// are so small that the second is rounding.
fn zero([mut low, mut high]: [f64; 2], f: impl Fn(f64) -> [f64; 2]) -> f64 {
    let positive = f(low)[0] > 0.0;
    let (mut t, mut close) = (0.5 * (low + high), false);
    for _ in 0..HALVINGS {
        let [value, slope] = f(t);
        if (value > 0.0) == positive {
            low = t
        } else {
            high = t
        }
        let step = value / slope;
        let next = t - step;
        let small = step.abs() < CLOSE;
        t = if small || (next > low && next < high) { next } else { 0.5 * (low + high) };
        if small && close {
            break;
        }
        close = small;
    }
    t
}
