//! Sections of a body across the axis, from its faces.
use crate::overlap::ball_faces::edge::Edge;
use interfaces::Vector;

/// Integrals between segments of a section's outline and the unit circle, along rays from the
/// centre of the circle; positive where the centre is on the inner side of a segment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beyond {
    /// ∫ dA.
    pub(super) area: f64,
    /// ∫ (1 − r²)/2 dA.
    pub(super) second: f64,
    /// Squared distance of the nearest segment from the centre.
    pub(super) nearest2: f64,
}

impl Default for Beyond {
    fn default() -> Self {
        Self { area: 0.0, second: 0.0, nearest2: f64::INFINITY }
    }
}

/// A directed segment, the body on its left.
struct Line {
    from: f64,
    to: f64,
    length: f64,
    /// Distance from the centre, positive where that is on the left.
    distance: f64,
}

impl Line {
    fn new(p: Vector, q: Vector) -> Option<Self> {
        let (x, y) = (q.x - p.x, q.y - p.y);
        let length = x.hypot(y);
        if length == 0.0 {
            return None;
        }
        let (u, v) = (x / length, y / length);
        let (from, to) = (p.x * u + p.y * v, q.x * u + q.y * v);
        let near = if from.abs() < to.abs() { p } else { q };
        // No negative zero.
        let distance = near.x * v - near.y * u + 0.0;
        Some(Self { from, to, length, distance })
    }
}

impl Beyond {
    /// The part beyond the segment from `p` to `q`, of which the horizontal coordinates count.
    pub(super) fn new(p: Vector, q: Vector) -> Self {
        let Some(line) = Line::new(p, q) else { return Self::default() };
        let Line { from, to, length, distance } = line;
        let half2 = (1.0 - distance) * (1.0 + distance);
        if half2 <= 0.0 {
            return Self::default();
        }
        let half = half2.sqrt();
        let rest = |x: Vector| 1.0 - x.x * x.x - x.y * x.y;
        let ways = |s: f64, rest: f64| {
            let far = half + s.abs();
            if s > 0.0 { (rest / far, far) } else { (far, rest / far) }
        };
        let (from, to, length, before, after) = match (rest(p) > 0.0, rest(q) > 0.0) {
            (false, false) if from < 0.0 && to > 0.0 => (-half, half, 2.0 * half, 0.0, 0.0),
            (false, false) => return Self::default(),
            (true, true) => (from, to, length, ways(from, rest(p)).1, ways(to, rest(q)).0),
            (true, false) => {
                let (after, before) = ways(from, rest(p));
                (from, half, after, before, 0.0)
            }
            (false, true) => {
                let (after, before) = ways(to, rest(q));
                (-half, to, before, 0.0, after)
            }
        };
        let edge = Edge { height: 0.0, disc2: 1.0, distance, from, to, length, before, after };
        let beyond = edge.beyond();
        Self { area: beyond.area, second: beyond.second, nearest2: edge.centre2() }
    }
    pub(super) fn add(&mut self, other: &Self) {
        self.area += other.area;
        self.second += other.second;
        self.nearest2 = self.nearest2.min(other.nearest2);
    }
}

/// Angle under which the centre sees the segment from `p` to `q`, by the numbers that
/// [`Beyond::new`] uses; negative where the centre is on its right.
pub(super) fn angle(p: Vector, q: Vector) -> f64 {
    Line::new(p, q).map_or(0.0, |l| {
        let d = l.distance;
        (d * (l.to - l.from)).atan2(d * d + l.from * l.to)
    })
}
