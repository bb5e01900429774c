//! A cone on which the curve lies, and its lines.
use interfaces::Vector;
use std::f64::consts::TAU;

/// Lines at which it is looked how much of them is within the sphere.
const LOOKS: usize = 16;
/// Halvings at most.
const HALVINGS: usize = 100;
/// A step of Newton's method that is nearly the last one.
const CLOSE: f64 = 1e-9;
/// Farther away, in radii of the sphere, a vertex leads to lines whose places are rounded too much.
const FARTHEST: f64 = 1e4;
/// Eigenvalues less than this share of all apart make a cone too flat.
const FLATTEST: f64 = 1e-6;

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
        let ends = [c[order[first]], c[order[first + 1]]];
        let size = c.amax() + b.amax();
        let squares = b.component_mul(&b);
        // Times the product of all cᵢ − μ.
        let equation = |mu: f64| {
            let [p, q, r] = [c.x - mu, c.y - mu, c.z - mu];
            let [x, y, z] = [squares.x, squares.y, squares.z];
            [
                mu * p * q * r - x * q * r - y * p * r - z * p * q,
                p * q * r - mu * (q * r + p * r + p * q) + x * (q + r) + y * (p + r) + z * (p + q),
            ]
        };
        let mu = zero(ends, first == 1, CLOSE * size, equation);
        let gaps = c.map(|c| c - mu);
        if !(gaps.map(f64::abs).min() > FLATTEST * size && size.is_finite()) {
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
    /// The square of half a line's length within the sphere, times that of |d|², and its change with t.
    fn chord(&self, t: f64) -> [f64; 2] {
        let (sin, cos) = t.sin_cos();
        let [[d, dd], [m, dm]] = [&self.directions, &self.moments].map(|x| around(x, sin, cos));
        [d.norm_squared() - m.norm_squared(), 2.0 * (d.dot(&dd) - m.dot(&dm))]
    }
    /// The pieces of the curve; `None` where there are none.
    pub(super) fn pieces(&self) -> Option<Pieces> {
        let chords = Chords::new(self);
        let (step_sin, step_cos) = (TAU / LOOKS as f64).sin_cos();
        let (mut sin, mut cos) = (0.0, 1.0);
        let (mut least, mut most, mut largest) = (f64::INFINITY, 0.0_f64, (0.0, 0.0));
        for k in 0..LOOKS {
            let chord = chords.at(sin, cos);
            (least, most) = (least.min(chord), most.max(chord));
            if chord.abs() > largest.0 {
                largest = (chord.abs(), TAU * k as f64 / LOOKS as f64);
            }
            (sin, cos) = (sin * step_cos + cos * step_sin, cos * step_cos - sin * step_sin);
        }
        // From where no end is near, half a circle to either side.
        let from = largest.1 - 0.5 * TAU;
        let quartic = self.turned(from).quartic();
        let (roots, number) = roots(&quartic);
        let positive = quartic[4] > 0.0;
        if number == 0 {
            let found = [Piece::Round(1.0), Piece::Round(-1.0)];
            return (positive && least > 0.0).then_some(Pieces { found, number: 2, smooth: least / most });
        }
        if number % 2 == 1 {
            return None;
        }
        let ends = roots.map(|u| self.polished(from + 2.0 * u.atan()));
        let (mut found, mut smooth) = ([Piece::Round(0.0); 2], f64::INFINITY);
        for (k, piece) in found.iter_mut().take(number / 2).enumerate() {
            let first = usize::from(positive);
            let [low, next] = [first, first + 1].map(|i| ends[(2 * k + i) % number]);
            let high = if next > low { next } else { next + TAU };
            let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
            *piece = Piece::Between { middle, half };
            let shares = SHARES.iter().map(|(sin, cos)| {
                let (sin, along) = (middle + half * sin).sin_cos();
                chords.at(sin, along) / (cos * cos)
            });
            let (least, most) =
                shares.fold((f64::INFINITY, 0.0), |(low, high), x| (f64::min(low, x), f64::max(high, x)));
            smooth = smooth.min(least / most);
        }
        (smooth > 0.0).then_some(Pieces { found, number: number / 2, smooth })
    }
    /// The chord as a function of the line's place after `from`.
    fn turned(&self, from: f64) -> Chords {
        let (sin, cos) = from.sin_cos();
        let turn = |[x, y, z]: &[Vector; 3]| [*x, y * cos + z * sin, z * cos - y * sin];
        Chords::new(&Self {
            vertex: self.vertex,
            directions: turn(&self.directions),
            moments: turn(&self.moments),
        })
    }
    /// An end of a piece, by Newton's method with all digits.
    fn polished(&self, mut t: f64) -> f64 {
        for _ in 0..3 {
            let [chord, slope] = self.chord(t);
            let step = chord / slope;
            if step.abs() < 1e-4 {
                t -= step;
            }
        }
        t
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

/// [`Cone::chord`] as q₀ + q₁ cos t + q₂ sin t + q₃ cos² t + q₄ sin² t + q₅ cos t sin t: fewer steps, but digits are lost where the
/// vertex is far.
struct Chords([f64; 6]);

impl Chords {
    fn new(cone: &Cone) -> Self {
        let product = |i: usize, j: usize| {
            cone.directions[i].dot(&cone.directions[j]) - cone.moments[i].dot(&cone.moments[j])
        };
        let twice = |i, j| 2.0 * product(i, j);
        Self([product(0, 0), twice(0, 1), twice(0, 2), product(1, 1), product(2, 2), twice(1, 2)])
    }
    #[inline]
    fn at(&self, sin: f64, cos: f64) -> f64 {
        let [q0, q1, q2, q3, q4, q5] = self.0;
        q0 + cos * (q1 + q3 * cos + q5 * sin) + sin * (q2 + q4 * sin)
    }
    /// Times (1 + u²)² with u = tan ½t, from the constant to u⁴.
    fn quartic(&self) -> [f64; 5] {
        let [q0, q1, q2, q3, q4, q5] = self.0;
        [q0 + q1 + q3, 2.0 * (q2 + q5), 2.0 * (q0 - q3) + 4.0 * q4, 2.0 * (q2 - q5), q0 - q1 + q3]
    }
}

/// All real roots of a quartic, upwards, and their number: between places where it is steepest, least and largest, which are roots of
/// its derivatives.
fn roots(quartic: &[f64; 5]) -> ([f64; 4], usize) {
    let bound = 1.0 + quartic.iter().fold(0.0, |most, q| f64::max(most, (q / quartic[4]).abs()));
    let (mut roots, mut n) = ([0.0; 4], 0);
    for degree in 1..=4 {
        // The derivative of this degree, and its own.
        let mut p = *quartic;
        for order in (degree..4).rev() {
            for k in 0..=order {
                p[k] = (k + 1) as f64 * p[k + 1];
            }
        }
        let value = |u: f64| {
            let both = (0..=degree).rev().fold([0.0, 0.0], |[f, df], k| [f * u + p[k], df * u + f]);
            [both[0], both[1]]
        };
        let (mut now, mut found, mut low) = ([0.0; 4], 0, -bound);
        for k in 0..=n {
            let high = if k < n { roots[k] } else { bound };
            let [positive, after] = [low, high].map(|u| value(u)[0] > 0.0);
            if positive != after {
                now[found] = zero([low, high], positive, CLOSE, value);
                found += 1;
            }
            low = high;
        }
        (roots, n) = (now, found);
    }
    (roots, n)
}

/// Sines and cosines at places where pieces are looked at.
#[rustfmt::skip]
const SHARES: [(f64, f64); 8] = [
    (-0.9807852804032304, 0.19509032201612828), (-0.8314696123025452, 0.5555702330196022),
    (-0.5555702330196022, 0.8314696123025452), (-0.19509032201612828, 0.9807852804032304),
    (0.19509032201612828, 0.9807852804032304), (0.5555702330196022, 0.8314696123025452),
    (0.8314696123025452, 0.5555702330196022), (0.9807852804032304, 0.19509032201612828),
];

/// Where a function that is given with its slope changes its sign between `ends`, being `positive` before: Newton's method between
/// brackets, until two steps are so small that the second is rounding.
fn zero([mut low, mut high]: [f64; 2], positive: bool, close: f64, f: impl Fn(f64) -> [f64; 2]) -> f64 {
    let (mut t, mut nearly) = (0.5 * (low + high), false);
    for _ in 0..HALVINGS {
        let [value, slope] = f(t);
        if (value > 0.0) == positive {
            low = t
        } else {
            high = t
        }
        let step = value / slope;
        let next = t - step;
        let small = step.abs() < close;
        t = if small || (next > low && next < high) { next } else { 0.5 * (low + high) };
        if small && nearly {
            break;
        }
        nearly = small;
    }
    t
}
