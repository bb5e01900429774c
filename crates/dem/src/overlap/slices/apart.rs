//! How far two slices are apart.
use super::slice::{Place, Slice};

/// A lower bound of the distance of two slices, exact where they are apart and negative where they overlap, and its change
/// with the height.
///
/// Along every direction m, min over b of m·x − max over a of m·x is a convex function of the height, and so is the
/// largest of these: where it is positive, its tangent bounds the heights at which slices can meet.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Gap {
    pub(super) value: f64,
    pub(super) change: f64,
}

/// Of directions that can be those of the shortest way between the slices.
pub(super) fn gap(a: &Slice, b: &Slice) -> Gap {
    let mut best = Gap { value: f64::NEG_INFINITY, change: 0.0 };
    // A corner or an edge of a polyhedron.
    if a.corners.is_empty() || b.corners.is_empty() {
        return Gap { value: f64::INFINITY, change: 0.0 };
    }
    let mut offer = |value: f64, change: f64| {
        if value > best.value {
            best = Gap { value, change };
        }
    };
    let radii = a.radius + b.radius;
    let slopes = a.slope + b.slope;
    for (one, other) in [(a, b), (b, a)] {
        for side in &one.sides {
            let (low, change) = lowest(other, side.normal);
            offer(low - other.radius - side.offset, change + other.slope + side.slope);
        }
        // Across a straight core.
        if !one.is_polygon() && one.corners.len() == 2 {
            let [p, q] = one.ends();
            if let Some(along) = (q - p).try_normalize(0.0) {
                for m in [Place::new(along.y, -along.x), Place::new(-along.y, along.x)] {
                    let (low, change) = lowest(other, m);
                    offer(low - m.dot(&p) - radii, change + slopes);
                }
            }
        }
    }
    if !(a.is_polygon() && b.is_polygon()) {
        let (round, other) = if a.is_polygon() { (b, a) } else { (a, b) };
        for end in round.ends() {
            // Only the corner nearest to an end can face it.
            let nearest = other.corners.iter().map(|c| c.x - end);
            let Some(way) = nearest.min_by(|u, v| u.norm_squared().total_cmp(&v.norm_squared())) else {
                continue;
            };
            let Some(m) = way.try_normalize(0.0) else { continue };
            let (low, change) = lowest(other, m);
            let high = round.ends().iter().map(|x| m.dot(x)).fold(f64::NEG_INFINITY, f64::max);
            offer(low - high - radii, change + slopes);
        }
    }
    best
}

/// The least m·x of a core and its change.
fn lowest(slice: &Slice, m: Place) -> (f64, f64) {
    slice
        .corners
        .iter()
        .map(|c| (m.dot(&c.x), m.dot(&c.dx)))
        .fold((f64::INFINITY, 0.0), |best, now| if now.0 < best.0 { now } else { best })
}
