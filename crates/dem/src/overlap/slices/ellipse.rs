//! Intersection of a disc and an ellipse.
use super::apart::Gap;
use super::outline::{Section, segment};
use super::slice::{Place, Tag, cross};
use std::f64::consts::{PI, TAU};

/// Steps of Newton's method or bisection, at most.
const STEPS: usize = 60;
/// Length of the last step of Newton's method \[rad\].
const CLOSE: f64 = 1e-8;

/// An ellipse with its axes along x and y, and a disc around the origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) radius: f64,
    /// −∂radius/∂h.
    pub(super) slope: f64,
    pub(super) centre: Place,
    /// Change of the centre with the height.
    pub(super) shift: Place,
    pub(super) semi_axes: Place,
    /// Relative change of the semi-axes with the height.
    pub(super) growth: f64,
}

/// Arcs of the ellipse within the disc, as ranges of its parameter θ, upwards.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Common {
    Nothing,
    Disc,
    Ellipse,
    Arcs([[f64; 2]; 2], usize),
}

impl Pair {
    /// The same in the quadrant where the centre of the ellipse has positive coordinates, and the
    /// signs that lead back.
    fn reflected(&self) -> (Self, Place) {
        let signs = self.centre.map(|x| if x < 0.0 { -1.0 } else { 1.0 });
        let same = |v: Place| v.component_mul(&signs);
        (Self { centre: same(self.centre), shift: same(self.shift), ..*self }, signs)
    }
    fn point(&self, angle: f64) -> Place {
        let (sin, cos) = angle.sin_cos();
        self.centre + Place::new(self.semi_axes.x * cos, self.semi_axes.y * sin)
    }
    /// |x|² − radius² at a point of the ellipse, and half its change with the parameter.
    fn level(&self, angle: f64) -> [f64; 2] {
        let (sin, cos) = angle.sin_cos();
        let [a, b] = [self.semi_axes.x, self.semi_axes.y];
        let (x, y) = (self.centre.x + a * cos, self.centre.y + b * sin);
        let r = (x * x + y * y).sqrt();
        [(r - self.radius) * (r + self.radius), b * cos * y - a * sin * x]
    }
    /// Half the change of the level with the parameter, and its change.
    fn change(&self, angle: f64) -> [f64; 2] {
        let (sin, cos) = angle.sin_cos();
        let [a, b] = [self.semi_axes.x, self.semi_axes.y];
        let (x, y) = (self.centre.x + a * cos, self.centre.y + b * sin);
        [b * cos * y - a * sin * x, a * a * sin * sin + b * b * cos * cos - a * cos * x - b * sin * y]
    }

    /// Lower bound of the distance between the disc and the ellipse, exact where they are apart,
    /// and its change with the height.
    pub(super) fn gap(&self) -> Gap {
        let (pair, _) = self.reflected();
        if pair.holds(Place::zeros()) {
            return Gap { value: -self.radius, change: 0.0 };
        }
        pair.distance(pair.nearest())
    }
    fn holds(&self, x: Place) -> bool {
        (x - self.centre).component_div(&self.semi_axes).norm_squared() < 1.0
    }
    /// Parameter of the point nearest to the origin, in the quadrant opposite to the centre.
    fn nearest(&self) -> f64 {
        root([PI, 1.5 * PI], PI + self.towards_centre(), |t| self.change(t))
    }
    /// Parameter of the point farthest from the origin, in the quadrant of the centre.
    fn farthest(&self) -> f64 {
        root([0.0, 0.5 * PI], self.towards_centre(), |t| self.change(t).map(|x| -x))
    }
    /// Parameter of the point behind the centre on the line from the origin.
    fn towards_centre(&self) -> f64 {
        (self.centre.y * self.semi_axes.x).atan2(self.centre.x * self.semi_axes.y)
    }

    /// Integrals over the common region and along the arcs of the disc, the first body.
    pub(super) fn section(&self) -> Section {
        let (pair, signs) = self.reflected();
        let mut section = Section::default();
        let (common, margin) = pair.common();
        section.margin = margin;
        match common {
            Common::Nothing => {}
            Common::Disc => pair.add_disc(&mut section),
            Common::Ellipse => pair.add_ellipse(&mut section),
            Common::Arcs(arcs, n) => pair.add_arcs(&arcs[..n], &mut section),
        }
        section.first.component_mul_assign(&signs);
        section.normal.component_mul_assign(&signs);
        section.arm.component_mul_assign(&signs);
        section
    }
    fn add_disc(&self, section: &mut Section) {
        let r = self.radius;
        section.area = PI * r * r;
        section.upward = self.slope * TAU * r;
        section.growth = -section.upward;
        section.add_piece(Tag::new(0, 0), TAU * r);
    }
    fn add_ellipse(&self, section: &mut Section) {
        section.area = PI * self.semi_axes.product();
        section.first = self.centre * section.area;
        section.growth = 2.0 * section.area * self.growth;
        section.add_piece(Tag::new(1, 0), TAU * self.semi_axes.max());
    }
    /// The region is the polygon of the arcs' ends and a segment per arc.
    fn add_arcs(&self, arcs: &[[f64; 2]], section: &mut Section) {
        let (r, [a, b]) = (self.radius, [self.semi_axes.x, self.semi_axes.y]);
        let n = arcs.len();
        let origin = self.point(arcs[0][0]);
        for (i, [from, to]) in arcs.iter().enumerate() {
            let next = arcs[if i + 1 < n { i + 1 } else { 0 }][0];
            let (p, q, s) = (self.point(*from), self.point(*to), self.point(next));
            for (x, y) in [(p, q), (q, s)] {
                let (u, v) = (x - origin, y - origin);
                let area = 0.5 * cross(u, v);
                section.area += area;
                section.first += (origin + (u + v) / 3.0) * area;
            }
            // The ellipse is the image of a unit circle.
            let (half, middle) = (0.5 * (to - from), 0.5 * (from + to));
            let (sin, cos) = middle.sin_cos();
            let area = a * b * segment(half);
            let bulge = a * b * 2.0 / 3.0 * half.sin().powi(3);
            section.area += area;
            section.first += self.centre * area + Place::new(a * cos, b * sin) * bulge;
            let chord = q - p;
            let outward = Place::new(chord.y, -chord.x);
            // Twice the sector of the ellipse.
            section.growth += self.shift.dot(&outward) + self.growth * a * b * (to - from);
            section.add_piece(Tag::new(1, i as u32), chord.norm().max(half * a.min(b)));
            // Along the disc to the next arc.
            let chord = s - q;
            let angle = self.turn(q, s);
            let (half, normal) = (0.5 * angle, Place::new(chord.y, -chord.x));
            let area = r * r * segment(half);
            let direction = q.y.atan2(q.x) + half;
            section.area += area;
            let bulge = 2.0 / 3.0 * r.powi(3) * half.sin().powi(3);
            section.first += Place::new(direction.cos(), direction.sin()) * bulge;
            section.normal += normal;
            section.upward += self.slope * r * angle;
            section.growth -= self.slope * r * angle;
            section.arm += normal * (self.slope * r);
            section.add_piece(Tag::new(0, i as u32), r * angle);
        }
    }
    /// Angle of the disc's arc from `q` counter-clockwise to `s`.
    fn turn(&self, q: Place, s: Place) -> f64 {
        let angle = cross(q, s).atan2(q.dot(&s));
        // Rounding does not tell a short arc from a whole turn: the opposite point does.
        if angle > 1e-8 {
            return angle;
        }
        if angle < -1e-8 {
            return TAU + angle;
        }
        if self.holds(-q) { TAU + angle } else { angle.max(0.0) }
    }

    /// The arcs of the ellipse within the disc, for a centre with positive coordinates, and how near to the circle an
    /// extreme of the distance from the origin is.
    ///
    /// Along the ellipse the distance from the origin rises from its least, in the quadrant
    /// opposite to the centre, to its greatest, in that of the centre. In between it has two more
    /// extremes if the origin is within the evolute, in the quadrant beside the longer axis.
    fn common(&self) -> (Common, Gap) {
        let [a, b] = [self.semi_axes.x, self.semi_axes.y];
        let [u, v] = [self.centre.x, self.centre.y];
        let extremes = self.inner_extremes(a, b, u, v);
        // Any point within the disc and any beyond it will do, if there is one arc.
        let (mut near, mut far) = (PI + self.towards_centre(), self.towards_centre());
        let [mut least, mut most] = [near, far].map(|t| self.level(t)[0]);
        if least >= 0.0 || extremes.is_some() {
            near = self.nearest();
            least = self.level(near)[0];
        }
        if least >= 0.0 {
            let common = if self.holds(Place::zeros()) { Common::Disc } else { Common::Nothing };
            return (common, self.margin(near));
        }
        if most <= 0.0 || extremes.is_some() {
            far = self.farthest();
            most = self.level(far)[0];
        }
        if most <= 0.0 {
            return (Common::Ellipse, self.margin(far));
        }
        // Where a cosine between the two is zero.
        let share = ((most + least) / (most - least)).clamp(-1.0, 1.0).acos() / PI;
        let crossing = |range: [f64; 2]| {
            root(range, range[0] + share * (range[1] - range[0]), |t| {
                let [level, half] = self.level(t);
                [level, 2.0 * half]
            })
        };
        // Falling from beyond the arc to its start, rising to its end.
        let falls = |from: f64, to: f64| {
            root([from, to], to - share * (to - from), |t| {
                let [level, half] = self.level(t);
                [-level, -2.0 * half]
            })
        };
        let whole = |[start, end]: [f64; 2]| Common::Arcs([[start, end]; 2], 1);
        let Some([first, second]) = extremes else {
            return (whole([falls(far, near), crossing([near, far + TAU])]), Gap::default());
        };
        let levels = [first, second].map(|t| self.level(t)[0]);
        let [one, other] = [first, second].map(|t| self.margin(t));
        let margin = if one.value < other.value { one } else { other };
        let common = if a > b {
            // Far, a least distance, a greatest one, near.
            let [least, most] = levels;
            let end = crossing([near, far + TAU]);
            if most <= 0.0 {
                whole([falls(far, first), end])
            } else if least >= 0.0 {
                whole([falls(second, near), end])
            } else {
                let other = [falls(far, first), crossing([first, second])];
                Common::Arcs([other, [falls(second, near), end]], 2)
            }
        } else {
            // Near, a greatest distance, a least one, far.
            let [most, least] = levels;
            let start = falls(far, near);
            if most <= 0.0 {
                whole([start, crossing([second, far + TAU])])
            } else if least >= 0.0 {
                whole([start, crossing([near, first])])
            } else {
                let other = [falls(first, second), crossing([second, far + TAU])];
                Common::Arcs([[start, crossing([near, first])], other], 2)
            }
        };
        (common, margin)
    }
    /// Distance beyond the circle of a point of the ellipse where that from the origin is an extreme, and its change with
    /// the height.
    fn distance(&self, angle: f64) -> Gap {
        let x = self.point(angle);
        let r = x.norm();
        let moves = x.dot(&(self.shift + (x - self.centre) * self.growth)) / r.max(f64::MIN_POSITIVE);
        Gap { value: r - self.radius, change: moves + self.slope }
    }
    fn margin(&self, angle: f64) -> Gap {
        let Gap { value, change } = self.distance(angle);
        Gap { value: value.abs(), change: change * value.signum() }
    }
    /// Parameters of the two extremes of the distance besides the least and the greatest one,
    /// upwards. There, with C = |cos θ| and S = |sin θ|, a u/C + b v/S = |a² − b²|: a convex
    /// function of θ, least where tan³ = b v/(a u).
    fn inner_extremes(&self, a: f64, b: f64, u: f64, v: f64) -> Option<[f64; 2]> {
        let (p, q, difference) = (a * u, b * v, (a - b).abs() * (a + b));
        if p >= difference || q >= difference {
            return None;
        }
        let (p_root, q_root) = (p.cbrt(), q.cbrt());
        let square = p_root * p_root + q_root * q_root;
        if square * square * square >= difference * difference {
            return None;
        }
        let middle = q_root.atan2(p_root);
        // As an angle from the x axis in the first quadrant, times sin cos: a smooth function.
        let f = |t: f64| {
            let (sin, cos) = t.sin_cos();
            let value = difference * sin * cos - p * sin - q * cos;
            [value, difference * (cos - sin) * (cos + sin) - p * cos + q * sin]
        };
        let low = root([0.0, middle], 0.5 * middle, f);
        let high = root([middle, 0.5 * PI], 0.5 * middle + 0.25 * PI, |t| f(t).map(|x| -x));
        Some(if a > b { [PI - high, PI - low] } else { [TAU - high, TAU - low] })
    }
}

/// The root of a function, given with its slope, that rises from negative to positive values over a
/// range: Newton's method from a `start`, between brackets.
fn root([mut low, mut high]: [f64; 2], start: f64, f: impl Fn(f64) -> [f64; 2]) -> f64 {
    let mut x = start;
    for _ in 0..STEPS {
        let [value, slope] = f(x);
        if value == 0.0 {
            return x;
        }
        if value < 0.0 {
            low = x
        } else {
            high = x
        }
        let next = x - value / slope;
        if next > low && next < high {
            // Newton's method squares the error.
            if (next - x).abs() <= CLOSE {
                return next;
            }
            x = next;
        } else {
            x = 0.5 * (low + high);
            if high - low <= CLOSE * CLOSE {
                return x;
            }
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::draw::Draw;
    use approx::assert_relative_eq;

    /// Area and first moment by strips along y.
    fn strips(pair: &Pair) -> (f64, Place) {
        const N: usize = 20_000;
        let r = pair.radius;
        let (low, high) =
            ((-r).max(pair.centre.x - pair.semi_axes.x), r.min(pair.centre.x + pair.semi_axes.x));
        let (mut area, mut first) = (0.0, Place::zeros());
        for i in 0..if low < high { N } else { 0 } {
            // Nodes of Chebyshev: roots at the ends do no harm.
            let angle = PI * (i as f64 + 0.5) / N as f64;
            let x = 0.5 * (low + high) - 0.5 * (high - low) * angle.cos();
            let weight = 0.5 * (high - low) * angle.sin() * PI / N as f64;
            let half = (r * r - x * x).max(0.0).sqrt();
            let share = (x - pair.centre.x) / pair.semi_axes.x;
            let other = pair.semi_axes.y * (1.0 - share * share).max(0.0).sqrt();
            let (from, to) = ((-half).max(pair.centre.y - other), half.min(pair.centre.y + other));
            if to > from {
                area += (to - from) * weight;
                first += Place::new(x * (to - from), 0.5 * (to - from) * (to + from)) * weight;
            }
        }
        (area, first)
    }

    #[test]
    fn areas_are_those_of_strips() {
        let mut draw = Draw(5);
        let (mut two, mut arcs) = (0, 0);
        for _ in 0..400 {
            let mut sign = || if draw.next() < 0.5 { -1.0 } else { 1.0 };
            let signs = Place::new(sign(), sign());
            let mut size = || draw.between(0.05, 2.0);
            let pair = Pair {
                radius: size(),
                slope: 0.3,
                centre: Place::new(size(), size()).component_mul(&signs) * 0.5,
                shift: Place::new(0.2, -0.1),
                semi_axes: Place::new(size(), size()),
                growth: -0.4,
            };
            let (section, (area, first)) = (pair.section(), strips(&pair));
            let scale = pair.radius.min(pair.semi_axes.max());
            assert_relative_eq!(section.area, area, epsilon = 1e-6 * scale * scale);
            assert_relative_eq!(section.first, first, epsilon = 1e-6 * scale * scale);
            // Change with the height.
            let at = |h: f64| Pair {
                radius: pair.radius - pair.slope * h,
                centre: pair.centre + pair.shift * h,
                semi_axes: pair.semi_axes * (1.0 + pair.growth * h),
                ..pair
            };
            let growth = (at(1e-5).section().area - at(-1e-5).section().area) / 2e-5;
            assert_relative_eq!(section.growth, growth, epsilon = 1e-3 * scale);
            if let Common::Arcs(_, n) = pair.reflected().0.common().0 {
                arcs += 1;
                two += usize::from(n == 2);
            }
        }
        assert!(arcs > 100 && two > 5, "{arcs} {two}");
    }

    #[test]
    fn gaps_are_distances() {
        let pair = Pair {
            radius: 1.0,
            slope: 0.5,
            centre: Place::new(-4.0, 0.0),
            shift: Place::new(0.1, 0.0),
            semi_axes: Place::new(2.0, 1.0),
            growth: 0.2,
        };
        let Gap { value, change } = pair.gap();
        assert_relative_eq!(value, 1.0, epsilon = 1e-14);
        // The tip at x = −2 moves by 0.1 + 2·0.2, the disc's rim by −0.5.
        assert_relative_eq!(change, 0.5 - 0.5, epsilon = 1e-14);
    }
}
