//! Sections of a body across the axis, from its faces.
use crate::overlap::ball_faces::face::Side;
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

/// The segment from `p` to `q`, seen from the axis in the plane across it.
fn side(p: Vector, q: Vector) -> Option<Side> {
    let ends = [p, q].map(|x| Vector::new(x.x, x.y, 0.0));
    let step = ends[1] - ends[0];
    let length = step.norm();
    if length == 0.0 {
        return None;
    }
    let [u, v] = [step.x / length, step.y / length];
    let [from, to] = ends.map(|x| x.x * u + x.y * v);
    let near = if from.abs() < to.abs() { p } else { q };
    // No negative zero.
    let distance = near.x * v - near.y * u + 0.0;
    Some(Side { ends, from, to, distance, length, direction: [u, v] })
}

impl Beyond {
    /// The part beyond the segment from `p` to `q`, of which the horizontal coordinates count.
    pub(super) fn new(p: Vector, q: Vector) -> Self {
        let Some(edge) = side(p, q).and_then(|side| side.within(0.0, Some(1.0))) else {
            return Self::default();
        };
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
    side(p, q).map_or(0.0, |l| {
        let d = l.distance;
        (d * (l.to - l.from)).atan2(d * d + l.from * l.to)
    })
}
