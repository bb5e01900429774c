//! Heights at which pieces of an outline appear or vanish.
use super::outline::Section;

/// A height and what was found there.
pub(super) type Found = (f64, Section);

/// The height between two slices of different pieces at which these change, so near that what is wrong by taking either for
/// the other is small against a volume and an area, and the slices next to it. The length of a piece that one of them has leads to where it
/// vanishes, by the nearest of `others` or by those found on the way; else the heights are halved.
pub(super) fn break_between(
    mut ends: [Found; 2],
    others: &[Found],
    small: [f64; 2],
    section: &mut impl FnMut(f64) -> Section,
) -> (f64, [(f64, u64); 2]) {
    // Which side has the piece.
    let more = [ends[0].1.more_than(&ends[1].1), ends[1].1.more_than(&ends[0].1)];
    let (side, tag) = match more {
        [Some(tag), _] => (0, Some(tag)),
        [_, Some(tag)] => (1, Some(tag)),
        _ => (0, None),
    };
    let length = |f: &Found| tag.map_or(0.0, |tag| f.1.length(tag));
    // The slice that had it before.
    let beyond = |f: &&Found| if side == 0 { f.0 < ends[0].0 } else { f.0 > ends[1].0 };
    let from = ends[side].0;
    let nearest =
        others.iter().filter(beyond).min_by(|f, g| (f.0 - from).abs().total_cmp(&(g.0 - from).abs()));
    let mut before = nearest.map(|f| (f.0, length(f)));
    let mut guesses = 0;
    for step in 0..60 {
        let width = ends[1].0 - ends[0].0;
        let growth = (ends[1].1.growth - ends[0].1.growth).abs();
        let change = (ends[1].1.normal - ends[0].1.normal).norm();
        if growth * width * width <= 0.5 * small[0] && change * width <= 5.0 * small[1] {
            break;
        }
        let (x, l) = (ends[side].0, length(&ends[side]));
        let mut next = 0.5 * (ends[0].0 + ends[1].0);
        if let Some((y, m)) = before
            && m > l
            && l > 0.0
            && step % 3 < 2
        {
            // Once towards, once a little beyond.
            let guess = x + (x - y) * (l / (m - l)) * if guesses % 2 == 0 { 0.9 } else { 1.2 };
            guesses += 1;
            if (guess - ends[0].0) * (guess - ends[1].0) < 0.0 {
                next = guess;
            }
        }
        let now = (next, section(next));
        let has = length(&now) > 0.0;
        let same = if tag.is_some() { has == (side == 0) } else { now.1.mark == ends[0].1.mark };
        if has {
            before = Some((x, l));
        }
        if same { ends[0] = now } else { ends[1] = now }
    }
    let (x, l) = (ends[side].0, length(&ends[side]));
    let [low, high] = [ends[0].0, ends[1].0];
    let at = match before {
        Some((y, m)) if m > l => (x + (x - y) * (l / (m - l))).clamp(low, high),
        _ => 0.5 * (low + high),
    };
    (at, ends.map(|f| (f.0, f.1.mark)))
}
