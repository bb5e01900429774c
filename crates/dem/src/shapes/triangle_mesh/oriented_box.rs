//! Boxes of any orientation.
use interfaces::Vector;

/// Relative round-off of a coordinate along an axis, some forty roundings.
const ROUND_OFF: f64 = 1e-14;

/// A box along axes of its own. It holds its points in spite of round-off.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OrientedBox {
    /// Unit vectors at right angles.
    axes: [Vector; 3],
    /// Centre, in coordinates along the axes \[m\].
    middle: Vector,
    /// Half edges \[m\].
    half: Vector,
}

impl OrientedBox {
    /// The least box along `axes` around `points`.
    pub(crate) fn along(axes: [Vector; 3], points: impl Iterator<Item = Vector>) -> Self {
        let start = (Vector::repeat(f64::INFINITY), Vector::repeat(f64::NEG_INFINITY));
        let turned = points.map(|p| Vector::from(axes.map(|a| a.dot(&p))));
        let (low, high) = turned.fold(start, |(low, high), p| (low.inf(&p), high.sup(&p)));
        let round_off = Vector::repeat(ROUND_OFF * low.abs().sup(&high.abs()).max());
        let half = (high - low) * (0.5 * (1.0 + 1e-12)) + round_off;
        Self { axes, middle: 0.5 * (low + high), half }
    }

    /// A box around `points` along the line from the first to the farthest, and the plane of these
    /// two and the point farthest from their line.
    pub(crate) fn around(points: impl Iterator<Item = Vector> + Clone) -> Self {
        let start = points.clone().next().unwrap_or_default();
        let longest = |a: Vector, b: Vector| if b.norm_squared() > a.norm_squared() { b } else { a };
        let far = points.clone().fold(Vector::zeros(), |most, p| longest(most, p - start));
        let along = far.try_normalize(0.0).unwrap_or_else(Vector::x);
        let level = |p: Vector| (p - start) - along * along.dot(&(p - start));
        let side = points.clone().fold(Vector::zeros(), |most, p| longest(most, level(p)));
        let any = along.cross(&Vector::ith(along.iamin(), 1.0));
        // Removes what round-off leaves along the line.
        let square = |v: Vector| (v - along * along.dot(&v)).try_normalize(0.0);
        let across =
            side.try_normalize(0.0).and_then(square).or_else(|| square(any)).unwrap_or_else(Vector::y);
        Self::along([along, across, along.cross(&across)], points)
    }

    /// A measure of its extent: the sum of its half edges \[m\].
    pub(crate) fn size(&self) -> f64 {
        self.half.sum()
    }

    /// The square of the distance of `x` from the box, which is not more than that from any of its
    /// points.
    #[inline]
    pub(crate) fn square_distance(&self, x: Vector) -> f64 {
        let turned = Vector::from(self.axes.map(|a| a.dot(&x)));
        let gap = (turned - self.middle).abs() - self.half;
        gap.map(|g| g.max(0.0)).norm_squared()
    }

    /// Distance along a unit vector from `from` to the box: 0 within, `None` if the ray misses it.
    pub(crate) fn ahead(&self, from: Vector, along: Vector) -> Option<f64> {
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for a in 0..3 {
            let (x, slope) = (self.axes[a].dot(&from) - self.middle[a], self.axes[a].dot(&along));
            if slope == 0.0 {
                if x.abs() > self.half[a] {
                    return None;
                }
                continue;
            }
            let (middle, half) = (-x / slope, (self.half[a] / slope).abs());
            enter = enter.max(middle - half);
            leave = leave.min(middle + half);
        }
        (enter <= leave * (1.0 + 1e-12)).then_some(enter * (1.0 - 1e-12))
    }

    /// Whether a plane parts the two boxes: one along a face of either, or along an edge of both
    /// (Gottschalk, Lin & Manocha 1996, "OBBTree").
    pub(crate) fn is_apart(&self, other: &Self) -> bool {
        let centre = |b: &Self| b.axes[0] * b.middle.x + b.axes[1] * b.middle.y + b.axes[2] * b.middle.z;
        let way = centre(other) - centre(self);
        let (mut turn, mut reach) = ([[0.0; 3]; 3], [[0.0; 3]; 3]);
        let t = self.axes.map(|a| a.dot(&way));
        let round_off = ROUND_OFF * (t[0].abs() + t[1].abs() + t[2].abs());
        for i in 0..3 {
            for j in 0..3 {
                turn[i][j] = self.axes[i].dot(&other.axes[j]);
                reach[i][j] = turn[i][j].abs() + ROUND_OFF;
            }
            let others = (0..3).map(|j| other.half[j] * reach[i][j]).sum::<f64>();
            if t[i].abs() > self.half[i] + others + round_off {
                return true;
            }
        }
        for j in 0..3 {
            let own = (0..3).map(|i| self.half[i] * reach[i][j]).sum::<f64>();
            if other.axes[j].dot(&way).abs() > own + other.half[j] + round_off {
                return true;
            }
        }
        (0..9).any(|pair| {
            let (i, j) = (pair / 3, pair % 3);
            let ([i1, i2], [j1, j2]) = ([(i + 1) % 3, (i + 2) % 3], [(j + 1) % 3, (j + 2) % 3]);
            let own = self.half[i1] * reach[i2][j] + self.half[i2] * reach[i1][j];
            let others = other.half[j1] * reach[i][j2] + other.half[j2] * reach[i][j1];
            (t[i2] * turn[i1][j] - t[i1] * turn[i2][j]).abs() > own + others + round_off
        })
    }
}
