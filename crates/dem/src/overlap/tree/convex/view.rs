//! Both bodies as the centre of a convex region sees them.
use super::super::around::{Oriented, tangents};
use super::super::deepest::{Deepest, Search};
use super::super::seen::Seen;
use super::parted::Face;
use super::polytope::{Corner, Side};
use interfaces::Vector;

/// Differences over this share of the region's width are slopes.
const STEP: f64 = 1e-5;
/// Faces are flat that are it this far to one side, as a share of the region's width.
const BESIDE: f64 = 0.02;
/// How far out towards a side's outline the surface below is looked for: there the mean of a square and of a cube along the way
/// are known both.
const OUT: f64 = 0.8;

/// From the deepest place, along the axes of a box around.
pub(super) struct View<'a> {
    bodies: [Seen<'a>; 2],
    band: f64,
    /// d_A and d_B at the centre \[m\].
    depth: [f64; 2],
    step: f64,
    /// Distances that are all but nothing \[m\].
    pub(super) small: f64,
    /// Heights that are nothing \[m\].
    pub(super) slack: f64,
    /// Of the region's size \[m²\].
    pub(super) area: f64,
}

impl<'a> View<'a> {
    pub(super) fn new(search: &Search<'a>, deepest: &Deepest, around: &Oriented, tolerance: f64) -> Self {
        let width = around.half.max();
        Self {
            bodies: search.bodies.map(|b| b.within(&around.axes, deepest.at)),
            band: 8.0 * search.size(),
            depth: deepest.distances,
            step: STEP * width,
            small: 0.01 * tolerance.min(1e-3) * -deepest.level,
            slack: 1e-7 * -deepest.level,
            area: around.half.product() / around.half.min(),
        }
    }
    pub(super) fn distance(&self, body: usize, x: Vector) -> f64 {
        self.bodies[body].distance(x, self.band)
    }
    pub(super) fn distances(&self, x: Vector) -> [f64; 2] {
        [0, 1].map(|i| self.distance(i, x))
    }
    pub(super) fn is_small(&self, d: [f64; 2]) -> bool {
        (0..2).all(|i| d[i].abs() <= 10.0 * self.small)
    }
    /// The share of the way from the centre to a place that is outside, if distances grow evenly.
    pub(super) fn gap(&self, d: [f64; 2]) -> f64 {
        let share = |i: usize| d[i] / (d[i].max(0.0) - self.depth[i]);
        share(0).max(share(1))
    }

    /// Where the way from the centre to a place outside leaves the region: the body, the place and its distance.
    pub(super) fn exit(&self, to: Vector, d: [f64; 2]) -> Option<(usize, Vector, f64)> {
        let share = |i: usize| d[i] / (d[i] - self.depth[i]);
        let first = usize::from(d[0] <= 0.0 || (d[1] > 0.0 && share(1) > share(0)));
        if d[first] <= 0.0 {
            return None;
        }
        let (t, there) = self.root(first, to, 1.0, d[first])?;
        let other = self.distance(1 - first, t * to);
        if other <= self.small {
            return Some((first, t * to, there));
        }
        let (t, there) = self.root(1 - first, to, t, other)?;
        Some((1 - first, t * to, there))
    }

    /// Where a body ends on the way to a place, of which the share `far` is outside by `d`.
    fn root(&self, body: usize, to: Vector, far: f64, d: f64) -> Option<(f64, f64)> {
        let enough = self.small;
        let (mut low, mut high) = ([0.0, self.depth[body]], [far, d]);
        // Regula falsi; an end that stays twice has its value halved (Dowell & Jarratt 1971). Now and then the middle, should the
        // surface be very near the beginning.
        let mut last = 0.0;
        for i in 1..60 {
            let t = if i % 4 == 0 {
                0.5 * (low[0] + high[0])
            } else {
                (low[0] * high[1] - high[0] * low[1]) / (high[1] - low[1])
            };
            let f = self.distance(body, t * to);
            if f.abs() <= enough {
                return Some((t, f));
            }
            if f > 0.0 {
                high = [t, f];
                low[1] *= if last > 0.0 { 0.5 } else { 1.0 };
            } else {
                low = [t, f];
                high[1] *= if last < 0.0 { 0.5 } else { 1.0 };
            }
            last = f;
        }
        None
    }

    /// Where a body's surface is on a line from `x`, `d` from it, on which the distance grows like `slope`: by secants.
    pub(super) fn along(&self, body: usize, x: Vector, way: Vector, d: f64, slope: f64) -> Option<Vector> {
        let (mut s, mut f, mut slope) = (0.0, d, slope);
        for _ in 0..12 {
            if f.abs() <= 10.0 * self.small {
                return Some(x + s * way);
            }
            let step = -f / slope;
            let there = self.distance(body, x + (s + step) * way);
            slope = (there - f) / step;
            (s, f) = (s + step, there);
            if !(slope.is_finite() && slope != 0.0) {
                return None;
            }
        }
        None
    }

    /// Of a body's distance, which is `d` at `x`.
    pub(super) fn slope(&self, body: usize, x: Vector, d: f64) -> Vector {
        let places = [Vector::x(), Vector::y(), Vector::z()].map(|e| x + self.step * e);
        Vector::from(self.bodies[body].distances(&places, self.band).map(|f| (f - d) / self.step))
    }

    /// The plane that touches a body's surface at `x`, which is `d` from it; none at edges.
    pub(super) fn tangent(&self, body: usize, x: Vector, d: f64) -> Option<Side> {
        let s = self.step;
        let slope = self.slope(body, x, d);
        let steep = slope.norm();
        let normal = slope.try_normalize(1e-9)?;
        let [up, down] = self.bodies[body].distances(&[x + s * normal, x - s * normal], self.band);
        let straight = |f: f64| (f / (s * steep) - 1.0).abs() < 1e-3;
        if !(straight(up - d) && straight(d - down)) {
            return None;
        }
        let side = Side::new(normal, x - (d / steep) * normal, steep, Some(body));
        (side.height > 0.0).then_some(side)
    }

    /// Is the body's surface flat beside a place on it, to either side of an edge that may be there?
    pub(super) fn is_flat(&self, face: &Face) -> bool {
        let way = BESIDE / STEP * self.step;
        tangents(face.normal).iter().all(|e| {
            let on = |s: f64| self.distance(face.body, face.foot + s * e).abs() <= self.small;
            on(way) || on(-way)
        })
    }

    /// The integral of 1 − t³ over a side, and of ¾(1 − t⁴)·x, with the body's surface at the share t of the way to it.
    ///
    /// In the triangles between the foot and the edges, 1 − t³ is taken for s²·q with q on the edge, s = 1, by Simpson's rule.
    pub(super) fn deficit(&self, side: &Side, corners: &[Corner]) -> Option<(f64, Vector)> {
        let (mut sum, mut first) = (0.0, Vector::zeros());
        let Some(body) = side.body else { return Some((sum, first)) };
        let value = |e: Vector| self.fallen(body, side, e);
        let mut edges = side.edges();
        let [start, mut to, _] = edges.next()?;
        let place = |c: usize| corners[c].x - side.foot;
        let begin = (place(start), value(place(start))?);
        let mut from = begin;
        loop {
            let end = if to == start { begin } else { (place(to), value(place(to))?) };
            let middle = 0.5 * (from.0 + end.0);
            let m = value(middle)?;
            let area = 0.5 * from.0.cross(&end.0).dot(&side.normal);
            let mean = (from.1 + 4.0 * m + end.1) / 6.0;
            let along = (from.1 * from.0 + 4.0 * m * middle + end.1 * end.0) / 6.0;
            sum += 0.5 * area * mean;
            first += area * (0.5 * mean * side.foot + 0.4 * along);
            from = end;
            match edges.next() {
                Some([_, next, _]) => to = next,
                None => return Some((sum, first)),
            }
        }
    }

    /// 1 − t³ at a place of a side, given from its foot, if it grows with the square of the distance; none where the surface is
    /// above the side.
    fn fallen(&self, body: usize, side: &Side, e: Vector) -> Option<f64> {
        let x = side.foot + OUT * e;
        let per = side.slope * side.height;
        let f = self.distance(body, x);
        let mut drop = f / per;
        if drop.abs() > 1e-6 {
            // Along the way in the distance shrinks as fast as at the foot, about; then by a secant.
            let there = self.distance(body, (1.0 - drop) * x);
            let rate = f - there;
            if rate * f > 0.0 {
                drop *= f / rate;
            }
        }
        if drop < -1e-4 * (1.0 + e.norm() / side.height) {
            return None;
        }
        let t = 1.0 - drop.min(1.0);
        Some((1.0 - t * t * t) / (OUT * OUT))
    }
}
