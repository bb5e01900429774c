//! What slices of two tubes share.
use super::outline::segment;
use super::slice::{Place, cross};
use super::tube::{Ends, SlicedTube};
use crate::overlap::integrals::Integrals;
use interfaces::Vector;

/// Places where a circle crosses the outline of a tube's slice, at most.
const CROSSINGS: usize = 8;

/// A tube in a slice: a rectangle, or all within a distance of a straight line.
#[derive(Clone, Copy, Debug)]
struct Flat {
    centre: Place,
    axis: Place,
    half: f64,
    width: f64,
    /// −∂width/∂h.
    slope: f64,
    ends: Ends,
}

/// A piece of an outline, counter-clockwise.
#[derive(Clone, Copy, Default)]
struct Part {
    start: Place,
    end: Place,
    /// Of the circle; zero for straight pieces.
    radius: f64,
    centre: Place,
    slope: f64,
    first: bool,
}

/// Sums over the pieces of both outlines that lie within the other body, in any order: Green's theorem does not ask for one.
#[derive(Default)]
struct Sums {
    /// The first piece's start, so that nothing cancels.
    origin: Option<Place>,
    area: f64,
    /// ∫ (x − origin) dA.
    moment: Place,
    normals: Place,
    upward: f64,
    arm: Place,
    turn: f64,
    of: [bool; 2],
}

/// What a slice of two tubes that are not parallel adds per height: integrals over the region that they share, by Green's theorem over
/// the pieces of both outlines within the other, and over the first one's pieces; whether there are pieces of the first and the second.
pub(super) fn slice(a: &SlicedTube, b: &SlicedTube, h: f64) -> (Integrals, [bool; 2]) {
    let (a, b) = (Flat::new(a, h), Flat::new(b, h));
    let mut sums = Sums::default();
    a.within(&b, true, &mut sums);
    b.within(&a, false, &mut sums);
    sums.integrals(h)
}

impl Flat {
    fn new(tube: &SlicedTube, h: f64) -> Self {
        let width = ((h - tube.low) * (tube.high - h)).max(0.0).sqrt();
        // Finite where the slice is a line.
        let slope = (h - 0.5 * (tube.low + tube.high)) / width.max(1e-100 * tube.radius);
        Self { centre: tube.centre, axis: tube.axis, half: tube.half, width, slope, ends: tube.ends }
    }
    /// Coordinates along and across the axis.
    fn of(&self, v: Place) -> Place {
        Place::new(self.axis.dot(&v), cross(self.axis, v))
    }
    fn world(&self, v: Place) -> Place {
        Place::new(self.axis.x * v.x - self.axis.y * v.y, self.axis.y * v.x + self.axis.x * v.y)
    }
    /// Adds the pieces of the outline that lie within the other's.
    fn within(&self, other: &Self, first: bool, sums: &mut Sums) {
        for sign in [1.0, -1.0] {
            let along = self.axis * sign;
            let side = Place::new(along.y, -along.x) * self.width;
            let ends = [self.centre - along * self.half, self.centre + along * self.half];
            let straight = Part { radius: 0.0, slope: self.slope, first, ..Part::default() };
            sums.straight(ends[0] + side, along, 2.0 * self.half, other, straight);
            match self.ends {
                Ends::Flat => {
                    let straight = Part { slope: 0.0, ..straight };
                    sums.straight(
                        ends[1] + side,
                        Place::new(-along.y, along.x),
                        2.0 * self.width,
                        other,
                        straight,
                    );
                }
                Ends::Round => {
                    let arc = Part {
                        start: ends[1] + side,
                        end: ends[1] - side,
                        radius: self.width,
                        centre: ends[1],
                        slope: self.slope,
                        first,
                    };
                    sums.arc(arc, along, other);
                }
            }
        }
    }
    /// Where the line from a place along a unit vector, both given along and across the axis, enters and leaves.
    fn chord(&self, p: Place, u: Place) -> Option<[f64; 2]> {
        let mut ends = slab(self.width, p.y, u.y)?;
        if self.ends == Ends::Flat {
            let other = slab(self.half, p.x, u.x)?;
            ends = [ends[0].max(other[0]), ends[1].min(other[1])];
        } else {
            for (t, sign) in ends.iter_mut().zip([-1.0, 1.0]) {
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
                }
            }
        }
        (ends[0] < ends[1]).then_some(ends)
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
}

/// Where a coordinate that starts at `x` and changes by `u` is between −half and half.
fn slab(half: f64, x: f64, u: f64) -> Option<[f64; 2]> {
    if u == 0.0 {
        return (x.abs() < half).then_some([f64::NEG_INFINITY, f64::INFINITY]);
    }
    let (middle, reach) = (-x / u, (half / u).abs());
    Some([middle - reach, middle + reach])
}

impl Sums {
    /// Adds what of a straight piece lies within the other.
    fn straight(&mut self, start: Place, along: Place, length: f64, other: &Flat, part: Part) {
        let (p, u) = (other.of(start - other.centre), other.of(along));
        let q = p + u * length;
        let long = if other.ends == Ends::Round { other.half + other.width } else { other.half };
        let beside = |p: f64, q: f64, half: f64| p.min(q) >= half || p.max(q) <= -half;
        if beside(p.y, q.y, other.width) || beside(p.x, q.x, long) {
            return;
        }
        let Some([from, to]) = other.chord(p, u) else { return };
        let (from, to) = (from.max(0.0), to.min(length));
        if from < to {
            self.add_line(start + along * from, start + along * to, to - from, &part);
        }
    }
    /// Adds what of half a circle, on the side of its centre that `facing` tells, lies within the other.
    fn arc(&mut self, arc: Part, facing: Place, other: &Flat) {
        let (r, w) = (arc.radius, other.width);
        let (c, f) = (other.of(arc.centre - other.centre), other.of(facing));
        // Away from the other's core.
        let core = Place::new(c.x - c.x.clamp(-other.half, other.half), c.y);
        let reach = r + w;
        let near = match other.ends {
            Ends::Round => core.norm_squared() < reach * reach,
            Ends::Flat => core.x.abs() < r && core.y.abs() < reach,
        };
        // How far the other reaches in front of the half circle's diameter.
        let wide = if other.ends == Ends::Round { w } else { w * f.y.abs() };
        let before = other.half * f.x.abs() - f.dot(&c) + wide;
        if !near || r <= 0.0 || before <= 0.0 {
            return;
        }
        // Crossings as places from the centre, in the order of the arc: its sine grows.
        let (mut found, mut n) = ([(0.0, Place::zeros()); CROSSINGS + 2], 1);
        found[0] = (-r, Place::new(f.y, -f.x) * r);
        let mut cross_at = |v: Place| {
            if v.dot(&f) > 0.0 && n <= CROSSINGS {
                found[n] = (cross(f, v), v);
                n += 1;
            }
        };
        for sign in [1.0, -1.0] {
            // The sides.
            let off = sign * w - c.y;
            if off.abs() < r {
                let half = ((r - off) * (r + off)).sqrt();
                for x in [half, -half] {
                    if (c.x + x).abs() <= other.half {
                        cross_at(Place::new(x, off));
                    }
                }
            }
            // The ends.
            let end = sign * other.half;
            if other.ends == Ends::Flat {
                let off = end - c.x;
                if off.abs() < r {
                    let half = ((r - off) * (r + off)).sqrt();
                    for y in [half, -half] {
                        if (c.y + y).abs() <= w {
                            cross_at(Place::new(off, y));
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
                    if (c.x + v.x) * sign > other.half {
                        cross_at(v);
                    }
                }
            }
        }
        found[n] = (r, Place::new(-f.y, f.x) * r);
        let found = &mut found[..=n];
        // Few: each goes down to its place.
        for i in 1..found.len() {
            let mut j = i;
            while j > 0 && found[j].0 < found[j - 1].0 {
                found.swap(j, j - 1);
                j -= 1;
            }
        }
        let last = found.len() - 2;
        for (i, w) in found.windows(2).enumerate() {
            let (v, u) = (w[0].1, w[1].1);
            let sum = if last == 0 { f } else { v + u };
            let length = sum.norm();
            if length > 0.0 && other.contains(c + sum * (r / length)) {
                let place = |at: Place| arc.centre + other.world(at);
                let start = if i == 0 { arc.start } else { place(v) };
                let end = if i == last { arc.end } else { place(u) };
                self.add_arc(&Part { start, end, ..arc });
            }
        }
    }
    /// Adds the triangle between the origin and a chord; both its ends from there, and its normal, as long.
    fn chord(&mut self, start: Place, end: Place, first: bool) -> [Place; 3] {
        let origin = *self.origin.get_or_insert(start);
        self.of[usize::from(!first)] = true;
        let (u, v) = (start - origin, end - origin);
        let double = cross(u, v);
        self.area += 0.5 * double;
        self.moment += (u + v) * (double / 6.0);
        [u, v, Place::new(v.y - u.y, u.x - v.x)]
    }
    fn add_line(&mut self, start: Place, end: Place, length: f64, part: &Part) {
        let [.., normal] = self.chord(start, end, part.first);
        if part.first {
            let middle = 0.5 * (start + end);
            self.normals += normal;
            self.upward += part.slope * length;
            self.arm += middle * (length * part.slope);
            self.turn += cross(middle, normal);
        }
    }
    fn add_arc(&mut self, part: &Part) {
        let [u, v, normal] = self.chord(part.start, part.end, part.first);
        let (r, square) = (part.radius, normal.norm_squared());
        if square == 0.0 {
            return;
        }
        let centre = part.centre - self.origin.unwrap_or_default();
        // Twice the chord and twice its distance from the centre, times the chord.
        let angle = square.atan2((u + v - centre * 2.0).dot(&normal));
        let bulge = r * r * segment(angle);
        self.area += bulge;
        self.moment += centre * bulge + normal * (square / 12.0);
        if part.first {
            let length = 2.0 * r * angle;
            self.normals += normal;
            self.upward += part.slope * length;
            self.arm += (part.centre * length + normal * r) * part.slope;
            self.turn += cross(part.centre, normal);
        }
    }
    fn integrals(&self, h: f64) -> (Integrals, [bool; 2]) {
        let (area, n, arm) = (self.area, self.normals, self.arm);
        let first = self.moment + self.origin.unwrap_or_default() * area;
        let sums = Integrals {
            volume: area,
            first: Vector::new(first.x, first.y, h * area),
            area: Vector::new(n.x, n.y, self.upward),
            moment: Vector::new(arm.y - h * n.y, h * n.x - arm.x, self.turn),
        };
        (sums, self.of)
    }
}
