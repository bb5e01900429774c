//! Integrals over the height of what slices share.
use super::breaks::{Found, break_between};
use super::heights;
use super::outline::Section;
use super::piece::Piece;
use super::rules::{RULES, missed};
use super::slice::Place;
use crate::overlap::integrals::Integrals;
use interfaces::Vector;

/// Pieces that wait, at most.
const WAITING: usize = 64;
/// Pieces that are tried, at most; what waits then is taken as it is.
const MOST: usize = 800;
/// Breaks between the slices of a piece that are looked for; where there are more it is halved.
const BREAKS: usize = 3;

/// What pieces there are is looked at so many tolerances from the ends of all heights, as a share of these.
const NEAR: f64 = 0.3;
/// From this tolerance on 15 points are taken at least.
const FINE: f64 = 1e-6;

/// Slices between two others that look for a piece there, at most.
const LOOKS: usize = 16;
/// Pieces after which breaks are no longer looked for.
const NOISY: usize = 200;

/// The integrals over the heights between `places`, upwards, to a share of `tolerance` of the volume, and
/// whether pieces of the first and the second body's surface were met.
///
/// The integrand has breaks where pieces of the outline appear or vanish: these heights are found, and what lies between
/// is integrated for itself. Inner places are breaks that are known. Places are round where a slice of a tube shrinks to a
/// line, and where there are `arcs` perhaps everywhere, since one may touch a line there.
pub(super) fn sweep(
    places: &[(f64, bool)],
    arcs: bool,
    tolerance: f64,
    mut section: impl FnMut(f64) -> Section,
) -> (Integrals, [bool; 2]) {
    let [(start, _), .., (end, _)] = *places else { return (Integrals::default(), [false; 2]) };
    let ends = [start, end];
    // What there is at inner places, and next to the ends, where outlines are points or lines.
    let inward = (ends[1] - ends[0]) * (NEAR * tolerance).max(1e-10);
    let mut at = |h: f64| (h, section(h).mark);
    let [mut below, last] = [ends[0] + inward, ends[1] - inward].map(&mut at);
    let mut sweep = Sweep {
        section,
        ends,
        arcs,
        tolerance,
        waiting: [Piece::default(); WAITING],
        n: 0,
        tried: 0,
        sums: Integrals::default(),
        of: [false; 2],
        scale: 0.0,
        scale_area: 0.0,
    };
    for (i, pair) in places.windows(2).enumerate() {
        let h = pair[1].0;
        let above = if i + 2 == places.len() { last } else { (h, (sweep.section)(h).mark) };
        sweep.push(Piece { near: [Some(below), Some(above)], ..Piece::between(pair[0], pair[1]) });
        below = above;
    }
    while sweep.n > 0 {
        sweep.n -= 1;
        sweep.tried += 1;
        sweep.integrate(sweep.waiting[sweep.n]);
    }
    (sweep.sums, sweep.of)
}

/// Pieces that wait, and what the others add up to.
struct Sweep<F> {
    section: F,
    ends: [f64; 2],
    arcs: bool,
    tolerance: f64,
    waiting: [Piece; WAITING],
    n: usize,
    tried: usize,
    sums: Integrals,
    of: [bool; 2],
    /// The largest volume and area so far, as scales of errors.
    scale: f64,
    scale_area: f64,
}

/// What the rules of 3 and 7 points say of a piece.
struct Seven {
    found: [Found; 7],
    /// Of the volume.
    values: [f64; 7],
    three: Integrals,
    seven: Integrals,
    /// The part of the rule of 15 points.
    fifteen: Integrals,
}

/// Which pieces of the outline there are at all known heights, upwards.
struct Marks {
    marks: [(f64, u64); 9],
    known: usize,
    /// What was known near the ends, and whether it differs from what the rule's places next to them know.
    near: [Option<(f64, u64)>; 2],
    hidden: bool,
}

impl Marks {
    fn changes(&self) -> impl Iterator<Item = &[(f64, u64)]> {
        self.marks[..self.known].windows(2).filter(|w| w[0].1 != w[1].1)
    }
}

impl<F: FnMut(f64) -> Section> Sweep<F> {
    fn push(&mut self, piece: Piece) {
        self.waiting[self.n] = piece;
        self.n += 1;
    }
    /// The slice at a place of a rule, and what it adds per weight.
    fn at(&mut self, piece: &Piece, rule: &[f64; 4]) -> (Found, Integrals) {
        let [h, change] = piece.height(rule[0]);
        let s = (self.section)(h);
        self.of = [self.of[0] | s.of[0], self.of[1] | s.of[1]];
        ((h, s), per_height(h, &s) * change)
    }
    /// Whether errors of the volume and the area are small.
    fn small(&self, volume: f64, area: f64) -> bool {
        volume <= 0.3 * self.tolerance * self.scale && area <= 3.0 * self.tolerance * self.scale_area
    }
    /// Adds the integrals over a piece, or has parts of it wait.
    fn integrate(&mut self, piece: Piece) {
        let looked = self.seven(&piece);
        let volume = self.sums.volume + looked.seven.volume;
        self.scale = self.scale.max(volume);
        let area = (self.sums.area + looked.seven.area).norm();
        self.scale_area = self.scale_area.max(self.scale.cbrt().powi(2) + area);
        let marks = self.marks(&piece, &looked.found);
        let breaks = marks.changes().count();
        let limits = piece.limits();
        let narrow = limits[1] - limits[0] <= 1e-12 * (self.ends[1] - self.ends[0]);
        let full = narrow || self.n + BREAKS + 2 > WAITING || self.tried > MOST;
        // Sides may come into play between two places.
        let touch = if breaks == 0 && !full && self.tried < NOISY { self.touch(&looked.found) } else { None };
        if let Some((h, mark)) = touch {
            return self.split(&piece, h, [(h, mark); 2]);
        }
        if full || (self.tolerance >= FINE && self.seven_will_do(&looked, &marks)) {
            self.sums = self.sums + looked.seven;
            return;
        }
        // So many are rounding of sides that lie on one another.
        let noisy = breaks > BREAKS || self.tried > NOISY;
        if breaks > 0 && !noisy {
            return self.split_at_breaks(&piece, &looked.found, &marks);
        }
        if !self.fifteen(&piece, &looked, breaks == 0) {
            let (h, middle) = looked.found[3];
            let [low, high] = piece.halves((h, middle.mark));
            self.push(low);
            self.push(high);
        }
    }
    fn seven(&mut self, piece: &Piece) -> Seven {
        let mut looked = Seven {
            found: [(0.0, Section::default()); 7],
            values: [0.0; 7],
            three: Integrals::default(),
            seven: Integrals::default(),
            fifteen: Integrals::default(),
        };
        for (i, rule) in RULES[..7].iter().enumerate() {
            let (found, part) = self.at(piece, rule);
            let [.., three, seven, fifteen] = rule;
            looked.values[i] = part.volume;
            looked.three = looked.three + part * *three;
            looked.seven = looked.seven + part * *seven;
            looked.fifteen = looked.fifteen + part * *fifteen;
            looked.found[i] = found;
        }
        looked
    }
    fn marks(&self, piece: &Piece, found: &[Found; 7]) -> Marks {
        let limits = piece.limits();
        let about = 1e-14 * (self.ends[1] - self.ends[0]);
        // Next to the ends of all, places of the rules may be nearer to these.
        let near = [0, 1].map(|i| {
            let beyond = |h: f64| (found[6 * i].0 - h) * (i as f64 - 0.5) > 0.0;
            piece.near[i].filter(|(h, _)| (limits[i] - self.ends[i]).abs() > about || !beyond(*h))
        });
        let (mut marks, mut known) = ([(f64::NEG_INFINITY, 0); 9], 0);
        let [low, high] = near;
        let end = high.map_or(f64::INFINITY, |(h, _)| h);
        let inner = found.iter().map(|f| (f.0, f.1.mark)).filter(|(h, _)| *h < end);
        for now in low.into_iter().chain(inner).chain(high) {
            // A break that was found about may have the place next to it on its other side.
            if known == 0 || now.0 > marks[known - 1].0 {
                marks[known] = now;
                known += 1;
            }
        }
        // Of breaks next to the ends no place of the rules knows.
        let hidden = (0..2).any(|i| near[i].is_some_and(|(_, mark)| mark != found[6 * i].1.mark));
        Marks { marks, known, near, hidden }
    }
    fn seven_will_do(&self, looked: &Seven, marks: &Marks) -> bool {
        let volume = (looked.seven.volume - looked.three.volume).abs();
        let area = (looked.seven.area - looked.three.area).norm();
        if marks.changes().next().is_some() {
            return !marks.hidden && self.small(volume, area);
        }
        let share = volume / looked.seven.volume.abs();
        let least = missed(&looked.values).max(0.01 * volume * share.min(1.0));
        self.small(volume.min(least), 0.1 * area)
    }
    /// Adds the integrals by 15 points if they are good enough, or divides the piece where a side comes into play; answers whether
    /// either was done.
    fn fifteen(&mut self, piece: &Piece, looked: &Seven, smooth: bool) -> bool {
        let mut all = [(0.0, Section::default()); 15];
        looked.found.iter().enumerate().for_each(|(i, f)| all[2 * i + 1] = *f);
        let (mut same, mut sums, mark) = (true, looked.fifteen, looked.found[3].1.mark);
        for (i, rule) in RULES[7..].iter().enumerate() {
            let (found, part) = self.at(piece, rule);
            sums = sums + part * rule[3];
            same &= found.1.mark == mark;
            all[2 * i] = found;
        }
        if smooth
            && same
            && self.tried < NOISY
            && self.tolerance < FINE
            && let Some((h, mark)) = self.touch(&all)
        {
            self.split(piece, h, [(h, mark); 2]);
            return true;
        }
        let volume = (sums.volume - looked.seven.volume).abs();
        let area = (sums.area - looked.seven.area).norm();
        let share = if same && smooth { volume / sums.volume.abs() } else { 1.0 };
        let done = self.small(volume * (10.0 * share).min(0.5), 0.1 * area);
        if done {
            self.sums = self.sums + sums;
        }
        done
    }
    /// A height between slices of the same pieces at which there are others, and which.
    fn touch(&mut self, found: &[Found]) -> Option<(f64, u64)> {
        if let Some(h) = found.windows(3).find_map(lowest) {
            let mark = (self.section)(h).mark;
            return (mark != found[0].1.mark).then_some((h, mark));
        }
        found.windows(2).find_map(|pair| self.touch_between(pair[0], pair[1]))
    }
    /// The same where the change of the margin is known: by cubics through two values and changes.
    fn touch_between(&mut self, mut low: Found, mut high: Found) -> Option<(f64, u64)> {
        for _ in 0..LOOKS {
            let [f, g] = [low.1.margin, high.1.margin];
            let falls_and_rises = f.change < 0.0 && g.change > 0.0;
            // The lines through both ends are below a convex margin.
            let least = (f.value * g.change - g.value * f.change + f.change * g.change * (high.0 - low.0))
                / (g.change - f.change);
            if !falls_and_rises || least > 0.0 {
                return None;
            }
            let h = heights::lowest((low.0, f), (high.0, g));
            if !(low.0 < h && h < high.0) {
                return None;
            }
            let section = (self.section)(h);
            if section.mark != low.1.mark {
                return Some((h, section.mark));
            }
            if section.margin.change < 0.0 { low = (h, section) } else { high = (h, section) }
        }
        None
    }
    /// Has both parts of a piece wait, below and above a height.
    fn split(&mut self, piece: &Piece, at: f64, beside: [(f64, u64); 2]) {
        let [below, above] = piece.split(at, self.arcs, beside);
        self.push(below);
        self.push(above);
    }
    fn split_at_breaks(&mut self, piece: &Piece, found: &[Found; 7], marks: &Marks) {
        let mut rest = Piece { near: marks.near, ..*piece };
        for ends in marks.changes() {
            let ends = [ends[0].0, ends[1].0].map(|h| {
                let seen = found.iter().find(|f| f.0 == h).copied();
                seen.unwrap_or_else(|| (h, (self.section)(h)))
            });
            let small = [self.tolerance * self.scale, self.tolerance * self.scale_area];
            let (at, beside) = break_between(ends, found, small, &mut self.section);
            let [below, above] = rest.split(at, self.arcs, beside);
            self.push(below);
            rest = above;
        }
        self.push(rest);
    }
}

/// What a slice at the height `h` adds per height; n dA = (n ds, t ds) dh.
pub(super) fn per_height(h: f64, s: &Section) -> Integrals {
    let join = |x: Place, z: f64| Vector::new(x.x, x.y, z);
    Integrals {
        volume: s.area,
        first: join(s.first, h * s.area),
        area: join(s.normal, s.upward),
        moment: Vector::new(s.arm.y - h * s.normal.y, h * s.normal.x - s.arm.x, s.turn),
    }
}

/// Where the distance of the nearest side that is not part of the outline is least, if it is in the middle of three
/// slices, by the parabola through these, and if it might vanish there.
fn lowest(three: &[Found]) -> Option<f64> {
    let [x, y, z] = [0, 1, 2].map(|i| three[i].0);
    let [f, g, h] = [0, 1, 2].map(|i| three[i].1.margin);
    if !three.iter().all(|found| found.1.margin.change.is_nan()) {
        return None;
    }
    let [f, g, h] = [f, g, h].map(|margin| margin.value);
    let [low, high] = [(g - f) / (y - x), (h - g) / (z - y)];
    if f.is_finite() && g.is_finite() && h.is_finite() && low <= 0.0 && high >= 0.0 && high > low {
        let bend = (high - low) / (z - x);
        let at = (0.5 * (x + y) - 0.5 * low / bend).clamp(x, z);
        let least = f + low * (at - x) + bend * (at - x) * (at - y);
        return (least < 0.5 * g && at != y).then_some(at);
    }
    None
}
