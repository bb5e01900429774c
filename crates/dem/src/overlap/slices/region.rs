//! What two slices share.
use super::outline::{Outline, Section};
use super::slice::{Place, Slice};

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
        for side in &polygon.sides {
            self.outline.cut(side, slack);
            if self.outline.is_empty() {
                return;
            }
        }
        self.outline.add_to(section);
        let sides = any.sides.iter().chain(&polygon.sides);
        let margins = sides.map(|side| self.outline.behind(side)).filter(|m| *m > 100.0 * slack);
        section.margin = margins.fold(f64::INFINITY, f64::min);
    }
    /// Two rounded cores: the second is a strip and what of a disc lies beyond each end of it; so is the first against these.
    fn rounds(&mut self, a: &Slice, b: &Slice, slack: f64, section: &mut Section) {
        let (strip_a, strip_b) = (a.strip(), b.strip());
        if let Some(strip) = &strip_b {
            self.outline.start(a);
            for side in strip {
                self.outline.cut(side, slack);
            }
            self.outline.add_to(section);
        }
        let n_ends = |strip: bool| if strip { 2 } else { 1 };
        let reach = (a.radius + b.radius) * (a.radius + b.radius);
        for j in 0..n_ends(strip_b.is_some()) {
            if far(b.ends()[j], a.ends(), reach) {
                continue;
            }
            let beyond = strip_b.map(|s| s[2 + j].flipped());
            if let Some(strip) = &strip_a {
                self.outline.start_disc(b, j);
                for side in beyond.iter().chain(strip) {
                    self.outline.cut(side, slack);
                }
                self.outline.add_to(section);
            }
            for i in 0..n_ends(strip_a.is_some()) {
                if (a.ends()[i] - b.ends()[j]).norm_squared() >= reach {
                    continue;
                }
                self.outline.start_lens(a, i, b, j, slack);
                for side in beyond.iter().chain(strip_a.map(|s| s[2 + i].flipped()).iter()) {
                    self.outline.cut(side, slack);
                }
                self.outline.add_to(section);
            }
        }
    }
}

/// Whether the square of the distance of a place from a straight line between two ends is no less than `square`.
fn far(x: Place, [p, q]: [Place; 2], square: f64) -> bool {
    let (along, from) = (q - p, x - p);
    let share = (from.dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    (from - along * share).norm_squared() >= square
}
