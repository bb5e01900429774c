//! Integrals over the height of what slices share.
use super::outline::Section;
use super::rules::{RULES, missed};
use super::slice::Place;
use crate::overlap::integrals::Integrals;
use interfaces::Vector;
use std::f64::consts::FRAC_PI_2;

/// Pieces that wait, at most.
const WAITING: usize = 64;
/// Pieces that are tried, at most; what waits then is taken as it is.
const MOST: usize = 800;
/// Breaks between the slices of a piece that are looked for; where there are more it is halved.
const BREAKS: usize = 3;

/// What pieces there are is looked at so many tolerances from the ends of all heights, as a share of these.
const NEAR: f64 = 0.3;
/// From this tolerance on, sides that come near to what is shared are followed.
const FINE: f64 = 1e-6;

/// Pieces after which breaks are no longer looked for.
const NOISY: usize = 200;

/// A height and what was found there.
type Found = (f64, Section);

/// Heights between two ends as a function of u between −1 and 1: linear, but quadratic at an end that is round, where the
/// integrand may be one of the square root of the distance, and m + w sin πu/2 if both are.
#[derive(Clone, Copy, Default)]
struct Piece {
    ends: [f64; 2],
    round: [bool; 2],
    part: [f64; 2],
    /// Heights near the ends and which pieces of the outline were there, if this is known.
    near: [Option<(f64, u64)>; 2],
}

impl Piece {
    fn halves(self) -> [Self; 2] {
        let [from, to] = self.part;
        let between = 0.5 * (from + to);
        let [low, high] = self.near;
        [
            Self { part: [from, between], near: [low, None], ..self },
            Self { part: [between, to], near: [None, high], ..self },
        ]
    }
    /// The height at a place of a rule, and its change with that.
    #[inline]
    fn height(&self, [share, sin, cos, ..]: &[f64; 6]) -> [f64; 2] {
        let ([low, high], [from, to]) = (self.ends, self.part);
        let (middle, half, scale) = (0.5 * (low + high), 0.5 * (high - low), 0.5 * (to - from));
        let u = 0.5 * (from + to) + scale * share;
        match self.round {
            [false, false] => [middle + half * u, half * scale],
            [true, false] => [low + 0.5 * half * (1.0 + u) * (1.0 + u), half * (1.0 + u) * scale],
            [false, true] => [high - 0.5 * half * (1.0 - u) * (1.0 - u), half * (1.0 - u) * scale],
            [true, true] => {
                let (sin, cos) = if scale == 1.0 { (*sin, *cos) } else { (FRAC_PI_2 * u).sin_cos() };
                [middle + half * sin, FRAC_PI_2 * half * cos * scale]
            }
        }
    }
    /// The place u of a height.
    fn place(&self, h: f64) -> f64 {
        let [low, high] = self.ends;
        let half = 0.5 * (high - low);
        let u = match self.round {
            [false, false] => (h - 0.5 * (low + high)) / half,
            [true, false] => (2.0 * (h - low).max(0.0) / half).sqrt() - 1.0,
            [false, true] => 1.0 - (2.0 * (high - h).max(0.0) / half).sqrt(),
            [true, true] => ((h - 0.5 * (low + high)) / half).clamp(-1.0, 1.0).asin() / FRAC_PI_2,
        };
        u.clamp(self.part[0], self.part[1])
    }
    /// Below and above a break, which is round itself where there are `arcs`; what was found next to it.
    fn split(self, at: f64, arcs: bool, [below, above]: [(f64, u64); 2]) -> [Self; 2] {
        let mut pieces = [self; 2];
        if arcs {
            let [low, high] = self.limits();
            let kind = |i: usize| self.part[i].abs() == 1.0 && self.round[i];
            pieces = pieces.map(|piece| Self { part: [-1.0, 1.0], ..piece });
            (pieces[0].ends, pieces[0].round) = ([low, at], [kind(0), true]);
            (pieces[1].ends, pieces[1].round) = ([at, high], [true, kind(1)]);
        } else {
            let u = self.place(at);
            pieces[0].part[1] = u;
            pieces[1].part[0] = u;
        }
        pieces[0].near[1] = Some(below);
        pieces[1].near[0] = Some(above);
        pieces
    }
    fn limits(&self) -> [f64; 2] {
        let at = |share: f64, cos| self.height(&[share, share, cos, 0.0, 0.0, 0.0])[0];
        [at(-1.0, 0.0), at(1.0, 0.0)]
    }
}

/// The integrals over the heights `ends` to a share of `tolerance` of the volume, and whether pieces of the first and the
/// second body's surface were met.
///
/// The integrand has breaks where pieces of the outline appear or vanish: these heights are found, and what lies between
/// is integrated for itself. Its ends are round where a slice of a tube shrinks to a line, and where there are `arcs` perhaps
/// everywhere, since one may touch a line there.
pub(super) fn sweep(
    ends: [f64; 2],
    round: [bool; 2],
    arcs: bool,
    tolerance: f64,
    mut section: impl FnMut(f64) -> Section,
) -> (Integrals, [bool; 2]) {
    let mut waiting = [Piece::default(); WAITING];
    let mut n = 1;
    let near = [0, 1].map(|i| {
        let h = ends[i] + (ends[1 - i] - ends[i]) * (NEAR * tolerance).max(1e-10);
        Some((h, section(h).mark))
    });
    waiting[0] = Piece { ends, round, part: [-1.0, 1.0], near };
    let (mut sums, mut of, mut scale, mut scale_area) = (Integrals::default(), [false; 2], 0.0_f64, 0.0_f64);
    let mut tried = 0;
    while n > 0 {
        n -= 1;
        tried += 1;
        let piece = waiting[n];
        let mut found = [(0.0, Section::default()); 7];
        let mut values = [0.0; 7];
        let mut rules = [Integrals::default(); 3];
        for (i, rule) in RULES[..7].iter().enumerate() {
            let [h, change] = piece.height(rule);
            let [.., three, seven, fifteen] = rule;
            let s = section(h);
            let part = per_height(h, &s) * change;
            values[i] = part.volume;
            rules = [rules[0] + part * *three, rules[1] + part * *seven, rules[2] + part * *fifteen];
            of = [of[0] | s.of[0], of[1] | s.of[1]];
            found[i] = (h, s);
        }
        scale = scale.max(sums.volume + rules[1].volume);
        scale_area = scale_area.max(scale.cbrt().powi(2) + (sums.area + rules[1].area).norm());
        let small = |volume: f64, area: f64| {
            volume <= 0.3 * tolerance * scale && area <= 3.0 * tolerance * scale_area
        };
        let limits = piece.limits();
        let about = 1e-14 * (ends[1] - ends[0]);
        // Next to the ends of all, places of the rules may be nearer to these.
        let near = [0, 1].map(|i| {
            let beyond = |h: f64| (found[6 * i].0 - h) * (i as f64 - 0.5) > 0.0;
            piece.near[i].filter(|(h, _)| (limits[i] - ends[i]).abs() > about || !beyond(*h))
        });
        // A break that was found about may have the place next to it on its other side.
        let mut marks = [(f64::NEG_INFINITY, 0); 9];
        let mut known = 0;
        let [low, high] = near;
        let end = high.map_or(f64::INFINITY, |(h, _)| h);
        let inner = found.iter().map(|f| (f.0, f.1.mark)).filter(|(h, _)| *h < end);
        for now in low.into_iter().chain(inner).chain(high) {
            if known == 0 || now.0 > marks[known - 1].0 {
                marks[known] = now;
                known += 1;
            }
        }
        let marks = &marks[..known];
        let changes = || marks.windows(2).filter(|w| w[0].1 != w[1].1);
        let smooth = changes().next().is_none();
        // Of breaks next to the ends no place of the rules knows.
        let hidden = (0..2).any(|i| near[i].is_some_and(|(_, mark)| mark != found[6 * i].1.mark));
        let narrow = limits[1] - limits[0] <= 1e-12 * (ends[1] - ends[0]);
        let full = narrow || n + BREAKS + 2 > WAITING || tried > MOST;
        let volume = (rules[1].volume - rules[0].volume).abs();
        let area = (rules[1].area - rules[0].area).norm();
        let seven = if smooth {
            let share = volume / rules[1].volume.abs();
            small(volume.min(missed(&values).max(0.01 * volume * share.min(1.0))), 0.1 * area)
        } else {
            !hidden && small(volume, area)
        };
        if (seven && tolerance >= FINE) || full {
            sums = sums + rules[1];
            continue;
        }
        let breaks = changes().count();
        // So many are rounding of sides that lie on one another.
        let noisy = breaks > BREAKS || tried > NOISY;
        if smooth || noisy {
            let fine = tolerance < FINE;
            let mut all = [(0.0, Section::default()); 15];
            if fine {
                found.iter().enumerate().for_each(|(i, f)| all[2 * i + 1] = *f);
            }
            let mut same = true;
            for (i, rule) in RULES[7..].iter().enumerate() {
                let [h, change] = piece.height(rule);
                let s = section(h);
                rules[2] = rules[2] + per_height(h, &s) * (change * rule[5]);
                of = [of[0] | s.of[0], of[1] | s.of[1]];
                same &= s.mark == found[3].1.mark;
                if fine {
                    all[2 * i] = (h, s);
                }
            }
            // A side may come into play between two places.
            if fine && smooth && same && !narrow && tried < NOISY {
                let touch = all.windows(3).find_map(lowest).map(|h| (h, section(h)));
                if let Some((h, s)) = touch.filter(|(_, s)| s.mark != found[3].1.mark) {
                    let [below, above] = piece.split(h, arcs, [(h, s.mark); 2]);
                    (waiting[n], waiting[n + 1]) = (below, above);
                    n += 2;
                    continue;
                }
            }
            let volume = (rules[2].volume - rules[1].volume).abs();
            let area = (rules[2].area - rules[1].area).norm();
            let share = if same && smooth { volume / rules[2].volume.abs() } else { 1.0 };
            if small(volume * (10.0 * share).min(0.5), 0.1 * area) {
                sums = sums + rules[2];
                continue;
            }
        }
        if smooth || noisy {
            let [low, high] = piece.halves();
            (waiting[n], waiting[n + 1]) = (low, high);
            n += 2;
            continue;
        }
        let mut rest = Piece { near, ..piece };
        for ends in changes() {
            let seen = |h: f64| found.iter().find(|f| f.0 == h).copied();
            let ends = [ends[0].0, ends[1].0].map(|h| seen(h).unwrap_or_else(|| (h, section(h))));
            let small = [tolerance * scale, tolerance * scale_area];
            let (at, beside) = break_between(ends, &found, small, &mut section);
            [waiting[n], rest] = rest.split(at, arcs, beside);
            n += 1;
        }
        waiting[n] = rest;
        n += 1;
    }
    (sums, of)
}

/// What a slice at the height `h` adds per height; n dA = (n ds, t ds) dh.
fn per_height(h: f64, s: &Section) -> Integrals {
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
    let [low, high] = [(g - f) / (y - x), (h - g) / (z - y)];
    if f.is_finite() && g.is_finite() && h.is_finite() && low <= 0.0 && high >= 0.0 && high > low {
        let bend = (high - low) / (z - x);
        let at = (0.5 * (x + y) - 0.5 * low / bend).clamp(x, z);
        let least = f + low * (at - x) + bend * (at - x) * (at - y);
        return (least < 0.5 * g && at != y).then_some(at);
    }
    None
}

/// The height between two slices of different pieces at which these change, so near that what is wrong by taking either for
/// the other is small against a volume and an area, and the slices next to it. The length of a piece that one of them has leads to where it
/// vanishes, by the nearest of `others` or by those found on the way; else the heights are halved.
fn break_between(
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
