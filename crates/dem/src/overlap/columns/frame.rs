//! Axes that make the overlap about as wide as it is thick.
use super::pair::{Pair, View};
use crate::Overlap;
use crate::overlap::integrals::Integrals;
use interfaces::{Point, Vector};
use nalgebra::{Matrix3, Matrix5, Vector5};

/// A point about in the middle of the overlap and three orthogonal half-axes of it, the last one leading from the first
/// body into the second. In coordinates along them the overlap is about a unit ball or lens.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub(super) origin: Vector,
    pub(super) axes: [Vector; 3],
    /// Whether the last axis leaves the overlap through the first body's surface and enters it through the second's.
    pub(super) lens: bool,
}

/// Sweeps that centre the origin.
const SWEEPS: usize = 2;
const SQRT_3: f64 = 1.732_050_807_568_877_2;

impl Frame {
    /// Centres `point`, which lies in both bodies, between the surfaces along a direction and across it in turns, the
    /// direction being made the mean of both normals; then the widths in three directions across give the axes.
    /// `None` where not even a line through the point has a length within both.
    pub(super) fn new(pair: &Pair, mut point: Vector, direction: Vector) -> Option<Self> {
        let mut e = direction.try_normalize(0.0)?;
        for _ in 0..SWEEPS {
            let thick = pair.shared(point, e)?;
            let (top, bottom) = (point + e * thick.leaves_a, point + e * thick.enters_b);
            point += e * thick.middle();
            if let (Some(n_a), Some(n_b)) = (pair.a.normal(top), pair.b.normal(bottom)) {
                let mean = n_a - n_b;
                // Normals that lead the same way say nothing.
                if mean.dot(&e) > 0.5 {
                    e = mean.normalize();
                }
            }
            for t in across(e) {
                point += t * pair.shared(point, t)?.middle();
            }
        }
        let thick = pair.shared(point, e)?;
        point += e * thick.middle();
        let [t1, t2] = across(e);
        // 1/w² = q₀ + q₁ cos 2φ + q₂ sin 2φ from three directions.
        let inverse = |t: Vector| pair.shared(point, t).map(|s| s.half().powi(-2));
        let q =
            [inverse(t1)?, inverse(0.5 * t1 + 0.5 * SQRT_3 * t2)?, inverse(0.5 * SQRT_3 * t2 - 0.5 * t1)?];
        let q0 = (q[0] + q[1] + q[2]) / 3.0;
        let (q1, q2) = ((2.0 * q[0] - q[1] - q[2]) / 3.0, (q[1] - q[2]) / SQRT_3);
        let varied = q1.hypot(q2);
        // The way in which 1/w² is largest.
        let [cos, sin] = half_angle(q1, q2);
        let narrow = 1.0 / (q0 + varied).sqrt();
        // Not an ellipse: never longer than it could be.
        let wide = 1.0 / (q0 - varied).max(1e-4 * q0).sqrt();
        let axes = [(cos * t1 + sin * t2) * narrow, (cos * t2 - sin * t1) * wide, e * thick.half()];
        // The ends of the thick line, as seen from the point before it was centred.
        let lens = thick.leaves_a == thick.ends[1] && thick.enters_b == thick.ends[0];
        Some(Self { origin: point, axes, lens })
    }
    /// The frame of the ellipse through five places of the edge of a lens, given in these coordinates: its plane is normal to
    /// their polygon's area. `None` where they lie on no ellipse.
    pub(super) fn refined(&self, pair: &Pair, edge: &[Vector; 5]) -> Option<Self> {
        let x = edge.map(|w| self.axes[0] * w[0] + self.axes[1] * w[1] + self.axes[2] * w[2]);
        let mean = x.iter().sum::<Vector>() / 5.0;
        let area: Vector = (0..5).map(|k| (x[k] - mean).cross(&(x[(k + 1) % 5] - mean))).sum();
        let e = area.try_normalize(0.0)?;
        let [t1, t2] = across(e);
        // a x² + 2b xy + c y² + d x + e y = 1 in units of the width.
        let unit = area.norm().sqrt();
        let places = x.map(|x| [t1.dot(&(x - mean)) / unit, t2.dot(&(x - mean)) / unit]);
        let rows = Matrix5::from_fn(|i, j| {
            let [x, y] = places[i];
            [x * x, 2.0 * x * y, y * y, x, y][j]
        });
        let q = rows.lu().solve(&Vector5::repeat(1.0))?;
        let det = q[0] * q[2] - q[1] * q[1];
        let centre = [0.5 * (q[1] * q[4] - q[2] * q[3]) / det, 0.5 * (q[1] * q[3] - q[0] * q[4]) / det];
        let whole = 1.0 - 0.5 * (q[3] * centre[0] + q[4] * centre[1]);
        let (half_sum, half_difference) = (0.5 * (q[0] + q[2]), 0.5 * (q[0] - q[2]));
        let varied = half_difference.hypot(q[1]);
        let narrow = unit * (whole / (half_sum + varied)).sqrt();
        let wide = unit * (whole / (half_sum - varied)).sqrt();
        if !(narrow > 0.0 && wide < 1e4 * narrow) {
            return None;
        }
        let [n1, n2] = half_angle(half_difference, q[1]);
        let mut origin = self.origin + mean + (t1 * centre[0] + t2 * centre[1]) * unit;
        let thick = pair.shared(origin, e)?;
        origin += e * thick.middle();
        let axes = [(n1 * t1 + n2 * t2) * narrow, (n1 * t2 - n2 * t1) * wide, e * thick.half()];
        let lens = thick.leaves_a == thick.ends[1] && thick.enters_b == thick.ends[0];
        Some(Self { origin, axes, lens })
    }
    /// Both bodies in these coordinates.
    pub(super) fn views<'a>(&self, pair: &Pair<'a>) -> [View<'a>; 2] {
        [pair.a.view(self.origin, &self.axes), pair.b.view(self.origin, &self.axes)]
    }
    /// Lengths of the axes.
    pub(super) fn lengths(&self) -> [f64; 3] {
        self.axes.each_ref().map(|v| v.norm())
    }
    /// Volume of the unit cube of these coordinates.
    pub(super) fn cell(&self) -> f64 {
        self.lengths().iter().product()
    }
    /// The point at the coordinates `x`, in the frame that the origin is given in.
    pub(super) fn point(&self, x: Vector) -> Point {
        Point::from(self.origin + self.axes[0] * x[0] + self.axes[1] * x[1] + self.axes[2] * x[2])
    }
    /// An area vector given by its parts in these coordinates.
    pub(super) fn area(&self, s: Vector) -> Vector {
        let [x, y, z] = self.axes;
        Matrix3::from_columns(&[y.cross(&z), z.cross(&x), x.cross(&y)]) * s
    }
}

/// Cosine and sine of half the angle of (x, y).
fn half_angle(x: f64, y: f64) -> [f64; 2] {
    let length = x.hypot(y);
    let cos = if length > 0.0 { x / length } else { 1.0 };
    [(0.5 * (1.0 + cos)).max(0.0).sqrt(), (0.5 * (1.0 - cos)).max(0.0).sqrt().copysign(y)]
}

/// Two directions across `e`.
fn across(e: Vector) -> [Vector; 2] {
    let mut other = Vector::zeros();
    other[e.iamin()] = 1.0;
    let t = e.cross(&other).normalize();
    [t, e.cross(&t)]
}

impl Frame {
    /// The overlap whose integrals in this frame, the moment along the axes but not stretched, are `sums`; `origin` is that of the
    /// frame in which this one is given.
    pub(super) fn overlap(&self, sums: &Integrals, origin: Point) -> Option<Overlap> {
        if sums.volume.is_nan() || sums.volume <= 0.0 {
            return None;
        }
        let middle = sums.first / sums.volume;
        let gradient = self.area(sums.area);
        let units = self.axes.map(|v| v.normalize());
        let about = units[0] * sums.moment[0] + units[1] * sums.moment[1] + units[2] * sums.moment[2];
        let centroid = self.point(middle);
        Some(Overlap {
            volume: sums.volume * self.cell(),
            centroid: origin + centroid.coords,
            normal: (-gradient).try_normalize(0.0).unwrap_or(-units[2]),
            gradient,
            moment: about - (centroid.coords - self.origin).cross(&gradient),
            pivot: nalgebra::Matrix3::zeros(),
        })
    }
}
