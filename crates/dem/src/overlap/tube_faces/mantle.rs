//! Integrals over the part of a plane convex polygon within a circular cylinder.
use super::segment::Segment;
use interfaces::Vector;

/// Integrals over the part of a face within the cylinder of radius 1 around z.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mantle {
    /// ∫ dA.
    pub(super) area: f64,
    /// ∫ x dA.
    pub(super) moment: Vector,
    /// ∫ z² dA.
    pub(super) z2: f64,
    /// ∫ (1 − x² − y²)/2 dA.
    pub(super) second: f64,
}

/// A point of the plane.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Place {
    /// Distance from the axis along the horizontal part of the face's normal.
    q: f64,
    /// Horizontal distance along the face.
    t: f64,
    /// Distance along the face at a right angle to that, from the first corner.
    s: f64,
    /// Whether the boundary goes on along the cylinder.
    arc: bool,
}

impl Place {
    fn towards(&self, to: &Self, share: f64) -> Self {
        let mix = |p: f64, q: f64| p + (q - p) * share;
        Self { q: mix(self.q, to.q), t: mix(self.t, to.t), s: mix(self.s, to.s), arc: false }
    }
    fn radius2(&self) -> f64 {
        self.q * self.q + self.t * self.t
    }
}

/// Places for polygons that are cut.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    all: Vec<Place>,
    half: Vec<Place>,
    common: Vec<Place>,
}

/// In-plane moments about the first corner of the common region.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    area: f64,
    s: f64,
    t: f64,
    s2: f64,
    t2: f64,
}

impl Mantle {
    /// The part of a convex polygon, counter-clockwise about its unit `normal`, within the
    /// cylinder.
    ///
    /// The region is bounded by straight lines and by arcs of an ellipse: it is the polygon of
    /// their ends plus a segment per arc, a circular one as seen along the axis. The polygon is
    /// parted at the plane through the axis along the face's horizontal lines, so that no arc spans
    /// more than half a turn and none is mistaken for its complement.
    pub(super) fn new(corners: &[Vector], normal: Vector, scratch: &mut Scratch) -> Self {
        let flat = normal.xy().norm();
        let (out_x, out_y) = if flat > 0.0 { (normal.x / flat, normal.y / flat) } else { (1.0, 0.0) };
        let (sign, rise) = (if normal.z < 0.0 { -1.0 } else { 1.0 }, normal.z.abs());
        let out = Vector::new(out_x, out_y, 0.0);
        let along = Vector::new(-out_y, out_x, 0.0) * sign;
        let up = out * rise - Vector::z() * (sign * flat);
        let Some(first) = corners.first() else { return Self::default() };
        let Scratch { all, half, common } = scratch;
        all.clear();
        all.extend(corners.iter().map(|x| Place {
            q: out.dot(x),
            t: along.dot(x),
            s: up.dot(&(x - first)),
            arc: false,
        }));
        let ends = all.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], p| {
            [if p.q < low { p.q } else { low }, if p.q > high { p.q } else { high }]
        });
        let mut sum = Self::default();
        if ends[0] >= 1.0 || ends[1] <= -1.0 {
            return sum;
        }
        let mut add = |places: &[Place]| {
            common_region(places, common);
            let Some(origin) = common.first().copied() else { return };
            let m = Moments::new(common, rise);
            // Heights and distances are linear in the plane.
            let (q, t, z) = (origin.q, origin.t, first.z - sign * flat * origin.s);
            let (m_q, m_t) = (q * m.area + rise * m.s, t * m.area + m.t);
            let m_z = z * m.area - sign * flat * m.s;
            let radius2 = q * (q * m.area + 2.0 * rise * m.s)
                + rise * rise * m.s2
                + t * (t * m.area + 2.0 * m.t)
                + m.t2;
            sum.area += m.area;
            sum.moment += out * m_q + along * m_t + Vector::z() * m_z;
            sum.z2 += z * (z * m.area - 2.0 * sign * flat * m.s) + flat * flat * m.s2;
            sum.second += 0.5 * (m.area - radius2);
        };
        if ends[0] >= 0.0 || ends[1] <= 0.0 {
            add(all);
        } else {
            for side in [1.0, -1.0] {
                half_of(all, side, half);
                add(half);
            }
        }
        sum
    }
}

/// The part of a convex polygon on one side of q = 0.
fn half_of(all: &[Place], side: f64, half: &mut Vec<Place>) {
    half.clear();
    for (i, p) in all.iter().enumerate() {
        let next = &all[if i + 1 < all.len() { i + 1 } else { 0 }];
        if p.q * side >= 0.0 {
            half.push(*p);
        }
        if (p.q > 0.0 && next.q < 0.0) || (p.q < 0.0 && next.q > 0.0) {
            half.push(Place { q: 0.0, ..p.towards(next, p.q / (p.q - next.q)) });
        }
    }
}

/// The part of a convex polygon within the unit circle of (q, t), as the ends of its straight sides
/// and arcs in order.
fn common_region(polygon: &[Place], common: &mut Vec<Place>) {
    common.clear();
    for (i, p) in polygon.iter().enumerate() {
        let next = &polygon[if i + 1 < polygon.len() { i + 1 } else { 0 }];
        let (rest_p, rest_next) = (1.0 - p.radius2(), 1.0 - next.radius2());
        if rest_p > 0.0 && rest_next > 0.0 {
            common.push(*p);
            continue;
        }
        let (dq, dt) = (next.q - p.q, next.t - p.t);
        let length = dq.hypot(dt);
        if length == 0.0 {
            if rest_p > 0.0 {
                common.push(*p);
            }
            continue;
        }
        let (u, v) = (dq / length, dt / length);
        let (from, to) = (p.q * u + p.t * v, next.q * u + next.t * v);
        // Distance of the line from the axis, by the nearer end.
        let near = if from.abs() < to.abs() { p } else { next };
        let distance = near.q * v - near.t * u;
        let half2 = (1.0 - distance) * (1.0 + distance);
        if half2 <= 0.0 {
            if rest_p > 0.0 {
                common.push(*p);
            }
            continue;
        }
        let half = half2.sqrt();
        // Ways from an end to where the line enters and leaves the circle.
        let ahead = |s: f64, rest: f64| if s > 0.0 { rest / (half + s) } else { half - s };
        let behind = |s: f64, rest: f64| if s < 0.0 { rest / (half - s) } else { half + s };
        let leaves =
            || Place { arc: true, ..p.towards(next, (ahead(from, rest_p) / length).clamp(0.0, 1.0)) };
        let enters = || next.towards(p, (behind(to, rest_next) / length).clamp(0.0, 1.0));
        match (rest_p > 0.0, rest_next > 0.0) {
            (true, true) => {}
            (true, false) => common.extend([*p, leaves()]),
            (false, true) => common.push(enters()),
            (false, false) if from < 0.0 && to > 0.0 => common.extend([enters(), leaves()]),
            (false, false) => {}
        }
    }
}

impl Moments {
    fn new(region: &[Place], rise: f64) -> Self {
        let mut sum = Self::default();
        let [first, rest @ ..] = region else { return sum };
        let off = |p: &Place| (p.s - first.s, p.t - first.t);
        for pair in rest.windows(2) {
            let ((s, t), (v, w)) = (off(&pair[0]), off(&pair[1]));
            let area = 0.5 * (s * w - v * t);
            sum.area += area;
            sum.s += area * (s + v) / 3.0;
            sum.t += area * (t + w) / 3.0;
            sum.s2 += area * (s * s + s * v + v * v) / 6.0;
            sum.t2 += area * (t * t + t * w + w * w) / 6.0;
        }
        // A plane so nearly along the axis has straight lines for arcs, but for rounding.
        if rise < f64::EPSILON {
            return sum;
        }
        for (i, p) in region.iter().enumerate().filter(|(_, p)| p.arc) {
            let next = &region[if i + 1 < region.len() { i + 1 } else { 0 }];
            sum.add_arc(p, next, off(p), off(next), rise.recip());
        }
        sum
    }
    /// Adds the segment between an arc and its chord; lengths along s are `stretch` times as long
    /// as seen along the axis.
    fn add_arc(&mut self, p: &Place, next: &Place, (s, t): (f64, f64), (v, w): (f64, f64), stretch: f64) {
        let (dq, dt) = (next.q - p.q, next.t - p.t);
        let chord = dq.hypot(dt);
        if chord == 0.0 {
            return;
        }
        let (middle_q, middle_t) = (0.5 * (p.q + next.q), 0.5 * (p.t + next.t));
        let distance = middle_q.hypot(middle_t);
        // Outward normal of the chord.
        let (out_q, out_t) = if distance > 0.5 * chord {
            (middle_q / distance, middle_t / distance)
        } else {
            (dt / chord, -dq / chord)
        };
        let segment = Segment::new((0.5 * chord).atan2(distance));
        let (s, t) = (0.5 * (s + v), 0.5 * (t + w));
        let area = segment.area * stretch;
        let (s1, t1) = (out_q * segment.u * stretch, out_t * segment.u);
        let s2 = (out_q * out_q * segment.u2 + out_t * out_t * segment.v2) * stretch * stretch;
        let t2 = out_t * out_t * segment.u2 + out_q * out_q * segment.v2;
        self.area += area;
        self.s += s * area + s1 * stretch;
        self.t += t * area + t1 * stretch;
        self.s2 += s * (s * area + 2.0 * s1 * stretch) + s2 * stretch;
        self.t2 += t * (t * area + 2.0 * t1 * stretch) + t2 * stretch;
    }
}
