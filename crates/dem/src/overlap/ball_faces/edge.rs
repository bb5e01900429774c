//! What an edge of a face cuts off the disc in which the face's plane meets the unit ball.
use std::f64::consts::PI;

/// A piece of an edge within the unit ball, seen from the foot w of the centre on the plane of a face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    /// Distance of the plane from the centre, from 0 to 1.
    pub(super) height: f64,
    /// Distance of the edge's line from w, positive where the face lies on the side of w.
    pub(super) distance: f64,
    /// Where the piece begins and ends, along the line from its point nearest to w.
    pub(super) from: f64,
    pub(super) to: f64,
    /// Half the chord: the line leaves the ball at ± this.
    pub(super) half: f64,
}

/// Integrals over the part of the disc beyond an edge, between the rays from w to its ends; also over a sector or a face. With
/// ρ the distance from the centre and dA the element of the plane:
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Integrals {
    /// ∫ dA.
    pub(super) area: f64,
    /// ∫ (1 − ρ²)/2 dA.
    pub(super) second: f64,
    /// ∫ (1 − ρ³)/3 dΩ, dΩ = height dA/ρ³: the volume between the part and the sphere, along rays from the centre.
    pub(super) beyond: f64,
}

/// Points and weights of Gauss and Legendre, the positive half.
const SIX: [(f64, f64); 3] = [
    (0.238_619_186_083_196_9, 0.467_913_934_572_691),
    (0.661_209_386_466_264_5, 0.360_761_573_048_138_6),
    (0.932_469_514_203_152_1, 0.171_324_492_379_170_3),
];
const TWELVE: [(f64, f64); 6] = [
    (0.125_233_408_511_468_9, 0.249_147_045_813_402_8),
    (0.367_831_498_998_180_2, 0.233_492_536_538_354_8),
    (0.587_317_954_286_617_4, 0.203_167_426_723_065_9),
    (0.769_902_674_194_304_7, 0.160_078_328_543_346_2),
    (0.904_117_256_370_474_9, 0.106_939_325_995_318_4),
    (0.981_560_634_246_719_3, 0.047_175_336_386_511_83),
];

impl Integrals {
    /// Over the sector of the disc that w sees under `angle`.
    pub(super) fn sector(height: f64, angle: f64) -> Self {
        let rest = 1.0 - height;
        let square = rest * (1.0 + height);
        Self {
            area: 0.5 * angle * square,
            second: 0.125 * angle * square * square,
            beyond: angle * rest * rest * (2.0 + height) / 6.0,
        }
    }
    pub(super) fn minus(self, other: Self) -> Self {
        Self {
            area: self.area - other.area,
            second: self.second - other.second,
            beyond: self.beyond - other.beyond,
        }
    }
}

impl Edge {
    /// Square of the distance from w to the nearest point of the piece.
    fn nearest2(&self) -> f64 {
        let t = 0.0f64.clamp(self.from, self.to);
        self.distance * self.distance + t * t
    }
    /// Square of the distance from the centre to the nearest point of the piece.
    pub(super) fn centre2(&self) -> f64 {
        self.height * self.height + self.nearest2()
    }

    /// The part of the disc beyond the piece. With t along the edge, u² = height² + distance² + t² and p = 1 − u² the integrals
    /// are, over distance dt/(distance² + t²): p/2, p²/8 and height (1 − u)²(2 + u)/(6u).
    ///
    /// All three are smooth and of one sign. Where the piece is short as seen from w they are summed at Gauss points, which
    /// keeps their digits however thin the part is; else in closed form.
    pub(super) fn beyond(&self) -> Integrals {
        let length = self.to - self.from;
        let (square, nearest) = (length * length, self.nearest2());
        // The singular points, ± i distance and ± i √(height² + distance²), then lie so far off in units of the length that the rule is
        // exact to rounding errors.
        if square <= 0.04 * nearest {
            self.points(&SIX)
        } else if square <= nearest {
            self.points(&TWELVE)
        } else {
            self.closed(square)
        }
    }

    fn points<const N: usize>(&self, rule: &[(f64, f64); N]) -> Integrals {
        let (h2, d2) = (self.height * self.height, self.distance * self.distance);
        let half = 0.5 * (self.to - self.from);
        let (before, after) = (self.half + self.from, self.half - self.to);
        let mut sum = Integrals::default();
        for &(x, weight) in rule {
            for x in [x, -x] {
                let (left, right) = (half * (1.0 + x), half * (1.0 - x));
                let t = self.from + left;
                let p = (before + left) * (after + right);
                let r2 = d2 + t * t;
                let u = (h2 + r2).sqrt();
                let v = u * (1.0 + u) * (1.0 + u);
                let part = weight * p / (r2 * v);
                sum.area += part * v;
                sum.second += part * v * p;
                sum.beyond += part * p * (2.0 + u);
            }
        }
        let scale = self.distance * half;
        Integrals {
            area: 0.5 * scale * sum.area,
            second: 0.125 * scale * sum.second,
            beyond: self.height * scale / 6.0 * sum.beyond,
        }
    }

    fn closed(&self, square: f64) -> Integrals {
        let Self { height: h, distance: d, from, to, .. } = *self;
        let (length, d2) = (to - from, d * d);
        let angle = (d * length).atan2(d2 + from * to);
        let sector = Integrals::sector(h, angle);
        let a2 = (1.0 - h) * (1.0 + h);
        let flat = d * length;
        let triangle = Integrals {
            area: 0.5 * flat,
            second: 0.125 * flat * (2.0 * a2 - d2 - (to * to + to * from + from * from) / 3.0),
            beyond: 0.0,
        };
        let part = sector.minus(triangle);
        if square <= self.centre2() {
            // A chord of a small disc, whose sector's volume is as small as the part's: the rest of it at Gauss points.
            let rest = if square <= 0.04 * self.centre2() { self.rest(&SIX) } else { self.rest(&TWELVE) };
            return Integrals { beyond: sector.beyond - rest, ..part };
        }
        let beyond = self.solid_angle(from, to) / 3.0 + h * (flat + (h * h - 3.0) * angle) / 6.0;
        Integrals { beyond, ..part }
    }

    /// distance/6 ∫ [2/(u(u + height)) − height] dt: what the sector's volume has more than that of the part beyond.
    fn rest<const N: usize>(&self, rule: &[(f64, f64); N]) -> f64 {
        let h = self.height;
        let (eta, h2, l2) = (1.0 - h, h * h, h * h + self.distance * self.distance);
        let a2 = eta * (1.0 + h);
        let half = 0.5 * (self.to - self.from);
        let (before, after) = (self.half + self.from, self.half - self.to);
        let mut sum = 0.0;
        for &(x, weight) in rule {
            for x in [x, -x] {
                let (left, right) = (half * (1.0 + x), half * (1.0 - x));
                let t = self.from + left;
                let p = (before + left) * (after + right);
                let u = (l2 + t * t).sqrt();
                // 2 − h u (u + h) as a sum of positive terms.
                let above = p * (1.0 + u + h2) + (eta * u * u + a2) * (1.0 + u);
                sum += weight * above / (u * (u + h) * (1.0 + u));
            }
        }
        self.distance * half * sum / 6.0
    }

    /// Solid angle under which the centre sees the part of the plane beyond the edge between `from` and `to`: that of
    /// atan(height t/(distance u)).
    pub(super) fn solid_angle(&self, from: f64, to: f64) -> f64 {
        let Self { height: h, distance: d, .. } = *self;
        let l2 = h * h + d * d;
        let (u, v) = ((l2 + from * from).sqrt(), (l2 + to * to).sqrt());
        // t v − s u of from = s, to = t, without cancellation on one side of the nearest point.
        let across = if from * to > 0.0 {
            l2 * (to - from) * (to + from) / (to * u + from * v)
        } else {
            to * u - from * v
        };
        (h * d * across).atan2(d * d * u * v + h * h * from * to)
    }
}

/// Solid angle of the triangle `p`, `q`, `r` seen from the origin, positive when it is counter-clockwise seen from beyond
/// (van Oosterom & Strackee 1983, IEEE Trans. Biomed. Eng. 30, 125–126).
pub(super) fn solid_angle([p, q, r]: [interfaces::Vector; 3]) -> f64 {
    let (a, b, c) = (p.norm(), q.norm(), r.norm());
    let angle = 2.0 * p.dot(&q.cross(&r)).atan2(a * b * c + p.dot(&q) * c + q.dot(&r) * a + r.dot(&p) * b);
    debug_assert!(angle.abs() <= 2.0 * PI);
    angle
}
