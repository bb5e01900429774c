//! One slice of a tube.
use super::common::Stop;
use super::slice::{Place, cross};
use super::sliced_tube::SlicedTube;
use crate::overlap::tube::Ends;

/// Places where a circle crosses the outline of a tube's slice, at most.
const CROSSINGS: usize = 8;

/// A tube in a slice: a rectangle, or all within a distance of a straight line. Its curves are its right and its left side, then its end
/// along the axis and the other one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flat {
    centre: Place,
    axis: Place,
    half: f64,
    width: f64,
    ends: Ends,
}

/// A straight piece as the other sees it: where it starts, the way along it and how long it is, its curve and the corners that it runs
/// between.
struct Straight {
    start: Place,
    along: Place,
    length: f64,
    curve: usize,
    corners: [Stop; 2],
}

/// Half a circle as the other sees it: its curve and the corners that it runs between.
struct Arc {
    centre: Place,
    /// The way from there to its middle.
    facing: Place,
    radius: f64,
    curve: usize,
    corners: [Stop; 2],
}

impl Flat {
    pub(super) fn new(tube: &SlicedTube, h: f64) -> Self {
        let width = ((h - tube.low) * (tube.high - h)).max(0.0).sqrt();
        Self { centre: tube.centre, axis: tube.axis, half: tube.half, width, ends: tube.ends }
    }
    /// Tells the pieces of the outline that lie within the other's: their curves, where they start and where they end.
    pub(super) fn within(&self, other: &Self, mut found: impl FnMut(usize, Stop, Stop)) {
        // All along and across the other's axis.
        let (centre, axis) = (other.of(self.centre - other.centre), other.of(self.axis));
        for (i, sign) in [(0, 1.0), (1, -1.0)] {
            let along = axis * sign;
            let side = Place::new(along.y, -along.x) * self.width;
            let (from, to) = (centre - along * self.half, centre + along * self.half);
            let straight = Straight {
                start: from + side,
                along,
                length: 2.0 * self.half,
                curve: i,
                corners: [Stop::Corner { end: 1 - i, side: i }, Stop::Corner { end: i, side: i }],
            };
            other.straight(&straight, &mut found);
            let corners = [Stop::Corner { end: i, side: i }, Stop::Corner { end: i, side: 1 - i }];
            let curve = 2 + i;
            match self.ends {
                Ends::Flat => {
                    let left = Place::new(-along.y, along.x);
                    let (start, length) = (to + side, 2.0 * self.width);
                    other.straight(&Straight { start, along: left, length, curve, corners }, &mut found);
                }
                Ends::Round => {
                    let arc = Arc { centre: to, facing: along, radius: self.width, curve, corners };
                    other.arc(&arc, &mut found);
                }
            }
        }
    }
    /// Coordinates along and across the axis.
    fn of(&self, v: Place) -> Place {
        Place::new(self.axis.dot(&v), cross(self.axis, v))
    }
    /// Where a curve crosses one of this at a place along and across the axis.
    fn crossing(&self, curve: usize, v: Place) -> Stop {
        let from = Place::new(self.axis.x * v.x - self.axis.y * v.y, self.axis.y * v.x + self.axis.x * v.y);
        Stop::Crossing { curve, near: self.centre + from }
    }
    /// Finds what of another's straight piece lies within.
    fn straight(&self, piece: &Straight, found: &mut impl FnMut(usize, Stop, Stop)) {
        let (p, u) = (piece.start, piece.along);
        let q = p + u * piece.length;
        let long = if self.ends == Ends::Round { self.half + self.width } else { self.half };
        let beside = |p: f64, q: f64, half: f64| p.min(q) >= half || p.max(q) <= -half;
        if beside(p.y, q.y, self.width) || beside(p.x, q.x, long) {
            return;
        }
        let Some([(from, enters), (to, leaves)]) = self.chord(p, u) else { return };
        if from.max(0.0) >= to.min(piece.length) {
            return;
        }
        let start = if from > 0.0 { self.crossing(enters, p + u * from) } else { piece.corners[0] };
        let end = if to < piece.length { self.crossing(leaves, p + u * to) } else { piece.corners[1] };
        found(piece.curve, start, end);
    }
    /// Where the line from a place along a unit vector, both given along and across the axis, enters and leaves, and through which curve.
    fn chord(&self, p: Place, u: Place) -> Option<[(f64, usize); 2]> {
        let mut ends = slab(self.width, p.y, u.y, [0, 1])?;
        if self.ends == Ends::Flat {
            let other = slab(self.half, p.x, u.x, [3, 2])?;
            if other[0].0 > ends[0].0 {
                ends[0] = other[0];
            }
            if other[1].0 < ends[1].0 {
                ends[1] = other[1];
            }
        } else {
            for ((t, curve), sign) in ends.iter_mut().zip([-1.0, 1.0]) {
                let x = if t.is_finite() { p.x + *t * u.x } else { *t * u.x };
                if x.abs() > self.half {
                    // The disc at that end.
                    let from = p - Place::new(self.half.copysign(x), 0.0);
                    let off = cross(u, from);
                    let square = (self.width - off) * (self.width + off);
                    if square < 0.0 {
                        return None;
                    }
                    *t = sign * square.sqrt() - u.dot(&from);
                    *curve = if x > 0.0 { 2 } else { 3 };
                }
            }
        }
        (ends[0].0 < ends[1].0).then_some(ends)
    }
    /// Whether a place, given along and across the axis, is inside.
    fn contains(&self, x: Place) -> bool {
        let beyond = x.x.abs() - self.half;
        if beyond <= 0.0 {
            x.y.abs() < self.width
        } else {
            self.ends == Ends::Round && beyond * beyond + x.y * x.y < self.width * self.width
        }
    }
    /// Finds what of half a circle of another lies within.
    fn arc(&self, arc: &Arc, found: &mut impl FnMut(usize, Stop, Stop)) {
        let (r, w) = (arc.radius, self.width);
        let (c, f) = (arc.centre, arc.facing);
        // Away from the core.
        let core = Place::new(c.x - c.x.clamp(-self.half, self.half), c.y);
        let reach = r + w;
        let near = match self.ends {
            Ends::Round => core.norm_squared() < reach * reach,
            Ends::Flat => core.x.abs() < r && core.y.abs() < reach,
        };
        // How far this reaches in front of the half circle's diameter.
        let wide = if self.ends == Ends::Round { w } else { w * f.y.abs() };
        let before = self.half * f.x.abs() - f.dot(&c) + wide;
        if !near || r <= 0.0 || before <= 0.0 {
            return;
        }
        // Crossings as places from the centre, in the order of the arc: its sine grows.
        let (mut crossed, mut n) = ([(0.0, Place::zeros(), 0); CROSSINGS + 2], 1);
        crossed[0] = (-r, Place::new(f.y, -f.x) * r, 0);
        let mut cross_at = |v: Place, curve: usize| {
            if v.dot(&f) > 0.0 && n <= CROSSINGS {
                crossed[n] = (cross(f, v), v, curve);
                n += 1;
            }
        };
        for (i, sign) in [(0, 1.0), (1, -1.0)] {
            // The sides.
            let off = sign * w - c.y;
            if off.abs() < r {
                let half = ((r - off) * (r + off)).sqrt();
                for x in [half, -half] {
                    if (c.x + x).abs() <= self.half {
                        cross_at(Place::new(x, off), 1 - i);
                    }
                }
            }
            // The ends.
            let (end, curve) = (sign * self.half, 2 + i);
            if self.ends == Ends::Flat {
                let off = end - c.x;
                if off.abs() < r {
                    let half = ((r - off) * (r + off)).sqrt();
                    for y in [half, -half] {
                        if (c.y + y).abs() <= w {
                            cross_at(Place::new(off, y), curve);
                        }
                    }
                }
                continue;
            }
            let way = Place::new(end, 0.0) - c;
            let d = way.norm();
            let product = (r + w - d) * (d - r + w) * (d + r - w) * (d + r + w);
            if product > 0.0 && d > 0.0 {
                let along = 0.5 * (d + (r - w) * ((r + w) / d));
                let (u, half) = (way / d, product.sqrt() / (2.0 * d));
                for half in [half, -half] {
                    let v = u * along + Place::new(-u.y, u.x) * half;
                    if (c.x + v.x) * sign > self.half {
                        cross_at(v, curve);
                    }
                }
            }
        }
        crossed[n] = (r, Place::new(-f.y, f.x) * r, 0);
        let crossed = &mut crossed[..=n];
        // Few: each goes down to its place.
        for i in 1..crossed.len() {
            let mut j = i;
            while j > 0 && crossed[j].0 < crossed[j - 1].0 {
                crossed.swap(j, j - 1);
                j -= 1;
            }
        }
        let last = crossed.len() - 2;
        // Within and outside by turns.
        let sum = if last == 0 { f } else { crossed[0].1 + crossed[1].1 };
        let mut within = self.contains(c + sum * (r / sum.norm()));
        for (i, w) in crossed.windows(2).enumerate() {
            if within {
                let start = if i == 0 { arc.corners[0] } else { self.crossing(w[0].2, c + w[0].1) };
                let end = if i == last { arc.corners[1] } else { self.crossing(w[1].2, c + w[1].1) };
                found(arc.curve, start, end);
            }
            within = !within;
        }
    }
}

/// Where a coordinate that starts at `x` and changes by `u` is between −half and half, and which of both ends these are.
fn slab(half: f64, x: f64, u: f64, [low, high]: [usize; 2]) -> Option<[(f64, usize); 2]> {
    if u == 0.0 {
        return (x.abs() < half).then_some([(f64::NEG_INFINITY, low), (f64::INFINITY, high)]);
    }
    let per = 1.0 / u;
    let (middle, reach) = (-x * per, half * per.abs());
    let [first, last] = if u > 0.0 { [low, high] } else { [high, low] };
    Some([(middle - reach, first), (middle + reach, last)])
}
