//! Boxes that regions are looked at in.
use super::deepest::{Deepest, Search};
use super::grow::{self, Tree};
use interfaces::Vector;
use nalgebra::{Matrix2, Matrix3, SymmetricEigen};

/// Directions along the contact in which its width is measured.
const RING: usize = 8;
/// How often the middle of a region is looked for.
const CHORDS: usize = 4;

/// Two directions along a plane of unit normal `n`, at right angles, as (u, v, n) turn like the axes.
pub(crate) fn tangents(n: Vector) -> [Vector; 2] {
    let u = n.cross(&Vector::ith(n.iamin(), 1.0)).normalize();
    [u, n.cross(&u)]
}

/// A box in the frame in which it was looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Oriented {
    pub(crate) centre: Vector,
    /// Its axes are the columns.
    pub(crate) axes: Matrix3<f64>,
    pub(crate) half: Vector,
}

impl Oriented {
    /// As a frame sees it in which this one's axes are the columns of `axes`.
    pub(crate) fn turn(&mut self, axes: &Matrix3<f64>) {
        self.centre = axes * self.centre;
        self.axes = axes * self.axes;
    }
    pub(crate) fn local(&self, x: Vector) -> Vector {
        self.axes.transpose() * (x - self.centre)
    }
    pub(crate) fn holds(&self, x: Vector) -> bool {
        self.holds_ball(x, 0.0)
    }
    /// Does it hold all that is within `reach` of `x`?
    pub(crate) fn holds_ball(&self, x: Vector, reach: f64) -> bool {
        let x = self.local(x);
        (0..3).all(|a| x[a].abs() + reach <= self.half[a])
    }
    /// Lower and upper corner, in this box's frame, of all of the other one.
    pub(crate) fn reach(&self, o: &Self) -> [Vector; 2] {
        let (middle, half) = (self.local(o.centre), (self.axes.transpose() * o.axes).abs() * o.half);
        [middle - half, middle + half]
    }
    pub(crate) fn may_meet(&self, o: &Self) -> bool {
        let meets = |a: &Self, b: &Self| {
            let [low, high] = a.reach(b);
            (0..3).all(|i| low[i] <= a.half[i] && high[i] >= -a.half[i])
        };
        meets(self, o) && meets(o, self)
    }
    pub(crate) fn set(&mut self, low: Vector, high: Vector) {
        self.centre += self.axes * (0.5 * (low + high));
        self.half = 0.5 * (high - low);
    }

    /// Half as large again where what it holds comes to its sides, but no larger than what holds all, of half-widths
    /// `limit` around the origin; tells whether it was.
    pub(crate) fn widen(&mut self, tree: &Tree, limit: Vector) -> bool {
        let mut touched = [[false; 2]; 3];
        for node in tree.nodes.iter().filter(|n| n.leaf != grow::NONE) {
            let (leaf, half) = (&tree.leaves[node.leaf as usize], tree.half_at(node.level));
            for (a, touched) in touched.iter_mut().enumerate() {
                let edge = (1.0 - 1e-9) * self.half[a] - half[a];
                for (end, sign) in [-1.0, 1.0].into_iter().enumerate() {
                    touched[end] |= sign * node.centre[a] > edge && leaf.reaches(a, sign);
                }
            }
        }
        let whole = Self { centre: Vector::zeros(), axes: Matrix3::identity(), half: (1.0 + 1e-9) * limit };
        let [least, most] = self.reach(&whole);
        let (mut low, mut high) = (-self.half, self.half);
        for a in 0..3 {
            if touched[a][0] {
                low[a] = (-2.0 * self.half[a]).max(least[a]).min(low[a]);
            }
            if touched[a][1] {
                high[a] = (2.0 * self.half[a]).min(most[a]).max(high[a]);
            }
        }
        let widened = low != -self.half || high != self.half;
        if widened {
            self.set(low, high);
        }
        widened
    }
}

impl Search<'_> {
    /// A box across the contact around the region at its deepest place, which may reach beyond it.
    pub(crate) fn around(&self, deepest: &Deepest) -> Oriented {
        let n = deepest.across;
        // The same whichever way it points.
        let n = if n[n.iamax()] < 0.0 { -n } else { n };
        let [u, v] = tangents(n);
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

    /// Deeper places in a convex region, whose distances have ridges along which steps down come to a halt: middles of chords.
    pub(crate) fn central(&self, mut deepest: Deepest) -> Deepest {
        for _ in 0..CHORDS {
            match self.stay(self.around(&deepest).centre) {
                Some(other) if other.level < 1.1 * deepest.level => deepest = other,
                _ => break,
            }
        }
        deepest
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
            s *= 2.0;
        }
        width
    }
}
