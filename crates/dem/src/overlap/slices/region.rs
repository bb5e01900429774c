//! What two slices share.
use super::apart::Gap;
use super::outline::{Outline, Section};
use super::slice::{Place, Side, Slice};

/// Cuts slices with one another; keeps the memory that this takes.
#[derive(Clone, Debug, Default)]
pub(super) struct Region {
    outline: Outline,
}

impl Region {
    /// The integrals over what two slices share. Lines nearer to one another than the `slack` are taken for one.
    pub(super) fn section(&mut self, a: &Slice, b: &Slice, slack: f64) -> Section {
        let mut section = Section::default();
        if a.corners.is_empty() || b.corners.is_empty() {
            return section;
        }
        match [a.is_polygon(), b.is_polygon()] {
            [_, true] => self.cut(a, b, slack, &mut section),
            [true, false] => self.cut(b, a, slack, &mut section),
            [false, false] => self.rounds(a, b, slack, &mut section),
        }
        section
    }
    /// Any slice, cut at the sides of a polygon.
    fn cut(&mut self, any: &Slice, polygon: &Slice, slack: f64, section: &mut Section) {
        self.outline.start(any);
        self.cut_all(polygon.sides.iter(), slack, section);
        if self.outline.is_empty() {
            return;
        }
        let sides = any.sides.iter().chain(&polygon.sides);
        let margins = sides.map(|side| self.outline.behind(side)).filter(|m| *m > 100.0 * slack);
        section.margin = Gap { value: margins.fold(f64::INFINITY, f64::min), change: f64::NAN };
    }
    /// Two rounded cores: the second is a strip and what of a disc lies beyond each end of it; so is the first against these. Parts
    /// of which a line shows that they share nothing are left out.
    fn rounds(&mut self, a: &Slice, b: &Slice, slack: f64, section: &mut Section) {
        let (strip_a, strip_b) = (a.strip(), b.strip());
        if let Some(strip) = &strip_b
            && !strip.iter().any(|side| beyond(side, a.ends(), a.radius))
        {
            self.outline.start(a);
            self.cut_all(strip.iter(), slack, section);
        }
        let n_ends = |strip: bool| if strip { 2 } else { 1 };
        let reach = (a.radius + b.radius) * (a.radius + b.radius);
        for j in 0..n_ends(strip_b.is_some()) {
            let end_b = b.ends()[j];
            let rest_b = strip_b.map(|s| s[2 + j].flipped());
            if far(end_b, a.ends(), reach) || rest_b.is_some_and(|side| beyond(&side, a.ends(), a.radius)) {
                continue;
            }
            if let Some(strip) = &strip_a
                && !strip.iter().any(|side| beyond(side, [end_b; 2], b.radius))
            {
                self.outline.start_disc(b, j);
                self.cut_all(rest_b.iter().chain(strip), slack, section);
            }
            for i in 0..n_ends(strip_a.is_some()) {
                let end_a = a.ends()[i];
                let rest_a = strip_a.map(|s| s[2 + i].flipped());
                if (end_a - end_b).norm_squared() >= reach
                    || rest_a.is_some_and(|side| beyond(&side, [end_b; 2], b.radius))
                    || rest_b.is_some_and(|side| beyond(&side, [end_a; 2], a.radius))
                {
                    continue;
                }
                self.outline.start_lens(a, i, b, j, slack);
                self.cut_all(rest_b.iter().chain(&rest_a), slack, section);
            }
        }
    }
    /// Cuts the outline at all these sides and adds what is left.
    fn cut_all<'a>(&mut self, sides: impl Iterator<Item = &'a Side>, slack: f64, section: &mut Section) {
        for side in sides {
            self.outline.cut(side, slack);
            if self.outline.is_empty() {
                return;
            }
        }
        self.outline.add_to(section);
    }
}

/// Whether all within a radius of a straight line between two ends is cut off by a side.
fn beyond(side: &Side, ends: [Place; 2], radius: f64) -> bool {
    ends.iter().all(|x| side.normal.dot(x) - radius >= side.offset)
}

/// Whether the square of the distance of a place from a straight line between two ends is no less than `square`.
fn far(x: Place, [p, q]: [Place; 2], square: f64) -> bool {
    let (along, from) = (q - p, x - p);
    let share = (from.dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (from - along * share).norm_squared() >= square
}
