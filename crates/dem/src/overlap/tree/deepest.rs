//! Where two bodies overlap most, and how far.
use super::seen::Seen;
use interfaces::Vector;
use nalgebra::{Matrix2, Matrix3, SymmetricEigen};

/// Points along each axis where the search starts.
const GRID: usize = 5;
/// How often boxes are halved in the search for regions that no start led to.
const SCAN: usize = 4;
/// Directions along the contact in which its width is measured.
const RING: usize = 8;

/// A place where both bodies are deepest, max(d_A, d_B) < 0.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deepest {
    pub(crate) at: Vector,
    /// max(d_A, d_B) there \[m\], negative.
    pub(crate) level: f64,
    /// From the one body to the other, of unit length, up to its sign.
    pub(crate) across: Vector,
}

/// A box in the frame in which it was looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Oriented {
    pub(crate) centre: Vector,
    /// Its axes are the columns.
    pub(crate) axes: Matrix3<f64>,
    pub(crate) half: Vector,
}

/// Both bodies, in the frame around the `half`-widths that their boxes share.
#[derive(Clone, Copy)]
pub(crate) struct Search<'a> {
    pub(crate) bodies: [Seen<'a>; 2],
    pub(crate) half: Vector,
}

impl Search<'_> {
    fn size(&self) -> f64 {
        self.half.norm()
    }
    fn distances(&self, y: Vector) -> [f64; 2] {
        // Far enough for any place in the box to be told from any other.
        self.bodies.map(|b| b.distance(y, 4.0 * self.size()))
    }

    /// All of them that starts on a grid lead to.
    pub(crate) fn deepest(&self, found: &mut Vec<Deepest>) {
        found.clear();
        let mut levels = [0.0; GRID * GRID * GRID];
        let place = |i: usize| {
            let number = [i % GRID, i / GRID % GRID, i / (GRID * GRID)];
            Vector::from_fn(|a, _| self.half[a] * ((2 * number[a] + 1) as f64 / GRID as f64 - 1.0))
        };
        for (i, level) in levels.iter_mut().enumerate() {
            let cell = self.size() / GRID as f64;
            let [a, b] = self.bodies;
            *level = a.distance(place(i), 4.0 * self.size());
            if *level < cell {
                *level = b.distance(place(i), 4.0 * self.size()).max(*level);
            }
        }
        for i in 0..levels.len() {
            // Nothing within the cell, or a neighbour is deeper.
            if levels[i] < self.size() / GRID as f64 && is_least(&levels, i) {
                found.extend(self.descend(place(i)));
            }
        }
        found.sort_by(|p, q| p.level.total_cmp(&q.level));
    }

    /// Calls `see` with the centres and radii of boxes in which the bodies may share something, but for those that are `known`: what
    /// is left of the whole, halved [`SCAN`] times, without what the distances tell to be empty.
    pub(crate) fn scan(&self, known: impl Fn(Vector, f64) -> bool + Copy, see: &mut impl FnMut(Vector, f64)) {
        self.scan_box(Vector::zeros(), self.half, 0, known, see);
    }
    fn scan_box(
        &self,
        centre: Vector,
        half: Vector,
        depth: usize,
        known: impl Fn(Vector, f64) -> bool + Copy,
        see: &mut impl FnMut(Vector, f64),
    ) {
        let reach = half.norm();
        if known(centre, reach) {
            return;
        }
        let [a, b] = self.bodies;
        let level = a.distance(centre, 2.0 * reach);
        if level > reach {
            return;
        }
        let level = level.max(b.distance(centre, 2.0 * reach));
        if level > reach {
            return;
        }
        if depth == SCAN {
            if self.may_share(centre, reach) {
                see(centre, reach);
            }
            return;
        }
        for i in 0..8 {
            let side = Vector::from_fn(|a, _| if i >> a & 1 == 1 { 0.5 } else { -0.5 });
            let child = centre + half.component_mul(&side);
            self.scan_box(child, 0.5 * half, depth + 1, known, see);
        }
    }

    /// May the bodies share anything within `reach` of `x`? Not if for any weights w, 1 − w the weighted sum of the distances, linear
    /// but for a tenth of the reach, is positive there.
    fn may_share(&self, x: Vector, reach: f64) -> bool {
        let d = self.distances(x);
        let [a, b] = [0, 1].map(|i| self.bodies[i].normal(x, d[i], self.size()));
        (0..=4).all(|w| {
            let w = f64::from(w) / 4.0;
            w * d[0] + (1.0 - w) * d[1] <= reach * ((w * a + (1.0 - w) * b).norm() + 0.1)
        })
    }

    /// Down from `x`: the least of the larger of two functions by proximal steps,
    /// min over s of max(d_A + g_A·s, d_B + g_B·s) + s²/2t.
    pub(crate) fn descend(&self, mut x: Vector) -> Option<Deepest> {
        let mut t = 0.5 * self.half.max();
        let mut d = self.distances(x);
        let mut across = Vector::z();
        for _ in 0..60 {
            let [a, b] = [0, 1].map(|i| self.bodies[i].normal(x, d[i], self.size()));
            let apart = a - b;
            let square = apart.norm_squared();
            across = if square > 0.25 { apart } else { a + b };
            let level = d[0].max(d[1]);
            let mut moved = false;
            // What is left to gain.
            let mut gain = 0.0;
            for _ in 0..12 {
                let share = ((d[0] - d[1]) / t - b.dot(&apart)) / square;
                let share = if square > 1e-12 { share.clamp(0.0, 1.0) } else { f64::from(d[0] > d[1]) };
                let slope = b + share * apart;
                let least = share * d[0] + (1.0 - share) * d[1] - t * slope.norm_squared();
                gain = level - least;
                let next = x - t * slope;
                let there = self.distances(next);
                let won = level - there[0].max(there[1]);
                if won > 0.1 * gain {
                    (x, d, moved) = (next, there, true);
                    if won > 0.6 * gain {
                        t *= 2.0;
                    }
                    break;
                }
                t *= 0.25;
            }
            if !moved || gain < 0.02 * d[0].max(d[1]).abs() {
                break;
            }
        }
        let level = d[0].max(d[1]);
        if level >= 0.0 {
            return None;
        }
        // One of them alone decides deep within the other.
        let [a, b] = [0, 1].map(|i| self.bodies[i].normal(x, d[i], self.size()));
        if (d[0] - d[1]).abs() > 0.5 * level.abs() {
            across = if d[0] > d[1] { a } else { b };
        }
        Some(Deepest { at: x, level, across: across.try_normalize(0.0).unwrap_or(Vector::z()) })
    }

    /// A box across the contact around the region at its deepest place, which may reach beyond it.
    pub(crate) fn around(&self, deepest: &Deepest) -> Oriented {
        let n = deepest.across;
        // The same whichever way it points.
        let n = if n[n.iamax()] < 0.0 { -n } else { n };
        let u = n.cross(&Vector::ith(n.iamin(), 1.0)).normalize();
        let v = n.cross(&u);
        let ring: [Vector; RING] = std::array::from_fn(|i| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / RING as f64).sin_cos();
            cos * u + sin * v
        });
        let widths = self.widths(deepest, &ring);
        let [above, below] = self.widths(deepest, &[n, -n]);
        // 1/w² = eᵀQe, by least squares over the directions e.
        let mut q = Matrix2::zeros();
        let (mut mean, mut cos2, mut sin2) = (0.0, 0.0, 0.0);
        for (i, w) in widths.iter().enumerate() {
            let angle = 2.0 * std::f64::consts::TAU * i as f64 / RING as f64;
            let inverse = 1.0 / (w * w);
            mean += inverse / RING as f64;
            cos2 += inverse * angle.cos() * 2.0 / RING as f64;
            sin2 += inverse * angle.sin() * 2.0 / RING as f64;
        }
        q[(0, 0)] = mean + cos2;
        q[(1, 1)] = mean - cos2;
        q[(0, 1)] = sin2;
        q[(1, 0)] = sin2;
        let eigen = SymmetricEigen::new(q);
        let along = |i: usize| (eigen.eigenvectors[(0, i)] * u + eigen.eigenvectors[(1, i)] * v).normalize();
        // Bodies of revolution leave the axes open.
        let round = (cos2 * cos2 + sin2 * sin2).sqrt() < 0.05 * mean;
        let u = if round { u } else { along(0) };
        let axes = Matrix3::from_columns(&[u, n.cross(&u), n]);
        // How far the ends of the measured widths come along each axis, or the ellipse through them.
        let mut low = Vector::new(0.0, 0.0, -below);
        let mut high = Vector::new(0.0, 0.0, above);
        for (e, w) in ring.iter().zip(widths) {
            for a in 0..2 {
                let end = w * e.dot(&axes.column(a));
                (low[a], high[a]) = (low[a].min(end), high[a].max(end));
            }
        }
        let half = (0.53 * (high - low)).zip_map(&Vector::repeat(1e-12 * self.size()), f64::max);
        Oriented { centre: deepest.at + axes * (0.5 * (low + high)), axes, half }
    }

    /// How far the region reaches from its deepest place along each of some directions.
    fn widths<const N: usize>(&self, deepest: &Deepest, directions: &[Vector; N]) -> [f64; N] {
        let depth = -deepest.level;
        let most = 2.0 * self.size();
        let (mut last, mut width) = ([(0.0, -depth); N], [most; N]);
        let mut open = [true; N];
        let mut s = depth;
        while s < most && open.contains(&true) {
            let points = directions.map(|e| deepest.at + s * e);
            let [a, b] = self.bodies.map(|body| body.distances(&points, 2.0 * s));
            for i in 0..N {
                let level = a[i].max(b[i]);
                if open[i] && level >= 0.0 {
                    // A parabola through both.
                    let (from, f) = last[i];
                    width[i] = (from * from + (s * s - from * from) * f / (f - level)).sqrt();
                    open[i] = false;
                }
                last[i] = (s, level);
            }
            s *= 1.5;
        }
        width
    }
}

/// Is value `i` of a grid no more than those around?
fn is_least(levels: &[f64], i: usize) -> bool {
    let at = [i % GRID, i / GRID % GRID, i / (GRID * GRID)];
    let range = |a: usize| at[a].saturating_sub(1)..=(at[a] + 1).min(GRID - 1);
    for z in range(2) {
        for y in range(1) {
            for x in range(0) {
                let other = x + GRID * (y + GRID * z);
                // Of equals the first.
                if levels[other] < levels[i] || (levels[other] == levels[i] && other < i) {
                    return false;
                }
            }
        }
    }
    true
}
