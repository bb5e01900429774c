//! The heights at which slices of two bodies meet.
use super::apart::Gap;

/// Steps at most.
const STEPS: usize = 80;
/// Heights of the ends are looked at this share of the range within it.
const WITHIN: f64 = 1e-10;

/// A height and the gap there.
pub(super) type Known = (f64, Gap);

/// The part of the `range` in which the `gap` is negative, `None` where there is none, its ends to a share of `close`.
///
/// The gap is convex. From where it is positive its tangent leads to a height before which it stays so: a proof where
/// these heights pass one another. The least value of the cubic through both tangents is looked at next, or where they cross.
pub(super) fn heights(range: [f64; 2], close: f64, mut gap: impl FnMut(f64) -> Gap) -> Option<[f64; 2]> {
    let (middle, known) = common(range, &mut gap)?;
    let ends = [0, 1].map(|i| end(range, middle, range[i], known[i], close, &mut gap));
    (ends[0] < ends[1]).then_some(ends)
}

/// A height at which the gap is negative, and the last ones on either side of it at which it was found not to be.
fn common(range: [f64; 2], gap: &mut impl FnMut(f64) -> Gap) -> Option<(f64, [Option<Known>; 2])> {
    let [mut low, mut high] = range;
    let (mut left, mut right) = (None, None);
    let mut x = 0.5 * (low + high);
    for step in 0..STEPS {
        let g = gap(x);
        if g.value < 0.0 {
            return Some((x, [left, right]));
        }
        let root = x - g.value / g.change;
        if g.change < 0.0 {
            low = low.max(root);
            left = Some((x, g));
        } else if g.change > 0.0 {
            high = high.min(root);
            right = Some((x, g));
        } else {
            return None;
        }
        if low.is_nan() || high.is_nan() || low >= high {
            return None;
        }
        x = match (left, right) {
            (Some(left), Some(right)) if step % 3 == 0 => crossing(left, right),
            (Some(left), Some(right)) => lowest(left, right),
            _ => 0.5 * (low + high),
        };
        let rim = 0.01 * (high - low);
        if !(x > low + rim && x < high - rim) {
            x = 0.5 * (low + high);
        }
    }
    None
}

/// Where two tangents cross.
fn crossing((x, f): Known, (y, g): Known) -> f64 {
    (f.value - g.value + g.change * y - f.change * x) / (g.change - f.change)
}

/// Where the cubic through two values and slopes of different signs is least.
pub(super) fn lowest((x, f): Known, (y, g): Known) -> f64 {
    let width = y - x;
    let sum = f.change + g.change - 3.0 * (g.value - f.value) / width;
    let root = (sum * sum - f.change * g.change).max(0.0).sqrt();
    y - width * (g.change + root - sum) / (g.change - f.change + 2.0 * root)
}

/// The end of the heights of a negative gap between `middle` and that `limit` of the range: Newton's method in the angle φ
/// of a half circle over the range, in which bodies that are round there are smooth, between brackets.
fn end(
    range: [f64; 2],
    middle: f64,
    limit: f64,
    known: Option<Known>,
    close: f64,
    gap: &mut impl FnMut(f64) -> Gap,
) -> f64 {
    let (centre, half) = (0.5 * (range[0] + range[1]), 0.5 * (range[1] - range[0]));
    let (near, mut g) = known.unwrap_or_else(|| {
        let near = limit + (centre - limit) * WITHIN;
        (near, gap(near))
    });
    if g.value <= 0.0 {
        return limit;
    }
    let angle = |h: f64| ((h - centre) / half).clamp(-1.0, 1.0).asin();
    let (mut apart, mut common) = (angle(near), angle(middle));
    let mut at = apart;
    for _ in 0..STEPS {
        let next = at - g.value / (g.change * half * at.cos());
        let within = (next - apart) * (next - common) < 0.0;
        let next = if within { next } else { 0.5 * (apart + common) };
        let step = (next - at).abs();
        at = next;
        if step <= close * (common - at).abs() {
            break;
        }
        g = gap(centre + half * at.sin());
        if g.value > 0.0 { apart = at } else { common = at }
    }
    centre + half * at.sin()
}
